/* The search `grid`, written once for every SIMD width (simd.h): the runs of cells that the sphere touches, row by row,
 * all their photons measured, those within collected by compress and store. */
#ifndef PM_SEARCH_GRID_KERNEL_H
#define PM_SEARCH_GRID_KERNEL_H

#include "../map/grid.h"
#include "grid.h"
#include "result.h"
#include "simd.h"

enum { CAPACITY = 512 };

typedef struct walk {
    const pm_map *map;
    const pm__grid *grid;
    const pm__query *query;
    pm__result *result;
    float limit; /* plain squared distance beyond which nothing is wanted */
    bool plain;  /* a sphere without filter: the limit decides */
    double at[3], doubt[3]; /* the query in cells, by o; how far that may be out */
    double reach;           /* the radius in cells, rounded up */
    size_t count;
    float d2[CAPACITY + PM__LANES];
    uint32_t place[CAPACITY + PM__LANES];
} walk;

static void hand_over(walk *w)
{
    const uint32_t *const numbers = w->grid->numbers;
    pm__result *const result = w->result;
    if (numbers)
        for (size_t i = 0; i < w->count; i++)
            w->place[i] = numbers[w->place[i]];
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

static inline void scan_rows(walk *w)
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
            scan(w, grid->starts[row + first_cell(w, 0, half)], grid->starts[row + last_cell(w, 0, half) + 1]);
            if (w->result->stopped)
                return;
        }
    }
}

static inline void find_in_grid(const pm_map *map, const pm__query *query, pm__result *result)
{
    walk w; /* not initialised as a whole: it is large */
    w.map = map;
    w.grid = pm__grid_of(map);
    w.query = query;
    w.result = result;
    w.count = 0;
    w.plain = query->shape == PM_LOOKUP_SPHERE && !query->front_only;
    /* The bound, widened as pm__reaches has it, by more than what is rounded. 1e-22 is for squares that underflow. */
    const double limit = ((double)result->bound + (double)query->prune_slack) / (double)query->prune_scale;
    w.limit = w.plain ? result->bound : (float)fmin(limit * (1.0 + 1e-6) + 1e-40, 3.4e38);
    const double radius = sqrt(limit) * (1.0 + 2e-6) + 1e-22;
    w.reach = radius * w.grid->inverse_edge * (1.0 + 1e-12);
    for (unsigned o = 0; o < 3; o++) {
        w.at[o] = pm__grid_coordinate(w.grid, o, (double)query->position[w.grid->axis[o]]);
        w.doubt[o] = 1e-14 * ((double)w.grid->cells[o] + fabs(w.at[o]));
    }
    scan_rows(&w);
    hand_over(&w);
}

#endif
