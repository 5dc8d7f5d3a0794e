/* Shapes before rays come: whether they can be, what is derived from them, the boxes about them. */
#include "shapes.h"

#include "../base/vec3.h"

#include <float.h>
#include <string.h>

/* Of the largest coordinate: positions that went through a few operations agree with the shape to this. */
static const double SLACK = 16.0 * DBL_EPSILON;

/* ---- Checks ------------------------------------------------------------------------------------ */

static const char *shape_name(pm__shape_kind kind)
{
    static const char *const names[] = {"sphere", "cylinder", "rectangle", "disc", "wave"};
    return names[kind];
}

/* Also refuses NaN. */
static bool fits(double value)
{
    return fabs(value) <= PM__LARGEST_LENGTH;
}

static bool fits3(const double v[3])
{
    return fits(v[0]) && fits(v[1]) && fits(v[2]);
}

static pm_status refuse(const pm__shape *shape, uint32_t number, pm_error *error, const char *what, double value)
{
    return pm__fail(error, PM_EINVAL, "shape %u (%s): %s (%g)", number, shape_name(shape->kind), what, value);
}

static pm_status check_position(const pm__shape *shape, uint32_t number, pm_error *error)
{
    const double *const c = shape->centre;
    if (fits3(c))
        return PM_OK;
    return pm__fail(error, PM_EINVAL, "shape %u (%s): its position (%g, %g, %g) is not finite or beyond %g m", number,
                    shape_name(shape->kind), c[0], c[1], c[2], PM__LARGEST_LENGTH);
}

static pm_status check_radius(const pm__shape *shape, uint32_t number, pm_error *error)
{
    if (shape->radius > 0.0 && fits(shape->radius))
        return PM_OK;
    return refuse(shape, number, error, "its radius is not above 0 and finite", shape->radius);
}

static pm_status prepare_cylinder(const pm__shape *shape, uint32_t number, pm_error *error)
{
    if (!fits(shape->low) || !fits(shape->high) || !(shape->low < shape->high))
        return pm__fail(error, PM_EINVAL, "shape %u (cylinder): no finite height from %g to %g", number, shape->low,
                        shape->high);
    if (!(shape->from >= -1.0 && shape->from < 1.0))
        return refuse(shape, number, error, "`from` is not at least -1 and below 1", shape->from);
    return PM_OK;
}

static pm_status prepare_rectangle(pm__shape *shape, uint32_t number, pm_error *error)
{
    const double *const u = shape->edge[0], *const v = shape->edge[1];
    if (!fits3(u) || !fits3(v))
        return pm__fail(error, PM_EINVAL, "shape %u (rectangle): an edge is not finite: (%g, %g, %g), (%g, %g, %g)",
                        number, u[0], u[1], u[2], v[0], v[1], v[2]);
    double unit[2][3], length[2];
    memcpy(unit, shape->edge, sizeof unit);
    for (int i = 0; i < 2; i++)
        length[i] = pm__normalize(unit[i]);
    pm__cross(unit[0], unit[1], shape->normal);
    const double sine = pm__normalize(shape->normal);
    if (!(sine > 1e-12))
        return pm__fail(error, PM_EINVAL, "shape %u (rectangle): the edges (%g, %g, %g), (%g, %g, %g) span no area",
                        number, u[0], u[1], u[2], v[0], v[1], v[2]);
    pm__cross(unit[1], shape->normal, shape->dual[0]);
    pm__cross(shape->normal, unit[0], shape->dual[1]);
    for (int i = 0; i < 2; i++)
        for (int axis = 0; axis < 3; axis++)
            shape->dual[i][axis] /= sine * length[i];
    return PM_OK;
}

static pm_status prepare_disc(pm__shape *shape, uint32_t number, pm_error *error)
{
    double *const n = shape->normal;
    const double length = fits3(n) ? sqrt(pm__dot(n, n)) : 0.0;
    if (!(fabs(length - 1.0) <= 1e-6))
        return pm__fail(error, PM_EINVAL, "shape %u (disc): its normal (%g, %g, %g) is not of length 1", number, n[0],
                        n[1], n[2]);
    (void)pm__normalize(n);
    return PM_OK;
}

static pm_status prepare_wave(const pm__shape *shape, uint32_t number, pm_error *error)
{
    if (!fits(shape->amplitude))
        return refuse(shape, number, error, "its amplitude is not finite", shape->amplitude);
    if (!(shape->wavenumber >= 0.0 && isfinite(shape->wavenumber)))
        return refuse(shape, number, error, "its wavenumber is not 0 or more and finite", shape->wavenumber);
    const double steepness = fabs(shape->amplitude) * shape->wavenumber;
    if (!(steepness < 1.0))
        return refuse(shape, number, error, "amplitude times wavenumber is not below 1", steepness);
    for (int i = 0; i < 2; i++)
        if (!(shape->extent[i] > 0.0 && fits(shape->extent[i])))
            return refuse(shape, number, error, "its extent is not above 0 and finite", shape->extent[i]);
    /* A ray along it may pass each crest by itself. */
    const double phase = shape->wavenumber * shape->extent[0];
    if (!(phase <= 1e6))
        return refuse(shape, number, error, "wavenumber times extent is above a million", phase);
    return PM_OK;
}

static pm_status check_kind(pm__shape *shape, uint32_t number, pm_error *error)
{
    switch (shape->kind) {
    case PM__SHAPE_SPHERE:
        return PM_OK;
    case PM__SHAPE_CYLINDER:
        return prepare_cylinder(shape, number, error);
    case PM__SHAPE_RECTANGLE:
        return prepare_rectangle(shape, number, error);
    case PM__SHAPE_DISC:
        return prepare_disc(shape, number, error);
    case PM__SHAPE_WAVE:
        return prepare_wave(shape, number, error);
    }
    return PM_EINVAL;
}

pm_status pm__shape_prepare(pm__shape *shape, uint32_t number, pm_error *error)
{
    pm_status status = check_position(shape, number, error);
    const bool is_round = shape->kind != PM__SHAPE_RECTANGLE && shape->kind != PM__SHAPE_WAVE;
    if (status == PM_OK && is_round)
        status = check_radius(shape, number, error);
    if (status == PM_OK)
        status = check_kind(shape, number, error);
    if (status != PM_OK)
        return status;
    shape->slack = 0.0;
    double low[3], high[3], largest = 0.0;
    pm__shape_bounds(shape, low, high);
    for (int axis = 0; axis < 3; axis++)
        largest = fmax(largest, fmax(fabs(low[axis]), fabs(high[axis])));
    shape->slack = SLACK * largest;
    for (int i = 0; i < 2; i++)
        shape->margin[i] = shape->slack * sqrt(pm__dot(shape->dual[i], shape->dual[i]));
    return PM_OK;
}

/* ---- Bounds ------------------------------------------------------------------------------------ */

static void extend(const pm__shape *shape, int axis, double *low, double *high)
{
    const double radius = shape->radius;
    switch (shape->kind) {
    case PM__SHAPE_SPHERE:
        *low -= radius;
        *high += radius;
        break;
    case PM__SHAPE_CYLINDER:
        *low = axis == 2 ? shape->low : *low + radius * (axis == 0 ? shape->from : -1.0);
        *high = axis == 2 ? shape->high : *high + radius;
        break;
    case PM__SHAPE_RECTANGLE:
        for (int i = 0; i < 2; i++) {
            *low += fmin(shape->edge[i][axis], 0.0);
            *high += fmax(shape->edge[i][axis], 0.0);
        }
        break;
    case PM__SHAPE_DISC: {
        const double half = radius * sqrt(fmax(0.0, 1.0 - shape->normal[axis] * shape->normal[axis]));
        *low -= half;
        *high += half;
        break;
    }
    case PM__SHAPE_WAVE: {
        const double half = axis == 2 ? fabs(shape->amplitude) : shape->extent[axis];
        *low -= half;
        *high += half;
        break;
    }
    }
}

void pm__shape_bounds(const pm__shape *shape, double low[3], double high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = high[axis] = shape->centre[axis];
        extend(shape, axis, &low[axis], &high[axis]);
        low[axis] -= shape->slack;
        high[axis] += shape->slack;
    }
}
