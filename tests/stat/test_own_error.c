/* What runs say of their own error, against the error. Where a mean over trials is compared, they are the replicates:
 * Student's bound for a false alarm in 1e-6 over the file (CHECKS comparisons, two-sided). The rest are promises with
 * room for chance: the error of 8 runs of some 500 points, 100 of which share no photons, has a standard error of 3 %
 * itself, what one run estimates of it one of 2 % more, so that 20 % is five and a half of both together; the share of
 * right points, near 0.95 where lookups smooth noise and 0.9 where it is promised, has one below 0.01: 0.85 is five. */
#include "../../src/converge/converge.h"
#include "../../src/stats/stats.h"
#include "../progress.h"

enum { TRIALS = 16, RUNS = 8, CHECKS = 6 };

static const double pi = 3.14159265358979323846;

/* ---- Means ------------------------------------------------------------------------------------- */

/* what: mean over trials of values, against `want` and what is allowed beside chance. */
static void check_mean(const char *what, const double values[TRIALS], double want, double allowed)
{
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < TRIALS; i++)
        mean += values[i] / TRIALS;
    for (int i = 0; i < TRIALS; i++)
        square += (values[i] - mean) * (values[i] - mean);
    const double bound = pm__student_quantile(1.0 - 0.5e-6 / CHECKS, TRIALS - 1.0);
    const double error = sqrt(square / (TRIALS * (TRIALS - 1.0)));
    ck_assert_msg(fabs(mean - want) <= allowed + bound * error, "%s: %g, expected %g within %g + %.1f x %g", what, mean,
                  want, allowed, bound, error);
}

/* Over points: the mean of the bias, of its square less its variance, and of the noise. */
typedef struct told {
    double bias, bias2, bias_variance, variance;
} told;

static told tell(const pm__run *run)
{
    told t = {0.0, 0.0, 0.0, 0.0};
    const double share = 1.0 / (double)run->of->points;
    for (size_t i = 0; i < run->of->points; i++) {
        const pm__own_error own = pm__run_own_error(run, i);
        t.bias += share * own.bias[0];
        t.bias2 += share * (own.bias[0] * own.bias[0] - own.bias_variance);
        t.bias_variance += share * own.bias_variance;
        t.variance += share * own.variance;
    }
    return t;
}

/* The furnace reflects 1 W/(m2 sr) evenly: no bias, and noise of 1 / n where passes of fixed radius find n photons, V =
 * (1/i^2) sum 1 / n_j. Photons land twice on average, 4000 times in a pass, anywhere: a disc of radius r on the unit
 * sphere holds r^2 / 4 of that. The schedule is pppm's. */
START_TEST(even_light_has_noise_alone)
{
    enum { PASSES = 12 };
    progress *const p = progress_create("scene:furnace", "pppm", "disc", 0.2);
    p->config.width = p->config.height = 24;
    p->config.photons = 2000;
    p->config.estimates = true;
    progress_open(p);
    double bias[TRIALS], bias2[TRIALS], noise[TRIALS], doubt[TRIALS], want = 0.0, share = 1.0;
    for (int i = 1; i <= PASSES; i++) {
        want += 1.0 / (4000.0 * 0.01 * share) / (PASSES * PASSES);
        share *= (i + p->config.alpha) / (i + 1.0);
    }
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        pm__run run = progress_begin(p, trial);
        progress_pass(&run, PASSES);
        const told t = tell(&run);
        bias[trial] = t.bias;
        bias2[trial] = t.bias2;
        doubt[trial] = t.bias_variance;
        noise[trial] = t.variance;
        pm__run_end(&run);
    }
    check_mean("bias", bias, 0.0, 0.0);
    check_mean("bias squared", bias2, 0.0, 0.0);
    check_mean("variance", noise, want, 1e-3 * want);
    check_mean("variance of the bias", doubt, want * 97.78 * pi / 64.0 / 64.0, 1e-3 * want);
    progress_free(p);
}
END_TEST

/* A point light of the height 1 lights the floor by (1 + u)^-3/2 / (4 pi), u = rho^2, with the Laplacian (9 u - 6) (1
 * + u)^-7/2 / (4 pi): rho times the derivative by rho is 2 u f', so it is 4 u f'' + 4 f'. Discs of radius R have R^2/8
 * of it as their bias. */
static double law_of_bias(const pm__hit_point *point, double radius2)
{
    const double u = point->position[0] * point->position[0] + point->position[1] * point->position[1];
    double brdf[3];
    pm__hit_point_brdf(point, point->normal, brdf);
    return brdf[0] * point->weight[0] * radius2 / 8.0 * (9.0 * u - 6.0) * pow(1.0 + u, -3.5) / (4.0 * pi);
}

/* Biases along their law, in 0.5 m about the foot. Blurring over 2 R makes the Laplacian smaller, by 0.05 (2 R)^2 times
 * 20 (its own, at the foot), 4 R^2 = 0.16 at first and less later and elsewhere. */
START_TEST(bias_is_that_of_the_curvature)
{
    static const pm__view near_foot = {.eye = {0, -1, 2}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.4};
    enum { PASSES = 5 };
    progress *const p = progress_create("scene:point-light", "pppm", "disc", 0.2);
    p->config.view = &near_foot;
    p->config.photons = 30000;
    p->config.estimates = true;
    p->config.parallel = &picture_two_threads;
    progress_open(p);
    double along[TRIALS], squares[TRIALS];
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        pm__run run = progress_begin(p, trial);
        double radius2 = 0.0, product = 0.0, law2 = 0.0;
        for (int j = 0; j < PASSES; j++) {
            radius2 += progress_radius2(&run) / PASSES;
            progress_pass(&run, 1);
        }
        for (size_t i = 0; i < p->progression.points; i++) {
            const double law = law_of_bias(&p->progression.fixed[i], radius2);
            product += law * pm__run_own_error(&run, i).bias[0];
            law2 += law * law;
        }
        along[trial] = product / law2;
        squares[trial] = tell(&run).bias2 * (double)p->progression.points / law2;
        pm__run_end(&run);
    }
    check_mean("bias over its law", along, 0.92, 0.08);
    check_mean("its square over that of the law", squares, 0.85, 0.15);
    progress_free(p);
}
END_TEST

/* ---- Series ------------------------------------------------------------------------------------ */

typedef struct asked {
    const char *scene, *method;
    size_t k;
    double error;
    uint32_t passes;
} asked;

static pm__converge_row last_row(const asked *a, bool *reached)
{
    progress *const p = progress_create(a->scene, a->method, "disc", 0.0);
    p->config.width = p->config.height = 24;
    p->config.photons = 10000;
    p->config.k = a->k;
    p->config.parallel = &picture_two_threads;
    const pm__converge_config config = {
        .progressive = p->config, .trials = RUNS, .passes = a->passes, .error = a->error};
    pm__converge_series series;
    pm_error error = {""};
    PM_CHECK_OK(pm__converge(&config, &series, &error), error);
    const pm__converge_row row = series.rows[series.row_count - 1];
    *reached = series.reached;
    pm__converge_free(&series);
    pm_estimator_destroy(p->kernel);
    free(p);
    return row;
}

static void check_estimate(const asked *a)
{
    bool reached;
    const pm__converge_row row = last_row(a, &reached);
    const double mean = row.estimated_rel_rmse_mean, first = row.estimated_rel_rmse;
    ck_assert(!reached && row.pass == a->passes);
    ck_assert_msg(fabs(first / row.rel_rmse - 1.0) < 0.2 && fabs(mean / row.rel_rmse - 1.0) < 0.2,
                  "%s, %s: error %g, estimated %g, in the mean %g", a->scene, a->method, row.rel_rmse, first, mean);
    ck_assert_msg(row.estimate_right >= 0.85, "%s, %s: right at %g", a->scene, a->method, row.estimate_right);
}

#define NEVER 1e-9

START_TEST(estimates_are_right)
{
    static const char *const scenes[] = {"scene:point-light", "scene:plate", "scene:water", "scene:nephroid"};
    for (size_t s = 0; s < 4; s++) {
        const asked a = {scenes[s], "ppm", 50, NEVER, 32};
        check_estimate(&a);
    }
    static const char *const methods[] = {"sppm", "pppm", "appm", "light"};
    for (size_t m = 0; m < 4; m++) {
        const asked a = {"scene:point-light", methods[m], 50, NEVER, 32};
        check_estimate(&a);
    }
}
END_TEST

START_TEST(ends_at_the_error_asked_for)
{
    const asked a = {"scene:plate", "ppm", 150, 0.03, 1000};
    bool reached;
    const pm__converge_row row = last_row(&a, &reached);
    ck_assert(reached && row.pass >= 8 && row.pass < 1000);
    ck_assert_double_le(row.estimated_rel_rmse, 0.03);
    ck_assert_msg(fabs(row.rel_rmse / 0.03 - 1.0) < 0.25, "error %g after %u passes", row.rel_rmse, row.pass);
}
END_TEST

PM_TEST_MAIN("own error", even_light_has_noise_alone, bias_is_that_of_the_curvature, estimates_are_right,
             ends_at_the_error_asked_for)
