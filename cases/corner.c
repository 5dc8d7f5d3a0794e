/* Inside corner: a floor lit from above and a wall lit from the side, each by its own parallel light.
 *
 * Truth. Floor z = 0 and wall x = 0, both unit squares (y in [0, 1]). Light straight down gives the floor E1, light
 * along -x gives the wall E2; neither light reaches the other surface. Probes are on the floor: truth E1.
 * Photons. The two squares are laid side by side, wall first: s = u0 (E1 + E2) - E2 is on the wall at height -s / E2
 * where negative, else on the floor at x = s / E1; y = u1.
 * Theory. The floor gives E1 times the area of a disc in the square. The wall's points at distance (x, dy, z) are
 *     sphere:     dy^2 + z^2 <= r^2 - x^2, a half disc: E2 pi (r^2 - x^2) / 2 away from the wall's sides;
 *     ellipsoid:  the same in S z, so its area over S;
 *     disc:       |dy| <= sqrt(r^2 - x^2) and z <= H, a strip.
 * The wall's photons travel across the floor's normal, so a front-side filter rejects them. */
#include "shared.h"

enum { FLOOR, WALL };

static const pm__param params[] = {
    PM__PARAM_IRRADIANCE,
    {.name = "wall", .type = PM__REAL, .value = 1.0, .min = 0.0, .max = 1e6, .unit = "W/m2",
     .help = "irradiance of the wall"},
};

const pm__region pm__corner_regions[PM__CORNER_REGIONS] = {
    {"all", "the floor, at least 0.15 m from its sides but for the wall", false, false},
    {"near", "within 0.05 m of the wall", false, false},
    {"far", "at least 0.15 m from the wall and every side", true, true},
};

static const pm__rectangle probed[] = {{0.0, 0.85, 0.15, 0.85}, {0.0, 0.05, 0.15, 0.85}, {0.15, 0.85, 0.15, 0.85}};

/* Cells are square on the brighter surface. */
static void aspect(const double *values, double ratio[2])
{
    ratio[0] = ratio[1] = (values[FLOOR] + values[WALL]) / fmax(values[FLOOR], values[WALL]);
}

static double power(const double *values)
{
    return values[FLOOR] + values[WALL];
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    const double s = u[0] * (values[FLOOR] + values[WALL]) - values[WALL];
    if (s >= 0.0) {
        pm__photon_down(s / values[FLOOR], u[1], position, direction, normal);
        return;
    }
    const double at[3] = {0.0, u[1], -s / values[WALL]};
    for (int i = 0; i < 3; i++) {
        position[i] = at[i];
        normal[i] = i == 0 ? 1.0 : 0.0;
        direction[i] = i == 0 ? -1.0 : 0.0;
    }
}

void pm__corner_probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    pm__probe_rectangle(&probed[region], u, point);
}

static double truth(const double *values, const pm__probe *point)
{
    return point->normal[2] > 0.5 ? values[FLOOR] : values[WALL];
}

double pm__corner_wall_area(const pm__probe *point, const pm__shape *shape, double r)
{
    const double x = point->position[0], y = point->position[1];
    const double reach2 = (r - x) * (r + x);
    if (!(reach2 > 0.0))
        return 0.0;
    const double reach = sqrt(reach2);
    if (shape->shape == PM_LOOKUP_DISC)
        return (fmin(1.0, y + reach) - fmax(0.0, y - reach)) * fmin(1.0, shape->parameter);
    const double squash = shape->shape == PM_LOOKUP_ELLIPSOID ? shape->parameter : 1.0;
    return pm__disc_rectangle_area(y, 0.0, reach, 0.0, 1.0, 0.0, squash) / squash;
}

/* For probes on the floor. */
static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const double floor_part = values[FLOOR] * pm__shell_area(&pm__unit_square, point, r0, r1);
    if (shape->front_only)
        return floor_part;
    return floor_part +
           values[WALL] * (pm__corner_wall_area(point, shape, r1) - pm__corner_wall_area(point, shape, r0));
}

const pm__case pm__case_corner = {
    .entry = {.name = "corner",
              .summary = "inside corner of a floor and a wall, each lit by its own parallel light",
              .citation = "course 43, 2.3.1 and Fig. 2.8",
              .params = params,
              .param_count = 2},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 2,
    .strata_dimensions = 2,
    .regions = pm__corner_regions,
    .region_count = PM__CORNER_REGIONS,
    .aspect = aspect,
    .power = power,
    .photon = photon,
    .probe = pm__corner_probe,
    .truth = truth,
    .mass = mass,
};
