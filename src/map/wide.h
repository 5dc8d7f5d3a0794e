/* PM__WIDE: 16-ary boxes over blocks of 16 photons, the structure behind the search `wide`.
 *
 * A node is 16 boxes, child by child, in structure-of-arrays form: one SIMD pass measures all. Nothing points: a node
 * of level 0 stands over blocks 16 n .. 16 n + 15, one of level t over nodes 16 n .. 16 n + 15 of level t - 1. The
 * map's photons are in the order that makes this true: split by rank at multiples of full blocks, so that all blocks
 * but the last are full. Boxes of children that do not exist are empty (low = +INFINITY, high = -INFINITY). */
#ifndef PM_MAP_WIDE_H
#define PM_MAP_WIDE_H

#include "map.h"

typedef struct pm__boxes {
    float low[3][PM__LANES], high[3][PM__LANES];
} pm__boxes;

/* Unit directions of a block's photons, rounded to 1/127: enough to tell the front from the back but for grazing
 * ones. */
typedef struct pm__facing {
    int8_t axis[3][PM__LANES];
} pm__facing;

enum { PM__WIDE_LEVELS = 8 };

typedef struct pm__wide {
    int levels;                        /* >= 1; the top one has one node */
    size_t nodes[PM__WIDE_LEVELS];
    pm__boxes *level[PM__WIDE_LEVELS]; /* level[0] owns the memory of all */
    pm__facing *facing;                /* a block each */
} pm__wide;

static inline const pm__wide *pm__wide_of(const pm_map *map)
{
    return map->index[PM__WIDE];
}

/* EBROKEN where a photon lies outside a box above it. */
pm_status pm__wide_check(const pm_map *map, pm_error *error);

#endif
