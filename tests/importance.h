/* What tests of importance share: scenes looked at, and importons of them. */
#ifndef PM_TESTS_IMPORTANCE_H
#define PM_TESTS_IMPORTANCE_H

#include "../src/base/vec3.h"
#include "../src/cli/parallel.h"
#include "../src/transport/importons.h"
#include "lit.h"

static const double important_pi = 3.14159265358979323846;

enum { SIDE = 50, PIXELS = SIDE * SIDE };

/* SIDE x SIDE pixels. */
static inline pm__camera look(double x, double y, double z, double at_x, double at_y, double at_z, double angle)
{
    const bool down = x == at_x && y == at_y;
    const pm__view view = {.eye = {x, y, z}, .at = {at_x, at_y, at_z}, .up = {0, down, !down}, .angle = angle};
    pm__camera camera;
    pm_error error;
    PM_CHECK_OK(pm__camera_init(&view, SIDE, SIDE, &camera, &error), error);
    return camera;
}

static inline void far_lamp(pm__scene *scene)
{
    const pm__light lamp = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0, 0, 1000}};
    lit_lamp(scene, &lamp);
}

/* From straight above, 2 m: the view is 1.4 m wide. */
static const double above = 2.0, angle = 0.7;

static inline pm__scene *make_floor(double albedo)
{
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, albedo, albedo, albedo), 10.0, 0.0);
    far_lamp(scene);
    return lit_commit(scene);
}

/* And a plate of glass between, 0.8 to 1.2 m up. */
static const double thick = 0.4;

static inline pm__scene *make_plate(const double ior[3])
{
    const pm__material glass = {.kind = PM__GLASS, .ior = {ior[0], ior[1], ior[2]}};
    const double top[3] = {-8, -8, 1.2}, bottom[3] = {-8, -8, 1.2 - thick}, x[3] = {16, 0, 0}, y[3] = {0, 16, 0};
    pm__scene *const scene = lit_create();
    const uint32_t of_glass = lit_material(scene, &glass);
    pm_error error;
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 10.0, 0.0);
    PM_CHECK_OK(pm__scene_rectangle(scene, of_glass, top, x, y, &error), error);    /* normal up: out of the glass */
    PM_CHECK_OK(pm__scene_rectangle(scene, of_glass, bottom, y, x, &error), error); /* normal down */
    far_lamp(scene);
    return lit_commit(scene);
}

static inline pm__importance_config importance_of(const pm__scene *scene, const pm__camera *camera, size_t paths,
                                                  pm__measure measure)
{
    return (pm__importance_config){.scene = scene, .camera = camera, .width = SIDE, .height = SIDE, .paths = paths,
                                   .bounces = 4, .near = 0.0, .measure = measure, .nearest = 200, .share = 1.0,
                                   .outlier = INFINITY, .seed = 1};
}

static inline pm__importance *importance_made(const pm__importance_config *config)
{
    pm__importance *importance;
    pm_error error;
    PM_CHECK_OK(pm__importance_create(config, &importance, &error), error);
    return importance;
}

static inline void importons_made(const pm__importance_config *config, pm__importons sets[PM__MAP_KINDS])
{
    pm_error error;
    PM_CHECK_OK(pm__importons_trace(config, sets, &error), error);
}

static inline double importance_at(const pm__importance *importance, pm__map_kind kind, double x, double y, double z,
                                   double nx, double ny, double nz)
{
    const float position[1][3] = {{(float)x, (float)y, (float)z}}, normal[1][3] = {{(float)nx, (float)ny, (float)nz}};
    float value = -1.0f;
    pm__importance_at(importance, kind, position, normal, 1, &value);
    ck_assert(value >= 0.0f && value < INFINITY);
    return (double)value;
}

/* The sum of the importons' importance, pixels. */
static inline double flux_of(const pm__importons *set)
{
    double sum = 0.0;
    for (size_t i = 0; i < set->count; i++)
        sum += (double)set->importons[i].power[PM__IMPORTON_PIXELS];
    return sum;
}

#endif
