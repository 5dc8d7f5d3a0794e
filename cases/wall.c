/* Thin wall lit on one side: light that leaks to the other.
 *
 * Truth. A square slab of thickness t; parallel light falls on its face z = 0 (normal +z), E0 there. The face z = -t
 * (normal -z) gets none.
 * Photons. x = u0, y = u1, on the lit face.
 * Theory. On the lit side as the square under parallel light. A probe on the dark side sees the lit face at height t:
 *     sphere:     a disc of radius sqrt(r^2 - t^2);
 *     ellipsoid:  the height counts S times: sqrt(r^2 - S^2 t^2);
 *     disc:       the disc of radius r where H >= t, else nothing;
 * and nothing at all with a front-side filter. */
#include "shared.h"

enum { IRRADIANCE, THICKNESS };

const pm__param pm__wall_params[PM__WALL_PARAMS] = {
    PM__PARAM_IRRADIANCE,
    {.name = "thickness", .type = PM__REAL, .value = 0.001, .min = 1e-6, .max = 0.1, .unit = "m",
     .help = "of the wall"},
};

enum { ALL, LIT, DARK };

const pm__region pm__wall_regions[PM__WALL_REGIONS] = {
    {"all", "both sides, at least 0.15 m from the edges", false, false},
    {"lit", "the lit side of it", true, true},
    {"dark", "the dark side of it", false, false},
};

double pm__wall_power(const double *values)
{
    return values[IRRADIANCE];
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    (void)values;
    pm__photon_down(u[0], u[1], position, direction, normal);
}

void pm__wall_probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    pm__probe_rectangle(&pm__inset_square, u, point);
    if (region == DARK || (region == ALL && u[2] >= 0.5)) {
        point->position[2] = -values[THICKNESS];
        point->normal[2] = -1.0;
    }
}

double pm__wall_truth(const double *values, const pm__probe *point)
{
    return point->normal[2] > 0.0 ? values[IRRADIANCE] : 0.0;
}

/* The radius on the lit face of what lies within r in the lookup's metric. */
static double face_radius(const pm__probe *point, const pm__shape *shape, double r)
{
    const double height = fabs(point->position[2]);
    if (shape->shape == PM_LOOKUP_DISC)
        return height <= shape->parameter ? r : 0.0;
    const double counted = shape->shape == PM_LOOKUP_ELLIPSOID ? shape->parameter * height : height;
    return sqrt(fmax(0.0, (r - counted) * (r + counted)));
}

double pm__wall_mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    if (!pm__accepts_down(point, shape))
        return 0.0;
    return values[IRRADIANCE] * pm__shell_area(&pm__unit_square, point, face_radius(point, shape, r0),
                                               face_radius(point, shape, r1));
}

/* Filtered lookups on the dark side accept nothing and would walk the whole map. */
double pm__wall_reach(const double *values)
{
    (void)values;
    return 0.2;
}

const pm__case pm__case_wall = {
    .entry = {.name = "wall",
              .summary = "thin wall lit on one side",
              .citation = "course 43, 2.1.3",
              .params = pm__wall_params,
              .param_count = PM__WALL_PARAMS},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 2,
    .strata_dimensions = 2,
    .regions = pm__wall_regions,
    .region_count = PM__WALL_REGIONS,
    .aspect = pm__aspect_square,
    .power = pm__wall_power,
    .photon = photon,
    .probe = pm__wall_probe,
    .truth = pm__wall_truth,
    .mass = pm__wall_mass,
    .reach = pm__wall_reach,
};
