/* The width of the loops of batch.h. */
#include "batch.h"

#include "../search/wide.h"

const pm__batch_kernel *pm__batch_choose(void)
{
#ifdef __x86_64__
    pm_simd simd;
    if (pm__choose_simd(PM_SIMD_AUTO, &simd, NULL) == PM_OK) {
        if (simd == PM_SIMD_AVX512)
            return &pm__batch_avx512;
        if (simd == PM_SIMD_AVX2)
            return &pm__batch_avx2;
    }
#endif
    return &pm__batch_plain;
}
