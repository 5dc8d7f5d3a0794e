/* Pool with a sinusoidal surface z = d + zeta, zeta = a cos kx, under parallel light straight down: the light on the
 * bottom z = 0.
 *
 * Truth. Where the surface has the slope zeta' = tan psi, light is bent from the vertical by psi - psi_t,
 * sin psi_t = sin psi / n, towards the crest: it lands at
 *     x' = x + (d + zeta) tan(psi - psi_t),
 * and with psi' = zeta'' / (1 + zeta'^2), psi_t' = psi' cos psi / (n cos psi_t),
 *     dx'/dx = 1 + zeta' tan(psi - psi_t) + (d + zeta) (psi' - psi_t') / cos^2(psi - psi_t).
 * What falls on dx, less what the surface reflects, is carried onto dx':  E = E0 sum over x of T(psi) / |dx'/dx|, those
 * x that lie in the beam with the point's y, which light keeps.
 * Deeper than the focus, d + a = n / ((n - 1) a k^2), there are two folds under each crest.
 * Power. The beam is a disc of radius b, all of which reaches the bottom: the integral of 2 sqrt(b^2 - x^2) E0 T, with
 * x = b sin v. Probes lie so far within it that its edge lights none of them.
 * Theory. A disc of the bottom gets E0 T dx times the length of its chord at x'. */
#include "scene_case.h"

static const double pi = 3.14159265358979323846;
static const double amplitude = 0.05, wavelength = 1.0, n = 1.33; /* m, m */
static const double radius = 1.25, beam = 1.0;                    /* m, W/m2 */

enum { CELLS = 128 };

static const pm__param params[] = {
    {.name = "d", .type = PM__REAL, .value = 1.0, .min = 0.25, .max = 3.0, .unit = "m", .help = "mean depth"},
};

enum { ALL, CREST };

static const pm__region regions[] = {
    {"all", "a square of one period; if folds or foci are near, at least 0.15 m from the crest", false, false},
    {"crest", "within 0.1 m of the crest: foci and folds", false, false},
    {"trough", "within 0.1 m of the middle between two crests", false, false},
};

static double wave_number(void)
{
    return 2.0 * pi / wavelength;
}

/* How light is bent at x. */
typedef struct bend {
    double zeta, first, psi, psi_t;
} bend;

static bend bend_at(double x)
{
    const double k = wave_number(), first = -amplitude * k * sin(k * x), psi = atan(first);
    return (bend){amplitude * cos(k * x), first, psi, asin(sin(psi) / n)};
}

typedef struct target {
    double d, x;
} target;

static double miss(const void *context, double x)
{
    const target *const at = context;
    const bend b = bend_at(x);
    return x + (at->d + b.zeta) * tan(b.psi - b.psi_t) - at->x;
}

static double slope(double d, const bend *b)
{
    const double k = wave_number(), turn = -k * k * b->zeta / (1.0 + b->first * b->first); /* psi' */
    const double turn_t = turn * cos(b->psi) / (n * cos(b->psi_t)), tangent = tan(b->psi - b->psi_t);
    return 1.0 + b->first * tangent + (d + b->zeta) * (turn - turn_t) * (1.0 + tangent * tangent);
}

static double strip(const void *context, double v)
{
    (void)context;
    const bend b = bend_at(radius * sin(v));
    return 2.0 * beam * radius * radius * cos(v) * cos(v) * pm__transmittance(cos(b.psi), n);
}

static double power(const double *values)
{
    return pm__integral(strip, values, -0.5 * pi, 0.5 * pi);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const double k = wave_number(), focus = n / ((n - 1.0) * amplitude * k * k) - amplitude;
    const double clear = region == ALL && values[0] > 0.8 * focus ? 0.15 : 0.0;
    const pm__rectangle area = {region == CREST ? -0.1 : clear, region == CREST ? 0.1 : 1.0 - clear, -0.5, 0.5};
    const pm__rectangle trough = {0.4, 0.6, -0.5, 0.5};
    pm__probe_rectangle(region > CREST ? &trough : &area, u, point);
    if (region != CREST && point->position[0] > 0.5)
        point->position[0] -= wavelength; /* near the middle of the beam */
}

/* No ray is bent farther than this along the bottom, m. */
static double aside(double d)
{
    const double steepest = atan(amplitude * wave_number());
    return (d + amplitude) * tan(steepest - asin(sin(steepest) / n));
}

static double truth(const double *values, const pm__probe *point)
{
    const target at = {values[0], point->position[0]};
    const double reach = 1e-3 + aside(at.d);
    double roots[PM__MOST_ROOTS], sum = 0.0;
    if (!pm__is_upside(point))
        return 0.0;
    const size_t count = pm__roots(miss, &at, at.x - reach, at.x + reach, CELLS, roots);
    for (size_t i = 0; i < count; i++) {
        const bend b = bend_at(roots[i]);
        if (hypot(roots[i], point->position[1]) < radius)
            sum += pm__transmittance(cos(b.psi), n) / fabs(slope(at.d, &b));
    }
    return beam * sum;
}

static double sheet_miss(const void *context, double x, double *slope_at)
{
    const target *const at = context;
    const bend b = bend_at(x);
    *slope_at = slope(at->d, &b);
    return x + (at->d + b.zeta) * tan(b.psi - b.psi_t) - at->x;
}

static double chord(const void *context, double x, double half)
{
    (void)context;
    return 2.0 * half * beam * pm__transmittance(cos(bend_at(x).psi), n);
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const target at = {values[0], point->position[0]};
    const double away = aside(at.d), reach = 1.25 * r1 + away + 2e-3;
    const pm__sheets sheets = {sheet_miss, chord, at.x - reach, at.x + reach};
    if (!pm__accepts_down(point, shape))
        return 0.0;
    /* the edge of the beam */
    const bool lit = hypot(at.x, point->position[1]) + r1 + away < radius;
    return lit ? pm__mass_sheets(&sheets, &at, r0, r1) : NAN;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__material water = {.kind = PM__GLASS, .ior = {n, n, n}};
    const double watts = beam * pi * radius * radius, extent[2] = {1.2 * radius, 1.2 * radius};
    uint32_t material = 0;
    pm_status status = pm__scene_material(scene, &water, &material, error);
    if (!status)
        status = pm__scene_wave(scene, material, values[0], amplitude, wave_number(), extent, error);
    if (!status)
        status = pm__scene_floor(scene, 0.0, 2.0 * radius, 0.0, error);
    if (!status)
        status = pm__scene_lamp(scene, PM__DIRECTIONAL, values[0] + 1.0, watts, radius, 0.0, error);
    return status;
}

static void view(const double *values, pm__view *from)
{
    *from = (pm__view){.eye = {0, -1.5, values[0] + 2.5}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.6};
}

const pm__case pm__case_scene_pool = {
    .entry = {.name = "scene:pool",
              .summary = "parallel light of 1 W/m2 through waves of 0.05 m on water",
              .citation = "Snell, Fresnel",
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
