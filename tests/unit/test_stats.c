/* Quantiles against GSL, error moments and their jackknife against plain transcriptions, medians against
 * enumeration. */
#include "../../src/stats/stats.h"

#include "../../src/base/gauss.h"
#include "../../src/base/random.h"
#include "../test.h"

#include <gsl/gsl_cdf.h>

START_TEST(quantiles_agree_with_gsl)
{
    static const double dofs[] = {1, 2, 3.5, 7, 31, 63, 399, 10000};
    for (size_t i = 0; i < sizeof dofs / sizeof *dofs; i++)
        for (double p = 0.55; p < 1.0; p += 0.0449)
            PM_CHECK_NEAR(pm__student_quantile(p, dofs[i]) / gsl_cdf_tdist_Pinv(p, dofs[i]), 1.0, 1e-9);
    for (double a = 0.5; a < 400.0; a *= 3.1)
        for (double b = 0.5; b < 40000.0; b *= 7.3)
            for (double x = 0.001; x < 1.0; x += 0.0497)
                PM_CHECK_NEAR(pm__beta_cdf(a, b, x), gsl_cdf_beta_P(x, a, b), 1e-11);
    PM_CHECK_NEAR(pm__beta_cdf(2.0, 3.0, 0.0), 0.0, 0.0);
    PM_CHECK_NEAR(pm__beta_cdf(2.0, 3.0, 1.0), 1.0, 0.0);
}
END_TEST

START_TEST(gauss_rules_integrate_polynomials)
{
    double x[64], w[64];
    for (int n = 1; n <= 64; n++) {
        pm__gauss_legendre(n, x, w);
        for (int degree = 0; degree < 2 * n; degree++) {
            double sum = 0.0;
            for (int i = 0; i < n; i++)
                sum += w[i] * pow(x[i], degree);
            PM_CHECK_NEAR(sum, 1.0 / (degree + 1), 1e-13);
        }
    }
}
END_TEST

enum { TRIALS = 9, PROBES = 5, STRIDE = 7 };

static void fill(float *error)
{
    for (size_t i = 0; i < TRIALS * STRIDE; i++) {
        double u[2];
        pm__random_uniform(21, PM__FOR_TESTS, 0, i, u, 2);
        error[i] = (float)(0.3 + u[0] - 0.8 * u[1] + 0.1 * (double)(i % STRIDE));
    }
}

/* The definitions of accuracy.h, word by word, on the trials but one. */
static void by_definition(const float *error, size_t left_out, double result[4])
{
    double n = 0.0, bias = 0.0, squared = 0.0, noise = 0.0, mse = 0.0;
    for (size_t q = 0; q < PROBES; q++) {
        double mean = 0.0, variance = 0.0;
        n = 0.0;
        for (size_t t = 0; t < TRIALS; t++)
            if (t != left_out) {
                mean += (double)error[t * STRIDE + q];
                mse += (double)error[t * STRIDE + q] * (double)error[t * STRIDE + q];
                n += 1.0;
            }
        mean /= n;
        for (size_t t = 0; t < TRIALS; t++)
            if (t != left_out)
                variance += pow((double)error[t * STRIDE + q] - mean, 2) / (n - 1.0);
        bias += mean / PROBES;
        squared += (mean * mean - variance / n) / PROBES;
        noise += variance / PROBES;
    }
    result[0] = bias;
    result[1] = squared;
    result[2] = sqrt(noise);
    result[3] = sqrt(mse / (n * PROBES));
}

/* The ends x of the interval solve |U - x| = q sqrt(4 x s2 + v). */
static void check_rms_bias(const float *error, double u, double se2, double q, const pm__error_summary *s)
{
    double mean[PROBES] = {0.0}, mean_square = 0.0, products[TRIALS * TRIALS], sum = 0.0, variance = 0.0;
    size_t pairs = 0;
    for (size_t p = 0; p < PROBES; p++) {
        for (size_t t = 0; t < TRIALS; t++)
            mean[p] += (double)error[t * STRIDE + p] / TRIALS;
        mean_square += mean[p] * mean[p] / PROBES;
    }
    for (size_t i = 0; i < TRIALS; i++)
        for (size_t j = i + 1; j < TRIALS; j++) {
            double product = 0.0;
            for (size_t p = 0; p < PROBES; p++)
                product +=
                    ((double)error[i * STRIDE + p] - mean[p]) * ((double)error[j * STRIDE + p] - mean[p]) / PROBES;
            sum += product;
            products[pairs++] = product;
        }
    for (size_t i = 0; i < pairs; i++)
        variance += pow(products[i] - sum / (double)pairs, 2) / (double)pairs;
    const double v = 2.0 * variance / (TRIALS * TRIALS);
    const double s2 = fmax(se2 / (4.0 * mean_square), sqrt(v / 2.0) * fmin(1.0, sqrt(v) / u));
    const double ends[] = {s->rms_bias_ci95.low, s->rms_bias_ci95.high};
    for (int i = 0; i < 2; i++) {
        const double x = ends[i] * ends[i];
        PM_CHECK_NEAR(fabs(u - x), q * sqrt(4.0 * x * s2 + v), 1e-10);
    }
}

START_TEST(summaries_follow_their_definitions)
{
    float error[TRIALS * STRIDE];
    double scratch[PROBES + 3 * TRIALS], all[4], se[4] = {0.0}, mean[4] = {0.0}, without[TRIALS][4];
    fill(error);
    const pm__trial_errors errors = {error, TRIALS, PROBES, STRIDE};
    pm__error_summary s;
    pm__summarize_errors(&errors, scratch, &s);
    by_definition(error, TRIALS, all);
    PM_CHECK_NEAR(s.bias, all[0], 1e-14);
    PM_CHECK_NEAR(s.rms_bias, sqrt(all[1]), 1e-13);
    PM_CHECK_NEAR(s.noise, all[2], 1e-14);
    PM_CHECK_NEAR(s.rmse, all[3], 1e-14);
    for (size_t t = 0; t < TRIALS; t++) {
        by_definition(error, t, without[t]);
        without[t][2] = log(without[t][2]);
        without[t][3] = log(without[t][3]);
        for (int i = 0; i < 4; i++)
            mean[i] += without[t][i] / TRIALS;
    }
    for (size_t t = 0; t < TRIALS; t++)
        for (int i = 0; i < 4; i++)
            se[i] += pow(without[t][i] - mean[i], 2) * (TRIALS - 1.0) / TRIALS;
    const double quantile = gsl_cdf_tdist_Pinv(0.975, TRIALS - 1);
    PM_CHECK_NEAR(s.bias_ci95.high - s.bias, quantile * sqrt(se[0]), 1e-12);
    PM_CHECK_NEAR(s.bias - s.bias_ci95.low, quantile * sqrt(se[0]), 1e-12);
    check_rms_bias(error, all[1], se[1], quantile, &s);
    PM_CHECK_NEAR(log(s.noise_ci95.high / s.noise), quantile * sqrt(se[2]), 1e-12);
    PM_CHECK_NEAR(log(s.rmse / s.rmse_ci95.low), quantile * sqrt(se[3]), 1e-12);
}
END_TEST

/* No error at all, and the same error everywhere: no NaN, no noise. */
START_TEST(summaries_of_constant_errors_are_finite)
{
    for (int constant = 0; constant < 2; constant++) {
        float error[4 * 3];
        double scratch[3 + 3 * 4];
        for (int i = 0; i < 12; i++)
            error[i] = (float)constant;
        const pm__trial_errors errors = {error, 4, 3, 3};
        pm__error_summary s;
        pm__summarize_errors(&errors, scratch, &s);
        PM_CHECK_NEAR(s.bias, constant, 0.0);
        PM_CHECK_NEAR(s.noise, 0.0, 0.0);
        PM_CHECK_NEAR(s.rmse, constant, 0.0);
        PM_CHECK_NEAR(s.rms_bias, constant, 0.0);
        PM_CHECK_NEAR(s.bias_ci95.high - s.bias_ci95.low, 0.0, 0.0);
        ck_assert(isfinite(s.noise_ci95.low) && isfinite(s.noise_ci95.high));
        ck_assert(isfinite(s.rmse_ci95.low) && isfinite(s.rmse_ci95.high));
        ck_assert(isfinite(s.rms_bias_ci95.low) && isfinite(s.rms_bias_ci95.high));
    }
}
END_TEST

START_TEST(median_intervals_cover_with_95_percent)
{
    for (size_t n = 1; n <= 60; n++) {
        double values[60];
        for (size_t i = 0; i < n; i++)
            values[i] = (double)((i * 37) % n); /* a permutation of 0..n-1 unless 37 divides n */
        pm__interval interval;
        const double median = pm__median_interval(values, n, &interval);
        if (n % 37 == 0)
            continue;
        PM_CHECK_NEAR(median, 0.5 * (double)(n - 1), 0.0);
        if (n < 6) {
            PM_CHECK_NEAR(interval.low, 0.0, 0.0);
            PM_CHECK_NEAR(interval.high, (double)(n - 1), 0.0);
            continue;
        }
        /* [x_r, x_(n+1-r)] fails with probability 2 P(Binomial(n, 1/2) < r): at most 5 %, and r + 1 would be too
         * many. */
        const unsigned r = (unsigned)interval.low + 1;
        ck_assert(2.0 * gsl_cdf_binomial_P(r - 1, 0.5, (unsigned)n) <= 0.05);
        ck_assert(2.0 * gsl_cdf_binomial_P(r, 0.5, (unsigned)n) > 0.05);
        PM_CHECK_NEAR(interval.high, (double)n - (double)r, 0.0);
    }
    pm__interval none;
    ck_assert(isnan(pm__median_interval(NULL, 0, &none)));
}
END_TEST

PM_TEST_MAIN("stats", quantiles_agree_with_gsl, gauss_rules_integrate_polynomials,
             summaries_follow_their_definitions, summaries_of_constant_errors_are_finite,
             median_intervals_cover_with_95_percent)
