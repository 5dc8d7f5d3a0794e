/* Inside a pm_map: photons in an order of their own, and the structures that searches walk. */
#ifndef PM_MAP_MAP_H
#define PM_MAP_MAP_H

#include "../base/status.h"

enum { PM__LANES = 16 };

/* Positions of 16 photons, map units relative to the map's centre; lanes beyond the last photon are +INFINITY, so that
 * no distance to them is ever small enough. */
typedef struct pm__block {
    float x[PM__LANES], y[PM__LANES], z[PM__LANES];
} pm__block;

/* What searches walk. Each structure is one file here, with a row in `structures` of structure.h. */
typedef enum pm__structure_id {
    PM__NO_STRUCTURE,
    PM__KD_TREE,
    PM__WIDE,
    PM__GRID,
    PM__GROWN,
    PM__STRUCTURES
} pm__structure_id;

/* What a photon carries beside its position, in floats: its power, W, then its direction, for what asks for one mostly
 * asks for both; or the power alone, where no directions are kept. */
enum { PM__POWER = 3, PM__POWER_AND_DIRECTION = 6 };

/* Invariants: photon `number` (0..count-1) is lane number % 16 of block number / 16; ids[number] is its index in the
 * caller's array, a permutation of 0..count-1. */
struct pm_map {
    size_t count;
    size_t block_count;    /* ceil(count / 16) */
    pm__block *blocks;
    uint32_t *ids;
    float *carried;        /* by number, carried_size each */
    size_t carried_size;   /* PM__POWER or PM__POWER_AND_DIRECTION */
    double centre[3];      /* m */
    double unit;           /* m in a map unit: a power of two */
    double inverse_unit;
    double max_power;
    const pm_search *search; /* what it was created for */
    pm_simd simd;
    pm_split split;
    void *index[PM__STRUCTURES]; /* NULL: not built */
};

/* The photon as it is sorted into a structure. */
typedef struct pm__item {
    float position[3]; /* map units */
    uint32_t id;       /* the caller's index: the tie-breaker of every order */
} pm__item;

/* Builds a map whose order is that of structure `primary`. */
pm_status pm__map_build(const pm_photon *photons, size_t count, pm__structure_id primary, const pm_map_options *options,
                        pm_map **map, pm_error *error);

/* Adds a structure to a map that has another order. EINVAL where the structure can only be the first. */
pm_status pm__map_add(pm_map *map, pm__structure_id structure, const pm_parallel *parallel, pm_error *error);

static inline void pm__position(const pm_map *map, size_t number, float position[3])
{
    const pm__block *const block = &map->blocks[number / PM__LANES];
    position[0] = block->x[number % PM__LANES];
    position[1] = block->y[number % PM__LANES];
    position[2] = block->z[number % PM__LANES];
}

static inline bool pm__has_directions(const pm_map *map)
{
    return map->carried_size == PM__POWER_AND_DIRECTION;
}

/* W. */
static inline const float *pm__power(const pm_map *map, size_t number)
{
    return map->carried + number * map->carried_size;
}

/* Only of a map that has directions. */
static inline const float *pm__direction(const pm_map *map, size_t number)
{
    return map->carried + number * map->carried_size + PM__POWER;
}

/* Takes what the map keeps of photon `number`. */
static inline void pm__carry(const pm_map *map, size_t number, const pm_photon *photon)
{
    float *const carried = map->carried + number * map->carried_size;
    for (int c = 0; c < 3; c++)
        carried[c] = photon->power[c];
    if (pm__has_directions(map))
        for (int a = 0; a < 3; a++)
            carried[PM__POWER + a] = photon->direction[a];
}

/* ---- the left-balanced kd-tree, PM__KD_TREE ------------------------------------------------------ */

/* A photon as the tree searches see it. 16 bytes, so four share a cache line. */
typedef struct pm__node {
    float position[3];
    uint32_t number_axis; /* number << 2 | split axis */
} pm__node;

/* index[PM__KD_TREE] is nodes[0..count], nodes[0] unused. Invariants: nodes[1..count] is a left-balanced kd-tree in
 * heap order: the children of i are 2i and 2i+1, those beyond count do not exist. With a = axis of i, every node of the
 * left subtree comes before i, every node of the right one after it, in the order (position[a], id). */
static inline const pm__node *pm__tree(const pm_map *map)
{
    return map->index[PM__KD_TREE];
}

static inline uint32_t pm__node_number(const pm__node *node)
{
    return node->number_axis >> 2;
}

static inline unsigned pm__node_axis(const pm__node *node)
{
    return node->number_axis & 3U;
}

/* Number of nodes in the left subtree of a left-balanced tree of `count` nodes (errata 18). */
size_t pm__left_size(size_t count);

/* Puts the item of rank `rank` along the axis in its place, those before it before it (order: coordinate, then id).
 * O(n), and O(n log n) for any input. */
void pm__select_rank(pm__item *items, size_t count, size_t rank, unsigned axis);

#endif
