/* Gaussian spot of light on the unit square.
 *
 * Truth. E = E0 exp(-rho^2 / (2 s^2)), rho the distance from the centre.
 * Photons. x and y are independent, each a Gaussian cut at +-1/2: with c = erf(1 / (2 sqrt2 s)) the CDF of x from the
 * centre is 1/2 + erf(x / (sqrt2 s)) / (2 c), and the power E0 (s sqrt(2 pi) c)^2.
 * Theory. No closed form off the centre: quadrature, in rings not much wider than s. At the centre a disc inside the
 * square holds 2 pi E0 s^2 (1 - exp(-r^2 / (2 s^2))). */
#include "planar.h"

static const double pi = 3.14159265358979323846;

enum { IRRADIANCE, SIGMA };

static const pm__param params[] = {
    PM__PARAM_IRRADIANCE,
    {.name = "sigma", .type = PM__REAL, .value = 0.1, .min = 0.01, .max = 0.3, .unit = "m",
     .help = "standard deviation of the spot"},
};

enum { ALL, PEAK, FLANK };

static const pm__region regions[] = {
    {"all", "at least 0.15 m from every side", false, false},
    {"peak", "within half a sigma of the centre", false, false},
    {"flank", "0.75 to 1.25 sigma from the centre", false, false},
};

static double irradiance(const double *values, double x, double y)
{
    const double dx = (x - 0.5) / values[SIGMA], dy = (y - 0.5) / values[SIGMA];
    return values[IRRADIANCE] * exp(-0.5 * (dx * dx + dy * dy));
}

static double power(const double *values)
{
    const double s = values[SIGMA], c = erf(0.5 * sqrt(0.5) / s);
    return values[IRRADIANCE] * 2.0 * pi * s * s * c * c;
}

static double erf_value(const void *context, double t, double *slope)
{
    const double *const target = context;
    *slope = 2.0 / sqrt(pi) * exp(-t * t);
    return erf(t) - *target;
}

/* The inverse of erf, from a start within 2e-3 of it (Winitzki 2008), in [-high, high]. */
static double erf_inverse(double y, double high)
{
    const double a = 0.147, l = log1p(-y * y), b = 2.0 / (pi * a) + 0.5 * l;
    const double guess = copysign(sqrt(fmax(0.0, sqrt(b * b - l / a) - b)), y);
    return pm__increasing_root(erf_value, &y, -high, high, fmin(fmax(guess, -high), high));
}

static double coordinate(double sigma, double u)
{
    const double high = 0.5 * sqrt(0.5) / sigma;
    return 0.5 + sqrt(2.0) * sigma * erf_inverse((2.0 * u - 1.0) * erf(high), high);
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    const double s = values[SIGMA];
    pm__photon_down(coordinate(s, u[0]), coordinate(s, u[1]), position, direction, normal);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const double s = values[SIGMA];
    if (region == ALL)
        pm__probe_rectangle(&pm__inset_square, u, point);
    else if (region == PEAK)
        pm__probe_ring(0.5, 0.5, 0.0, 0.5 * s, u, point);
    else
        pm__probe_ring(0.5, 0.5, 0.75 * s, 1.25 * s, u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return irradiance(values, point->position[0], point->position[1]);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (!pm__accepts_down(point, shape))
        return 0.0;
    const double step = 2.0 * values[SIGMA];
    double sum = 0.0;
    for (double a = r0; a < r1 && a < 1.5; a += step) /* no part of the square is farther than sqrt 2 */
        sum += pm__mass_rectangle(irradiance, values, &pm__unit_square, point, a, fmin(a + step, r1));
    return sum;
}

const pm__case pm__case_blob = {
    .entry = {.name = "blob",
              .summary = "Gaussian spot of light on the unit square",
              .citation = "Silverman 1986, 4.2",
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
