/* The kernels of the search `wide`, one a SIMD width, from one source: wide_kernel.h. */
#ifndef PM_SEARCH_WIDE_H
#define PM_SEARCH_WIDE_H

#include "search.h"

enum { PM__WIDE_BATCH = 16 };

typedef struct pm__wide_kernel {
    void (*find)(const pm_map *map, const pm__query *query, pm__result *result);
    void (*find_batch)(const pm_map *map, const pm__query *queries, pm__result *results, size_t count);
} pm__wide_kernel;

extern const pm__wide_kernel pm__wide_plain;
#ifdef __x86_64__
extern const pm__wide_kernel pm__wide_v2, pm__wide_avx2, pm__wide_avx512;
#endif

/* Fills the hints of a map's PM__WIDE structure: its own searches tell the local densities. ENOMEM is possible. */
pm_status pm__wide_hint(const pm_map *map, const pm_parallel *parallel);

/* The width to use where `asked` is wanted; EINVAL where the processor lacks it, or PHOTONBENCH_SIMD names none. */
pm_status pm__choose_simd(pm_simd asked, pm_simd *chosen, pm_error *error);
const char *pm__simd_name(pm_simd simd);

#endif
