/* Prism: parallel light of 1 W/m2 straight down on the level face of a glass wedge, and what of it falls on a floor
 * below, band by band.
 *
 * Truth. The wedge lies under its face 0 <= x <= w at the height H, thicker toward x = w by tan A for each metre. Light
 * passes the level face straight on, meets the sloping one at the angle A at the height H - x tan A, and leaves it at
 * the angle t, sin t = n sin A, turned by d = t - A toward the thick side. It lands at
 *     x' = x + (H - x tan A) tan d,    dx'/dx = 1 - tan A tan d > 0  since  A + d = t < pi / 2:
 * a rectangle, evenly lit, with T1 and T2 of the two faces by
 *     E = E0 T1 T2 / (1 - tan A tan d).
 * The width of the beam shrinks by cos t / cos A and the floor is hit under the angle d: the same.
 * The indices of red, green and blue are 1.6 - D / 2, 1.6, 1.6 + D / 2; each band has a rectangle of its own.
 * Power. w l E0 T1 T2 of each band. Where indices differ a photon goes on in one band with the power of all three, so
 * the photons of a map have the sum of the bands between them, a share alike each; where indices are alike, what one
 * band has.
 * Theory. Where only red photons are near, those are as those of an evenly lit rectangle. */
#include "../planar.h"
#include "scene_case.h"

static const double pi = 3.14159265358979323846, beam = 1.0, middle_index = 1.6; /* W/m2, - */
static const double width = 0.1, length = 0.2, height = 5.0;                     /* m: w, l, H */

enum { ANGLE, DISPERSION, BANDS = 3 };

static const pm__param params[] = {
    {.name = "angle", .type = PM__REAL, .value = 30.0, .min = 5.0, .max = 35.0, .unit = "degree",
     .help = "of the wedge"},
    {.name = "dispersion", .type = PM__REAL, .value = 0.05, .min = 0.0, .max = 0.1, .unit = "",
     .help = "index of blue less that of red"},
};

enum { ALL, EDGE };

static const pm__region regions[] = {
    {"all", "the middle half of the red light, in x and y", false, false},
    {"edge", "within 0.01 m of the side of the red light that is away from green", false, false},
};

static double wedge(const double *values)
{
    return values[ANGLE] * pi / 180.0;
}

static double index_of(const double *values, int band)
{
    return middle_index + 0.5 * (band - 1) * values[DISPERSION];
}

/* A band's light on the floor. */
typedef struct patch {
    pm__rectangle area;
    double irradiance, power; /* W/m2, W */
} patch;

static patch patch_of(const double *values, int band)
{
    const double n = index_of(values, band), a = wedge(values), t = asin(n * sin(a)), turn = tan(t - a);
    const double passed = beam * pm__transmittance(1.0, n) * pm__transmittance(cos(t), n);
    const double shrink = 1.0 - tan(a) * turn, x = height * turn;
    return (patch){{x, x + width * shrink, -0.5 * length, 0.5 * length}, passed / shrink, passed * width * length};
}

static bool is_split(const double *values)
{
    return values[DISPERSION] > 0.0;
}

static double power(const double *values)
{
    double sum = 0.0;
    for (int band = 0; band < (is_split(values) ? BANDS : 1); band++)
        sum += patch_of(values, band).power;
    return sum;
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const pm__rectangle red = patch_of(values, 0).area;
    const double quarter = 0.25 * (red.x1 - red.x0), band = 0.01;
    const pm__rectangle area = {red.x0 + (region == EDGE ? -band : quarter),
                                region == EDGE ? red.x0 + band : red.x1 - quarter, -0.25 * length, 0.25 * length};
    pm__probe_rectangle(&area, u, point);
}

static void truth_bands(const double *values, const pm__probe *point, double truth[3])
{
    for (int band = 0; band < BANDS; band++) {
        const patch lit = patch_of(values, band);
        truth[band] = pm__is_upside(point) && pm__holds_disc(&lit.area, point, 0.0) ? lit.irradiance : 0.0;
    }
}

static double truth(const double *values, const pm__probe *point)
{
    double bands[BANDS];
    truth_bands(values, point, bands);
    return bands[0];
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const patch red = patch_of(values, 0);
    if (!pm__accepts_down(point, shape))
        return 0.0;
    for (int band = 1; band < BANDS && is_split(values); band++) {
        const patch other = patch_of(values, band);
        if (pm__shell_area(&other.area, point, 0.0, r1) > 0.0)
            return NAN;
    }
    return red.irradiance * pm__shell_area(&red.area, point, r0, r1);
}

/* The faces that light passes are exact; the triangles that close the ends are along all light from the lamp. */
static pm_status build_faces(const double *values, uint32_t glass, pm__scene *scene, pm_error *error)
{
    const double y = -0.5 * length, drop = width * tan(wedge(values));
    const double thin[3] = {0, y, height}, thick[3] = {width, y, height}, low[3] = {width, y, height - drop};
    const double along[3] = {0, length, 0}, across[3] = {width, 0, 0}, slope[3] = {width, 0, -drop};
    const double up[3] = {0, 0, drop};
    pm_status status = pm__scene_rectangle(scene, glass, thin, across, along, error);
    if (!status)
        status = pm__scene_rectangle(scene, glass, thin, along, slope, error);
    if (!status)
        status = pm__scene_rectangle(scene, glass, low, along, up, error);
    if (status)
        return status;
    static const uint32_t ends[2][3] = {{0, 2, 1}, {3, 4, 5}};
    float corners[6][3];
    for (int i = 0; i < 3; i++) {
        const double *const at[3] = {thin, thick, low};
        for (int c = 0; c < 3; c++) {
            corners[c][i] = (float)at[c][i];
            corners[3 + c][i] = (float)(at[c][i] + along[i]);
        }
    }
    return pm__scene_mesh(scene, glass, (const float(*)[3])corners, 6, ends, 2, error);
}

static pm_status build_prism(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material glass = {.kind = PM__GLASS,
                                .ior = {index_of(values, 0), index_of(values, 1), index_of(values, 2)}};
    uint32_t material = 0;
    const pm_status status = pm__scene_material(scene, &glass, &material, error);
    return status ? status : build_faces(values, material, scene, error);
}

/* Between the ends of red and blue. */
static double middle_of(const double *values)
{
    return 0.5 * (patch_of(values, 0).area.x0 + patch_of(values, BANDS - 1).area.x1);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double middle = middle_of(values), half = patch_of(values, BANDS - 1).area.x1 - middle + 0.25;
    const double radius = 0.51 * hypot(width, length), watts = beam * pi * radius * radius;
    const pm__light light = {.kind = PM__DIRECTIONAL, .power = {watts, watts, watts},
                             .position = {0.5 * width, 0, height + 1.0}, .direction = {0, 0, -1}, .radius = radius};
    pm_status status = build_prism(values, scene, error);
    if (!status)
        status = pm__scene_floor(scene, middle, half, 0.0, error);
    if (!status)
        status = pm__scene_light(scene, &light, error);
    return status;
}

static void view(const double *values, pm__view *from)
{
    const double middle = middle_of(values), half = patch_of(values, BANDS - 1).area.x1 - middle;
    const double away = 3.0 * fmax(half, 0.6 * length);
    *from = (pm__view){.eye = {middle, -0.5 * away, away}, .at = {middle, 0, 0}, .up = {0, 1, 0}, .angle = 0.65};
}

const pm__case pm__case_scene_prism = {
    .entry = {.name = "scene:prism",
              .summary = "parallel light of 1 W/m2 through a glass wedge that bends its bands apart",
              .citation = "Newton 1704",
              .params = params,
              .param_count = 2},
    .paths = "LSSD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = regions,
    .region_count = sizeof regions / sizeof *regions,
    .power = power,
    .probe = probe,
    .truth = truth,
    .mass = mass,
    .build = build,
    .view = view,
    .truth_bands = truth_bands,
};
