/* Keeping by chance: each photon for itself with a probability of its own, its power over that, so that what a place
 * receives is kept in expectation ([C02] 3.5.1). */
#ifndef PM_TRANSPORT_KEEP_CHANCE_H
#define PM_TRANSPORT_KEEP_CHANCE_H

#include "policies/policy.h"

/* The probability of arrival i, in [0, 1]; one of 0 is never kept. Asked by several threads. */
typedef double (*pm__chance)(const pm__storage *storage, const pm__arrivals *arrivals, size_t i);

/* As pm__keeping's keep. chance NULL: all are kept. */
pm_status pm__keep_by_chance(pm__storage *storage, const pm__arrivals *arrivals, pm__chance chance, size_t *taken);

/* What its power is multiplied with there; 0: it is not kept. */
float pm__chance_factor(const pm__storage *storage, const pm__arrivals *arrivals, pm__chance chance, size_t i);

#endif
