/* The search `grid`: picks the kernels of the map's SIMD width. */
#include "grid.h"

static const pm__grid_kernel *kernel_of(const pm_map *map)
{
#ifdef __x86_64__
    switch (map->simd) {
    case PM_SIMD_V2:
        return &pm__grid_v2;
    case PM_SIMD_AVX2:
        return &pm__grid_avx2;
    case PM_SIMD_AVX512:
        return &pm__grid_avx512;
    case PM_SIMD_AUTO:
    case PM_SIMD_PLAIN:
        break;
    }
#else
    (void)map;
#endif
    return &pm__grid_plain;
}

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    if (map->count)
        kernel_of(map)->find(map, query, result);
}

static void find_batch(const pm_map *map, const pm__query *queries, pm__result *results, size_t count)
{
    if (map->count)
        kernel_of(map)->find_batch(map, queries, results, count);
}

const pm_search pm__search_grid = {
    .entry = {.name = "grid", .summary = "fixed radius only: rows of the cells of a uniform grid, scanned by SIMD",
              .citation = "Bentley and Friedman 1979"},
    .structure = PM__GRID,
    .radius_only = true,
    .find = find,
    .find_batch = find_batch,
    .batch = PM__GRID_BATCH,
};
