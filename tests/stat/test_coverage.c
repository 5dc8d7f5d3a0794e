/* How often intervals hold what they should: counted, on planted errors and on the bench itself.
 *
 * A count is compared with the nominal 95 % by the exact binomial tail; a test may fail by chance with at most 1e-6
 * over all of its comparisons. Jackknife intervals are only asymptotically exact, so they are allowed the shortfall
 * that each test states, which is far below what a wrong formula (a forgotten correlation between probes, say) would
 * cost. */
#include "bench.h"

#include "../../src/base/memory.h"

#include <gsl/gsl_cdf.h>
#include <stdio.h>

/* Covered `hits` times of n: is that too few for `least`, or too many for `most` (both as probabilities)? */
static void check_coverage(const char *what, unsigned hits, unsigned n, double least, double most)
{
    const double too_few = gsl_cdf_binomial_P(hits, least, n), too_many = gsl_cdf_binomial_Q(hits - 1, most, n);
    if (getenv("PM_SHOW"))
        printf("%s: %u of %u\n", what, hits, n);
    ck_assert_msg(too_few > 1e-7 && too_many > 1e-7, "%s: %u of %u intervals hold the truth", what, hits, n);
}

static bool holds(pm__interval interval, double value)
{
    return interval.low <= value && value <= interval.high;
}

/* Two independent normal deviates. */
static void normal_pair(uint64_t number, uint32_t replicate, double pair[2])
{
    double u[2];
    pm__random_uniform(31, PM__FOR_TESTS, replicate, number, u, 2);
    const double r = sqrt(-2.0 * log1p(-u[0])), angle = 2.0 * acos(-1.0) * u[1];
    pair[0] = r * cos(angle);
    pair[1] = r * sin(angle);
}

enum { PROBES = 24 };

/* error = b_q + 0.6 (trial's own) + 0.8 (probe's own): probes of a trial are correlated, as photons shared between
 * lookups make them. Every quantity is known exactly. */
static void count_planted(size_t trials, unsigned replicates, double planted, unsigned covered[4])
{
    float *const error = pm__alloc(trials * PROBES, sizeof *error);
    double *const scratch = pm__alloc(PROBES + 3 * trials, sizeof *scratch);
    double bias = 0.0, squared = 0.0;
    for (size_t q = 0; q < PROBES; q++) {
        const double b = planted * (double)q / PROBES;
        bias += b / PROBES;
        squared += b * b / PROBES;
    }
    for (uint32_t replicate = 0; replicate < replicates; replicate++) {
        uint64_t number = 0;
        for (size_t t = 0; t < trials; t++) {
            double common[2], own[2] = {0.0, 0.0};
            normal_pair(number++, replicate, common);
            for (size_t q = 0; q < PROBES; q++) {
                if (q % 2 == 0)
                    normal_pair(number++, replicate, own);
                error[t * PROBES + q] =
                    (float)(planted * (double)q / PROBES + 0.6 * common[0] + 0.8 * own[q % 2]);
            }
        }
        const pm__trial_errors errors = {error, trials, PROBES, PROBES};
        pm__error_summary s;
        pm__summarize_errors(&errors, scratch, &s);
        covered[0] += holds(s.bias_ci95, bias);
        covered[1] += holds(s.rms_bias_ci95, sqrt(squared));
        covered[2] += holds(s.noise_ci95, 1.0);
        covered[3] += holds(s.rmse_ci95, sqrt(1.0 + squared));
    }
    free(scratch);
    free(error);
}

START_TEST(planted_biases_and_variances_are_covered)
{
    static const size_t trials[] = {32, 400};
    static const double planted[] = {0.0, 0.3, 3.0};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 3; j++) {
            const unsigned replicates = i ? 800 : 3000;
            unsigned covered[4] = {0};
            count_planted(trials[i], replicates, planted[j], covered);
            const double slack = i ? 0.01 : 0.025; /* of the jackknife with 400 and with 32 trials */
            check_coverage("bias", covered[0], replicates, 0.95 - 0.002, 0.95 + 0.002);
            check_coverage("rms bias", covered[1], replicates, 0.95 - slack, 1.0 - 1e-9);
            check_coverage("noise", covered[2], replicates, 0.95 - slack, 0.95 + slack);
            check_coverage("rmse", covered[3], replicates, 0.95 - slack, 0.95 + slack);
        }
}
END_TEST

/* The bench as users run it: 400 trials, k from 10, 256 probes; the truth is the exact law. */
START_TEST(the_bench_covers_exact_predictions)
{
    enum { RUNS = 80 };
    static const size_t ks[] = {10, 40};
    unsigned bias = 0, noise = 0, total = 0;
    for (unsigned seed = 0; seed < RUNS; seed++) {
        const bench_run run = {.cases = "quadratic", .estimators = "disc,epanechnikov:last=none", .ks = ks,
                               .k_count = 2, .photons = 1000, .trials = 400, .probes = 256, .seed = 1000 + seed};
        pm__accuracy_row *rows;
        const size_t count = run_bench(&run, &rows);
        for (size_t i = 0; i < count; i++) {
            if (strcmp(rows[i].region, "all") || rows[i].k != ks[seed % 2])
                continue; /* one k a run: rows of a run are not independent */
            if (strcmp(rows[i].estimator_spec->entry->name, seed / 2 % 2 ? "disc" : "epanechnikov"))
                continue;
            total++;
            bias += holds(rows[i].rel_bias_ci95, rows[i].predicted_rel_bias);
            noise += holds(rows[i].rel_noise_ci95, rows[i].predicted_rel_noise);
        }
        free(rows);
    }
    ck_assert_uint_eq(total, RUNS);
    check_coverage("bias", bias, total, 0.95, 1.0 - 1e-9);
    check_coverage("noise", noise, total, 0.94, 1.0 - 1e-9);
}
END_TEST

/* 0.1 % is seen: a bias of that size moves the interval off 0 with 400 trials of 2000 photons' worth of probes. */
START_TEST(a_bias_of_a_tenth_of_a_percent_is_seen)
{
    static const size_t ks[] = {500};
    const bench_run run = {.cases = "square", .estimators = "disc,disc:last=none", .ks = ks, .k_count = 1,
                           .photons = 40000, .trials = 400, .probes = 512, .seed = 77};
    pm__accuracy_row *rows;
    const size_t count = run_bench(&run, &rows);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(rows[i].region, "interior"))
            continue;
        ck_assert_msg(half_width(rows[i].rel_bias_ci95) < 1e-3, "+-%g", half_width(rows[i].rel_bias_ci95));
        if (rows[i].estimator_spec->values[0] == 0.0) /* last=full: +1/499 */
            ck_assert_msg(rows[i].rel_bias_ci95.low > 0.0, "%g is not told from 0", rows[i].rel_bias);
    }
    free(rows);
}
END_TEST

/* The same rows to the last bit for any number of threads. */
START_TEST(rows_do_not_depend_on_the_threads)
{
    static const size_t ks[] = {12, 30};
    pm__accuracy_row *rows[3] = {NULL};
    size_t counts[3];
    for (int i = 0; i < 3; i++) {
        size_t threads = (size_t)(i == 2 ? 5 : i + 1);
        const pm_parallel parallel = pm__parallel_for(&threads);
        pm__spec *cases = NULL, *estimators = NULL, *samplers = NULL;
        size_t case_count = 0, estimator_count = 0, sampler_count = 0, photons = 3000;
        ck_assert_int_eq(pm__spec_parse_list(&pm__cases, "edge,volume", &cases, &case_count, NULL), PM_OK);
        ck_assert_int_eq(pm__spec_parse_list(&pm__estimators, "all", &estimators, &estimator_count, NULL), PM_OK);
        ck_assert_int_eq(pm__spec_parse_list(&pm__samplers, "all", &samplers, &sampler_count, NULL), PM_OK);
        const pm__accuracy_config config = {
            .cases = cases, .case_count = case_count, .estimators = estimators, .estimator_count = estimator_count,
            .ks = ks, .k_count = 2, .photons = &photons, .photon_count = 1, .samplers = samplers,
            .sampler_count = sampler_count, .trials = 6, .probes_all = 60, .probes_region = 60,
            .lookup = {PM_LOOKUP_SPHERE, 0.0, true}, .seed = 5, .parallel = i ? &parallel : NULL};
        ck_assert_int_eq(pm__accuracy_run(&config, &rows[i], &counts[i], NULL), PM_OK);
        ck_assert_uint_eq(counts[i], counts[0]);
        for (size_t r = 0; r < counts[0]; r++) {
            rows[i][r].case_spec = rows[i][r].estimator_spec = rows[i][r].sampler_spec = NULL;
            ck_assert_mem_eq(&rows[i][r], &rows[0][r], sizeof rows[0][r]);
        }
        free(cases);
        free(estimators);
        free(samplers);
    }
    for (int i = 0; i < 3; i++)
        free(rows[i]);
}
END_TEST

/* The oracle is a floor for the disc: at no k of the run is the disc better, but for the noise of its choice. */
START_TEST(the_oracle_is_a_floor_for_the_disc)
{
    static const size_t ks[] = {10, 30, 100, 300};
    const bench_run run = {.cases = "edge,quadratic:curvature=20", .estimators = "disc,oracle", .ks = ks, .k_count = 4,
                           .photons = 4000, .trials = 64, .probes = 300, .seed = 41};
    pm__accuracy_row *rows;
    const size_t count = run_bench(&run, &rows);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            if (rows[i].case_spec == rows[j].case_spec && rows[i].region == rows[j].region && rows[j].k == 300 &&
                !strcmp(rows[i].estimator_spec->entry->name, "disc") &&
                !strcmp(rows[j].estimator_spec->entry->name, "oracle"))
                ck_assert_msg(rows[j].rel_rmse < 1.03 * rows[i].rel_rmse, "%s %s: disc k=%zu %g, oracle %g",
                              rows[i].case_spec->entry->name, rows[i].region, rows[i].k, rows[i].rel_rmse,
                              rows[j].rel_rmse);
    free(rows);
}
END_TEST

PM_TEST_MAIN("coverage", planted_biases_and_variances_are_covered, the_bench_covers_exact_predictions,
             a_bias_of_a_tenth_of_a_percent_is_seen, rows_do_not_depend_on_the_threads,
             the_oracle_is_a_floor_for_the_disc)
