#include "vicinity.h"

#include "../base/memory.h"
#include "../map/map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ALL = PM__VOXELS * PM__VOXELS * PM__VOXELS };

/* The box about all photons, wider by their reach and by what rounding may do. */
static double box_of(const pm_map *map, double reach, double low[3])
{
    double edge = 0.0, high[3];
    float place[3];
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
    for (size_t i = 0; i < pm_map_count(map); i++) {
        pm__position(map, (uint32_t)i, place);
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fmin(low[axis], (double)place[axis]);
            high[axis] = fmax(high[axis], (double)place[axis]);
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        const double margin = 1.001 * reach + 1e-5 * (fabs(low[axis]) + fabs(high[axis]));
        low[axis] -= margin;
        edge = fmax(edge, (high[axis] + margin - low[axis]) / (PM__VOXELS - 1));
    }
    return edge;
}

static void mark_photons(const pm_map *map, pm__vicinity *v)
{
    float place[3];
    for (size_t i = 0; i < pm_map_count(map); i++) {
        size_t at = 0;
        pm__position(map, (uint32_t)i, place);
        for (int axis = 2; axis >= 0; axis--)
            at = at * PM__VOXELS + (size_t)((place[axis] - v->low[axis]) * v->per_edge);
        v->marked[at] = 1;
    }
}

/* Along one axis, by so many voxels to both sides: the sum over a window that moves on. */
static void widen(unsigned char *line, size_t stride, int by)
{
    unsigned char before[PM__VOXELS];
    int sum = 0;
    for (int i = 0; i < PM__VOXELS; i++)
        before[i] = line[(size_t)i * stride];
    for (int i = 0; i < by && i < PM__VOXELS; i++)
        sum += before[i];
    for (int i = 0; i < PM__VOXELS; i++) {
        sum += i + by < PM__VOXELS ? before[i + by] : 0;
        sum -= i - by - 1 >= 0 ? before[i - by - 1] : 0;
        line[(size_t)i * stride] = sum > 0;
    }
}

static void widen_all(unsigned char *marked, int by)
{
    const size_t n = PM__VOXELS;
    for (size_t i = 0; i < n * n; i++)
        widen(marked + i * n, 1, by);
    for (size_t i = 0; i < n * n; i++)
        widen(marked + i / n * n * n + i % n, n, by);
    for (size_t i = 0; i < n * n; i++)
        widen(marked + i, n * n, by);
}

pm_status pm__vicinity_create(const pm_map *map, double reach, pm__vicinity *vicinity)
{
    double low[3];
    const double edge = box_of(map, reach, low);
    *vicinity = (pm__vicinity){.marked = NULL};
    if (!(edge > 0.0 && edge < 1e18 && reach < 1e18))
        return PM_OK; /* floats do not tell places apart so far off */
    vicinity->marked = pm__alloc_zero(ALL, 1);
    if (!vicinity->marked)
        return PM_ENOMEM;
    for (int axis = 0; axis < 3; axis++)
        vicinity->low[axis] = (float)low[axis];
    vicinity->per_edge = (float)(1.0 / edge);
    mark_photons(map, vicinity);
    widen_all(vicinity->marked, (int)fmin(floor(1.001 * reach / edge) + 1.0, PM__VOXELS));
    return PM_OK;
}

void pm__vicinity_free(pm__vicinity *vicinity)
{
    free(vicinity->marked);
    vicinity->marked = NULL;
}
