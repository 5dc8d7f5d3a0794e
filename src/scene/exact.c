/* Exact shapes as they are added to a scene. */
#include "rays.h"

#include <stdlib.h>
#include <string.h>

static pm_status add_shape(pm__scene *scene, uint32_t material, const pm__shape *shape, pm_error *error)
{
    pm__shape prepared = *shape;
    pm_status status = pm__shape_prepare(&prepared, scene->shape_count, error);
    pm__geometry *made = NULL;
    if (status == PM_OK)
        status = pm__geometry_of(scene, material, 1, &made, error);
    if (status != PM_OK)
        return status;
    const RTCGeometry embree = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
    if (!embree) {
        free(made);
        return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
    }
    made->shape = prepared;
    pm__rays_shape(embree);
    pm__shape_bounds(&prepared, made->low, made->high);
    pm__geometry_attach(scene, made, embree);
    return PM_OK;
}

static void copy(double to[3], const double from[3])
{
    memcpy(to, from, 3 * sizeof *to);
}

pm_status pm__scene_sphere(pm__scene *scene, uint32_t material, const double centre[3], double radius, bool inward,
                           pm_error *error)
{
    pm__shape shape = {.kind = PM__SHAPE_SPHERE, .radius = radius, .inward = inward};
    copy(shape.centre, centre);
    return add_shape(scene, material, &shape, error);
}

pm_status pm__scene_cylinder(pm__scene *scene, uint32_t material, const double centre[2], double radius, double low,
                             double high, double from, bool inward, pm_error *error)
{
    const pm__shape shape = {.kind = PM__SHAPE_CYLINDER,
                             .inward = inward,
                             .centre = {centre[0], centre[1], 0.0},
                             .radius = radius,
                             .low = low,
                             .high = high,
                             .from = from};
    return add_shape(scene, material, &shape, error);
}

pm_status pm__scene_rectangle(pm__scene *scene, uint32_t material, const double corner[3], const double u[3],
                              const double v[3], pm_error *error)
{
    pm__shape shape = {.kind = PM__SHAPE_RECTANGLE};
    copy(shape.centre, corner);
    copy(shape.edge[0], u);
    copy(shape.edge[1], v);
    return add_shape(scene, material, &shape, error);
}

pm_status pm__scene_disc(pm__scene *scene, uint32_t material, const double centre[3], const double normal[3],
                         double radius, pm_error *error)
{
    pm__shape shape = {.kind = PM__SHAPE_DISC, .radius = radius};
    copy(shape.centre, centre);
    copy(shape.normal, normal);
    return add_shape(scene, material, &shape, error);
}

pm_status pm__scene_wave(pm__scene *scene, uint32_t material, double height, double amplitude, double wavenumber,
                         const double extent[2], pm_error *error)
{
    const pm__shape shape = {.kind = PM__SHAPE_WAVE,
                             .centre = {0.0, 0.0, height},
                             .amplitude = amplitude,
                             .wavenumber = wavenumber,
                             .extent = {extent[0], extent[1]}};
    return add_shape(scene, material, &shape, error);
}
