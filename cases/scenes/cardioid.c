/* Cardioid: the caustic of a point light in a mirror cylinder of radius 1 that stands on the floor z = 0. The light, of
 * 1 W/sr, hangs on the rim at (-1, 0, h); the wall is as high.
 *
 * Truth. Light of the plan direction phi, |phi| < pi / 2, meets the wall after the chord 2 cos phi at the angle 2 phi
 * and goes on at 3 phi + pi. Landing after the plan distance t = 2 cos phi + s it is at
 *     P = (cos 2phi, sin 2phi) - s (cos 3phi, sin 3phi).
 * Its elevation has the sine h / sqrt(h^2 + t^2), so dphi ds is the solid angle h t / (h^2 + t^2)^(3/2), and
 * |dP/dphi x dP/ds| = |2 cos phi - 3 s|:
 *     E = I sum of h t / ((h^2 + t^2)^(3/2) |2 cos phi - 3 s|),  over phi with  x sin 3phi - y cos 3phi = sin phi,
 * s > 0. Inside the circle s is within the second chord, 2 cos phi, by itself; the wall is met at h s / t <= h / 2.
 * Fold: s = 2/3 cos phi, with psi = 2 phi the curve (2 cos psi - cos 2psi, 2 sin psi - sin 2psi) / 3; cusp (1/3, 0).
 * The wall is open where x < -SLOT, so that the light hangs free of it. That darkens only what lies by the opening:
 * light of |phi| > (pi - acos(SLOT)) / 2, whose chords are short.
 * Power. All that lands within the circle after one reflection:
 *     I integral dphi [h / sqrt(h^2 + 4 cos^2 phi) - h / sqrt(h^2 + 16 cos^2 phi)].
 * Theory. The same integral between t1 and t2, I dphi [h / sqrt(h^2 + t1^2) - h / sqrt(h^2 + t2^2)], falls on a chord
 * of the ray of phi. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846, slot = 0.999, intensity = 1.0; /* -, W/sr */

enum { CELLS = 128 };

static const pm__param params[] = {
    {.name = "height", .type = PM__REAL, .value = 1.0, .min = 0.1, .max = 10.0, .unit = "m",
     .help = "of the light and of the wall"},
};

enum { ALL, NOTCH, FOLD, CUSP };

static const pm__region regions[] = {
    {"all", "x from -0.5 to 0.2 m, |y| below 0.5 m: within the curve", false, false},
    {"notch", "x from 0.6 to 0.8 m, |y| below 0.4 m: beyond the curve", false, false},
    {"fold", "x from 0.42 to 0.56 m, y from 0.2 to 0.45 m: across the fold", false, false},
    {"cusp", "within 0.05 m of the cusp", false, false},
};

static const pm__rectangle probed[] = {{-0.5, 0.2, -0.5, 0.5}, {0.6, 0.8, -0.4, 0.4}, {0.42, 0.56, 0.2, 0.45}};

static double widest(void)
{
    return 0.5 * (pi - acos(slot));
}

static double landed(const void *context, double phi)
{
    const double h = *(const double *)context, c = 2.0 * cos(phi);
    return h / hypot(h, c) - h / hypot(h, 2.0 * c);
}

static double power(const double *values)
{
    return 2.0 * intensity * pm__integral(landed, values, 0.0, widest());
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    (void)values;
    if (region == CUSP)
        pm__probe_ring(1.0 / 3.0, 0.0, 0.0, 0.05, u, point);
    else
        pm__probe_rectangle(&probed[region], u, point);
}

static double miss(const void *context, double phi)
{
    const double *const at = context;
    return at[0] * sin(3.0 * phi) - at[1] * cos(3.0 * phi) - sin(phi);
}

static double truth(const double *values, const pm__probe *point)
{
    const double *const at = point->position, h = values[0];
    double roots[PM__MOST_ROOTS], sum = 0.0;
    if (!pm__is_upside(point))
        return 0.0;
    const size_t count = pm__roots(miss, at, -widest(), widest(), CELLS, roots);
    for (size_t i = 0; i < count; i++) {
        const double phi = roots[i];
        const double s = (cos(2.0 * phi) - at[0]) * cos(3.0 * phi) + (sin(2.0 * phi) - at[1]) * sin(3.0 * phi);
        const double t = 2.0 * cos(phi) + s, d2 = h * h + t * t;
        if (s > 0.0)
            sum += h * t / (d2 * sqrt(d2) * fabs(2.0 * cos(phi) - 3.0 * s));
    }
    return intensity * sum;
}

typedef struct disc {
    const double *at;
    double h;
} disc;

static double sheet_miss(const void *context, double phi, double *slope)
{
    const double *const at = ((const disc *)context)->at;
    *slope = 3.0 * (at[0] * cos(3.0 * phi) + at[1] * sin(3.0 * phi)) - cos(phi);
    return miss(at, phi);
}

static double strip(const void *context, double phi, double half)
{
    const disc *const d = context;
    const double s = (cos(2.0 * phi) - d->at[0]) * cos(3.0 * phi) + (sin(2.0 * phi) - d->at[1]) * sin(3.0 * phi);
    const double near = 2.0 * cos(phi) + s - half, far = near + 2.0 * half, h = d->h;
    /* h / hypot(h, near) - h / hypot(h, far), without its cancellation */
    const double a = hypot(h, near), b = hypot(h, far);
    return intensity * h * 2.0 * half * (near + far) / (a * b * (a + b));
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const disc d = {point->position, values[0]};
    const pm__sheets sheets = {sheet_miss, strip, -widest(), widest()};
    if (!pm__accepts_down(point, shape))
        return 0.0;
    return hypot(d.at[0], d.at[1]) + r1 < 1.0 ? pm__mass_sheets(&sheets, &d, r0, r1) : NAN;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material mirror = {.kind = PM__MIRROR, .specular = {1, 1, 1}};
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    const double h = values[0], axis[2] = {0, 0}, origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    const double watts = 2.0 * pi * intensity; /* the half space in front: the other half would only be lost */
    const pm__light light = {.kind = PM__SPOT, .power = {watts, watts, watts}, .position = {-1, 0, h},
                             .direction = {1, 0, 0}, .angle = 0.5 * pi};
    uint32_t shiny = 0, matte = 0;
    pm_status status = pm__scene_material(scene, &mirror, &shiny, error);
    if (!status)
        status = pm__scene_material(scene, &white, &matte, error);
    if (!status)
        status = pm__scene_cylinder(scene, shiny, axis, 1.0, 0.0, h, -slot, true, error);
    if (!status)
        status = pm__scene_disc(scene, matte, origin, up, 1.0, error);
    if (!status)
        status = pm__scene_light(scene, &light, error);
    return status;
}

static void view(const double *values, pm__view *from)
{
    *from = (pm__view){.eye = {0, 0, values[0] + 3.0}, .at = {0, 0, 0}, .up = {0, 1, 0}, .angle = 0.7};
}

const pm__case pm__case_scene_cardioid = {
    .entry = {.name = "scene:cardioid",
              .summary = "caustic of a point light of 1 W/sr on the rim of a mirror cylinder",
              .citation = "la Hire 1708",
              .params = params,
              .param_count = 1},
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
