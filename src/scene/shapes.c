/* Rays and shapes: where they meet, and the place on the shape to rounding. */
#include "shapes.h"

#include "../base/vec3.h"
#include "wave.h"

/* ---- Round shapes ------------------------------------------------------------------------------ */

/* A line through a circle or sphere: the distances along it, ascending; how many. An end that lies on the shape is one
 * root, and the other follows since they add up to twice the way to the point nearest to the centre: nothing is then
 * left to rounding but whether that other root is the end itself. Else the discriminant comes from the distance of the
 * line from the centre and the smaller root by division, free of cancellation: Haines, Guenther & Akenine-Moeller 2019,
 * "Precision improvements for ray/sphere intersection". length: of the ray, in the units of the roots. */
static int round_roots(const pm__shape *shape, const pm__ray *ray, const double to_centre[3],
                       const double direction[3], double length, double roots[2])
{
    const double along = pm__dot(to_centre, direction);
    if (ray->leaves && ray->arrives)
        return 0;
    if (ray->leaves || ray->arrives) {
        const double apart = ray->leaves ? 2.0 * along : 2.0 * (length - along);
        roots[0] = ray->leaves ? apart : length - apart;
        return apart > shape->slack;
    }
    double off[3];
    for (int axis = 0; axis < 3; axis++)
        off[axis] = to_centre[axis] - along * direction[axis];
    const double square = pm__dot(off, off);
    if (square > 1.001 * shape->radius * shape->radius) /* beyond doubt, and the most frequent answer */
        return 0;
    const double miss = sqrt(square);
    const double discriminant = (shape->radius - miss) * (shape->radius + miss);
    if (!(discriminant >= 0.0))
        return 0;
    const double far = along + copysign(sqrt(discriminant), along);
    const double from_centre = sqrt(pm__dot(to_centre, to_centre));
    const double product = (from_centre - shape->radius) * (from_centre + shape->radius);
    const double other = far != 0.0 ? product / far : 0.0;
    roots[0] = far < other ? far : other;
    roots[1] = far < other ? other : far;
    return 2;
}

static bool meet_sphere(const pm__shape *shape, const pm__ray *ray, double *distance)
{
    double to_centre[3], roots[2];
    for (int axis = 0; axis < 3; axis++)
        to_centre[axis] = shape->centre[axis] - ray->origin[axis];
    const int count = round_roots(shape, ray, to_centre, ray->direction, ray->reach, roots);
    for (int i = 0; i < count; i++)
        if (roots[i] > 0.0) {
            *distance = roots[i];
            return roots[i] <= ray->reach;
        }
    return false;
}

static bool meet_cylinder(const pm__shape *shape, const pm__ray *ray, double *distance)
{
    double plan[3] = {ray->direction[0], ray->direction[1], 0.0}, roots[2];
    const double to_axis[3] = {shape->centre[0] - ray->origin[0], shape->centre[1] - ray->origin[1], 0.0};
    const double speed = pm__normalize_near(plan); /* of the ray as seen from above */
    if (!(speed > 0.0))
        return false;
    const int count = round_roots(shape, ray, to_axis, plan, ray->reach * speed, roots);
    for (int i = 0; i < count; i++) {
        const double t = roots[i] / speed;
        const double x = roots[i] * plan[0] - to_axis[0], z = ray->origin[2] + t * ray->direction[2];
        if (t > 0.0 && t <= ray->reach && z >= shape->low - shape->slack && z <= shape->high + shape->slack &&
            x >= shape->from * shape->radius - shape->slack) {
            *distance = t;
            return true;
        }
    }
    return false;
}

/* ---- Flat shapes ------------------------------------------------------------------------------- */

static bool flat_covers(const pm__shape *shape, const double offset[3])
{
    if (shape->kind == PM__SHAPE_DISC)
        return pm__dot(offset, offset) <= (shape->radius + shape->slack) * (shape->radius + shape->slack);
    for (int i = 0; i < 2; i++) {
        const double along = pm__dot(shape->dual[i], offset), margin = shape->margin[i];
        if (!(along >= -margin && along <= 1.0 + margin))
            return false;
    }
    return true;
}

/* A line meets a plane once: a way that starts or ends on it never does in between. */
static bool meet_flat(const pm__shape *shape, const pm__ray *ray, double *distance)
{
    if (ray->leaves || ray->arrives)
        return false;
    double offset[3];
    for (int axis = 0; axis < 3; axis++)
        offset[axis] = ray->origin[axis] - shape->centre[axis];
    const double t = -pm__dot(shape->normal, offset) / pm__dot(shape->normal, ray->direction);
    if (!(t > 0.0 && t <= ray->reach))
        return false;
    for (int axis = 0; axis < 3; axis++)
        offset[axis] += t * ray->direction[axis];
    *distance = t;
    return flat_covers(shape, offset);
}

/* ---- The wave ---------------------------------------------------------------------------------- */

static bool march(const pm__shape *shape, const double o[3], const double d[3], double reach, bool leaves,
                  double *distance)
{
    pm__above over;
    pm__march m = pm__wave_begin(shape, o, d, reach, leaves, &over);
    while (m.goes_on)
        pm__wave_step(&over, shape->amplitude, &m);
    *distance = m.t;
    return m.is_root;
}

/* From both ends to the middle: at an end that lies on the wave a march starts, and passes it over. Each goes a little
 * farther: rounding could put a crossing in the very middle beyond both. */
static bool is_between(const pm__shape *shape, const pm__ray *ray, double *distance)
{
    const double half = 0.501 * ray->reach;
    double end[3], back[3];
    for (int axis = 0; axis < 3; axis++) {
        end[axis] = ray->origin[axis] + ray->reach * ray->direction[axis];
        back[axis] = -ray->direction[axis];
    }
    if (march(shape, ray->origin, ray->direction, half, ray->leaves, distance))
        return true;
    const bool met = march(shape, end, back, half, true, distance);
    *distance = ray->reach - *distance;
    return met;
}

static bool meet_wave(const pm__shape *shape, const pm__ray *ray, double *distance)
{
    if (ray->arrives)
        return is_between(shape, ray, distance);
    return march(shape, ray->origin, ray->direction, ray->reach, ray->leaves, distance);
}

/* ---- All --------------------------------------------------------------------------------------- */

bool pm__shape_meet(const pm__shape *shape, const pm__ray *ray, double *distance)
{
    switch (shape->kind) {
    case PM__SHAPE_SPHERE:
        return meet_sphere(shape, ray, distance);
    case PM__SHAPE_CYLINDER:
        return meet_cylinder(shape, ray, distance);
    case PM__SHAPE_RECTANGLE:
    case PM__SHAPE_DISC:
        return meet_flat(shape, ray, distance);
    case PM__SHAPE_WAVE:
        return meet_wave(shape, ray, distance);
    }
    return false;
}

static void settle_round(const pm__shape *shape, double position[3], double normal[3])
{
    const int axes = shape->kind == PM__SHAPE_SPHERE ? 3 : 2;
    for (int axis = 0; axis < 3; axis++)
        normal[axis] = axis < axes ? position[axis] - shape->centre[axis] : 0.0;
    (void)pm__normalize_near(normal);
    for (int axis = 0; axis < axes; axis++)
        position[axis] = shape->centre[axis] + shape->radius * normal[axis];
    for (int axis = 0; axis < axes && shape->inward; axis++)
        normal[axis] = -normal[axis];
}

void pm__shape_settle(const pm__shape *shape, double position[3], double normal[3])
{
    if (shape->kind == PM__SHAPE_SPHERE || shape->kind == PM__SHAPE_CYLINDER) {
        settle_round(shape, position, normal);
    } else if (shape->kind == PM__SHAPE_WAVE) {
        pm__wave_settle(shape, position, normal);
    } else {
        double off = 0.0;
        for (int axis = 0; axis < 3; axis++)
            off += (position[axis] - shape->centre[axis]) * shape->normal[axis];
        for (int axis = 0; axis < 3; axis++) {
            position[axis] -= off * shape->normal[axis];
            normal[axis] = shape->normal[axis];
        }
    }
}
