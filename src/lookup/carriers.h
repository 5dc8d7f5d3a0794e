/* The photons that carry an estimate, [C02] 5.4.1: a share of all, evenly taken from the caller's order. (The course
 * takes the top of its tree; which photons are on top depends on the structure, and an estimate should not.) They have
 * a map of their own, in the caller's order so that ties go as everywhere. */
#ifndef PM_LOOKUP_CARRIERS_H
#define PM_LOOKUP_CARRIERS_H

#include "lookup.h"

typedef struct pm__carriers {
    pm_map *map;
    uint32_t *number;     /* in the whole map, of each carrier in carrier order */
    float (*normals)[3];  /* surface normals in carrier order; NULL where none are known */
    size_t count;
} pm__carriers;

/* normals: of all photons in the caller's order, or NULL. ENOMEM leaves nothing behind. */
pm_status pm__carriers_create(pm__carriers *carriers, const pm_map *map, double fraction, const float (*normals)[3],
                              const pm_parallel *parallel);
void pm__carriers_destroy(pm__carriers *carriers);

/* The carrier nearest to the query that its filters accept and whose normal is similar to the query's (where normals
 * are known), or SIZE_MAX. Cost: a search for 1; again for 8, 64, ... while normals differ. */
pm_status pm__nearest_carrier(const pm__carriers *carriers, const pm_query *query, pm_workspace *workspace,
                              size_t *carrier);

/* 5.4.1: "with a surface normal similar to" the other's; of any length above 0. */
bool pm__similar_normals(const float a[3], const float b[3]);

/* The query at carrier `index`, made from a template: its position and normal; no shape and no filter where the
 * normal is not known. */
pm_query pm__carrier_query(const pm__carriers *carriers, const pm_map *map, const pm_query *lookup, size_t index);

#endif
