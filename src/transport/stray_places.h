/* In whose places the parts of strays lie: see strays.h. */
#ifndef PM_TRANSPORT_STRAY_PLACES_H
#define PM_TRANSPORT_STRAY_PLACES_H

#include "send_strata.h"

typedef struct pm__stray_places {
    const pm__stray *strays;
    pm__stray *own;          /* the same, if they are not the sender's */
    size_t stray_count;
    size_t *first;           /* in alike, of each stray; [stray_count + 1] */
    size_t *count;           /* of each stray: 0 where nobody is alike */
    uint32_t *alike;         /* numbers in the stock: up to as many of its nearest as it has parts, 256 at most */
} pm__stray_places;

pm__stray pm__stray_of(const pm__storage *storage, const pm_photon *photon, const float normal[3], bool important);

/* Those of sender->places that lie near important photons: numbers are of the stock as it is. ENOMEM; what there is is
 * to be freed in any case. */
pm_status pm__find_near_importance(pm__storage *storage, pm__stray_places *places);

/* All those of sender->strays. */
pm_status pm__find_near_strays(pm__storage *storage, pm__stray_places *places);

void pm__stray_places_free(pm__stray_places *places);

#endif
