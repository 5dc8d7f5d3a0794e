/* Sphere in parallel light: a curved surface with a terminator.
 *
 * Truth. Light of flux density E0 travels along -z: E = E0 max(0, cos theta), theta from the pole. The sphere of radius
 * a catches E0 pi a^2.
 * Photons. Uniform across the beam: a uniform point (x, y) of the disc of radius a, lifted to
 * z = sqrt(a^2 - x^2 - y^2).
 * Theory. What lies within the chord s of a probe at theta0 is a cap, bounded by a circle of radius
 * rho^2 = s^2 (1 - s^2 / (4 a^2)) in the plane a cos gamma = a - s^2 / (2 a) from the centre. The light that a patch
 * catches is E0 times the z component of its vector area, which depends on its boundary only. The lit part of the cap
 * is bounded by the part of that circle above z = 0 and the part of the terminator inside the cap, which share a chord;
 * so its vector area is that of two plane segments:
 *     of the cap's circle, beyond a chord at -c from its centre, c = a cos gamma / tan theta0:
 *         segment(rho, -c) cos theta0
 *     of the terminator's disc, beyond e = a cos gamma / sin theta0:
 *         segment(a, e)
 * with segment(R, d) = R^2 (acos(d/R) - d/R sqrt(1 - d^2/R^2)), d clamped to [-R, R], which covers caps that are all
 * lit, all dark, or hold the whole terminator; it is R^2 (x - sin x) / 2 with x = 2 acos(d/R).
 * All lit: E0 cos theta0 pi s^2 (1 - s^2 / (4 a^2)).
 * All photons travel along -z: a front-side filter accepts all for a normal with z > 0, none else. For other shapes of
 * lookup no formula is given. */
#include "planar.h"

static const double pi = 3.14159265358979323846;

enum { IRRADIANCE, RADIUS };

static const pm__param params[] = {
    PM__PARAM_IRRADIANCE,
    {.name = "radius", .type = PM__REAL, .value = 1.0, .min = 1e-3, .max = 1e3, .unit = "m", .help = "of the sphere"},
};

static const pm__region regions[] = {
    {"all", "the whole sphere", false, false},
    {"lit", "cos theta above 0.5", false, false},
    {"terminator", "cos theta within 0.1 of 0", false, false},
    {"dark", "cos theta below -0.2", false, false},
};

static const double probed[][2] = {{-1.0, 1.0}, {0.5, 1.0}, {-0.1, 0.1}, {-1.0, -0.2}}; /* cos theta */

static double power(const double *values)
{
    return values[IRRADIANCE] * pi * values[RADIUS] * values[RADIUS];
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    double point[2];
    pm__concentric(u, point);
    const double at[3] = {point[0], point[1], sqrt(fmax(0.0, 1.0 - point[0] * point[0] - point[1] * point[1]))};
    for (int i = 0; i < 3; i++) {
        normal[i] = at[i];
        position[i] = values[RADIUS] * at[i];
        direction[i] = i == 2 ? -1.0 : 0.0;
    }
}

/* Equal heights have equal areas. */
static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const double z = probed[region][0] + u[0] * (probed[region][1] - probed[region][0]);
    const double r = sqrt(fmax(0.0, 1.0 - z * z)), phi = 2.0 * pi * u[1];
    const double at[3] = {r * cos(phi), r * sin(phi), z};
    for (int i = 0; i < 3; i++) {
        point->normal[i] = at[i];
        point->position[i] = values[RADIUS] * at[i];
    }
}

static double truth(const double *values, const pm__probe *point)
{
    return values[IRRADIANCE] * fmax(0.0, point->normal[2]);
}

/* depth: 1 - d / radius. */
static double segment(double radius, double depth)
{
    const double angle = 4.0 * asin(sqrt(0.5 * fmin(fmax(depth, 0.0), 2.0))), a2 = angle * angle; /* 2 acos(d / R) */
    /* x - sin x, by its series where the difference cancels */
    const double rest = angle > 0.5 ? angle - sin(angle)
                                    : angle * a2 / 6.0 * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0 * (1.0 - a2 / 72.0 *
                                      (1.0 - a2 / 110.0))));
    return 0.5 * radius * radius * rest;
}

/* Power / E0 of the lit part of the cap within the chord. */
static double cap(double a, const double normal[3], double chord)
{
    const double s = fmin(chord / a, 2.0), rho = s * sqrt(1.0 - 0.25 * s * s); /* in radii */
    const double cosine = normal[2], sine = fmax(hypot(normal[0], normal[1]), 1e-300);
    const double tilted = (1.0 - 0.5 * s * s) * cosine / sine;
    const double rim = rho > 0.0 ? cosine * segment(rho, 1.0 + tilted / rho) : 0.0;
    /* 1 - cos gamma / sin theta0, where both are near 1 at the terminator */
    const double inside = (0.5 * s * s - cosine * cosine / (1.0 + sine)) / sine;
    return a * a * (rim + segment(1.0, inside));
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (shape->shape != PM_LOOKUP_SPHERE)
        return NAN;
    if (!pm__accepts_down(point, shape))
        return 0.0;
    const double a = values[RADIUS];
    return values[IRRADIANCE] * fmax(0.0, cap(a, point->normal, r1) - cap(a, point->normal, r0));
}

/* Filtered lookups on the dark side accept nothing and would walk the whole map. */
static double reach(const double *values)
{
    return 0.5 * values[RADIUS];
}

const pm__case pm__case_sphere = {
    .entry = {.name = "sphere",
              .summary = "sphere in parallel light",
              .citation = "Archimedes, On the Sphere and Cylinder I, 42-43",
              .params = params,
              .param_count = 2},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 2,
    .strata_dimensions = 2,
    .regions = regions,
    .region_count = sizeof regions / sizeof *regions,
    .aspect = pm__aspect_square,
    .power = power,
    .photon = photon,
    .probe = probe,
    .truth = truth,
    .mass = mass,
    .reach = reach,
};
