/* 80 % along a nephroid, the caustic of parallel light in a round cup, blurred; 20 % uniform around it. */
#include "../workloads.h"

#include <math.h>

static const double blur = 0.01; /* m, standard deviation across the curve */

static void draw(const double *u, pm__workload_point *point)
{
    const double below[3] = {0.0, 0.0, -1.0}, tau = 6.283185307179586, a = 0.25;
    *point = (pm__workload_point){.position = {2.0 * u[1] - 1.0, 2.0 * u[2] - 1.0, 0.0}, .normal = {0.0, 0.0, 1.0}};
    pm__cosine_direction(below, u + 5, point->direction);
    if (u[0] >= 0.8)
        return;
    /* (3 cos t - cos 3t, 3 sin t - sin 3t) a; Box and Muller's pair of normal deviates. */
    const double t = tau * u[1], r = blur * sqrt(-2.0 * log(1.0 - u[3]));
    point->position[0] = a * (3.0 * cos(t) - cos(3.0 * t)) + r * cos(tau * u[4]);
    point->position[1] = a * (3.0 * sin(t) - sin(3.0 * t)) + r * sin(tau * u[4]);
}

const pm__workload pm__workload_caustic = {
    .entry = {.name = "caustic", .summary = "80 % along a blurred nephroid on a plane, 20 % uniform", .citation = ""},
    .draw = draw,
};
