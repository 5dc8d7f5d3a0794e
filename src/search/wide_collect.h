/* Collecting the photons within a bound, and guessing that bound. */
#ifndef PM_SEARCH_WIDE_COLLECT_H
#define PM_SEARCH_WIDE_COLLECT_H

#include "wide_select.h"

/* Empties the candidates, or keeps the k best of them: for a fixed radius they are handed over, above MOST_SELECTED
 * they go into a heap of k. */
static void make_room(const walk *w)
{
    collector *const c = w->found;
    const size_t k = w->query->k;
    if (k && k <= MOST_SELECTED) {
        select_best(c, w->map->ids, k);
        c->bound = c->d2[0];
        for (size_t i = 1; i < c->count; i++)
            c->bound = c->d2[i] > c->bound ? c->d2[i] : c->bound;
        return;
    }
    for (size_t i = 0; i < c->count; i++)
        pm__keep(w->query, w->result, c->d2[i], c->number[i]);
    c->count = 0;
    if (k)
        c->bound = w->result->bound;
}

/* Adds the photons of a block that lie within the bound. */
static inline void scan_block(const walk *w, size_t block)
{
    collector *const c = w->found;
    const pm__block *const b = &w->map->blocks[block];
    const vf limit = v_set(c->bound);
    for (unsigned lane = 0; lane < PM__LANES; lane += V) {
        const vf d2 = measure(b, lane, w->query);
        unsigned mask = v_le(d2, limit);
        if (w->query->shape == PM_LOOKUP_DISC && mask)
            mask &= within_height(b, lane, w->query);
        if (w->query->front_only && mask)
            mask = in_front(w, block, lane, mask);
        v_compress(c->d2 + c->count, d2, mask);
        v_compress_lanes(c->number + c->count, (uint32_t)(block * PM__LANES + lane), mask);
        c->count += v_bits(mask);
    }
    if (c->count > CAPACITY - PM__LANES)
        make_room(w);
}

static inline void scan_list(const walk *w, const uint32_t *blocks, size_t count)
{
    for (size_t i = 0; i < count; i++)
        scan_block(w, blocks[i]);
}

static inline void fetch_ahead(const pm_map *map, size_t block)
{
    const char *const at = (const char *)&map->blocks[block];
    __builtin_prefetch(at);
    __builtin_prefetch(at + 64);
    __builtin_prefetch(at + 128);
}

/* What a box must be within to matter; see pm__reaches. Finite: an empty box, at infinity, must never be. */
static inline float box_bound(const walk *w)
{
    const float bound = (w->found->bound + w->query->prune_slack) / w->query->prune_scale;
    const float wide = w->query->prune_scale < 1.0f ? bound * (1.0f + 1e-6f) : bound;
    return wide < FLT_MAX ? wide : FLT_MAX;
}

/* Blocks to be scanned. A full list is scanned and begun again, or (hold) the list is given up. */
typedef struct block_list {
    uint32_t blocks[LISTED];
    size_t count;
    bool hold, overflow;
} block_list;

static inline void list_children(const walk *w, block_list *list, uint32_t node, unsigned mask)
{
    if (list->count + v_bits(mask) > LISTED) {
        list->overflow = true;
        if (list->hold)
            return;
        scan_list(w, list->blocks, list->count);
        list->count = 0;
    }
    for (; mask; mask &= mask - 1) {
        list->blocks[list->count] = node * PM__LANES + (uint32_t)__builtin_ctz(mask);
        fetch_ahead(w->map, list->blocks[list->count++]);
    }
}

typedef struct pending {
    uint32_t node;
    int level;
} pending;

static inline int push_children(const walk *w, pending *stack, int top, uint32_t node, int level, unsigned mask)
{
    for (; mask; mask &= mask - 1) {
        const uint32_t child = node * PM__LANES + (uint32_t)__builtin_ctz(mask);
        __builtin_prefetch(&w->wide->level[level - 1][child]);
        stack[top++] = (pending){child, level - 1};
    }
    return top;
}

/* Lists the blocks within the bound below the children of a node that the mask names. */
static void list_below(const walk *w, block_list *list, uint32_t root, int root_level, unsigned root_mask)
{
    pending stack[STACK];
    if (!root_level) {
        list_children(w, list, root, root_mask);
        return;
    }
    int top = push_children(w, stack, 0, root, root_level, root_mask);
    while (top && !w->result->stopped) {
        const pending p = stack[--top];
        const unsigned mask = measure_boxes(&w->wide->level[p.level][p.node], w->query, box_bound(w));
        if (p.level)
            top = push_children(w, stack, top, p.node, p.level, mask);
        else
            list_children(w, list, p.node, mask);
    }
}

/* ---- guessing --------------------------------------------------------------------------------- */

/* A descent towards the query: at each level from the top the node, the child taken, and the distances to all children,
 * which collecting needs again; and the extents and distance of the last child's box. */
typedef struct descent {
    uint32_t node[PM__WIDE_LEVELS + 1];
    unsigned lane[PM__WIDE_LEVELS];
    float boxes2[PM__WIDE_LEVELS][PM__LANES];
    float extent[3];
    float distance2;
    int level; /* of the node reached; -1: a block */
} descent;

static inline void descend(const walk *w, descent *d)
{
    const int level = d->level;
    const uint32_t node = d->node[level + 1];
    const pm__boxes *const boxes = &w->wide->level[level][node];
    const unsigned lane = nearest_box(boxes, w->query, d->boxes2[level]);
    d->lane[level] = lane;
    d->node[level] = node * PM__LANES + lane;
    d->level = level - 1;
    if (level)
        __builtin_prefetch(&w->wide->level[level - 1][d->node[level]]);
}

/* The box that a finished descent has come to. */
static inline void look_at_box(const walk *w, descent *d)
{
    const int level = d->level + 1;
    const pm__boxes *const boxes = &w->wide->level[level][d->node[level + 1]];
    const unsigned lane = d->lane[level];
    for (int a = 0; a < 3; a++)
        d->extent[a] = boxes->high[a][lane] - boxes->low[a][lane];
    d->distance2 = d->boxes2[level][lane];
}

/* How far down a descent goes: to a box that holds about k photons or more, so that its density is the local one. */
static inline int guess_level(const pm__wide *wide, size_t k)
{
    int level = 0;
    for (size_t photons = PM__LANES; photons * 2 < k && level < wide->levels - 1; photons *= PM__LANES)
        level++;
    return level;
}

/* Photons under the box that a descent has come to: full but for the last. */
static size_t photons_under(const pm_map *map, const descent *d)
{
    const size_t full = (size_t)PM__LANES << 4 * (d->level + 1), first = d->node[d->level + 1] * full;
    return first + full <= map->count ? full : map->count > first ? map->count - first : 1;
}

/* The squared radius that holds k photons at the density of the box: of a surface where the box is flat, of a volume
 * where it is not; a margin makes too few rare. */
static float guess_radius2(const pm_map *map, const pm__query *query, const descent *d)
{
    float e0 = d->extent[0], e1 = d->extent[1], e2 = d->extent[2], t;
    if (e1 > e0) { t = e0; e0 = e1; e1 = t; }
    if (e2 > e0) { t = e0; e0 = e2; e2 = t; }
    if (e2 > e1) { t = e1; e1 = e2; e2 = t; }
    const float k = (float)query->k, share = k / (float)photons_under(map, d);
    const float scatter = GUESS_MARGIN * (1.0f + GUESS_NOISE / sqrtf(k));
    float r2 = share * e0 * e1 * 0.31831f;
    if (e2 > 0.5f * e1) {
        const float r = cbrtf(share * e0 * e1 * e2 * 0.238732f);
        r2 = r * r;
    }
    const float line = 0.5f * share * e0;
    if (r2 < 1e-3f * line * line) /* nearly a line, or all in one point */
        r2 = line * line;
    r2 *= scatter;
    if (d->distance2 > 0.0f) {
        const float r = sqrtf(r2) + sqrtf(d->distance2);
        r2 = r * r;
    }
    return !(r2 > FLT_MIN) ? FLT_MIN : r2 < query->max_distance2 ? r2 : query->max_distance2;
}

static inline void start_descent(const walk *w, descent *d)
{
    d->level = w->wide->levels - 1;
    d->node[w->wide->levels] = 0;
}

static void descend_all(const walk *w, descent *d)
{
    const int stop = guess_level(w->wide, w->query->k);
    for (start_descent(w, d); d->level >= stop;)
        descend(w, d);
    look_at_box(w, d);
}

/* Lists what is within the bound, from the descent's end upwards: near photons come first, and no node that the descent
 * has seen is measured again. */
static void list_from(const walk *w, const descent *d, block_list *list)
{
    const float bound = box_bound(w);
    const vf limit = v_set(bound);
    list->count = 0;
    list->overflow = false;
    for (int level = d->level + 1; level < w->wide->levels && !w->result->stopped; level++) {
        unsigned mask = 0;
        for (unsigned lane = 0; lane < PM__LANES; lane += V)
            mask |= v_le(v_load(d->boxes2[level] + lane), limit) << lane;
        if (level > d->level + 1)
            mask &= ~(1U << d->lane[level]);
        if (mask)
            list_below(w, list, d->node[level + 1], level, mask);
    }
}

static void collect(const walk *w, const descent *d)
{
    block_list list;
    list.hold = false;
    list_from(w, d, &list);
    scan_list(w, list.blocks, list.count);
}

#endif
