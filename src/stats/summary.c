/* Error moments over trials and probes, with jackknife intervals over trials.
 *
 * With m_t, s_t the means over probes of e and e^2 in trial t, S_q the sum of e at probe q and c_t the mean over probes
 * of S_q e_tq, every leave-one-out estimate follows from m_t, s_t and c_t, so the jackknife costs no more passes. */
#include "stats.h"

#include <math.h>
#include <string.h>

/* What the estimates need of a set of n trials: means of e, of e^2, and of the squared trial mean. */
typedef struct moments {
    double n, mean, square, mean_square;
} moments;

static double variance_of(const moments *m)
{
    return m->n > 1.0 ? fmax(0.0, m->n * (m->square - m->mean_square) / (m->n - 1.0)) : 0.0;
}

/* The mean squared bias: the mean square of the trial means less what noise adds to it. */
static double squared_bias_of(const moments *m)
{
    return m->mean_square - variance_of(m) / m->n;
}

static double log_noise(const moments *m)
{
    return 0.5 * log(variance_of(m));
}

static double log_rmse(const moments *m)
{
    return 0.5 * log(m->square);
}

static double mean_of(const moments *m)
{
    return m->mean;
}

/* Sums over trials, enough for all leave-one-out moments. */
typedef struct sums {
    const pm__trial_errors *errors;
    double *m, *s, *c; /* one a trial */
    double total_m, total_s, total_a;
} sums;

static moments all_trials(const sums *u)
{
    const double n = (double)u->errors->trials;
    return (moments){n, u->total_m / n, u->total_s / n, u->total_a / (n * n)};
}

static moments without(const sums *u, size_t t)
{
    const double n = (double)u->errors->trials - 1.0;
    return (moments){n, (u->total_m - u->m[t]) / n, (u->total_s - u->s[t]) / n,
                     (u->total_a - 2.0 * u->c[t] + u->s[t]) / (n * n)};
}

static void add_up(sums *u, double *sum_of_probe)
{
    const pm__trial_errors *const e = u->errors;
    const double probes = (double)e->probes;
    memset(sum_of_probe, 0, e->probes * sizeof *sum_of_probe);
    for (size_t t = 0; t < e->trials; t++) {
        double m = 0.0, s = 0.0;
        for (size_t q = 0; q < e->probes; q++) {
            const double x = (double)e->error[t * e->stride + q];
            sum_of_probe[q] += x;
            m += x;
            s += x * x;
        }
        u->m[t] = m / probes;
        u->s[t] = s / probes;
        u->total_m += u->m[t];
        u->total_s += u->s[t];
    }
    for (size_t t = 0; t < e->trials; t++) {
        double c = 0.0;
        for (size_t q = 0; q < e->probes; q++)
            c += sum_of_probe[q] * (double)e->error[t * e->stride + q];
        u->c[t] = c / probes;
    }
    for (size_t q = 0; q < e->probes; q++)
        u->total_a += sum_of_probe[q] * sum_of_probe[q] / probes;
}

/* 1.96 standard errors, or rather Student's quantile of them, of a function of the moments. NAN where it is not finite
 * for some trial left out. */
static double half_width(const sums *u, double (*function)(const moments *), double quantile)
{
    const size_t n = u->errors->trials;
    double mean = 0.0, square = 0.0;
    for (size_t t = 0; t < n; t++) {
        const moments m = without(u, t);
        mean += function(&m);
    }
    mean /= (double)n;
    for (size_t t = 0; t < n; t++) {
        const moments m = without(u, t);
        const double d = function(&m) - mean;
        square += d * d;
    }
    return quantile * sqrt((double)(n - 1) / (double)n * square);
}

static pm__interval around_log(double log_value, double half)
{
    if (!isfinite(log_value) || !isfinite(half)) /* no error at all in some set of trials */
        return (pm__interval){0.0, isfinite(log_value) ? exp(log_value) : 0.0};
    return (pm__interval){exp(log_value - half), exp(log_value + half)};
}

enum { PAIRED_TRIALS = 32 };

/* The variance of the mean over probes of the squared noise of the trial mean: 2 tr(C^2) / n^2, C the covariance
 * between probes (over their number). Off the diagonal the products of two trials' deviations have the variance
 * tr(C^2), so a few trials tell it. sum_of_probe: sums over all trials. */
static double noise_square_variance(const sums *u, const double *sum_of_probe)
{
    const pm__trial_errors *const e = u->errors;
    const size_t n = e->trials < PAIRED_TRIALS ? e->trials : PAIRED_TRIALS;
    double sum = 0.0, square = 0.0, pairs = 0.0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            const float *const a = e->error + i * e->trials / n * e->stride;
            const float *const b = e->error + j * e->trials / n * e->stride;
            double product = 0.0;
            for (size_t q = 0; q < e->probes; q++) {
                const double mean = sum_of_probe[q] / (double)e->trials;
                product += ((double)a[q] - mean) * ((double)b[q] - mean);
            }
            product /= (double)e->probes;
            sum += product;
            square += product * product;
            pairs += 1.0;
        }
    const double trials = (double)e->trials, mean = sum / pairs;
    return 2.0 * fmax(0.0, square / pairs - mean * mean) / (trials * trials);
}

/* Squared bias x from its unbiased estimate U, whose variance at x is 4 x s2 + v: s2 the noise along the bias, v that
 * of the squared noise. The interval is {x: |U - x| <= q sqrt(4 x s2 + v)}: unlike U +- q (standard error at U) it
 * keeps its coverage where noise has by chance cancelled most of the bias. */
static pm__interval squared_bias_interval(double u, double s2, double v, double q)
{
    const double middle = u + 2.0 * q * q * s2;
    const double half = sqrt(fmax(0.0, middle * middle - u * u + q * q * v));
    return (pm__interval){middle - half, middle + half};
}

static void fill_rms_bias(const sums *u, const double *sum_of_probe, double two_sided, double one_sided,
                          pm__error_summary *out)
{
    const moments all = all_trials(u);
    const double squared = squared_bias_of(&all), width = half_width(u, squared_bias_of, 1.0);
    const double v = noise_square_variance(u, sum_of_probe);
    /* Noise along the bias, as the jackknife saw it; where the bias hardly stands out of the noise its direction is not
     * known, and the largest that noise can be in any direction stands in. */
    double along = all.mean_square > 0.0 ? width * width / (4.0 * all.mean_square) : 0.0;
    along = fmax(along, sqrt(0.5 * v) * fmin(1.0, sqrt(v) / fmax(squared, 1e-300)));
    pm__interval x = squared_bias_interval(squared, along, v, two_sided);
    if (x.low <= 0.0)
        x = (pm__interval){0.0, squared_bias_interval(squared, along, v, one_sided).high};
    out->rms_bias = sqrt(fmax(0.0, squared));
    out->rms_bias_ci95 = (pm__interval){sqrt(x.low), sqrt(fmax(0.0, x.high))};
}

static void fill_summary(const sums *u, const double *sum_of_probe, pm__error_summary *out)
{
    const moments all = all_trials(u);
    const double dof = all.n - 1.0;
    const double two_sided = pm__student_quantile(0.975, dof), one_sided = pm__student_quantile(0.95, dof);

    out->bias = all.mean;
    const double half = half_width(u, mean_of, two_sided);
    out->bias_ci95 = (pm__interval){all.mean - half, all.mean + half};

    fill_rms_bias(u, sum_of_probe, two_sided, one_sided, out);

    out->noise = sqrt(variance_of(&all));
    out->noise_ci95 = around_log(log_noise(&all), all.n > 2.0 ? half_width(u, log_noise, two_sided) : INFINITY);
    out->rmse = sqrt(all.square);
    out->rmse_ci95 = around_log(log_rmse(&all), half_width(u, log_rmse, two_sided));
}

void pm__summarize_errors(const pm__trial_errors *errors, double *scratch, pm__error_summary *summary)
{
    double *const per_trial = scratch + errors->probes;
    sums u = {errors, per_trial, per_trial + errors->trials, per_trial + 2 * errors->trials, 0.0, 0.0, 0.0};
    add_up(&u, scratch);
    fill_summary(&u, scratch, summary);
}
