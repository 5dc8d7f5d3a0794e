/* Still water 1 m deep under a point light 1 m above it: the light on the bottom.
 *
 * Truth. Light of 1 W/sr, 1 m of air, 1 m of water: scene_case.c, with one crossing.
 * Power. The light shines into a cone of 75 degrees, and bottom and surface reach beyond it. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846;
static const double depth = 1.0, height = 1.0; /* m, of the water, and of the light over it */

static const pm__param params[] = {
    {.name = "ior", .type = PM__REAL, .value = 1.33, .min = 1.0, .max = 3.0, .unit = "", .help = "of the water"},
};

static pm__layered layers(const double *values)
{
    return (pm__layered){.air = height, .layer = depth, .n = values[0], .cone = pi * 75.0 / 180.0, .crossings = 1};
}

static double power(const double *values)
{
    const pm__layered l = layers(values);
    return pm__layered_power(&l);
}

static double truth(const double *values, const pm__probe *point)
{
    const pm__layered l = layers(values);
    return pm__layered_truth(&l, point);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const pm__layered l = layers(values);
    return pm__layered_within(&l, point, shape, r0, r1);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__layered l = layers(values);
    const double n = values[0], half = 1.05 * pm__layered_extent(&l);
    const pm__material water = {.kind = PM__GLASS, .ior = {n, n, n}};
    const double corner[3] = {-half, -half, depth}, x[3] = {2.0 * half, 0, 0}, y[3] = {0, 2.0 * half, 0};
    uint32_t material = 0;
    pm_status status = pm__scene_material(scene, &water, &material, error);
    if (!status)
        status = pm__scene_rectangle(scene, material, corner, x, y, error);
    if (!status)
        status = pm__scene_floor(scene, 0.0, half, 0.0, error);
    if (!status)
        status = pm__scene_lamp(scene, PM__SPOT, depth + height, 2.0 * pi * (1.0 - cos(l.cone)), 0.0, l.cone, error);
    return status;
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0, -2.5, depth + 2.5}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.8};
}

const pm__case pm__case_scene_water = {
    .entry = {.name = "scene:water",
              .summary = "point light of 1 W/sr over still water",
              .citation = "Snell, Fresnel",
              .params = params,
              .param_count = 1},
    .paths = "LSD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = pm__layered_regions,
    .region_count = PM__LAYERED_REGIONS,
    .power = power,
    .probe = pm__layered_probe,
    .truth = truth,
    .mass = mass,
    .build = build,
    .view = view,
};
