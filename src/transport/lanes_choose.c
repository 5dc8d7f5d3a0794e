/* The width of the loops of lanes.h. */
#include "lanes.h"

#include "../search/wide.h"

const pm__lanes *pm__lanes_choose(void)
{
#ifdef __x86_64__
    pm_simd simd;
    if (pm__choose_simd(PM_SIMD_AUTO, &simd, NULL) == PM_OK) {
        if (simd == PM_SIMD_AVX512)
            return &pm__lanes_avx512;
        if (simd == PM_SIMD_AVX2)
            return &pm__lanes_avx2;
    }
#endif
    return &pm__lanes_plain;
}
