/* Statistics of the bench: quantiles, intervals over trials, medians of times. Pure, in double. */
#ifndef PM_STATS_STATS_H
#define PM_STATS_STATS_H

#include <stddef.h>

typedef struct pm__interval {
    double low, high; /* NAN where there is none */
} pm__interval;

/* P(X <= x) of the beta distribution, a, b > 0; relative error about 1e-14. Lentz's continued fraction. */
double pm__beta_cdf(double a, double b, double x);

/* The quantile p (0.5 < p < 1) of Student's t with dof > 0 degrees of freedom. */
double pm__student_quantile(double p, double dof);

/* P(|T| >= |t|) for Student's t with dof > 0 degrees of freedom. */
double pm__student_p(double t, double dof);

/* How far b lies above a (Hodges and Lehmann: the median of all differences b_j - a_i), its distribution-free interval,
 * and the p-value of "the shift is within +- tolerance" (two-sided Mann-Whitney). */
typedef struct pm__shift {
    double shift, p;
    pm__interval interval; /* the range of the differences where na and nb are too small for the level */
} pm__shift;

/* na, nb >= 1; both are sorted in place. Exact for up to 50 of each without ties, else the normal approximation,
 * corrected for ties. Cost: that of sorting. */
void pm__rank_shift(double *a, size_t na, double *b, size_t nb, double level, double tolerance, pm__shift *out);

/* Estimates at `probes` probes in `trials` independent trials, less the truth: error[t * probes + q]. */
typedef struct pm__trial_errors {
    const float *error;
    size_t trials, probes; /* >= 2, >= 1 */
    size_t stride;         /* from one trial to the next, >= probes */
} pm__trial_errors;

typedef struct pm__error_summary {
    double bias, rms_bias, noise, rmse; /* in the unit of the errors; see accuracy.h for the definitions */
    pm__interval bias_ci95, rms_bias_ci95, noise_ci95, rmse_ci95;
} pm__error_summary;

/* Moments and 95 % jackknife intervals over trials. noise and rmse have theirs on a log scale; rms_bias on the scale of
 * its square, by inversion of its test, one-sided (low = 0) where 0 is not excluded. scratch: probes + 3 trials
 * doubles. Cost: two passes. */
void pm__summarize_errors(const pm__trial_errors *errors, double *scratch, pm__error_summary *summary);

/* Of n >= 1 values, which are sorted in place. */
double pm__median(double *values, size_t n);

/* Median and a distribution-free interval for it from order statistics: at least 95 % where n >= 6, else the range.
 * values are sorted in place. */
double pm__median_interval(double *values, size_t n, pm__interval *interval);

#endif
