/* The kernel of `grid` in this width; the Makefile compiles this file for it. */
#define PM__SIMD_WIDTH 0
#include "grid_kernel.h"

void pm__grid_plain(const pm_map *map, const pm__query *query, pm__result *result)
{
    find_in_grid(map, query, result);
}
