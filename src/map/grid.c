/* The grid of grid.h: its frame from a sample, its cells by a counting sort. */
#include "grid.h"
#include "bulk.h"
#include "structure.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SAMPLE = 4096,
    PHOTONS_A_CELL = 6, /* where photons fill the cells */
    CROWDED = 2 * PHOTONS_A_CELL
};

/* The range of the bulk along an axis, widened so that a uniform cloud is covered whole. */
static void bulk(const pm__item *items, size_t count, unsigned axis, double *low, double *high)
{
    float sample[SAMPLE], first = 0.0f, last = 0.0f;
    const size_t n = count < SAMPLE ? count : SAMPLE;
    for (size_t i = 0; i < n; i++)
        sample[i] = items[(size_t)((double)i / (double)n * (double)count)].position[axis];
    if (n)
        pm__bulk(sample, n, &first, &last);
    const double from = (double)first, to = (double)last;
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double x = (double)items[i].position[axis];
        least = x < least ? x : least;
        most = x > most ? x : most;
    }
    *low = fmax(least, from - 0.02 * (to - from));
    *high = fmin(most, to + 0.02 * (to - from));
}

/* Longest axis first, so that rows are long. */
static void frame(pm__grid *grid, const pm__item *items, size_t count, double range[3])
{
    double low[3], extent[3];
    for (unsigned a = 0; a < 3; a++) {
        bulk(items, count, a, &low[a], &extent[a]);
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
    for (int o = 0; o < 3; o++)
        grid->cells[o] = (size_t)cells_along(range[o], grid->inverse_edge);
}

static size_t cell_of(const pm__grid *grid, const float position[3])
{
    size_t c[3];
    for (unsigned o = 0; o < 3; o++)
        c[o] = pm__grid_cell(grid, o, (double)position[grid->axis[o]]);
    return (c[2] * grid->cells[1] + c[1]) * grid->cells[0] + c[0];
}

static size_t cells_of(const pm__grid *grid)
{
    return grid->cells[0] * grid->cells[1] * grid->cells[2];
}

/* Cells of all items, and in starts[c + 1] how many are in cell c. Returns the number that the average photon shares
 * its cell with. */
static double count_cells(const pm__grid *grid, const pm__item *items, size_t count, uint32_t *cells)
{
    const size_t all = cells_of(grid);
    memset(grid->starts, 0, (all + 1) * sizeof *grid->starts);
    for (size_t i = 0; i < count; i++) {
        cells[i] = (uint32_t)cell_of(grid, items[i].position);
        grid->starts[cells[i] + 1]++;
    }
    double shared = 0.0;
    for (size_t c = 1; c <= all; c++)
        shared += (double)grid->starts[c] * (double)grid->starts[c];
    return count ? shared / (double)count : 0.0;
}

/* Counting sort; items of a cell keep their order. */
static void sort_items(const pm__grid *grid, const uint32_t *cells, pm__item *items, pm__item *copy, size_t count)
{
    const size_t all = cells_of(grid);
    for (size_t c = 1; c <= all; c++)
        grid->starts[c] += grid->starts[c - 1];
    memcpy(copy, items, count * sizeof *copy);
    for (size_t i = 0; i < count; i++)
        items[grid->starts[cells[i]]++] = copy[i];
    memmove(grid->starts + 1, grid->starts, all * sizeof *grid->starts); /* each stands at its cell's end */
    grid->starts[0] = 0;
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
    (void)options;
    pm__grid *const grid = calloc(1, sizeof *grid);
    uint32_t *const cells = pm__alloc(count, sizeof *cells);
    pm__item *const copy = pm__alloc(count, sizeof *copy);
    const size_t most = count > 64 ? count - count / 32 : 64; /* at most 24 bytes a photon in all */
    if (grid)
        grid->starts = malloc((most + 1) * sizeof *grid->starts);
    const bool room = grid && cells && copy && grid->starts;
    if (room) {
        double range[3] = {0.0, 0.0, 0.0};
        if (count)
            frame(grid, items, count, range);
        choose_cells(grid, range, most / PHOTONS_A_CELL + 1);
        if (count_cells(grid, items, count, cells) > CROWDED) { /* most cells are empty: a surface in space */
            choose_cells(grid, range, most);
            (void)count_cells(grid, items, count, cells);
        }
        sort_items(grid, cells, items, copy, count);
        shrink(grid);
        *index = grid;
    } else {
        destroy(grid);
    }
    free(cells);
    free(copy);
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
