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

/* Squared distances are not negative, so their bits are in their order. */
static cut cut_many(float *values, size_t count, size_t wanted)
{
    uint32_t bits[CAPACITY + PM__LANES];
    memcpy(bits, values, count * sizeof *bits);
    const uint32_t chosen = value_of_rank(bits, count, wanted);
    float at;
    memcpy(&at, &chosen, sizeof at);
    size_t below = 0, equal = 0;
    for (size_t i = 0; i < count; i++) {
        below += values[i] < at;
        equal += !(values[i] < at) && !(values[i] > at);
    }
    return (cut){at, below + equal == wanted ? ALL_TIES : wanted - below};
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

/* The highest id to be kept of those that tie at a cut. */
static uint32_t last_id(uint32_t *ids, size_t count, size_t ties)
{
    return ties == ALL_TIES ? UINT32_MAX : value_of_rank(ids, count, ties);
}

#endif
