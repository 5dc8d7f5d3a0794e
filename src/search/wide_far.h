/* Any number of blocks: walked with a stack, candidates collected until there are too many. */
#ifndef PM_SEARCH_WIDE_FAR_H
#define PM_SEARCH_WIDE_FAR_H

#include "wide_near.h"

enum {
    MOST_SELECTED = 1024, /* above this k a heap of k is kept instead */
    STACK = 16 * PM__WIDE_LEVELS
};

typedef struct collector {
    _Alignas(64) float d2[CAPACITY + PM__LANES];
    uint32_t number[CAPACITY + PM__LANES];
    size_t count;
    float bound; /* inclusive */
} collector;

/* Leaves the k best candidates. */
static void keep_best(const walk *w, collector *c)
{
    const size_t k = w->query->k;
    for (size_t i = c->count; i < c->count + V; i++)
        c->d2[i] = INFINITY; /* no lane beyond the last is counted */
    const cut at = cut_at(c->d2, c->count, c->count, c->bound, k);
    uint32_t ids[CAPACITY + PM__LANES];
    size_t equal = 0, kept = 0;
    for (size_t i = 0; i < c->count; i++)
        if (!(c->d2[i] < at.distance2) && !(c->d2[i] > at.distance2))
            ids[equal++] = w->map->ids[c->number[i]];
    const uint32_t last = last_id(ids, equal, at.ties, w->map->count);
    for (size_t i = 0; i < c->count; i++)
        if (c->d2[i] < at.distance2 || (!(c->d2[i] > at.distance2) && w->map->ids[c->number[i]] <= last)) {
            c->d2[kept] = c->d2[i];
            c->number[kept++] = c->number[i];
        }
    c->count = kept;
    c->bound = at.distance2;
}

/* Empties the candidates, or keeps the k best of them: for a fixed radius they are handed over, above MOST_SELECTED
 * they go into a heap of k. */
static void make_room(const walk *w, collector *c)
{
    const size_t k = w->query->k;
    if (k && k <= MOST_SELECTED) {
        if (c->count > k)
            keep_best(w, c);
        return;
    }
    for (size_t i = 0; i < c->count; i++)
        pm__keep(w->query, w->result, c->d2[i], c->number[i]);
    c->count = 0;
    if (k)
        c->bound = w->result->bound;
}

/* Adds the photons of a block that lie within the bound. */
static void scan_block(const walk *w, collector *c, size_t block)
{
    const vf limit = v_set(c->bound);
    for (unsigned lane = 0; lane < PM__LANES; lane += V) {
        const vf d2 = measure(w, block, lane, false);
        const unsigned mask = v_le(d2, limit);
        v_compress(c->d2 + c->count, d2, mask);
        v_compress_lanes(c->number + c->count, (uint32_t)(block * PM__LANES + lane), mask);
        c->count += v_bits(mask);
    }
    if (c->count > CAPACITY - PM__LANES)
        make_room(w, c);
}

typedef struct pending {
    uint32_t node;
    int level;
} pending;

static int push_children(pending *stack, int top, pending p, unsigned mask)
{
    for (; mask; mask &= mask - 1)
        stack[top++] = (pending){p.node * PM__LANES + (uint32_t)__builtin_ctz(mask), p.level - 1};
    return top;
}

/* All within c->bound, which shrinks as candidates become many. */
static void collect(const walk *w, collector *c)
{
    pending stack[STACK];
    int top = 1;
    c->count = 0;
    stack[0] = (pending){0, w->wide->levels - 1};
    while (top && !w->result->stopped) {
        const pending p = stack[--top];
        if (p.level < 0) {
            scan_block(w, c, p.node);
            continue;
        }
        const unsigned mask = measure_boxes(&w->wide->level[p.level][p.node], w->query, box_bound(w, c->bound));
        top = push_children(stack, top, p, mask);
    }
    make_room(w, c);
}

/* The k nearest, however many lie within the bound. False where they are fewer and a larger bound may hold more. */
static bool settle_far(const walk *w, float bound, size_t *found)
{
    collector c;
    c.bound = bound;
    w->result->count = 0;
    w->result->bound = bound;
    collect(w, &c);
    if (w->query->k <= MOST_SELECTED) {
        for (size_t i = 0; i < c.count; i++)
            w->result->list[i] = (pm_neighbor){c.d2[i], c.number[i]};
        w->result->count = c.count;
    }
    *found = w->result->count;
    return *found >= w->query->k || bound >= w->query->max_distance2;
}

static void hand_over_far(const walk *w)
{
    collector c;
    c.bound = w->query->max_distance2;
    collect(w, &c);
}

#endif
