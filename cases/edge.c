/* Step edge: light on one half of the unit square.
 *
 * Truth. E = E0 for x < 1/2, E0 * dark beyond.
 * Photons. Power E0 (1 + dark) / 2; the CDF of x is linear on either half; y = u1.
 * Theory. The areas of the disc on either side: next to the edge, at distance q r from it, a disc estimate on the lit
 * side is E0 (f + (1 - f) dark), f = 1 - (acos q - q sqrt(1 - q^2)) / pi, and on the dark side the same with 1 - f. */
#include "planar.h"

enum { IRRADIANCE, DARK };

static const pm__param params[] = {
    PM__PARAM_IRRADIANCE,
    {.name = "dark", .type = PM__REAL, .value = 0.0, .min = 0.0, .max = 1.0, .unit = "",
     .help = "irradiance of the dark half over that of the lit one"},
};

static const pm__region regions[] = {
    {"all", "at least 0.15 m from every side", false, false},
    {"lit", "within 0.05 m of the edge, lit side", false, false},
    {"dark", "within 0.05 m of the edge, dark side", false, false},
    {"far", "lit, at least 0.15 m from the edge and the sides", true, true},
};

static const pm__rectangle probed[] = {
    {0.15, 0.85, 0.15, 0.85}, {0.45, 0.5, 0.15, 0.85}, {0.5, 0.55, 0.15, 0.85}, {0.15, 0.35, 0.15, 0.85}};

static const pm__rectangle lit_half = {0.0, 0.5, 0.0, 1.0}, dark_half = {0.5, 1.0, 0.0, 1.0};

/* Cells are square on the lit half. */
static void aspect(const double *values, double ratio[2])
{
    ratio[0] = ratio[1] = 0.5 * (1.0 + values[DARK]);
}

static double power(const double *values)
{
    return values[IRRADIANCE] * 0.5 * (1.0 + values[DARK]);
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    const double dark = values[DARK], x = 0.5 * u[0] * (1.0 + dark);
    pm__photon_down(x < 0.5 ? x : 0.5 + (x - 0.5) / dark, u[1], position, direction, normal);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    pm__probe_rectangle(&probed[region], u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return values[IRRADIANCE] * (point->position[0] < 0.5 ? 1.0 : values[DARK]);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (!pm__accepts_down(point, shape))
        return 0.0;
    return values[IRRADIANCE] *
           (pm__shell_area(&lit_half, point, r0, r1) + values[DARK] * pm__shell_area(&dark_half, point, r0, r1));
}

const pm__case pm__case_edge = {
    .entry = {.name = "edge",
              .summary = "step edge between a lit and a dark half of the unit square",
              .citation = "course 43, 5.5.3",
              .params = params,
              .param_count = 2},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 2,
    .strata_dimensions = 2,
    .regions = regions,
    .region_count = sizeof regions / sizeof *regions,
    .aspect = aspect,
    .power = power,
    .photon = photon,
    .probe = probe,
    .truth = truth,
    .mass = mass,
};
