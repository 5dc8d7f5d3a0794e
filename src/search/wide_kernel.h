/* The search `wide`, written once for every SIMD width (simd.h).
 *
 * No heap: a radius is guessed from the local density, everything inside it is collected by compress and store, and the
 * k best are selected once. Too few found: a larger radius, and again. The guess only costs time; the answer is
 * exact. */
#ifndef PM_SEARCH_WIDE_KERNEL_H
#define PM_SEARCH_WIDE_KERNEL_H

#include "wide_collect.h"

/* A larger squared radius where `tried` held too few. */
static float enlarge(const pm__query *query, float tried, size_t found, int round)
{
    const float lacking = (float)query->k / ((float)found + 0.5f);
    const float factor = lacking < 2.0f ? 1.3f * lacking : lacking < 8.0f ? 2.6f : 6.0f;
    return round > 40 || tried > query->max_distance2 / factor ? query->max_distance2 : tried * factor;
}

static void hand_over(const walk *w)
{
    const collector *const c = w->found;
    pm_neighbor *const list = w->result->list;
    for (size_t i = 0; i < c->count; i++)
        list[i] = (pm_neighbor){c->d2[i], c->number[i]};
    w->result->count = c->count;
}

/* The k best of the candidates within `tried`, or false where there are too few and a larger radius may hold more. */
static inline bool settle(const walk *w, float tried)
{
    collector *const c = w->found;
    if (c->count < w->query->k && tried < w->query->max_distance2)
        return false;
    if (c->count > w->query->k)
        select_best(c, w->map->ids, w->query->k);
    hand_over(w);
    return true;
}

static void find_selected(const walk *w, const descent *d, float guess)
{
    for (int round = 0;; round++) {
        w->found->count = 0;
        w->found->bound = guess;
        collect(w, d);
        if (settle(w, guess))
            return;
        guess = enlarge(w->query, guess, w->found->count, round);
    }
}

static void find_heaped(const walk *w, const descent *d, float guess)
{
    for (int round = 0;; round++) {
        w->result->count = w->found->count = 0;
        w->result->bound = w->found->bound = guess;
        collect(w, d);
        make_room(w);
        if (w->result->count >= w->query->k || guess >= w->query->max_distance2)
            return;
        guess = enlarge(w->query, guess, w->result->count, round);
    }
}

static void find_within(const walk *w)
{
    block_list list = {.count = 0, .hold = false};
    const int top = w->wide->levels - 1;
    w->found->count = 0;
    w->found->bound = w->query->max_distance2;
    list_below(w, &list, 0, top, measure_boxes(w->wide->level[top], w->query, box_bound(w)));
    scan_list(w, list.blocks, list.count);
    make_room(w);
}

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    collector found;
    descent d;
    const walk w = {map, pm__wide_of(map), query, result, &found};
    if (!map->count)
        return;
    if (!query->k) {
        find_within(&w);
        return;
    }
    descend_all(&w, &d);
    if (query->k > MOST_SELECTED)
        find_heaped(&w, &d, guess_radius2(map, query, &d));
    else
        find_selected(&w, &d, guess_radius2(map, query, &d));
}

/* ---- sixteen at a time ------------------------------------------------------------------------ */

/* Stage by stage, so that the memory accesses of many queries overlap: descend all, list the blocks of all, scan
 * all. */
typedef struct stage {
    descent d;
    block_list list;
    float guess;
} stage;

static bool fits_stages(const pm__query *queries, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (queries[i].k != queries[0].k || !queries[i].k || queries[i].k > MOST_SELECTED)
            return false;
    return true;
}

static void guess_stages(const walk *walks, stage *stages, size_t count, int levels, int stop)
{
    for (size_t i = 0; i < count; i++)
        start_descent(&walks[i], &stages[i].d);
    for (int level = levels - 1; level >= stop; level--)
        for (size_t i = 0; i < count; i++)
            descend(&walks[i], &stages[i].d);
    for (size_t i = 0; i < count; i++) {
        look_at_box(&walks[i], &stages[i].d);
        stages[i].guess = guess_radius2(walks[i].map, walks[i].query, &stages[i].d);
    }
}

static void scan_stage(const walk *w, stage *s)
{
    w->found->count = 0;
    w->found->bound = s->guess;
    if (s->list.overflow)
        collect(w, &s->d);
    else
        scan_list(w, s->list.blocks, s->list.count);
    if (!settle(w, s->guess))
        find_selected(w, &s->d, enlarge(w->query, s->guess, w->found->count, 0));
}

static void find_batch(const pm_map *map, const pm__query *queries, pm__result *results, size_t count)
{
    stage stages[PM__WIDE_BATCH];
    walk walks[PM__WIDE_BATCH];
    collector found;
    if (!count || count > PM__WIDE_BATCH || !map->count || !fits_stages(queries, count)) {
        for (size_t i = 0; i < count; i++)
            find(map, &queries[i], &results[i]);
        return;
    }
    const pm__wide *const wide = pm__wide_of(map);
    for (size_t i = 0; i < count; i++)
        walks[i] = (walk){map, wide, &queries[i], &results[i], &found};
    guess_stages(walks, stages, count, wide->levels, guess_level(wide, queries[0].k));
    for (size_t i = 0; i < count; i++) {
        found.bound = stages[i].guess;
        stages[i].list.hold = true;
        list_from(&walks[i], &stages[i].d, &stages[i].list);
    }
    for (size_t i = 0; i < count; i++)
        scan_stage(&walks[i], &stages[i]);
}

#endif
