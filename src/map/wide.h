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

/* Where a search may begin, and how wide: a grid over the bulk of the photons, whose cells name a block that lies
 * there, and the squared radii about it that hold PM__HINT_NEAR and PM__HINT_FAR photons. Only a search's time depends
 * on them; cells without photons, and small maps, have none. */
enum { PM__HINT_NEAR = 64, PM__HINT_FAR = 512, PM__HINT_NONE = -1, PM__HINT_STEPS = 128 };

typedef struct pm__hint {
    int32_t block;
    int16_t log_near, log_far; /* log2 of the squared radii, in steps of 1/PM__HINT_STEPS */
} pm__hint;

typedef struct pm__hints {
    float low[3], inverse_edge;
    float last[3];     /* number of the last cell along each axis */
    size_t stride[3];
    size_t count;      /* of cells; 0: no hints */
    pm__hint *cells;
} pm__hints;

typedef struct pm__wide {
    int levels;                        /* >= 1; the top one has one node */
    size_t nodes[PM__WIDE_LEVELS];
    pm__boxes *level[PM__WIDE_LEVELS]; /* level[0] owns the memory of all */
    pm__facing *facing;                /* a block each; NULL: the map has no directions */
    pm__hints hints;
} pm__wide;

static inline const pm__wide *pm__wide_of(const pm_map *map)
{
    return map->index[PM__WIDE];
}

/* The hint of the cell where a position (map units) lies; of the nearest cell where it lies outside. */
static inline const pm__hint *pm__hint_at(const pm__hints *hints, const float position[3])
{
    size_t cell = 0;
    for (int a = 0; a < 3; a++) {
        float t = (position[a] - hints->low[a]) * hints->inverse_edge;
        t = t > 0.0f ? t : 0.0f;
        t = t < hints->last[a] ? t : hints->last[a];
        cell += (size_t)t * hints->stride[a];
    }
    return &hints->cells[cell];
}

/* EBROKEN where a photon lies outside a box above it. */
pm_status pm__wide_check(const pm_map *map, pm_error *error);

#endif
