/* What runs say of their own error, against sums written out here; and what they say it with: the blur of kernels and
 * the Laplacian. The furnace's wall reflects 1 W/(m2 sr) by a BRDF of 0.5 / pi. */
#include "../../src/methods/progressive/curvature.h"
#include "../../src/stats/stats.h"
#include "../progress.h"

static const double pi = 3.14159265358979323846;

/* ---- Kernels ----------------------------------------------------------------------------------- */

/* w = 1: 1 and 1/2. w = 1 - s: c = 1/2, so 4/3 and 1/3. */
START_TEST(blur_of_kernels)
{
    static const struct {
        const char *name;
        double square, moment;
    } want[] = {{"disc", 1.0, 0.5}, {"epanechnikov", 4.0 / 3.0, 1.0 / 3.0}};
    for (size_t i = 0; i < 2; i++) {
        pm_error error = {""};
        pm_estimator *kernel = NULL;
        PM_CHECK_OK(pm_estimator_create(want[i].name, &kernel, &error), error);
        const pm__blur blur = pm__blur_of(kernel);
        PM_CHECK_NEAR(blur.square, want[i].square, 1e-12);
        PM_CHECK_NEAR(blur.moment, want[i].moment, 1e-12);
        pm_estimator_destroy(kernel);
    }
}
END_TEST

/* integral of f(rho) 2 pi rho drho over the radius r, by the midpoint rule in s = rho^2 / r^2. */
static double integrate(double r, int power_of_rho, int power_of_curving)
{
    enum { STEPS = 200000 };
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double s = (i + 0.5) / STEPS;
        sum += pow(s * r * r, 0.5 * power_of_rho) * pow(pm__curving(s, r * r), power_of_curving);
    }
    return sum * pi * r * r / STEPS;
}

/* The Laplacian of 1 is 0, that of rho^2 is 4; of rho^4 it is 16 rho^2, and smoothed 0.05 r^2 times 64, its own. The
 * midpoint rule is right to 1e-9 here. */
START_TEST(laplacian_of_polynomials)
{
    const double r = 0.7;
    PM_CHECK_NEAR(integrate(r, 0, 1) * r * r, 0.0, 1e-7);
    PM_CHECK_NEAR(integrate(r, 2, 1), 4.0, 1e-7);
    PM_CHECK_NEAR(integrate(r, 4, 1), 0.05 * r * r * 64.0, 1e-7);
    PM_CHECK_NEAR(integrate(r, 0, 2) * pow(r, 6.0), 48.0 * 48.0 / pi * 2.0 / 15.0, 1e-6);
}
END_TEST

/* ---- Sums over passes -------------------------------------------------------------------------- */

enum { PASSES = 7, POINT = 21 };

static double mean_of(const double *values)
{
    double sum = 0.0;
    for (int j = 0; j < PASSES; j++)
        sum += values[j] / PASSES;
    return sum;
}

static double variance_of_mean(const double *values)
{
    double sum = 0.0;
    for (int j = 0; j < PASSES; j++)
        sum += (values[j] - mean_of(values)) * (values[j] - mean_of(values));
    return sum / (PASSES * (PASSES - 1.0));
}

/* A pass's estimate of radiance by a disc, and of its bias by all photons within twice the radius, one by one. */
static void look_around(const pm__photon_set *set, const double position[3], double radius, double *x, double *bias)
{
    const double far2 = 4.0 * radius * radius, share = 0.5 / pi;
    *x = *bias = 0.0;
    for (size_t i = 0; i < set->count; i++) {
        const double power = (double)set->photons[i].power[0];
        double d2 = 0.0;
        for (int a = 0; a < 3; a++) {
            const double d = (double)set->photons[i].position[a] - position[a];
            d2 += d * d;
        }
        if (d2 <= radius * radius)
            *x += share * power / (pi * radius * radius);
        if (d2 <= far2)
            *bias += radius * radius / 8.0 * share * power * 48.0 / pi * (1.0 - d2 / far2) * (3.0 * d2 / far2 - 1.0) /
                     (far2 * far2);
    }
}

static progress *estimating(const char *scene, const char *method, double radius)
{
    progress *const p = progress_create(scene, method, "disc", radius);
    p->config.estimates = true;
    return p;
}

/* Positions and radii are rounded to single precision, and the terms of the bias cancel: 1e-5 of what they are. */
START_TEST(sums_are_those_of_passes)
{
    progress *const p = progress_open(estimating("scene:furnace", "ppm", 0.25));
    pm__run run = progress_begin(p, 0);
    double x[PASSES], bias[PASSES];
    for (uint32_t j = 0; j < PASSES; j++) {
        const pm__shoot_config shooting = {.scene = p->progression.stage.scene, .paths = p->progression.paths,
                                           .seed = run.seed, .trial = j, .count = p->config.photons, .emitted = true};
        pm__photon_set set = lit_shoot(&shooting);
        look_around(&set, p->progression.fixed[POINT].position, pm__run_view(&run, POINT).radius, &x[j], &bias[j]);
        pm__photon_set_free(&set);
        progress_pass(&run, 1);
    }
    const pm__own_error own = pm__run_own_error(&run, POINT);
    const double t = pm__student_quantile(0.95, PASSES - 1.0);
    PM_CHECK_NEAR(own.variance / variance_of_mean(x), 1.0, 1e-5);
    PM_CHECK_NEAR(own.bias_variance / variance_of_mean(bias), 1.0, 1e-5);
    for (int b = 0; b < 3; b++)
        PM_CHECK_NEAR(own.bias[b], mean_of(bias), 1e-5 * sqrt(PASSES * variance_of_mean(bias)));
    PM_CHECK_NEAR(pm__run_own_bound(&run, POINT, 0.9), t * sqrt(own.variance) + fabs(own.bias[0]), 1e-12);
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

/* Where points are drawn anew, by what answers say: x_j = j a_j - (j - 1) a_(j-1), lights seen among it. */
static void check_by_answers(const char *scene, const char *method)
{
    progress *const p = progress_open(estimating(scene, method, 0.0));
    pm__run run = progress_begin(p, 0);
    const size_t points = p->progression.points;
    double(*const x)[3][PASSES] = calloc(points, sizeof *x), answer = 0.0, variance = 0.0, bias = 0.0;
    for (int j = 0; j < PASSES; j++) {
        progress_pass(&run, 1);
        double(*const radiance)[3] = progress_read(&run);
        for (size_t i = 0; i < points; i++)
            for (int b = 0; b < 3; b++) {
                x[i][b][j] = radiance[i][b] * (j + 1.0);
                for (int before = 0; before < j; before++)
                    x[i][b][j] -= x[i][b][before];
                answer += j == PASSES - 1 ? radiance[i][b] / 3.0 : 0.0;
            }
        free(radiance);
    }
    for (size_t i = 0; i < points; i++) {
        const pm__own_error own = pm__run_own_error(&run, i);
        double want = 0.0;
        for (int b = 0; b < 3; b++) {
            want += variance_of_mean(x[i][b]) / 3.0;
            bias += own.bias[b] * own.bias[b] / 3.0;
        }
        PM_CHECK_NEAR(own.variance, want, 1e-9 * want + 1e-18);
        variance += own.variance;
        bias -= own.bias_variance;
    }
    const double want = sqrt((variance + fmax(bias, 0.0)) / (double)points) / (answer / (double)points);
    PM_CHECK_NEAR(pm__run_own_rel_rmse(&run, NULL, 0) / want, 1.0, 1e-12);
    free(x);
    pm__run_end(&run);
    progress_free(p);
}

START_TEST(sums_are_those_of_answers)
{
    static const char *const methods[] = {"ppm", "ppm:start=first", "sppm", "pppm", "appm", "light"};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        check_by_answers("scene:furnace", methods[m]);
        check_by_answers("scene:point-light", methods[m]);
    }
    check_by_answers("scene:point-light", "path");
}
END_TEST

/* ---- What there is no estimate of -------------------------------------------------------------- */

START_TEST(nothing_is_known_before_two_passes)
{
    progress *const p = progress_open(estimating("scene:furnace", "pppm", 0.25));
    pm__run run = progress_begin(p, 0);
    for (int j = 0; j < 2; j++) {
        ck_assert(isnan(pm__run_own_rel_rmse(&run, NULL, 0)));
        ck_assert(isnan(pm__run_own_bound(&run, POINT, 0.9)));
        ck_assert(isnan(pm__run_own_error(&run, POINT).variance));
        progress_pass(&run, 1);
    }
    ck_assert_double_gt(pm__run_own_rel_rmse(&run, NULL, 0), 0.0);
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

/* A path tracer never finds a point light through glass: an error of nothing would be a lie. */
START_TEST(black_has_no_relative_error)
{
    progress *const p = progress_open(estimating("scene:plate", "path", 0.0));
    pm__run run = progress_begin(p, 0);
    progress_pass(&run, 3);
    ck_assert(isnan(pm__run_own_rel_rmse(&run, NULL, 0)));
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

START_TEST(other_answers_are_refused)
{
    static const char *const methods[] = {"pm", "pm-combine", "ppm:flux=printed", "sppm:flux=printed"};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        progress *const p = estimating("scene:furnace", methods[m], 0.0);
        pm_error error = {""};
        ck_assert_int_eq(pm__progression_open(&p->config, &p->progression, &error), PM_EINVAL);
        ck_assert_ptr_nonnull(strstr(error.text, "cannot estimate its own error"));
        pm_estimator_destroy(p->kernel);
        free(p);
    }
}
END_TEST

/* ---- State ------------------------------------------------------------------------------------- */

/* Asked or not, the answer is the same; taken up again, so are the estimates; on two threads too. */
START_TEST(state_holds_all)
{
    static const char *const methods[] = {"ppm", "appm"};
    for (size_t m = 0; m < 2; m++) {
        progress *const p = estimating("scene:plate", methods[m], 0.0), *const plain =
            progress_open(progress_create("scene:plate", methods[m], "disc", 0.0));
        p->config.width = p->config.height = 20; /* more than one task */
        plain->config.width = plain->config.height = 20;
        progress_open(p);
        pm__progression_close(&plain->progression);
        progress_open(plain);
        pm__run whole = progress_begin(p, 1), half = progress_begin(p, 1), none = progress_begin(plain, 1);
        progress_pass(&whole, 5);
        progress_pass(&none, 5);
        const size_t bytes = pm__run_state_count(&p->progression) * sizeof(double);
        ck_assert_mem_eq(none.state, whole.state, pm__run_state_count(&plain->progression) * sizeof(double));
        ck_assert_uint_eq(bytes / sizeof(double),
                          pm__run_state_count(&plain->progression) + 8 * p->progression.points);
        p->config.parallel = &picture_two_threads;
        progress_pass(&half, 3);
        double *const saved = malloc(bytes);
        ck_assert_ptr_nonnull(saved);
        memcpy(saved, half.state, bytes);
        pm__run_end(&half);
        half = progress_begin(p, 1);
        pm_error error = {""};
        PM_CHECK_OK(pm__run_resume(&half, saved, 3, &error), error);
        progress_pass(&half, 2);
        ck_assert_mem_eq(half.state, whole.state, bytes);
        free(saved);
        pm__run_end(&whole);
        pm__run_end(&half);
        pm__run_end(&none);
        progress_free(p);
        progress_free(plain);
    }
}
END_TEST

PM_TEST_MAIN("own error", blur_of_kernels, laplacian_of_polynomials, sums_are_those_of_passes,
             sums_are_those_of_answers, nothing_is_known_before_two_passes, black_has_no_relative_error,
             other_answers_are_refused, state_holds_all)
