/* Lambertian rectangle over a floor: the case `rect-light` (../rect_light.c) with its photons traced.
 *
 * Truth, power, theory. As there. A Lambertian area A of radiance L sends pi L A. */
#include "../shared.h"
#include "scene_case.h"

static const double pi = 3.14159265358979323846;

enum { RADIANCE, WIDTH, DEPTH, HEIGHT };

static double truth(const double *values, const pm__probe *point)
{
    return pm__is_upside(point) ? pm__rect_light_truth(values, point) : 0.0;
}

static pm_status build_floor(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    double half[2];
    pm__rect_light_floor(values, half);
    const double corner[3] = {-half[0], -half[1], 0}, x[3] = {2.0 * half[0], 0, 0}, y[3] = {0, 2.0 * half[1], 0};
    uint32_t material = 0;
    const pm_status status = pm__scene_material(scene, &white, &material, error);
    return status ? status : pm__scene_rectangle(scene, material, corner, x, y, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double w = values[WIDTH], d = values[DEPTH], watts = pi * values[RADIANCE] * w * d;
    const pm__light light = {.kind = PM__RECTANGLE,
                             .power = {watts, watts, watts},
                             .position = {-0.5 * w, -0.5 * d, values[HEIGHT]},
                             .edge = {{0, d, 0}, {w, 0, 0}}}; /* y cross x is down */
    const pm_status status = build_floor(values, scene, error);
    return status ? status : pm__scene_light(scene, &light, error);
}

static void view(const double *values, pm__view *from)
{
    double half[2];
    pm__rect_light_floor(values, half);
    const double size = sqrt(half[0] * half[1]);
    *from = (pm__view){.eye = {0, -2.2 * size, 1.2 * size + values[HEIGHT]}, .at = {0, 0, 0}, .up = {0, 0, 1},
                       .angle = 0.8};
}

const pm__case pm__case_scene_rect_light = {
    .entry = {.name = "scene:rect-light",
              .summary = "Lambertian rectangular light over a floor",
              .citation = "Lambert 1760",
              .params = pm__rect_light_params,
              .param_count = PM__RECT_LIGHT_PARAMS},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = pm__rect_light_regions,
    .region_count = PM__RECT_LIGHT_REGIONS,
    .power = pm__rect_light_power,
    .probe = pm__rect_light_probe,
    .truth = truth,
    .mass = pm__rect_light_mass,
    .build = build,
    .view = view,
};
