/* Irradiance that waves along x: how much contrast an estimator keeps.
 *
 * Truth. E = E0 (1 + c cos kx) on the unit square, k = 2 pi cycles.
 * Photons. The integral over the square is E0 (1 + c sin(k) / k); the CDF of x is (x + c sin(kx) / k) over the same at
 * x = 1; y = u1.
 * Theory. The mean of cos kx over a disc of radius r is cos(kx) 2 J1(z) / z, z = kr, so a disc inside the square holds
 * E0 (pi r^2 + c cos(kx) 2 pi r J1(kr) / k). */
#include "planar.h"

static const double pi = 3.14159265358979323846;

enum { IRRADIANCE, CYCLES, CONTRAST };

static const pm__param params[] = {
    PM__PARAM_IRRADIANCE,
    {.name = "cycles", .type = PM__REAL, .value = 3.0, .min = 2.0, .max = 1000.0, .unit = "1/m",
     .help = "waves across the square"},
    {.name = "contrast", .type = PM__REAL, .value = 0.5, .min = 0.0, .max = 1.0, .unit = "",
     .help = "c in E = irradiance (1 + c cos kx)"},
};

enum { ALL, CREST, TROUGH };

static const pm__region regions[] = {
    {"all", "at least 0.15 m from every side", false, false},
    {"crest", "within 1/20 wave of a crest near the middle", false, false},
    {"trough", "within 1/20 wave of a trough near the middle", false, false},
};

static double wave_number(const double *values)
{
    return 2.0 * pi * values[CYCLES];
}

static double irradiance(const double *values, double x, double y)
{
    (void)y;
    return values[IRRADIANCE] * (1.0 + values[CONTRAST] * cos(wave_number(values) * x));
}

static double power(const double *values)
{
    const double k = wave_number(values);
    return values[IRRADIANCE] * (1.0 + values[CONTRAST] * sin(k) / k);
}

typedef struct wave {
    double k, contrast, target;
} wave;

static double wave_value(const void *context, double x, double *slope)
{
    const wave *const w = context;
    *slope = 1.0 + w->contrast * cos(w->k * x);
    return x + w->contrast * sin(w->k * x) / w->k - w->target;
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    const double k = wave_number(values), c = values[CONTRAST];
    const wave w = {k, c, u[0] * (1.0 + c * sin(k) / k)};
    /* |sin| <= 1 brackets the root. */
    const double low = fmax(0.0, w.target - c / k), high = fmin(1.0, w.target + c / k);
    const double guess = w.target - c * sin(k * w.target) / k;
    pm__photon_down(pm__increasing_root(wave_value, &w, low, high, guess), u[1], position, direction, normal);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const double cycles = values[CYCLES];
    pm__rectangle band = pm__inset_square;
    if (region != ALL) {
        const double middle = (region == CREST ? round(0.5 * cycles) : floor(0.5 * cycles) + 0.5) / cycles;
        band.x0 = middle - 0.05 / cycles;
        band.x1 = middle + 0.05 / cycles;
    }
    pm__probe_rectangle(&band, u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return irradiance(values, point->position[0], point->position[1]);
}

static double disc(const double *values, double x, double r)
{
    const double k = wave_number(values);
    return values[IRRADIANCE] * (pi * r * r + values[CONTRAST] * cos(k * x) * 2.0 * pi * r * j1(k * r) / k);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (!pm__accepts_down(point, shape))
        return 0.0;
    if (pm__holds_disc(&pm__unit_square, point, r1))
        return disc(values, point->position[0], r1) - disc(values, point->position[0], r0);
    const double step = 0.5 / values[CYCLES];
    double sum = 0.0;
    for (double a = r0; a < r1 && a < 1.5; a += step) /* no part of the square is farther than sqrt 2 */
        sum += pm__mass_rectangle(irradiance, values, &pm__unit_square, point, a, fmin(a + step, r1));
    return sum;
}

const pm__case pm__case_sinusoid = {
    .entry = {.name = "sinusoid",
              .summary = "irradiance that waves along x across the unit square",
              .citation = "Bracewell 2000, ch. 13 (Hankel transforms)",
              .params = params,
              .param_count = 3},
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
