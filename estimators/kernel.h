/* The sum that kernel estimators share: flux weighted by distance over the region's measure ([C02] 2.8, 2.11). */
#ifndef PM_ESTIMATORS_KERNEL_H
#define PM_ESTIMATORS_KERNEL_H

#include "estimator.h"

/* `last=full|half|none`: the share of the k-th photon, which lies on the region's rim (errata 1, 5, 6). */
#define PM__PARAM_LAST                                                                                       \
    {                                                                                                        \
        "last", PM__CHOICE, 0, 0, 0, "", "full|half|none",                                                   \
            "share of the k-th photon: none is unbiased for random photons, half for stratified ones"        \
    }

static inline double pm__last_share(double choice)
{
    return 1.0 - 0.5 * choice;
}

/* The farthest photon: the last of them where several tie. */
static inline size_t pm__farthest(const pm__neighbors *set)
{
    size_t farthest = 0;
    for (size_t i = 1; i < set->count; i++)
        if (set->distance2[i] >= set->distance2[farthest])
            farthest = i;
    return farthest;
}

/* sum of weight(values, d2/r2) * flux over photons [from, to). weight is a constant at every call, so it inlines. */
static inline void pm__kernel_sum(const pm__neighbors *set, size_t from, size_t to, const double *values,
                                  double (*weight)(const double *values, double t2), double sum[3])
{
    const double inverse = 1.0 / set->radius2;
    double r = sum[0], g = sum[1], b = sum[2];
    for (size_t i = from; i < to; i++) {
        const double w = weight(values, (double)set->distance2[i] * inverse);
        r += w * (double)set->flux[i][0];
        g += w * (double)set->flux[i][1];
        b += w * (double)set->flux[i][2];
    }
    sum[0] = r;
    sum[1] = g;
    sum[2] = b;
}

/* The estimate: all photons in full where the set is cut by its radius, else the farthest `last` times. */
static inline pm_status pm__kernel_estimate(const pm__lookup *lookup, const double *values,
                                            double (*weight)(const double *values, double t2), double norm,
                                            double last, double result[3])
{
    const pm__neighbors *set = &lookup->sets[0];
    const double divisor = norm * pm__measure_of(lookup, set->radius2);
    if (!(divisor > 0.0))
        return PM_EDEGENERATE;
    const size_t farthest = set->cut || last == 1.0 ? set->count : pm__farthest(set);
    double sum[3] = {0.0, 0.0, 0.0};
    pm__kernel_sum(set, 0, farthest, values, weight, sum);
    if (farthest < set->count) {
        pm__kernel_sum(set, farthest + 1, set->count, values, weight, sum);
        const double w = last * weight(values, 1.0);
        for (int c = 0; c < 3; c++)
            sum[c] += w * (double)set->flux[farthest][c];
    }
    for (int c = 0; c < 3; c++)
        result[c] = sum[c] / divisor;
    return PM_OK;
}

#endif
