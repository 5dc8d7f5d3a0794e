/* The kernels of the search `grid`, one a SIMD width, from one source: grid_kernel.h. */
#ifndef PM_SEARCH_GRID_H
#define PM_SEARCH_GRID_H

#include "search.h"

enum { PM__GRID_BATCH = 16 };

typedef struct pm__grid_kernel {
    void (*find)(const pm_map *map, const pm__query *query, pm__result *result);
    void (*find_batch)(const pm_map *map, const pm__query *queries, pm__result *results, size_t count);
} pm__grid_kernel;

extern const pm__grid_kernel pm__grid_plain;
#ifdef __x86_64__
extern const pm__grid_kernel pm__grid_v2, pm__grid_avx2, pm__grid_avx512;
#endif

#endif
