/* Uniform in the unit cube, directions uniform over the sphere. */
#include "../workloads.h"

#include <math.h>

static void draw(const double *u, pm__workload_point *point)
{
    const double z = 2.0 * u[3] - 1.0, s = sqrt(fmax(0.0, 1.0 - z * z)), phi = 6.283185307179586 * u[4];
    *point = (pm__workload_point){.position = {u[0], u[1], u[2]},
                                  .direction = {s * cos(phi), s * sin(phi), z},
                                  .normal = {0.0, 0.0, 1.0}};
}

const pm__workload pm__workload_volume = {
    .entry = {.name = "volume", .summary = "uniform in a cube of 1 m, from all directions", .citation = ""},
    .draw = draw,
};
