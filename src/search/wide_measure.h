/* What the kernels of `wide` know of a search under way, and distances to boxes and photons (simd.h). */
#ifndef PM_SEARCH_WIDE_MEASURE_H
#define PM_SEARCH_WIDE_MEASURE_H

#include "../map/wide.h"
#include "result.h"
#include "simd.h"
#include "wide.h"

#include <float.h>

typedef struct walk {
    const pm_map *map;
    const pm__wide *wide;
    const pm__query *query;
    pm__result *result;
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

/* The nearest box and its squared distance; of those that hold the query (boxes overlap: that of many faces of a room
 * holds them all) the one whose farthest corner is nearest, since small boxes say most of the density there. */
static inline unsigned nearest_box(const pm__boxes *boxes, const pm__query *query, float *distance2)
{
    float nearest[PM__LANES], farthest[PM__LANES];
    unsigned inside = 0, mask = 0;
    for (unsigned lane = 0; lane < PM__LANES; lane += V) {
        vf near[3], far[3];
        for (int a = 0; a < 3; a++) {
            const vf q = v_set(query->position[a]);
            const vf low = v_sub(v_load(boxes->low[a] + lane), q), high = v_sub(q, v_load(boxes->high[a] + lane));
            const vf d = v_max(v_max(low, high), v_set(0.0f)), e = v_min(low, high);
            near[a] = v_mul(d, d);
            far[a] = v_mul(e, e);
        }
        const vf d2 = v_add(v_add(near[0], near[1]), near[2]), f2 = v_add(v_add(far[0], far[1]), far[2]);
        const unsigned within = v_le(d2, v_set(0.0f));
        v_store(nearest + lane, d2);
        v_store(farthest + lane, v_add_where(f2, v_set(INFINITY), ~within & ((1U << V) - 1)));
        inside |= within << lane;
    }
    const float *const key = inside ? farthest : nearest;
    vf least = v_load(key);
    for (unsigned lane = V; lane < PM__LANES; lane += V)
        least = v_min(least, v_load(key + lane));
    const vf limit = v_set(v_least(least));
    for (unsigned lane = 0; lane < PM__LANES; lane += V)
        mask |= v_le(v_load(key + lane), limit) << lane;
    const unsigned best = mask ? (unsigned)__builtin_ctz(mask) : 0;
    *distance2 = nearest[best];
    return best;
}

/* What a box must be within to matter; see pm__reaches. Finite: an empty box, at infinity, must never be. */
static inline float box_bound(const walk *w, float bound)
{
    const float widened = (bound + w->query->prune_slack) / w->query->prune_scale;
    const float safe = w->query->prune_scale < 1.0f ? widened * (1.0f + 1e-6f) : widened;
    return safe < FLT_MAX ? safe : FLT_MAX;
}

/* Squared distances of part of a block, in the order of operations of pm__measure, of any height. */
static inline vf measure_shape(const pm__block *block, unsigned lane, const pm__query *q)
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
        const size_t number = block * PM__LANES + lane + i;
        if (number < w->map->count && pm__in_front(w->map, w->query, number)) /* lanes beyond the last have none */
            mask |= 1U << i << 16;
    }
    return front | mask >> 16;
}

/* Squared distances of part of a block; NAN where the query's shape or filter rejects. plain: a sphere, no filter. */
static inline vf measure(const walk *w, size_t block, unsigned lane, const bool plain)
{
    const pm__block *const b = &w->map->blocks[block];
    const pm__query *const q = w->query;
    if (plain) {
        const vf x = v_sub(v_load(b->x + lane), v_set(q->position[0]));
        const vf y = v_sub(v_load(b->y + lane), v_set(q->position[1]));
        const vf z = v_sub(v_load(b->z + lane), v_set(q->position[2]));
        return v_add(v_add(v_mul(x, x), v_mul(y, y)), v_mul(z, z));
    }
    const vf d2 = measure_shape(b, lane, q);
    const unsigned all = (1U << V) - 1;
    unsigned mask = q->shape == PM_LOOKUP_DISC ? within_height(b, lane, q) : all;
    if (q->front_only)
        mask = in_front(w, block, lane, mask);
    return v_add_where(d2, v_set(NAN), ~mask & all);
}

static inline bool is_plain(const pm__query *query)
{
    return query->shape == PM_LOOKUP_SPHERE && !query->front_only;
}

#endif
