/* The cases' formulas against quadrature of the truth alone, and against 200-bit arithmetic where they cancel. */
#include "../case_charts.h"

#include "../../cases/planar.h"
#include "../../src/base/random.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sort.h>
#include <mpfr.h>

static const double pi = 3.14159265358979323846;

/* Flat cases with their rectangle. */
static const struct {
    const char *text;
    double x0, x1, y0, y1;
} flat[] = {
    {"square", 0, 1, 0, 1},
    {"gradient:slope=-1.9", 0, 1, 0, 1},
    {"quadratic", 0, 1, 0, 1},
    {"quadratic:curvature=300", 0, 1, 0, 1},
    {"blob", 0, 1, 0, 1},
    {"blob:sigma=0.3", 0, 1, 0, 1},
    {"sinusoid", 0, 1, 0, 1},
    {"sinusoid:cycles=4.3,contrast=1", 0, 1, 0, 1},
    {"edge", 0, 1, 0, 1},
    {"edge:dark=0.3", 0, 1, 0, 1},
    {"rect-light", -2, 2, -2, 2},
    {"rect-light:width=3,depth=0.4,height=0.8,radiance=2", -2.7, 2.7, -1.4, 1.4},
    {"point-light:height=0.7", -1e300, 1e300, -1e300, 1e300},
};

enum { FLAT = sizeof flat / sizeof *flat, FINITE = FLAT - 1 };

static const pm__case *parse(const char *text, pm__spec *spec)
{
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__cases, text, spec, &error), error);
    return (const pm__case *)(const void *)spec->entry;
}

static void uniform(uint64_t number, double *u, int count)
{
    pm__random_uniform(3, PM__FOR_TESTS, 0, number, u, count);
}

/* Composite Gauss-Legendre. */
typedef struct rule {
    gsl_integration_glfixed_table *table;
    int panels;
} rule;

static double integrate(const rule *with, double (*function)(double, void *), void *context, double a, double b)
{
    const gsl_function f = {function, context};
    double sum = 0.0;
    for (int i = 0; i < with->panels && b > a; i++)
        sum += gsl_integration_glfixed(&f, a + (b - a) * i / with->panels, a + (b - a) * (i + 1) / with->panels,
                                       with->table);
    return sum;
}

typedef struct field {
    const pm__case *c;
    const double *values;
    rule rule;
    double x, y0, y1;   /* the line in hand, and its ends */
    double cx, cy, r;   /* a disc */
} field;

static double along_y(double y, void *context)
{
    const field *const f = context;
    const pm__probe probe = {.position = {f->x, y, 0}, .normal = {0, 0, 1}};
    return f->c->truth(f->values, &probe);
}

static double along_x(double x, void *context)
{
    field *const f = context;
    f->x = x;
    return integrate(&f->rule, along_y, f, f->y0, f->y1);
}

/* Over x in [a, b] and the field's y, cut at the only jump that any case has. */
static double over_x(field *f, double a, double b)
{
    return integrate(&f->rule, along_x, f, a, fmin(b, 0.5)) + integrate(&f->rule, along_x, f, fmax(a, 0.5), b);
}

/* ---- Sampling: the photon of u has u[0] of the power before its x, and u[1] of its line before its y ---- */

START_TEST(test_inverse)
{
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(16);
    for (int i = 0; i < FINITE; i++) {
        pm__spec spec;
        field f = {.c = parse(flat[i].text, &spec), .values = spec.values, .rule = {table, 6}};
        for (uint64_t j = 0; j < 12; j++) {
            double u[4], p[3], direction[3], normal[3];
            uniform(j, u, 4);
            f.c->photon(spec.values, u, p, direction, normal);
            f.y0 = flat[i].y0;
            f.y1 = flat[i].y1;
            PM_CHECK_NEAR(over_x(&f, flat[i].x0, p[0]) / f.c->power(spec.values), u[0], 1e-10);
            const double line = along_x(p[0], &f);
            f.y1 = p[1];
            PM_CHECK_NEAR(along_x(p[0], &f) / line, u[1], 1e-10);
        }
    }
    gsl_integration_glfixed_table_free(table);
}
END_TEST

/* The cases on a disc: the share of the power within the photon's radius is the share of the square within that of u,
 * and the angle grows along a side of the square in proportion. */
static void check_disc(const char *text, double (*share)(const double p[3]))
{
    pm__spec spec;
    const pm__case *const c = parse(text, &spec);
    for (uint64_t j = 0; j < 100; j++) {
        double u[2], p[3], direction[3], normal[3];
        uniform(j, u, 2);
        c->photon(spec.values, u, p, direction, normal);
        const double a = 2 * u[0] - 1, b = 2 * u[1] - 1, side = fmax(fabs(a), fabs(b));
        PM_CHECK_NEAR(share(p), side * side, 1e-12);
        const double along = fabs(a) > fabs(b) ? b / fabs(a) : a / fabs(b);
        const double across = fabs(a) > fabs(b) ? p[1] : p[0];
        PM_CHECK_NEAR(asin(across / hypot(p[0], p[1])), along * pi / 4, 1e-12);
    }
}

static double lamp_share(const double p[3])
{
    return 1 - 0.7 / sqrt(0.49 + p[0] * p[0] + p[1] * p[1]);
}

static double sphere_share(const double p[3])
{
    return (p[0] * p[0] + p[1] * p[1]) / 9;
}

START_TEST(test_inverse_disc)
{
    check_disc("point-light:height=0.7,power=2", lamp_share);
    check_disc("sphere:radius=3", sphere_share);
}
END_TEST

/* The ball, cut by x, then y, then z. */
START_TEST(test_inverse_ball)
{
    pm__spec spec;
    const pm__case *const c = parse("volume", &spec);
    for (uint64_t j = 0; j < 100; j++) {
        double u[3], p[3], direction[3], normal[3];
        uniform(j, u, 3);
        c->photon(spec.values, u, p, direction, normal);
        PM_CHECK_NEAR((2 + 3 * p[0] - p[0] * p[0] * p[0]) / 4, u[0], 1e-14);
        const double q = sqrt(1 - p[0] * p[0]);
        PM_CHECK_NEAR(pm__disc_rectangle_area(0, 0, q, -2, 2, -2, p[1]) / (pi * q * q), u[1], 1e-13);
        PM_CHECK_NEAR(0.5 + 0.5 * p[2] / sqrt(q * q - p[1] * p[1]), u[2], 1e-12);
    }
}
END_TEST

/* ---- Power: the truth over all charts ---- */

typedef struct surface {
    const pm__case *c;
    const double *values;
    rule rule;
    int chart;
    double st[3];
} surface;

static double along_t(double t, void *context)
{
    surface *const s = context;
    pm__probe probe;
    s->st[1] = t;
    const double area = pm__chart_point(s->c, s->values, s->chart, s->st, &probe);
    return area * s->c->truth(s->values, &probe);
}

static double along_s(double s, void *context)
{
    surface *const f = context;
    f->st[0] = s;
    return integrate(&f->rule, along_t, f, 0.0, 1.0);
}

START_TEST(test_power)
{
    static const char *const curved[] = {"corner:irradiance=2,wall=0.5", "wall:irradiance=3",
                                         "sphere:radius=2,irradiance=3", "volume:density=5"};
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(16);
    for (size_t i = 0; i < FLAT + 4; i++) {
        pm__spec spec;
        surface s = {.c = parse(i < FLAT ? flat[i].text : curved[i - FLAT], &spec), .values = spec.values,
                     .rule = {table, 6}, .st = {0, 0, 0.5}};
        double sum = 0.0;
        for (s.chart = 0; s.chart < pm__chart_count(s.c); s.chart++)
            sum += integrate(&s.rule, along_s, &s, 0.0, 0.5) + integrate(&s.rule, along_s, &s, 0.5, 1.0);
        PM_CHECK_NEAR(sum / s.c->power(spec.values), 1.0, 1e-10);
    }
    gsl_integration_glfixed_table_free(table);
}
END_TEST

/* ---- Mass on the plane: chord by chord ---- */

static double chord(double angle, void *context)
{
    field *const f = context;
    const field outer = *f;
    const double half = f->r * cos(angle);
    f->y0 = fmax(outer.y0, f->cy - half);
    f->y1 = fmin(outer.y1, f->cy + half);
    const double line = f->y1 > f->y0 ? along_x(f->cx + f->r * sin(angle), f) : 0.0;
    f->y0 = outer.y0;
    f->y1 = outer.y1;
    return line * half;
}

static double clamped(double (*inverse)(double), double t)
{
    return inverse(fmax(-1.0, fmin(t, 1.0)));
}

/* x = cx + r sin(angle) makes chords smooth; cut where the disc crosses a side or the jump. */
static double disc(field *f, double x0, double x1)
{
    if (!(f->r > 0.0))
        return 0.0;
    const double from = clamped(asin, (x0 - f->cx) / f->r), to = clamped(asin, (x1 - f->cx) / f->r);
    const double above = clamped(acos, (f->y1 - f->cy) / f->r), below = clamped(acos, (f->cy - f->y0) / f->r);
    double cuts[7] = {from, to, above, -above, below, -below, clamped(asin, (0.5 - f->cx) / f->r)};
    double sum = 0.0;
    gsl_sort(cuts, 1, 7);
    for (int i = 0; i < 6; i++)
        sum += integrate(&f->rule, chord, f, fmax(from, cuts[i]), fmin(to, cuts[i + 1]));
    return sum;
}

START_TEST(test_mass_flat)
{
    static const double radii[][2] = {{0, 0.01}, {0, 0.1}, {0.04, 0.06}, {0.1, 0.25}, {0.12, 0.1201}};
    static const pm__shape sphere = {PM_LOOKUP_SPHERE, 0, false};
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(20);
    for (int i = 0; i < FLAT; i++) {
        pm__spec spec;
        field f = {.c = parse(flat[i].text, &spec), .values = spec.values, .rule = {table, 2},
                   .y0 = flat[i].y0, .y1 = flat[i].y1};
        for (uint64_t j = 0; j < 10; j++)
            for (int k = 0; k < 5; k++) {
                pm__probe probe;
                double u[3];
                uniform(j, u, 3);
                f.c->probe(spec.values, 0, u, &probe);
                if (j > 4 && i < FINITE) { /* near the corner of the domain */
                    probe.position[0] = flat[i].x0 + 0.08 * u[0];
                    probe.position[1] = flat[i].y1 - 0.15 * u[1];
                }
                f.cx = probe.position[0];
                f.cy = probe.position[1];
                f.r = radii[k][1];
                double want = disc(&f, flat[i].x0, flat[i].x1);
                const double whole = want;
                f.r = radii[k][0];
                want -= disc(&f, flat[i].x0, flat[i].x1);
                const double got = f.c->mass(spec.values, &probe, &sphere, radii[k][0], radii[k][1]);
                PM_CHECK_NEAR(got, want, 1e-7 * want + 1e-11 * whole);
            }
    }
    gsl_integration_glfixed_table_free(table);
}
END_TEST

static double constant(const double *values, double x, double y)
{
    (void)x;
    (void)y;
    return *values;
}

/* Probes anywhere, also outside the rectangle: areas. */
START_TEST(test_mass_anywhere)
{
    const double two = 2.0;
    for (uint64_t j = 0; j < 500; j++) {
        double u[6];
        uniform(j, u, 6);
        const pm__rectangle rectangle = {-u[0], u[1], -u[2], u[3]};
        const pm__probe probe = {.position = {3 * u[4] - 1.5, 3 * u[5] - 1.5, 0}, .normal = {0, 0, 1}};
        for (double r = 0.1; r < 3.0; r *= 1.7) {
            const double want = two * pm__shell_area(&rectangle, &probe, 0.5 * r, r);
            PM_CHECK_NEAR(pm__mass_rectangle(constant, &two, &rectangle, &probe, 0.5 * r, r), want,
                          1e-7 * want + 1e-9 * r * r);
        }
    }
}
END_TEST

/* ---- Mass on the sphere: ring by ring ---- */

typedef struct ring {
    double theta, gamma;
    rule rule;
} ring;

static double around(double phi, void *context)
{
    const ring *const f = context;
    return fmax(0.0, cos(f->gamma) * cos(f->theta) + sin(f->gamma) * sin(f->theta) * cos(phi));
}

/* Area element on the unit sphere: sin(gamma). The ring is lit up to |phi| = lit. */
static double rings(double gamma, void *context)
{
    ring *const f = context;
    f->gamma = gamma;
    const double t = -cos(gamma) * cos(f->theta) / (sin(gamma) * sin(f->theta));
    return 2.0 * sin(gamma) * integrate(&f->rule, around, f, 0.0, clamped(acos, t));
}

START_TEST(test_mass_sphere)
{
    static const pm__shape lookup = {PM_LOOKUP_SPHERE, 0, false};
    static const double chords[] = {0, 0.01, 0.05, 0.2, 0.5, 1.0, 1.6, 2.0};
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(40);
    pm__spec spec;
    const pm__case *const c = parse("sphere:radius=3,irradiance=2", &spec);
    for (int i = 1; i < 60; i++) {
        ring f = {.theta = pi * i / 60 + 1e-3 * (i == 30), .rule = {table, 4}};
        const double n[3] = {0.6 * sin(f.theta), 0.8 * sin(f.theta), cos(f.theta)};
        pm__probe probe;
        for (int d = 0; d < 3; d++)
            probe.position[d] = 3 * (probe.normal[d] = n[d]);
        for (int k = 0; k < 7; k++) {
            double cuts[4] = {2 * asin(chords[k] / 2), 2 * asin(chords[k + 1] / 2), fabs(pi / 2 - f.theta),
                              pi - fabs(pi / 2 - f.theta)};
            const double from = cuts[0], to = cuts[1];
            double want = 0.0;
            gsl_sort(cuts, 1, 4);
            for (int j = 0; j < 3; j++)
                want += integrate(&f.rule, rings, &f, fmax(from, cuts[j]), fmin(to, cuts[j + 1]));
            const double got = c->mass(spec.values, &probe, &lookup, 3 * chords[k], 3 * chords[k + 1]);
            PM_CHECK_NEAR(got, 18 * want, 1e-7 * 18 * want + 1e-13);
        }
    }
    gsl_integration_glfixed_table_free(table);
}
END_TEST

/* ---- 200 bits ---- */

enum { BITS = 200 };

/* result = u / sqrt(h2 + u^2) atan(v / sqrt(h2 + u^2)) and, in leg, the root. */
static void term(mpfr_t result, mpfr_t leg, const mpfr_t u, const mpfr_t v, const mpfr_t h2)
{
    mpfr_sqr(leg, u, MPFR_RNDN);
    mpfr_add(leg, leg, h2, MPFR_RNDN);
    mpfr_sqrt(leg, leg, MPFR_RNDN);
    mpfr_div(result, v, leg, MPFR_RNDN);
    mpfr_atan(result, result, MPFR_RNDN);
    mpfr_mul(result, result, u, MPFR_RNDN);
    mpfr_div(result, result, leg, MPFR_RNDN);
}

/* Adds sign * G(X, Y) for the offsets from the point x to the corner a, y to b. */
static void add_corner(mpfr_t sum, double a, double x, double b, double y, double h, int sign)
{
    mpfr_t X, Y, h2, first, second, leg;
    mpfr_inits2(BITS, X, Y, h2, first, second, leg, (mpfr_ptr)0);
    mpfr_set_d(h2, h, MPFR_RNDN);
    mpfr_sqr(h2, h2, MPFR_RNDN);
    mpfr_set_d(X, a, MPFR_RNDN);
    mpfr_sub_d(X, X, x, MPFR_RNDN);
    mpfr_set_d(Y, b, MPFR_RNDN);
    mpfr_sub_d(Y, Y, y, MPFR_RNDN);
    term(first, leg, X, Y, h2);
    term(second, leg, Y, X, h2);
    mpfr_add(first, first, second, MPFR_RNDN);
    mpfr_mul_d(first, first, 0.5 * sign, MPFR_RNDN);
    mpfr_add(sum, sum, first, MPFR_RNDN);
    mpfr_clears(X, Y, h2, first, second, leg, (mpfr_ptr)0);
}

/* Small and high, large and low, far and near. */
START_TEST(test_rect_light_precise)
{
    static const char *const texts[] = {"rect-light", "rect-light:width=0.1,depth=0.1,height=10",
                                        "rect-light:width=100,depth=0.1,height=0.1"};
    for (int i = 0; i < 3; i++) {
        pm__spec spec;
        const pm__case *const c = parse(texts[i], &spec);
        const double a = 0.5 * pm__test_value(c, spec.values, "width"),
                     b = 0.5 * pm__test_value(c, spec.values, "depth");
        const double h = pm__test_value(c, spec.values, "height");
        for (uint64_t j = 0; j < 200; j++) {
            double u[2];
            uniform(j, u, 2);
            const pm__probe probe = {.position = {(a + 1.5 * h) * (2 * u[0] - 1), (b + 1.5 * h) * (2 * u[1] - 1), 0},
                                     .normal = {0, 0, 1}};
            mpfr_t sum;
            mpfr_init2(sum, BITS);
            mpfr_set_d(sum, 0.0, MPFR_RNDN);
            for (int corner = 0; corner < 4; corner++)
                add_corner(sum, corner & 1 ? a : -a, probe.position[0], corner & 2 ? b : -b, probe.position[1], h,
                           corner == 0 || corner == 3 ? 1 : -1);
            const double want = mpfr_get_d(sum, MPFR_RNDN);
            /* The corners cancel as (a / h)^2 at worst: 2.5e-5 here, so eps over that. */
            PM_CHECK_NEAR(c->truth(spec.values, &probe), want, 1e-10 * want);
            mpfr_clear(sum);
        }
    }
}
END_TEST

/* E0 (pi r^2 + c cos(kx) 2 pi r J1(kr) / k) for small and large kr. */
START_TEST(test_sinusoid_precise)
{
    static const pm__shape sphere = {PM_LOOKUP_SPHERE, 0, false};
    pm__spec spec;
    const pm__case *const c = parse("sinusoid:cycles=40,contrast=1", &spec);
    const pm__probe probe = {.position = {0.4875, 0.5, 0}, .normal = {0, 0, 1}}; /* a trough: cos = -1 */
    const double k = 2 * pi * 40;
    for (double r = 1e-4; r < 0.4; r *= 1.3) {
        mpfr_t j;
        mpfr_init2(j, BITS);
        mpfr_set_d(j, k * r, MPFR_RNDN);
        mpfr_j1(j, j, MPFR_RNDN);
        const double want = pi * r * r - 2 * pi * r * mpfr_get_d(j, MPFR_RNDN) / k;
        PM_CHECK_NEAR(c->mass(spec.values, &probe, &sphere, 0, r), want, 1e-14 * pi * r * r);
        mpfr_clear(j);
    }
}
END_TEST

/* A segment of the unit disc beyond d = 1 - w: acos d - d sqrt(1 - d^2), by the rectangle that cuts it off. The
 * absolute error stays at that of the whole disc. */
START_TEST(test_segment_precise)
{
    for (double w = 1e-8; w < 2.0; w *= 1.7) {
        mpfr_t d, angle, root;
        mpfr_inits2(BITS, d, angle, root, (mpfr_ptr)0);
        mpfr_set_d(d, 1.0 - w, MPFR_RNDN);
        mpfr_acos(angle, d, MPFR_RNDN);
        mpfr_sqr(root, d, MPFR_RNDN);
        mpfr_ui_sub(root, 1, root, MPFR_RNDN);
        mpfr_sqrt(root, root, MPFR_RNDN);
        mpfr_mul(root, root, d, MPFR_RNDN);
        mpfr_sub(angle, angle, root, MPFR_RNDN);
        PM_CHECK_NEAR(pm__disc_rectangle_area(0, 0, 1, 1.0 - w, 5, -5, 5), mpfr_get_d(angle, MPFR_RNDN), 3e-15);
        mpfr_clears(d, angle, root, (mpfr_ptr)0);
    }
}
END_TEST

PM_TEST_MAIN("cases against quadrature", test_inverse, test_inverse_disc, test_inverse_ball, test_power, test_mass_flat,
             test_mass_anywhere, test_mass_sphere, test_rect_light_precise, test_sinusoid_precise, test_segment_precise)
