/* Strays: photons of small sets, much more powerful than those of large ones. Where it matters or near there they would
 * be bright dots ([C02] 5.7.4), so each is split there into photons of little more power than others have, which lie
 * where its nearest neighbours do. */
#ifndef PM_TRANSPORT_STRAYS_H
#define PM_TRANSPORT_STRAYS_H

#include "policies/policy.h"

typedef pm_status (*pm__keep)(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken);

/* Keeps arrivals, but for strays that came to important places, and where `everywhere` to others too: these are put
 * aside, unless `strays=keep`. */
pm_status pm__keep_but_strays(pm__storage *storage, const pm__arrivals *arrivals, pm__keep keep, bool everywhere,
                              size_t *taken);

/* Stores them. Where `split`, and config->stored is no end, those in important places and those near by, about
 * within the reach of a lookup of 50, are split: parts, at most 2.4 times as powerful as photons sent evenly, lie
 * each at another of its nearest of the same part whose side it came to; at those again where they are too few. Else
 * their power is given to as many stored photons, and they are stored where there are none. Flux: of each part, to
 * rounding. Cost: some 0.1 us for each photon that lies near important ones, 2 us a stray. */
pm_status pm__place_strays(pm__storage *storage, bool split);

#endif
