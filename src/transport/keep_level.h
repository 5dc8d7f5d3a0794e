/* Keeping by chance, and even powers where it matters. Where a place is important, or near one that is, no photon is to
 * be much more powerful than those about it: it would be a bright dot ([C02] 5.7.4).
 *
 * Near is what is among the 50 nearest of an important photon: those are kept whole, whatever chance says of them,
 * which changes no neighbourhood; and whoever carries more than twice the median of one that it is in gives the rest to
 * its nearest neighbours of the same part and side. */
#ifndef PM_TRANSPORT_KEEP_LEVEL_H
#define PM_TRANSPORT_KEEP_LEVEL_H

#include "keep_chance.h"

/* As pm__keeping has them; storage->own is theirs. Photons that chance does not keep wait until the end, if sending has
 * no end but its own (config->stored is SIZE_MAX): else none are added to those that are stored. Memory: of all that
 * arrives. Flux: of each part what chance leaves of it, to rounding. */
pm_status pm__level_begin(pm__storage *storage);
pm_status pm__level_keep(pm__storage *storage, const pm__arrivals *arrivals, pm__chance chance, size_t *taken);
pm_status pm__level_end(pm__storage *storage);
void pm__level_release(pm__storage *storage);

#endif
