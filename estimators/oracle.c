/* The oracle: the disc whose number of photons is chosen with knowledge of the truth, so that its expected squared
 * error is least. No estimator that only chooses a bandwidth can do better: the floor for the others. */
#include "kernel.h"

enum { LAST };

static const pm__param params[] = {{"last", PM__CHOICE, 0, 0, 0, "", "full|half|none",
                                    "share of the farthest photon used: full as in the disc, none is unbiased"}};

static inline double weight(const double *values, double t2)
{
    (void)values;
    (void)t2;
    return 1.0;
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    pm__neighbors set = lookup->sets[0];
    if (lookup->oracle_k && lookup->oracle_k < set.count) {
        set.count = lookup->oracle_k;
        set.radius2 = (double)set.distance2[set.count - 1];
        set.cut = false;
    }
    pm__lookup best = *lookup;
    best.sets = &set;
    return pm__kernel_estimate(&best, values, weight, 1.0, pm__last_share(values[LAST]), result);
}

static double last(const double *values)
{
    return pm__last_share(values[LAST]);
}

/* A number of photons that does not depend on this lookup's photons leaves (n-1)/(pi r_n^2) unbiased. Below k = 4 the
 * best choice may be a single photon, whose estimate is 0. */
static double uniform_mean(const double *values, size_t k, int dimensions)
{
    (void)dimensions;
    return pm__last_share(values[LAST]) == 0.0 && k >= 4 ? 1.0 : NAN;
}

const pm__estimator pm__estimator_oracle = {
    .entry = {.name = "oracle",
              .summary = "disc with the best number of photons, at most k, known from the truth: the floor for others",
              .citation = "this project",
              .params = params,
              .param_count = 1},
    .needs = PM__SORTED | PM__TRUTH,
    .dimensions = 4 | 8,
    .min_k = 1,
    .estimate = estimate,
    .last = last,
    .uniform_mean = uniform_mean,
};
