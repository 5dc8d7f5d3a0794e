/* Path and light tracing as runs: taken up again, on any number of threads, canceled. */
#include "../progress.h"

enum { SIDE = 16, POINTS = SIDE * SIDE };

static progress *image_of(const char *scene, const char *method, size_t photons, const pm_parallel *parallel)
{
    progress *const s = progress_create(scene, method, "combined", 0.0); /* a kernel that others refuse */
    s->config.width = s->config.height = SIDE;
    s->config.photons = photons;
    s->config.parallel = parallel;
    return progress_open(s);
}

static void run_trial(const progress *s, uint32_t trial, uint32_t passes, double (*radiance)[3])
{
    pm_error error = {""};
    pm__run run = progress_begin(s, trial);
    progress_pass(&run, passes);
    PM_CHECK_OK(pm__run_read(&run, radiance, &error), error);
    pm__run_end(&run);
}

/* Several rounds of photons, lights in view. */
enum { MANY = 40000 };
static const char *const both[] = {"path", "light"};

START_TEST(resumed_as_undisturbed)
{
    static double want[POINTS][3], got[POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        progress *const s = image_of("scene:cornell-diffuse", both[m], MANY, NULL);
        pm_error error = {""};
        run_trial(s, 1, 3, want);
        pm__run first = progress_begin(s, 1), second = progress_begin(s, 1);
        progress_pass(&first, 1);
        PM_CHECK_OK(pm__run_resume(&second, first.state, first.passes, &error), error);
        pm__run_end(&first);
        progress_pass(&second, 2);
        ck_assert_uint_eq(second.passes, 3);
        PM_CHECK_OK(pm__run_read(&second, got, &error), error);
        pm__run_end(&second);
        ck_assert_msg(memcmp(want, got, sizeof want) == 0, "%s", both[m]);
        progress_free(s);
    }
}
END_TEST

START_TEST(as_one_thread_so_two)
{
    static double want[POINTS][3], got[POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        progress *const one = image_of("scene:cornell-diffuse", both[m], MANY, NULL);
        progress *const two = image_of("scene:cornell-diffuse", both[m], MANY, &picture_two_threads);
        run_trial(one, 0, 2, want);
        run_trial(two, 0, 2, got);
        ck_assert_msg(memcmp(want, got, sizeof want) == 0, "%s", both[m]);
        progress_free(one);
        progress_free(two);
    }
}
END_TEST

/* By more than sums in another order do. */
static bool differ(const double (*a)[3], const double (*b)[3])
{
    for (size_t p = 0; p < POINTS; p++)
        if (fabs(a[p][0] - b[p][0]) > 1e-9 * fabs(a[p][0]))
            return true;
    return false;
}

/* Passes and trials have numbers of their own: no answer comes twice. No light is seen itself, which would hide it. */
START_TEST(passes_and_trials_differ)
{
    static double seen[4][POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        progress *const s = image_of("scene:point-light", both[m], 1000, NULL);
        for (uint32_t i = 0; i < 4; i++)
            run_trial(s, i % 2, 1 + i / 2, seen[i]);
        for (size_t i = 0; i < 4; i++)
            for (size_t j = 0; j < i; j++)
                ck_assert_msg(differ((const double(*)[3])seen[i], (const double(*)[3])seen[j]), "%s: %zu and %zu",
                              both[m], i, j);
        progress_free(s);
    }
}
END_TEST

/* What a point says of itself: photons that were joined to it; no radius. */
START_TEST(photons_are_counted)
{
    progress *const s = image_of("scene:furnace", "light", 3000, NULL);
    pm__run run = progress_begin(s, 0);
    double sum = 0.0;
    progress_pass(&run, 2);
    for (size_t p = 0; p < POINTS; p++) {
        const pm__point_view view = pm__run_view(&run, p);
        PM_CHECK_NEAR(view.radius, 0.0, 0.0);
        sum += view.count;
    }
    ck_assert_uint_eq(run.emitted, 6000);
    ck_assert(sum > 0.0 && sum < (double)run.stored);
    pm__run_end(&run);
    progress_free(s);
}
END_TEST

static bool stops(void *context)
{
    int *const left = context;
    return (*left)-- <= 0;
}

/* A pass that is told to stop when it asks for the time `left`, from 0; returns what it leaves of that. */
static int pass_until(progress *s, int left, pm_status want)
{
    pm_error error = {""};
    s->config.canceled = stops;
    s->config.context = &left;
    pm__run run = progress_begin(s, 0);
    const pm_status status = pm__run_pass(&run, &error);
    ck_assert_msg(status == want, "%d left: %s", left, pm_status_text(status));
    ck_assert(status == PM_OK || strstr(error.text, "canceled"));
    if (status != PM_OK) { /* as it was before */
        const size_t values = s->progression.points * pm__progressive_of(&run)->fields;
        ck_assert_uint_eq(run.passes + run.emitted + run.stored, 0);
        for (size_t i = 0; i < values; i++)
            ck_assert(run.state[i] == 0.0);
    }
    pm__run_end(&run);
    return left;
}

START_TEST(passes_are_canceled)
{
    static const int fewest[] = {1, 10}; /* one task of points; photons traced, and joined, besides */
    for (size_t m = 0; m < 2; m++) {
        progress *const s = image_of("scene:cornell-diffuse", both[m], 3000, NULL);
        const int asked = 1000 - pass_until(s, 1000, PM_OK);
        ck_assert_int_ge(asked, fewest[m]);
        for (int left = 0; left < asked; left++)
            (void)pass_until(s, left, PM_ECANCELED);
        progress_free(s);
    }
}
END_TEST

START_TEST(photons_are_needed)
{
    progress *const s = image_of("scene:furnace", "light", 1, NULL);
    pm__progression none;
    pm_error error = {""};
    pm__progressive_config config = s->config;
    config.photons = 0;
    ck_assert_int_eq(pm__progression_open(&config, &none, &error), PM_EINVAL);
    ck_assert_msg(strstr(error.text, "no photons"), "%s", error.text);
    progress_free(s);
}
END_TEST

PM_TEST_MAIN("light_path_runs", resumed_as_undisturbed, as_one_thread_so_two, passes_and_trials_differ,
             photons_are_counted, passes_are_canceled, photons_are_needed)
