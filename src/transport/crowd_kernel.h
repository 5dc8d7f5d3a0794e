/* The search of crowd.h, for the width PM__SIMD_WIDTH. */
#include "../search/simd.h"
#include "crowd.h"

#include <math.h>
#include <stdlib.h>

/* Slots that are looked at before it is seen to it that there is room for more; halvings of a limit before photons are
 * sorted. */
enum { STEP = 512, HALVINGS = 24 };

static size_t count_up_to(const float *d2, size_t count, float limit)
{
    const vf bound = v_set(limit);
    size_t sum = 0;
    for (size_t i = 0; i < count; i += V)
        sum += v_bits(v_le(v_load(d2 + i), bound));
    return sum;
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Distances ascending, of equal ones the latest slots first; the bits of floats from 0 on are in their order. */
static float keep_sorted(pm__crowd_found *found, size_t wanted)
{
    uint64_t keys[PM__CROWD_FOUND];
    for (size_t i = 0; i < found->count; i++) {
        uint32_t bits;
        memcpy(&bits, &found->distance2[i], sizeof bits);
        keys[i] = (uint64_t)bits << 32 | (UINT32_MAX - found->slots[i]);
    }
    qsort(keys, found->count, sizeof *keys, compare_keys);
    found->count = wanted;
    for (size_t i = 0; i < wanted; i++) {
        const uint32_t bits = (uint32_t)(keys[i] >> 32);
        memcpy(&found->distance2[i], &bits, sizeof bits);
        found->slots[i] = UINT32_MAX - (uint32_t)keys[i];
    }
    return found->distance2[wanted - 1];
}

static void keep_up_to(pm__crowd_found *found, float limit)
{
    const vf bound = v_set(limit);
    size_t kept = 0;
    for (size_t i = 0; i < found->count; i += V) {
        const vf d2 = v_load(found->distance2 + i);
        const unsigned mask = v_le(d2, bound);
        v_compress(found->distance2 + kept, d2, mask);
        v_compress_bits(found->slots + kept, found->slots + i, mask);
        kept += v_bits(mask);
    }
    found->count = kept;
}

static float farthest_of(const pm__crowd_found *found)
{
    float farthest = 0.0f;
    for (size_t i = 0; i < found->count; i++)
        farthest = found->distance2[i] > farthest ? found->distance2[i] : farthest;
    return farthest;
}

/* The `wanted` nearest of those found, which are more and none farther than `limit`. On a surface about as many lie
 * within a squared distance as it is long: guesses by that, then halves. */
static float keep_nearest(pm__crowd_found *found, size_t wanted, float limit)
{
    float low = 0.0f, high = limit;
    size_t below = 0, up_to = found->count;
    for (size_t lane = found->count; lane < found->count + V; lane++)
        found->distance2[lane] = INFINITY;
    for (int i = 0; i < HALVINGS; i++) {
        const float part = i % 3 == 2 ? 0.5f : ((float)(wanted - below) + 0.5f) / (float)(up_to - below + 1);
        const float middle = low + (high - low) * part;
        const size_t count = count_up_to(found->distance2, found->count, middle);
        if (count == wanted) {
            keep_up_to(found, middle);
            return farthest_of(found);
        }
        if (count < wanted) {
            low = middle;
            below = count;
        } else {
            high = middle;
            up_to = count;
        }
    }
    return keep_sorted(found, wanted);
}

/* Slots first .. first + count - 1 that are within the squared reach. */
static void look(const pm__crowd *crowd, uint32_t first, uint32_t count, const float position[3], float reach2,
                 pm__crowd_found *found)
{
    const vf px = v_set(position[0]), py = v_set(position[1]), pz = v_set(position[2]), bound = v_set(reach2);
    for (uint32_t i = 0; i < count; i += V) {
        const uint32_t slot = first + i;
        const vf dx = v_sub(v_load(crowd->at[0] + slot), px), dy = v_sub(v_load(crowd->at[1] + slot), py);
        const vf dz = v_sub(v_load(crowd->at[2] + slot), pz);
        const vf d2 = v_add(v_add(v_mul(dx, dx), v_mul(dy, dy)), v_mul(dz, dz));
        const unsigned left = count - i < V ? (1U << (count - i)) - 1U : ~0U;
        const unsigned mask = v_le(d2, bound) & left;
        v_compress(found->distance2 + found->count, d2, mask);
        v_compress_lanes(found->slots + found->count, slot, mask);
        found->count += v_bits(mask);
    }
}

static float find(const pm__crowd *crowd, const pm__crowd_run *run, const float position[3], float reach, size_t wanted,
                  pm__crowd_found *found)
{
    float limit = reach * reach;
    found->count = 0;
    for (size_t c = 0; c < run->count; c++) {
        const pm__crowd_cell *const cell = &crowd->cells[run->cells[c]];
        for (uint32_t done = 0; done < cell->count; done += STEP) {
            const uint32_t now = cell->count - done < STEP ? cell->count - done : STEP;
            if (found->count + now > PM__CROWD_FOUND)
                limit = keep_nearest(found, wanted, limit);
            look(crowd, cell->first + done, now, position, limit, found);
        }
    }
    return found->count > wanted ? keep_nearest(found, wanted, limit) : farthest_of(found);
}
