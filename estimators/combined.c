/* Lookups in several maps put together, [C02] 5.6 (errata 10 to 12).
 *
 * The maps' powers together carry the whole light. `mean` adds the maps' irradiances, P_m/(pi r_m^2) each; `pooled` is
 * the course's better form, M sum P_m / sum pi r_m^2.
 * Maps that do not fill their share of k: one that is cut has the whole sphere of the cut for its region, empty or
 * not, and no photon on its rim. One without a region (no photons and no cut) is left out, of M too.
 *
 * `last`. mean: of each map's own farthest photon. pooled: of one photon in all n, since for random photons the
 * maps' areas together have the law of the n-th photon's in a single map (errata 11); every photon of the maps that
 * are not cut bears its part, so that no map's farthest is singled out. */
#include "kernel.h"

enum { MAPS, RULE, DEAL, LAST };
enum { MEAN, POOLED };

static const pm__param params[] = {
    {"maps", PM__INTEGER, 4, 2, 64, "", NULL, "how many maps share the k photons, at least 3 each"},
    {"rule", PM__CHOICE, POOLED, 0, 0, "", "mean|pooled",
     "pooled: M sum P over sum pi r2; mean: irradiances added, with last=full (k/M)/(k/M-1) too bright"},
    {"deal", PM__CHOICE, 1, 0, 0, "", "separate|random|roundrobin",
     "how photons get into maps: a sample of its own each, at random, or in turn (lattices if stratified)"},
    PM__PARAM_LAST};

/* What the maps looked up so far have. */
typedef struct pool {
    double open[3]; /* flux in maps that are not cut */
    double cut[3];  /* flux in maps that are */
    double measure;
    double photons; /* in maps that are not cut */
    double maps;    /* with a region */
} pool;

static void add_flux(const pm__neighbors *set, double sum[3])
{
    for (size_t i = 0; i < set->count; i++)
        for (int c = 0; c < 3; c++)
            sum[c] += (double)set->flux[i][c];
}

static void add_set(pool *all, const pm__neighbors *set, double measure)
{
    add_flux(set, set->cut ? all->cut : all->open);
    all->measure += measure;
    all->photons += set->cut ? 0.0 : (double)set->count;
    all->maps += 1.0;
}

static bool has_region(const pm__neighbors *set)
{
    return set->cut || set->count;
}

static pm_status pooled(const pm__lookup *lookup, double last, double result[3])
{
    pool all = {.maps = 0.0};
    for (size_t m = 0; m < lookup->set_count; m++)
        if (has_region(&lookup->sets[m]))
            add_set(&all, &lookup->sets[m], pm__measure_of(lookup, lookup->sets[m].radius2));
    if (!(all.measure > 0.0))
        return PM_EDEGENERATE;
    const double share = all.photons > 0.0 ? (all.photons - (1.0 - last)) / all.photons : 1.0;
    for (int c = 0; c < 3; c++)
        result[c] = all.maps * (share * all.open[c] + all.cut[c]) / all.measure;
    return PM_OK;
}

static inline double even(const double *values, double t2)
{
    (void)values;
    (void)t2;
    return 1.0;
}

static pm_status mean(const pm__lookup *lookup, double last, double result[3])
{
    double sum[3] = {0.0, 0.0, 0.0};
    pm__lookup one = *lookup;
    for (size_t m = 0; m < lookup->set_count; m++) {
        double part[3];
        one.sets = &lookup->sets[m];
        if (!has_region(one.sets))
            continue;
        const pm_status status = pm__kernel_estimate(&one, NULL, even, 1.0, last, part);
        if (status)
            return status;
        for (int c = 0; c < 3; c++)
            sum[c] += part[c];
    }
    for (int c = 0; c < 3; c++)
        result[c] = sum[c];
    return PM_OK;
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    const double last = pm__last_share(values[LAST]);
    return values[RULE] == MEAN ? mean(lookup, last, result) : pooled(lookup, last, result);
}

/* Errata 10, 11. A map's share of k differs from another's by one at most. */
static double uniform_mean(const double *values, size_t k, int dimensions)
{
    (void)dimensions;
    const size_t maps = (size_t)values[MAPS], share = k / maps, larger = k % maps;
    const double last = pm__last_share(values[LAST]);
    if (share < 2)
        return NAN;
    if (values[RULE] == POOLED)
        return 1.0 + last / ((double)k - 1.0);
    const double excess = (double)(maps - larger) / ((double)share - 1.0) + (double)larger / (double)share;
    return 1.0 + last * excess / (double)maps;
}

const pm__estimator pm__estimator_combined = {
    .entry = {.name = "combined",
              .summary = "lookups in several maps, k photons in all; last=none is unbiased for random photons",
              .citation = "course 43, 5.6",
              .params = params,
              .param_count = 4},
    .needs = PM__MAPS,
    .dimensions = 4 | 8,
    .min_k = 3,
    .estimate = estimate,
    .uniform_mean = uniform_mean,
};
