/* A series that is saved and taken up again ends as the one that was never disturbed, whatever the method. */
#include "../../src/converge/converge.h"

#include "../progress.h"

#include <stddef.h>
#include <string.h>

enum { TRIALS = 3, PASSES = 6, SIDE = 4, MOST_SAVED = 64 };
/* Where fields stand in what is saved. */
enum { GONE = 72, RECORDS = GONE + 8, DONE = RECORDS + 8, RECORD = DONE + 8, RUNNING = RECORD + 8 };
enum { REACHED = RUNNING + 1, FIRST_PASS = REACHED + 1 };

static const size_t watched[] = {5, 10};

/* What a series keeps of itself, and when it is told to stop. */
typedef struct keeper {
    pm__saved all[MOST_SAVED];
    size_t count;
    int asked, stop; /* stop: at this time that it is asked; 0: never */
} keeper;

static bool stops(void *context)
{
    keeper *const k = context;
    return ++k->asked >= k->stop && k->stop;
}

static pm_status keep(void *context, const pm__saved *saved, pm_error *error)
{
    keeper *const k = context;
    (void)error;
    ck_assert_uint_lt(k->count, MOST_SAVED);
    pm__saved *const to = &k->all[k->count++];
    *to = (pm__saved){malloc(saved->count), saved->count};
    ck_assert_ptr_nonnull(to->bytes);
    memcpy(to->bytes, saved->bytes, saved->count);
    return PM_OK;
}

static void drop(keeper *k)
{
    for (size_t i = 0; i < k->count; i++)
        free(k->all[i].bytes);
    *k = (keeper){.count = 0};
}

/* Methods without a bias find nothing of a caustic: they have the furnace. */
static progress *setting_of(const char *name)
{
    const bool caustic = strcmp(name, "path") != 0 && strcmp(name, "light") != 0;
    progress *const p = progress_create(caustic ? "scene:plate" : "scene:furnace", name, "disc", 0.0);
    p->config.width = p->config.height = SIDE;
    p->config.photons = 500;
    return p;
}

static void setting_free(progress *p)
{
    pm_estimator_destroy(p->kernel);
    free(p);
}

static pm__converge_config config_of(const progress *p, keeper *k, const pm__saved *from)
{
    pm__converge_config config = {.progressive = p->config, .trials = TRIALS, .passes = PASSES, .watched = watched,
                                  .watched_count = 2, .from = from, .save = keep, .save_seconds = 1e-9};
    config.progressive.canceled = stops;
    config.progressive.context = k;
    return config;
}

static pm__converge_series go(const progress *p, keeper *k, const pm__saved *from)
{
    const pm__converge_config config = config_of(p, k, from);
    pm__converge_series series;
    pm_error error = {""};
    PM_CHECK_OK(pm__converge(&config, &series, &error), error);
    return series;
}

/* To the last bit, but for seconds; all after them in a row are doubles. */
static void check_same(const char *what, const pm__converge_series *a, const pm__converge_series *b)
{
    const size_t from = offsetof(pm__converge_row, rel_bias), size = sizeof(pm__converge_row) - from;
    ck_assert_uint_eq(a->row_count, b->row_count);
    ck_assert_uint_eq(a->trials, b->trials);
    ck_assert(a->interrupted == b->interrupted);
    for (size_t r = 0; r < a->row_count; r++) {
        ck_assert_uint_eq(a->rows[r].pass, b->rows[r].pass);
        ck_assert_uint_eq(a->rows[r].photons, b->rows[r].photons);
        ck_assert_msg(memcmp((const char *)&a->rows[r] + from, (const char *)&b->rows[r] + from, size) == 0,
                      "%s: row %zu differs", what, r);
    }
    for (int q = 0; q < PM__QUANTITIES; q++) {
        const pm__converge_fit *const x = &a->fits[q], *const y = &b->fits[q];
        ck_assert(x->fits == y->fits && memcmp(&x->slope, &y->slope, sizeof x->slope) == 0);
        ck_assert(memcmp(&x->predicted, &y->predicted, sizeof x->predicted) == 0);
    }
    for (size_t i = 0; i < a->row_count * 2; i++) {
        const pm__converge_point *const x = &a->watched[i], *const y = &b->watched[i];
        ck_assert(x->point == y->point && x->pass == y->pass);
        ck_assert_mem_eq(&x->radius, &y->radius, sizeof *x - offsetof(pm__converge_point, radius));
    }
}

/* From every third state, and from the one of a series that is done. */
START_TEST(every_method_goes_on)
{
    const char *const name = pm__progressives.entries[_i]->name;
    progress *const p = setting_of(name);
    keeper whole = {.count = 0};
    pm__converge_series want = go(p, &whole, NULL);
    ck_assert_uint_eq(want.row_count, 4);
    ck_assert_msg(want.rows[3].rel_noise > 0.0, "%s finds nothing", name);
    ck_assert_uint_eq(whole.count, TRIALS * PASSES + 1);
    for (size_t i = 0; i < whole.count; i += 3) {
        keeper rest = {.count = 0};
        pm__converge_series got = go(p, &rest, &whole.all[i]);
        ck_assert_uint_eq(rest.count, whole.count - 1 - i + (i + 1 == whole.count));
        check_same(name, &want, &got);
        pm__converge_free(&got);
        drop(&rest);
    }
    ck_assert_uint_eq((whole.count - 1) % 3, 0); /* the last one was among them */
    pm__converge_free(&want);
    drop(&whole);
    setting_free(p);
}
END_TEST

/* Stopped again and again, each time a little later: within set-up, passes, and between. */
START_TEST(every_method_stops_anywhere)
{
    const char *const name = pm__progressives.entries[_i]->name;
    progress *const p = setting_of(name);
    keeper never = {.count = 0};
    pm__converge_series want = go(p, &never, NULL);
    pm__saved last = {NULL, 0};
    size_t stopped = 0;
    for (int stop = 1;; stop += stop < 20 ? 3 : 31) {
        keeper k = {.stop = stop};
        pm__converge_series got = go(p, &k, last.bytes ? &last : NULL);
        if (k.count) {
            free(last.bytes);
            last = k.all[--k.count];
        }
        drop(&k);
        if (!got.interrupted) {
            check_same(name, &want, &got);
            pm__converge_free(&got);
            break;
        }
        pm__converge_free(&got);
        stopped++;
    }
    ck_assert_msg(stopped >= 3, "%s was stopped %zu times", name, stopped);
    free(last.bytes);
    pm__converge_free(&want);
    drop(&never);
    setting_free(p);
}
END_TEST

static void check_refused(const progress *p, const pm__saved *saved, size_t trials, const char *message)
{
    keeper k = {.count = 0};
    pm__converge_config config = config_of(p, &k, saved);
    pm__converge_series series;
    pm_error error = {""};
    config.trials = trials;
    ck_assert_int_eq(pm__converge(&config, &series, &error), PM_EFORMAT);
    ck_assert_msg(strstr(error.text, message) != NULL, "'%s' lacks '%s'", error.text, message);
    ck_assert_uint_eq(k.count, 0);
    ck_assert_uint_eq(series.row_count, 0);
    pm__converge_free(&series);
}

START_TEST(damage_is_refused)
{
    progress *const p = setting_of("path");
    keeper whole = {.count = 0};
    pm__converge_series series = go(p, &whole, NULL);
    const pm__saved *const one = &whole.all[9];
    pm__saved copy = {malloc(one->count + 1), 0};
    ck_assert_ptr_nonnull(copy.bytes);
    memcpy(copy.bytes, one->bytes, one->count);
    for (; copy.count < one->count; copy.count += copy.count < 128 ? 1 : 61) /* cut */
        check_refused(p, &copy, TRIALS, "damaged");
    copy.bytes[one->count] = 0;
    copy.count = one->count + 1;
    check_refused(p, &copy, TRIALS, "damaged");
    copy.count = one->count;
    static const size_t fields[] = {RECORDS, DONE, RECORD};
    static const uint64_t values[] = {UINT64_MAX, (uint64_t)1 << 32, 5, 0};
    for (size_t f = 0; f < 3; f++)
        for (size_t v = 0; v < (f ? 3 : 4); v++) {
            memcpy(copy.bytes + fields[f], &values[v], 8);
            check_refused(p, &copy, TRIALS, "damaged");
            memcpy(copy.bytes + fields[f], one->bytes + fields[f], 8);
        }
    for (unsigned v = 0; v < 3; v += 2) { /* no run in hand, though one is there; no truth value */
        copy.bytes[RUNNING] = (unsigned char)v;
        check_refused(p, &copy, TRIALS, "damaged");
    }
    copy.bytes[RUNNING] = one->bytes[RUNNING];
    copy.bytes[REACHED] = 2;
    check_refused(p, &copy, TRIALS, "damaged");
    copy.bytes[REACHED] = 0;
    static const uint32_t passes[4][4] = {{0, 2, 4, 6}, {1, 2, 4, 7}, {1, 4, 4, 6}, {2, 1, 4, 6}};
    for (size_t i = 0; i < 4; i++) {
        memcpy(copy.bytes + FIRST_PASS, passes[i], sizeof passes[i]);
        check_refused(p, &copy, TRIALS, "damaged");
    }
    free(copy.bytes);
    pm__converge_free(&series);
    drop(&whole);
    setting_free(p);
}
END_TEST

START_TEST(other_series_are_refused)
{
    progress *const p = setting_of("path");
    keeper whole = {.count = 0};
    pm__converge_series series = go(p, &whole, NULL);
    check_refused(p, &whole.all[4], TRIALS + 1, "another series");
    p->config.seed = 2;
    check_refused(p, &whole.all[4], TRIALS, "another series");
    p->config.seed = 1;
    p->config.photons = 501;
    check_refused(p, &whole.all[4], TRIALS, "another series");
    p->config.photons = 500;
    p->config.height = 5;
    check_refused(p, &whole.all[4], TRIALS, "another series");
    pm__converge_free(&series);
    drop(&whole);
    setting_free(p);
}
END_TEST

/* Time that had gone by counts: said to be long over, it ends the first run after its next pass. */
START_TEST(time_counts_on)
{
    progress *const p = setting_of("path");
    keeper whole = {.count = 0}, rest = {.count = 0};
    pm__converge_series series = go(p, &whole, NULL);
    pm__converge_config config = config_of(p, &rest, &whole.all[2]); /* after the third pass */
    pm_error error = {""};
    const double gone = 1e6;
    double noted;
    pm__converge_free(&series);
    memcpy(&noted, whole.all[2].bytes + GONE, sizeof noted);
    ck_assert(noted >= 0.0 && noted < 600.0);
    memcpy(whole.all[2].bytes + GONE, &gone, sizeof gone);
    config.seconds = 1e5;
    PM_CHECK_OK(pm__converge(&config, &series, &error), error);
    ck_assert_uint_eq(series.row_count, 3);
    ck_assert_uint_eq(series.rows[2].pass, 4);
    ck_assert_uint_eq(series.trials, TRIALS);
    ck_assert_double_ge(series.rows[2].seconds, gone);
    pm__converge_free(&series);
    drop(&whole);
    drop(&rest);
    setting_free(p);
}
END_TEST

/* Stopped while it is set up there is nothing new to save, and what was there must not be lost. */
START_TEST(nothing_is_saved_of_set_up)
{
    progress *const p = setting_of("ppm");
    keeper k = {.stop = 1}, whole = {.count = 0};
    pm__converge_series series = go(p, &k, NULL);
    ck_assert(series.interrupted && series.row_count == 0);
    ck_assert_uint_eq(k.count, 0);
    pm__converge_free(&series);
    series = go(p, &whole, NULL);
    pm__converge_free(&series);
    series = go(p, &k, &whole.all[5]);
    ck_assert(series.interrupted && series.row_count == 0);
    ck_assert_uint_eq(k.count, 0);
    pm__converge_free(&series);
    drop(&whole);
    setting_free(p);
}
END_TEST

int main(void)
{
    const TTest *const once[] = {damage_is_refused, other_series_are_refused, time_counts_on,
                                 nothing_is_saved_of_set_up};
    Suite *const suite = suite_create("converge_saved");
    TCase *const tcase = tcase_create("converge_saved");
    tcase_set_timeout(tcase, 300);
    for (size_t i = 0; i < sizeof once / sizeof *once; i++)
        tcase_add_test(tcase, once[i]);
    tcase_add_loop_test(tcase, every_method_goes_on, 0, (int)pm__progressives.count);
    tcase_add_loop_test(tcase, every_method_stops_anywhere, 0, (int)pm__progressives.count);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
