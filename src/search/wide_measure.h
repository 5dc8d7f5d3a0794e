/* What the kernels of `wide` know of a search under way, and distances to boxes and photons (simd.h). */
#ifndef PM_SEARCH_WIDE_MEASURE_H
#define PM_SEARCH_WIDE_MEASURE_H


#include "../map/wide.h"
#include "result.h"
#include "simd.h"
#include "wide.h"

#include <float.h>

enum {
    CAPACITY = 4096,     /* candidates; when they are full the k best are selected and the radius shrinks to them */
    MOST_SELECTED = 1024, /* above this k a heap of k is kept instead */
    LISTED = 128,        /* blocks listed (and fetched ahead) before they are scanned */
    STACK = 16 * PM__WIDE_LEVELS
};

/* How much wider than the box's density says, and how much for the scatter of k: the cost of too many against too
 * few. */
#define GUESS_MARGIN 1.1f
#define GUESS_NOISE 1.2f

typedef struct collector {
    float d2[CAPACITY + PM__LANES];
    uint32_t number[CAPACITY + PM__LANES];
    size_t count;
    float bound; /* inclusive */
} collector;

typedef struct walk {
    const pm_map *map;
    const pm__wide *wide;
    const pm__query *query;
    pm__result *result;
    collector *found;
} walk;

/* Squared distances to the 16 boxes of a node; which are within the bound. Empty boxes never are. */
static inline unsigned measure_boxes(const pm__boxes *boxes, const pm__query *query, float bound)
{
    const vf limit = v_set(bound), zero = v_set(0.0f);
    unsigned mask = 0;
    for (unsigned lane = 0; lane < PM__LANES; lane += V) {
        vf square[3];
        for (int a = 0; a < 3; a++) {
            const vf q = v_set(query->position[a]);
            const vf below = v_sub(v_load(boxes->low[a] + lane), q), above = v_sub(q, v_load(boxes->high[a] + lane));
            const vf d = v_max(v_max(below, above), zero);
            square[a] = v_mul(d, d);
        }
        mask |= v_le(v_add(v_add(square[0], square[1]), square[2]), limit) << lane;
    }
    return mask;
}

/* The nearest box; of those that hold the query (boxes overlap: that of many faces of a room holds them all) the one
 * whose farthest corner is nearest, since small boxes say most of the density there. nearest: squared distances to
 * all. */
static inline unsigned nearest_box(const pm__boxes *boxes, const pm__query *query, float nearest[PM__LANES])
{
    float farthest[PM__LANES];
    unsigned inside = 0;
    for (unsigned lane = 0; lane < PM__LANES; lane += V) {
        vf near[3], far[3];
        for (int a = 0; a < 3; a++) {
            const vf q = v_set(query->position[a]);
            const vf low = v_sub(v_load(boxes->low[a] + lane), q), high = v_sub(q, v_load(boxes->high[a] + lane));
            const vf d = v_max(v_max(low, high), v_set(0.0f)), e = v_min(low, high);
            near[a] = v_mul(d, d);
            far[a] = v_mul(e, e);
        }
        const vf d2 = v_add(v_add(near[0], near[1]), near[2]);
        v_store(nearest + lane, d2);
        v_store(farthest + lane, v_add(v_add(far[0], far[1]), far[2]));
        inside |= v_le(d2, v_set(0.0f)) << lane;
    }
    unsigned best = 0;
    if (inside) {
        best = (unsigned)__builtin_ctz(inside);
        for (inside &= inside - 1; inside; inside &= inside - 1) {
            const unsigned lane = (unsigned)__builtin_ctz(inside);
            best = farthest[lane] < farthest[best] ? lane : best;
        }
        return best;
    }
    for (unsigned lane = 1; lane < PM__LANES; lane++)
        best = nearest[lane] < nearest[best] ? lane : best;
    return best;
}

/* Squared distances of part of a block, in the order of operations of pm__measure; NAN where the shape rejects. */
static inline vf measure(const pm__block *block, unsigned lane, const pm__query *q)
{
    const vf x = v_sub(v_load(block->x + lane), v_set(q->position[0]));
    const vf y = v_sub(v_load(block->y + lane), v_set(q->position[1]));
    const vf z = v_sub(v_load(block->z + lane), v_set(q->position[2]));
    const vf d2 = v_add(v_add(v_mul(x, x), v_mul(y, y)), v_mul(z, z));
    if (q->shape == PM_LOOKUP_SPHERE)
        return d2;
    const vf nx = v_set(q->normal[0]), ny = v_set(q->normal[1]), nz = v_set(q->normal[2]);
    const vf h = v_add(v_add(v_mul(x, nx), v_mul(y, ny)), v_mul(z, nz));
    if (q->shape == PM_LOOKUP_ELLIPSOID)
        return v_add(d2, v_mul(v_set(q->squash), v_mul(h, h)));
    const vf tx = v_sub(x, v_mul(h, nx)), ty = v_sub(y, v_mul(h, ny)), tz = v_sub(z, v_mul(h, nz));
    return v_add(v_add(v_mul(tx, tx), v_mul(ty, ty)), v_mul(tz, tz));
}

/* Lanes of the mask whose height a disc accepts. */
static inline unsigned within_height(const pm__block *block, unsigned lane, const pm__query *q)
{
    const vf x = v_sub(v_load(block->x + lane), v_set(q->position[0]));
    const vf y = v_sub(v_load(block->y + lane), v_set(q->position[1]));
    const vf z = v_sub(v_load(block->z + lane), v_set(q->position[2]));
    const vf nx = v_set(q->normal[0]), ny = v_set(q->normal[1]), nz = v_set(q->normal[2]);
    const vf h = v_add(v_add(v_mul(x, nx), v_mul(y, ny)), v_mul(z, nz));
    return v_le(h, v_set(q->half_height)) & v_le(v_set(-q->half_height), h);
}

/* Lanes of the mask that face the query. Rounded directions decide but for grazing ones, which the full ones do. */
static unsigned in_front(const walk *w, size_t block, unsigned lane, unsigned mask)
{
    const pm__facing *const facing = &w->wide->facing[block];
    const float *const n = w->query->normal;
    /* half a step an axis, and the rounding of the products */
    const float doubt = 0.55f * (fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]));
    const vf dot = v_add(v_add(v_mul(v_bytes(facing->axis[0] + lane), v_set(n[0])),
                               v_mul(v_bytes(facing->axis[1] + lane), v_set(n[1]))),
                         v_mul(v_bytes(facing->axis[2] + lane), v_set(n[2])));
    const unsigned front = v_lt(dot, v_set(-doubt)) & mask;
    for (unsigned open = mask & v_le(dot, v_set(doubt)) & ~front; open; open &= open - 1) {
        const unsigned i = (unsigned)__builtin_ctz(open);
        if (pm__in_front(w->map, w->query, block * PM__LANES + lane + i))
            mask |= 1U << i << 16;
    }
    return front | mask >> 16;
}

#endif
