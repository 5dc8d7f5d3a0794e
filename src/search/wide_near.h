/* Few blocks, as nearly always: all are listed, then measured whole, then cut; none is moved but the k that stay. */
#ifndef PM_SEARCH_WIDE_NEAR_H
#define PM_SEARCH_WIDE_NEAR_H

#include "wide_guess.h"
#include "wide_select.h"

enum { LISTED = CAPACITY / PM__LANES, SIBLINGS = 96 };

typedef struct block_list {
    size_t count, most;
    uint32_t blocks[LISTED + 2 * PM__LANES];
} block_list;

/* The children of a node that the mask names, behind those listed. */
static inline size_t list_children(uint32_t *list, size_t count, size_t node, unsigned mask)
{
    for (unsigned lane = 0; lane < PM__LANES; lane += V) {
        const unsigned part = mask >> lane & ((1U << V) - 1);
        v_compress_lanes(list + count, (uint32_t)(node * PM__LANES + lane), part);
        count += v_bits(part);
    }
    return count;
}

/* Lists, behind those listed, the blocks within the bound below nodes at the side of the path to `block`: the children
 * that the masks name, by level. False where they are too many. */
static bool list_aside(const walk *w, size_t block, const unsigned *masks, float bound, block_list *list)
{
    uint32_t nodes[2][SIBLINGS + 2 * PM__LANES], *here = nodes[0], *below = nodes[1];
    size_t count = 0;
    for (int level = w->wide->levels - 1; level > 0; level--) {
        size_t next = list_children(below, 0, block >> 4 * (level + 1), masks[level]);
        for (size_t i = 0; i < count; i++) {
            const unsigned mask = measure_boxes(&w->wide->level[level][here[i]], w->query, bound);
            next = list_children(below, next, here[i], mask);
            if (next > SIBLINGS)
                return false;
        }
        uint32_t *const swapped = here;
        here = below;
        below = swapped;
        count = next;
    }
    for (size_t i = 0; i < count; i++) {
        const unsigned mask = measure_boxes(&w->wide->level[0][here[i]], w->query, bound);
        list->count = list_children(list->blocks, list->count, here[i], mask);
        if (list->count > list->most)
            return false;
    }
    return true;
}

/* Lists the blocks within the bound, or false where they are too many. Nothing points, so all nodes above a block are
 * known at once: they are measured beside each other, not one after the other, and hold nearly all that is near. */
static inline bool list_near(const walk *w, int32_t start_block, float bound, block_list *list)
{
    const size_t block = (size_t)start_block;
    const int levels = w->wide->levels;
    pm__boxes *const *const boxes = w->wide->level;
    unsigned masks[PM__WIDE_LEVELS], high = 0;
    const unsigned own = measure_boxes(&boxes[0][block >> 4], w->query, bound);
    list->count = list_children(list->blocks, 0, block >> 4, own);
    if (levels < 2)
        return true;
    for (int level = 1; level < levels; level++) {
        masks[level] = measure_boxes(&boxes[level][block >> 4 * (level + 1)], w->query, bound);
        masks[level] &= ~(1U << (block >> 4 * level & (PM__LANES - 1)));
        high |= level > 1 ? masks[level] : 0;
    }
    if (high)
        return list_aside(w, block, masks, bound, list);
    for (unsigned rest = masks[1]; rest; rest &= rest - 1) {
        if (list->count > list->most)
            return false;
        const size_t node = (block >> 8) * PM__LANES + (size_t)__builtin_ctz(rest);
        list->count = list_children(list->blocks, list->count, node, measure_boxes(&boxes[0][node], w->query, bound));
    }
    return list->count <= list->most;
}

static inline void fetch_blocks(const pm_map *map, const block_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        const char *const at = (const char *)&map->blocks[list->blocks[i]];
        __builtin_prefetch(at);
        __builtin_prefetch(at + 64);
        __builtin_prefetch(at + 128);
    }
}

/* Squared distances of all photons of the list, block by block; how many are within the bound. */
static inline size_t measure_list(const walk *w, const block_list *list, float bound, float *d2, const bool plain)
{
    const vf limit = v_set(bound);
    size_t within = 0;
    for (size_t i = 0; i < list->count; i++)
        for (unsigned lane = 0; lane < PM__LANES; lane += V) {
            const vf value = measure(w, list->blocks[i], lane, plain);
            v_store(d2 + i * PM__LANES + lane, value);
            within += v_bits(v_le(value, limit));
        }
    return within;
}

static void append_with_ties(const walk *w, const block_list *list, const float *d2, cut at)
{
    uint32_t ids[CAPACITY + PM__LANES];
    const vf limit = v_set(at.distance2);
    pm__result *const result = w->result;
    size_t count = 0;
    for (size_t i = 0; i < list->count * PM__LANES; i += V) {
        const vf value = v_load(d2 + i);
        const size_t number = (size_t)list->blocks[i / PM__LANES] * PM__LANES + i % PM__LANES;
        const unsigned equal = v_le(value, limit) & ~v_lt(value, limit);
        v_compress_bits(ids + count, w->map->ids + number, equal); /* the array ends with a whole block */
        count += v_bits(equal);
    }
    const uint32_t last = last_id(ids, count, at.ties, w->map->count);
    for (size_t i = 0; i < list->count * PM__LANES; i += V) {
        const vf value = v_load(d2 + i);
        const size_t number = (size_t)list->blocks[i / PM__LANES] * PM__LANES + i % PM__LANES;
        const unsigned below = v_lt(value, limit), equal = v_le(value, limit) & ~below;
        const unsigned mask = below | (equal & v_up_to(w->map->ids + number, last));
        v_pairs(result->list + result->count, result->capacity - result->count, value, (uint32_t)number, mask);
        result->count += v_bits(mask);
    }
}

static inline void append_all(const walk *w, const block_list *list, const float *d2, float up_to)
{
    const vf limit = v_set(up_to);
    pm_neighbor *const to = w->result->list;
    const size_t room = w->result->capacity;
    size_t count = 0;
    for (size_t i = 0; i < list->count; i++)
        for (unsigned lane = 0; lane < PM__LANES; lane += V) {
            const vf value = v_load(d2 + i * PM__LANES + lane);
            const unsigned mask = v_le(value, limit);
            v_pairs(to + count, room - count, value, list->blocks[i] * PM__LANES + lane, mask);
            count += v_bits(mask);
        }
    w->result->count = count;
}

/* The k nearest of the listed within the bound, or false where they are fewer and a larger one may hold more. */
static inline bool settle(const walk *w, const block_list *list, float bound, size_t *found)
{
    _Alignas(64) float d2[CAPACITY];
    const size_t k = w->query->k;
    const size_t within = *found = is_plain(w->query) ? measure_list(w, list, bound, d2, true)
                                                      : measure_list(w, list, bound, d2, false);
    if (within < k && bound < w->query->max_distance2)
        return false;
    const cut at = within > k ? cut_at(d2, list->count * PM__LANES, within, bound, k) : (cut){bound, ALL_TIES};
    w->result->count = 0;
    if (at.ties == ALL_TIES)
        append_all(w, list, d2, at.distance2);
    else
        append_with_ties(w, list, d2, at);
    return true;
}

/* All of the listed within a fixed radius. */
static inline void hand_over(const walk *w, const block_list *list, const bool plain)
{
    const float bound = w->query->max_distance2;
    const vf limit = v_set(bound);
    pm__result *const result = w->result;
    for (size_t i = 0; i < list->count && !result->stopped; i++)
        for (unsigned lane = 0; lane < PM__LANES; lane += V) {
            const vf value = measure(w, list->blocks[i], lane, plain);
            const unsigned mask = v_le(value, limit);
            const uint32_t number = list->blocks[i] * PM__LANES + lane;
            const size_t more = v_bits(mask);
            if (more <= result->capacity - result->count && result->count <= result->capacity) {
                v_pairs(result->list + result->count, result->capacity - result->count, value, number, mask);
                result->count += more;
                continue;
            }
            float d2[V];
            v_store(d2, value);
            for (unsigned rest = mask; rest; rest &= rest - 1)
                pm__keep(w->query, result, d2[__builtin_ctz(rest)], number + (uint32_t)__builtin_ctz(rest));
        }
}

static inline void hand_over_list(const walk *w, const block_list *list)
{
    if (is_plain(w->query))
        hand_over(w, list, true);
    else
        hand_over(w, list, false);
}

#endif
