/* PM__GRID: photons counted into the cubes of a uniform grid, row by row, for searches of a fixed radius.
 *
 * The grid covers the bulk of the photons; those outside belong to its outermost cells, which have no outer side. So a
 * few photons far off make no cell larger, and memory is bounded for any extent: at most one cell a photon. Where the
 * photons fill them, cells hold about six. */
#ifndef PM_MAP_GRID_H
#define PM_MAP_GRID_H

#include "map.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

/* Places 0..count-1 are ordered by cell; place p is lane p % 16 of block p / 16. Axis o = 0 is the longest: along it
 * the cells of a row follow each other. Invariant: the photons of cell c are those of places starts[c] .. starts[c + 1]
 * - 1, and c = (c2 * cells[1] + c1) * cells[0] + c0 with co = pm__grid_cell(grid, o, position[axis[o]]). */
typedef struct pm__grid {
    unsigned axis[3];
    size_t cells[3];
    double low[3];       /* of the grid, by o; map units */
    double last[3];      /* cells[o] - 1 */
    double inverse_edge; /* of a cell; 0 where all photons are in one point */
    uint32_t *starts;
    const pm__block *blocks; /* positions by place: the map's where the grid gave it its order */
    pm__block *own_blocks;   /* else these */
    uint32_t *numbers;       /* of the photons by place; NULL: the place is the number */
} pm__grid;

static inline const pm__grid *pm__grid_of(const pm_map *map)
{
    return map->index[PM__GRID];
}

/* A coordinate in cells. Never decreases with x, whatever is rounded. */
static inline double pm__grid_coordinate(const pm__grid *grid, unsigned o, double x)
{
    return (x - grid->low[o]) * grid->inverse_edge;
}

/* The cell at that coordinate. Without branches, which compilers like to make of it: what comes next is random. */
static inline size_t pm__grid_clamp(const pm__grid *grid, unsigned o, double t)
{
#ifdef __SSE2__
    const __m128d above = _mm_max_sd(_mm_set_sd(t), _mm_setzero_pd());
    return (size_t)_mm_cvttsd_si64(_mm_min_sd(above, _mm_set_sd(grid->last[o])));
#else
    const double last = grid->last[o], above = t > 0.0 ? t : 0.0;
    return (size_t)(int64_t)(above < last ? above : last);
#endif
}

static inline size_t pm__grid_cell(const pm__grid *grid, unsigned o, double x)
{
    return pm__grid_clamp(grid, o, pm__grid_coordinate(grid, o, x));
}

/* EBROKEN where a photon is not in its cell. */
pm_status pm__grid_check(const pm_map *map, pm_error *error);

#endif
