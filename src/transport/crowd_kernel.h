/* The search of crowd.h, for the width PM__SIMD_WIDTH. */
#include "../search/simd.h"
#include "crowd.h"

#include <math.h>
#include <stdlib.h>

/* Halvings of a limit before photons are sorted. */
enum { HALVINGS = 24 };

/* Lanes beyond the last are no neighbours. */
static void pad(pm__crowd_found *found)
{
    v_store(found->distance2 + found->count, v_set(INFINITY));
}

static size_t count_up_to(const pm__crowd_found *found, float limit)
{
    const vf bound = v_set(limit);
    size_t sum = 0;
    for (size_t i = 0; i < found->count; i += V)
        sum += v_bits(v_le(v_load(found->distance2 + i), bound));
    return sum;
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* By distance, of equal ones the latest first: the bits of floats from 0 on are in their order. Without memory for that
 * those stay that were found first: a matter of ties. */
static void keep_sorted(pm__crowd_found *found, size_t wanted)
{
    uint64_t *const keys = malloc(found->count * sizeof *keys);
    for (size_t i = 0; keys && i < found->count; i++) {
        uint32_t bits;
        memcpy(&bits, &found->distance2[i], sizeof bits);
        keys[i] = (uint64_t)bits << 32 | (UINT32_MAX - found->places[i]);
    }
    if (keys)
        qsort(keys, found->count, sizeof *keys, compare_keys);
    for (size_t i = 0; keys && i < wanted; i++) {
        const uint32_t bits = (uint32_t)(keys[i] >> 32);
        memcpy(&found->distance2[i], &bits, sizeof bits);
        found->places[i] = UINT32_MAX - (uint32_t)keys[i];
    }
    found->count = wanted;
    free(keys);
}

static void keep_up_to(pm__crowd_found *found, float limit)
{
    const vf bound = v_set(limit);
    size_t kept = 0;
    for (size_t i = 0; i < found->count; i += V) {
        const vf d2 = v_load(found->distance2 + i);
        const unsigned mask = v_le(d2, bound);
        v_compress(found->distance2 + kept, d2, mask);
        v_compress_bits(found->places + kept, found->places + i, mask);
        kept += v_bits(mask);
    }
    found->count = kept;
    pad(found);
}

/* On a surface about as many lie within a squared distance as it is long: guesses by that, every third by half. */
static void narrow(pm__crowd_found *found, size_t wanted, float limit)
{
    float low = 0.0f, high = limit;
    size_t below = 0, up_to = found->count;
    for (int i = 0; i < HALVINGS && up_to > PM__CROWD_FEW; i++) {
        const float part = i % 3 == 2 ? 0.5f : ((float)(wanted - below) + 4.0f) / (float)(up_to - below);
        const float middle = low + (high - low) * (part < 1.0f ? part : 0.5f);
        const size_t count = count_up_to(found, middle);
        if (count < wanted) {
            low = middle;
            below = count;
        } else {
            high = middle;
            up_to = count;
        }
    }
    if (high < limit)
        keep_up_to(found, high);
}

/* How many of those found are nearer than each of V from lane `first` on. Four sums, since one after another would be
 * waited for. */
static inline vf ranks(const pm__crowd_found *found, size_t first)
{
    const vf d2 = v_load(found->distance2 + first), one = v_set(1.0f);
    vf sums[4] = {v_set(0.0f), v_set(0.0f), v_set(0.0f), v_set(0.0f)};
    for (size_t j = 0; j < found->count; j += 4)
        for (size_t s = 0; s < 4; s++)
            sums[s] = v_add_where(sums[s], one, v_lt(v_set(found->distance2[j + s]), d2));
    return v_add(v_add(sums[0], sums[1]), v_add(sums[2], sums[3]));
}

static void keep_ranked(pm__crowd_found *found, size_t wanted)
{
    unsigned masks[PM__CROWD_FEW / V];
    const vf limit = v_set((float)wanted);
    size_t total = 0, kept = 0;
    for (size_t i = 0; i < found->count; i += V) {
        const unsigned left = found->count - i < V ? (1U << (found->count - i)) - 1U : ~0U;
        masks[i / V] = v_lt(ranks(found, i), limit) & left;
        total += v_bits(masks[i / V]);
    }
    if (total != wanted) {
        keep_sorted(found, wanted);
        return;
    }
    for (size_t i = 0; i < found->count; i += V) {
        v_compress(found->distance2 + kept, v_load(found->distance2 + i), masks[i / V]);
        v_compress_bits(found->places + kept, found->places + i, masks[i / V]);
        kept += v_bits(masks[i / V]);
    }
    found->count = kept;
}

static void keep_nearest(pm__crowd_found *found, size_t wanted, float limit)
{
    pad(found);
    if (found->count > PM__CROWD_FEW)
        narrow(found, wanted, limit);
    if (found->count > PM__CROWD_FEW)
        keep_sorted(found, wanted);
    else if (found->count > wanted)
        keep_ranked(found, wanted);
}

static float farthest(const pm__crowd_found *found)
{
    float most = 0.0f;
    for (size_t i = 0; i < found->count; i++)
        most = found->distance2[i] > most ? found->distance2[i] : most;
    return most;
}

static void give(const uint32_t *places, size_t count, const double part[4], pm__crowd_sum *sums)
{
    for (size_t i = 0; i < count; i++)
        for (int b = 0; b < 4; b++)
            sums[places[i]][b] += part[b];
}

static void find(const pm__crowd_hood *hood, const float position[3], float reach, size_t wanted,
                 pm__crowd_found *found)
{
    const vf px = v_set(position[0]), py = v_set(position[1]), pz = v_set(position[2]);
    const vf bound = v_set(reach * reach);
    float *const distance2 = found->distance2;
    uint32_t *const places = found->places;
    const float *const x = hood->at[0], *const y = hood->at[1], *const z = hood->at[2];
    const size_t all = hood->count;
    size_t count = 0;
    for (size_t i = 0; i < all; i += V) {
        const vf dx = v_sub(v_load(x + i), px), dy = v_sub(v_load(y + i), py), dz = v_sub(v_load(z + i), pz);
        const vf d2 = v_add(v_add(v_mul(dx, dx), v_mul(dy, dy)), v_mul(dz, dz));
        const unsigned mask = v_le(d2, bound);
        v_compress(distance2 + count, d2, mask);
        v_compress_lanes(places + count, (uint32_t)i, mask);
        count += v_bits(mask);
    }
    found->count = count;
    if (count > wanted)
        keep_nearest(found, wanted, reach * reach);
}
