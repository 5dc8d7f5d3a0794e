/* Rays and shapes: where they meet, and the place on the shape to rounding. */
#include "shapes.h"

#include "../base/geometry.h"
#include "../base/vec3.h"

#define PI 3.14159265358979323846

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

/* The height of the ray over the wave, f(t) = f(0) + t dz + a (cos kx(0) - cos kx(t)), with the difference as a
 * product: exact near the origin, where f(0) is 0 for a ray that leaves the wave. */
typedef struct profile {
    double start;            /* f(0) */
    double climb;            /* dz */
    double amplitude;
    double phase, frequency; /* k x(0), k dx >= 0: mirrored in x where the ray runs towards smaller x */
    double sign;             /* turns a falling piece into a rising one for the root finder */
} profile;

static double profile_height(const profile *p, double t)
{
    const double half = 0.5 * p->frequency * t;
    return p->start + t * p->climb + 2.0 * p->amplitude * sin(p->phase + half) * sin(half);
}

static double profile_rising(const void *context, double t, double *slope)
{
    const profile *const p = context;
    *slope = p->sign * (p->climb + p->amplitude * p->frequency * sin(p->phase + p->frequency * t));
    return p->sign * profile_height(p, t);
}

static profile profile_of(const pm__shape *shape, const pm__ray *ray)
{
    const double rate = shape->wavenumber * ray->direction[0], x = shape->wavenumber * ray->origin[0];
    return (profile){.start = ray->leaves ? 0.0 : ray->origin[2] - shape->centre[2] - shape->amplitude * cos(x),
                     .climb = ray->direction[2],
                     .amplitude = shape->amplitude,
                     .phase = copysign(1.0, rate) * x,
                     .frequency = fabs(rate)};
}

/* Turning point `index` of the height, ascending in t: sin(phase) = -climb / (amplitude frequency). */
static double turning_point(const profile *p, double index)
{
    const double arc = asin(-p->climb / (p->amplitude * p->frequency));
    const double phase = index * PI + (fmod(index, 2.0) == 0.0 ? arc : -arc);
    return (phase - p->phase) / p->frequency;
}

/* Cuts [*low, *high] to where |origin + t direction| <= half. */
static void clip(double origin, double direction, double half, double *low, double *high)
{
    if (direction == 0.0) {
        if (fabs(origin) > half)
            *high = -1.0;
        return;
    }
    const double a = (-half - origin) / direction, b = (half - origin) / direction;
    const double near = a < b ? a : b, far = a < b ? b : a;
    *low = near > *low ? near : *low;
    *high = far < *high ? far : *high;
}

static double root_between(profile *p, double low, double high, double at_low, double at_high)
{
    p->sign = at_high > at_low ? 1.0 : -1.0;
    const double guess = low + (high - low) * at_low / (at_low - at_high);
    return pm__increasing_root(profile_rising, p, low, high, guess);
}

/* The first root of the height on [low, high]. Between turning points the height is monotone and has one root or none,
 * so none is missed. Within the slab between troughs and crests a ray crosses the wave or leaves the slab after a few
 * such pieces. The piece of a root at an end on the wave has no other: it is passed over. */
static bool first_root(profile *p, const pm__ray *ray, double slack, double low, double high, double *root)
{
    const bool turns = fabs(p->climb) < fabs(p->amplitude) * p->frequency;
    double index = turns ? floor((p->phase + p->frequency * low) / PI - 0.5) : 0.0;
    while (turns && turning_point(p, index) <= low)
        index += 1.0;
    bool passed = !ray->leaves;
    double start = low, at_start = passed ? profile_height(p, low) : 0.0;
    while (start < high) {
        const double end = turns ? fmin(turning_point(p, index), high) : high;
        if (end >= high && (ray->arrives || !passed))
            return false;
        const double at_end = profile_height(p, end);
        if (passed && (at_start < 0.0) != (at_end < 0.0)) {
            *root = root_between(p, start, end, at_start, at_end);
            if (*root > (ray->leaves ? slack : 0.0))
                return true;
        }
        passed = true;
        start = end;
        at_start = at_end;
        index += 1.0;
    }
    return false;
}

static bool meet_wave(const pm__shape *shape, const pm__ray *ray, double *distance)
{
    const double *const o = ray->origin, *const d = ray->direction, slack = shape->slack;
    double low = 0.0, high = ray->reach;
    clip(o[0], d[0], shape->extent[0] + slack, &low, &high);
    clip(o[1], d[1], shape->extent[1] + slack, &low, &high);
    /* The slab a little higher than the wave: the height has its right sign where the ray enters. */
    clip(o[2] - shape->centre[2], d[2], fabs(shape->amplitude) * (1.0 + 1e-9) + 64.0 * slack, &low, &high);
    if (ray->leaves)
        low = 0.0;
    if (ray->arrives)
        high = ray->reach;
    if (!(low < high))
        return false;
    profile p = profile_of(shape, ray);
    return first_root(&p, ray, slack, low, high, distance);
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
        const double phase = shape->wavenumber * position[0];
        position[2] = shape->centre[2] + shape->amplitude * cos(phase);
        normal[0] = shape->amplitude * shape->wavenumber * sin(phase);
        normal[1] = 0.0;
        normal[2] = 1.0;
        (void)pm__normalize(normal);
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
