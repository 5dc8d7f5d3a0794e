/* What advice predicts is what happens: pilots, laws and the check itself, as `advise --verify` runs them. */
#include "../../src/cli/parallel.h"
#include "../../src/converge/advise.h"
#include "../test.h"

#include <string.h>

static pm__advice advise(const char *subject, const char *estimators, const char *method, double error, uint64_t seed)
{
    static size_t threads;
    const pm_parallel parallel = pm__parallel_for(&threads);
    pm_error message = {""};
    pm__spec of, how, *kernels = NULL;
    pm__advice *advice = NULL;
    size_t kernel_count = 0, count = 0;
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, subject, &of, &message), message);
    PM_CHECK_OK(pm__spec_parse(&pm__advise_methods, method, &how, &message), message);
    PM_CHECK_OK(pm__spec_parse_list(&pm__estimators, estimators, &kernels, &kernel_count, &message), message);
    const pm__advise_config config = {.subject = &of, .error = error, .estimators = kernels,
                                      .estimator_count = kernel_count, .methods = &how, .method_count = 1,
                                      .probes = 500, .most_photons = 320000, .seconds = 2.0, .seed = seed,
                                      .parallel = &parallel, .threads = threads};
    PM_CHECK_OK(pm__advise(&config, &advice, &count, &message), message);
    ck_assert_uint_ge(count, 1);
    ck_assert(advice[0].advised);
    for (size_t i = 1; i < count; i++)
        ck_assert(!advice[i].advised);
    PM_CHECK_OK(pm__advise_verify(&config, &advice[0], &message), message);
    const pm__advice first = advice[0];
    free(advice);
    free(kernels);
    return first;
}

/* The error reached has a standard error s over trials, here at most 4 % (asserted). A prediction that is right to 5 %
 * then misses the quarter with a probability below 3e-7: 20 % are five of s. */
static void check(const pm__advice *a, double error)
{
    const double s = 0.5 * (a->reached_rel_rmse_ci95.high - a->reached_rel_rmse_ci95.low) /
                     pm__student_quantile(0.975, (double)a->trials - 1.0);
    ck_assert_double_le(s, 0.04 * error);
    ck_assert_msg(fabs(a->ratio - 1.0) <= 0.25, "k %zu, %zu photons: %.4f of the error asked for", a->k, a->photons,
                  a->ratio);
    ck_assert_str_eq(a->status, "ok");
    PM_CHECK_NEAR(a->ratio, a->reached_rel_rmse / error, 1e-12);
    PM_CHECK_NEAR(a->predicted_rel_rmse / error, 1.0, 0.02);
    PM_CHECK_NEAR(hypot(a->predicted_rel_bias, a->predicted_rel_noise) / a->predicted_rel_rmse, 1.0, 1e-9);
}

/* Noise alone. */
START_TEST(an_even_slope_is_a_matter_of_k)
{
    const pm__advice a = advise("gradient", "disc:last=none", "map", 0.05, 401);
    check(&a, 0.05);
    ck_assert_double_lt(a.predicted_rel_bias, 0.015);
}
END_TEST

/* Curvature: bias and noise share the error. */
START_TEST(a_curve_is_a_matter_of_both)
{
    const pm__advice a = advise("sinusoid", "disc:last=none", "map", 0.08, 402);
    check(&a, 0.08);
    ck_assert_double_gt(a.predicted_rel_bias, 0.01);
}
END_TEST

START_TEST(passes_of_a_scene)
{
    const pm__advice a = advise("scene:plate", "disc", "pppm", 0.15, 403);
    ck_assert_uint_ge(a.passes, 1);
    check(&a, 0.15);
}
END_TEST

PM_TEST_MAIN("advice", an_even_slope_is_a_matter_of_k, a_curve_is_a_matter_of_both, passes_of_a_scene)
