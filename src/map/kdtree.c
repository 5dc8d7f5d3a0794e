/* The left-balanced kd-tree of [C02] 2.2, split by rank so that ties are kept and any N fits (errata 18, 19).
 *
 * Every selection uses the total order (coordinate, id), so the tree is unique: neither the threads nor the
 * selection's pivots can change it. */
#include "map.h"

#include "../base/parallel.h"

#include <math.h>

enum {
    SMALL = 24,           /* ranges up to this are sorted by insertion */
    PARALLEL_LEVELS = 6,  /* levels built range by range before whole subtrees are handed out */
    PARALLEL_MINIMUM = 8192
};

typedef struct range {
    size_t first, count;
    size_t index; /* heap index of its root */
} range;

typedef struct balancing {
    pm__node *work;
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

static unsigned widest_axis(const pm__node *nodes, size_t count)
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

static unsigned most_varied_axis(const pm__node *nodes, size_t count)
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

/* id_axis holds the bare id while building, its axis bits 0. */
static inline bool before(const pm__node *a, const pm__node *b, unsigned axis)
{
    const float x = a->position[axis], y = b->position[axis];
    return x < y || (x == y && a->id_axis < b->id_axis);
}

static inline void swap(pm__node *a, pm__node *b)
{
    const pm__node t = *a;
    *a = *b;
    *b = t;
}

static void insertion_sort(pm__node *nodes, size_t count, unsigned axis)
{
    for (size_t i = 1; i < count; i++) {
        const pm__node item = nodes[i];
        size_t j = i;
        for (; j > 0 && before(&item, &nodes[j - 1], axis); j--)
            nodes[j] = nodes[j - 1];
        nodes[j] = item;
    }
}

static void heap_sink(pm__node *nodes, size_t i, size_t count, unsigned axis)
{
    for (size_t child = 2 * i + 1; child < count; i = child, child = 2 * i + 1) {
        if (child + 1 < count && before(&nodes[child], &nodes[child + 1], axis))
            child++;
        if (!before(&nodes[i], &nodes[child], axis))
            return;
        swap(&nodes[i], &nodes[child]);
    }
}

static void heap_sort(pm__node *nodes, size_t count, unsigned axis)
{
    for (size_t i = count / 2; i-- > 0;)
        heap_sink(nodes, i, count, axis);
    for (size_t end = count; end-- > 1;) {
        swap(&nodes[0], &nodes[end]);
        heap_sink(nodes, 0, end, axis);
    }
}

static const pm__node *median_of_three(const pm__node *a, const pm__node *b, const pm__node *c, unsigned axis)
{
    if (before(a, b, axis))
        return before(b, c, axis) ? b : before(a, c, axis) ? c : a;
    return before(a, c, axis) ? a : before(b, c, axis) ? c : b;
}

static pm__node pick_pivot(const pm__node *nodes, size_t count, unsigned axis)
{
    const size_t step = count / 9;
    const pm__node *const first = median_of_three(&nodes[0], &nodes[step], &nodes[2 * step], axis);
    const pm__node *const second = median_of_three(&nodes[3 * step], &nodes[4 * step], &nodes[5 * step], axis);
    const pm__node *const third = median_of_three(&nodes[6 * step], &nodes[7 * step], &nodes[count - 1], axis);
    return *median_of_three(first, second, third, axis);
}

/* Hoare's selection: afterwards nodes[rank] is in its place, smaller ones before it, larger ones after it. Input
 * that defeats the pivots is sorted by a heap instead, so the cost stays O(n log n) for any input. */
static void select_rank(pm__node *nodes, size_t count, size_t rank, unsigned axis)
{
    for (unsigned budget = 64; count > SMALL; budget--) {
        if (!budget) {
            heap_sort(nodes, count, axis);
            return;
        }
        const pm__node pivot = pick_pivot(nodes, count, axis);
        size_t i = 0, j = count - 1;
        for (;;) {
            while (before(&nodes[i], &pivot, axis))
                i++;
            while (before(&pivot, &nodes[j], axis))
                j--;
            if (i >= j)
                break;
            swap(&nodes[i++], &nodes[j--]);
        }
        /* ids differ, so exactly one node equals the pivot; [0, i) come before it or are it. */
        const size_t left = i > j ? i : i + 1;
        if (rank < left) {
            count = left;
        } else {
            nodes += left;
            count -= left;
            rank -= left;
        }
    }
    insertion_sort(nodes, count, axis);
}

static size_t place_root(const balancing *b, const range *r)
{
    pm__node *const nodes = b->work + r->first;
    const size_t left = pm__left_size(r->count);
    unsigned axis = 0;
    if (r->count > 1) {
        axis = b->split == PM_SPLIT_VARIANCE ? most_varied_axis(nodes, r->count) : widest_axis(nodes, r->count);
        select_rank(nodes, r->count, left, axis);
    }
    b->out[r->index] = nodes[left];
    b->out[r->index].id_axis = nodes[left].id_axis << 2 | axis;
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

void pm__balance(pm__node *work, size_t count, pm_split split, const pm_parallel *parallel, pm__node *out)
{
    for (size_t i = 0; i < count; i++)
        work[i].id_axis = (uint32_t)i;
    range buffers[2][(size_t)1 << PARALLEL_LEVELS];
    buffers[0][0] = (range){0, count, 1};
    balancing b = {work, out, split, buffers[0], NULL};
    size_t ranges = 1;
    if (parallel && count >= PARALLEL_MINIMUM)
        for (int level = 0; level < PARALLEL_LEVELS; level++) {
            b.ranges = buffers[level & 1];
            b.next = buffers[~level & 1];
            pm__for(parallel, ranges, balance_task, &b);
            ranges *= 2;
        }
    b.ranges = buffers[parallel && count >= PARALLEL_MINIMUM ? PARALLEL_LEVELS & 1 : 0];
    b.next = NULL;
    pm__for(parallel, ranges, balance_task, &b);
}
