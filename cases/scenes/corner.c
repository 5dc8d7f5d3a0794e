/* Inside corner: a floor and a wall, unit squares that share an edge, under one parallel light of 1 W/m2 that comes
 * from in front of both.
 *
 * Truth. Light travels along (-sin a, 0, -cos a): the floor z = 0 gets cos a, the wall x = 0 gets sin a, everywhere,
 * since neither square is between the other and the light. Their backs get nothing.
 * Theory. As of the case `corner` (../corner.c), but that the wall's photons come from above the floor too: no
 * front-side filter tells them from its own. */
#include "../shared.h"
#include "scene_case.h"

static const double pi = 3.14159265358979323846, beam = 1.0; /* W/m2 */
static const double radius = 0.9; /* m, of the beam about the middle of the unit cube: its corners are sqrt(3)/2 off */

static const pm__param params[] = {
    {.name = "angle", .type = PM__REAL, .value = 30.0, .min = 5.0, .max = 85.0, .unit = "degree",
     .help = "of the light to the floor's normal"},
};

/* of the floor and of the wall, W/m2 */
static void irradiances(const double *values, double e[2])
{
    const double a = values[0] * pi / 180.0;
    e[0] = beam * cos(a);
    e[1] = beam * sin(a);
}

static double power(const double *values)
{
    double e[2];
    irradiances(values, e);
    return e[0] + e[1];
}

static double truth(const double *values, const pm__probe *point)
{
    double e[2];
    irradiances(values, e);
    return point->normal[2] > 0.5 ? e[0] : point->normal[0] > 0.5 ? e[1] : 0.0;
}

/* For probes on the floor. */
static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    double e[2];
    irradiances(values, e);
    return e[0] * pm__shell_area(&pm__unit_square, point, r0, r1) +
           e[1] * (pm__corner_wall_area(point, shape, r1) - pm__corner_wall_area(point, shape, r0));
}

static pm_status build_light(const double *values, pm__scene *scene, pm_error *error)
{
    double e[2];
    irradiances(values, e);
    const double x = -e[1] / beam, z = -e[0] / beam, watts = beam * pi * radius * radius, away = 2.0;
    const pm__light light = {.kind = PM__DIRECTIONAL,
                             .power = {watts, watts, watts},
                             .position = {0.5 - away * x, 0.5, 0.5 - away * z},
                             .direction = {x, 0, z},
                             .radius = radius};
    return pm__scene_light(scene, &light, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    const double corner[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
    uint32_t material = 0;
    pm_status status = pm__scene_material(scene, &white, &material, error);
    if (!status)
        status = pm__scene_rectangle(scene, material, corner, x, y, error);
    if (!status)
        status = pm__scene_rectangle(scene, material, corner, y, z, error);
    if (!status)
        status = build_light(values, scene, error);
    return status;
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {2.2, -0.6, 1.6}, .at = {0.25, 0.5, 0.25}, .up = {0, 0, 1}, .angle = 0.75};
}

const pm__case pm__case_scene_corner = {
    .entry = {.name = "scene:corner",
              .summary = "inside corner of a floor and a wall under one parallel light of 1 W/m2",
              .citation = "course 43, 2.3.1 and Fig. 2.8",
              .params = params,
              .param_count = 1},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = pm__corner_regions,
    .region_count = PM__CORNER_REGIONS,
    .power = power,
    .probe = pm__corner_probe,
    .truth = truth,
    .mass = mass,
    .build = build,
    .view = view,
};
