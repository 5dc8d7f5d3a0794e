/* The left-balanced kd-tree of [C02] 2.2, split by rank so that ties are kept and any N fits (errata 18, 19).
 *
 * Every selection uses the total order (coordinate, id), so the tree is unique: neither the threads nor the
 * selection's pivots can change it. */
#include "map.h"
#include "structure.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <stdlib.h>

enum {
    PARALLEL_LEVELS = 6,  /* levels built range by range before whole subtrees are handed out */
    PARALLEL_MINIMUM = 8192
};

typedef struct range {
    size_t first, count;
    size_t index; /* heap index of its root */
} range;

typedef struct balancing {
    pm__item *work;
    pm__node *out;
    pm_split split;
    range *ranges;
    range *next; /* NULL: build whole subtrees */
} balancing;

size_t pm__left_size(size_t count)
{
    if (count < 2)
        return 0;
    size_t half = 1; /* places of the last level below the left child */
    while (4 * half <= count)
        half *= 2;
    const size_t last = count - (2 * half - 1);
    return half - 1 + (last < half ? last : half);
}

static unsigned widest_axis(const pm__item *nodes, size_t count)
{
    float low[3], high[3];
    for (int a = 0; a < 3; a++)
        low[a] = high[a] = nodes[0].position[a];
    for (size_t i = 1; i < count; i++)
        for (int a = 0; a < 3; a++) {
            const float x = nodes[i].position[a];
            low[a] = x < low[a] ? x : low[a];
            high[a] = x > high[a] ? x : high[a];
        }
    unsigned axis = 0;
    for (unsigned a = 1; a < 3; a++)
        if (high[a] - low[a] > high[axis] - low[axis])
            axis = a;
    return axis;
}

static unsigned most_varied_axis(const pm__item *nodes, size_t count)
{
    double mean[3] = {0.0, 0.0, 0.0}, square[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) /* Welford's update */ {
            const double x = (double)nodes[i].position[a], before = x - mean[a];
            mean[a] += before / (double)(i + 1);
            square[a] += before * (x - mean[a]);
        }
    unsigned axis = 0;
    for (unsigned a = 1; a < 3; a++)
        if (square[a] > square[axis])
            axis = a;
    return axis;
}

static size_t place_root(const balancing *b, const range *r)
{
    pm__item *const nodes = b->work + r->first;
    const size_t left = pm__left_size(r->count);
    unsigned axis = 0;
    if (r->count > 1) {
        axis = b->split == PM_SPLIT_VARIANCE ? most_varied_axis(nodes, r->count) : widest_axis(nodes, r->count);
        pm__select_rank(nodes, r->count, left, axis);
    }
    pm__node *const root = &b->out[r->index];
    for (int a = 0; a < 3; a++)
        root->position[a] = nodes[left].position[a];
    root->number_axis = nodes[left].id << 2 | axis; /* the id, until place knows the number */
    return left;
}

static void build_subtree(const balancing *b, range r)
{
    while (r.count) {
        const size_t left = place_root(b, &r);
        build_subtree(b, (range){r.first, left, 2 * r.index});
        r = (range){r.first + left + 1, r.count - left - 1, 2 * r.index + 1};
    }
}

static void balance_task(void *argument, size_t i)
{
    const balancing *const b = argument;
    const range r = b->ranges[i];
    if (!b->next) {
        build_subtree(b, r);
        return;
    }
    size_t left = 0;
    if (r.count)
        left = place_root(b, &r);
    b->next[2 * i] = (range){r.first, left, 2 * r.index};
    b->next[2 * i + 1] = (range){r.first + left + 1, r.count ? r.count - left - 1 : 0, 2 * r.index + 1};
}

static void balance(pm__item *work, size_t count, const pm_map_options *options, pm__node *out)
{
    range buffers[2][(size_t)1 << PARALLEL_LEVELS];
    buffers[0][0] = (range){0, count, 1};
    balancing b = {work, out, options->split, buffers[0], NULL};
    size_t ranges = 1;
    const bool levels = options->parallel && count >= PARALLEL_MINIMUM;
    for (int level = 0; levels && level < PARALLEL_LEVELS; level++) {
        b.ranges = buffers[level & 1];
        b.next = buffers[~level & 1];
        pm__for(options->parallel, ranges, balance_task, &b);
        ranges *= 2;
    }
    b.ranges = buffers[levels ? PARALLEL_LEVELS & 1 : 0];
    b.next = NULL;
    pm__for(options->parallel, ranges, balance_task, &b);
}

static pm_status arrange(pm__item *items, size_t count, const pm_map_options *options, void **index)
{
    pm__node *const nodes = pm__alloc(count + 1, sizeof *nodes);
    if (!nodes)
        return PM_ENOMEM;
    nodes[0] = (pm__node){{0.0f, 0.0f, 0.0f}, 0};
    balance(items, count, options, nodes);
    for (size_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++)
            items[i].position[a] = nodes[i + 1].position[a];
        items[i].id = nodes[i + 1].number_axis >> 2;
    }
    *index = nodes;
    return PM_OK;
}

static pm_status place(const pm_map *map, void *index, const uint32_t *numbers, const pm_parallel *parallel)
{
    (void)parallel;
    pm__node *const nodes = index;
    for (size_t i = 0; i < map->count; i++)
        nodes[i + 1].number_axis = (numbers ? numbers[i] : (uint32_t)i) << 2 | pm__node_axis(&nodes[i + 1]);
    return PM_OK;
}

static size_t bytes(const pm_map *map, const void *index)
{
    (void)index;
    return (map->count + 1) * sizeof(pm__node);
}

const pm__structure pm__structure_tree = {PM__KD_TREE, arrange, place, free, bytes, false, 16.0, 0.0, 0.0};
