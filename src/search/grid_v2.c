/* The kernel of `grid` in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#define PM__SIMD_WIDTH 4
#include "grid_kernel.h"

void pm__grid_v2(const pm_map *map, const pm__query *query, pm__result *result)
{
    find_in_grid(map, query, result);
}
#endif
