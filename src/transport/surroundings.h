/* Where photons are, as voxels, and which of these are near some of them: about within the reach of a lookup. */
#ifndef PM_TRANSPORT_SURROUNDINGS_H
#define PM_TRANSPORT_SURROUNDINGS_H

#include "../photonmap.h"

#include <stdatomic.h>
#include <stdbool.h>

enum { PM__VOXEL_SIDE = 64, PM__VOXEL_LEVELS = 4 };

/* Rows of voxels of all levels: of 64, 32, 16, 8 a side. */
enum { PM__VOXEL_ROWS = 64 * 64 + 32 * 32 + 16 * 16 + 8 * 8 };

#define PM__OUTSIDE UINT32_MAX

typedef struct pm__voxels {
    float low[3], per_edge;       /* of the finest; m, 1/m */
    _Atomic uint32_t *counts;     /* photons in each, finest level first */
    _Atomic unsigned char *seeds; /* of the finest: one of those that are asked about is in it */
} pm__voxels;

/* A set of voxels, a bit each, finest level first: once spread the finest alone say it. */
typedef struct pm__reach {
    uint64_t rows[PM__VOXEL_ROWS];
} pm__reach;

/* A box, and a quarter more on each side; outside nothing is near. Photons are counted, from any thread, and it is said
 * in which voxel one lies; then coarser voxels are filled. ENOMEM. */
pm_status pm__voxels_create(const float low[3], const float high[3], pm__voxels *voxels);
uint32_t pm__voxels_count(pm__voxels *voxels, const float position[3], bool seed);
void pm__voxels_gather(pm__voxels *voxels, const pm_parallel *parallel);
void pm__voxels_free(pm__voxels *voxels);

/* Marks the voxel about a place, so large that it holds `enough` photons: k / 4 make its side about the radius of k on
 * a surface. All of them: that about each seed. Spread: those next to marked ones are, too. */
void pm__reach_mark(const pm__voxels *voxels, const float position[3], uint32_t enough, pm__reach *reach);
void pm__reach_mark_all(const pm__voxels *voxels, uint32_t enough, pm__reach *reach);
void pm__reach_spread(pm__reach *reach);

/* voxel: as pm__voxels_count said. */
static inline bool pm__reach_holds(const pm__reach *reach, uint32_t voxel)
{
    return voxel != PM__OUTSIDE && (reach->rows[voxel / PM__VOXEL_SIDE] >> voxel % PM__VOXEL_SIDE & 1);
}

#endif
