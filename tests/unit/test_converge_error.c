/* Series that end by the error their first run estimates: where they end, what rows say, and what a checkpoint keeps of
 * it. Tiny runs; how far estimates are right is for the statistical tests. */
#include "../../src/converge/converge.h"
#include "../progress.h"

static progress *tiny(const char *scene, const char *method)
{
    progress *const p = progress_create(scene, method, "disc", 0.0);
    p->config.width = p->config.height = 8;
    return p;
}

static void forget(progress *p)
{
    pm_estimator_destroy(p->kernel);
    free(p);
}

static pm__converge_series series_of(const pm__converge_config *config)
{
    pm__converge_series series;
    pm_error error = {""};
    PM_CHECK_OK(pm__converge(config, &series, &error), error);
    return series;
}

/* The first pass from the 8th on after which the first run's estimate is small enough. */
static uint32_t first_good_pass(const progress *p, double wanted)
{
    pm__progressive_config config = p->config;
    pm__progression progression;
    pm_error error = {""};
    pm__run run;
    config.estimates = true;
    PM_CHECK_OK(pm__progression_open(&config, &progression, &error), error);
    PM_CHECK_OK(pm__run_begin(&progression, 0, &run, &error), error);
    progress_pass(&run, 8);
    while (pm__run_own_rel_rmse(&run, NULL, 0) > wanted)
        progress_pass(&run, 1);
    const uint32_t passes = run.passes;
    pm__run_end(&run);
    pm__progression_close(&progression);
    return passes;
}

/* All points of the furnace are measured, so that series and run mean the same ones. */
START_TEST(the_first_run_ends_all)
{
    progress *const p = tiny("scene:furnace", "ppm");
    const double easy = 1.0, hard = 0.06;
    const uint32_t passes = first_good_pass(p, hard);
    ck_assert_uint_gt(passes, 9);
    pm__converge_config config = {.progressive = p->config, .trials = 3, .passes = 200, .error = hard};
    pm__converge_series series = series_of(&config);
    const pm__converge_row *const last = &series.rows[series.row_count - 1];
    ck_assert(series.reached && series.trials == 3 && series.points == 64);
    ck_assert_uint_eq(last->pass, passes);
    ck_assert_double_le(last->estimated_rel_rmse, hard);
    ck_assert(isnan(series.rows[0].estimated_rel_rmse) && isnan(series.rows[0].estimate_right)); /* one pass */
    for (size_t r = 1; r < series.row_count; r++) {
        ck_assert(series.rows[r].estimate_right > 0.5 && series.rows[r].estimate_right <= 1.0);
        ck_assert_double_gt(series.rows[r].estimated_rel_rmse_mean, 0.5 * series.rows[r].estimated_rel_rmse);
    }
    pm__converge_free(&series);
    config.error = easy; /* not before the 8th pass */
    series = series_of(&config);
    ck_assert_uint_eq(series.rows[series.row_count - 1].pass, 8);
    pm__converge_free(&series);
    config.passes = 5; /* never */
    series = series_of(&config);
    ck_assert(!series.reached && series.rows[series.row_count - 1].pass == 5);
    pm__converge_free(&series);
    config.error = 0.0; /* not asked */
    series = series_of(&config);
    ck_assert(!series.reached && isnan(series.rows[2].estimated_rel_rmse) && isnan(series.rows[2].estimate_right));
    pm__converge_free(&series);
    forget(p);
}
END_TEST

/* Where nothing is found there is no estimate, so that nothing is right or wrong. */
START_TEST(black_has_no_estimate)
{
    progress *const p = tiny("scene:plate", "path");
    const pm__converge_config config = {.progressive = p->config, .trials = 2, .passes = 10, .error = 0.5};
    pm__converge_series series = series_of(&config);
    const pm__converge_row *const row = &series.rows[series.row_count - 1];
    ck_assert(!series.reached && isnan(row->estimated_rel_rmse));
    ck_assert(isnan(row->estimated_rel_rmse_mean) && isnan(row->estimate_right));
    ck_assert_double_gt(row->rel_rmse, 0.9);
    pm__converge_free(&series);
    forget(p);
}
END_TEST

/* A stored reference: nothing is said of right. */
START_TEST(references_have_no_bounds)
{
    progress *const p = tiny("scene:cornell", "pppm");
    p->config.width = p->config.height = 128;
    p->config.k = 50;
    const pm__converge_config config = {.progressive = p->config, .trials = 2, .passes = 2, .error = 0.5};
    pm__converge_series series = series_of(&config);
    ck_assert_str_eq(series.truth, "reference");
    ck_assert(series.rows[1].estimated_rel_rmse > 0.0 && isnan(series.rows[1].estimate_right));
    pm__converge_free(&series);
    forget(p);
}
END_TEST

START_TEST(what_cannot_be_asked)
{
    static const double errors[] = {-0.1, (double)NAN, (double)INFINITY};
    progress *const p = tiny("scene:furnace", "ppm");
    for (size_t i = 0; i < 3; i++) {
        const pm__converge_config config = {.progressive = p->config, .trials = 2, .passes = 2, .error = errors[i]};
        pm__converge_series series;
        pm_error error = {""};
        ck_assert_int_eq(pm__converge(&config, &series, &error), PM_EINVAL);
        pm__converge_free(&series);
    }
    forget(p);
}
END_TEST

/* ---- Checkpoints ------------------------------------------------------------------------------- */

typedef struct keeping {
    pm__saved last;
    size_t saves, end; /* canceled once there are `end` */
} keeping;

static pm_status keep(void *context, const pm__saved *saved, pm_error *error)
{
    keeping *const k = context;
    (void)error;
    k->saves++;
    free(k->last.bytes);
    k->last = (pm__saved){malloc(saved->count), saved->count};
    memcpy(k->last.bytes, saved->bytes, saved->count);
    return PM_OK;
}

static bool is_enough(void *context)
{
    const keeping *const k = context;
    return k->end && k->saves >= k->end;
}

/* Ended after so many passes of all runs together, in the first run or a later one, and taken up again. */
static void check_resumed(size_t end, double wanted)
{
    progress *const p = tiny("scene:plate", "ppm");
    keeping kept = {.end = end};
    p->config.context = &kept;
    p->config.canceled = is_enough;
    pm__converge_config config = {.progressive = p->config, .trials = 3, .passes = 40, .error = wanted};
    config.progressive.canceled = NULL;
    pm__converge_series whole = series_of(&config);
    config.progressive.canceled = is_enough;
    config.save = keep;
    config.save_seconds = 1e-9; /* after every pass */
    pm__converge_series part = series_of(&config);
    ck_assert(part.interrupted && whole.reached && whole.rows[whole.row_count - 1].pass < 40);
    pm__converge_free(&part);
    const pm__saved from = {malloc(kept.last.count), kept.last.count};
    memcpy(from.bytes, kept.last.bytes, from.count);
    config.progressive.canceled = NULL;
    config.from = &from;
    pm__converge_series rest = series_of(&config);
    ck_assert(rest.reached && rest.row_count == whole.row_count);
    for (size_t r = 0; r < whole.row_count; r++) {
        rest.rows[r].seconds = whole.rows[r].seconds;
        ck_assert_mem_eq(&rest.rows[r].rel_bias, &whole.rows[r].rel_bias,
                         sizeof rest.rows[r] - offsetof(pm__converge_row, rel_bias));
    }
    pm__converge_free(&rest);
    config.error = 0.5 * wanted; /* another series */
    pm_error error = {""};
    ck_assert_int_eq(pm__converge(&config, &rest, &error), PM_EFORMAT);
    pm__converge_free(&rest);
    pm__converge_free(&whole);
    free(from.bytes);
    free(kept.last.bytes);
    forget(p);
}

START_TEST(checkpoints_keep_estimates)
{
    check_resumed(5, 0.2);
    check_resumed(14, 0.2); /* in the second run: each has 9 passes */
}
END_TEST

PM_TEST_MAIN("converge by error", the_first_run_ends_all, black_has_no_estimate, references_have_no_bounds,
             what_cannot_be_asked, checkpoints_keep_estimates)
