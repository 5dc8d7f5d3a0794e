/* Lambertian rectangle of radiance L over a floor parallel to it, at height h.
 *
 * Truth. From a floor point, the part of the light between its normal and the offsets X, Y gives
 * L times the integral of cos cos / d^2 = h^2 / (h^2 + x^2 + y^2)^2 over [0,X] x [0,Y], which is
 *     G(X, Y) = 1/2 [ X/A atan(Y/A) + Y/B atan(X/B) ],   A^2 = h^2 + X^2,  B^2 = h^2 + Y^2
 * (Lambert's formula for a rectangle, odd in X and in Y). With the light centred over the origin, of half sizes a, b,
 *     E(x, y) = L sum over X in {a - x, a + x}, Y in {b - y, b + y} of G(X, Y).
 * Photons. The floor ends 1.5 h beyond the outline of the light: |x| <= S = a + 1.5 h, |y| <= T = b + 1.5 h. G is
 * integrated along Y and then X by
 *     H(X, Y) = 1/2 [ X Y/A atan(Y/A) + B atan(X/B) ],                       dH/dY = G, even in Y,
 *     J(X, Y) = 1/2 [ Y A atan(Y/A) + X B atan(X/B) - h^2/2 ln(h^2 + X^2 + Y^2) ],   dJ/dX = H, even in X and Y
 * (the rational terms cancel on differentiation). So from the middle of the floor, on either side alike,
 *     flux below x:        M(x) = 2 L [ J(a + x, T + b) - J(a + x, T - b) - J(a - x, T + b) + J(a - x, T - b) ],
 *     and below y at x:    C(y) = L sum over X in {a - x, a + x} of [ H(X, b + y) - H(X, b - y) ],
 * M'(x) = 2 C(T). Power 2 M(S); u0 and u1 invert M / M(S) and C / C(T). A light small against h makes M a second
 * difference of J: the ranges of the parameters keep it to 1e-10.
 * Directions come from a point of the light uniform in u2, u3: not weighted by what that point contributes, which an
 * irradiance does not depend on.
 * Theory. Quadrature of E. */
#include "shared.h"

enum { RADIANCE, WIDTH, DEPTH, HEIGHT };

const pm__param pm__rect_light_params[PM__RECT_LIGHT_PARAMS] = {
    {.name = "radiance", .type = PM__REAL, .value = 1.0, .min = 1e-6, .max = 1e6, .unit = "W/(m2 sr)",
     .help = "of the light"},
    {.name = "width", .type = PM__REAL, .value = 1.0, .min = 0.1, .max = 100.0, .unit = "m", .help = "along x"},
    {.name = "depth", .type = PM__REAL, .value = 1.0, .min = 0.1, .max = 100.0, .unit = "m", .help = "along y"},
    {.name = "height", .type = PM__REAL, .value = 1.0, .min = 0.1, .max = 10.0, .unit = "m", .help = "over the floor"},
};

enum { ALL, BELOW, BESIDE };

const pm__region pm__rect_light_regions[PM__RECT_LIGHT_REGIONS] = {
    {"all", "up to 0.9 heights beyond the outline of the light", false, false},
    {"below", "under the middle half of the light", false, false},
    {"beside", "0.4 to 0.9 heights beyond the outline, along x", false, false},
};

typedef struct layout {
    double a, b, h, s, t;
} layout;

static layout measure(const double *values)
{
    const double a = 0.5 * values[WIDTH], b = 0.5 * values[DEPTH], h = values[HEIGHT];
    return (layout){a, b, h, a + 1.5 * h, b + 1.5 * h};
}

void pm__rect_light_floor(const double *values, double half[2])
{
    const layout l = measure(values);
    half[0] = l.s;
    half[1] = l.t;
}

/* G, H and J share their square roots and arc tangents. */
typedef struct corner {
    double A, B, alpha, beta; /* atan(Y/A), atan(X/B) */
} corner;

static inline corner corner_of(double x, double y, double A, double B)
{
    return (corner){A, B, atan(y / A), atan(x / B)};
}

static inline double G(const corner *c, double x, double y)
{
    return 0.5 * (x / c->A * c->alpha + y / c->B * c->beta);
}

static inline double H(const corner *c, double x, double y)
{
    return 0.5 * (x * y / c->A * c->alpha + c->B * c->beta);
}

/* J but for its logarithm, which callers take once for four corners. */
static inline double J_arcs(const corner *c, double x, double y)
{
    return 0.5 * (y * c->A * c->alpha + x * c->B * c->beta);
}

static inline double leg(double h, double x)
{
    return sqrt(h * h + x * x);
}

/* C(y) / L and its slope E / L at abscissa x. */
static double conditional(const layout *l, double x, double y, double *slope)
{
    const double X[2] = {l->a - x, l->a + x}, Y[2] = {l->b - y, l->b + y};
    const double A[2] = {leg(l->h, X[0]), leg(l->h, X[1])}, B[2] = {leg(l->h, Y[0]), leg(l->h, Y[1])};
    double sum = 0.0, density = 0.0;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            const corner c = corner_of(X[i], Y[j], A[i], B[j]);
            sum += j ? H(&c, X[i], Y[j]) : -H(&c, X[i], Y[j]);
            density += G(&c, X[i], Y[j]);
        }
    *slope = density;
    return sum;
}

/* M(x) / (2 L) and its slope C(T) / L. */
static double marginal(const layout *l, double x, double *slope)
{
    const double X[2] = {l->a - x, l->a + x}, Y[2] = {l->t - l->b, l->t + l->b};
    const double A[2] = {leg(l->h, X[0]), leg(l->h, X[1])}, B[2] = {leg(l->h, Y[0]), leg(l->h, Y[1])};
    double sum = 0.0, density = 0.0;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            const corner c = corner_of(X[i], Y[j], A[i], B[j]);
            sum += i == j ? J_arcs(&c, X[i], Y[j]) : -J_arcs(&c, X[i], Y[j]);
            density += j ? H(&c, X[i], Y[j]) : -H(&c, X[i], Y[j]);
        }
    const double h2 = l->h * l->h, x0 = X[0] * X[0], x1 = X[1] * X[1];
    const double y0 = B[0] * B[0], y1 = B[1] * B[1]; /* h^2 included */
    *slope = density;
    return sum - 0.25 * h2 * log((x0 + y0) * (x1 + y1) / ((x0 + y1) * (x1 + y0)));
}

static double irradiance(const double *values, double x, double y)
{
    const layout l = measure(values);
    double density;
    (void)conditional(&l, x, y, &density);
    return values[RADIANCE] * density;
}

static void aspect(const double *values, double ratio[2])
{
    const layout l = measure(values);
    ratio[0] = ratio[1] = l.s / l.t;
}

double pm__rect_light_power(const double *values)
{
    const layout l = measure(values);
    double slope;
    return 4.0 * values[RADIANCE] * marginal(&l, l.s, &slope);
}

typedef struct inversion {
    layout l;
    double x, target;
} inversion;

static double marginal_value(const void *context, double x, double *slope)
{
    const inversion *const i = context;
    return marginal(&i->l, x, slope) - i->target;
}

static double conditional_value(const void *context, double y, double *slope)
{
    const inversion *const i = context;
    return conditional(&i->l, i->x, y, slope) - i->target;
}

/* A start for v in [-1, 1] from the flux that a line of height `scale` would send: t / sqrt(scale^2 + t^2). */
static double start(double v, double scale2, double end)
{
    const double t = v * end / sqrt(scale2 + end * end);
    return t * sqrt(scale2 / (1.0 - t * t));
}

static void photon(const double *values, const double *u, double position[3], double direction[3], double normal[3])
{
    inversion i = {.l = measure(values)};
    const layout *const l = &i.l;
    const double v = 2.0 * u[0] - 1.0, w = 2.0 * u[1] - 1.0;
    double slope;
    i.target = v * marginal(l, l->s, &slope);
    const double scale2 = l->h * l->h + l->a * l->a;
    const double x = pm__increasing_root(marginal_value, &i, -l->s, l->s, start(v, scale2, l->s));
    i.x = x;
    i.target = w * conditional(l, x, l->t, &slope);
    const double y = pm__increasing_root(conditional_value, &i, -l->t, l->t,
                                         start(w, l->h * l->h + l->b * l->b, l->t));
    pm__photon_down(x, y, position, direction, normal);
    direction[0] = x - (2.0 * u[2] - 1.0) * l->a;
    direction[1] = y - (2.0 * u[3] - 1.0) * l->b;
    direction[2] = -l->h;
    pm__normalize(direction);
}

void pm__rect_light_probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    const layout l = measure(values);
    const double far = 0.9 * l.h;
    pm__rectangle area = {-l.a - far, l.a + far, -l.b - far, l.b + far};
    if (region == BELOW)
        area = (pm__rectangle){-0.5 * l.a, 0.5 * l.a, -0.5 * l.b, 0.5 * l.b};
    else if (region == BESIDE)
        area = (pm__rectangle){l.a + 0.4 * l.h, l.a + far, -l.b, l.b};
    pm__probe_rectangle(&area, u, point);
}

double pm__rect_light_truth(const double *values, const pm__probe *point)
{
    return irradiance(values, point->position[0], point->position[1]);
}

double pm__rect_light_mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1)
{
    const layout l = measure(values);
    const pm__rectangle floor_area = {-l.s, l.s, -l.t, l.t};
    return pm__accepts_down(point, shape) ? pm__mass_rectangle(irradiance, values, &floor_area, point, r0, r1) : 0.0;
}

const pm__case pm__case_rect_light = {
    .entry = {.name = "rect-light",
              .summary = "Lambertian rectangular light over a floor",
              .citation = "Lambert 1760",
              .params = pm__rect_light_params,
              .param_count = PM__RECT_LIGHT_PARAMS},
    .paths = "LD",
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .regions = pm__rect_light_regions,
    .region_count = PM__RECT_LIGHT_REGIONS,
    .aspect = aspect,
    .power = pm__rect_light_power,
    .photon = photon,
    .probe = pm__rect_light_probe,
    .truth = pm__rect_light_truth,
    .mass = pm__rect_light_mass,
};
