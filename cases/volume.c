/* Uniform ball of a medium: the estimate in three dimensions, with a boundary.
 *
 * Truth. Flux density F everywhere in a ball of radius 1 m.
 * Photons. Uniform in the ball, cut into boxes by x, then y, then z, so that strata are boxes that are near cubes in
 * the middle. The CDF of x is 1/2 + (3x - x^3) / 4, solved by x = 2 sin(asin(2 u0 - 1) / 3). Across the slice of radius
 * q = sqrt(1 - x^2), y = q sin t has the CDF 1/2 + (2t + sin 2t) / (2 pi). z is uniform along the chord. In the middle
 * dx : dy : dz = 4/3 : pi/2 : 2 for equal steps of u.
 * Theory. A ball around the probe holds F times the volume common to both balls. For the other shapes of lookup no
 * formula is given. Directions mean nothing here: all photons travel along -z, all probes face +z. */
#include "planar.h"

static const double pi = 3.14159265358979323846;

enum { DENSITY };

static const pm__param params[] = {
    {.name = "density", .type = PM__REAL, .value = 1.0, .min = 1e-6, .max = 1e6, .unit = "W/m3",
     .help = "flux density in the ball"},
};

static const pm__region regions[] = {
    {"all", "the whole ball of radius 1 m", true, false},
    {"interior", "at least 0.3 m from the boundary", true, true},
    {"boundary", "within 0.1 m of the boundary", true, false},
};

static const double probed[][2] = {{0.0, 1.0}, {0.0, 0.7}, {0.9, 1.0}}; /* radii */

static void aspect(const double *values, double ratio[2])
{
    (void)values;
    ratio[0] = 4.0 / 3.0 / (0.5 * pi);
    ratio[1] = 4.0 / 3.0 / 2.0;
}

static double power(const double *values)
{
    return values[DENSITY] * 4.0 / 3.0 * pi;
}

static double slice_value(const void *context, double t, double *slope)
{
    const double *const target = context;
    *slope = 2.0 + 2.0 * cos(2.0 * t);
    return 2.0 * t + sin(2.0 * t) - *target;
}

/* y in the unit disc from u. At the rim 2t + sin 2t = pi - 4/3 (pi/2 - t)^3 + ..., where Newton starts from. */
static double slice(double u)
{
    const double target = pi * (2.0 * u - 1.0);
    const double guess = copysign(0.5 * pi - cbrt(0.75 * (pi - fabs(target))), target);
    return sin(pm__increasing_root(slice_value, &target, -0.5 * pi, 0.5 * pi, guess));
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    (void)values;
    const double x = 2.0 * sin(asin(2.0 * u[0] - 1.0) / 3.0);
    const double y = sqrt(fmax(0.0, 1.0 - x * x)) * slice(u[1]);
    pm__photon_down(x, y, position, direction, normal);
    position[2] = (2.0 * u[2] - 1.0) * sqrt(fmax(0.0, 1.0 - x * x - y * y));
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    const double a = probed[region][0], b = probed[region][1];
    const double r = cbrt(a * a * a + u[0] * (b * b * b - a * a * a));
    const double cosine = 1.0 - 2.0 * u[1], phi = 2.0 * pi * u[2];
    const double across = r * sqrt(fmax(0.0, 1.0 - cosine * cosine));
    *point = (pm__probe){.position = {across * cos(phi), across * sin(phi), r * cosine}, .normal = {0.0, 0.0, 1.0}};
}

static double truth(const double *values, const pm__probe *point)
{
    (void)point;
    return values[DENSITY];
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (shape->shape != PM_LOOKUP_SPHERE)
        return NAN;
    if (!pm__accepts_down(point, shape))
        return 0.0;
    const double d = sqrt(pm__dot(point->position, point->position));
    return values[DENSITY] * (pm__ball_ball_volume(1.0, r1, d) - pm__ball_ball_volume(1.0, r0, d));
}

const pm__case pm__case_volume = {
    .entry = {.name = "volume",
              .summary = "uniform ball of a medium: the estimate in three dimensions",
              .citation = "course 43, 2.3.3",
              .params = params,
              .param_count = 1},
    .paths = "LV",
    .dimensions = 3,
    .sample_dimensions = 3,
    .strata_dimensions = 3,
    .regions = regions,
    .region_count = sizeof regions / sizeof *regions,
    .aspect = aspect,
    .power = power,
    .photon = photon,
    .probe = probe,
    .truth = truth,
    .mass = mass,
};
