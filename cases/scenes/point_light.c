/* Isotropic point light over a floor: the case `point-light` (../point_light.c) with its photons traced.
 *
 * Truth. As there. The floor is a square that ends at a = 4 heights from the foot, in x and y.
 * Power. What falls on the floor: a square of half size a at the height h fills the solid angle
 *     4 atan(a^2 / (h sqrt(h^2 + 2 a^2)))
 * of the 4 pi of the light.
 * Theory. Quadrature over the square. */
#include "../shared.h"
#include "scene_case.h"

static const double pi = 3.14159265358979323846, extent = 4.0; /* heights */

enum { POWER, HEIGHT };

static double power(const double *values)
{
    return values[POWER] * atan(extent * extent / sqrt(1.0 + 2.0 * extent * extent)) / pi;
}

static double truth(const double *values, const pm__probe *point)
{
    return pm__is_upside(point) ? pm__point_light_irradiance(values, point->position[0], point->position[1]) : 0.0;
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const double a = extent * values[HEIGHT];
    const pm__rectangle floor_area = {-a, a, -a, a};
    if (!pm__accepts_down(point, shape))
        return 0.0;
    return pm__mass_rectangle(pm__point_light_irradiance, values, &floor_area, point, r0, r1);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm_status status = pm__scene_floor(scene, 0.0, extent * values[HEIGHT], 0.0, error);
    return status ? status : pm__scene_lamp(scene, PM__POINT, values[HEIGHT], values[POWER], 0.0, 0.0, error);
}

static void view(const double *values, pm__view *from)
{
    const double h = values[HEIGHT];
    *from = (pm__view){.eye = {0, -3.0 * h, 3.0 * h}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.8};
}

const pm__case pm__case_scene_point_light = {
    .entry = {.name = "scene:point-light",
              .summary = "isotropic point light over a floor",
              .citation = "Lambert 1760",
              .params = pm__point_light_params,
              .param_count = PM__POINT_LIGHT_PARAMS},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = pm__point_light_regions,
    .region_count = PM__POINT_LIGHT_REGIONS,
    .power = power,
    .probe = pm__point_light_probe,
    .truth = truth,
    .mass = mass,
    .build = build,
    .view = view,
};
