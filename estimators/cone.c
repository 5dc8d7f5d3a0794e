/* The cone filter, [C02] 2.10 and 2.11 (errata 5, 6): a photon's weight falls linearly with its distance. */
#include "kernel.h"

enum { K, LAST };

static const pm__param params[] = {
    {"k", PM__REAL, 1.1, 0.1, 1e6, "", NULL,
     "the weight is max(0, 1 - d/(k r)): 1.1 in course 43, 5.5.3, 1 in Jensen 1996; below 1 it is 0 before the rim"},
    PM__PARAM_LAST};

/* inverse: 1/k. */
static inline double cone(const double *inverse, double t2)
{
    const double w = 1.0 - sqrt(t2) * *inverse;
    return w > 0.0 ? w : 0.0;
}

static double weight(const double *values, double t2)
{
    const double inverse = 1.0 / values[K];
    return cone(&inverse, t2);
}

static double weight_slope(const double *values, double t)
{
    return t < values[K] ? -1.0 / values[K] : 0.0;
}

/* d times the integral of t^(d-1) max(0, 1 - t/k) over [0, 1]: [C02] 2.11's 1 - 2/(3k) in the plane, and where k < 1
 * ends the cone before the rim, the k^d/(d+1) of a whole one (errata 5). */
static double norm(const double *values, int dimensions)
{
    const double k = values[K], d = dimensions;
    return k < 1.0 ? pow(k, d) / (d + 1.0) : 1.0 - d / ((d + 1.0) * k);
}

static double last(const double *values)
{
    return pm__last_share(values[LAST]);
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    const double inverse = 1.0 / values[K];
    return pm__kernel_estimate(lookup, &inverse, cone, norm(values, lookup->dimensions), last(values), result);
}

const pm__estimator pm__estimator_cone = {
    .entry = {.name = "cone",
              .summary = "weight falling linearly with distance; last=none is unbiased for random photons",
              .citation = "Jensen 1996; course 43, eq. 2.10, 2.11 and 5.5.3",
              .params = params,
              .param_count = 2},
    .dimensions = 4 | 8,
    .min_k = 1,
    .estimate = estimate,
    .weight = weight,
    .weight_slope = weight_slope,
    .norm = norm,
    .last = last,
};
