/* Unit square under parallel light from straight above: Christensen's experiment ([C02] 5.5.1).
 *
 * Truth. Light of flux density E0 across its direction meets the plane head on: E = E0 everywhere.
 * Photons. x = u0, y = u1.
 * Theory. The photons within r of a probe carry E0 times the area of the disc of radius r inside the square. All
 * lie in the plane of the probe, so each shape of lookup measures the same distance. At distance q r from one side,
 * the fraction inside is 1 - (acos q - q sqrt(1 - q^2)) / pi; its mean over the square is
 * 1 - 8r/(3 pi) + r^2/(2 pi). */
#include "planar.h"

enum { IRRADIANCE };

static const pm__param params[] = {PM__PARAM_IRRADIANCE};

enum { ALL, INTERIOR, EDGE, CORNER };

static const pm__region regions[] = {
    {"all", "the whole square", true, false},
    {"interior", "at least 0.15 m from every side", true, true},
    {"edge", "within 0.05 m of one side, at least 0.15 m from the two beside it", true, false},
    {"corner", "within 0.05 m of two sides", true, false},
};

static double power(const double *values)
{
    return values[IRRADIANCE];
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    (void)values;
    pm__photon_down(u[0], u[1], position, direction, normal);
}

/* The band along one of the four sides, or one of the four corners. */
static pm__rectangle part(size_t region, double which)
{
    const int side = (int)(4.0 * which);
    const double low = side & 1 ? 0.95 : 0.0;
    if (region == CORNER) {
        const double below = side & 2 ? 0.95 : 0.0;
        return (pm__rectangle){low, low + 0.05, below, below + 0.05};
    }
    return side & 2 ? (pm__rectangle){low, low + 0.05, 0.15, 0.85} : (pm__rectangle){0.15, 0.85, low, low + 0.05};
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    const pm__rectangle band = region == ALL        ? pm__unit_square
                               : region == INTERIOR ? pm__inset_square
                                                    : part(region, u[2]);
    pm__probe_rectangle(&band, u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    (void)point;
    return values[IRRADIANCE];
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    return pm__accepts_down(point, shape) ? values[IRRADIANCE] * pm__shell_area(&pm__unit_square, point, r0, r1) : 0.0;
}

const pm__case pm__case_square = {
    .entry = {.name = "square",
              .summary = "unit square under parallel light",
              .citation = "course 43, 5.5.1",
              .params = params,
              .param_count = 1},
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
