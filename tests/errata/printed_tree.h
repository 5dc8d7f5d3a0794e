/* The kd-tree as printed: Fig. 2.7 and 2.10 of [C02] and the iterative search of 5.3.2, transcribed over a plain heap
 * array. Each condition at fault (errata 14 to 19) has the printed and the corrected form. */
#ifndef PM_TESTS_PRINTED_TREE_H
#define PM_TESTS_PRINTED_TREE_H

#include "../../src/base/random.h"
#include "../test.h"

#include <stdbool.h>
#include <string.h>

enum { SMALL = 64, LARGE = 1000, ROOM = 8 * LARGE };

typedef struct point {
    float p[3];
    uint32_t id;
} point;

/* nodes[1..count] in heap order; behind them dummies at infinity, so that a read beyond the end can be seen. */
typedef struct tree {
    size_t count;
    point nodes[ROOM];
    int axis[ROOM];
    bool used[ROOM];
    size_t (*left_size)(size_t count);
    bool strict; /* erratum 19: only what lies strictly below and above the median goes on */
} tree;

/* ---- Fig. 2.7, balance -------------------------------------------------------------------------- */

static int sort_axis;

static inline int by_coordinate(const void *a, const void *b)
{
    const point *const u = a, *const v = b;
    const float x = u->p[sort_axis], y = v->p[sort_axis];
    return x != y ? (x > y) - (x < y) : (u->id > v->id) - (u->id < v->id);
}

static inline int widest_axis(const point *points, size_t count)
{
    int widest = 0;
    float width = -1.0f;
    for (int a = 0; a < 3; a++) {
        float low = points[0].p[a], high = low;
        for (size_t i = 1; i < count; i++) {
            low = fminf(low, points[i].p[a]);
            high = fmaxf(high, points[i].p[a]);
        }
        if (high - low > width) {
            width = high - low;
            widest = a;
        }
    }
    return widest;
}

static inline void balance(tree *t, point *points, size_t count, size_t index)
{
    if (count == 0)
        return;
    ck_assert_uint_lt(index, ROOM);
    sort_axis = widest_axis(points, count);
    qsort(points, count, sizeof *points, by_coordinate);
    const size_t median = t->left_size(count);
    const int a = sort_axis;
    size_t below = median, above = median + 1;
    while (t->strict && below > 0 && !(points[below - 1].p[a] < points[median].p[a]))
        below--;
    while (t->strict && above < count && !(points[above].p[a] > points[median].p[a]))
        above++;
    t->nodes[index] = points[median];
    t->axis[index] = a;
    t->used[index] = true;
    balance(t, points, below, 2 * index);
    balance(t, points + above, count - above, 2 * index + 1);
}

static inline size_t lower_median(size_t count)
{
    return (count - 1) / 2;
}

static inline size_t upper_median(size_t count)
{
    return count / 2;
}

/* Erratum 18 by its definition: the indices up to count that descend from 2. */
static inline size_t left_balanced(size_t count)
{
    size_t size = 0;
    for (size_t i = 2; i <= count; i++) {
        size_t ancestor = i;
        while (ancestor > 3)
            ancestor /= 2;
        size += ancestor == 2;
    }
    return size;
}

static inline void build(tree *t, const point *points, size_t count, size_t (*left_size)(size_t), bool strict)
{
    static point work[LARGE];
    memset(t, 0, sizeof *t);
    memcpy(work, points, count * sizeof *work);
    for (size_t i = 0; i < ROOM; i++)
        for (int a = 0; a < 3; a++)
            t->nodes[i].p[a] = INFINITY;
    t->count = count;
    t->left_size = left_size;
    t->strict = strict;
    balance(t, work, count, 1);
}

static inline size_t used_count(const tree *t)
{
    size_t count = 0;
    for (size_t i = 1; i < ROOM; i++)
        count += t->used[i];
    return count;
}

static inline size_t used_highest(const tree *t)
{
    size_t highest = 0;
    for (size_t i = 1; i < ROOM; i++)
        if (t->used[i])
            highest = i;
    return highest;
}

/* ---- The searches as printed -------------------------------------------------------------------- */

typedef struct hit {
    double d2; /* squared distance */
    uint32_t id;
} hit;

typedef struct search {
    const tree *t;
    double query[3];
    double d2; /* beyond it nothing is looked at */
    size_t k, count;
    hit hits[SMALL]; /* ascending */
    bool visited[ROOM];
    bool printed_end;    /* errata 14, 16: the printed condition for a node with children */
    bool printed_shrink; /* erratum 15 */
    size_t levels;       /* entries of the iterative search's arrays that were used */
} search;

static inline void check_photon(search *s, size_t i)
{
    ck_assert_uint_lt(i, ROOM);
    s->visited[i] = true;
    double d2 = 0.0;
    for (int a = 0; a < 3; a++) {
        const double d = (double)s->t->nodes[i].p[a] - s->query[a];
        d2 += d * d;
    }
    if (!(d2 < s->d2))
        return;
    size_t at = s->count < s->k ? s->count++ : s->k - 1;
    for (; at > 0 && s->hits[at - 1].d2 > d2; at--)
        s->hits[at] = s->hits[at - 1];
    s->hits[at] = (hit){d2, s->t->nodes[i].id};
    if (s->printed_shrink || s->count == s->k)
        s->d2 = s->hits[s->count - 1].d2;
}

static inline double signed_distance(const search *s, size_t i)
{
    return s->query[s->t->axis[i]] - (double)s->t->nodes[i].p[s->t->axis[i]];
}

/* Fig. 2.10. */
static inline void recursive(search *s, size_t p)
{
    const size_t n = s->t->count;
    if (!s->printed_end && p > n)
        return;
    if (s->printed_end ? 2 * p + 1 < n : 2 * p <= n) {
        const double delta = signed_distance(s, p);
        const size_t near = delta < 0.0 ? 2 * p : 2 * p + 1;
        recursive(s, near);
        if (delta * delta < s->d2)
            recursive(s, near ^ 1);
    }
    check_photon(s, p);
}

/* 5.3.2; `last` is the "last non-leaf node" of its loop `while (i < last)`. */
static inline void iterative(search *s, size_t last)
{
    double plane2[32];
    size_t chosen[32], i = 1, level = 0;
    for (;;) {
        while (i < last) {
            const double d = signed_distance(s, i);
            plane2[level] = d * d;
            i = 2 * i + (d > 0.0);
            chosen[level++] = i;
            s->levels = level > s->levels ? level : s->levels;
        }
        check_photon(s, i);
        size_t came_from;
        do {
            came_from = i;
            i /= 2;
            if (i == 0)
                return;
            level--;
        } while (plane2[level] >= s->d2 || came_from != chosen[level]);
        check_photon(s, i);
        i = chosen[level++] ^ 1;
    }
}

static inline void start(search *s, const tree *t, const double query[3], size_t k)
{
    memset(s, 0, sizeof *s);
    s->t = t;
    memcpy(s->query, query, sizeof s->query);
    s->d2 = (double)INFINITY;
    s->k = k;
}

/* ---- Points ------------------------------------------------------------------------------------- */

/* Coordinates on levels + 1 values from 0 to 1 or a little less, multiples of a power of two, so that up to 1024
 * squared distances are exact in float; with few levels ties abound. */
static inline void grid_points(point *to, size_t count, uint32_t trial, unsigned levels)
{
    float step = 1.0f;
    while (step * (float)levels > 1.0f)
        step /= 2.0f;
    for (size_t i = 0; i < count; i++) {
        uint32_t words[4];
        pm__random_words(14, PM__FOR_TESTS, trial, i, 0, words);
        for (int a = 0; a < 3; a++)
            to[i].p[a] = (float)(words[a] % (levels + 1)) * step;
        to[i].id = (uint32_t)i;
    }
}

static inline void random_query(uint32_t trial, uint64_t number, double query[3])
{
    uint32_t words[4];
    pm__random_words(15, PM__FOR_TESTS, trial, number, 0, words);
    for (int a = 0; a < 3; a++)
        query[a] = (double)(words[a] % 1025) / 1024.0;
}

static inline double distance2(const point *p, const double query[3])
{
    double d2 = 0.0;
    for (int a = 0; a < 3; a++) {
        const double d = (double)p->p[a] - query[a];
        d2 += d * d;
    }
    return d2;
}

static inline int by_distance(const void *a, const void *b)
{
    const hit *const u = a, *const v = b;
    return u->d2 != v->d2 ? (u->d2 > v->d2) - (u->d2 < v->d2) : (u->id > v->id) - (u->id < v->id);
}

/* All points in ascending order of distance, equal ones by index. */
static inline void brute_force(const point *points, size_t count, const double query[3], hit *hits)
{
    for (size_t i = 0; i < count; i++)
        hits[i] = (hit){distance2(&points[i], query), points[i].id};
    qsort(hits, count, sizeof *hits, by_distance);
}

#endif
