/* One SIMD vocabulary for the kernels, in the width that PM__SIMD_WIDTH asks for (0: plain C, 4, 8, 16 lanes).
 * Comparisons are false on NaN. No operation contracts or reorders, so every width rounds alike. */
#ifndef PM_SEARCH_SIMD_H
#define PM_SEARCH_SIMD_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if PM__SIMD_WIDTH == 16
#include <immintrin.h>
enum { V = 16 };
typedef __m512 vf;
static inline vf v_load(const float *p) { return _mm512_loadu_ps(p); }
static inline vf v_set(float x) { return _mm512_set1_ps(x); }
static inline vf v_add(vf a, vf b) { return _mm512_add_ps(a, b); }
static inline vf v_sub(vf a, vf b) { return _mm512_sub_ps(a, b); }
static inline vf v_mul(vf a, vf b) { return _mm512_mul_ps(a, b); }
static inline vf v_max(vf a, vf b) { return _mm512_max_ps(a, b); }
static inline vf v_min(vf a, vf b) { return _mm512_min_ps(a, b); }
static inline void v_store(float *p, vf a) { _mm512_storeu_ps(p, a); }
static inline float v_least(vf a) { return _mm512_reduce_min_ps(a); }
static inline unsigned v_le(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
static inline unsigned v_lt(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
/* a + b in the lanes of the mask, a in the others. */
static inline vf v_add_where(vf a, vf b, unsigned mask) { return _mm512_mask_add_ps(a, (__mmask16)mask, a, b); }
static inline vf v_bytes(const int8_t *p)
{
    return _mm512_cvtepi32_ps(_mm512_cvtepi8_epi32(_mm_loadu_si128((const __m128i *)(const void *)p)));
}
/* The lanes of the mask to the front; V lanes are written. */
static inline void v_compress(float *to, vf a, unsigned mask)
{
    _mm512_storeu_ps(to, _mm512_maskz_compress_ps((__mmask16)mask, a));
}
static inline void v_compress_bits(uint32_t *to, const uint32_t *from, unsigned mask)
{
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32((__mmask16)mask, _mm512_loadu_si512(from)));
}
/* base + lane number of the lanes of the mask. */
static inline void v_compress_lanes(uint32_t *to, uint32_t base, unsigned mask)
{
    const __m512i lanes = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32((__mmask16)mask,
                                                         _mm512_add_epi32(_mm512_set1_epi32((int)base), lanes)));
}
/* Which of V numbers are not above t. */
static inline unsigned v_up_to(const uint32_t *p, uint32_t t)
{
    return _mm512_cmple_epu32_mask(_mm512_loadu_si512(p), _mm512_set1_epi32((int)t));
}
/* Pairs of a and base + lane number of the lanes of the mask; nothing is written beyond `room` pairs. */
static inline void v_pairs(void *to, size_t room, vf a, uint32_t base, unsigned mask)
{
    const __m512i lanes = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    const __m512i first = _mm512_set_epi32(23, 7, 22, 6, 21, 5, 20, 4, 19, 3, 18, 2, 17, 1, 16, 0);
    const __m512i second = _mm512_add_epi32(first, _mm512_set1_epi32(8));
    const __m512i numbers = _mm512_add_epi32(_mm512_set1_epi32((int)base), lanes);
    const __m512i value = _mm512_castps_si512(_mm512_maskz_compress_ps((__mmask16)mask, a));
    const __m512i number = _mm512_maskz_compress_epi32((__mmask16)mask, numbers);
    const __m512i low = _mm512_permutex2var_epi32(value, first, number);
    const __m512i high = _mm512_permutex2var_epi32(value, second, number);
    const unsigned written = _pext_u32(mask, mask);
    (void)room; /* masks cost less than a branch that is often mistaken */
    _mm512_mask_storeu_epi64(to, (__mmask8)written, low);
    _mm512_mask_storeu_epi64((char *)to + 64, (__mmask8)(written >> 8), high);
}

#elif PM__SIMD_WIDTH == 8
#include <immintrin.h>
enum { V = 8 };
typedef __m256 vf;
static inline vf v_load(const float *p) { return _mm256_loadu_ps(p); }
static inline vf v_set(float x) { return _mm256_set1_ps(x); }
static inline vf v_add(vf a, vf b) { return _mm256_add_ps(a, b); }
static inline vf v_sub(vf a, vf b) { return _mm256_sub_ps(a, b); }
static inline vf v_mul(vf a, vf b) { return _mm256_mul_ps(a, b); }
static inline vf v_max(vf a, vf b) { return _mm256_max_ps(a, b); }
static inline vf v_min(vf a, vf b) { return _mm256_min_ps(a, b); }
static inline void v_store(float *p, vf a) { _mm256_storeu_ps(p, a); }
static inline float v_least(vf a)
{
    const __m128 four = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1));
    const __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
}
static inline unsigned v_le(vf a, vf b) { return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)); }
static inline unsigned v_lt(vf a, vf b) { return (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)); }
static inline vf v_add_where(vf a, vf b, unsigned mask)
{
    const __m256i bits = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
    const __m256i lanes = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)mask), bits), bits);
    return _mm256_add_ps(a, _mm256_and_ps(b, _mm256_castsi256_ps(lanes)));
}
static inline vf v_bytes(const int8_t *p)
{
    return _mm256_cvtepi32_ps(_mm256_cvtepi8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)p)));
}
static inline __m256i v_order(unsigned mask)
{
    const uint64_t lanes = _pdep_u64(mask, 0x0101010101010101u) * 0xff;
    return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)_pext_u64(0x0706050403020100u, lanes)));
}
static inline void v_compress(float *to, vf a, unsigned mask)
{
    _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(a, v_order(mask)));
}
static inline void v_compress_bits(uint32_t *to, const uint32_t *from, unsigned mask)
{
    _mm256_storeu_si256(
        (__m256i *)(void *)to,
        _mm256_permutevar8x32_epi32(_mm256_loadu_si256((const __m256i *)(const void *)from), v_order(mask)));
}
static inline void v_compress_lanes(uint32_t *to, uint32_t base, unsigned mask)
{
    _mm256_storeu_si256((__m256i *)(void *)to, _mm256_add_epi32(_mm256_set1_epi32((int)base), v_order(mask)));
}
static inline unsigned v_up_to(const uint32_t *p, uint32_t t)
{
    const __m256i limit = _mm256_set1_epi32((int)t);
    const __m256i more = _mm256_max_epu32(_mm256_loadu_si256((const __m256i *)(const void *)p), limit);
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(more, limit)));
}
static inline void v_all_pairs(void *to, vf a, uint32_t base, unsigned mask)
{
    const __m256i order = v_order(mask), number = _mm256_add_epi32(_mm256_set1_epi32((int)base), order);
    const __m256i value = _mm256_castps_si256(_mm256_permutevar8x32_ps(a, order));
    const __m256i low = _mm256_unpacklo_epi32(value, number), high = _mm256_unpackhi_epi32(value, number);
    _mm256_storeu_si256((__m256i *)to, _mm256_permute2x128_si256(low, high, 0x20));
    _mm256_storeu_si256((__m256i *)(void *)((char *)to + 32), _mm256_permute2x128_si256(low, high, 0x31));
}

#elif PM__SIMD_WIDTH == 4
#include <smmintrin.h>
enum { V = 4 };
typedef __m128 vf;
static inline vf v_load(const float *p) { return _mm_loadu_ps(p); }
static inline vf v_set(float x) { return _mm_set1_ps(x); }
static inline vf v_add(vf a, vf b) { return _mm_add_ps(a, b); }
static inline vf v_sub(vf a, vf b) { return _mm_sub_ps(a, b); }
static inline vf v_mul(vf a, vf b) { return _mm_mul_ps(a, b); }
static inline vf v_max(vf a, vf b) { return _mm_max_ps(a, b); }
static inline vf v_min(vf a, vf b) { return _mm_min_ps(a, b); }
static inline void v_store(float *p, vf a) { _mm_storeu_ps(p, a); }
static inline float v_least(vf a)
{
    const __m128 two = _mm_min_ps(a, _mm_movehl_ps(a, a));
    return _mm_cvtss_f32(_mm_min_ss(two, _mm_shuffle_ps(two, two, 1)));
}
static inline unsigned v_le(vf a, vf b) { return (unsigned)_mm_movemask_ps(_mm_cmple_ps(a, b)); }
static inline unsigned v_lt(vf a, vf b) { return (unsigned)_mm_movemask_ps(_mm_cmplt_ps(a, b)); }
static inline vf v_add_where(vf a, vf b, unsigned mask)
{
    const __m128i bits = _mm_set_epi32(8, 4, 2, 1);
    const __m128i lanes = _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32((int)mask), bits), bits);
    return _mm_add_ps(a, _mm_and_ps(b, _mm_castsi128_ps(lanes)));
}
static inline vf v_bytes(const int8_t *p)
{
    int32_t four;
    memcpy(&four, p, sizeof four);
    return _mm_cvtepi32_ps(_mm_cvtepi8_epi32(_mm_cvtsi32_si128(four)));
}
/* For each mask the lanes that it holds, lowest first, two bits a lane. */
static inline __m128i v_order(unsigned mask)
{
    static const uint8_t lanes[16][4] = {
        {0, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {2, 0, 0, 0}, {0, 2, 0, 0}, {1, 2, 0, 0}, {0, 1, 2, 0},
        {3, 0, 0, 0}, {0, 3, 0, 0}, {1, 3, 0, 0}, {0, 1, 3, 0}, {2, 3, 0, 0}, {0, 2, 3, 0}, {1, 2, 3, 0}, {0, 1, 2, 3}};
    int32_t four;
    memcpy(&four, lanes[mask], sizeof four);
    return _mm_cvtepu8_epi32(_mm_cvtsi32_si128(four));
}
static inline __m128i v_bytes_of_order(__m128i order)
{
    const __m128i four = _mm_mullo_epi32(order, _mm_set1_epi32(0x04040404));
    return _mm_add_epi8(four, _mm_set1_epi32(0x03020100));
}
static inline void v_compress(float *to, vf a, unsigned mask)
{
    const __m128i bytes = v_bytes_of_order(v_order(mask));
    _mm_storeu_ps(to, _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(a), bytes)));
}
static inline void v_compress_bits(uint32_t *to, const uint32_t *from, unsigned mask)
{
    const __m128i bytes = v_bytes_of_order(v_order(mask));
    _mm_storeu_si128((__m128i *)(void *)to,
                     _mm_shuffle_epi8(_mm_loadu_si128((const __m128i *)(const void *)from), bytes));
}
static inline void v_compress_lanes(uint32_t *to, uint32_t base, unsigned mask)
{
    _mm_storeu_si128((__m128i *)(void *)to, _mm_add_epi32(_mm_set1_epi32((int)base), v_order(mask)));
}
static inline unsigned v_up_to(const uint32_t *p, uint32_t t)
{
    const __m128i limit = _mm_set1_epi32((int)t);
    const __m128i more = _mm_max_epu32(_mm_loadu_si128((const __m128i *)(const void *)p), limit);
    return (unsigned)_mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(more, limit)));
}
static inline void v_all_pairs(void *to, vf a, uint32_t base, unsigned mask)
{
    const __m128i order = v_order(mask), number = _mm_add_epi32(_mm_set1_epi32((int)base), order);
    const __m128i value = _mm_shuffle_epi8(_mm_castps_si128(a), v_bytes_of_order(order));
    _mm_storeu_si128((__m128i *)to, _mm_unpacklo_epi32(value, number));
    _mm_storeu_si128((__m128i *)(void *)((char *)to + 16), _mm_unpackhi_epi32(value, number));
}

#else
enum { V = 4 };
typedef struct vf {
    float lane[4];
} vf;
#define PM__LANEWISE(expression)      \
    vf r;                             \
    for (int i = 0; i < V; i++)       \
        r.lane[i] = (expression);     \
    return r
static inline vf v_load(const float *p) { PM__LANEWISE(p[i]); }
static inline vf v_set(float x) { PM__LANEWISE(x); }
static inline vf v_add(vf a, vf b) { PM__LANEWISE(a.lane[i] + b.lane[i]); }
static inline vf v_sub(vf a, vf b) { PM__LANEWISE(a.lane[i] - b.lane[i]); }
static inline vf v_mul(vf a, vf b) { PM__LANEWISE(a.lane[i] * b.lane[i]); }
static inline vf v_max(vf a, vf b) { PM__LANEWISE(a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i]); }
static inline vf v_min(vf a, vf b) { PM__LANEWISE(a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i]); }
static inline vf v_add_where(vf a, vf b, unsigned mask)
{
    PM__LANEWISE(mask >> i & 1 ? a.lane[i] + b.lane[i] : a.lane[i]);
}
static inline vf v_bytes(const int8_t *p) { PM__LANEWISE((float)p[i]); }
static inline void v_store(float *p, vf a) { memcpy(p, a.lane, sizeof a.lane); }
static inline float v_least(vf a)
{
    float least = a.lane[0];
    for (int i = 1; i < V; i++)
        least = a.lane[i] < least ? a.lane[i] : least;
    return least;
}
static inline unsigned v_le(vf a, vf b)
{
    unsigned mask = 0;
    for (unsigned i = 0; i < V; i++)
        mask |= (unsigned)(a.lane[i] <= b.lane[i]) << i;
    return mask;
}
static inline unsigned v_lt(vf a, vf b)
{
    unsigned mask = 0;
    for (unsigned i = 0; i < V; i++)
        mask |= (unsigned)(a.lane[i] < b.lane[i]) << i;
    return mask;
}
static inline void v_compress(float *to, vf a, unsigned mask)
{
    for (unsigned i = 0, n = 0; i < V; i++)
        if (mask >> i & 1)
            to[n++] = a.lane[i];
}
static inline void v_compress_bits(uint32_t *to, const uint32_t *from, unsigned mask)
{
    for (unsigned i = 0, n = 0; i < V; i++)
        if (mask >> i & 1)
            to[n++] = from[i];
}
static inline void v_compress_lanes(uint32_t *to, uint32_t base, unsigned mask)
{
    for (unsigned i = 0, n = 0; i < V; i++)
        if (mask >> i & 1)
            to[n++] = base + i;
}
static inline unsigned v_up_to(const uint32_t *p, uint32_t t)
{
    unsigned mask = 0;
    for (unsigned i = 0; i < V; i++)
        mask |= (unsigned)(p[i] <= t) << i;
    return mask;
}
static inline void v_all_pairs(void *to, vf a, uint32_t base, unsigned mask)
{
    char *next = to;
    for (unsigned i = 0; i < V; i++)
        if (mask >> i & 1) {
            const uint32_t number = base + i;
            memcpy(next, &a.lane[i], sizeof(float));
            memcpy(next + 4, &number, sizeof number);
            next += 8;
        }
}
#endif

#if PM__SIMD_WIDTH != 16
/* Pairs of a and base + lane number of the lanes of the mask; nothing is written beyond `room` pairs. */
static inline void v_pairs(void *to, size_t room, vf a, uint32_t base, unsigned mask)
{
    if (room >= V) {
        v_all_pairs(to, a, base, mask);
    } else if (mask) { /* `to` may be NULL where there is no room */
        char pairs[V * 8];
        v_all_pairs(pairs, a, base, mask);
        memcpy(to, pairs, (size_t)__builtin_popcount(mask) * 8);
    }
}
#endif

static inline unsigned v_bits(unsigned mask)
{
    return (unsigned)__builtin_popcountll(mask);
}

#endif
