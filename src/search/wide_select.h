/* Selection of the k best candidates. */
#ifndef PM_SEARCH_WIDE_SELECT_H
#define PM_SEARCH_WIDE_SELECT_H

#include "wide_measure.h"

/* How many candidates are not beyond t. */
static inline size_t count_up_to(const collector *c, float t)
{
    const vf limit = v_set(t);
    size_t count = 0;
    for (size_t i = 0; i < c->count; i += V)
        count += v_bits(v_le(v_load(c->d2 + i), limit));
    return count;
}

/* Quickselect for what interpolation cannot part: the `wanted` nearest of middle to its front. */
static void part_middle(const uint32_t *ids, pm_neighbor *middle, size_t count, size_t wanted)
{
    uint64_t state = count;
    while (count > 32) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const pm_neighbor pivot = middle[(state >> 33) % count];
        size_t border = 0; /* those not farther than the pivot to the front */
        for (size_t i = 0; i < count; i++) {
            const pm_neighbor item = middle[i];
            const bool near = !pm__farther(ids, item, pivot);
            middle[i] = middle[border];
            middle[border] = item;
            border += near;
        }
        if (border == wanted)
            return;
        if (wanted < border) {
            if (border == count) { /* the pivot is the farthest: set it apart */
                for (size_t i = 0; i < count; i++)
                    if (middle[i].number == pivot.number) {
                        middle[i] = middle[count - 1];
                        middle[count - 1] = pivot;
                        break;
                    }
                count--;
            } else {
                count = border;
            }
        } else {
            middle += border;
            count -= border;
            wanted -= border;
        }
    }
    for (size_t i = 0; i < wanted; i++) {
        size_t best = i;
        for (size_t j = i + 1; j < count; j++)
            if (pm__farther(ids, middle[best], middle[j]))
                best = j;
        const pm_neighbor item = middle[best];
        middle[best] = middle[i];
        middle[i] = item;
    }
}

/* Compresses the candidates to those not beyond `low`; those in (low, high] go to middle. Returns how many are kept. */
static size_t divide(collector *c, float low, float high, pm_neighbor *middle, size_t *middle_count)
{
    const vf lower = v_set(low), upper = v_set(high);
    size_t kept = 0, between = 0;
    for (size_t i = 0; i < c->count; i += V) {
        const vf d2 = v_load(c->d2 + i);
        const unsigned keep = v_le(d2, lower);
        for (unsigned rest = v_le(d2, upper) & ~keep; rest; rest &= rest - 1) {
            const size_t at = i + (size_t)__builtin_ctz(rest);
            middle[between++] = (pm_neighbor){c->d2[at], c->number[at]};
        }
        uint32_t numbers[PM__LANES];
        memcpy(numbers, c->number + i, V * sizeof *numbers);
        v_compress(c->d2 + kept, d2, keep);
        v_compress_bits(c->number + kept, numbers, keep);
        kept += v_bits(keep);
    }
    *middle_count = between;
    return kept;
}

enum { FEW = 32 };

/* Few candidates: each one's rank is the number of those before it, counted at once for all by comparing each with
 * every other. False where distances tie, which the ids must decide. */
static bool select_by_rank(collector *c, size_t k)
{
    float d2[FEW];
    uint32_t numbers[FEW];
    unsigned chosen[FEW / V], total = 0;
    for (size_t i = c->count; i < FEW; i++)
        c->d2[i] = INFINITY;
    for (unsigned at = 0; at < FEW; at += V) {
        const vf mine = v_load(c->d2 + at), one = v_set(1.0f);
        vf rank = v_set(0.0f);
        for (size_t j = 0; j < c->count; j++)
            rank = v_add_where(rank, one, v_lt(v_set(c->d2[j]), mine));
        chosen[at / V] = v_lt(rank, v_set((float)k));
        total += v_bits(chosen[at / V]);
    }
    if (total != k)
        return false;
    memcpy(d2, c->d2, sizeof d2);
    memcpy(numbers, c->number, sizeof numbers);
    size_t kept = 0;
    for (unsigned at = 0; at < FEW; at += V) {
        v_compress(c->d2 + kept, v_load(d2 + at), chosen[at / V]);
        v_compress_bits(c->number + kept, numbers + at, chosen[at / V]);
        kept += v_bits(chosen[at / V]);
    }
    c->count = k;
    return true;
}

/* Leaves the k nearest (distance2, id) of more than k candidates. On a surface d2 is nearly uniform, so interpolation
 * finds a threshold with k below it in a few passes; ties and clusters are parted one by one. */
static void select_best(collector *c, const uint32_t *ids, size_t k)
{
    if (c->count <= FEW && select_by_rank(c, k))
        return;
    pm_neighbor middle[CAPACITY + PM__LANES];
    float low = -1.0f, high = c->bound;
    size_t below = 0, up_to = c->count, middle_count = 0;
    for (size_t i = c->count; i < c->count + V; i++)
        c->d2[i] = NAN; /* no lane beyond the last is counted */
    for (int pass = 0; pass < 8 && up_to != k && up_to - below > 6; pass++) {
        const float from = low > 0.0f ? low : 0.0f;
        const float t = from + (high - from) * ((float)(k - below) / (float)(up_to - below));
        if (!(t > low && t < high))
            break;
        const size_t count = count_up_to(c, t);
        const bool enough = count >= k; /* which side is a coin's toss: selected, not branched on */
        high = enough ? t : high;
        low = enough ? low : t;
        up_to = enough ? count : up_to;
        below = enough ? below : count;
    }
    if (up_to == k)
        low = high;
    const size_t kept = divide(c, low, high, middle, &middle_count);
    if (kept < k) {
        part_middle(ids, middle, middle_count, k - kept);
        for (size_t i = 0; i < k - kept; i++) {
            c->d2[kept + i] = middle[i].distance2;
            c->number[kept + i] = middle[i].number;
        }
    }
    c->count = k;
}

#endif
