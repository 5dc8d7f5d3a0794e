/* What an estimator is.
 *
 * It sees neighbours only: their flux, distance, offset, and the query's point and normal; never the tree.
 * It says what it needs, the driver supplies it. Flux is already multiplied by the BRDF where reflected
 * radiance is asked for, so an estimator is a pure density estimate. */
#ifndef PM_ESTIMATORS_ESTIMATOR_H
#define PM_ESTIMATORS_ESTIMATOR_H

#include "../src/base/param.h"

#include <math.h>

/* One lookup's photons. Distances are in map units: distance2 / radius2 is unit-free, radius2 * unit^2 is m2. */
typedef struct pm__neighbors {
    size_t count;            /* photons found */
    bool cut;                /* the radius was reached before k photons (or none were asked for): the region is
                                the whole sphere of `radius2`, every photon is inside it, none is the last */
    const float *distance2;  /* ascending where the estimator needs PM__SORTED; count of them */
    const float (*flux)[3];  /* W (x BRDF) */
    const float (*offset)[3]; /* photon - query point, map units; NULL unless PM__OFFSETS */
    double radius2;          /* of the region, map units squared: of the k-th photon, or of the cut */
    bool blurred;            /* single precision cannot tell these distances: there is no estimate, EDEGENERATE */
} pm__neighbors;

/* A whole lookup: one set of neighbours a map. */
typedef struct pm__lookup {
    const pm__neighbors *sets;
    size_t set_count;
    int dimensions;     /* 2: divide by areas, 3: by volumes */
    float normal[3];    /* unit */
    double unit;        /* m in a map unit, the same for all sets */
    size_t oracle_k;    /* PM__TRUTH: how many photons to use */
    void *scratch;      /* working memory for the call, aligned for any type, the caller's; contents do not matter.
                           NULL only where the estimator's scratch_per_photon is 0 */
    size_t scratch_size; /* bytes: at least scratch_per_photon for each photon of all sets */
} pm__lookup;

enum {
    PM__SORTED = 1,     /* neighbours in ascending order */
    PM__OFFSETS = 2,    /* offsets of the photons */
    PM__MAPS = 4,       /* several maps: parameter `maps` says how many */
    PM__TRUTH = 8,      /* a k chosen with knowledge of the truth: only a bench can supply it */
    PM__AT_PHOTON = 16  /* is evaluated at photons and looked up at the nearest: [C02] 5.4 */
};

typedef struct pm__estimator {
    pm__entry entry;
    unsigned needs;
    unsigned dimensions; /* bit d set: works in d dimensions (4: surfaces, 8: media) */
    size_t min_k;        /* a map: fewer asked for is PM_EINVAL */
    size_t scratch_per_photon; /* bytes of pm__lookup.scratch needed for each photon; 0: none */

    /* The estimate in each band, W/m2 or W/m3. values: the spec's parameters. An empty neighbourhood (all
     * sets) never comes here: it is 0. EDEGENERATE where no region is spanned, EINVAL where scratch is short. */
    pm_status (*estimate)(const double *values, const pm__lookup *lookup, double result[3]);

    /* For estimators of the form  sum w(d/r) flux / (norm * measure), measure = pi r^2 or 4/3 pi r^3:
     * w at t2 = (d/r)^2 in [0, 1], its derivative by t = d/r, and the divisor. NULL elsewhere.
     * last: the share of the k-th photon's weight that counts. From these follow exact predictions. */
    double (*weight)(const double *values, double t2);
    double (*weight_slope)(const double *values, double t);
    double (*norm)(const double *values, int dimensions);
    double (*last)(const double *values);

    /* Expected estimate / truth for independent photons of constant density where it is known in closed form
     * and the above does not give it; NAN where it is not known. NULL: not known. */
    double (*uniform_mean)(const double *values, size_t k, int dimensions);
    /* uniform_mean holds up to the edges of a convex domain too (theorem T1 of docs/errata.md). */
    bool (*holds_at_edges)(const double *values);
} pm__estimator;

extern const pm__catalogue pm__estimators;

/* pi r^2 or 4/3 pi r^3 of the set, in m2 or m3. */
static inline double pm__measure_of(const pm__lookup *lookup, double radius2)
{
    const double pi = 3.14159265358979323846;
    const double r2 = radius2 * lookup->unit * lookup->unit;
    return lookup->dimensions == 3 ? 4.0 / 3.0 * pi * r2 * sqrt(r2) : pi * r2;
}

#endif
