/* Thin wall lit on one side: the case `wall` (../wall.c) with its photons traced. It is seen from the dark side, where
 * all light is light that leaks.
 *
 * Truth, power, theory. As there. Two squares stand for the faces of the wall; light straight down passes by its sides,
 * which are left open. */
#include "../shared.h"
#include "scene_case.h"

static const double pi = 3.14159265358979323846, radius = 0.75; /* m, of the beam; the square's corners: sqrt(2)/2 */

enum { IRRADIANCE, THICKNESS };

static pm_status build_faces(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}, .back = {1, 1, 1}, .two_sided = true};
    const double lit[3] = {0, 0, 0}, dark[3] = {0, 0, -values[THICKNESS]}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    uint32_t material = 0;
    pm_status status = pm__scene_material(scene, &white, &material, error);
    if (!status)
        status = pm__scene_rectangle(scene, material, lit, x, y, error);
    if (!status)
        status = pm__scene_rectangle(scene, material, dark, y, x, error);
    return status;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double watts = values[IRRADIANCE] * pi * radius * radius;
    const pm__light light = {.kind = PM__DIRECTIONAL, .power = {watts, watts, watts}, .position = {0.5, 0.5, 1},
                             .direction = {0, 0, -1}, .radius = radius};
    const pm_status status = build_faces(values, scene, error);
    return status ? status : pm__scene_light(scene, &light, error);
}

static void view(const double *values, pm__view *from)
{
    *from = (pm__view){.eye = {0.5, -0.9, -1.4}, .at = {0.5, 0.45, -values[THICKNESS]}, .up = {0, 0, 1}, .angle = 0.7};
}

const pm__case pm__case_scene_wall = {
    .entry = {.name = "scene:wall",
              .summary = "thin wall lit on one side",
              .citation = "course 43, 2.1.3",
              .params = pm__wall_params,
              .param_count = PM__WALL_PARAMS},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = pm__wall_regions,
    .region_count = PM__WALL_REGIONS,
    .power = pm__wall_power,
    .probe = pm__wall_probe,
    .truth = pm__wall_truth,
    .mass = pm__wall_mass,
    .reach = pm__wall_reach,
    .build = build,
    .view = view,
};
