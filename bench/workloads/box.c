/* A closed box of 2 m with two spheres on its floor: photons of a small ceiling light at its first hits (half of them),
 * or after one or two diffuse bounces. Every hit is solved for, so positions lie on the surfaces to rounding. */
#include "../workloads.h"
#include "../../src/base/vec3.h"

#include <string.h>

enum { SPHERES = 2, NOT_A_SPHERE = -1 };

static const struct sphere {
    double centre[3], radius;
} spheres[SPHERES] = {{{-0.42, 0.3, -0.65}, 0.35}, {{0.42, -0.28, -0.65}, 0.35}};

static const double light_half_width = 0.25;

/* A point of a surface; `sphere`: which one it is of. */
typedef struct hit {
    double position[3], normal[3], distance;
    int sphere;
} hit;

/* The walls are the planes +-1 of each axis; a ray from inside leaves through the nearest one that it faces. */
static void meet_walls(const double origin[3], const double direction[3], hit *best)
{
    int wall = 0;
    best->distance = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        if (direction[axis] == 0.0)
            continue;
        const double t = (copysign(1.0, direction[axis]) - origin[axis]) / direction[axis];
        if (t < best->distance) {
            best->distance = t;
            wall = axis;
        }
    }
    for (int i = 0; i < 3; i++) {
        best->position[i] = fmin(fmax(origin[i] + best->distance * direction[i], -1.0), 1.0);
        best->normal[i] = 0.0;
    }
    best->position[wall] = copysign(1.0, direction[wall]);
    best->normal[wall] = -best->position[wall];
    best->sphere = NOT_A_SPHERE;
}

static void meet_sphere(const double origin[3], const double direction[3], int index, hit *best)
{
    const struct sphere *const s = &spheres[index];
    const double away[3] = {origin[0] - s->centre[0], origin[1] - s->centre[1], origin[2] - s->centre[2]};
    const double b = pm__dot(away, direction), c = pm__dot(away, away) - s->radius * s->radius;
    const double discriminant = b * b - c;
    if (b >= 0.0 || discriminant <= 0.0)
        return;
    const double t = c / (-b + sqrt(discriminant)); /* the nearer root, free of cancellation */
    if (!(t > 0.0 && t < best->distance))
        return;
    best->distance = t;
    best->sphere = index;
    for (int i = 0; i < 3; i++)
        best->normal[i] = away[i] + t * direction[i];
    (void)pm__normalize(best->normal);
    for (int i = 0; i < 3; i++)
        best->position[i] = s->centre[i] + s->radius * best->normal[i];
}

/* from: the surface that the ray starts on, which it does not meet again (both kinds are convex from where it
 * starts). */
static hit trace(const hit *from, const double direction[3])
{
    hit best;
    meet_walls(from->position, direction, &best);
    for (int i = 0; i < SPHERES; i++)
        if (i != from->sphere)
            meet_sphere(from->position, direction, i, &best);
    return best;
}

static void draw(const double *u, pm__workload_point *point)
{
    const int bounces = u[0] < 0.5 ? 0 : u[0] < 0.8 ? 1 : 2;
    hit at = {.position = {light_half_width * (2.0 * u[1] - 1.0), light_half_width * (2.0 * u[2] - 1.0), 1.0},
              .normal = {0.0, 0.0, -1.0},
              .sphere = NOT_A_SPHERE};
    for (int i = 0; i <= bounces; i++) {
        pm__cosine_direction(at.normal, u + 3 + 2 * i, point->direction);
        at = trace(&at, point->direction);
    }
    memcpy(point->position, at.position, sizeof at.position);
    memcpy(point->normal, at.normal, sizeof at.normal);
}

const pm__workload pm__workload_box = {
    .entry = {.name = "box", .summary = "hits of a ceiling light's photons in a box with two spheres", .citation = ""},
    .draw = draw,
};
