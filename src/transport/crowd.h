/* Stored photons by place, to be searched while they grow more: which lie within a distance that is known beforehand?
 *
 * Cubic cells, hashed by regions of 64, at levels of edges that double. A photon stands at the level of its own reach,
 * the smallest whose edge is no less, and at the neighbouring level that its reach is nearer to; a search looks at the
 * level of its own reach alone. So it sees photons whose reach is between 0.35 and 1.4 edges, about its own, in at most
 * 27 cells, and where reaches jump those on either side do not see each other. */
#ifndef PM_TRANSPORT_CROWD_H
#define PM_TRANSPORT_CROWD_H

#include "../photonmap.h"

/* Four photons: where they are, m, what the caller calls them, and marks them with. */
enum { PM__CROWD_BLOCK = 4 };
typedef struct pm__crowd_block {
    float at[3][PM__CROWD_BLOCK];
    uint32_t ids[PM__CROWD_BLOCK], tags[PM__CROWD_BLOCK];
} pm__crowd_block;

/* Its photons, as they came, fill blocks from `first` on; room: blocks that it may fill. */
typedef struct pm__crowd_cell {
    uint32_t first, count, room;
} pm__crowd_cell;

/* 4 x 4 x 4 cells. Those that have photons are bits of `filled`, and stand in that order from `first` on; room: so many
 * may. */
typedef struct pm__crowd_region {
    uint64_t key, filled;
    uint32_t first, room;
} pm__crowd_region;

enum { PM__CROWD_LEVELS = 128, PM__CROWD_MIDDLE = PM__CROWD_LEVELS / 2 };

typedef struct pm__crowd {
    double inverse_edge[PM__CROWD_LEVELS]; /* 1/m */
    bool one_reach; /* all photons have the same: they stand at its level alone */
    pm__crowd_region *regions; /* by key, open addressing; key 0: free */
    size_t region_count, table_size; /* the latter a power of two */
    pm__crowd_cell *cells;
    size_t cell_count, cell_room;
    pm__crowd_block *blocks;
    size_t used, room;         /* blocks */
    uint16_t *fresh;           /* photons added of late, by a hash of regions */
} pm__crowd;

/* Where a search begins. */
typedef struct pm__crowd_place {
    int64_t cell[3];
    int level; /* PM__CROWD_MIDDLE: of the edge that it was made with */
    uint64_t key;
} pm__crowd_place;

/* Photons of the cells that searches of one run look into, side by side. All zero: empty. */
typedef struct pm__crowd_hood {
    float *at[3];         /* m */
    uint32_t *ids, *tags;
    size_t count, room;
    bool alike;           /* all have the first one's tag */
} pm__crowd_hood;

/* Photons that are told apart by comparing each with every other, and lanes beyond that kernels may write. */
enum { PM__CROWD_FEW = 64, PM__CROWD_SPARE = 16 };

/* What a search finds, in no order: squared distances, m2, and places in the hood. */
typedef struct pm__crowd_found {
    float *distance2;
    uint32_t *places;
    size_t count, room;
} pm__crowd_found;

/* edge: m, > 0. ENOMEM. */
pm_status pm__crowd_init(pm__crowd *crowd, double edge, bool one_reach);
void pm__crowd_free(pm__crowd *crowd);

/* reach: m, > 0 and finite. */
pm__crowd_place pm__crowd_place_of(const pm__crowd *crowd, const float position[3], double reach);

/* ENOMEM: the crowd may hold the photon at one level of two. */
pm_status pm__crowd_add(pm__crowd *crowd, const float position[3], double reach, uint32_t id, uint32_t tag);

/* How many may have been added within a cell's edge of the place since all were settled? Never too few. */
unsigned pm__crowd_fresh(const pm__crowd *crowd, const pm__crowd_place *place);
void pm__crowd_settle(pm__crowd *crowd);

/* The photons of the cells of the place's level that the box meets; it must not go farther than a cell's edge beyond
 * the place's. ENOMEM. */
pm_status pm__crowd_gather(const pm__crowd *crowd, const pm__crowd_place *place, const double low[3],
                           const double high[3], pm__crowd_hood *hood);
void pm__crowd_hood_free(pm__crowd_hood *hood);

/* Room for all that a hood may give. ENOMEM. */
pm_status pm__crowd_found_reserve(pm__crowd_found *found, const pm__crowd_hood *hood);
void pm__crowd_found_free(pm__crowd_found *found);

/* What photons of a hood are given: by band, and a place to spare so that SIMD has an even number. */
typedef double pm__crowd_sum[4];

/* The code in one width of SIMD. Every width finds the same. */
typedef struct pm__crowd_kernel {
    /* Photons of the hood within `reach` of the position; where they are more than `wanted` the nearest so many, of
     * those equally far in one cell the latest (so that of photons heaped in one point none is searched in vain). */
    void (*find)(const pm__crowd_hood *hood, const float position[3], float reach, size_t wanted,
                 pm__crowd_found *found);
    /* The squared distance, m2, of the farthest found; 0: none is. */
    float (*farthest)(const pm__crowd_found *found);
    /* The same to each of them. */
    void (*give)(const uint32_t *places, size_t count, const double part[4], pm__crowd_sum *sums);
} pm__crowd_kernel;

extern const pm__crowd_kernel pm__crowd_plain, pm__crowd_avx2, pm__crowd_avx512;

/* The widest that the processor has and PHOTONBENCH_SIMD lets. */
const pm__crowd_kernel *pm__crowd_choose(void);

#endif
