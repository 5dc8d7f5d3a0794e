/* pm__random_triple of many numbers at once: PM__LANES (8, 4 or 2) in SIMD, to the same digits. For kernels, which
 * define the width that they are compiled for. */
#ifndef PM_BASE_RANDOM_LANES_H
#define PM_BASE_RANDOM_LANES_H

#include "random.h"

#include <stddef.h>

#ifdef __x86_64__
#include <immintrin.h>
#endif

typedef uint64_t pm__words __attribute__((vector_size(8 * PM__LANES), may_alias));
typedef double pm__doubles __attribute__((vector_size(8 * PM__LANES), may_alias));

/* Of the lower halves, whatever stands above them. */
static inline pm__words pm__product(pm__words a, uint64_t b)
{
    const pm__words factor = (pm__words){0} + b;
#if PM__LANES == 8
    return (pm__words)_mm512_mul_epu32((__m512i)a, (__m512i)factor);
#elif PM__LANES == 4
    return (pm__words)_mm256_mul_epu32((__m256i)a, (__m256i)factor);
#elif defined(__x86_64__)
    return (pm__words)_mm_mul_epu32((__m128i)a, (__m128i)factor);
#else
    return (a & 0xffffffff) * factor;
#endif
}

/* Philox4x32-10 (Salmon et al. 2011, section 3.3): four words of 32 bits, each in the lower half of a lane; what stands
 * above them is left over from products. */
static inline void pm__philox(pm__words c[4], uint64_t seed)
{
    uint32_t key[2] = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    for (int round = 0; round < 10; round++) {
        const pm__words p = pm__product(c[0], 0xD2511F53), q = pm__product(c[2], 0xCD9E8D57);
        c[0] = (q >> 32) ^ c[1] ^ (uint64_t)key[0];
        c[1] = q;
        c[2] = (p >> 32) ^ c[3] ^ (uint64_t)key[1];
        c[3] = p;
        key[0] += 0x9E3779B9;
        key[1] += 0xBB67AE85;
    }
}

/* `count` triples, rounded up to whole registers: u[axis * stride + i] is of number[i]. All as aligned as registers. */
static inline void pm__random_triples(uint64_t seed, pm__purpose purpose, uint32_t trial, uint32_t block,
                                      const uint64_t *number, size_t count, double *u, size_t stride)
{
    for (size_t i = 0; i < count; i += PM__LANES) {
        const pm__words at = *(const pm__words *)(const void *)&number[i];
        pm__words c[4] = {at, (at >> 32 & 0xff) | (uint64_t)purpose << 8, (pm__words){0} + trial,
                          (pm__words){0} + block};
        pm__philox(c, seed);
        for (size_t axis = 0; axis < 3; axis++) {
            /* Of 42 bits: behind the exponent of 2^52 they are a number to be taken off by 2^52, exactly. */
            const pm__words bits = (c[axis] & 0xffffffff) << 10 | (c[3] >> 10 * axis & 0x3ff);
            *(pm__doubles *)(void *)&u[axis * stride + i] =
                ((pm__doubles)(bits | 0x4330000000000000) - 0x1p52) * 0x1p-42;
        }
    }
}

#endif
