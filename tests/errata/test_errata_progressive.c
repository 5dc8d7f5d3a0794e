/* Errata of the progressive methods. The furnace reflects 1 W/(m2 sr) under even light, and shines as much itself.
 * Bounds: Student's for a false alarm in 1e-7 each. */
#include "../../src/stats/stats.h"
#include "../progress.h"

enum { TRIALS = 16 };

/* Reflected, first point, after each pass. */
static void follow(const char *method, uint32_t passes, double *answers)
{
    progress *const p = progress_open(progress_create("scene:furnace", method, "disc", 0.3));
    pm__run run = progress_begin(p, 0);
    for (uint32_t i = 0; i < passes; i++) {
        progress_pass(&run, 1);
        double(*const radiance)[3] = progress_read(&run);
        answers[i] = radiance[0][0] - p->progression.fixed[0].emitted[0];
        free(radiance);
    }
    pm__run_end(&run);
    progress_free(p);
}

/* Flux in print shrinks with the disc but takes no new photons, so it keeps the density of the first pass, and divided
 * by all passes' photons falls as 1/i. The corrected flux stays: within 12 standard errors of 90 photons. */
START_TEST(erratum_27)
{
    enum { PASSES = 5 };
    double printed[PASSES], corrected[PASSES];
    follow("ppm:flux=printed,start=first", PASSES, printed);
    follow("ppm:start=first", PASSES, corrected);
    ck_assert_double_gt(printed[0], 0.0);
    PM_CHECK_NEAR(corrected[0], printed[0], 0.0);
    for (int i = 0; i < PASSES; i++) {
        PM_CHECK_NEAR(printed[i] / printed[0], 1.0 / (i + 1.0), 1e-12);
        PM_CHECK_NEAR(corrected[i], 1.0, 12.0 / sqrt(90.0 * (i + 1.0)));
    }
    ck_assert_double_gt(corrected[PASSES - 1], 2.0 * printed[PASSES - 1]);
}
END_TEST

/* A radius so small that no pass finds a photon: nothing is divided by 0, the radius stays and so does the count. */
START_TEST(erratum_29)
{
    static const char *const methods[] = {"ppm", "ppm:start=first", "sppm"};
    for (size_t m = 0; m < 3; m++) {
        progress *const p = progress_open(progress_create("scene:furnace", methods[m], "disc", 1e-6));
        pm__run run = progress_begin(p, 0);
        progress_pass(&run, 3);
        double(*const radiance)[3] = progress_read(&run);
        for (size_t i = 0; i < p->progression.points; i++) {
            const pm__point_view view = pm__run_view(&run, i);
            PM_CHECK_NEAR(radiance[i][0], p->progression.fixed[i].emitted[0], 0.0);
            PM_CHECK_NEAR(view.radius / 1e-6, 1.0, 1e-6);
            PM_CHECK_NEAR(view.count, 0.0, 0.0);
        }
        free(radiance);
        pm__run_end(&run);
        progress_free(p);
    }
}
END_TEST

typedef struct law {
    double mean, variance; /* over points and trials; the mean of variances of points */
    double mean_error, variance_error; /* standard errors */
} law;

static law law_of(const char *method, uint32_t passes)
{
    progress *const p = progress_create("scene:furnace", method, "disc", 0.0);
    law l = {0};
    double means[TRIALS], squares[TRIALS];
    p->config.width = 20;
    p->config.height = 16;
    progress_open(p);
    const double share = 1.0 / (double)p->config.width / (double)p->config.height;
    for (uint32_t t = 0; t < TRIALS; t++) {
        pm__run run = progress_begin(p, t);
        progress_pass(&run, passes);
        double(*const radiance)[3] = progress_read(&run);
        means[t] = squares[t] = 0.0;
        for (size_t i = 0; i < p->progression.points; i++) {
            means[t] += (radiance[i][0] - 1.0) * share;
            squares[t] += (radiance[i][0] - 1.0) * (radiance[i][0] - 1.0) * share;
        }
        l.mean += means[t] / TRIALS;
        free(radiance);
        pm__run_end(&run);
    }
    for (int t = 0; t < TRIALS; t++)
        l.variance += (squares[t] - 2.0 * means[t] * l.mean + l.mean * l.mean) / TRIALS;
    for (int t = 0; t < TRIALS; t++) {
        const double d = squares[t] - 2.0 * means[t] * l.mean + l.mean * l.mean - l.variance;
        l.mean_error += (means[t] - l.mean) * (means[t] - l.mean) / (TRIALS * (TRIALS - 1.0));
        l.variance_error += d * d / (TRIALS * (TRIALS - 1.0));
    }
    l.mean_error = sqrt(l.mean_error);
    l.variance_error = sqrt(l.variance_error);
    progress_free(p);
    return l;
}

static double bound(void)
{
    return pm__student_quantile(1.0 - 0.5e-7, TRIALS - 1.0);
}

/* k photons of one map have the mean k/(k-1) and the variance mean^2 / (k - 2), however many passes the map is made of:
 * with beta = 0 noise does not fall. k = floor(10 * 8^0.667) = 40 of 8 passes have the variance (40/39)^2 / 38. The
 * photons of a pass vary in number too, by less than 1 in 1000 squared: that is allowed. */
START_TEST(erratum_30)
{
    const law one = law_of("pm:beta=0", 1), still = law_of("pm:beta=0", 8), grown = law_of("pm:beta=0.667", 8);
    const double ten = 100.0 / 81.0 / 8.0, forty = 1600.0 / 1521.0 / 38.0;
    PM_CHECK_NEAR(one.variance, ten, bound() * one.variance_error + 1e-3);
    PM_CHECK_NEAR(still.variance, ten, bound() * still.variance_error + 1e-3);
    PM_CHECK_NEAR(grown.variance, forty, bound() * grown.variance_error + 1e-3);
    ck_assert_double_gt(still.variance, 2.0 * grown.variance);
}
END_TEST

/* 10 photons a pass, whatever the passes: averaged 10/9, pooled 10 M / (10 M - 1), which goes to 1. */
START_TEST(erratum_31)
{
    const law average = law_of("pm-average", 16), pooled = law_of("pm-combine", 16), once = law_of("pm-combine", 1);
    PM_CHECK_NEAR(average.mean, 10.0 / 9.0, bound() * average.mean_error);
    PM_CHECK_NEAR(once.mean, 10.0 / 9.0, bound() * once.mean_error);
    PM_CHECK_NEAR(pooled.mean, 160.0 / 159.0, bound() * pooled.mean_error);
    ck_assert_double_lt(pooled.mean, 0.95 * average.mean);
}
END_TEST

/* What is left is the light's curvature: at the foot of a point light of the height 1 the Laplacian is -6 E, so pooled
 * lookups go to 1 - 6/8 (k + 1)/k of their mean r^2, here to 0.92, however many they are. Allowed: the next order,
 * 5/8 r^4, and as much again for r's spread. */
START_TEST(erratum_31_curved_light)
{
    static const pm__view at_foot = {.eye = {0, -0.3, 0.5}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.1};
    const double brdf = 1.0 / 3.14159265358979323846, truth = 0.25 / 3.14159265358979323846;
    progress *const p = progress_create("scene:point-light", "pm-combine", "disc", 0.0);
    double rest[TRIALS], mean = 0.0, square = 0.0, area = 0.0;
    p->config.view = &at_foot;
    p->config.k = 50;
    progress_open(p);
    for (uint32_t t = 0; t < TRIALS; t++) {
        pm__run run = progress_begin(p, t);
        progress_pass(&run, 128);
        const double r2 = progress_radius2(&run);
        const pm__material *const floor = p->progression.fixed[0].material;
        rest[t] = progress_mean(&run) / (truth * brdf * floor->diffuse[0]) - 1.0 + 0.75 * 51.0 / 50.0 * r2;
        mean += rest[t] / TRIALS;
        area += r2 / TRIALS;
        pm__run_end(&run);
    }
    for (int t = 0; t < TRIALS; t++)
        square += (rest[t] - mean) * (rest[t] - mean);
    const double error = sqrt(square / (TRIALS * (TRIALS - 1.0)));
    PM_CHECK_NEAR(mean, 0.0, bound() * error + 1.25 * area * area);
    ck_assert_double_gt(0.75 * area, 2.0 * (bound() * error + 1.25 * area * area));
    progress_free(p);
}
END_TEST

PM_TEST_MAIN("errata of progressive methods", erratum_27, erratum_29, erratum_30, erratum_31, erratum_31_curved_light)
