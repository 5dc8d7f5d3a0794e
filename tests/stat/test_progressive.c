/* Progressive methods against their laws. Trials are the replicates; Student's bound for a false alarm in 1e-6 over the
 * file (CHECKS comparisons, two-sided). The furnace reflects 1 W/(m2 sr) evenly and shines as much itself. */
#include "../../src/stats/stats.h"
#include "../progress.h"

enum { TRIALS = 16, CHECKS = 40 };

static const double pi = 3.14159265358979323846;
static const double two_thirds = 2.0 / 3.0;

typedef struct sample {
    double values[TRIALS];
} sample;

static void check_mean(const char *what, const sample *of, double want, double allowed)
{
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < TRIALS; i++)
        mean += of->values[i] / TRIALS;
    for (int i = 0; i < TRIALS; i++)
        square += (of->values[i] - mean) * (of->values[i] - mean);
    const double error = sqrt(square / (TRIALS * (TRIALS - 1.0)));
    const double bound = pm__student_quantile(1.0 - 0.5e-6 / CHECKS, TRIALS - 1.0);
    ck_assert_msg(fabs(mean - want) <= allowed + bound * error, "%s: %.6f, expected %.6f within %.6f + %.1f x %.6f",
                  what, mean, want, allowed, bound, error);
    ck_assert_msg(bound * error < 0.13 * fabs(want), "%s: a standard error of %.6f shows nothing", what, error);
}

/* ---- Even light --------------------------------------------------------------------------------- */

/* What the furnace is seen to reflect after so many passes; radius: as in progress_create. */
static void check_furnace(const char *method, const char *kernel, double radius, uint32_t passes, double want)
{
    progress *const p = progress_create("scene:furnace", method, kernel, radius);
    p->config.width = 20;
    p->config.height = 16;
    p->config.photons = 1000;
    progress_open(p);
    sample answers;
    for (uint32_t t = 0; t < TRIALS; t++) {
        pm__run run = progress_begin(p, t);
        progress_pass(&run, passes);
        answers.values[t] = progress_mean(&run) - 1.0;
        pm__run_end(&run);
    }
    check_mean(method, &answers, want, 1e-4); /* positions in single precision */
    progress_free(p);
}

/* Radii depend on the past alone, so that nothing is biased, after one pass or several. */
START_TEST(even_light_is_unbiased)
{
    static const char *const methods[] = {"ppm", "ppm:start=first", "sppm", "pppm", "appm"};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        check_furnace(methods[m], "disc", 0.4, 1, 1.0);
        check_furnace(methods[m], "epanechnikov", 0.4, 12, 1.0);
    }
}
END_TEST

/* 10 photons a pass. One photon in k is the search's own (errata 1, 31); the sum of areas of M passes is a Gamma
 * variable of M k. */
START_TEST(levels_of_maps_of_k_photons)
{
    check_furnace("pm-average", "disc", 0.0, 12, 10.0 / 9.0);
    check_furnace("pm-average", "disc:last=none", 0.0, 12, 1.0);
    check_furnace("pm-combine", "disc", 0.0, 12, 120.0 / 119.0);
    check_furnace("pm-combine", "disc:last=none", 0.0, 12, 108.0 / 119.0);
    check_furnace("pm-combine", "epanechnikov", 0.0, 12, 108.0 / 119.0);
    check_furnace("pm:beta=0", "disc", 0.0, 8, 10.0 / 9.0);
    check_furnace("pm:beta=0.667", "disc", 0.0, 8, 40.0 / 39.0);
}
END_TEST

/* ---- Radii -------------------------------------------------------------------------------------- */

static sample radii_of(const char *method, uint32_t passes)
{
    progress *const p = progress_open(progress_create("scene:furnace", method, "disc", 0.5));
    sample radii;
    for (uint32_t t = 0; t < TRIALS; t++) {
        pm__run run = progress_begin(p, t);
        progress_pass(&run, passes);
        radii.values[t] = progress_radius2(&run) / 0.25;
        pm__run_end(&run);
    }
    progress_free(p);
    return radii;
}

/* R_i^2 / R_0^2 = Gamma(i + a) / (Gamma(a) i!), and 1/a times that where the first pass keeps its radius. Photons of a
 * pass vary by 1/M, M = 250 within the first radius (4000 on the sphere, r^2/4 of it): the share (N + a M) / (N + M) is
 * convex, and moves by less than a (1 - a) / M a pass, falling as passes add up. Allowed: 2 / M. */
START_TEST(radii_follow_their_law)
{
    for (uint32_t i = 1; i <= 16; i *= 4) {
        const double law = tgamma(i + two_thirds) / (tgamma(two_thirds) * tgamma(i + 1.0));
        const sample zero = radii_of("ppm", i), first = radii_of("ppm:start=first", i), shared = radii_of("sppm", i);
        check_mean("ppm", &zero, law, 2.0 / 250.0 * law);
        check_mean("sppm", &shared, law, 2.0 / 250.0 * law);
        check_mean("ppm:start=first", &first, law / two_thirds, 2.0 / 250.0 * law);
    }
}
END_TEST

/* ---- The adaptive radius ------------------------------------------------------------------------ */

/* A small patch of floor, so that a pixel's mean is the value at its middle; the first radius is so many times that of
 * 50 photons. */
static progress *open_patch(const char *scene, const char *method, const pm__view *view, double times)
{
    progress *const p = progress_create(scene, method, "disc", 0.0);
    p->config.view = view;
    p->config.k = 50;
    p->config.photons = 10000;
    progress_open(p);
    for (size_t i = 0; i < p->progression.points; i++)
        p->progression.radius[i] *= (float)times;
    return p;
}

static double relative_error(const progress *p, pm__run *run)
{
    double(*const radiance)[3] = progress_read(run);
    double error = 0.0, truth = 0.0;
    for (size_t i = 0; i < p->progression.points; i++) {
        const pm__hit_point *const point = &p->progression.fixed[i];
        double brdf[3], right[3];
        pm__hit_point_brdf(point, point->normal, brdf);
        pm__stage_truth(&p->progression.stage, point->position, point->normal, point->outgoing, brdf, right);
        error += (radiance[i][0] - right[0]) * (radiance[i][0] - right[0]);
        truth += right[0] * right[0];
    }
    free(radiance);
    return sqrt(error / truth);
}

static double error_of(const char *scene, const char *method, const pm__view *view, double times)
{
    enum { RUNS = 2, PASSES = 32 };
    progress *const p = open_patch(scene, method, view, times);
    double sum = 0.0;
    for (uint32_t t = 0; t < RUNS; t++) {
        pm__run run = progress_begin(p, t);
        progress_pass(&run, PASSES);
        sum += relative_error(p, &run) / RUNS;
        pm__run_end(&run);
    }
    progress_free(p);
    return sum;
}

static const pm__view at_foot = {.eye = {0, -0.3, 0.5}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.1};
static const pm__view at_caustic = {.eye = {3, 0, -1.2}, .at = {0.3, 0, -2}, .up = {0, 0, 1}, .angle = 0.05};

/* From a first radius that is far too large most of the error of pppm is bias; appm soon leaves it. No bound by chance:
 * half the other's error is many standard errors away. */
START_TEST(appm_leaves_a_bad_first_radius)
{
    const struct {
        const char *scene;
        const pm__view *view;
    } scenes[] = {{"scene:point-light", &at_foot}, {"scene:glass-sphere:d=2", &at_caustic}};
    for (size_t s = 0; s < 2; s++) {
        const double fixed = error_of(scenes[s].scene, "pppm", scenes[s].view, 10.0);
        const double adaptive = error_of(scenes[s].scene, "appm", scenes[s].view, 10.0);
        ck_assert_msg(adaptive < 0.5 * fixed, "%s: %g against %g", scenes[s].scene, adaptive, fixed);
    }
}
END_TEST

/* At the foot of a point light of the height 1 the irradiance is E = 1 / (4 pi) (1 + rho^2)^-3/2 for 1 W, its Laplacian
 * -6 E. With photons of the power f, h_i^6 = (E f / pi) / (6 (6 E / 8)^2 i). Allowed: the Laplacian is that of the
 * irradiance smoothed over b = 2.5 i^(1/15) h, 0.05 b^2 (120 / 6) = b^2 lower (its Laplacian is 120 E): h is larger by
 * b^2 / 3, and by as much again for the passes before, when b was larger. */
static void check_optimum(double times, uint32_t passes)
{
    progress *const p = open_patch("scene:point-light", "appm", &at_foot, times);
    const double irradiance = 0.25 / pi;
    sample logs;
    double power = 0.0;
    for (uint32_t t = 0; t < TRIALS; t++) {
        pm__run run = progress_begin(p, t);
        progress_pass(&run, passes);
        pm__photon_set set = {0};
        pm_error error = {""};
        PM_CHECK_OK(pm__run_shoot(&run, 0, &set, &error), error);
        power = (double)set.photons[0].power[0];
        logs.values[t] = sqrt(progress_radius2(&run));
        pm__photon_set_free(&set);
        pm__run_end(&run);
    }
    const double slope = 0.75 * irradiance, h6 = irradiance * power / pi / (6.0 * slope * slope * (passes + 1.0));
    const double best = pow(h6, 1.0 / 6.0), wide = 2.5 * best * pow(passes, 1.0 / 15.0);
    check_mean("radius at the foot", &logs, best * (1.0 + wide * wide / 3.0), best * wide * wide / 3.0);
    progress_free(p);
}

START_TEST(appm_finds_the_best_radius)
{
    check_optimum(1.0, 48);
    check_optimum(5.0, 48);
}
END_TEST

PM_TEST_MAIN("progressive methods", even_light_is_unbiased, levels_of_maps_of_k_photons, radii_follow_their_law,
             appm_leaves_a_bad_first_radius, appm_finds_the_best_radius)
