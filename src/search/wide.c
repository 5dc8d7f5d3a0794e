/* The search `wide`: picks the kernel of the map's SIMD width. */
#include "wide.h"

#include <stdlib.h>
#include <string.h>

static const pm__wide_kernel *kernel_of(const pm_map *map)
{
#ifdef __x86_64__
    switch (map->simd) {
    case PM_SIMD_V2:
        return &pm__wide_v2;
    case PM_SIMD_AVX2:
        return &pm__wide_avx2;
    case PM_SIMD_AVX512:
        return &pm__wide_avx512;
    case PM_SIMD_AUTO:
    case PM_SIMD_PLAIN:
        break;
    }
#else
    (void)map;
#endif
    return &pm__wide_plain;
}

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    kernel_of(map)->find(map, query, result);
}

static void find_batch(const pm_map *map, const pm__query *queries, pm__result *results, size_t count)
{
    kernel_of(map)->find_batch(map, queries, results, count);
}

const pm_search pm__search_wide = {
    .entry = {.name = "wide",
              .summary = "SIMD over 16-ary boxes and blocks of 16 photons; guesses a radius, collects, selects once",
              .citation = "this project"},
    .structure = PM__WIDE,
    .finish = pm__wide_hint,
    .find = find,
    .find_batch = find_batch,
    .batch = PM__WIDE_BATCH,
};

static const char *const names[] = {"auto", "plain", "v2", "avx2", "avx512"};

const char *pm__simd_name(pm_simd simd)
{
    return (unsigned)simd < sizeof names / sizeof *names ? names[simd] : "none";
}

static bool available(pm_simd simd)
{
#ifdef __x86_64__
    __builtin_cpu_init();
    switch (simd) {
    case PM_SIMD_V2:
        return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
    case PM_SIMD_AVX2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
    case PM_SIMD_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("bmi2");
    case PM_SIMD_AUTO:
    case PM_SIMD_PLAIN:
        break;
    }
#endif
    return simd == PM_SIMD_PLAIN;
}

pm_status pm__choose_simd(pm_simd asked, pm_simd *chosen, pm_error *error)
{
    const char *const forced = asked == PM_SIMD_AUTO ? getenv("PHOTONBENCH_SIMD") : NULL;
    if (forced && *forced) {
        for (unsigned i = 1; i < sizeof names / sizeof *names; i++)
            if (!strcmp(forced, names[i]))
                asked = (pm_simd)i;
        if (asked == PM_SIMD_AUTO)
            return pm__fail(error, PM_EINVAL, "PHOTONBENCH_SIMD is '%.40s': plain, v2, avx2 and avx512 are known",
                            forced);
    }
    if (asked == PM_SIMD_AUTO)
        for (asked = PM_SIMD_AVX512; !available(asked);)
            asked = (pm_simd)(asked - 1);
    if ((unsigned)asked >= sizeof names / sizeof *names || !available(asked))
        return pm__fail(error, PM_EINVAL, "this processor has no %s", pm__simd_name(asked));
    *chosen = asked;
    return PM_OK;
}
