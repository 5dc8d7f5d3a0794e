/* Glass sphere of radius 1 at the origin in parallel light straight down, over a floor at z = -d: the light that passes
 * through it.
 *
 * Truth. A ray at the distance b = sin i from the axis enters at the polar angle i, is bent by i - t at each of the two
 * boundaries (sin t = b / n), and leaves at the polar angle phi = i + pi - 2 t, bent by delta = 2 (i - t) towards the
 * axis. While delta < pi / 2 it lands at the signed distance
 *     rho(i) = sin phi - (cos phi + d) tan delta,
 * and with t' = cos i / (n cos t), phi' = 1 - 2 t', delta' = 2 (1 - t'),
 *     rho'(i) = phi' (cos phi + sin phi tan delta) - (cos phi + d) delta' / cos^2 delta.
 * A ring b db = sin i cos i di is carried onto rho drho, less what the boundaries reflect (both alike: the angles
 * inside are equal; light is taken as unpolarised at each):
 *     E(r) = E0 sum over rho(i) = +r and -r of T^2 sin i cos i / (r |rho'(i)|).
 * Roots are sought of (rho -+ r) cos delta, which has no pole. On the axis the paraxial rays have the limit
 * T^2 / rho'(0)^2; other rays that cross the axis there (d below the paraxial focus n / (2 (n - 1))) make E infinite.
 * Fold: at the largest rho, if that is above 0.
 * Theory. Beyond 1.2 times the paraxial focus -rho increases with i, so a single sheet is smooth there, axis and all:
 * one Newton root for each point of a quadrature. Nearer no formula is given.
 * Power. The floor is a disc that catches rays up to rho = -4 m: the integral of 2 pi E0 T^2 sin i cos i over them. */
#include "scene_case.h"

#include "../../src/base/geometry.h"

static const double pi = 3.14159265358979323846, floor_radius = 4.0, beam = 1.0; /* m, W/m2 */

enum { IOR, D, CELLS = 128 };

static const pm__param params[] = {
    {.name = "ior", .type = PM__REAL, .value = 1.5, .min = 1.2, .max = 2.0, .unit = "", .help = "of the glass"},
    {.name = "d", .type = PM__REAL, .value = 2.0, .min = 1.0, .max = 4.0, .unit = "m",
     .help = "from the centre of the sphere to the floor"},
};

enum { ALL, CORE };

static const pm__region regions[] = {
    {"all", "lit without fold or focus: within the fold where that is beyond 0.1 m, else up to 0.8 m from the axis",
     false, false},
    {"core", "up to 0.1 m from the axis, or 1.2 times as far as the fold: what folds and foci there are", false, false},
    {"outer", "0.5 to 0.8 m from the axis", false, false},
};

/* A ray through the glass. */
typedef struct passage {
    double i, t, phi, delta;
} passage;

static passage pass(const double *values, double i)
{
    const double t = asin(sin(i) / values[IOR]);
    return (passage){i, t, i + pi - 2.0 * t, 2.0 * (i - t)};
}

typedef struct target {
    const double *values;
    double rho;
} target;

/* (rho(i) - target) cos delta. */
static double miss(const void *context, double i)
{
    const target *const at = context;
    const passage p = pass(at->values, i);
    return (sin(p.phi) - at->rho) * cos(p.delta) - (cos(p.phi) + at->values[D]) * sin(p.delta);
}

static double slope(const double *values, const passage *p)
{
    const double bend = cos(p->i) / (values[IOR] * cos(p->t)), secant = 1.0 / cos(p->delta);
    return (1.0 - 2.0 * bend) * (cos(p->phi) + sin(p->phi) * tan(p->delta)) -
           (cos(p->phi) + values[D]) * 2.0 * (1.0 - bend) * secant * secant;
}

static double fold_sign(const void *context, double i)
{
    const target *const at = context;
    const passage p = pass(at->values, i);
    const double cosine = cos(p.delta);
    return slope(at->values, &p) * cosine * cosine;
}

/* delta - pi / 2. */
static double level(const void *context, double i)
{
    const target *const at = context;
    return pass(at->values, i).delta - 0.5 * pi;
}

/* The largest i of rays that go on downward. */
static double last(const target *at)
{
    double roots[PM__MOST_ROOTS];
    return pm__roots(level, at, 0.0, 0.5 * pi, 16, roots) ? roots[0] : 0.5 * pi;
}

/* 0: there is none. */
static double fold_radius(const double *values)
{
    const target at = {values, 0.0};
    double roots[PM__MOST_ROOTS], largest = 0.0;
    const size_t count = pm__roots(fold_sign, &at, 0.0, last(&at), CELLS, roots);
    for (size_t k = 0; k < count; k++)
        largest = fmax(largest, miss(&at, roots[k]) / cos(pass(values, roots[k]).delta));
    return largest;
}

/* T^2 sin i cos i. */
static double carried(const double *values, double i)
{
    const double passed = pm__transmittance(cos(i), values[IOR]);
    return passed * passed * sin(i) * cos(i);
}

static double ring_power(const void *context, double i)
{
    const target *const at = context;
    return 2.0 * pi * beam * carried(at->values, i);
}

static double power(const double *values)
{
    const target edge = {values, -floor_radius};
    double roots[PM__MOST_ROOTS];
    const double end = last(&edge);
    const size_t count = pm__roots(miss, &edge, 0.0, end, CELLS, roots);
    return pm__integral(ring_power, &edge, 0.0, count ? roots[0] : end);
}

static void probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const double fold = fold_radius(values), core = fmax(0.1, 1.2 * fold);
    const double focus = 0.5 * values[IOR] / (values[IOR] - 1.0);
    double inner = 0.5, outer = 0.8;
    if (region == CORE) {
        inner = 0.0;
        outer = core;
    } else if (region == ALL && fold > 0.1) {
        inner = 0.25 * fold;
        outer = 0.8 * fold;
    } else if (region == ALL) {
        inner = values[D] > 1.2 * focus ? 0.0 : 1.25 * core; /* far enough behind the focus the middle is smooth */
    }
    pm__probe_ring(0.0, 0.0, inner, outer, u, point);
    point->position[2] = -values[D];
}

static double truth(const double *values, const pm__probe *point)
{
    /* On the axis: nearer, rounding of rho is more than what the paraxial limit is off here, both about 1e-10. */
    const double r = fmax(3e-6, hypot(point->position[0], point->position[1]));
    double sum = 0.0;
    if (!pm__is_upside(point))
        return 0.0;
    for (int side = -1; side <= 1; side += 2) {
        const target at = {values, side * r};
        double roots[PM__MOST_ROOTS];
        const size_t count = pm__roots(miss, &at, 0.0, last(&at), CELLS, roots);
        for (size_t k = 0; k < count; k++) {
            const passage p = pass(values, roots[k]);
            sum += carried(values, p.i) / (r * fabs(slope(values, &p)));
        }
    }
    return beam * sum;
}

/* Signed distance on the far side of the axis, less the target's, where -rho increases. */
static double beyond(const void *context, double i, double *rise)
{
    const target *const at = context;
    const passage p = pass(at->values, i);
    *rise = -slope(at->values, &p);
    return -(sin(p.phi) - (cos(p.phi) + at->values[D]) * tan(p.delta)) - at->rho;
}

typedef struct disc {
    const double *values;
    double rho, last, rise; /* of the middle; the largest i; -rho'(0) */
} disc;

static double around(const void *context, double r, double cosine)
{
    const disc *const d = context;
    const double far2 = d->rho * d->rho + r * r + 2.0 * d->rho * r * cosine;
    const target at = {d->values, sqrt(fmax(far2, 1e-11))}; /* as in truth */
    const double guess = fmin(at.rho / d->rise, 0.5 * d->last);
    const double i = pm__increasing_root(beyond, &at, 0.0, d->last, guess);
    const passage p = pass(d->values, i);
    return beam * carried(d->values, i) / (at.rho * fabs(slope(d->values, &p)));
}

static double mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const double n = values[IOR], focus = 0.5 * n / (n - 1.0), rho = hypot(point->position[0], point->position[1]);
    if (!pm__accepts_down(point, shape))
        return 0.0;
    if (values[D] <= 1.2 * focus || rho + r1 > 0.9 * floor_radius)
        return NAN;
    /* delta = pi / 2 there: tan i (1 - sqrt(2) / n) = 1 */
    const double end = n > sqrt(2.0) ? atan(1.0 / (1.0 - sqrt(2.0) / n)) : 0.5 * pi;
    const passage middle = pass(values, 0.0);
    const disc d = {values, rho, end * (1.0 - 1e-9), -slope(values, &middle)};
    return pm__mass_even(around, &d, r0, r1);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double n = values[IOR], down[3] = {0, 0, -values[D]}, up[3] = {0, 0, 1}, origin[3] = {0, 0, 0};
    const pm__material glass = {.kind = PM__GLASS, .ior = {n, n, n}};
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    uint32_t solid = 0, matte = 0;
    pm_status status = pm__scene_material(scene, &glass, &solid, error);
    if (!status)
        status = pm__scene_material(scene, &white, &matte, error);
    if (!status)
        status = pm__scene_sphere(scene, solid, origin, 1.0, false, error);
    if (!status)
        status = pm__scene_disc(scene, matte, down, up, floor_radius, error);
    if (!status)
        status = pm__scene_lamp(scene, PM__DIRECTIONAL, 2.0, beam * pi, 1.0, 0.0, error);
    return status;
}

/* Past the sphere at what it gathers. */
static void view(const double *values, pm__view *from)
{
    const double d = values[D];
    *from = (pm__view){.eye = {0, -5.5, 2.2 - d}, .at = {0, 0, -0.5 * d}, .up = {0, 0, 1}, .angle = 0.62};
}

const pm__case pm__case_scene_glass_sphere = {
    .entry = {.name = "scene:glass-sphere",
              .summary = "caustic of parallel light through a glass sphere of radius 1 m, 1 W/m2",
              .citation = "Snell, Fresnel",
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
};
