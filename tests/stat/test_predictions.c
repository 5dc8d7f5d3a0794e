/* What theory predicts is what the bench measures, in every case, region, kernel and k.
 *
 * The bound on a standardized difference is Student's quantile for a false alarm in 1e-6 over the whole family of a
 * test, by Bonferroni; seeds are fixed. */
#include "bench.h"

static const char kernels[] = "disc,disc:last=none,disc:last=half,cone:k=1,cone:last=none,cone:k=2,gaussian,"
                              "gaussian:form=pavicic,last=none,gaussian:form=normalised,last=none,"
                              "epanechnikov:last=none,biweight:last=half";

START_TEST(kernels_follow_their_law_in_every_case)
{
    static const size_t ks[] = {5, 20, 80};
    const bench_run run = {.cases = "all", .estimators = kernels, .ks = ks, .k_count = 3, .photons = 4000,
                           .trials = 60, .probes = 150, .seed = 101};
    pm__accuracy_row *rows;
    const size_t count = run_bench(&run, &rows), predicted = check_rows(rows, count);
    ck_assert_msg(predicted > count * 9 / 10, "only %zu of %zu rows have a prediction", predicted, count);
    free(rows);
}
END_TEST

/* T2 and the like: lookups that a radius cuts now and then, and fixed radii. */
START_TEST(cut_lookups_and_fixed_radii_follow_their_law)
{
    static const size_t ks[] = {20};
    bench_run run = {.cases = "square,quadratic,edge,wall,volume", .estimators = kernels, .ks = ks, .k_count = 1,
                     .radius = 0.04, .photons = 4000, .trials = 60, .probes = 150, .seed = 102};
    pm__accuracy_row *rows;
    size_t count = run_bench(&run, &rows);
    ck_assert_uint_gt(check_rows(rows, count), count * 9 / 10);
    free(rows);
    run.k_count = 0;
    run.radius = 0.06;
    count = run_bench(&run, &rows);
    ck_assert_uint_gt(check_rows(rows, count), count * 9 / 10);
    free(rows);
}
END_TEST

/* With the front filter off, photons of the wall and of the lit side leak in as the mass functions say. */
START_TEST(leaks_follow_their_law)
{
    static const size_t ks[] = {20, 80};
    const bench_run run = {.cases = "corner,wall,sphere", .estimators = "disc,disc:last=none,cone", .ks = ks,
                           .k_count = 2, .photons = 4000, .trials = 60, .probes = 150, .seed = 103, .front_off = true};
    pm__accuracy_row *rows;
    const size_t count = run_bench(&run, &rows);
    ck_assert_uint_gt(check_rows(rows, count), count * 8 / 10);
    free(rows);
}
END_TEST

/* Stratified and Sobol' photons keep the mean of a fixed radius; their noise is below that of independent ones. */
START_TEST(other_samplers_keep_the_mean_of_fixed_radii)
{
    static const char *const samplers[] = {"stratified", "sobol"};
    for (int s = 0; s < 2; s++) {
        const bench_run run = {.cases = "square,quadratic,point-light,volume", .estimators = "disc,epanechnikov",
                               .sampler = samplers[s], .radius = 0.08, .photons = 4000, .trials = 60, .probes = 150,
                               .seed = 104};
        pm__accuracy_row *rows;
        const size_t count = run_bench(&run, &rows);
        ck_assert_uint_eq(check_rows(rows, count), count);
        free(rows);
    }
}
END_TEST

/* Theorems T1 to T3 of docs/errata.md, through the whole bench: hull, combined maps, differential checking. */
START_TEST(estimators_without_a_kernel_have_their_uniform_mean)
{
    static const size_t ks[] = {24, 60};
    const bench_run run = {.cases = "square", .ks = ks, .k_count = 2, .photons = 12000, .trials = 80, .probes = 200,
                           .seed = 105,
                           .estimators = "hull:boundary=0,combined:maps=4,rule=pooled,last=none,"
                                         "combined:maps=8,rule=mean,last=full,combined:maps=4,deal=separate,"
                                         "combined:maps=4,deal=roundrobin,"
                                         "differential:rule=significance,last=none,differential:last=none"};
    pm__accuracy_row *rows;
    const size_t count = run_bench(&run, &rows), predicted = check_rows(rows, count);
    /* two k: every estimator in the interior, the hull in all four regions */
    ck_assert_msg(predicted >= 2 * (7 + 3), "%zu predictions", predicted);
    free(rows);
}
END_TEST

PM_TEST_MAIN("predictions", kernels_follow_their_law_in_every_case, cut_lookups_and_fixed_radii_follow_their_law,
             leaks_follow_their_law, other_samplers_keep_the_mean_of_fixed_radii,
             estimators_without_a_kernel_have_their_uniform_mean)
