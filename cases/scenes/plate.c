/* Plate of glass between a point light and a floor: the light that passes straight
 * through, without reflection inside.
 *
 * Truth. Light of 1 W/sr, 1 m of air in all (0.6 m above the plate, 0.4 m below it: only the sum matters, since a ray
 * leaves a plate parallel to how it came), the plate of the given thickness: scene_case.c, with two crossings.
 * Power. The light shines into a cone of 75 degrees, and floor and plate reach beyond it. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846;
static const double below = 0.4, above = 0.6; /* m of air */

enum { IOR, THICKNESS };

static const pm__param params[] = {
    {.name = "ior", .type = PM__REAL, .value = 1.5, .min = 1.0, .max = 3.0, .unit = "", .help = "of the glass"},
    {.name = "thickness", .type = PM__REAL, .value = 0.2, .min = 0.01, .max = 2.0, .unit = "m", .help = "of the plate"},
};

static pm__layered layers(const double *values)
{
    return (pm__layered){.air = below + above, .layer = values[THICKNESS], .n = values[IOR], .cone = pi * 75.0 / 180.0,
                         .crossings = 2};
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

/* The two faces; the normals point out of the glass. */
static pm_status build_faces(const double *values, double half, pm__scene *scene, pm_error *error)
{
    const double n = values[IOR], side = 2.0 * half, top = below + values[THICKNESS];
    const pm__material glass = {.kind = PM__GLASS, .ior = {n, n, n}};
    const double upper[3] = {-half, -half, top}, lower[3] = {-half, -half, below};
    const double x[3] = {side, 0, 0}, y[3] = {0, side, 0};
    uint32_t material = 0;
    pm_status status = pm__scene_material(scene, &glass, &material, error);
    if (!status)
        status = pm__scene_rectangle(scene, material, upper, x, y, error);
    if (!status)
        status = pm__scene_rectangle(scene, material, lower, y, x, error);
    return status;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__layered l = layers(values);
    const double half = 1.05 * pm__layered_extent(&l), height = below + values[THICKNESS] + above;
    pm_status status = build_faces(values, half, scene, error);
    if (!status)
        status = pm__scene_floor(scene, 0.0, half, 0.0, error);
    if (!status)
        status = pm__scene_lamp(scene, PM__SPOT, height, 2.0 * pi * (1.0 - cos(l.cone)), 0.0, l.cone, error);
    return status;
}

static void view(const double *values, pm__view *from)
{
    const double top = below + values[THICKNESS] + above;
    *from = (pm__view){.eye = {0, -2.5, top + 1.5}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.8};
}

const pm__case pm__case_scene_plate = {
    .entry = {.name = "scene:plate",
              .summary = "point light of 1 W/sr through a glass plate",
              .citation = "Snell, Fresnel",
              .params = params,
              .param_count = 2},
    .paths = "LSSD",
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
