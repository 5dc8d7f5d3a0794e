/* Where to cut candidates so that k remain. */
#ifndef PM_SEARCH_WIDE_SELECT_H
#define PM_SEARCH_WIDE_SELECT_H

#include "wide_measure.h"

enum {
    CAPACITY = 4096, /* candidates */
    WINDOW = 48      /* so few are told apart by comparing each with every other */
};

/* Kept is what lies below distance2, and of what lies at it `ties`: those with the lowest ids; ALL_TIES: all. */
typedef struct cut {
    float distance2;
    size_t ties;
} cut;

#define ALL_TIES SIZE_MAX

static inline size_t count_up_to(const float *d2, size_t lanes, float t)
{
    const vf limit = v_set(t);
    size_t count = 0;
    for (size_t i = 0; i < lanes; i += V)
        count += v_bits(v_le(v_load(d2 + i), limit));
    return count;
}

/* The values in (low, high] to the front of `to`, which has V more places than there are of them. */
static inline size_t values_between(const float *d2, size_t lanes, float low, float high, float *to)
{
    const vf lower = v_set(low), upper = v_set(high);
    size_t count = 0;
    for (size_t i = 0; i < lanes; i += V) {
        const vf value = v_load(d2 + i);
        const unsigned mask = v_le(value, upper) & v_lt(lower, value);
        v_compress(to + count, value, mask);
        count += v_bits(mask);
    }
    return count;
}

/* Quickselect: the value of rank `wanted` (from 1). */
static uint32_t value_of_rank(uint32_t *values, size_t count, size_t wanted)
{
    uint64_t state = count;
    while (count > 1) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const uint32_t pivot = values[(state >> 33) % count];
        size_t below = 0, up_to = 0;
        for (size_t i = 0; i < count; i++) {
            const uint32_t value = values[i];
            values[i] = values[below];
            values[below] = value;
            below += value < pivot;
        }
        for (size_t i = below; i < count; i++)
            up_to += values[i] == pivot;
        if (wanted <= below) {
            count = below;
        } else if (wanted <= below + up_to) {
            return pivot;
        } else {
            wanted -= below + up_to;
            size_t kept = below;
            for (size_t i = below; i < count; i++)
                if (values[i] != pivot)
                    values[kept++] = values[i];
            values += below;
            count = kept - below;
        }
    }
    return values[0];
}

static inline cut cut_here(float at, size_t below, size_t up_to, size_t wanted)
{
    return (cut){at, up_to == wanted ? ALL_TIES : wanted - below};
}

/* Many are mostly so because they tie: the first may be the one. Else their bits are selected, which are in their
 * order, since squared distances are not negative. `values` has V more places than there are of them. */
static cut cut_many(float *values, size_t count, size_t wanted)
{
    v_store(values + count, v_set(NAN));
    float at = values[0];
    for (int try = 0;; try++) {
        const vf limit = v_set(at);
        size_t below = 0, up_to = 0;
        for (size_t i = 0; i < count; i += V) {
            below += v_bits(v_lt(v_load(values + i), limit));
            up_to += v_bits(v_le(v_load(values + i), limit));
        }
        if (try || (below < wanted && wanted <= up_to))
            return cut_here(at, below, up_to, wanted);
        uint32_t bits[CAPACITY + PM__LANES] = {0};
        memcpy(bits, values, count * sizeof *bits);
        const uint32_t chosen = value_of_rank(bits, count, wanted);
        memcpy(&at, &chosen, sizeof at);
    }
}

/* Each one's rank is the number of those before it: counted at once for all. */
static inline cut cut_few(float *values, size_t count, size_t wanted)
{
    float found = 0.0f;
    unsigned alike = 0;
    v_store(values + count, v_set(NAN)); /* before nothing; what is compared beyond the last is of no account */
    const vf one = v_set(1.0f), rank = v_set((float)(wanted - 1));
    for (size_t at = 0; at < count; at += V) {
        const vf mine = v_load(values + at);
        vf before = v_set(0.0f), others = before;
        for (size_t j = 0; j < count; j += 2) {
            before = v_add_where(before, one, v_lt(v_set(values[j]), mine));
            others = v_add_where(others, one, v_lt(v_set(values[j + 1]), mine));
        }
        before = v_add(before, others);
        unsigned mask = v_le(before, rank) & v_le(rank, before);
        if (count - at < V)
            mask &= (1U << (count - at)) - 1;
        if (mask)
            found = values[at + (size_t)__builtin_ctz(mask)];
        alike += v_bits(mask);
    }
    return alike == 1 ? (cut){found, ALL_TIES} : cut_many(values, count, wanted); /* ties, where there is not one */
}

/* The cut that leaves k of the `within` > k values up to `bound`. On a surface squared distances are nearly uniform, so
 * interpolation comes close in two steps: each aims beyond k from the nearer end of the interval, so that the interval
 * closes from both ends. */
static inline cut cut_at(const float *d2, size_t lanes, size_t within, float bound, size_t k)
{
    float low = -1.0f, high = bound;
    size_t below = 0, up_to = within;
    for (int pass = 0; pass < 10 && up_to - below > WINDOW && up_to > k; pass++) {
        const float inner = (float)(k - below), outer = (float)(up_to - k), from = low > 0.0f ? low : 0.0f;
        const bool far_below = inner > outer;
        const float beyond = 4.0f + 0.1f * (far_below ? outer : inner);
        const float aim = far_below ? inner - beyond : inner + beyond;
        const float t = from + (high - from) * (aim / (inner + outer));
        if (!(t > low && t < high))
            break;
        const size_t count = count_up_to(d2, lanes, t);
        const bool enough = count >= k; /* which is a coin's toss: selected, not branched on */
        high = enough ? t : high;
        low = enough ? low : t;
        up_to = enough ? count : up_to;
        below = enough ? below : count;
    }
    if (up_to == k)
        return (cut){high, ALL_TIES};
    float values[CAPACITY + 2 * PM__LANES];
    const size_t count = values_between(d2, lanes, low, high, values);
    return count <= WINDOW ? cut_few(values, count, k - below) : cut_many(values, count, k - below);
}

/* The highest id to be kept of those that tie at a cut: any up to which there are `ties`. All ids are different and
 * below `all`. `ids` has V more places than there are of them. */
static uint32_t last_id(uint32_t *ids, size_t count, size_t ties, size_t all)
{
    if (ties == ALL_TIES)
        return UINT32_MAX;
    for (unsigned i = 0; i < V; i++)
        ids[count + i] = UINT32_MAX;
    uint64_t from = 0, to = all; /* the answer lies in [from, to) */
    size_t below = 0, up_to = count;
    for (bool halve = false;; halve = !halve) { /* interpolation is fast, halving certain */
        const double share = halve ? 0.5 : (double)(ties - below) / (double)(up_to - below + 1);
        const uint64_t t = from + (uint64_t)(share * (double)(to - from - 1));
        size_t found = 0;
        for (size_t i = 0; i < count; i += V)
            found += v_bits(v_up_to(ids + i, (uint32_t)t));
        if (found == ties || to - from <= 1)
            return (uint32_t)t;
        to = found > ties ? t : to;
        up_to = found > ties ? found : up_to;
        from = found > ties ? from : t + 1;
        below = found > ties ? below : found;
    }
}

#endif
