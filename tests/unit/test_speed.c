/* Rows of `speed`: verdicts, and whether images agree; times are not looked at. */
#include "../../bench/speed.h"

#include "../../cases/scenes/list.h"
#include "../../src/base/random.h"
#include "../test.h"

#include <string.h>

/* ---- Verdicts ---------------------------------------------------------------------------------- */

static const char *verdict(double promise, double low, double high, size_t rounds)
{
    return pm__speed_verdict(promise, 0.5 * (low + high), (pm__interval){low, high}, rounds);
}

START_TEST(test_an_interval_decides)
{
    ck_assert_str_eq(verdict(0.6, 0.61, 0.7, 20), "ok");
    ck_assert_str_eq(verdict(0.6, 0.6, 0.7, 20), "ok");
    ck_assert_str_eq(verdict(0.6, 0.5, 0.59, 20), "missed");
    ck_assert_str_eq(verdict(0.6, 0.55, 0.7, 20), "unclear");
    ck_assert_str_eq(verdict((double)NAN, 0.1, 0.2, 20), "ok");
    ck_assert_str_eq(verdict(0.6, (double)NAN, (double)NAN, 20), "ok");
}
END_TEST

/* Five rounds have no interval at 95 %: what is given then is their range. */
START_TEST(test_too_few_rounds_decide_nothing)
{
    ck_assert_str_eq(verdict(0.6, 0.7, 0.8, 5), "unclear");
    ck_assert_str_eq(verdict(0.6, 0.7, 0.8, 6), "ok");
}
END_TEST

/* ---- Images ------------------------------------------------------------------------------------ */

enum { TRIALS = 16, VALUES = 48 };

typedef struct trials {
    double values[TRIALS * VALUES];
} trials;

/* Box and Muller; sigma differs from value to value. */
static void draw(uint64_t number, double mean, double noise, trials *t)
{
    for (size_t i = 0; i < TRIALS * VALUES; i++) {
        double u[3];
        pm__random_uniform(1, PM__FOR_TESTS, (uint32_t)number, i, u, 3);
        const double normal = sqrt(-2.0 * log1p(-u[0])) * cos(6.283185307179586 * u[1]);
        t->values[i] = mean + noise * (double)(1 + i % VALUES) / VALUES * normal;
    }
}

/* 1000 comparisons at one false alarm in a million: one in a thousand that there is any. */
START_TEST(test_equal_means_agree)
{
    double worst, least = 1.0, small = 0.0;
    for (uint64_t i = 0; i < 1000; i++) {
        trials a, b;
        draw(2 * i, 1.0, 0.3, &a);
        draw(2 * i + 1, 1.0, 0.3, &b);
        ck_assert(pm__speed_agree(a.values, b.values, TRIALS, VALUES, &worst));
        least = fmin(least, worst);
        small += worst < 0.1;
    }
    /* The p-values are what they say: below 0.1 in 9.5 % (Bonferroni, independent values), here +- 6 sigma. */
    PM_CHECK_NEAR(small, 95.3, 6.0 * sqrt(1000.0 * 0.0953 * 0.9047));
    ck_assert_double_lt(least, 0.02);
}
END_TEST

/* One value of 48 is off by five times its own noise: 20 standard errors of its mean, which t with 15 degrees of
 * freedom tells at 1e-11. */
START_TEST(test_one_value_off_is_told)
{
    double worst;
    trials a, b;
    draw(5000, 1.0, 0.01, &a);
    draw(5001, 1.0, 0.01, &b);
    for (size_t t = 0; t < TRIALS; t++)
        b.values[t * VALUES + 47] += 0.01 * 5.0 * sqrt(2.0);
    ck_assert(!pm__speed_agree(a.values, b.values, TRIALS, VALUES, &worst));
    ck_assert_double_lt(worst, 1e-6);
}
END_TEST

START_TEST(test_images_without_noise)
{
    double worst;
    trials a, b;
    draw(1, 1.0, 0.0, &a);
    draw(2, 1.0, 0.0, &b);
    ck_assert(pm__speed_agree(a.values, b.values, TRIALS, VALUES, &worst));
    ck_assert_double_eq(worst, 1.0);
    for (size_t t = 0; t < TRIALS; t++)
        b.values[t * VALUES] = 1.0 + 1e-7; /* rounding */
    ck_assert(pm__speed_agree(a.values, b.values, TRIALS, VALUES, NULL));
    for (size_t t = 0; t < TRIALS; t++)
        b.values[t * VALUES] = 1.0 + 1e-4;
    ck_assert(!pm__speed_agree(a.values, b.values, TRIALS, VALUES, &worst));
    ck_assert_double_eq(worst, 0.0);
    b.values[0] = (double)NAN;
    ck_assert(!pm__speed_agree(a.values, b.values, TRIALS, VALUES, NULL));
}
END_TEST

/* ---- Runs -------------------------------------------------------------------------------------- */

static bool always(void *context)
{
    (void)context;
    return true;
}

static pm__speed_config tiny(const pm__spec *scene, unsigned quantities)
{
    return (pm__speed_config){.scenes = scene, .scene_count = 1, .quantities = quantities, .photons = 300,
                              .pass_photons = 300, .k = 8, .width = 8, .height = 8, .threads = 1, .seconds = 1e-3,
                              .seed = 1};
}

static pm__spec scene_of(const char *name)
{
    pm__spec scene;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, name, &scene, &error), error);
    return scene;
}

START_TEST(test_rows_say_what_was_compared)
{
    static const char *const baselines[] = {"embree", "rays + search", "no-skip", "no-skip", "parts", "2e6 rays"};
    static const pm__quantity quantities[] = {PM__TRACE_SPEED, PM__VISUALIZE_SPEED, PM__SKIP_SPEED,
                                              PM__SKIP_SPEED,  PM__PASS_SPEED,      PM__PASS_RAYS_SPEED};
    const pm__spec scene = scene_of("scene:cornell");
    const pm__speed_config config = tiny(&scene, 0);
    pm__speed_row *rows;
    size_t count;
    pm_error error;
    PM_CHECK_OK(pm__speed_run(&config, &rows, &count, &error), error);
    ck_assert_uint_eq(count, 6); /* one thread: no trace-threads, no pass-threads */
    for (size_t i = 0; i < count; i++) {
        const pm__speed_row *const row = &rows[i];
        ck_assert_int_eq(row->quantity, quantities[i]);
        ck_assert_str_eq(row->baseline, baselines[i]);
        ck_assert_msg(row->seconds > 0.0 && row->baseline_seconds > 0.0 && row->ratio > 0.0, "%s", row->detail);
        ck_assert(row->ratio_ci95.low <= row->ratio && row->ratio <= row->ratio_ci95.high);
        ck_assert_uint_ge(row->samples, 6);
        ck_assert(row->compared == (row->quantity == PM__SKIP_SPEED) && (!row->compared || row->agree));
        ck_assert(isnan(row->promise) == row->compared);
    }
    free(rows);
}
END_TEST

/* A row that cannot be measured says so and leaves the others alone. */
START_TEST(test_a_row_that_fails_is_a_row)
{
    const pm__spec scene = scene_of("scene:cornell");
    pm__speed_config config = tiny(&scene, 1U << PM__SKIP_SPEED);
    config.k = 0; /* neither k nor a radius */
    pm__speed_row *rows;
    size_t count;
    pm_error error;
    PM_CHECK_OK(pm__speed_run(&config, &rows, &count, &error), error);
    ck_assert_uint_eq(count, 2);
    ck_assert_str_eq(rows[0].status, "failed");
    ck_assert_ptr_nonnull(strstr(rows[0].detail, "neither k nor a radius"));
    ck_assert(isnan(rows[0].ratio));
    free(rows);
}
END_TEST

START_TEST(test_canceled)
{
    const pm__spec scene = scene_of("scene:cornell");
    pm__speed_config config = tiny(&scene, 0);
    config.canceled = always;
    pm__speed_row *rows;
    size_t count = 1;
    pm_error error;
    ck_assert_int_eq(pm__speed_run(&config, &rows, &count, &error), PM_ECANCELED);
    ck_assert_uint_eq(count, 0);
    free(rows);
}
END_TEST

PM_TEST_MAIN("speed", test_an_interval_decides, test_too_few_rounds_decide_nothing, test_equal_means_agree,
             test_one_value_off_is_told, test_images_without_noise, test_rows_say_what_was_compared,
             test_a_row_that_fails_is_a_row, test_canceled)
