/* Integrating sphere: a Lambertian sphere of radius 1 with a point light of 1 W inside: the light that has been
 * reflected at least once.
 *
 * Truth. Between two points of a sphere of radius a, both cosines are d / (2 a), so a patch that sends the power P in a
 * Lambertian way lights every other with P cos cos / (pi d^2) = P / (4 pi a^2), wherever it is: reflected light is
 * uniform after one reflection. Of the light's 1 W the wall reflects rho, of that rho again, and so on:
 *     E = rho / ((1 - rho) 4 pi a^2),   power rho / (1 - rho),
 * for any position of the light. It hangs off the centre, where direct light is not uniform: a test of the scene. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846, light_power = 1.0, offset = 0.5; /* W, m */

static const pm__param params[] = {
    {.name = "albedo", .type = PM__REAL, .value = 0.5, .min = 0.01, .max = 0.95, .unit = "", .help = "of the wall"},
};

static const pm__region regions[] = {
    {"all", "the whole sphere", false, false},
};

static double power(const double *values)
{
    return light_power * values[0] / (1.0 - values[0]);
}

/* Equal heights have equal areas. */
static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    (void)region;
    const double z = 2.0 * u[0] - 1.0, r = sqrt(fmax(0.0, 1.0 - z * z)), phi = 2.0 * pi * u[1];
    const double at[3] = {r * cos(phi), r * sin(phi), z};
    for (int i = 0; i < 3; i++) {
        point->position[i] = at[i];
        point->normal[i] = -at[i];
    }
}

static double truth(const double *values, const pm__probe *point)
{
    (void)point;
    return power(values) / (4.0 * pi);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double rho = values[0], centre[3] = {0, 0, 0};
    const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {rho, rho, rho}};
    const pm__light light = {.kind = PM__POINT, .power = {light_power, light_power, light_power},
                             .position = {offset, 0, 0}};
    uint32_t material = 0;
    pm_status status = pm__scene_material(scene, &wall, &material, error);
    if (!status)
        status = pm__scene_sphere(scene, material, centre, 1.0, true, error);
    if (!status)
        status = pm__scene_light(scene, &light, error);
    return status;
}

const pm__case pm__case_scene_integrating_sphere = {
    .entry = {.name = "scene:integrating-sphere",
              .summary = "indirect light of a point light of 1 W in a Lambertian sphere",
              .citation = "Ulbricht 1900",
              .params = params,
              .param_count = 1},
    .paths = "LDD+",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = regions,
    .region_count = sizeof regions / sizeof *regions,
    .power = power,
    .probe = probe,
    .truth = truth,
    .build = build,
};
