/* Running the accuracy bench from tests, and what its rows must satisfy. */
#ifndef PM_TESTS_STAT_BENCH_H
#define PM_TESTS_STAT_BENCH_H

#include "../../src/accuracy/accuracy.h"
#include "../../src/cli/parallel.h"
#include "../test.h"

#include <string.h>

typedef struct bench_run {
    const char *cases, *estimators, *sampler;
    const size_t *ks;
    size_t k_count;
    double radius;
    size_t photons, trials, probes;
    uint64_t seed;
    bool front_off;
} bench_run;

/* Rows point to specs, so these stay; within reach, so that no one takes them for a leak. */
static inline void keep_specs(pm__spec *specs)
{
    static pm__spec *kept[1024];
    static size_t count;
    ck_assert_uint_lt(count, sizeof kept / sizeof *kept);
    kept[count++] = specs;
}

/* The caller frees the rows. */
static inline size_t run_bench(const bench_run *run, pm__accuracy_row **rows)
{
    static size_t threads;
    const pm_parallel parallel = pm__parallel_for(&threads);
    pm__spec *cases = NULL, *estimators = NULL, *samplers = NULL;
    size_t case_count = 0, estimator_count = 0, sampler_count = 0, row_count = 0;
    pm_error error = {""};
    /* "all" leaves the traced scenes out, as the program does: they take longer */
    const pm__catalogue *const from = strcmp(run->cases, "all") ? &pm__all_cases : &pm__cases;
    PM_CHECK_OK(pm__spec_parse_list(from, run->cases, &cases, &case_count, &error), error);
    PM_CHECK_OK(pm__spec_parse_list(&pm__estimators, run->estimators, &estimators, &estimator_count, &error), error);
    PM_CHECK_OK(pm__spec_parse_list(&pm__samplers, run->sampler ? run->sampler : "poisson", &samplers, &sampler_count,
                                    &error),
                error);
    keep_specs(cases);
    keep_specs(estimators);
    keep_specs(samplers);
    const pm__accuracy_config config = {
        .cases = cases, .case_count = case_count, .estimators = estimators, .estimator_count = estimator_count,
        .ks = run->ks, .k_count = run->k_count, .radius = run->radius, .photons = &run->photons, .photon_count = 1,
        .samplers = samplers, .sampler_count = sampler_count, .trials = run->trials, .probes_all = run->probes,
        .probes_region = run->probes, .lookup = {PM_LOOKUP_SPHERE, 0.0, !run->front_off}, .seed = run->seed,
        .parallel = &parallel};
    PM_CHECK_OK(pm__accuracy_run(&config, rows, &row_count, &error), error);
    return row_count;
}

static inline double half_width(pm__interval interval)
{
    return 0.5 * (interval.high - interval.low);
}

/* Standard error of the bias over trials, from its interval. */
static inline double bias_error(const pm__accuracy_row *row)
{
    return half_width(row->rel_bias_ci95) / pm__student_quantile(0.975, (double)row->trials - 1.0);
}

/* Student's bound for a false alarm in 1e-6 over a family, by Bonferroni. */
static inline double quantile_for(size_t comparisons, size_t trials)
{
    return pm__student_quantile(1.0 - 0.5e-6 / (double)comparisons, (double)trials - 1.0);
}

/* Each predicted row within its bound; how many there were. */
static inline size_t check_rows(const pm__accuracy_row *rows, size_t count)
{
    size_t predicted = 0;
    for (size_t i = 0; i < count; i++) {
        const pm__accuracy_row *const r = &rows[i];
        if (isnan(r->predicted_rel_bias))
            continue;
        predicted++;
        char name[PM__MAX_SPEC];
        pm__spec_format_short(r->estimator_spec, name, sizeof name);
        /* The law is exact but for quadrature (1e-5 of the estimate); rows without any noise are compared so. */
        const double se = bias_error(r), bound = quantile_for(2 * count, r->trials);
        ck_assert_msg(fabs(r->rel_bias - r->predicted_rel_bias) <= bound * se + 2e-5,
                      "%s %s %s k=%zu: bias %+.5f, theory %+.5f, %.1f standard errors", r->case_spec->entry->name,
                      r->region, name, r->k, r->rel_bias, r->predicted_rel_bias,
                      (r->rel_bias - r->predicted_rel_bias) / se);
        if (isnan(r->predicted_rel_noise) || !(r->predicted_rel_noise > 0.0))
            continue;
        const double log_se = 0.5 * log(r->rel_noise_ci95.high / r->rel_noise_ci95.low) /
                              pm__student_quantile(0.975, (double)r->trials - 1.0);
        ck_assert_msg(fabs(log(r->rel_noise / r->predicted_rel_noise)) <= bound * log_se + 2e-5,
                      "%s %s %s k=%zu: noise %.5f, theory %.5f", r->case_spec->entry->name, r->region, name, r->k,
                      r->rel_noise, r->predicted_rel_noise);
    }
    return predicted;
}

#endif
