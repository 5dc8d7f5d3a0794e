/* Linear irradiance over the unit square: every radial kernel of fixed radius is unbiased on it.
 *
 * Truth. E = E0 (1 + g (x - 1/2)), positive for |g| < 2.
 * Photons. The integral over the square is E0. The marginal of x has the CDF (1 - g/2) x + (g/2) x^2 = u0, whose
 * root without cancellation is x = 2 u0 / (b + sqrt(b^2 + 2 g u0)), b = 1 - g/2; y = u1.
 * Theory. The mean over a ring inside the square is the value at its centre: mass = E pi (r1^2 - r0^2). */
#include "planar.h"

static const double pi = 3.14159265358979323846;

enum { IRRADIANCE, SLOPE };

static const pm__param params[] = {
    PM__PARAM_IRRADIANCE,
    {.name = "slope", .type = PM__REAL, .value = 1.0, .min = -1.9, .max = 1.9, .unit = "1/m",
     .help = "relative change along x"},
};

static const pm__region regions[] = {{"all", "at least 0.15 m from every side", false, false}};

static double irradiance(const double *values, double x, double y)
{
    (void)y;
    return values[IRRADIANCE] * (1.0 + values[SLOPE] * (x - 0.5));
}

static double power(const double *values)
{
    return values[IRRADIANCE];
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    const double slope = values[SLOPE], b = 1.0 - 0.5 * slope;
    const double x = 2.0 * u[0] / (b + sqrt(b * b + 2.0 * slope * u[0]));
    pm__photon_down(x, u[1], position, direction, normal);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    (void)region;
    pm__probe_rectangle(&pm__inset_square, u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return irradiance(values, point->position[0], point->position[1]);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (!pm__accepts_down(point, shape))
        return 0.0;
    if (pm__holds_disc(&pm__unit_square, point, r1))
        return truth(values, point) * pi * (r1 - r0) * (r1 + r0);
    return pm__mass_rectangle(irradiance, values, &pm__unit_square, point, r0, r1);
}

const pm__case pm__case_gradient = {
    .entry = {.name = "gradient",
              .summary = "irradiance that rises linearly across the unit square",
              .citation = "course 43, 5.5",
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
};
