/* The Epanechnikov kernel 1 - t2: of all radial kernels the least squared error where the irradiance is curved
 * (errata, section 3). */
#include "kernel.h"

enum { LAST };

static const pm__param params[] = {
    {"last", PM__CHOICE, 0, 0, 0, "", "full|half|none", "share of the k-th photon: all the same, its weight is 0"}};

static inline double weight(const double *values, double t2)
{
    (void)values;
    return 1.0 - t2;
}

static double weight_slope(const double *values, double t)
{
    (void)values;
    return -2.0 * t;
}

/* d times the integral of t^(d-1) (1 - t2) over [0, 1]. */
static double norm(const double *values, int dimensions)
{
    (void)values;
    return dimensions == 3 ? 2.0 / 5.0 : 1.0 / 2.0;
}

static double last(const double *values)
{
    return pm__last_share(values[LAST]);
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    return pm__kernel_estimate(lookup, values, weight, norm(values, lookup->dimensions), last(values), result);
}

const pm__estimator pm__estimator_epanechnikov = {
    .entry = {.name = "epanechnikov",
              .summary = "weight 1 - (d/r)^2: the kernel of least error; unbiased for random photons as it stands",
              .citation = "Epanechnikov 1969; Silverman 1986, 4.2",
              .params = params,
              .param_count = 1},
    .dimensions = 4 | 8,
    .min_k = 2,
    .estimate = estimate,
    .weight = weight,
    .weight_slope = weight_slope,
    .norm = norm,
    .last = last,
};
