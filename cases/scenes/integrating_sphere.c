/* Integrating sphere: a Lambertian sphere of radius 1 with a point light of 1 W inside: the light that has been
 * reflected at least once.
 *
 * Truth. Between two points of a sphere of radius a, both cosines are d / (2 a), so a patch that sends the power P in a
 * Lambertian way lights every other with P cos cos / (pi d^2) = P / (4 pi a^2), wherever it is: reflected light is
 * uniform after one reflection. Of the light's 1 W the wall reflects rho, of that rho again, and so on:
 *     E = rho / ((1 - rho) 4 pi a^2),   power rho / (1 - rho),
 * for any position of the light. It hangs off the centre, where direct light is not uniform: a test of the scene.
 * Theory. Within the chord s lies the area pi s^2. At the front of a probe p arrives what comes from above the plane
 * through the photon's place x that is parallel to the tangent plane in p: of the sphere all but the cap about p up to
 * x. What a cap sends is rho times its direct and indirect light. Of a light at the offset c, with P_l of Legendre,
 *     E_direct(y) = 1 / (4 pi) sum of (l + 1) c^l P_l(cos(y, c)),
 * the normal derivative of its potential; over the cap of cosines above t the mean rule of Funk and Hecke has
 *     2 pi integral_t^1 P_l = 2 pi (P_{l-1}(t) - P_{l+1}(t)) / (2 l + 1)  times P_l(cos(p, c)),
 * and what is refused up to s is the integral of that over the area 2 pi dt, again by this rule. Means are exact; noise
 * leaves out that a photon and the next of its path are together in a lookup with a chance of k / N. */
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

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    (void)region;
    pm__probe_sphere(u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return pm__is_inside(point) ? power(values) / (4.0 * pi) : 0.0;
}

enum { TERMS = 56 };

/* integral_t^1 of what the cap of cosines above t' gets directly, W; toward: cosine between probe and light. */
static double direct_on_caps(double t, double toward)
{
    double p[TERMS + 2], q[TERMS + 2], once[TERMS + 1]; /* P_l(t), P_l(toward), the integral of P_l from t to 1 */
    p[0] = q[0] = 1.0;
    p[1] = t;
    q[1] = toward;
    for (int l = 1; l <= TERMS; l++) {
        p[l + 1] = ((2 * l + 1) * t * p[l] - l * p[l - 1]) / (l + 1);
        q[l + 1] = ((2 * l + 1) * toward * q[l] - l * q[l - 1]) / (l + 1);
    }
    for (int l = 0; l <= TERMS; l++)
        once[l] = (p[l ? l - 1 : 0] - p[l + 1]) / (2 * l + 1);
    double sum = 0.0, scale = 0.5 * light_power;
    for (int l = 0; l < TERMS; l++) {
        sum += scale * (l + 1) * q[l] * (once[l ? l - 1 : 0] - once[l + 1]) / (2 * l + 1);
        scale *= offset;
    }
    return sum;
}

/* Power within the chord s that a lookup accepts. */
static double within(const double *values, const pm__probe *point, bool front_only, double s)
{
    const double rho = values[0], e = power(values) / (4.0 * pi), chord = fmin(s, 2.0);
    const double height = 0.5 * chord * chord; /* 1 - t */
    const double all = 2.0 * pi * e * height;
    if (!front_only)
        return all;
    return all - 0.5 * rho * (direct_on_caps(1.0 - height, point->position[0]) + pi * e * height * height);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (shape->shape != PM_LOOKUP_SPHERE)
        return NAN;
    return within(values, point, shape->front_only, r1) - within(values, point, shape->front_only, r0);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__light light = {.kind = PM__POINT, .power = {light_power, light_power, light_power},
                             .position = {offset, 0, 0}};
    return pm__scene_ball_room(scene, values[0], &light, error);
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
    .mass = mass,
    .build = build,
    .view = pm__ball_room_view,
};
