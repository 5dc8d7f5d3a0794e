#include "../base/memory.h"
#include "rays.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Boxes ------------------------------------------------------------------------------------- */

void pm__box_enclose(double low[3], double high[3], const double point[3])
{
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = fmin(low[axis], point[axis]);
        high[axis] = fmax(high[axis], point[axis]);
    }
}

void pm__box_empty(double low[3], double high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
}

/* ---- Creation ---------------------------------------------------------------------------------- */

static void ignore_error(void *context, enum RTCError code, const char *text)
{
    (void)context;
    (void)code;
    (void)text;
}

/* What went wrong in Embree since it was last asked, if anything. */
static pm_status embree_status(const pm__scene *scene, pm_error *error)
{
    const enum RTCError code = rtcGetDeviceError(scene->device);
    if (code == RTC_ERROR_NONE)
        return PM_OK;
    if (code == RTC_ERROR_OUT_OF_MEMORY)
        return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
    return pm__fail(error, PM_EINVAL, "Embree refuses the scene (its error %d)", (int)code);
}

pm_status pm__scene_on(RTCDevice device, pm__scene **scene, pm_error *error)
{
    *scene = NULL;
    pm__scene *const made = calloc(1, sizeof *made);
    if (!made)
        return pm__fail(error, PM_ENOMEM, "out of memory for a scene");
    pm__box_empty(made->low, made->high);
    if (device) {
        rtcRetainDevice(device);
        made->device = device;
        made->rays = rtcNewScene(device);
    }
    if (!made->rays) {
        pm__scene_destroy(made);
        return pm__fail(error, PM_ENOMEM, "Embree cannot be started");
    }
    /* Robust: rays do not slip through between two triangles. */
    rtcSetSceneFlags(made->rays, RTC_SCENE_FLAG_ROBUST);
    *scene = made;
    return PM_OK;
}

pm_status pm__scene_create(pm__scene **scene, pm_error *error)
{
    const RTCDevice device = rtcNewDevice("threads=1,verbose=0"); /* one thread is the caller's: none is started */
    if (device)
        rtcSetDeviceErrorFunction(device, ignore_error, NULL);
    const pm_status status = pm__scene_on(device, scene, error);
    if (device)
        rtcReleaseDevice(device);
    return status;
}

static void destroy_geometry(pm__geometry *geometry)
{
    free(geometry->planes);
    free(geometry);
}

void pm__scene_destroy(pm__scene *scene)
{
    if (!scene)
        return;
    for (size_t i = 0; i < scene->part_count; i++)
        pm__scene_destroy(scene->parts[i]);
    free(scene->parts);
    if (scene->rays)
        rtcReleaseScene(scene->rays);
    if (scene->device)
        rtcReleaseDevice(scene->device);
    for (size_t i = 0; i < scene->geometry_count; i++)
        destroy_geometry(scene->geometries[i]);
    free(scene->geometries);
    free(scene->flats);
    free(scene->few);
    free(scene->objects);
    free(scene->materials);
    free(scene->lights);
    free(scene);
}

/* ---- Materials and lights ---------------------------------------------------------------------- */

static pm_status check_open(const pm__scene *scene, pm_error *error)
{
    if (scene->committed)
        return pm__fail(error, PM_EINVAL, "the scene is committed: nothing can be added");
    if (scene->smallest > 0.0)
        return pm__fail(error, PM_EINVAL, "the part has been placed: nothing can be added");
    return PM_OK;
}

static pm_status no_memory(pm_error *error)
{
    return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
}

pm_status pm__scene_material(pm__scene *scene, const pm__material *material, uint32_t *index, pm_error *error)
{
    if (check_open(scene, error) != PM_OK)
        return PM_EINVAL;
    const size_t count = scene->material_count;
    pm_error fault;
    if (pm__material_check(material, &fault) != PM_OK)
        return pm__fail(error, PM_EINVAL, "material %zu: %s", count, fault.text);
    if (pm__grow((void **)&scene->materials, &scene->material_capacity, count + 1, sizeof *material))
        return no_memory(error);
    scene->materials[count] = *material;
    scene->material_count = count + 1;
    *index = (uint32_t)count;
    return PM_OK;
}

pm_status pm__scene_light(pm__scene *scene, const pm__light *light, pm_error *error)
{
    if (check_open(scene, error) != PM_OK)
        return PM_EINVAL;
    if (scene->whole)
        return pm__fail(error, PM_EINVAL, "a part of a scene has no lights of its own");
    const pm_status status = pm__light_check(light, error);
    if (status != PM_OK)
        return status;
    const size_t count = scene->light_count;
    if (pm__grow((void **)&scene->lights, &scene->light_capacity, count + 1, sizeof *light))
        return no_memory(error);
    scene->lights[count] = *light;
    scene->light_count = count + 1;
    return PM_OK;
}

size_t pm__scene_light_count(const pm__scene *scene)
{
    return scene->light_count;
}

const pm__light *pm__scene_light_at(const pm__scene *scene, size_t index)
{
    return &scene->lights[index];
}

void pm__scene_power(const pm__scene *scene, double power[3])
{
    for (int band = 0; band < 3; band++) {
        power[band] = 0.0;
        for (size_t i = 0; i < scene->light_count; i++)
            power[band] += scene->lights[i].power[band];
    }
}

/* ---- Geometries -------------------------------------------------------------------------------- */

pm_status pm__geometry_create(pm__scene *scene, size_t count, pm__geometry **made, pm_error *error)
{
    if (check_open(scene, error) != PM_OK)
        return PM_EINVAL;
    const uint32_t number = scene->shape_count;
    if (count > PM__ELSEWHERE - number)
        return pm__fail(error, PM_EINVAL, "shape %u: %zu more are too many", number, count);
    if (pm__grow((void **)&scene->geometries, &scene->geometry_capacity, scene->geometry_count + 1, sizeof *made))
        return no_memory(error);
    *made = calloc(1, sizeof **made);
    if (!*made)
        return no_memory(error);
    (*made)->scene = scene;
    (*made)->first = number;
    (*made)->count = (uint32_t)count;
    return PM_OK;
}

void pm__geometry_attach(pm__scene *scene, pm__geometry *made, RTCGeometry embree)
{
    rtcSetGeometryUserData(embree, made);
    rtcCommitGeometry(embree);
    made->slot = (unsigned)scene->geometry_count;
    rtcAttachGeometryByID(scene->rays, embree, made->slot);
    rtcReleaseGeometry(embree);
    scene->geometries[scene->geometry_count++] = made;
    scene->shape_count += made->count;
    pm__box_enclose(scene->low, scene->high, made->low);
    pm__box_enclose(scene->low, scene->high, made->high);
}

pm_status pm__geometry_of(pm__scene *scene, uint32_t material, size_t count, pm__geometry **made, pm_error *error)
{
    if (material >= scene->material_count)
        return pm__fail(error, PM_EINVAL, "shape %u: there is no material %u", scene->shape_count, material);
    const pm_status status = pm__geometry_create(scene, count, made, error);
    if (status == PM_OK)
        (*made)->material = material;
    return status;
}

/* Fills in the triangles' planes. */
static pm_status check_mesh(uint32_t first, const float (*vertices)[3], size_t vertex_count,
                            const uint32_t (*triangles)[3], size_t triangle_count, pm__plane *planes, pm_error *error)
{
    for (size_t i = 0; i < vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            if (!(fabs((double)vertices[i][axis]) <= PM__LARGEST_LENGTH))
                return pm__fail(error, PM_EINVAL,
                                "shape %u (mesh): vertex %zu (%g, %g, %g) is not finite or beyond %g m", first, i,
                                (double)vertices[i][0], (double)vertices[i][1], (double)vertices[i][2],
                                PM__LARGEST_LENGTH);
    for (size_t i = 0; i < triangle_count; i++) {
        const uint32_t *const t = triangles[i];
        if (t[0] >= vertex_count || t[1] >= vertex_count || t[2] >= vertex_count)
            return pm__fail(error, PM_EINVAL, "shape %u (mesh): triangle %zu (%u, %u, %u) names a vertex beyond %zu",
                            first, i, t[0], t[1], t[2], vertex_count);
        if (!pm__triangle_plane(vertices, t, &planes[i]))
            return pm__fail(error, PM_EINVAL, "shape %u (mesh): triangle %zu (%u, %u, %u) spans no area", first, i,
                            t[0], t[1], t[2]);
    }
    return PM_OK;
}

static void box_of(pm__geometry *made, const float (*vertices)[3], size_t count)
{
    pm__box_empty(made->low, made->high);
    for (size_t i = 0; i < count; i++) {
        const double corner[3] = {(double)vertices[i][0], (double)vertices[i][1], (double)vertices[i][2]};
        pm__box_enclose(made->low, made->high, corner);
    }
}

pm_status pm__scene_mesh(pm__scene *scene, uint32_t material, const float (*vertices)[3], size_t vertex_count,
                         const uint32_t (*triangles)[3], size_t triangle_count, pm_error *error)
{
    const uint32_t first = scene->shape_count;
    if (vertex_count == 0 || triangle_count == 0)
        return pm__fail(error, PM_EINVAL, "shape %u (mesh): %zu vertices and %zu triangles", first, vertex_count,
                        triangle_count);
    pm__geometry *made = NULL;
    pm_status status = pm__geometry_of(scene, material, triangle_count, &made, error);
    if (status != PM_OK)
        return status;
    made->planes = pm__alloc(triangle_count, sizeof *made->planes);
    status = made->planes ? check_mesh(first, vertices, vertex_count, triangles, triangle_count, made->planes, error)
                          : no_memory(error);
    if (status != PM_OK) {
        destroy_geometry(made);
        return status;
    }
    const RTCGeometry embree = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float(*const v)[3] = rtcSetNewGeometryBuffer(embree, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof *v,
                                                 vertex_count);
    uint32_t(*const t)[3] = rtcSetNewGeometryBuffer(embree, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof *t,
                                                    triangle_count);
    if (!v || !t) {
        rtcReleaseGeometry(embree);
        destroy_geometry(made);
        status = embree_status(scene, error);
        return status == PM_OK ? no_memory(error) : status;
    }
    memcpy(v, vertices, vertex_count * sizeof *v);
    memcpy(t, triangles, triangle_count * sizeof *t);
    made->vertices = (const float(*)[3])v;
    made->triangles = (const uint32_t(*)[3])t;
    made->vertex_count = vertex_count;
    pm__rays_triangles(embree);
    box_of(made, vertices, vertex_count);
    pm__geometry_attach(scene, made, embree);
    return PM_OK;
}

/* ---- Committing -------------------------------------------------------------------------------- */

static bool is_flat(const pm__geometry *geometry)
{
    return geometry->shape.kind == PM__SHAPE_RECTANGLE || geometry->shape.kind == PM__SHAPE_DISC;
}

static bool is_exact(const pm__geometry *geometry)
{
    return !geometry->planes && !geometry->part;
}

static void list_kept(pm__scene *scene, const pm__geometry *geometry)
{
    const size_t at = scene->kept_count++;
    const pm__shape *const shape = &geometry->shape;
    pm__few *const few = scene->few;
    const bool is_wave = shape->kind == PM__SHAPE_WAVE, is_round = !is_flat(geometry) && !is_wave;
    few->kept[at] = geometry;
    few->shape[at] = geometry->first;
    few->material[at] = &scene->materials[geometry->material];
    few->round_count += is_round;
    few->wave_count += is_wave;
    few->radius[at] = is_round ? shape->radius : 0.0;
    few->axes[at] = shape->kind == PM__SHAPE_SPHERE ? 3 : 2;
    few->sign[at] = shape->inward ? -1.0 : 1.0;
    for (int axis = 0; axis < 3; axis++) {
        few->centre[axis][at] = shape->centre[axis];
        few->corner[axis][at] = is_flat(geometry) ? shape->centre[axis] : 0.0;
        few->normal[axis][at] = is_flat(geometry) ? shape->normal[axis] : 0.0;
    }
}

static void keep(pm__scene *scene, const pm__geometry *geometry)
{
    rtcDetachGeometry(scene->rays, geometry->slot);
    list_kept(scene, geometry);
    if (!is_flat(geometry) || !scene->flats) {
        scene->single[scene->single_count++] = geometry;
        return;
    }
    scene->flat[scene->flats->count] = geometry;
    pm__flats_add(scene->flats, &geometry->shape, geometry->first);
}

/* Takes exact shapes out of Embree, unless they are many: flat ones to be met together, others to be asked one by one.
 * Measured, in ns: a flat one takes 3 then and another one 7; to have Embree ask takes 50 or more. */
static pm_status keep_few(pm__scene *scene, pm_error *error)
{
    enum { LEAST_FLATS = 4, FLAT = 3, SINGLE = 7, MOST = 56 };
    size_t flat = 0, single = 0;
    for (size_t i = 0; i < scene->geometry_count; i++)
        if (is_exact(scene->geometries[i]))
            *(is_flat(scene->geometries[i]) ? &flat : &single) += 1;
    if (flat < LEAST_FLATS) {
        single += flat;
        flat = 0;
    }
    if (!scene->few && !(scene->few = pm__alloc_zero(1, sizeof *scene->few)))
        return no_memory(error);
    scene->few->shape[PM__MOST_KEPT] = PM__NO_SHAPE;
    if (scene->kept_count > 0 || flat * FLAT + single * SINGLE > MOST)
        return PM_OK;
    if (flat > 0 && !(scene->flats = pm__alloc_zero(1, sizeof *scene->flats)))
        return no_memory(error);
    for (size_t i = 0; i < scene->geometry_count; i++)
        if (is_exact(scene->geometries[i]))
            keep(scene, scene->geometries[i]);
    return PM_OK;
}

static void box_held(pm__scene *scene)
{
    pm__box_empty(scene->held_low, scene->held_high);
    for (size_t i = 0; i < scene->geometry_count; i++) {
        const pm__geometry *const geometry = scene->geometries[i];
        bool is_kept = false;
        for (size_t place = 0; place < scene->kept_count; place++)
            is_kept = is_kept || scene->few->kept[place] == geometry;
        if (is_kept)
            continue;
        pm__box_enclose(scene->held_low, scene->held_high, geometry->low);
        pm__box_enclose(scene->held_low, scene->held_high, geometry->high);
    }
}

static pm_status build(pm__scene *scene, double rounding, pm_error *error)
{
    if (keep_few(scene, error) != PM_OK)
        return PM_ENOMEM;
    box_held(scene);
    for (int axis = 0; axis < 3; axis++)
        scene->extent = fmax(scene->extent, fmax(fabs(scene->low[axis]), fabs(scene->high[axis])));
    /* A part so small, or so far off, that double is coarser there than float would be in its own terms. */
    scene->extent = fmax(scene->extent, 0x1p-28 * rounding);
    scene->rounding = fmax(rounding, scene->extent);
    rtcCommitScene(scene->rays);
    return embree_status(scene, error);
}

pm_status pm__scene_commit(pm__scene *scene, pm_error *error)
{
    if (scene->whole)
        return pm__fail(error, PM_EINVAL, "a part is committed with its scene");
    if (check_open(scene, error) != PM_OK)
        return PM_EINVAL;
    if (scene->geometry_count == 0 || scene->light_count == 0)
        return pm__fail(error, PM_EINVAL, "the scene has no %s", scene->geometry_count ? "light" : "shape");
    pm_status status = build(scene, 0.0, error);
    for (size_t i = 0; i < scene->part_count && status == PM_OK; i++)
        if (scene->parts[i]->smallest > 0.0)
            status = build(scene->parts[i], scene->extent / scene->parts[i]->smallest, error);
    if (status == PM_OK)
        status = pm__scene_list_objects(scene, error);
    scene->committed = status == PM_OK;
    return status;
}
