/* Parts and where they are placed; the objects of a scene. */
#include "rays.h"

#include "../base/memory.h"
#include "../base/vec3.h"

#include <stdlib.h>
#include <string.h>

/* ---- Placements -------------------------------------------------------------------------------- */

void pm__placed_direction(const pm__placement *placement, const double direction[3], double placed[3])
{
    for (int i = 0; i < 3; i++)
        placed[i] = pm__dot(placement->rotation[i], direction);
}

void pm__placed_point(const pm__placement *placement, const double point[3], double placed[3])
{
    pm__placed_direction(placement, point, placed);
    for (int i = 0; i < 3; i++)
        placed[i] = placement->scale * placed[i] + placement->offset[i];
}

void pm__part_direction(const pm__placement *placement, const double placed[3], double direction[3])
{
    for (int i = 0; i < 3; i++)
        direction[i] = placement->rotation[0][i] * placed[0] + placement->rotation[1][i] * placed[1] +
                       placement->rotation[2][i] * placed[2];
}

void pm__part_point(const pm__placement *placement, const double placed[3], double point[3])
{
    double from[3];
    for (int i = 0; i < 3; i++)
        from[i] = placed[i] - placement->offset[i];
    pm__part_direction(placement, from, point);
    for (int i = 0; i < 3; i++)
        point[i] /= placement->scale;
}

/* The box about a box as it is placed. */
static void placed_box(const pm__placement *placement, const double low[3], const double high[3], double placed_low[3],
                       double placed_high[3])
{
    pm__box_empty(placed_low, placed_high);
    for (int corner = 0; corner < 8; corner++) {
        double point[3], placed[3];
        for (int axis = 0; axis < 3; axis++)
            point[axis] = corner >> axis & 1 ? high[axis] : low[axis];
        pm__placed_point(placement, point, placed);
        pm__box_enclose(placed_low, placed_high, placed);
    }
}

/* ---- Checks ------------------------------------------------------------------------------------ */

/* Rows that are orthonormal to 1e-6 are made so to rounding: a ray must come back where it was. */
static pm_status settle_rotation(double rotation[3][3], pm_error *error)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
            if (!(fabs(pm__dot(rotation[i], rotation[j]) - (i == j)) <= 1e-6))
                return pm__fail(error, PM_EINVAL, "a placement: rows %d and %d of its rotation are not orthonormal", j,
                                i);
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < i; j++) {
                const double along = pm__dot(rotation[i], rotation[j]);
                for (int axis = 0; axis < 3; axis++)
                    rotation[i][axis] -= along * rotation[j][axis];
            }
            (void)pm__normalize(rotation[i]);
        }
    return PM_OK;
}

static pm_status check_placement(const pm__placement *placement, pm_error *error)
{
    if (!(placement->scale > 0.0 && placement->scale <= PM__LARGEST_LENGTH))
        return pm__fail(error, PM_EINVAL, "a placement's scale is not above 0 and finite (%g)", placement->scale);
    for (int axis = 0; axis < 3; axis++)
        if (!(fabs(placement->offset[axis]) <= PM__LARGEST_LENGTH))
            return pm__fail(error, PM_EINVAL, "a placement's offset[%d] is %g: not finite or beyond %g m", axis,
                            placement->offset[axis], PM__LARGEST_LENGTH);
    return PM_OK;
}

static pm_status check_box(const double low[3], const double high[3], pm_error *error)
{
    for (int axis = 0; axis < 3; axis++)
        if (!(low[axis] >= -PM__LARGEST_LENGTH && high[axis] <= PM__LARGEST_LENGTH))
            return pm__fail(error, PM_EINVAL, "a placement: the part then reaches from %g to %g, beyond %g m",
                            low[axis], high[axis], PM__LARGEST_LENGTH);
    return PM_OK;
}

/* ---- Parts ------------------------------------------------------------------------------------- */

pm_status pm__scene_part(pm__scene *scene, pm__scene **part, pm_error *error)
{
    *part = NULL;
    if (scene->whole)
        return pm__fail(error, PM_EINVAL, "a part has no parts");
    if (scene->committed)
        return pm__fail(error, PM_EINVAL, "the scene is committed: nothing can be added");
    if (pm__grow((void **)&scene->parts, &scene->part_capacity, scene->part_count + 1, sizeof *part))
        return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
    const pm_status status = pm__scene_on(scene->device, part, error);
    if (status != PM_OK)
        return status;
    (*part)->whole = scene;
    scene->parts[scene->part_count++] = *part;
    return PM_OK;
}

static pm_status attach_part(pm__scene *scene, pm__scene *part, const pm__geometry *ready, pm_error *error)
{
    pm__geometry *made = NULL;
    const pm_status status = pm__geometry_create(scene, part->shape_count, &made, error);
    if (status != PM_OK)
        return status;
    const RTCGeometry embree = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
    if (!embree) {
        free(made);
        return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
    }
    made->part = part;
    made->placement = ready->placement;
    memcpy(made->low, ready->low, sizeof made->low);
    memcpy(made->high, ready->high, sizeof made->high);
    pm__rays_shape(embree);
    pm__geometry_attach(scene, made, embree);
    part->smallest = part->smallest > 0.0 ? fmin(part->smallest, ready->placement.scale) : ready->placement.scale;
    return PM_OK;
}

pm_status pm__scene_place(pm__scene *scene, pm__scene *part, const pm__placement *placement, pm_error *error)
{
    pm__geometry ready = {.placement = *placement};
    if (part->whole != scene)
        return pm__fail(error, PM_EINVAL, "a placement: the part is not of this scene");
    if (part->geometry_count == 0)
        return pm__fail(error, PM_EINVAL, "a placement: the part has no shape");
    pm_status status = check_placement(placement, error);
    if (status == PM_OK)
        status = settle_rotation(ready.placement.rotation, error);
    if (status != PM_OK)
        return status;
    placed_box(&ready.placement, part->low, part->high, ready.low, ready.high);
    status = check_box(ready.low, ready.high, error);
    return status == PM_OK ? attach_part(scene, part, &ready, error) : status;
}

/* ---- Objects ----------------------------------------------------------------------------------- */

static size_t count_objects(const pm__scene *scene)
{
    size_t count = 0;
    for (size_t i = 0; i < scene->geometry_count; i++)
        count += scene->geometries[i]->part ? scene->geometries[i]->part->geometry_count : 1;
    return count;
}

static void list_part(const pm__geometry *placed, pm__object *objects)
{
    for (size_t i = 0; i < placed->part->geometry_count; i++) {
        const pm__geometry *const geometry = placed->part->geometries[i];
        placed_box(&placed->placement, geometry->low, geometry->high, objects[i].low, objects[i].high);
        objects[i].material = &placed->part->materials[geometry->material];
    }
}

pm_status pm__scene_list_objects(pm__scene *scene, pm_error *error)
{
    free(scene->objects);
    scene->object_count = count_objects(scene);
    scene->objects = calloc(scene->object_count, sizeof *scene->objects);
    if (!scene->objects)
        return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
    pm__object *next = scene->objects;
    for (size_t i = 0; i < scene->geometry_count; i++) {
        const pm__geometry *const geometry = scene->geometries[i];
        if (geometry->part) {
            list_part(geometry, next);
            next += geometry->part->geometry_count;
            continue;
        }
        memcpy(next->low, geometry->low, sizeof next->low);
        memcpy(next->high, geometry->high, sizeof next->high);
        next->material = &scene->materials[geometry->material];
        next++;
    }
    return PM_OK;
}

size_t pm__scene_object_count(const pm__scene *scene)
{
    return scene->object_count;
}

pm__object pm__scene_object(const pm__scene *scene, size_t index)
{
    return scene->objects[index];
}
