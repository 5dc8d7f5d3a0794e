/* Nephroid: the caustic of parallel light in a mirror half cylinder, x >= 0, of radius 1 on the floor z = 0. Light
 * travels along (cos a, 0, -sin a), comes in by the open side and is reflected once.
 *
 * Truth. At the wall's point (cos th, sin th), |th| < pi / 2, the plan direction (1, 0) is turned to
 * -(cos 2th, sin 2th). Light that meets the wall at the height z lands after the plan distance s = z cot a, at
 *     P = (cos th - s cos 2th, sin th - s sin 2th).
 * The wall's dth dz = dth ds tan a catches E0 cos a cos th dth dz, and |dP/dth x dP/ds| = |cos th - 2 s|: with
 * Ef = E0 sin a, the direct irradiance of the floor,
 *     E = Ef sum of cos th / |cos th - 2 s|,   over th with  sin th - x sin 2th + y cos 2th = 0,
 * 0 < s <= height cot a, and s <= 2 cos th, the chord, where that ends in the mirror: light leaves by the open side
 * only if |th| < pi / 6 (see Power). Fold: s = cos th / 2, the curve cos th (1/2 + sin^2 th), sin^3 th; cusp (1/2, 0).
 * The wall must be as high as 2 tan a, so that no floor point lacks light from above its edge.
 * Power. The chord from th ends at the angle 3 th + pi: in the open side for |th| < pi / 6, so that all of the wall's
 * light lands; else in the mirror, and only light from below 2 cos th tan a lands first. With integral of cos^2
 * from pi / 6 to pi / 2 = pi / 6 - sqrt(3) / 8:
 *     E0 (height cos a + 4 sin a (pi / 6 - sqrt(3) / 8)).
 * The floor reaches as far as light can land.
 * Theory. Ef cos th dth ds is what falls on dth ds, so on a chord of the reflected ray falls Ef cos th times its
 * length. Rays land in all of a disc that lies within the circle and, where x < 0, between y = -1 and 1. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846, beam = 1.0; /* W/m2 */

enum { ELEVATION, HEIGHT, CELLS = 128 };

static const pm__param params[] = {
    {.name = "elevation", .type = PM__REAL, .value = 45.0, .min = 10.0, .max = 80.0, .unit = "degree",
     .help = "of the light over the horizon"},
    {.name = "height", .type = PM__REAL, .value = 2.0, .min = 0.1, .max = 20.0, .unit = "m",
     .help = "of the wall; at least 2 tan(elevation)"},
};

enum { ALL, INSIDE, FOLD, CUSP };

static const pm__region regions[] = {
    {"all", "x from -0.6 to 0.4 m, |y| below 0.6 m: one reflection reaches it", false, false},
    {"inside", "x from 0.78 to 0.9 m, |y| below 0.2 m: three reflections reach it", false, false},
    {"fold", "x from 0.62 to 0.78 m, y from 0.25 to 0.45 m: across the fold", false, false},
    {"cusp", "within 0.05 m of the cusp", false, false},
};

static const pm__rectangle probed[] = {{-0.6, 0.4, -0.6, 0.6}, {0.78, 0.9, -0.2, 0.2}, {0.62, 0.78, 0.25, 0.45}};

static double elevation(const double *values)
{
    return values[ELEVATION] * pi / 180.0;
}

static pm_status resolve(double *values, pm_error *error)
{
    const double least = 2.0 * tan(elevation(values));
    if (values[HEIGHT] < least * (1.0 - 1e-12)) /* tan 45 degrees rounds */
        return pm__fail(error, PM_EINVAL, "scene:nephroid: height=%g: at elevation %g the wall must be %g m or higher",
                        values[HEIGHT], values[ELEVATION], least);
    return PM_OK;
}

static double power(const double *values)
{
    const double a = elevation(values);
    return beam * (values[HEIGHT] * cos(a) + 4.0 * sin(a) * (pi / 6.0 - sqrt(3.0) / 8.0));
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    if (region == CUSP)
        pm__probe_ring(0.5, 0.0, 0.0, 0.05, u, point);
    else
        pm__probe_rectangle(&probed[region], u, point);
}

static double miss(const void *context, double th)
{
    const double *const at = context;
    return sin(th) - at[0] * sin(2.0 * th) + at[1] * cos(2.0 * th);
}

static double truth(const double *values, const pm__probe *point)
{
    const double *const at = point->position, a = elevation(values);
    double roots[PM__MOST_ROOTS], sum = 0.0;
    if (!pm__is_upside(point))
        return 0.0;
    const size_t count = pm__roots(miss, at, -0.5 * pi, 0.5 * pi, CELLS, roots);
    for (size_t i = 0; i < count; i++) {
        const double th = roots[i];
        const double s = (cos(th) - at[0]) * cos(2.0 * th) + (sin(th) - at[1]) * sin(2.0 * th);
        const bool leaves = fabs(th) < pi / 6.0 || s <= 2.0 * cos(th);
        if (s > 0.0 && s * tan(a) <= values[HEIGHT] && leaves)
            sum += cos(th) / fabs(cos(th) - 2.0 * s);
    }
    return beam * sin(a) * sum;
}

typedef struct disc {
    const double *values, *at;
} disc;

static double sheet_miss(const void *context, double th, double *slope)
{
    const double *const at = ((const disc *)context)->at;
    *slope = cos(th) - 2.0 * (at[0] * cos(2.0 * th) + at[1] * sin(2.0 * th));
    return miss(at, th);
}

static double strip(const void *context, double th, double half)
{
    (void)context;
    return 2.0 * half * cos(th);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const double *const at = point->position, a = elevation(values);
    const disc d = {values, at};
    const pm__sheets sheets = {sheet_miss, strip, -0.5 * pi, 0.5 * pi};
    if (!pm__accepts_down(point, shape))
        return 0.0;
    const bool within = hypot(at[0], at[1]) + r1 < 1.0 || hypot(fmax(0.0, at[0] + r1), fabs(at[1]) + r1) < 1.0;
    /* no light comes from farther than the ends of the disc are from the wall's far point */
    if (!within || hypot(1.0 - at[0], at[1]) + r1 > values[HEIGHT] / tan(a))
        return NAN;
    return beam * sin(a) * pm__mass_sheets(&sheets, &d, r0, r1);
}

static pm_status build_wall(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material mirror = {.kind = PM__MIRROR, .specular = {1, 1, 1}};
    const double axis[2] = {0, 0};
    uint32_t material = 0;
    const pm_status status = pm__scene_material(scene, &mirror, &material, error);
    return status ? status : pm__scene_cylinder(scene, material, axis, 1.0, 0.0, values[HEIGHT], 0.0, true, error);
}

/* The beam just covers the wall: |y| <= 1 across, and from the floor at x = 0 to the top at x = 1. */
static pm_status build_light(const double *values, pm__scene *scene, pm_error *error)
{
    const double a = elevation(values), half = 0.5 * (sin(a) + values[HEIGHT] * cos(a)), radius = hypot(1.0, half);
    const double watts = beam * pi * radius * radius, away = values[HEIGHT] + 5.0;
    const pm__light light = {.kind = PM__DIRECTIONAL,
                             .power = {watts, watts, watts},
                             .position = {half * sin(a) - away * cos(a), 0, half * cos(a) + away * sin(a)},
                             .direction = {cos(a), 0, -sin(a)},
                             .radius = radius};
    return pm__scene_light(scene, &light, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    pm_status status = build_wall(values, scene, error);
    if (!status)
        status = pm__scene_floor(scene, 0.0, values[HEIGHT] / tan(elevation(values)) + 2.0, 0.0, error);
    if (!status)
        status = build_light(values, scene, error);
    return status;
}

static void view(const double *values, pm__view *from)
{
    *from = (pm__view){.eye = {0, 0, values[HEIGHT] + 3.0}, .at = {0, 0, 0}, .up = {0, 1, 0}, .angle = 0.72};
}

const pm__case pm__case_scene_nephroid = {
    .entry = {.name = "scene:nephroid",
              .summary = "caustic of parallel light of 1 W/m2 in a mirror half cylinder",
              .citation = "Huygens 1690",
              .params = params,
              .param_count = 2,
              .resolve = resolve},
    .paths = "LSD",
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
};
