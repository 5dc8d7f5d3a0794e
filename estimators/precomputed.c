/* Estimates stored at photons and used at the nearest of them, [C02] 5.4. Here is what is evaluated at a photon, whose
 * neighbours include the photon itself at distance 0; which photons carry one and when is the driver's part.
 *
 * Errata 13: given a photon at the query point the others are still Poisson (Slivnyak), so r_n is the (n-1)-th distance
 * of the others and n/(pi r_n^2) has mean n/(n-2). Leaving out the photon itself, which was there for certain, and the
 * farthest, which ended the search, gives (n-2)/(pi r_n^2), which is unbiased at photons. Looked up from elsewhere the
 * mean is lower: photons in thin spots own larger cells. */
#include "kernel.h"

enum { FRACTION, WHEN, FORM };
enum { PRINTED, UNBIASED };

static const pm__param params[] = {
    {"fraction", PM__REAL, 0.25, 1e-6, 1, "", NULL, "of the photons that carry an estimate: every so many"},
    {"when", PM__CHOICE, 0, 0, 0, "", "eager|demand", "all beforehand, or each when it is first asked for"},
    {"form", PM__CHOICE, PRINTED, 0, 0, "", "printed|unbiased",
     "printed counts all n photons, mean n/(n-2) at a photon; unbiased leaves out itself and the farthest: right at "
     "photons, dark where it is looked up"}};

static size_t nearest(const pm__neighbors *set)
{
    size_t best = 0;
    for (size_t i = 1; i < set->count; i++)
        if (set->distance2[i] < set->distance2[best])
            best = i;
    return best;
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    const pm__neighbors *set = &lookup->sets[0];
    const double measure = pm__measure_of(lookup, set->radius2);
    if (!(measure > 0.0))
        return PM_EDEGENERATE;
    const bool unbiased = values[FORM] == UNBIASED;
    const size_t itself = unbiased ? nearest(set) : set->count;
    const size_t farthest = unbiased && !set->cut ? pm__farthest(set) : set->count;
    double sum[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < set->count; i++)
        for (int c = 0; i != itself && i != farthest && c < 3; c++)
            sum[c] += (double)set->flux[i][c];
    for (int c = 0; c < 3; c++)
        result[c] = sum[c] / measure;
    return PM_OK;
}

const pm__estimator pm__estimator_precomputed = {
    .entry = {.name = "precomputed",
              .summary = "the estimate of the nearest photon that carries one",
              .citation = "Christensen 1999; course 43, 5.4",
              .params = params,
              .param_count = 3},
    .needs = PM__AT_PHOTON,
    .dimensions = 4 | 8,
    .min_k = 3,
    .estimate = estimate,
};
