/* The grid of grid.h: its frame from a sample, its cells by a counting sort. */
#include "grid.h"
#include "bulk.h"
#include "structure.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLE = 4096, CHUNK = 1 << 15, BUCKETS = 512 };

/* Photons that fill space are six to a cell of the larger ones, those of surfaces many more; of the smaller ones, of
 * which there are six times as many, they share theirs with one other. Twice those six would be three here. */
enum { PHOTONS_A_CELL = 6, CROWDED = 3 };

typedef struct extents {
    float least[4], most[4]; /* the last one, of ids, means nothing: four are as fast as one */
} extents;

/* An arrangement under way. Items are brought into the order of buckets, runs of cells, and then each bucket into that
 * of its cells: both steps stay within the caches, and any number of threads can share them. */
typedef struct sorting {
    pm__grid *grid;
    pm__item *items, *copy; /* copy: by bucket */
    uint32_t *cells;        /* of the copy's */
    size_t count, chunks, buckets;
    unsigned shift;         /* cell >> shift is its bucket */
    uint32_t *next;         /* [chunks * BUCKETS]: how many of the chunk are in the bucket, then where they go */
    uint32_t first[BUCKETS + 1];
    double shared[BUCKETS]; /* by bucket, the sum over its cells of photons squared */
    extents *extents;       /* [chunks] */
} sorting;

static size_t chunk_end(const sorting *s, size_t chunk)
{
    return (chunk + 1) * CHUNK < s->count ? (chunk + 1) * CHUNK : s->count;
}

/* ---- The frame --------------------------------------------------------------------------------- */

static void extents_task(void *argument, size_t chunk)
{
    const sorting *const s = argument;
    extents e = {{INFINITY, INFINITY, INFINITY, 0.0f}, {-INFINITY, -INFINITY, -INFINITY, 0.0f}};
    for (size_t i = chunk * CHUNK; i < chunk_end(s, chunk); i++) {
        float x[4];
        memcpy(x, &s->items[i], sizeof x);
        for (int a = 0; a < 4; a++) {
            e.least[a] = x[a] < e.least[a] ? x[a] : e.least[a];
            e.most[a] = x[a] > e.most[a] ? x[a] : e.most[a];
        }
    }
    s->extents[chunk] = e;
}

/* The range of the bulk along an axis, widened so that a uniform cloud is covered whole. */
static void bulk(const sorting *s, unsigned axis, double *low, double *high)
{
    float sample[SAMPLE], first = 0.0f, last = 0.0f;
    const size_t n = s->count < SAMPLE ? s->count : SAMPLE;
    for (size_t i = 0; i < n; i++)
        sample[i] = s->items[(size_t)((double)i / (double)n * (double)s->count)].position[axis];
    if (n)
        pm__bulk(sample, n, &first, &last);
    const double from = (double)first, to = (double)last;
    double least = INFINITY, most = -INFINITY;
    for (size_t c = 0; c < s->chunks; c++) {
        least = fmin(least, (double)s->extents[c].least[axis]);
        most = fmax(most, (double)s->extents[c].most[axis]);
    }
    *low = fmax(least, from - 0.02 * (to - from));
    *high = fmin(most, to + 0.02 * (to - from));
}

/* Longest axis first, so that rows are long. */
static void frame(const sorting *s, double range[3])
{
    pm__grid *const grid = s->grid;
    double low[3], extent[3];
    for (unsigned a = 0; a < 3; a++) {
        bulk(s, a, &low[a], &extent[a]);
        extent[a] -= low[a];
        grid->axis[a] = a;
    }
    for (int pass = 0; pass < 2; pass++)
        for (int o = 0; o < 2; o++)
            if (extent[grid->axis[o + 1]] > extent[grid->axis[o]]) {
                const unsigned axis = grid->axis[o];
                grid->axis[o] = grid->axis[o + 1];
                grid->axis[o + 1] = axis;
            }
    for (int o = 0; o < 3; o++) {
        grid->low[o] = low[grid->axis[o]];
        range[o] = extent[grid->axis[o]];
    }
}

static double cells_along(double range, double inverse_edge)
{
    return floor(range * inverse_edge) + 1.0;
}

static double cell_count(const double range[3], double inverse_edge)
{
    return cells_along(range[0], inverse_edge) * cells_along(range[1], inverse_edge) *
           cells_along(range[2], inverse_edge);
}

/* The smallest cells of which there are at most `limit`: by bisection of their number along the longest axis. */
static void choose_cells(pm__grid *grid, const double range[3], size_t limit)
{
    double few = 0.0, many = (double)limit; /* edges along the longest axis */
    if (range[0] > 0.0 && isfinite(1.0 / range[0]))
        for (int step = 0; step < 40; step++) {
            const double middle = 0.5 * (few + many);
            if (cell_count(range, middle / range[0]) <= (double)limit)
                few = middle;
            else
                many = middle;
        }
    grid->inverse_edge = few > 0.0 ? few / range[0] : 0.0;
    for (int o = 0; o < 3; o++) {
        grid->cells[o] = (size_t)cells_along(range[o], grid->inverse_edge);
        grid->last[o] = (double)grid->cells[o] - 1.0;
    }
}

static inline size_t cell_of(const pm__grid *grid, const float position[3])
{
    const size_t c0 = pm__grid_cell(grid, 0, (double)position[grid->axis[0]]);
    const size_t c1 = pm__grid_cell(grid, 1, (double)position[grid->axis[1]]);
    const size_t c2 = pm__grid_cell(grid, 2, (double)position[grid->axis[2]]);
    return (c2 * grid->cells[1] + c1) * grid->cells[0] + c0;
}

static size_t cells_of(const pm__grid *grid)
{
    return grid->cells[0] * grid->cells[1] * grid->cells[2];
}

/* ---- The order --------------------------------------------------------------------------------- */

static void count_task(void *argument, size_t chunk)
{
    const sorting *const s = argument;
    uint32_t *const counts = s->next + chunk * BUCKETS;
    const pm__grid grid = *s->grid; /* its own, or every count might change it */
    memset(counts, 0, BUCKETS * sizeof *counts);
    for (size_t i = chunk * CHUNK; i < chunk_end(s, chunk); i++)
        counts[cell_of(&grid, s->items[i].position) >> s->shift]++;
}

static void scatter_task(void *argument, size_t chunk)
{
    const sorting *const s = argument;
    const pm__grid grid = *s->grid;
    uint32_t *const next = s->next + chunk * BUCKETS;
    for (size_t i = chunk * CHUNK; i < chunk_end(s, chunk); i++) {
        const size_t cell = cell_of(&grid, s->items[i].position);
        const uint32_t to = next[cell >> s->shift]++;
        s->copy[to] = s->items[i];
        s->cells[to] = (uint32_t)cell;
    }
}

/* The bucket's cells: the first, and the one behind the last. */
static size_t first_cell(const sorting *s, size_t bucket)
{
    const size_t all = cells_of(s->grid);
    return bucket << s->shift < all ? bucket << s->shift : all;
}

/* In starts[c] how many are in cell c. */
static void count_cells_task(void *argument, size_t bucket)
{
    sorting *const s = argument;
    uint32_t *const starts = s->grid->starts;
    const size_t from = first_cell(s, bucket), to = first_cell(s, bucket + 1);
    double shared = 0.0;
    memset(starts + from, 0, (to - from) * sizeof *starts);
    for (size_t i = s->first[bucket]; i < s->first[bucket + 1]; i++)
        starts[s->cells[i]]++;
    for (size_t c = from; c < to; c++)
        shared += (double)starts[c] * (double)starts[c];
    s->shared[bucket] = shared;
}

/* Items of a cell keep their order. */
static void place_task(void *argument, size_t bucket)
{
    sorting *const s = argument;
    uint32_t *const starts = s->grid->starts;
    const size_t from = first_cell(s, bucket), to = first_cell(s, bucket + 1);
    uint32_t before = s->first[bucket];
    for (size_t c = from; c < to; c++) {
        const uint32_t here = starts[c];
        starts[c] = before;
        before += here;
    }
    for (size_t i = s->first[bucket]; i < s->first[bucket + 1]; i++)
        s->items[starts[s->cells[i]]++] = s->copy[i];
    for (size_t c = to; c > from + 1; c--) /* each stands at its cell's end */
        starts[c - 1] = starts[c - 2];
    if (to > from)
        starts[from] = s->first[bucket];
}

/* Where the chunks' photons of each bucket go: chunk by chunk, so that they keep their order. */
static void add_up(sorting *s)
{
    uint32_t before = 0;
    for (size_t b = 0; b < s->buckets; b++) {
        s->first[b] = before;
        for (size_t c = 0; c < s->chunks; c++) {
            const uint32_t here = s->next[c * BUCKETS + b];
            s->next[c * BUCKETS + b] = before;
            before += here;
        }
    }
    s->first[s->buckets] = before;
}

/* Puts the items into the copy by buckets and counts the cells'. Returns the number that the average photon shares its
 * cell with. */
static double sort_buckets(sorting *s, const pm_parallel *parallel)
{
    const size_t all = cells_of(s->grid);
    s->shift = 0;
    while (all > (size_t)BUCKETS << s->shift)
        s->shift++;
    s->buckets = (all - 1) / ((size_t)1 << s->shift) + 1;
    pm__for(parallel, s->chunks, count_task, s);
    add_up(s);
    pm__for(parallel, s->chunks, scatter_task, s);
    pm__for(parallel, s->buckets, count_cells_task, s);
    double shared = 0.0;
    for (size_t b = 0; b < s->buckets; b++)
        shared += s->shared[b];
    return s->count ? shared / (double)s->count : 0.0;
}

/* most: cells. Where photons fill space such small ones hold one each, and larger ones do better. */
static void sort_items(sorting *s, size_t most, const pm_parallel *parallel)
{
    double range[3] = {0.0, 0.0, 0.0};
    pm__for(parallel, s->chunks, extents_task, s);
    if (s->count)
        frame(s, range);
    choose_cells(s->grid, range, most);
    if (sort_buckets(s, parallel) < CROWDED) {
        choose_cells(s->grid, range, most / PHOTONS_A_CELL + 1);
        (void)sort_buckets(s, parallel);
    }
    pm__for(parallel, s->buckets, place_task, s);
    s->grid->starts[cells_of(s->grid)] = (uint32_t)s->count;
}

static void destroy(void *index)
{
    pm__grid *const grid = index;
    if (!grid)
        return;
    free(grid->starts);
    free(grid->own_blocks);
    free(grid->numbers);
    free(grid);
}

static void shrink(pm__grid *grid)
{
    uint32_t *const fitted = realloc(grid->starts, (cells_of(grid) + 1) * sizeof *fitted);
    if (fitted)
        grid->starts = fitted;
}

static pm_status arrange(pm__item *items, size_t count, const pm_map_options *options, void **index)
{
    const size_t most = count > 64 ? count - count / 32 : 64; /* at most 24 bytes a photon in all */
    const size_t chunks = (count + CHUNK - 1) / CHUNK;
    sorting *const s = calloc(1, sizeof *s);
    if (!s)
        return PM_ENOMEM;
    *s = (sorting){.grid = calloc(1, sizeof *s->grid), .items = items, .copy = pm__alloc(count, sizeof *s->copy),
                   .cells = pm__alloc(count, sizeof *s->cells), .count = count, .chunks = chunks,
                   .next = pm__alloc(chunks * BUCKETS, sizeof *s->next),
                   .extents = pm__alloc(chunks, sizeof *s->extents)};
    if (s->grid)
        s->grid->starts = malloc((most + 1) * sizeof *s->grid->starts);
    const bool room = s->grid && s->copy && s->cells && s->next && s->extents && s->grid->starts;
    if (room) {
        sort_items(s, most, options->parallel);
        shrink(s->grid);
        *index = s->grid;
    } else {
        destroy(s->grid);
    }
    free(s->copy);
    free(s->cells);
    free(s->next);
    free(s->extents);
    free(s);
    return room ? PM_OK : PM_ENOMEM;
}

static pm_status place(const pm_map *map, void *index, const uint32_t *numbers, const pm_parallel *parallel)
{
    (void)parallel;
    pm__grid *const grid = index;
    grid->blocks = map->blocks;
    if (!numbers)
        return PM_OK;
    grid->own_blocks = pm__alloc(map->block_count, sizeof *grid->own_blocks);
    grid->numbers = pm__alloc(map->block_count * PM__LANES, sizeof *grid->numbers);
    if (!grid->own_blocks || !grid->numbers)
        return PM_ENOMEM;
    for (size_t p = 0; p < map->block_count * PM__LANES; p++) {
        float position[3] = {INFINITY, INFINITY, INFINITY};
        grid->numbers[p] = p < map->count ? numbers[p] : 0;
        if (p < map->count)
            pm__position(map, numbers[p], position);
        pm__block *const block = &grid->own_blocks[p / PM__LANES];
        block->x[p % PM__LANES] = position[0];
        block->y[p % PM__LANES] = position[1];
        block->z[p % PM__LANES] = position[2];
    }
    grid->blocks = grid->own_blocks;
    return PM_OK;
}

static size_t bytes(const pm_map *map, const void *index)
{
    const pm__grid *const grid = index;
    const size_t starts = (cells_of(grid) + 1) * sizeof *grid->starts, blocks = map->block_count * sizeof(pm__block);
    return starts + blocks + (grid->numbers ? map->count * sizeof *grid->numbers : 0);
}

const pm__structure pm__structure_grid = {PM__GRID, arrange, place, destroy, bytes, false, 4.0, 20.0, 0.0};

pm_status pm__grid_check(const pm_map *map, pm_error *error)
{
    const pm__grid *const grid = pm__grid_of(map);
    if (grid->starts[0] != 0 || grid->starts[cells_of(grid)] != map->count)
        return pm__fail(error, PM_EBROKEN, "the grid's cells do not hold all photons");
    for (size_t c = 0; c < cells_of(grid); c++)
        for (size_t p = grid->starts[c]; p < grid->starts[c + 1]; p++) {
            const pm__block *const block = &grid->blocks[p / PM__LANES];
            const size_t lane = p % PM__LANES, number = grid->numbers ? grid->numbers[p] : p;
            const float here[3] = {block->x[lane], block->y[lane], block->z[lane]};
            float position[3];
            pm__position(map, number, position);
            if (memcmp(here, position, sizeof here) != 0 || cell_of(grid, position) != c)
                return pm__fail(error, PM_EBROKEN, "photon %zu is not in its cell", number);
        }
    return PM_OK;
}
