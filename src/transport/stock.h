/* Photons that a policy has stored so far, in the order in which it did. */
#ifndef PM_TRANSPORT_STOCK_H
#define PM_TRANSPORT_STOCK_H

#include "../photonmap.h"

#include <stdbool.h>

typedef struct pm__stock {
    pm_photon *photons;      /* power: in units of the storage, as if the number of photons emitted were 1 */
    float (*normals)[3];
    unsigned char *part;     /* 1: in a place that is important */
    size_t count, capacity;
} pm__stock;

/* Room for `more` photons behind those that there are. ENOMEM: the stock is as before. */
pm_status pm__stock_reserve(pm__stock *stock, size_t more);

/* As photon `at`, only where there is room. */
static inline void pm__stock_put(pm__stock *stock, size_t at, const pm_photon *photon, const float normal[3],
                                 bool important)
{
    stock->photons[at] = *photon;
    for (int a = 0; a < 3; a++)
        stock->normals[at][a] = normal[a];
    stock->part[at] = important;
}

static inline void pm__stock_add(pm__stock *stock, const pm_photon *photon, const float normal[3], bool important)
{
    pm__stock_put(stock, stock->count++, photon, normal, important);
}

void pm__stock_free(pm__stock *stock);

/* Powers of all bands, to the sums: of all, and of those that lie in important places. */
void pm__add_powers(const pm_photon *photons, const unsigned char *part, size_t count, double sums[2]);

/* How many of `count` arrivals, of which some are kept, are taken: all, or those up to the end of the path before that
 * by which `wanted` photons are stored. numbers: of their paths, 0 being `first`. kept NULL: all are. Path 0 of all is
 * never left out. */
size_t pm__stock_taken(const pm__stock *stock, size_t wanted, const unsigned char *kept, const uint32_t *numbers,
                       uint64_t first, size_t count);

#endif
