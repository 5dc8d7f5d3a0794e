/* Lit scenes for tests of photon tracing. */
#ifndef PM_TESTS_LIT_H
#define PM_TESTS_LIT_H

#include "../src/transport/shoot.h"
#include "test.h"

static inline pm__scene *lit_create(void)
{
    pm_error error;
    pm__scene *scene;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    return scene;
}

static inline pm__scene *lit_commit(pm__scene *scene)
{
    pm_error error;
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

static inline uint32_t lit_material(pm__scene *scene, const pm__material *material)
{
    pm_error error;
    uint32_t index;
    PM_CHECK_OK(pm__scene_material(scene, material, &index, &error), error);
    return index;
}

static inline uint32_t lit_wall(pm__scene *scene, double r, double g, double b)
{
    const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {r, g, b}};
    return lit_material(scene, &wall);
}

static inline uint32_t lit_glass(pm__scene *scene)
{
    const pm__material glass = {.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}};
    return lit_material(scene, &glass);
}

static inline void lit_sphere(pm__scene *scene, uint32_t material, double x, double y, double z, double radius,
                              bool inward)
{
    pm_error error;
    const double centre[3] = {x, y, z};
    PM_CHECK_OK(pm__scene_sphere(scene, material, centre, radius, inward, &error), error);
}

static inline void lit_lamp(pm__scene *scene, const pm__light *light)
{
    pm_error error;
    PM_CHECK_OK(pm__scene_light(scene, light, &error), error);
}

/* |x|, |y| <= half, facing up. */
static inline void lit_floor(pm__scene *scene, uint32_t material, double half, double z)
{
    pm_error error;
    const double corner[3] = {-half, -half, z}, u[3] = {2.0 * half, 0.0, 0.0}, v[3] = {0.0, 2.0 * half, 0.0};
    PM_CHECK_OK(pm__scene_rectangle(scene, material, corner, u, v, &error), error);
}

static inline pm__photon_set lit_shoot(const pm__shoot_config *config)
{
    pm_error error;
    pm__photon_set set;
    PM_CHECK_OK(pm__shoot(config, &set, &error), error);
    return set;
}

static inline double lit_power(const pm__photon_set *set, int band)
{
    double sum = 0.0;
    for (size_t i = 0; i < set->count; i++)
        sum += (double)set->photons[i].power[band];
    return sum;
}

static inline const pm__sampler *lit_sampler(const char *name)
{
    const pm__entry *const entry = pm__find(&pm__samplers, name);
    ck_assert_ptr_nonnull(entry);
    return (const pm__sampler *)(const void *)entry;
}

#endif
