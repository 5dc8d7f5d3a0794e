/* The laws behind advice against made-up pilots whose answer is known in closed form, or found by trying all. */
#include "../../src/converge/advise.h"
#include "../../src/converge/advise_law.h"
#include "../../src/cli/parallel.h"
#include "../test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a map costs and how it errs: variance a / (k - 2), bias b s^p of the share s, times per photon and per query. */
typedef struct world {
    double a, b, p;
    double ns_per_photon, ns_first, ns_power; /* a query: ns_first k^ns_power */
} world;

static double bias2_of(const world *w, double share)
{
    return w->b * w->b * pow(share, 2.0 * w->p);
}

static double error_of(const world *w, double k, double photons)
{
    return sqrt(w->a / (k - 2.0) + bias2_of(w, k / photons));
}

static double seconds_of(const world *w, double k, double photons, double queries)
{
    return 1e-9 * (photons * w->ns_per_photon + queries * w->ns_first * pow(k, w->ns_power));
}

static pm__map_sample sample_of(const world *w, double k, double photons)
{
    const double bias2 = bias2_of(w, k / photons);
    return (pm__map_sample){.k = k, .photons = photons, .variance = w->a / (k - 2.0), .bias2 = bias2,
                            .bias2_error = 0.01 * bias2, .ns_per_query = w->ns_first * pow(k, w->ns_power),
                            .ns_per_photon = w->ns_per_photon};
}

static pm__map_law law_of(const world *w)
{
    pm__map_law law = {.count = 0};
    for (double k = 32.0; k <= 2048.0; k *= 2.0) {
        const pm__map_sample sample = sample_of(w, k, 32768.0);
        ck_assert(pm__map_law_add(&law, &sample));
    }
    return law;
}

static const world curved = {1.3, 4.0, 1.0, 300.0, 40.0, 0.8}, abrupt = {1.1, 0.6, 0.25, 500.0, 20.0, 1.0};
static const pm__map_limits free_limits = {2048.0, 5.0, 1e12};

/* Pilots that follow the laws to the letter are continued by them. */
START_TEST(laws_are_continued)
{
    static const double shares[] = {1e-6, 1e-4, 0.003, 0.05};
    const world *const worlds[] = {&curved, &abrupt};
    for (int i = 0; i < 2; i++) {
        const world *const w = worlds[i];
        const pm__map_law law = law_of(w);
        for (int j = 0; j < 4; j++) {
            PM_CHECK_NEAR(pm__map_bias2(&law, shares[j]) / bias2_of(w, shares[j]), 1.0, 1e-9);
            PM_CHECK_NEAR(pm__map_variance(&law, 5000.0, 5000.0 / shares[j]) * 4998.0 / w->a, 1.0, 1e-12);
            PM_CHECK_NEAR(pm__map_seconds(&law, 5000.0, 1e6, 2048.0) / seconds_of(w, 5000.0, 1e6, 2048.0), 1.0, 1e-9);
        }
    }
}
END_TEST

/* The least time over all whole k and all numbers of photons that reach the error. */
static double cheapest(const world *w, double error, double queries)
{
    double least = INFINITY;
    for (double k = 5.0; k < 40000.0; k++) {
        const double left = error * error - w->a / (k - 2.0);
        if (left <= 0.0)
            continue;
        const double share = fmin(pow(left / (w->b * w->b), 0.5 / w->p), 1.0 / 16.0);
        least = fmin(least, seconds_of(w, k, ceil(k / share), queries));
    }
    return least;
}

START_TEST(the_cheapest_is_found)
{
    static const double errors[] = {0.02, 0.05, 0.1, 0.3};
    const world *const worlds[] = {&curved, &abrupt};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 4; j++) {
            const world *const w = worlds[i];
            const pm__map_law law = law_of(w);
            const pm__map_choice c = pm__map_solve(&law, &free_limits, errors[j]);
            ck_assert(c.reachable);
            ck_assert_double_eq(c.k, floor(c.k));
            ck_assert_double_eq(c.photons, floor(c.photons));
            /* a whole k: the error is met to half a photon */
            PM_CHECK_NEAR(error_of(w, c.k, c.photons) / errors[j], 1.0, 0.6 / c.k);
            PM_CHECK_NEAR(c.rel_rmse, error_of(w, c.k, c.photons), 1e-9);
            PM_CHECK_NEAR(c.seconds / seconds_of(w, c.k, c.photons, free_limits.queries), 1.0, 1e-9);
            /* shares are tried in steps of a quarter of an octave */
            ck_assert_double_le(c.seconds, 1.02 * cheapest(w, errors[j], free_limits.queries) * (1.0 + 1.0 / c.k));
        }
}
END_TEST

/* Queries that cost nothing: N = A / (s (E^2 - b^2 s^2p)) is least where E^2 = (1 + 2p) B^2. */
START_TEST(free_queries_have_a_closed_form)
{
    const pm__map_law law = law_of(&abrupt);
    const pm__map_limits limits = {0.0, 5.0, 1e12};
    const pm__map_choice c = pm__map_solve(&law, &limits, 0.05);
    const double bias2 = 0.05 * 0.05 / (1.0 + 2.0 * abrupt.p);
    const double share = pow(bias2 / (abrupt.b * abrupt.b), 0.5 / abrupt.p);
    const double photons = (2.0 + abrupt.a / (0.05 * 0.05 - bias2)) / share;
    PM_CHECK_NEAR(log2(c.k / c.photons / share), 0.0, 0.25);
    ck_assert_double_ge(c.photons, 0.999 * photons);
    ck_assert_double_le(c.photons, 1.01 * photons);
}
END_TEST

/* The pilot of a small map was held up by other programs: still no larger one with the same k takes less time. */
START_TEST(a_disturbed_clock_favours_no_larger_map)
{
    world w = curved, held_up = curved;
    w.b = held_up.b = 0.0;
    held_up.ns_per_photon *= 20.0;
    held_up.ns_first *= 20.0;
    pm__map_law law = law_of(&w);
    const pm__map_sample sample = sample_of(&held_up, 128.0, 2048.0);
    ck_assert(pm__map_law_add(&law, &sample));
    double before = 0.0;
    for (double photons = 2048.0; photons < 1e9; photons *= 1.5) {
        const double seconds = pm__map_seconds(&law, 128.0, photons, free_limits.queries);
        ck_assert_double_gt(seconds, before);
        before = seconds;
    }
    const pm__map_choice c = pm__map_solve(&law, &free_limits, 0.1);
    PM_CHECK_NEAR(c.photons, 16.0 * c.k, 0.5);
}
END_TEST

/* No bias anywhere: the largest share that was seen. */
START_TEST(without_bias_the_map_is_small)
{
    world w = curved;
    w.b = 0.0;
    const pm__map_law law = law_of(&w);
    const pm__map_choice c = pm__map_solve(&law, &free_limits, 0.02);
    ck_assert_double_eq(pm__map_bias2(&law, 0.01), 0.0);
    ck_assert(c.reachable);
    ck_assert_double_eq(c.k, ceil(2.0 + w.a / 4e-4 - 0.5));
    ck_assert_double_eq(c.photons, ceil(c.k * 16.0));
}
END_TEST

START_TEST(what_is_out_of_reach_says_what_is_not)
{
    const pm__map_law law = law_of(&abrupt);
    const pm__map_limits limits = {2048.0, 5.0, 1e6};
    const pm__map_choice c = pm__map_solve(&law, &limits, 0.02);
    double least = INFINITY;
    for (double k = 5.0; k < 60000.0; k++)
        least = fmin(least, error_of(&abrupt, k, 1e6));
    ck_assert(!c.reachable);
    ck_assert_double_eq(c.photons, 1e6);
    PM_CHECK_NEAR(c.rel_rmse, error_of(&abrupt, c.k, c.photons), 1e-9);
    ck_assert_double_ge(c.rel_rmse, least);
    ck_assert_double_le(c.rel_rmse, 1.005 * least);
    const pm__map_choice next = pm__map_solve(&law, &limits, 1.02 * c.rel_rmse);
    ck_assert(next.reachable);
    ck_assert(pm__map_is_better(&next, &c));
    ck_assert(!pm__map_is_better(&c, &next));
    const pm__map_law none = {.count = 0};
    ck_assert(!pm__map_solve(&none, &limits, 0.5).reachable);
}
END_TEST

/* A constant bias (the Gaussian as printed) is not shrunk away. */
START_TEST(a_constant_bias_stays)
{
    const world w = {1.2, 0.469, 0.0, 300.0, 40.0, 0.8};
    const pm__map_law law = law_of(&w);
    const pm__map_limits limits = {2048.0, 5.0, 1e9};
    PM_CHECK_NEAR(pm__map_bias2(&law, 1e-9), 0.469 * 0.469, 1e-9);
    ck_assert(!pm__map_solve(&law, &limits, 0.4).reachable);
    ck_assert(pm__map_solve(&law, &limits, 0.5).reachable);
}
END_TEST

/* A sample that does not stand clear bounds the bias of smaller shares, and of those alone. */
START_TEST(what_is_not_clear_is_a_bound)
{
    pm__map_law law = law_of(&abrupt);
    pm__map_sample blurred = sample_of(&abrupt, 1000.0, 1e6);
    blurred.bias2 = 0.0;
    blurred.bias2_error = 1e-6;
    ck_assert(pm__map_law_add(&law, &blurred));
    PM_CHECK_NEAR(pm__map_bias2(&law, 1e-3), 2e-6, 1e-15);
    PM_CHECK_NEAR(pm__map_bias2(&law, 2e-4), 2e-6, 1e-15);
    PM_CHECK_NEAR(pm__map_bias2(&law, 4e-3) / bias2_of(&abrupt, 4e-3), 1.0, 1e-9);
}
END_TEST

/* Nothing clear: proportional to the share, by least squares. */
START_TEST(a_vague_bias_is_fitted_all_the_same)
{
    pm__map_law law = {.count = 0};
    for (double k = 32.0; k <= 2048.0; k *= 2.0) {
        pm__map_sample sample = sample_of(&curved, k, 32768.0);
        sample.bias2 = 0.02 * k / 32768.0;
        sample.bias2_error = sample.bias2;
        ck_assert(pm__map_law_add(&law, &sample));
    }
    PM_CHECK_NEAR(pm__map_bias2(&law, 0.01), 2e-4, 1e-9);
    PM_CHECK_NEAR(pm__map_bias2(&law, 1e-5), 2e-7, 1e-12);
}
END_TEST

START_TEST(near_is_a_quarter_of_the_photons_and_half_the_share)
{
    const pm__map_law law = law_of(&curved); /* 32768 photons, shares 2^-10 to 2^-4 */
    const pm__map_choice near = {.k = 100.0, .photons = 131072.0}, large = {.k = 200.0, .photons = 262144.0};
    const pm__map_choice small_share = {.k = 15.0, .photons = 32768.0};
    ck_assert(pm__map_is_near(&law, &near));
    ck_assert(!pm__map_is_near(&law, &large));
    ck_assert(!pm__map_is_near(&law, &small_share));
}
END_TEST

START_TEST(useless_samples_are_passed_over)
{
    pm__map_law law = {.count = 0};
    const pm__map_sample bad[] = {{.k = 2.0, .photons = 10.0, .variance = 1.0},
                                  {.k = 20.0, .photons = 100.0, .variance = 0.0},
                                  {.k = 20.0, .photons = 100.0, .variance = NAN}};
    const pm__map_sample good = {.k = 20.0, .photons = 400.0, .variance = 0.05};
    for (int i = 0; i < 3; i++)
        ck_assert(pm__map_law_add(&law, &bad[i]));
    ck_assert_uint_eq(law.count, 0);
    for (int i = 0; i < PM__MOST_SAMPLES; i++)
        ck_assert(pm__map_law_add(&law, &good));
    ck_assert(!pm__map_law_add(&law, &good));
}
END_TEST

/* error^2 = 0.04 i^-2/3 + 0.0009 i^-2/3 and others: scales come back, and the first whole pass is found. */
START_TEST(passes_are_fitted_and_solved)
{
    const double slopes[][2] = {{2.0 / 3.0, 2.0 / 3.0}, {0.5, 1.0}, {1.0, 0.0}};
    for (int i = 0; i < 3; i++) {
        pm__pass_sample samples[6];
        for (int r = 0; r < 6; r++) {
            const double n = exp2(r);
            samples[r] = (pm__pass_sample){n, 0.04 * pow(n, -slopes[i][0]), 0.0009 * pow(n, -slopes[i][1])};
        }
        samples[0].variance *= 3.0; /* the start is not of the law */
        const pm__pass_law law = pm__pass_law_fit(samples, 6, slopes[i][0], slopes[i][1]);
        PM_CHECK_NEAR(law.variance_1, 0.04, 1e-12);
        PM_CHECK_NEAR(law.bias2_1, 0.0009, 1e-12);
        for (double error = 0.4; error > 0.032; error /= 1.5) {
            const double n = pm__pass_solve(&law, error, 1e9);
            ck_assert_double_ge(n, 1.0);
            ck_assert_double_le(pm__pass_error(&law, n), error);
            ck_assert(n == 1.0 || pm__pass_error(&law, n - 1.0) > error);
        }
    }
    /* steeper than the law: points drawn anew; never steeper than a mean */
    pm__pass_sample steep[6];
    for (int r = 0; r < 6; r++)
        steep[r] = (pm__pass_sample){exp2(r), 0.04 * pow(exp2(r), -0.8), 0.0};
    PM_CHECK_NEAR(pm__pass_law_fit(steep, 6, 2.0 / 3.0, 2.0 / 3.0).variance_slope, 0.8, 1e-12);
    PM_CHECK_NEAR(pm__pass_law_fit(steep, 6, 0.9, 0.2).variance_slope, 0.9, 1e-12);
    PM_CHECK_NEAR(pm__pass_law_fit(steep, 1, 0.5, 0.5).variance_slope, 0.5, 1e-12);
    const pm__pass_law level = {0.04, 1.0, 0.0009, 0.0}; /* a mean of maps: never below its bias of 3 % */
    ck_assert_double_eq(pm__pass_solve(&level, 0.03, 1e9), 0.0);
    ck_assert_double_eq(pm__pass_solve(&level, 0.05, 0.0), 0.0);
    ck_assert_double_eq(pm__pass_solve(&level, 0.05, 10.0), 0.0);
    ck_assert_double_eq(pm__pass_solve(&level, 0.05, 25.0), 25.0); /* 0.0016 = 0.04 / 25 */
}
END_TEST

/* A bias that stays, and no noise: 1 pass says it all. With noise as few as leave little of it. */
START_TEST(what_passes_cannot_mend)
{
    const pm__pass_sample dark[] = {{1.0, 0.0, 1.44}, {2.0, 0.0, 1.44}, {4.0, 0.0, 1.44}, {8.0, 0.0, 1.44}};
    const pm__pass_law still = pm__pass_law_fit(dark, 4, 1.0, 0.0);
    PM_CHECK_NEAR(pm__pass_error(&still, 1.0), 1.2, 1e-12);
    PM_CHECK_NEAR(pm__pass_floor(&still), 1.2, 1e-12);
    ck_assert_double_eq(pm__pass_solve(&still, 0.5, 1e6), 0.0);
    ck_assert_double_eq(pm__pass_nearest(&still, 1e6), 1.0);
    const pm__pass_law noisy = {0.04, 1.0, 0.01, 0.0};
    const double passes = pm__pass_nearest(&noisy, 1e6);
    PM_CHECK_NEAR(pm__pass_floor(&noisy), 0.1, 1e-15);
    PM_CHECK_NEAR(passes, 4.0 / (1.01 * 1.01 * (1.0 + 4e-6) - 1.0), 1.0); /* 0.04 / i = (1.01^2 e^2 - 1) / 100 */
    ck_assert_double_eq(pm__pass_nearest(&noisy, 5.0), 5.0);
    const pm__pass_law falling = {0.04, 0.667, 0.01, 0.667};
    ck_assert_double_eq(pm__pass_floor(&falling), 0.0);
    ck_assert_double_eq(pm__pass_nearest(&falling, 1e6), 1e6);
}
END_TEST

/* Some passes without noise do not hide the slope of the others. */
START_TEST(passes_without_noise_have_no_slope)
{
    const pm__pass_sample samples[] = {{1.0, 0.0, 0.0}, {2.0, 0.02, 0.0}, {4.0, 0.0, 0.0}, {8.0, 0.005, 0.0},
                                       {16.0, 0.0025, 0.0}};
    PM_CHECK_NEAR(pm__pass_law_fit(samples, 5, 0.6, 0.6).variance_slope, 1.0, 1e-12);
}
END_TEST

/* A path tracer of 51 passes has an error of about 5 % in the furnace (noise only). */
static pm__advice verified(double wanted, double predicted, const char *detail, bool canceled);

/* More than a quarter off to either side is missed, unless there is nothing smaller; canceled it is neither. */
START_TEST(verification_is_honest)
{
    pm__advice a = verified(0.05, 0.05, "", false);
    ck_assert_str_eq(a.status, "ok");
    ck_assert_str_eq(a.detail, "");
    PM_CHECK_NEAR(a.ratio, a.reached_rel_rmse / 0.05, 1e-12);
    a = verified(0.1, 0.1, "extrapolated", false);
    ck_assert_str_eq(a.status, "missed");
    ck_assert_str_eq(a.detail, "better than what was asked for by more than 25 %; extrapolated");
    a = verified(0.03, 0.03, "", false);
    ck_assert_str_eq(a.status, "missed");
    ck_assert_str_eq(a.detail, "worse than what was asked for by more than 25 %");
    a = verified(0.1, 0.05, "", false);
    ck_assert_str_eq(a.status, "ok");
    ck_assert_str_eq(a.detail, "better than what was asked for: the least there is");
    a = verified(0.05, 0.05, "", true);
    ck_assert_str_eq(a.status, "interrupted");
    ck_assert(isnan(a.ratio) && isnan(a.reached_rel_rmse) && isnan(a.reached_seconds));
}
END_TEST

static bool say_canceled(void *context)
{
    return *(bool *)context;
}

static pm__advice verified(double wanted, double predicted, const char *detail, bool canceled)
{
    pm_error error = {""};
    pm__spec of;
    pm__advice a = {.passes = 51, .width = 32, .height = 32, .trials = 4, .predicted_rel_rmse = predicted,
                    .status = "ok"};
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, "scene:furnace", &of, &error), error);
    PM_CHECK_OK(pm__spec_parse(&pm__advise_methods, "path", &a.method, &error), error);
    (void)snprintf(a.detail, sizeof a.detail, "%s", detail);
    const pm__advise_config config = {.subject = &of, .error = wanted, .probes = 1, .seed = 1,
                                      .canceled = say_canceled, .context = &canceled};
    ck_assert_int_eq(pm__advise_verify(&config, &a, &error), canceled ? PM_ECANCELED : PM_OK);
    return a;
}

static const char *refusal(const char *subject, const char *method, double wanted)
{
    static pm_error error;
    pm__spec of, methods[1];
    pm__advice *advice = NULL;
    size_t count = 0;
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, subject, &of, &error), error);
    PM_CHECK_OK(pm__spec_parse(&pm__advise_methods, method, methods, &error), error);
    const pm__advise_config config = {.subject = &of, .error = wanted, .methods = methods, .method_count = 1,
                                      .probes = 20, .most_photons = 2000, .seconds = 0.1, .seed = 1};
    ck_assert_int_eq(pm__advise(&config, &advice, &count, &error), PM_EINVAL);
    ck_assert_ptr_null(advice);
    return error.text;
}

START_TEST(refusals_say_why)
{
    ck_assert_ptr_nonnull(strstr(refusal("square", "map", 0.0), "between 0 and 1"));
    ck_assert_ptr_nonnull(strstr(refusal("square", "map", 1.0), "between 0 and 1"));
    ck_assert_ptr_nonnull(strstr(refusal("square", "map", NAN), "between 0 and 1"));
    ck_assert_ptr_nonnull(strstr(refusal("square", "pppm", 0.1), "takes a scene"));
    ck_assert_str_eq(refusal("scene:cornell", "map", 0.1),
                     "scene:cornell has no exact answer, which maps are judged by; other methods, such as pppm, are by "
                     "its stored reference");
    ck_assert_str_eq(refusal("scene:cornell:albedo=0.5", "map", 0.1),
                     "scene:cornell:albedo=0.5 has no exact answer, which maps are judged by");
    ck_assert_str_eq(refusal("scene:furnace", "pppm", 0.1),
                     "a pass emits 20000 photons, and 2000 is the most that there may be");
}
END_TEST

PM_TEST_MAIN("advise", laws_are_continued, the_cheapest_is_found, free_queries_have_a_closed_form,
             a_disturbed_clock_favours_no_larger_map, without_bias_the_map_is_small,
             what_is_out_of_reach_says_what_is_not, a_constant_bias_stays, what_is_not_clear_is_a_bound,
             a_vague_bias_is_fitted_all_the_same, near_is_a_quarter_of_the_photons_and_half_the_share,
             useless_samples_are_passed_over, passes_are_fitted_and_solved, what_passes_cannot_mend,
             verification_is_honest, passes_without_noise_have_no_slope, refusals_say_why)
