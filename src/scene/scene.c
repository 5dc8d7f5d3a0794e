#include "../base/memory.h"
#include "../base/vec3.h"
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

pm_status pm__scene_embree_status(const pm__scene *scene, pm_error *error)
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
        return pm__fail(error, PM_ENOMEM, "out of memory: Embree cannot be started");
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

void pm__geometry_destroy(pm__geometry *geometry)
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
        pm__geometry_destroy(scene->geometries[i]);
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

static bool absorbs(const pm__material *material)
{
    return material->kind == PM__GLASS && pm__sum(material->absorption) > 0.0;
}

bool pm__scene_absorbs(const pm__scene *scene)
{
    bool any = false;
    for (size_t i = 0; i < scene->material_count; i++)
        any = any || absorbs(&scene->materials[i]);
    for (size_t i = 0; i < scene->part_count; i++)
        any = any || pm__scene_absorbs(scene->parts[i]);
    return any;
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

static bool is_kept(const pm__scene *scene, const pm__geometry *geometry)
{
    for (size_t place = 0; place < scene->kept_count; place++)
        if (scene->few->kept[place] == geometry)
            return true;
    return false;
}

static void hold(const pm__geometry *geometry, pm__held *held)
{
    pm__box_enclose(held->low, held->high, geometry->low);
    pm__box_enclose(held->low, held->high, geometry->high);
    held->first = geometry->first < held->first ? geometry->first : held->first;
    held->end = (int64_t)geometry->first + geometry->count;
}

static pm__held *begin_held(pm__scene *scene)
{
    pm__held *const held = &scene->held[scene->held_count++];
    *held = (pm__held){.first = INT64_MAX, .steep = 2.0};
    pm__box_empty(held->low, held->high);
    return held;
}

/* While there is room for the others behind it. */
static bool hold_sheet(pm__scene *scene, const pm__geometry *geometry)
{
    for (int axis = 0; axis < 3 && geometry->planes && scene->held_count + 1 < PM__MOST_HELD; axis++) {
        const double steep = pm__sheet_steepness(geometry, axis);
        if (steep > 1.0)
            continue;
        pm__held *const sheet = begin_held(scene);
        hold(geometry, sheet);
        sheet->axis = axis;
        sheet->steep = steep;
        return true;
    }
    return false;
}

static void list_held(pm__scene *scene)
{
    pm__held *others = NULL;
    scene->held_count = 0; /* a commit that failed may be tried again */
    for (size_t i = 0; i < scene->geometry_count; i++) {
        const pm__geometry *const geometry = scene->geometries[i];
        if (is_kept(scene, geometry) || hold_sheet(scene, geometry))
            continue;
        if (!others)
            others = begin_held(scene);
        hold(geometry, others);
    }
}

static pm_status build(pm__scene *scene, double rounding, pm_error *error)
{
    if (keep_few(scene, error) != PM_OK)
        return PM_ENOMEM;
    list_held(scene);
    for (int axis = 0; axis < 3; axis++)
        scene->extent = fmax(scene->extent, fmax(fabs(scene->low[axis]), fabs(scene->high[axis])));
    /* A part so small, or so far off, that double is coarser there than float would be in its own terms. */
    scene->extent = fmax(scene->extent, 0x1p-28 * rounding);
    scene->rounding = fmax(rounding, scene->extent);
    rtcCommitScene(scene->rays);
    return pm__scene_embree_status(scene, error);
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
