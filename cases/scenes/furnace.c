/* Furnace: a Lambertian sphere of radius 1 whose whole inside shines with the radiance Le.
 *
 * Truth. Light of a patch of a Lambertian sphere falls on every other alike (integrating_sphere.c), so the irradiance
 * is even, of every order: E = pi Le (1 + rho + rho^2 + ...) = pi Le / (1 - rho); what is seen is Le / (1 - rho).
 * The light is a ball just within the wall, so that its photons do not start on it. By symmetry its light is as even on
 * the wall for any radius; only its power, 4 pi^2 Le, counts.
 * Power. That of all orders, 4 pi E.
 * Theory. Within the chord s lies the area pi s^2, a cap of the height h = s^2 / 2. At the front of a probe p arrives
 * at the cosine t from p what comes from below the plane there that is parallel to the tangent plane in p. All points
 * send alike, and equal heights are equal areas: that is the share (1 + t) / 2 = 1 - (1 - t) / 2. Over the cap,
 *     2 pi E integral_0^h (1 - x / 2) dx = 2 pi E (h - h^2 / 4):
 * the front-side filter takes s^2 / 8 of an estimate of the radius s.
 * Where a photon lands next does not depend on where it is, so positions are independent; as of the integrating sphere,
 * noise leaves out that the number of photons of a path varies. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846, radiance = 1.0; /* W/(m2 sr) */
static const double within_wall = 1.0 - 1e-9;                    /* m, radius of the light */

static const pm__param params[] = {
    {.name = "albedo", .type = PM__REAL, .value = 0.5, .min = 0.0, .max = 0.95, .unit = "", .help = "of the wall"},
};

static const pm__region regions[] = {
    {"all", "the whole sphere", false, false},
};

static double irradiance(const double *values)
{
    return pi * radiance / (1.0 - values[0]);
}

static double power(const double *values)
{
    return 4.0 * pi * irradiance(values);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    (void)region;
    pm__probe_sphere(u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return pm__is_inside(point) ? irradiance(values) : 0.0;
}

/* Power within the chord s that a lookup accepts. */
static double within(const double *values, bool front_only, double s)
{
    const double chord = fmin(s, 2.0), height = 0.5 * chord * chord;
    return 2.0 * pi * irradiance(values) * (front_only ? height * (1.0 - 0.25 * height) : height);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    (void)point;
    if (shape->shape != PM_LOOKUP_SPHERE)
        return NAN;
    return within(values, shape->front_only, r1) - within(values, shape->front_only, r0);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double watts = 4.0 * pi * pi * radiance;
    const pm__light light = {.kind = PM__BALL, .power = {watts, watts, watts}, .radius = within_wall, .inward = true};
    return pm__scene_ball_room(scene, values[0], &light, error);
}

const pm__case pm__case_scene_furnace = {
    .entry = {.name = "scene:furnace",
              .summary = "all light in a Lambertian sphere that shines inside with 1 W/(m2 sr)",
              .citation = "Kirchhoff 1860",
              .params = params,
              .param_count = 1},
    .paths = "LD+",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = regions,
    .region_count = sizeof regions / sizeof *regions,
    .power = power,
    .probe = probe,
    .truth = truth,
    .mass = mass,
    .build = build,
    .view = pm__ball_room_view,
};
