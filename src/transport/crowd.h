/* Stored photons by place, to be searched while they grow more: which lie within a distance that is known beforehand?
 *
 * A hash of cubic cells at levels of edges that double. A photon stands at the level of its own reach, the smallest
 * whose edge is no less, and at the neighbouring level that its reach is nearer to; a search looks at the level of its
 * own reach alone. So it sees photons whose reach is between 0.35 and 1.4 edges, about its own, in at most 27 cells,
 * and where reaches jump those on either side do not see each other. */
#ifndef PM_TRANSPORT_CROWD_H
#define PM_TRANSPORT_CROWD_H

#include "../photonmap.h"

/* Slots first .. first + count - 1 are its photons', as they came; room: slots that it may fill. */
typedef struct pm__crowd_cell {
    uint64_t key;
    uint32_t first, count, room;
} pm__crowd_cell;

typedef struct pm__crowd {
    double edge;   /* m, of level 0 */
    bool one_reach; /* all photons have the same: they stand at its level alone */
    pm__crowd_cell *cells;
    size_t cell_count, cell_room;
    uint32_t *table;      /* of cells by key, open addressing; NO_CELL: free */
    size_t table_size;    /* a power of two */
    float *at[3];         /* of slots, m */
    uint32_t *ids, *tags; /* of slots: what the caller calls the photon, and marks it with */
    size_t used, room;    /* slots */
    uint16_t *fresh;      /* photons added of late, by a hash of blocks of cells */
} pm__crowd;

/* Where a search begins. */
typedef struct pm__crowd_place {
    int64_t cell[3];
    int level;
    uint64_t key;
} pm__crowd_place;

/* Cells that searches of one run look into. */
typedef struct pm__crowd_run {
    uint32_t cells[27];
    size_t count;
} pm__crowd_run;

enum { PM__CROWD_FOUND = 2048, PM__CROWD_SPARE = 16 };

/* What a search finds, in no order. */
typedef struct pm__crowd_found {
    size_t count;
    float distance2[PM__CROWD_FOUND + PM__CROWD_SPARE]; /* m2 */
    uint32_t slots[PM__CROWD_FOUND + PM__CROWD_SPARE];
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

/* The cells of the place's level that the box meets; it must not go farther than a cell's edge beyond the place's. */
void pm__crowd_gather(const pm__crowd *crowd, const pm__crowd_place *place, const double low[3], const double high[3],
                      pm__crowd_run *run);

/* The code in one width of SIMD. Every width finds the same. */
typedef struct pm__crowd_kernel {
    /* Photons of the run's cells within `reach` of the position; where they are more than `wanted` the nearest so many,
     * of those equally far in one cell the latest (so that of photons heaped in one point none is searched in vain).
     * wanted: from 1 to 512. Returns the squared distance, m2, of the farthest found; 0: none is found. */
    float (*find)(const pm__crowd *crowd, const pm__crowd_run *run, const float position[3], float reach, size_t wanted,
                  pm__crowd_found *found);
} pm__crowd_kernel;

extern const pm__crowd_kernel pm__crowd_plain, pm__crowd_avx2, pm__crowd_avx512;

/* The widest that the processor has and PHOTONBENCH_SIMD lets. */
const pm__crowd_kernel *pm__crowd_choose(void);

#endif
