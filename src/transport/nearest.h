/* The nearest photon that came to a side, for very many points of few places: cells of space remember which photons may
 * be it. What is answered is what pm_map_search answers for k = 1 and front_only, to the last tie, whatever cells know
 * already: so it does not depend on who asked before. */
#ifndef PM_TRANSPORT_NEAREST_H
#define PM_TRANSPORT_NEAREST_H

#include "../photonmap.h"

typedef struct pm__nearest pm__nearest;

/* map: with directions, and photons in it; borrowed. reach: m, none farther is wanted. spacing: m, about how far
 * photons lie apart where most of the points will be: cells are about so large. ENOMEM. */
pm_status pm__nearest_create(const pm_map *map, double reach, double spacing, pm__nearest **nearest);
void pm__nearest_destroy(pm__nearest *nearest); /* NULL is allowed */

enum { PM__NEAREST_AT_ONCE = 16 };

/* Of `count` points, at most so many: numbers in the map (UINT32_MAX: there is none) and squared distances in map
 * units. NaN: there is none. From any number of threads. Cost: 50 to 100 ns a point; for the first few in a cell, with
 * a normal like theirs, a search each, and a few times as much once. */
void pm__nearest_find(pm__nearest *nearest, const float (*positions)[3], const float (*normals)[3], size_t count,
                      pm_neighbor *found);

#endif
