/* Many equal positions and many equal distances: what searches and builds stumble over. Half the photons lie on 1000
 * different points, half on a grid whose spacing is exact in binary. */
#include "../workloads.h"

#include <math.h>

enum { POINTS = 1000, GRID = 256 };

static void draw(const double *u, pm__workload_point *point)
{
    const double below[3] = {0.0, 0.0, -1.0};
    *point = (pm__workload_point){.position = {floor(GRID * u[1]) / GRID, floor(GRID * u[2]) / GRID, 0.0},
                                  .normal = {0.0, 0.0, 1.0}};
    pm__cosine_direction(below, u + 3, point->direction);
    if (u[0] >= 0.5)
        return;
    /* The points are the same for every seed: Weyl's sequence with the plastic number (Roberts' R2). */
    const double i = floor(POINTS * u[1]);
    point->position[0] = fmod(0.7548776662466927 * (i + 1.0), 1.0);
    point->position[1] = fmod(0.5698402909980532 * (i + 1.0), 1.0);
}

const pm__workload pm__workload_duplicates = {
    .entry = {.name = "duplicates",
              .summary = "half on 1000 positions, half on a grid: repeats and ties",
              .citation = ""},
    .query_jitter = 1.0 / GRID,
    .draw = draw,
};
