/* Scenes for tests: made of exact shapes, all black, under one lamp. */
#ifndef PM_TESTS_SHAPES_H
#define PM_TESTS_SHAPES_H

#include "../src/base/random.h"
#include "../src/base/vec3.h"
#include "../src/scene/scene.h"
#include "../src/scene/shapes.h"
#include "test.h"

static const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 1.0, 1.0}};
static const pm__material black = {.kind = PM__BLACK};

static inline pm__scene *new_scene(void)
{
    pm__scene *scene;
    pm_error error;
    uint32_t material;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__scene_material(scene, &black, &material, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, &lamp, &error), error);
    ck_assert_uint_eq(material, 0);
    return scene;
}

static inline pm_status add(pm__scene *scene, const pm__shape *s, pm_error *error)
{
    switch (s->kind) {
    case PM__SHAPE_SPHERE:
        return pm__scene_sphere(scene, 0, s->centre, s->radius, s->inward, error);
    case PM__SHAPE_CYLINDER:
        return pm__scene_cylinder(scene, 0, s->centre, s->radius, s->low, s->high, s->from, s->inward, error);
    case PM__SHAPE_RECTANGLE:
        return pm__scene_rectangle(scene, 0, s->centre, s->edge[0], s->edge[1], error);
    case PM__SHAPE_DISC:
        return pm__scene_disc(scene, 0, s->centre, s->normal, s->radius, error);
    case PM__SHAPE_WAVE:
        return pm__scene_wave(scene, 0, s->centre[2], s->amplitude, s->wavenumber, s->extent, error);
    }
    return PM_EINVAL;
}

static inline pm__scene *scene_of(pm__shape *shapes, size_t count)
{
    pm__scene *const scene = new_scene();
    pm_error error;
    for (size_t i = 0; i < count; i++) {
        PM_CHECK_OK(add(scene, &shapes[i], &error), error);
        PM_CHECK_OK(pm__shape_prepare(&shapes[i], (uint32_t)i, &error), error);
    }
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

/* Uniform within [-size, size]^3, and a direction. */
static inline void random_ray(uint32_t trial, uint64_t number, double size, double origin[3], double direction[3])
{
    double u[6];
    pm__random_uniform(7, PM__FOR_TESTS, trial, number, u, 6);
    for (int axis = 0; axis < 3; axis++) {
        origin[axis] = size * (2.0 * u[axis] - 1.0);
        direction[axis] = 2.0 * u[3 + axis] - 1.0;
    }
    (void)pm__normalize(direction);
}

static inline pm__shape sphere(double x, double y, double z, double radius)
{
    return (pm__shape){.kind = PM__SHAPE_SPHERE, .centre = {x, y, z}, .radius = radius};
}

static inline pm__shape cylinder(double x, double y, double radius, double low, double high, double from)
{
    return (pm__shape){
        .kind = PM__SHAPE_CYLINDER, .centre = {x, y, 0.0}, .radius = radius, .low = low, .high = high, .from = from};
}

static inline pm__shape wave(double amplitude, double wavenumber)
{
    return (pm__shape){.kind = PM__SHAPE_WAVE,
                       .centre = {0.0, 0.0, 0.1},
                       .amplitude = amplitude,
                       .wavenumber = wavenumber,
                       .extent = {1.7, 1.3}};
}

#endif
