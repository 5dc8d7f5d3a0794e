/* The search `grid`, written once for every SIMD width (simd.h): the runs of cells that the sphere touches, row by row,
 * all their photons measured, those within collected by compress and store. */
#ifndef PM_SEARCH_GRID_KERNEL_H
#define PM_SEARCH_GRID_KERNEL_H

#include "../map/grid.h"
#include "grid.h"
#include "result.h"
#include "simd.h"

enum {
    CAPACITY = 512,
    RUNS = 9 /* of cells, of a search among several: one that touches more is not worth it */
};

typedef struct runs {
    size_t count;                  /* above RUNS: there are more */
    uint32_t from[RUNS], to[RUNS]; /* cells, then places */
} runs;

typedef struct walk {
    const pm_map *map;
    const pm__grid *grid;
    const pm__query *query;
    pm__result *result;
    float limit; /* plain squared distance beyond which nothing is wanted */
    bool plain;  /* a sphere: the limit decides; sides are looked at later */
    bool sided;  /* when photons are handed over */
    runs *list;  /* where several search together */
    double at[3], doubt[3]; /* the query in cells, by o; how far that may be out */
    double reach;           /* the radius in cells, rounded up */
    size_t count;
    float d2[CAPACITY + PM__LANES];
    uint32_t place[CAPACITY + PM__LANES];
} walk;

/* Drops what came from behind. */
static void keep_front(walk *w)
{
    size_t kept = 0;
    for (size_t i = 0; i < w->count; i++) {
        const bool in_front = pm__in_front(w->map, w->query, w->place[i]);
        w->d2[kept] = w->d2[i];
        w->place[kept] = w->place[i];
        kept += in_front;
    }
    w->count = kept;
}

static void hand_over(walk *w)
{
    const uint32_t *const numbers = w->grid->numbers;
    pm__result *const result = w->result;
    if (numbers)
        for (size_t i = 0; i < w->count; i++)
            w->place[i] = numbers[w->place[i]];
    if (w->sided)
        keep_front(w);
    if (result->count + w->count <= result->capacity) {
        pm_neighbor *const to = result->list + result->count;
        for (size_t i = 0; i < w->count; i++)
            to[i] = (pm_neighbor){w->d2[i], w->place[i]};
        result->count += w->count;
    } else {
        for (size_t i = 0; i < w->count; i++)
            pm__keep(w->query, result, w->d2[i], w->place[i]);
    }
    w->count = 0;
}

static void offer(const walk *w, size_t from, unsigned mask)
{
    for (; mask; mask &= mask - 1) {
        const size_t p = from + (size_t)__builtin_ctz(mask);
        const pm__block *const b = &w->grid->blocks[p / PM__LANES];
        const float position[3] = {b->x[p % PM__LANES], b->y[p % PM__LANES], b->z[p % PM__LANES]};
        pm__offer(w->map, w->query, w->result, position, w->grid->numbers ? w->grid->numbers[p] : (uint32_t)p);
    }
}

/* Photons of places [from, to). */
static inline void scan(walk *w, size_t from, size_t to)
{
    const float *const q = w->query->position;
    for (size_t p = from / V * V; p < to; p += V) {
        const pm__block *const b = &w->grid->blocks[p / PM__LANES];
        const size_t lane = p % PM__LANES;
        const vf x = v_sub(v_load(b->x + lane), v_set(q[0]));
        const vf y = v_sub(v_load(b->y + lane), v_set(q[1]));
        const vf z = v_sub(v_load(b->z + lane), v_set(q[2]));
        const vf d2 = v_add(v_add(v_mul(x, x), v_mul(y, y)), v_mul(z, z)); /* in the order of pm__measure */
        unsigned mask = v_le(d2, v_set(w->limit));
        mask &= ~0U << (p < from ? from - p : 0); /* what stands before and behind belongs to other cells */
        mask &= ~0U >> (to - p < V ? 32 - (to - p) : 0);
        if (!w->plain) {
            offer(w, p, mask);
            continue;
        }
        v_compress(w->d2 + w->count, d2, mask);
        v_compress_lanes(w->place + w->count, (uint32_t)p, mask);
        w->count += v_bits(mask);
        if (w->count > CAPACITY)
            hand_over(w);
    }
}

/* How far the query is from cell c along o, in cells; outermost cells have no outer side. */
static inline double gap(const walk *w, unsigned o, size_t c)
{
    const double below = (double)c - w->at[o], above = w->at[o] - (double)(c + 1);
    if (below > w->doubt[o] && c > 0)
        return below - w->doubt[o];
    if (above > w->doubt[o] && c + 1 < w->grid->cells[o])
        return above - w->doubt[o];
    return 0.0;
}

static inline size_t first_cell(const walk *w, unsigned o, double reach)
{
    return pm__grid_clamp(w->grid, o, w->at[o] - reach - w->doubt[o]);
}

static inline size_t last_cell(const walk *w, unsigned o, double reach)
{
    return pm__grid_clamp(w->grid, o, w->at[o] + reach + w->doubt[o]);
}

/* Visits the runs of cells [from, to) that the sphere touches; visit says whether to go on. */
static inline void for_runs(walk *w, bool (*visit)(walk *w, size_t from, size_t to))
{
    const pm__grid *const grid = w->grid;
    const double square = w->reach * w->reach;
    const size_t first = first_cell(w, 1, w->reach), last = last_cell(w, 1, w->reach);
    for (size_t c2 = first_cell(w, 2, w->reach), end = last_cell(w, 2, w->reach); c2 <= end; c2++) {
        const double gap2 = gap(w, 2, c2), left2 = square - gap2 * gap2;
        for (size_t c1 = first; c1 <= last; c1++) {
            const double gap1 = gap(w, 1, c1), left = left2 - gap1 * gap1;
            if (!(left >= 0.0))
                continue;
            const double half = sqrt(left); /* of the row's chord */
            const size_t row = (c2 * grid->cells[1] + c1) * grid->cells[0];
            if (!visit(w, row + first_cell(w, 0, half), row + last_cell(w, 0, half) + 1))
                return;
        }
    }
}

static inline bool scan_run(walk *w, size_t from, size_t to)
{
    scan(w, w->grid->starts[from], w->grid->starts[to]);
    return !w->result->stopped;
}

/* Where the query is and how far it reaches; the map and the grid are known. */
static inline void aim(walk *w, const pm__query *query, pm__result *result)
{
    w->query = query;
    w->result = result;
    w->count = 0;
    w->plain = query->shape == PM_LOOKUP_SPHERE;
    w->sided = w->plain && query->front_only;
    /* The bound, widened as pm__reaches has it, by more than what is rounded. 1e-22 is for squares that underflow. */
    const double limit = ((double)result->bound + (double)query->prune_slack) / (double)query->prune_scale;
    w->limit = w->plain ? result->bound : (float)fmin(limit * (1.0 + 1e-6) + 1e-40, 3.4e38);
    const double radius = sqrt(limit) * (1.0 + 2e-6) + 1e-22;
    w->reach = radius * w->grid->inverse_edge * (1.0 + 1e-12);
    for (unsigned o = 0; o < 3; o++) {
        w->at[o] = pm__grid_coordinate(w->grid, o, (double)query->position[w->grid->axis[o]]);
        w->doubt[o] = 1e-14 * ((double)w->grid->cells[o] + fabs(w->at[o]));
    }
}

static inline void find_alone(walk *w, const pm__query *query, pm__result *result)
{
    aim(w, query, result);
    for_runs(w, scan_run);
    hand_over(w);
}

static void find_in_grid(const pm_map *map, const pm__query *query, pm__result *result)
{
    walk w; /* not initialised as a whole: it is large */
    w.map = map;
    w.grid = pm__grid_of(map);
    find_alone(&w, query, result);
}

/* ---- Several at once --------------------------------------------------------------------------- */

/* A search that finds a photon or two waits for memory most of the time: several take their steps together, each asking
 * for what the next one reads. */

static inline bool list_run(walk *w, size_t from, size_t to)
{
    runs *const list = w->list;
    if (list->count < RUNS) {
        list->from[list->count] = (uint32_t)from;
        list->to[list->count] = (uint32_t)to;
        __builtin_prefetch(&w->grid->starts[from]);
    }
    return list->count++ < RUNS;
}

static inline void find_places(const pm__grid *grid, runs *list)
{
    for (size_t i = 0; i < list->count; i++) {
        const uint32_t from = list->from[i] = grid->starts[list->from[i]];
        const uint32_t to = list->to[i] = grid->starts[list->to[i]];
        for (uint32_t b = from / PM__LANES; from < to && b <= (to - 1) / PM__LANES && b < from / PM__LANES + 2; b++) {
            __builtin_prefetch(grid->blocks[b].x);
            __builtin_prefetch(grid->blocks[b].y);
            __builtin_prefetch(grid->blocks[b].z);
        }
    }
}

/* What scanning asks of a search that has been aimed before. Sides are left to the next step. */
static inline void scan_places(walk *w, const pm__query *query, pm__result *result, const runs *list)
{
    w->query = query;
    w->result = result;
    w->count = 0;
    w->limit = result->bound;
    w->plain = true;
    w->sided = false;
    for (size_t i = 0; i < list->count; i++)
        scan(w, list->from[i], list->to[i]);
    hand_over(w);
    for (size_t i = 0; i < result->count && i < result->capacity; i++)
        __builtin_prefetch(pm__power(w->map, result->list[i].number));
}

static inline void drop_behind(const pm_map *map, const pm__query *query, pm__result *result)
{
    size_t kept = 0;
    for (size_t i = 0; i < result->count; i++) {
        const bool in_front = pm__in_front(map, query, result->list[i].number);
        result->list[kept] = result->list[i];
        kept += in_front;
    }
    result->count = kept;
}

static void find_all_in_grid(const pm_map *map, const pm__query *queries, pm__result *results, size_t count)
{
    runs lists[PM__GRID_BATCH];
    walk w;
    w.map = map;
    w.grid = pm__grid_of(map);
    for (size_t i = 0; i < count; i++) {
        aim(&w, &queries[i], &results[i]);
        w.list = &lists[i];
        lists[i].count = w.plain && !results[i].deliver ? 0 : RUNS + 1;
        if (lists[i].count == 0)
            for_runs(&w, list_run);
    }
    for (size_t i = 0; i < count; i++)
        if (lists[i].count <= RUNS)
            find_places(w.grid, &lists[i]);
    for (size_t i = 0; i < count; i++)
        if (lists[i].count <= RUNS)
            scan_places(&w, &queries[i], &results[i], &lists[i]);
    for (size_t i = 0; i < count; i++)
        if (lists[i].count > RUNS || (queries[i].front_only && results[i].count > results[i].capacity)) {
            results[i].count = 0;
            find_alone(&w, &queries[i], &results[i]);
        } else if (queries[i].front_only) {
            drop_behind(map, &queries[i], &results[i]);
        }
}

#endif
