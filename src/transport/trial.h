/* Trial photons: what those of each stratum of emission find of importance. They decide how many are sent, and are not
 * stored themselves. */
#ifndef PM_TRANSPORT_TRIAL_H
#define PM_TRANSPORT_TRIAL_H

#include "harvest.h"
#include "policies/policy.h"
#include "strata.h"

/* What a path finds: importance over the mean of importons, at most 1 at each place that it comes to, added up. */
typedef struct pm__trial_sum {
    double count;      /* photons */
    double finders;    /* of them, those that found anything */
    double found;      /* importance that they came to, 1/m2, added up */
    double square;     /* of what paths find, added up */
    bool is_important; /* one came to an important place */
} pm__trial_sum;

typedef struct pm__trial {
    pm__harvest photons;
    pm__trial_sum *sums; /* of each stratum */
} pm__trial;

/* `tests` photons of each of the first `count` strata; others have sums of 0. Their numbers begin at PM__MOST_TRACED.
 * Sets storage->unit, and adds to storage->tried. Errors as pm__harvest_paths has them; on error nothing is to be
 * freed. */
pm_status pm__trial_run(pm__storage *storage, const pm__strata *strata, size_t count, pm__trial *trial);
void pm__trial_free(pm__trial *trial);

#endif
