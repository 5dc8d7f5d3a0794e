/* Advice in the making. For advise*.c alone. */
#ifndef PM_CONVERGE_ADVISING_H
#define PM_CONVERGE_ADVISING_H

#include "advise.h"
#include "advise_law.h"

typedef struct pm__advising {
    const pm__advise_config *config;
    pm__advice *advice; /* room for all candidates */
    size_t count;
    double start;       /* s */
    double part;        /* of the work that is done, 0 to 1 */
} pm__advising;

/* Pilots draw other photons than the run that is advised, so that a check is one. */
uint64_t pm__advise_pilot_seed(const pm__advise_config *config);
double pm__advise_time_left(const pm__advising *a);
void pm__advise_unsupported(pm__advice *advice, const char *why);

/* One piece of advice for each estimator. */
pm_status pm__advise_maps(pm__advising *a, const pm__spec *method, pm_error *error);
pm_status pm__advise_verify_map(const pm__advise_config *config, pm__advice *advice, pm_error *error);

/* The same of a progressive method. estimator: NULL where it looks nothing up. */
pm_status pm__advise_passes(pm__advising *a, const pm__spec *method, const pm__spec *estimator, pm_error *error);
pm_status pm__advise_verify_passes(const pm__advise_config *config, pm__advice *advice, pm_error *error);

#endif
