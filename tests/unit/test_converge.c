/* What converge makes of errors, and the law that it sets beside them, against formulas written out here. */
#include "../../src/converge/measure.h"
#include "../progress.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- Slopes ------------------------------------------------------------------------------------ */

START_TEST(a_line_has_its_slope)
{
    const double x[] = {0.0, 1.0, 2.5, 7.0}, y[] = {3.0, 2.3, 1.25, -1.9};
    PM_CHECK_NEAR(pm__slope(x, y, 4), -0.7, 1e-14);
    const double bent[] = {0.0, 1.0, 0.0, 1.0}, even[] = {0.0, 1.0, 2.0, 3.0};
    PM_CHECK_NEAR(pm__slope(even, bent, 4), 0.2, 1e-14);
}
END_TEST

enum { TRIALS = 6, VALUES = 9, RECORDS = 5 };

/* Errors of known size: noise that falls as pass^-0.35, and a bias along a profile that falls as pass^-0.3. Each value
 * has noise of its own, whose sum over trials is 0, so that moments come out as they were put in. */
typedef struct made_up {
    float errors[TRIALS * RECORDS * VALUES];
    double profile[RECORDS * VALUES];
    uint32_t passes[RECORDS];
} made_up;

static double noise_of(size_t trial, size_t value)
{
    return sin(1.0 + 2.0 * pi * (double)(trial * (1 + value % 2)) / TRIALS + (double)value);
}

static pm__record_set make_errors(made_up *m, double bias)
{
    for (size_t r = 0; r < RECORDS; r++) {
        m->passes[r] = 4u << r;
        const double pass = (double)m->passes[r];
        for (size_t v = 0; v < VALUES; v++) {
            const double profile = 0.1 * ((double)v - 2.0) * pow(pass, -0.3);
            m->profile[r * VALUES + v] = profile;
            for (size_t t = 0; t < TRIALS; t++)
                m->errors[(t * RECORDS + r) * VALUES + v] =
                    (float)(bias * profile + 0.01 * pow(pass, -0.35) * noise_of(t, v));
        }
    }
    return (pm__record_set){.errors = m->errors, .passes = m->passes, .records = RECORDS, .trials = TRIALS,
                            .values = VALUES, .profile = m->profile, .scale = 2.0};
}

static void make_law(const made_up *m, double law[PM__QUANTITIES][PM__MOST_RECORDS])
{
    for (size_t r = 0; r < RECORDS; r++) {
        const double pass = (double)m->passes[r];
        law[PM__VARIANCE][r] = 0.3 * pow(pass, -0.7);
        law[PM__BIAS][r] = 0.2 * pow(pass, -0.3);
        law[PM__RMSE][r] = pow(pass, -0.25);
    }
}

START_TEST(fits_find_what_was_put_in)
{
    made_up m;
    double law[PM__QUANTITIES][PM__MOST_RECORDS];
    pm__converge_fit fits[PM__QUANTITIES];
    pm_error error = {""};
    const pm__record_set set = make_errors(&m, 0.75);
    make_law(&m, law);
    PM_CHECK_OK(pm__fit_all(&set, (const double(*)[PM__MOST_RECORDS])law, fits, &error), error);
    for (int q = 0; q < PM__QUANTITIES; q++) {
        ck_assert_msg(fits[q].fits, "quantity %d: %s", q, fits[q].detail);
        ck_assert_uint_eq(fits[q].first_pass, 4);
        ck_assert_uint_eq(fits[q].last_pass, 64);
        ck_assert(fits[q].slope_ci95.low <= fits[q].slope && fits[q].slope <= fits[q].slope_ci95.high);
    }
    PM_CHECK_NEAR(fits[PM__VARIANCE].slope, -0.7, 1e-4);
    PM_CHECK_NEAR(fits[PM__VARIANCE].predicted, -0.7, 1e-12);
    PM_CHECK_NEAR(fits[PM__BIAS].slope, -0.3, 1e-4); /* a share of 0.75 of it at every pass */
    PM_CHECK_NEAR(fits[PM__BIAS].predicted, -0.3, 1e-12);
    PM_CHECK_NEAR(fits[PM__RMSE].predicted, -0.25, 1e-12);
}
END_TEST

/* The same of each set of trials by itself, the slow way. */
static double variance_without(const pm__record_set *set, size_t record, size_t left)
{
    double sum = 0.0;
    for (size_t v = 0; v < set->values; v++) {
        double mean = 0.0, n = 0.0, squares = 0.0;
        for (size_t t = 0; t < set->trials; t++)
            if (t != left) {
                mean += (double)set->errors[(t * set->records + record) * set->values + v];
                n += 1.0;
            }
        mean /= n;
        for (size_t t = 0; t < set->trials; t++)
            if (t != left) {
                const double d = (double)set->errors[(t * set->records + record) * set->values + v] - mean;
                squares += d * d;
            }
        sum += squares / (n - 1.0) / (double)set->values;
    }
    return sum;
}

START_TEST(intervals_leave_trials_out)
{
    made_up m;
    double law[PM__QUANTITIES][PM__MOST_RECORDS], slope[TRIALS], mean = 0.0, squares = 0.0;
    pm__converge_fit fits[PM__QUANTITIES];
    pm_error error = {""};
    const pm__record_set set = make_errors(&m, 0.1);
    make_law(&m, law);
    for (size_t t = 0; t < TRIALS; t++) /* no two trials alike in how their noise falls */
        for (size_t r = 0; r < RECORDS; r++)
            for (size_t v = 0; v < VALUES; v++)
                m.errors[(t * RECORDS + r) * VALUES + v] *= (float)(1.0 + 0.05 * (double)(t * r));
    PM_CHECK_OK(pm__fit_all(&set, (const double(*)[PM__MOST_RECORDS])law, fits, &error), error);
    for (size_t t = 0; t < TRIALS; t++) {
        double x[RECORDS], y[RECORDS];
        for (size_t r = 0; r < RECORDS; r++) {
            x[r] = log((double)m.passes[r]);
            y[r] = log(variance_without(&set, r, t));
        }
        slope[t] = pm__slope(x, y, RECORDS);
        mean += slope[t] / TRIALS;
    }
    for (size_t t = 0; t < TRIALS; t++)
        squares += (slope[t] - mean) * (slope[t] - mean);
    PM_CHECK_NEAR(fits[PM__VARIANCE].slope_error, sqrt((TRIALS - 1.0) / TRIALS * squares), 1e-9);
    const double half = pm__student_quantile(0.975, TRIALS - 1.0) * fits[PM__VARIANCE].slope_error;
    PM_CHECK_NEAR(fits[PM__VARIANCE].slope_ci95.high - fits[PM__VARIANCE].slope, half, 1e-12);
}
END_TEST

START_TEST(a_bias_within_noise_has_no_fit)
{
    made_up m;
    double law[PM__QUANTITIES][PM__MOST_RECORDS];
    pm__converge_fit fits[PM__QUANTITIES];
    pm_error error = {""};
    const pm__record_set set = make_errors(&m, 0.0);
    make_law(&m, law);
    PM_CHECK_OK(pm__fit_all(&set, (const double(*)[PM__MOST_RECORDS])law, fits, &error), error);
    ck_assert(!fits[PM__BIAS].fits);
    ck_assert_ptr_nonnull(strstr(fits[PM__BIAS].detail, "standard errors clear"));
    ck_assert(fits[PM__VARIANCE].fits);
}
END_TEST

START_TEST(bias_is_taken_along_its_profile)
{
    made_up m;
    double without[TRIALS], mean = 0.0;
    pm__record_set set = make_errors(&m, 0.6);
    const pm__along along = pm__bias_along(&set, 2, without);
    PM_CHECK_NEAR(along.value, 0.6, 1e-6);
    for (size_t t = 0; t < TRIALS; t++)
        mean += without[t] / TRIALS;
    PM_CHECK_NEAR(mean, along.value, 1e-12);
    set.profile = NULL; /* then the mean over values, scaled */
    double sum = 0.0;
    for (size_t v = 0; v < VALUES; v++)
        sum += 0.6 * m.profile[2 * VALUES + v] / VALUES;
    PM_CHECK_NEAR(pm__bias_along(&set, 2, without).value, 2.0 * sum, 1e-6);
}
END_TEST

/* ---- The law ----------------------------------------------------------------------------------- */

/* Even light: a disc of the radius R holds each of the N photons with p = pi R^2 E / power, whatever there is of other
 * passes, so passes have the variance N p (1 - p) of their counts, and no bias. R_j^2 = R_0^2 Gamma(j + a) / (Gamma(a)
 * j!). Albedo 1/2: E = 2 pi, and 2 pi^2 of each band's power of 4 pi^2 falls on the wall twice. */
static double even_variance(double alpha, double first2, size_t photons, uint32_t passes)
{
    const double e = 2.0 * pi, power = 4.0 * pi * pi, brdf = 0.5 / pi;
    double share = 1.0, sum = 0.0;
    for (uint32_t j = 0; j < passes; j++) {
        const double area = pi * first2 * share, p = area * e / power, flux = power / (double)photons;
        sum += (double)photons * p * (1.0 - p) * flux * flux / (area * area);
        share *= (j + alpha) / (j + 1.0);
    }
    return brdf * brdf * sum / ((double)passes * passes);
}

START_TEST(passes_add_up_under_even_light)
{
    const uint32_t passes[] = {1, 2, 5, 32, 100, 700, 5000};
    enum { COUNT = sizeof passes / sizeof *passes };
    const double alphas[] = {0.5, 0.667, 0.8};
    pm_error error = {""};
    for (size_t a = 0; a < 3; a++) {
        progress *const p = progress_create("scene:furnace", "ppm", "disc", 0.1);
        p->config.alpha = alphas[a];
        progress_open(p);
        pm__expectation expectation;
        PM_CHECK_OK(pm__expectation_create(&p->progression, passes, COUNT, &expectation, &error), error);
        ck_assert_uint_eq(expectation.lawful_count, p->progression.points);
        for (size_t r = 0; r < COUNT; r++)
            for (size_t i = 0; i < p->progression.points; i += 7) {
                const size_t at = r * p->progression.points + i;
                PM_CHECK_NEAR(expectation.bias[at], 0.0, 1e-6);
                PM_CHECK_NEAR(expectation.variance[at] / even_variance(alphas[a], 0.01, 2000, passes[r]), 1.0, 2e-3);
            }
        pm__expectation_destroy(&expectation);
        progress_free(p);
    }
}
END_TEST

/* The foot of a point light: E = P h / (4 pi (h^2 + s^2)^1.5), whose mean over the disc of the radius R about it is
 * P / (2 pi R^2) (1 - h / sqrt(h^2 + R^2)). One pass has that bias, later ones that of their radius. */
START_TEST(bias_follows_the_irradiance)
{
    const uint32_t passes[] = {1, 3};
    pm_error error = {""};
    progress *const p = progress_create("scene:point-light", "ppm:start=first", "disc", 0.3);
    p->config.width = p->config.height = 1;
    progress_open(p);
    const pm__hit_point *const foot = &p->progression.fixed[0];
    pm__expectation expectation;
    PM_CHECK_OK(pm__expectation_create(&p->progression, passes, 2, &expectation, &error), error);
    ck_assert_ptr_nonnull(expectation.lawful);
    pm__probe probe = {.position = {foot->position[0], foot->position[1], foot->position[2]}, .normal = {0, 0, 1}};
    const pm__case *const subject = p->progression.stage.subject;
    const double truth = subject->truth(p->progression.stage.values, &probe);
    const pm__shape shape = {PM_LOOKUP_SPHERE, 0.0, false};
    double brdf[3], sum = 0.0;
    pm__hit_point_brdf(foot, foot->normal, brdf);
    const double radius2[3] = {0.09, 0.09, 0.09 * (1.0 + p->config.alpha) / 2.0};
    for (int j = 0; j < 3; j++) {
        const double mean = subject->mass(p->progression.stage.values, &probe, &shape, 0.0, sqrt(radius2[j])) /
                            (pi * radius2[j]);
        sum += (mean - truth) * brdf[0];
        if (j == 0)
            PM_CHECK_NEAR(expectation.bias[0], sum, 1e-6 * truth);
    }
    PM_CHECK_NEAR(expectation.bias[1], sum / 3.0, 1e-4 * fabs(sum));
    pm__expectation_destroy(&expectation);
    progress_free(p);
}
END_TEST

/* No law: light in bands of its own, a method that decides by what it finds, samples that are not independent. */
START_TEST(what_has_no_law_says_so)
{
    const struct {
        const char *scene, *method, *kernel;
    } lawless[] = {{"scene:prism", "ppm", "disc"}, {"scene:plate", "appm", "disc"}, {"scene:plate", "light", "disc"},
                   {"scene:cornell-diffuse", "ppm", "disc"}};
    const uint32_t passes[] = {1, 2};
    pm_error error = {""};
    for (size_t i = 0; i < sizeof lawless / sizeof *lawless; i++) {
        progress *const p = progress_open(progress_create(lawless[i].scene, lawless[i].method, lawless[i].kernel, 0.1));
        pm__expectation expectation;
        PM_CHECK_OK(pm__expectation_create(&p->progression, passes, 2, &expectation, &error), error);
        ck_assert_msg(!expectation.lawful, "%s by %s", lawless[i].scene, lawless[i].method);
        pm__expectation_destroy(&expectation);
        progress_free(p);
    }
}
END_TEST

/* ---- The truth of a pixel ---------------------------------------------------------------------- */

typedef struct ways {
    double weight, reached;
    size_t count;
} ways;

static void add_way(void *context, const pm__eye *eye, bool reached)
{
    ways *const w = context;
    w->count++;
    w->weight += reached ? eye->weight[0] : 0.0;
    w->reached += reached;
}

/* Through a plate the ways are those of R and T at two faces: light reaches the floor with T^2 (1 + R^2 + R^4 + ...) =
 * T / (1 + R), T = 1 - R, seen straight down R = 0.04. */
START_TEST(all_ways_through_a_plate)
{
    progress *const p = progress_create("scene:plate", "sppm", "disc", 0.1);
    pm__view down = {.eye = {0, 0, 3}, .at = {0, 0, 0}, .up = {0, 1, 0}, .angle = 1e-3};
    p->config.view = &down;
    p->config.width = p->config.height = 1;
    progress_open(p);
    pm__eye eye;
    ways all = {0.0, 0.0, 0};
    pm__run_eye(&p->progression, 1, 0, 0, true, &eye);
    pm__eye_follow_all(&eye, 1e-9, add_way, &all);
    PM_CHECK_NEAR(all.weight, 0.96 / 1.04, 1e-7);
    ck_assert_double_ge(all.reached, 4.0);
    ways few = {0.0, 0.0, 0};
    pm__eye_follow_all(&eye, 0.3, add_way, &few); /* within the glass 0.96 / 1.5^2 */
    PM_CHECK_NEAR(few.weight, 0.96 * 0.96, 1e-7); /* the one that carries most */
    progress_free(p);
}
END_TEST

PM_TEST_MAIN("converge", a_line_has_its_slope, fits_find_what_was_put_in, intervals_leave_trials_out,
             a_bias_within_noise_has_no_fit, bias_is_taken_along_its_profile, passes_add_up_under_even_light,
             bias_follows_the_irradiance, what_has_no_law_says_so, all_ways_through_a_plate)
