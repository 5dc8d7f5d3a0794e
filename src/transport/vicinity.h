/* Whether anything of a map can be near: a box of voxels, each of which is marked where a photon may lie within the
 * reach of a point in it. For very many points of which most lie far from all photons. */
#ifndef PM_TRANSPORT_VICINITY_H
#define PM_TRANSPORT_VICINITY_H

#include "../photonmap.h"

#include <stdbool.h>
#include <stddef.h>

enum { PM__VOXELS = 64 }; /* on each side of the box */

typedef struct pm__vicinity {
    float low[3], per_edge; /* map units, one over them */
    unsigned char *marked;  /* [z][y][x]; NULL: anything may be near anywhere */
} pm__vicinity;

/* reach: map units, > 0. ENOMEM. Cost: 1 ms, and a pass over the photons. */
pm_status pm__vicinity_create(const pm_map *map, double reach, pm__vicinity *vicinity);
void pm__vicinity_free(pm__vicinity *vicinity); /* an empty one is allowed */

/* false: no photon lies within reach of the place (map units, finite). */
static inline bool pm__vicinity_holds(const pm__vicinity *vicinity, const float place[3])
{
    size_t at = 0;
    if (!vicinity->marked)
        return true;
    for (int axis = 2; axis >= 0; axis--) {
        const float x = (place[axis] - vicinity->low[axis]) * vicinity->per_edge;
        if (!(x >= 0.0f && x < (float)PM__VOXELS))
            return false;
        at = at * PM__VOXELS + (size_t)x;
    }
    return vicinity->marked[at];
}

#endif
