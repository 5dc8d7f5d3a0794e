/* Strays: photons of small sets, much more powerful than those of large ones. Where it matters or near there they would
 * be bright dots ([C02] 5.7.4), so each is split there into photons of little more power than others have, which lie
 * where its nearest neighbours do. */
#ifndef PM_TRANSPORT_STRAYS_H
#define PM_TRANSPORT_STRAYS_H

#include "policies/policy.h"

typedef pm_status (*pm__keep)(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken);

/* Neither does anything with `strays=keep`, nor where all strata send about evenly. */

/* Remembers which of the stock are strays, from photon `first` on. */
pm_status pm__note_strays(pm__storage *storage, size_t first);

/* Remembers the paths of the stock's photons from `first` on, which are the first of the arrivals, where so many stored
 * are wanted: parts are of that number, but how many there will be is known in the end alone. */
pm_status pm__note_paths(pm__storage *storage, const pm__arrivals *arrivals, size_t first);

/* Splits those in important places and those near by, about within the reach of a lookup of 50: parts, at most 2.4
 * times as powerful as photons sent evenly, lie each at another of its nearest of the same part whose side it came to;
 * at those again where they are too few. Flux: of each part, to rounding. Where so many stored are wanted the last
 * paths are taken back, so that there are no more with the parts (but of one path alone). Cost: some 20 ns a photon of
 * the stock if there are any strays, 0.1 us for each photon near those that are split, 1 us for each of these; some
 * times as much where paths are taken back. */
pm_status pm__split_strays(pm__storage *storage);

/* Keeps arrivals, but for strays that came to important places: these are put aside. */
pm_status pm__keep_but_strays(pm__storage *storage, const pm__arrivals *arrivals, pm__keep keep, size_t *taken);

/* Gives their power in parts to as many stored photons as pm__split_strays would split one into, which carry more
 * then; they are stored where there are none. */
pm_status pm__give_strays(pm__storage *storage);

#endif
