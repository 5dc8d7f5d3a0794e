/* Isotropic point light over an infinite plane.
 *
 * Truth. Power P at height h: intensity P / (4 pi), cos / d^2 = h / d^3 at d^2 = h^2 + rho^2, so
 * E = P h / (4 pi (h^2 + rho^2)^(3/2)).
 * Photons. All of the lower hemisphere lands: power P / 2. Within rho of the foot falls the fraction
 * v = 1 - h / sqrt(h^2 + rho^2), so rho = h sqrt(v (2 - v)) / (1 - v). u is carried to a disc area for area, whose
 * radius squared is v: cells stay near square. v is held below 1 - 1e-9, that is rho below 1e9 h, which keeps positions
 * finite in single precision and touches one photon in 1e9.
 * Theory. Quadrature; in the foot a disc holds P v / 2. */
#include "shared.h"

static const double pi = 3.14159265358979323846;

enum { POWER, HEIGHT };

const pm__param pm__point_light_params[PM__POINT_LIGHT_PARAMS] = {
    {.name = "power", .type = PM__REAL, .value = 1.0, .min = 1e-6, .max = 1e6, .unit = "W",
     .help = "of the light in all directions"},
    {.name = "height", .type = PM__REAL, .value = 1.0, .min = 1e-3, .max = 1e3, .unit = "m",
     .help = "of the light over the plane"},
};

const pm__region pm__point_light_regions[PM__POINT_LIGHT_REGIONS] = {
    {"all", "within 2 heights of the foot", false, false},
    {"foot", "within 0.25 heights of the foot", false, false},
    {"far", "1.5 to 2 heights from the foot", false, false},
};

static const double probed[][2] = {{0.0, 2.0}, {0.0, 0.25}, {1.5, 2.0}}; /* radii in heights */

static const pm__rectangle plane = {-INFINITY, INFINITY, -INFINITY, INFINITY};

double pm__point_light_irradiance(const double *values, double x, double y)
{
    const double h = values[HEIGHT], d2 = h * h + x * x + y * y;
    return values[POWER] * h / (4.0 * pi * d2 * sqrt(d2));
}

static double power(const double *values)
{
    return 0.5 * values[POWER];
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    double point[2];
    pm__concentric(u, point);
    const double v = fmin(point[0] * point[0] + point[1] * point[1], 1.0 - 1e-9);
    /* rho / radius in the disc, with the radius divided out of sqrt(v) */
    const double stretch = values[HEIGHT] * sqrt(2.0 - v) / (1.0 - v);
    pm__photon_down(point[0] * stretch, point[1] * stretch, position, direction, normal);
    direction[0] = position[0];
    direction[1] = position[1];
    direction[2] = -values[HEIGHT];
    pm__normalize(direction);
}

void pm__point_light_probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const double h = values[HEIGHT];
    pm__probe_ring(0.0, 0.0, probed[region][0] * h, probed[region][1] * h, u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return pm__point_light_irradiance(values, point->position[0], point->position[1]);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (!pm__accepts_down(point, shape))
        return 0.0;
    return pm__mass_rectangle(pm__point_light_irradiance, values, &plane, point, r0, r1);
}

const pm__case pm__case_point_light = {
    .entry = {.name = "point-light",
              .summary = "isotropic point light over an infinite plane",
              .citation = "Lambert 1760",
              .params = pm__point_light_params,
              .param_count = PM__POINT_LIGHT_PARAMS},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 2,
    .strata_dimensions = 2,
    .regions = pm__point_light_regions,
    .region_count = PM__POINT_LIGHT_REGIONS,
    .aspect = pm__aspect_square,
    .power = power,
    .photon = photon,
    .probe = pm__point_light_probe,
    .truth = truth,
    .mass = mass,
};
