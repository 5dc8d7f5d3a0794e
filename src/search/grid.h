/* The kernels of the search `grid`, one a SIMD width, from one source: grid_kernel.h. */
#ifndef PM_SEARCH_GRID_H
#define PM_SEARCH_GRID_H

#include "search.h"

typedef void pm__grid_kernel(const pm_map *map, const pm__query *query, pm__result *result);

pm__grid_kernel pm__grid_plain;
#ifdef __x86_64__
pm__grid_kernel pm__grid_v2, pm__grid_avx2, pm__grid_avx512;
#endif

#endif
