/* The search `wide`, written once for every SIMD width (simd.h).
 *
 * No heap: a radius is guessed from the local density, everything inside it is measured, and the k best are cut off at
 * once. Too few found: a larger radius, and again. The guess only costs time; the answer is exact. */
#ifndef PM_SEARCH_WIDE_KERNEL_H
#define PM_SEARCH_WIDE_KERNEL_H

#include "wide_far.h"

#define SHRINK 0.3f /* of the squared radius */

/* A larger squared radius where `tried` held too few. */
static float enlarge(const walk *w, float tried, size_t found, int round)
{
    const pm__query *const query = w->query;
    if (!found && !round) { /* the hint was of another density, or the query is away from all photons */
        const scale k = scale_of(query->k);
        tried = fmaxf(tried, descend(w, &k).guess);
    }
    const float lacking = (float)query->k / ((float)found + 0.5f);
    const float factor = lacking < 2.0f ? 1.3f * lacking : lacking < 8.0f ? 2.6f : 6.0f;
    return round > 40 || tried > query->max_distance2 / factor ? query->max_distance2 : tried * factor;
}

/* So many blocks that the guess must be far too large: it is cheaper to guess again than to measure them. */
static inline size_t most_blocks(size_t k)
{
    return k > MOST_SELECTED ? 0 : k / 4 + 24 < LISTED ? k / 4 + 24 : LISTED;
}

/* May a smaller guess reach fewer blocks? Not where photons lie in one place, nor where a disc's height alone reaches
 * them. */
static inline bool shrinks(const walk *w, float guess, float too_few)
{
    return SHRINK * guess > fmaxf(too_few, FLT_MIN) && w->query->prune_slack < guess;
}

/* Tries s.guess, which is known not to be the first and too small where round > 0, and larger or smaller ones. */
static void find_nearest(const walk *w, start s, int round)
{
    block_list list;
    float too_few = round ? s.guess / 1.3f : 0.0f, too_many = INFINITY;
    size_t found;
    list.most = most_blocks(w->query->k);
    for (;; round++) {
        const bool listed = list.most && list_near(w, s.block, box_bound(w, s.guess), &list);
        if (!listed && list.most && round < 20) {
            const bool smaller = shrinks(w, s.guess, too_few);
            if (list.most < LISTED && (too_many < INFINITY || !smaller)) { /* many in one place, perhaps */
                list.most = LISTED;
                continue;
            }
            if (smaller) {
                too_many = s.guess;
                s.guess *= SHRINK;
                continue;
            }
        }
        if (listed ? settle(w, &list, s.guess, &found) : settle_far(w, s.guess, &found))
            return;
        if (!listed || round >= 20)
            too_many = INFINITY; /* where few of the photons in reach are wanted */
        too_few = s.guess;
        const float larger = enlarge(w, s.guess, found, round);
        const float between = sqrtf(too_few) * sqrtf(too_many) * 1.05f; /* but never more than the query's maximum */
        s.guess = larger < too_many ? larger : between < too_many ? between : too_many;
    }
}

static void find_within(const walk *w, int32_t block)
{
    block_list list;
    list.most = LISTED;
    if (!list_near(w, block, box_bound(w, w->query->max_distance2), &list))
        hand_over_far(w);
    else
        hand_over_list(w, &list);
}

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    const walk w = {map, pm__wide_of(map), query, result};
    if (!map->count)
        return;
    const scale k = scale_of(query->k);
    const start s = begin(&w, &k);
    if (query->k)
        find_nearest(&w, s, 0);
    else
        find_within(&w, s.block);
}

/* ---- sixteen at a time ------------------------------------------------------------------------ */

/* Stage by stage, so that the memory accesses of many queries overlap: all starts, then all lists, then all cuts. */
typedef struct stage {
    walk w;
    start s;
    bool listed;
    block_list list;
} stage;

static void finish_stage(stage *t)
{
    size_t found;
    if (!t->listed)
        find_nearest(&t->w, t->s, 0);
    else if (!settle(&t->w, &t->list, t->s.guess, &found)) {
        t->s.guess = enlarge(&t->w, t->s.guess, found, 0);
        find_nearest(&t->w, t->s, 1);
    }
}

static void find_batch(const pm_map *map, const pm__query *queries, pm__result *results, size_t count)
{
    stage stages[PM__WIDE_BATCH];
    if (!map->count || !count)
        return;
    scale k = scale_of(queries[0].k);
    for (size_t i = 0; i < count; i++) {
        stages[i].w = (walk){map, pm__wide_of(map), &queries[i], &results[i]};
        if (queries[i].k != k.k)
            k = scale_of(queries[i].k);
        stages[i].s = begin(&stages[i].w, &k);
    }
    for (size_t i = 0; i < count; i++) {
        stage *const t = &stages[i];
        t->list.most = queries[i].k ? most_blocks(queries[i].k) : LISTED;
        t->listed = t->list.most && list_near(&t->w, t->s.block, box_bound(&t->w, t->s.guess), &t->list);
        if (t->listed)
            fetch_blocks(map, &t->list);
    }
    for (size_t i = 0; i < count; i++) {
        stage *const t = &stages[i];
        if (queries[i].k)
            finish_stage(t);
        else if (t->listed)
            hand_over_list(&t->w, &t->list);
        else
            hand_over_far(&t->w);
    }
}

#endif
