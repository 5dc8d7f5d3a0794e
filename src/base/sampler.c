#include "sampler.h"

#include "sobol.h"

#include <math.h>

/* ---- poisson: independent points ---- */

static void poisson_point(const pm__points *points, uint64_t index, double *u)
{
    pm__random_uniform(points->seed, points->purpose, points->trial, index, u, points->dimensions);
}

static const pm__sampler poisson = {
    .entry = {.name = "poisson",
              .summary = "N independent photons",
              .citation = "course 43, 2.1.1"},
    .independent = true,
    .point = poisson_point,
};

/* ---- stratified: one jittered point in each cell of a grid ---- */

/* How far a grid is from `count` cells, and its cells from square; compared in that order. */
typedef struct grid_error {
    double count, shape;
} grid_error;

static bool better(grid_error a, grid_error b)
{
    return a.count < b.count || (a.count <= b.count && a.shape < b.shape);
}

/* Keeps the grid if it is the best so far. ideal: what square cells would take along each dimension. */
static void try_grid(pm__points *points, uint64_t count, const double ideal[3], const uint32_t cells[3],
                     grid_error *best)
{
    grid_error error = {fabs((double)cells[0] * cells[1] * cells[2] - (double)count), 0.0};
    for (int i = 0; i < points->strata_dimensions; i++)
        error.shape += fabs(log(cells[i] / ideal[i]));
    if (!better(error, *best))
        return;
    *best = error;
    for (int i = 0; i < 3; i++)
        points->cells[i] = cells[i];
    points->count = (uint64_t)cells[0] * cells[1] * cells[2];
}

static uint32_t at_least_one(double x)
{
    return x < 1.0 ? 1u : (uint32_t)x;
}

/* Cells count as near-square within 2 % of the ideal along the free dimensions, or one whole cell. The last
 * dimension follows from the others and the count. */
static void stratified_plan(pm__points *points, const double aspect[2])
{
    const uint64_t count = points->count;
    const int dimensions = points->strata_dimensions;
    if (count == 0)
        return;
    const double n = (double)count;
    double ideal[3] = {n, 1.0, 1.0};
    if (dimensions == 2) {
        ideal[0] = sqrt(n * aspect[0]);
        ideal[1] = ideal[0] / aspect[0];
    } else if (dimensions == 3) {
        ideal[0] = cbrt(n * aspect[0] * aspect[1]);
        ideal[1] = ideal[0] / aspect[0];
        ideal[2] = ideal[0] / aspect[1];
    }
    uint32_t from[3] = {1, 1, 1}, to[3] = {1, 1, 1};
    for (int i = 0; i < dimensions - 1; i++) {
        from[i] = at_least_one(floor(ideal[i] * 0.98));
        to[i] = at_least_one(ceil(ideal[i] * 1.02));
    }
    grid_error best = {INFINITY, INFINITY};
    for (uint32_t x = from[0]; x <= to[0]; x++)
        for (uint32_t y = from[1]; y <= to[1]; y++) {
            uint32_t cells[3] = {x, y, 1};
            cells[dimensions - 1] = 1;
            cells[dimensions - 1] = at_least_one(round(n / ((double)cells[0] * cells[1])));
            try_grid(points, count, ideal, cells, &best);
        }
}

static const double below_one = 0x1.fffffffffffffp-1;

static void stratified_point(const pm__points *points, uint64_t index, double *u)
{
    pm__random_uniform(points->seed, points->purpose, points->trial, index, u, points->dimensions);
    uint64_t rest = index;
    for (int i = 0; i < points->strata_dimensions; i++) {
        const uint64_t cell = rest % points->cells[i];
        rest /= points->cells[i];
        u[i] = fmin(((double)cell + u[i]) / points->cells[i], below_one);
    }
}

static const pm__sampler stratified = {
    .entry = {.name = "stratified",
              .summary = "one photon in each cell of a grid of near-square cells, warped to the irradiance",
              .citation = "course 43, 2.1.1 and 5.5"},
    .plan = stratified_plan,
    .point = stratified_point,
};

/* ---- sobol ---- */

/* The digits beyond 32 are independent uniform, which is what scrambling makes of them in points that differ above. */
static void sobol_point(const pm__points *points, uint64_t index, double *u)
{
    pm__random_uniform(points->seed, points->purpose, points->trial, index, u, points->dimensions);
    for (int i = 0; i < points->dimensions && i < PM__SOBOL_DIMENSIONS; i++) {
        uint32_t keys[4];
        pm__random_words(points->seed, PM__FOR_SCRAMBLING, points->trial, points->purpose, (uint32_t)i, keys);
        const uint32_t x = pm__owen_scramble(pm__sobol((uint32_t)index, i), keys);
        u[i] = fmin(((double)x + u[i]) * 0x1p-32, below_one);
    }
}

static const pm__sampler sobol = {
    .entry = {.name = "sobol",
              .summary = "Sobol' points, Owen-scrambled anew in each trial",
              .citation = "Owen 1995; Joe and Kuo 2008"},
    .point = sobol_point,
};

static const pm__entry *const entries[] = {&poisson.entry, &stratified.entry, &sobol.entry};

const pm__catalogue pm__samplers = {"sampler", entries, sizeof entries / sizeof *entries};

void pm__points_init(pm__points *points, const pm__sampler *sampler, uint64_t seed, pm__purpose purpose,
                     uint32_t trial, uint64_t count, int dimensions, int strata_dimensions, const double aspect[2])
{
    *points = (pm__points){.sampler = sampler,
                           .seed = seed,
                           .purpose = purpose,
                           .trial = trial,
                           .dimensions = dimensions,
                           .strata_dimensions = strata_dimensions,
                           .count = count,
                           .cells = {1, 1, 1}};
    if (sampler->plan)
        sampler->plan(points, aspect);
}
