/* The search `grid`: picks the kernel of the map's SIMD width. */
#include "grid.h"

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    if (!map->count)
        return;
#ifdef __x86_64__
    switch (map->simd) {
    case PM_SIMD_V2:
        pm__grid_v2(map, query, result);
        return;
    case PM_SIMD_AVX2:
        pm__grid_avx2(map, query, result);
        return;
    case PM_SIMD_AVX512:
        pm__grid_avx512(map, query, result);
        return;
    case PM_SIMD_AUTO:
    case PM_SIMD_PLAIN:
        break;
    }
#endif
    pm__grid_plain(map, query, result);
}

const pm_search pm__search_grid = {
    .entry = {.name = "grid", .summary = "fixed radius only: rows of the cells of a uniform grid, scanned by SIMD",
              .citation = "Bentley and Friedman 1979"},
    .structure = PM__GRID,
    .radius_only = true,
    .find = find,
};
