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

/* Only where there is room. */
static inline void pm__stock_add(pm__stock *stock, const pm_photon *photon, const float normal[3], bool important)
{
    stock->photons[stock->count] = *photon;
    for (int a = 0; a < 3; a++)
        stock->normals[stock->count][a] = normal[a];
    stock->part[stock->count++] = important;
}

void pm__stock_free(pm__stock *stock);

#endif
