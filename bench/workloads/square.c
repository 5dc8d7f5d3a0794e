/* Uniform on the unit square z = 0, lit from above. */
#include "../workloads.h"

static void draw(const double *u, pm__workload_point *point)
{
    const double below[3] = {0.0, 0.0, -1.0};
    *point = (pm__workload_point){.position = {u[0], u[1], 0.0}, .normal = {0.0, 0.0, 1.0}};
    pm__cosine_direction(below, u + 2, point->direction);
}

const pm__workload pm__workload_square = {
    .entry = {.name = "square", .summary = "uniform on a square of 1 m", .citation = ""},
    .draw = draw,
};
