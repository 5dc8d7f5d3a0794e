/* Irradiance with a constant Laplacian, so the same bias everywhere.
 *
 * Truth. E = E0 (1 + a rho^2), rho the distance from the centre of the unit square; Laplacian 4 a E0.
 * Photons. With x, y from the centre: the integral over y is E0 (1 + a/12 + a x^2), over both E0 (1 + a/6). The
 * marginal CDF of x and the conditional one of y are both of the form p (t + 1/2) + q (t^3 + 1/8), increasing.
 * Theory. The mean of rho^2 over a ring around rho0 is rho0^2 + (r0^2 + r1^2) / 2, so a ring inside the square holds
 * pi (r1^2 - r0^2) (E + E0 a (r0^2 + r1^2) / 2): a kernel of radius R and second moment m2 errs by E0 a R^2 m2. */
#include "planar.h"

static const double pi = 3.14159265358979323846;

enum { IRRADIANCE, CURVATURE };

static const pm__param params[] = {
    PM__PARAM_IRRADIANCE,
    {.name = "curvature", .type = PM__REAL, .value = 20.0, .min = 0.0, .max = 1e4, .unit = "1/m2",
     .help = "a in E = irradiance (1 + a rho^2)"},
};

enum { ALL, CENTRE };

static const pm__region regions[] = {
    {"all", "at least 0.15 m from every side", false, false},
    {"centre", "within 0.05 m of the centre", false, false},
};

static double irradiance(const double *values, double x, double y)
{
    const double dx = x - 0.5, dy = y - 0.5;
    return values[IRRADIANCE] * (1.0 + values[CURVATURE] * (dx * dx + dy * dy));
}

static double power(const double *values)
{
    return values[IRRADIANCE] * (1.0 + values[CURVATURE] / 6.0);
}

/* p (t + 1/2) + q (t^3 + 1/8) - target */
typedef struct cubic {
    double p, q, target;
} cubic;

static double cubic_value(const void *context, double t, double *slope)
{
    const cubic *const c = context;
    *slope = c->p + 3.0 * c->q * t * t;
    return c->p * (t + 0.5) + c->q * (t * t * t + 0.125) - c->target;
}

static double cubic_root(double p, double q, double u)
{
    const cubic c = {p, q, u * (p + 0.25 * q)};
    return pm__increasing_root(cubic_value, &c, -0.5, 0.5, u - 0.5);
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    const double a = values[CURVATURE];
    const double x = cubic_root(1.0 + a / 12.0, a / 3.0, u[0]);
    const double y = cubic_root(1.0 + a * x * x, a / 3.0, u[1]);
    pm__photon_down(0.5 + x, 0.5 + y, position, direction, normal);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    if (region == ALL)
        pm__probe_rectangle(&pm__inset_square, u, point);
    else
        pm__probe_ring(0.5, 0.5, 0.0, 0.05, u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return irradiance(values, point->position[0], point->position[1]);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (!pm__accepts_down(point, shape))
        return 0.0;
    if (!pm__holds_disc(&pm__unit_square, point, r1))
        return pm__mass_rectangle(irradiance, values, &pm__unit_square, point, r0, r1);
    const double mean = truth(values, point) + 0.5 * values[IRRADIANCE] * values[CURVATURE] * (r0 * r0 + r1 * r1);
    return mean * pi * (r1 - r0) * (r1 + r0);
}

const pm__case pm__case_quadratic = {
    .entry = {.name = "quadratic",
              .summary = "irradiance that grows with the square of the distance from the centre",
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
