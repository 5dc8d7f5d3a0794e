/* The disc estimate, [C02] 2.8 (errata 1, 2): the flux of the k nearest photons over the disc that holds them. */
#include "kernel.h"

enum { LAST };

static const pm__param params[] = {PM__PARAM_LAST};

static inline double weight(const double *values, double t2)
{
    (void)values;
    (void)t2;
    return 1.0;
}

static double weight_slope(const double *values, double t)
{
    (void)values;
    (void)t;
    return 0.0;
}

static double norm(const double *values, int dimensions)
{
    (void)values;
    (void)dimensions;
    return 1.0;
}

static double last(const double *values)
{
    return pm__last_share(values[LAST]);
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    return pm__kernel_estimate(lookup, values, weight, 1.0, last(values), result);
}

const pm__estimator pm__estimator_disc = {
    .entry = {.name = "disc",
              .summary = "flux of the k nearest photons over the disc (ball) that holds them",
              .citation = "Jensen 1996; course 43, eq. 2.8 and 5.5.2",
              .params = params,
              .param_count = 1},
    .dimensions = 4 | 8,
    .min_k = 1,
    .estimate = estimate,
    .weight = weight,
    .weight_slope = weight_slope,
    .norm = norm,
    .last = last,
};
