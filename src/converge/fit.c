/* Slopes of error over passes, with intervals from leaving trials out one by one: points of one curve are far from
 * independent, trials are not. */
#include "measure.h"

#include "../base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A bias is fitted where it stands so many standard errors clear. */
static const double clear = 5.0;

double pm__slope(const double *x, const double *y, size_t count)
{
    double mx = 0.0, my = 0.0, xy = 0.0, xx = 0.0;
    for (size_t i = 0; i < count; i++) {
        mx += x[i] / (double)count;
        my += y[i] / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        xy += (x[i] - mx) * (y[i] - my);
        xx += (x[i] - mx) * (x[i] - mx);
    }
    return xy / xx;
}

/* ---- Values of one record, with all trials and without each ------------------------------------ */

static double mean_error(const pm__record_set *set, const float *e, const double *profile)
{
    double sum = 0.0, weight = 0.0;
    for (size_t v = 0; v < set->values; v++) {
        const double p = profile ? profile[v] : 1.0;
        sum += (double)e[v] * p;
        weight += p * p;
    }
    return profile ? sum / weight : sum / weight * set->scale;
}

pm__along pm__bias_along(const pm__record_set *set, size_t record, double *without)
{
    const double n = (double)set->trials;
    const double *const profile = set->profile ? set->profile + record * set->values : NULL;
    const float *const errors = pm__record_errors(set, record);
    double sum = 0.0, squares = 0.0;
    for (size_t t = 0; t < set->trials; t++) {
        without[t] = mean_error(set, errors + t * set->records * set->values, profile);
        sum += without[t];
    }
    for (size_t t = 0; t < set->trials; t++) {
        squares += (without[t] - sum / n) * (without[t] - sum / n);
        without[t] = (sum - without[t]) / (n - 1.0);
    }
    return (pm__along){sum / n, sqrt(squares / (n - 1.0) / n)};
}

/* Variance and mean square of a record: [t] with trial t left out, [trials] with all. From the sum of all squares, q,
 * that of squared sums over trials, a, and each trial's products with those sums. */
static pm_status find_moments(const pm__record_set *set, size_t record, double *variance, double *square)
{
    const size_t values = set->values, step = set->records * values;
    const float *const errors = pm__record_errors(set, record);
    double *const sum = pm__alloc_zero(values, sizeof *sum);
    double q = 0.0, a = 0.0;
    if (!sum)
        return PM_ENOMEM;
    for (size_t t = 0; t < set->trials; t++)
        for (size_t v = 0; v < values; v++)
            sum[v] += (double)errors[t * step + v];
    for (size_t v = 0; v < values; v++)
        a += sum[v] * sum[v];
    for (size_t t = 0; t < set->trials; t++) { /* the trial's own sums take the place of what is made of them below */
        square[t] = variance[t] = 0.0;
        for (size_t v = 0; v < values; v++) {
            const double e = (double)errors[t * step + v];
            square[t] += e * e;
            variance[t] += sum[v] * e;
        }
        q += square[t];
    }
    const double n = (double)set->trials;
    variance[set->trials] = (q - a / n) / (n - 1.0) / (double)values;
    square[set->trials] = q / n / (double)values;
    for (size_t t = 0; t < set->trials; t++) {
        const double left = a - 2.0 * variance[t] + square[t];
        variance[t] = n > 2.0 ? (q - square[t] - left / (n - 1.0)) / (n - 2.0) / (double)values : NAN;
        square[t] = (q - square[t]) / (n - 1.0) / (double)values;
    }
    free(sum);
    return PM_OK;
}

/* ---- Fits -------------------------------------------------------------------------------------- */

/* logs[(trials + 1) * records]: ln of the quantity without each trial, and with all. */
static void fit(const pm__record_set *set, size_t first, const double *logs, pm__converge_fit *result)
{
    const size_t count = set->records - first, n = set->trials;
    double x[PM__MOST_RECORDS], mean = 0.0, squares = 0.0;
    for (size_t r = 0; r < count; r++)
        x[r] = log((double)set->passes[first + r]);
    result->slope = pm__slope(x, logs + n * set->records + first, count);
    for (size_t t = 0; t < n; t++)
        mean += pm__slope(x, logs + t * set->records + first, count) / (double)n;
    for (size_t t = 0; t < n; t++) {
        const double off = pm__slope(x, logs + t * set->records + first, count) - mean;
        squares += off * off;
    }
    result->slope_error = sqrt(((double)n - 1.0) / (double)n * squares);
    result->fits = isfinite(result->slope) && isfinite(result->slope_error) && result->slope_error > 0.0 && n > 2;
    if (!result->fits) {
        (void)snprintf(result->detail, sizeof result->detail, "%s",
                       n < 3                       ? "an interval takes three trials"
                       : !isfinite(result->slope) ? "not above 0 after each of these passes"
                                                   : "trials do not differ");
        return;
    }
    const double half = pm__student_quantile(0.975, (double)n - 1.0) * result->slope_error;
    result->slope_ci95 = (pm__interval){result->slope - half, result->slope + half};
}

/* The law over the same passes. */
static void predict(const pm__record_set *set, size_t first, const double *law, pm__converge_fit *result)
{
    double x[PM__MOST_RECORDS], y[PM__MOST_RECORDS];
    for (size_t r = first; r < set->records; r++) {
        x[r - first] = log((double)set->passes[r]);
        y[r - first] = log(fabs(law[r]));
    }
    result->predicted = pm__slope(x, y, set->records - first);
}

/* The first passes are left out where there are many: radii that depend on few photons are not yet as expected. */
static size_t first_record(const pm__record_set *set)
{
    size_t first = 0;
    while (set->passes[first] < 4 && set->records - first > 4)
        first++;
    return first;
}

static pm_status fit_moments(const pm__record_set *set, size_t first, pm__converge_fit *variance,
                             pm__converge_fit *rmse)
{
    const size_t n = set->trials + 1;
    double *const m = pm__alloc(4 * n * set->records, sizeof *m);
    if (!m)
        return PM_ENOMEM;
    double *const logs = m, *const logs_square = m + n * set->records, *const v = logs_square + n * set->records,
                  *const s = v + n;
    pm_status status = PM_OK;
    for (size_t r = 0; r < set->records && status == PM_OK; r++) {
        status = find_moments(set, r, v, s);
        for (size_t t = 0; t < n && status == PM_OK; t++) {
            logs[t * set->records + r] = log(v[t]);
            logs_square[t * set->records + r] = 0.5 * log(s[t]);
        }
    }
    if (status == PM_OK) {
        fit(set, first, logs, variance);
        fit(set, first, logs_square, rmse);
    }
    free(m);
    return status;
}

/* law: of the bias's size; what is measured along a profile is a share of it. */
static pm_status fit_bias(const pm__record_set *set, size_t first, const double *law, pm__converge_fit *bias)
{
    const size_t n = set->trials;
    double *const logs = pm__alloc((n + 1) * set->records, sizeof *logs);
    double *const without = pm__alloc(n, sizeof *without);
    pm_status status = logs && without ? PM_OK : PM_ENOMEM;
    uint32_t faint = 0;
    for (size_t r = 0; r < set->records && status == PM_OK; r++) {
        const pm__along along = pm__bias_along(set, r, without);
        const double size = set->profile ? fabs(law[r]) : 1.0;
        if (r >= first && !faint && !(fabs(along.value) > clear * along.error))
            faint = set->passes[r];
        for (size_t t = 0; t <= n; t++)
            logs[t * set->records + r] = log(fabs(t < n ? without[t] : along.value) * size);
    }
    if (status == PM_OK && faint)
        (void)snprintf(bias->detail, sizeof bias->detail, "after %u pass%s the bias is not %g standard errors clear",
                       faint, faint == 1 ? "" : "es", clear);
    else if (status == PM_OK)
        fit(set, first, logs, bias);
    free(logs);
    free(without);
    return status;
}

pm_status pm__fit_all(const pm__record_set *set, const double law[PM__QUANTITIES][PM__MOST_RECORDS],
                      pm__converge_fit fits[PM__QUANTITIES], pm_error *error)
{
    const size_t first = first_record(set);
    for (int q = 0; q < PM__QUANTITIES; q++) {
        fits[q] = (pm__converge_fit){.quantity = (pm__quantity)q,
                                     .first_pass = set->passes[first],
                                     .last_pass = set->passes[set->records - 1],
                                     .slope = NAN,
                                     .slope_error = NAN,
                                     .slope_ci95 = {NAN, NAN},
                                     .predicted = NAN,
                                     .asymptote = NAN};
        if (set->records - first < 3)
            (void)snprintf(fits[q].detail, sizeof fits[q].detail, "a line takes three readings");
        else
            predict(set, first, law[q], &fits[q]);
    }
    if (set->records - first < 3)
        return PM_OK;
    pm_status status = fit_moments(set, first, &fits[PM__VARIANCE], &fits[PM__RMSE]);
    if (status == PM_OK)
        status = fit_bias(set, first, law[PM__BIAS], &fits[PM__BIAS]);
    return status == PM_OK ? PM_OK : pm__fail(error, status, "out of memory for fits");
}
