/* Glossy plane: the unit square z = 0 with Schlick's model under parallel light of 1 W/m2, seen from above. What is
 * asked for is radiance.
 *
 * Truth. Light travels along (sin a, 0, -cos a), so E = cos a, and toward `out` leaves f(in, out) E, with the BRDF f of
 * src/scene/material.c: the form that conserves energy, or the printed one with what is wrong with it (errata 25, 26).
 * Probes are seen along the normal, off the mirrored direction, where the printed form has no lobe to lose.
 * Theory. f is the same for every photon, so an estimate of radiance is f times that of the irradiance. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846, beam = 1.0; /* W/m2 */
static const double radius = 0.75; /* m, of the beam about the middle of the square, whose corners are sqrt(2)/2 off */

enum { ROUGHNESS, ANGLE, FORM };

static const pm__param params[] = {
    {.name = "roughness", .type = PM__REAL, .value = 0.1, .min = 0.0, .max = 1.0, .unit = "",
     .help = "of the surface: 0 a mirror, 1 facets of all directions"},
    {.name = "angle", .type = PM__REAL, .value = 30.0, .min = 0.0, .max = 85.0, .unit = "degree",
     .help = "of the light to the normal"},
    {.name = "form", .type = PM__CHOICE, .value = 0, .choices = "safe|printed", .unit = "",
     .help = "of the BRDF: one that conserves energy, or the formula as printed"},
};

static const pm__region regions[] = {
    {"all", "at least 0.15 m from the sides", true, true},
};

static pm__material surface(const double *values)
{
    return (pm__material){.kind = PM__GLOSSY, .diffuse = {0.3, 0.3, 0.3}, .specular = {0.6, 0.6, 0.6},
                          .roughness = values[ROUGHNESS], .printed = values[FORM] != 0.0};
}

/* And the power, since the square is of 1 m2. */
static double irradiance(const double *values)
{
    return beam * cos(values[ANGLE] * pi / 180.0);
}

static void light_direction(const double *values, double direction[3])
{
    const double a = values[ANGLE] * pi / 180.0;
    direction[0] = sin(a);
    direction[1] = 0.0;
    direction[2] = -cos(a);
}

static void incoming(const double *values, const pm__probe *point, double direction[3])
{
    (void)point;
    light_direction(values, direction);
}

static void brdf(const double *values, const double along[3], const double outgoing[3], double value[3])
{
    const double up[3] = {0, 0, 1}, in[3] = {-along[0], -along[1], -along[2]};
    const pm__material material = surface(values);
    pm__material_brdf(&material, up, in, outgoing, value);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    (void)region;
    pm__probe_rectangle(&pm__inset_square, u, point);
    point->outgoing[2] = 1.0;
}

static double truth(const double *values, const pm__probe *point)
{
    double along[3], value[3];
    if (!pm__is_upside(point))
        return 0.0;
    light_direction(values, along);
    brdf(values, along, point->outgoing, value);
    return value[0] * irradiance(values);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    return pm__accepts_down(point, shape) ? irradiance(values) * pm__shell_area(&pm__unit_square, point, r0, r1) : 0.0;
}

static pm_status build_light(const double *values, pm__scene *scene, pm_error *error)
{
    const double watts = beam * pi * radius * radius, away = 2.0;
    pm__light light = {.kind = PM__DIRECTIONAL, .power = {watts, watts, watts}, .position = {0.5, 0.5, 0},
                       .radius = radius};
    light_direction(values, light.direction);
    for (int i = 0; i < 3; i++)
        light.position[i] -= away * light.direction[i];
    return pm__scene_light(scene, &light, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material material = surface(values);
    const double corner[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    uint32_t glossy = 0;
    pm_status status = pm__scene_material(scene, &material, &glossy, error);
    if (!status)
        status = pm__scene_rectangle(scene, glossy, corner, x, y, error);
    if (!status)
        status = build_light(values, scene, error);
    return status;
}

/* From where the light is mirrored to, as far as the square can be seen from there. */
static void view(const double *values, pm__view *from)
{
    const double a = fmin(fmax(values[ANGLE], 10.0), 70.0) * pi / 180.0, away = 1.8;
    *from = (pm__view){.eye = {0.5 + away * sin(a), 0.5, away * cos(a)}, .at = {0.5, 0.5, 0}, .up = {0, 0, 1},
                       .angle = 0.75};
}

const pm__case pm__case_scene_glossy_plane = {
    .entry = {.name = "scene:glossy-plane",
              .summary = "radiance of a glossy plane under parallel light of 1 W/m2, seen along its normal",
              .citation = "Schlick 1993; Jensen 1996, eq. 5",
              .params = params,
              .param_count = 3},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = regions,
    .region_count = sizeof regions / sizeof *regions,
    .power = irradiance,
    .probe = probe,
    .truth = truth,
    .mass = mass,
    .build = build,
    .view = view,
    .brdf = brdf,
    .incoming = incoming,
};
