/* Areas, volumes and roots: closed forms, limits, and one-dimensional quadrature of the definitions. */
#include "../test.h"

#include "../../src/base/geometry.h"
#include "../../src/base/random.h"
#include "../../src/base/turn.h"
#include "../../src/base/vec3.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_sort.h>
#include <stdbool.h>

static const double pi = 3.14159265358979323846;

static void uniform(uint64_t number, double *u, int count)
{
    pm__random_uniform(1, PM__FOR_TESTS, 0, number, u, count);
}

/* A disc's part inside a square, at distance q r from one side (truths of the square under parallel light). */
START_TEST(test_disc_at_a_side)
{
    static const double table[][2] = {
        {0.0, 0.5}, {0.25, 0.6574811788}, {0.5, 0.8044988905}, {0.75, 0.9278531936}, {0.9, 0.9813069633}, {1.0, 1.0}};
    const double r = 0.05;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const double d = table[i][0] * r, area = table[i][1] * pi * r * r;
        PM_CHECK_NEAR(pm__disc_rectangle_area(d, 0.5, r, 0, 1, 0, 1), area, 1e-12);
        PM_CHECK_NEAR(pm__disc_rectangle_area(1 - d, 0.5, r, 0, 1, 0, 1), area, 1e-12);
        PM_CHECK_NEAR(pm__disc_rectangle_area(0.5, d, r, 0, 1, 0, 1), area, 1e-12);
        PM_CHECK_NEAR(pm__disc_rectangle_area(0.5, 1 - d, r, 0, 1, 0, 1), area, 1e-12);
        PM_CHECK_NEAR(pm__disc_rectangle_area(-d, 0.5, r, 0, 1, 0, 1), pi * r * r - area, 1e-12);
    }
}
END_TEST

START_TEST(test_disc_limits)
{
    PM_CHECK_NEAR(pm__disc_rectangle_area(0, 0, 2, 0, 1, 0, 1), 1.0, 4e-15);       /* holds the square */
    PM_CHECK_NEAR(pm__disc_rectangle_area(0, 0, 0.5, 0, 1, 0, 1), pi / 16, 1e-15); /* a quarter */
    PM_CHECK_NEAR(pm__disc_rectangle_area(3, 0.5, 1, 0, 1, 0, 1), 0.0, 0.0);       /* apart */
    PM_CHECK_NEAR(pm__disc_rectangle_area(-3, -3, 4.2, 0, 1, 0, 1), 0.0, 0.0);     /* past a corner, not over it */
    PM_CHECK_NEAR(pm__disc_rectangle_area(0.5, 0.5, 0, 0, 1, 0, 1), 0.0, 0.0);
    PM_CHECK_NEAR(pm__disc_rectangle_area(7, -9, 2, -HUGE_VAL, HUGE_VAL, -HUGE_VAL, HUGE_VAL), 4 * pi, 1e-14);
    PM_CHECK_NEAR(pm__disc_rectangle_area(7, -9, 2, 7, HUGE_VAL, -HUGE_VAL, HUGE_VAL), 2 * pi, 1e-14);
}
END_TEST

/* The height inside the rectangle of a disc's chord. */
typedef struct slab {
    double y, r, y0, y1, x;
} slab;

static double chord(double x, void *context)
{
    const slab *const s = context;
    const double half = sqrt(fmax(0.0, s->r * s->r - (x - s->x) * (x - s->x)));
    return fmax(0.0, fmin(s->y1, s->y + half) - fmax(s->y0, s->y - half));
}

START_TEST(test_disc_against_quadrature)
{
    gsl_integration_cquad_workspace *const workspace = gsl_integration_cquad_workspace_alloc(400);
    for (uint64_t i = 0; i < 400; i++) {
        double u[8];
        uniform(i, u, 7);
        const double x = 3 * u[0] - 1, y = 3 * u[1] - 1, r = 2 * u[2];
        const double x0 = u[3] - 0.5, x1 = x0 + 1.5 * u[4], y0 = u[5] - 0.5, y1 = y0 + 1.5 * u[6];
        slab s = {y, r, y0, y1, x};
        const double from = fmax(x0, x - r), to = fmin(x1, x + r);
        double want = 0.0;
        const gsl_function f = {chord, &s};
        if (to > from)
            gsl_integration_cquad(&f, from, to, 1e-10, 1e-9, workspace, &want, NULL, NULL);
        PM_CHECK_NEAR(pm__disc_rectangle_area(x, y, r, x0, x1, y0, y1), want, 1e-8);
    }
    gsl_integration_cquad_workspace_free(workspace);
}
END_TEST

/* Fraction of a small ball inside a half space is (2 + 3q - q^3) / 4; a large ball is nearly one. */
START_TEST(test_balls_closed_forms)
{
    const double r = 1e-6, whole = 4.0 / 3.0 * pi * r * r * r;
    static const double table[][2] = {{0, 0.5}, {0.25, 0.68359375}, {0.5, 0.84375}, {0.75, 0.95703125}, {1.0, 1.0}};
    for (size_t i = 0; i < 5; i++)
        PM_CHECK_NEAR(pm__ball_ball_volume(1.0, r, 1.0 - table[i][0] * r) / whole, table[i][1], 2e-6);
    PM_CHECK_NEAR(pm__ball_ball_volume(1.0, 1.0, 1.0), 5 * pi / 12, 1e-14);
    PM_CHECK_NEAR(pm__ball_ball_volume(1.0, 0.5, 0.2), pi / 6, 1e-15);
    PM_CHECK_NEAR(pm__ball_ball_volume(0.5, 1.0, 0.2), pi / 6, 1e-15);
    PM_CHECK_NEAR(pm__ball_ball_volume(1.0, 0.5, 1.5), 0.0, 0.0);
    PM_CHECK_NEAR(pm__ball_ball_volume(1.0, 0.0, 0.2), 0.0, 0.0);
    PM_CHECK_NEAR(pm__ball_ball_volume(1.0, 1.0, 0.0), 4 * pi / 3, 1e-14);
}
END_TEST

typedef struct balls {
    double r1, r2, d;
} balls;

static double common_disc(double x, void *context)
{
    const balls *const b = context;
    const double s1 = b->r1 * b->r1 - x * x, s2 = b->r2 * b->r2 - (x - b->d) * (x - b->d);
    return pi * fmax(0.0, fmin(s1, s2));
}

/* The integrand is a parabola between the ends of the balls and the plane where they meet. */
START_TEST(test_balls_against_quadrature)
{
    gsl_integration_glfixed_table *const rule = gsl_integration_glfixed_table_alloc(8);
    for (uint64_t i = 0; i < 300; i++) {
        double u[3], want = 0.0;
        uniform(i, u, 3);
        balls b = {u[0], u[1], 2 * u[2]};
        const gsl_function f = {common_disc, &b};
        double cuts[5] = {-b.r1, b.r1, b.d - b.r2, b.d + b.r2, (b.d * b.d + b.r1 * b.r1 - b.r2 * b.r2) / (2 * b.d)};
        gsl_sort(cuts, 1, 5);
        for (int j = 0; j < 4; j++)
            want += gsl_integration_glfixed(&f, cuts[j], cuts[j + 1], rule);
        PM_CHECK_NEAR(pm__ball_ball_volume(b.r1, b.r2, b.d), want, 1e-13);
    }
    gsl_integration_glfixed_table_free(rule);
}
END_TEST

typedef struct counted {
    int kind, calls;
    double target;
} counted;

/* Smooth, of a triple root, flat but for a step, of slope 0, and of a wrong slope (NaN). */
static double function(const void *context, double x, double *slope)
{
    counted *const c = (counted *)(uintptr_t)context;
    c->calls++;
    switch (c->kind) {
    case 0:
        *slope = exp(x);
        return exp(x) - c->target;
    case 1:
        *slope = 3 * (x - c->target) * (x - c->target);
        return (x - c->target) * (x - c->target) * (x - c->target);
    case 2:
        *slope = 1e3 / pow(cosh(1e3 * (x - c->target)), 2);
        return tanh(1e3 * (x - c->target));
    case 3:
        *slope = 0.0;
        return x - c->target;
    default:
        *slope = (double)NAN;
        return x - c->target;
    }
}

START_TEST(test_root)
{
    for (int kind = 0; kind < 5; kind++)
        for (int i = 0; i <= 20; i++)
            for (int j = 0; j <= 20; j++) {
                const double root = 0.1 * i - 0.5, guess = 0.12 * j - 0.6; /* in [-0.5, 1.5] */
                counted c = {kind, 0, kind == 0 ? exp(root) : root};
                const double got = pm__increasing_root(function, &c, -0.5, 1.5, guess);
                /* A cube is not resolved beyond the cube root of what its subtraction keeps. */
                PM_CHECK_NEAR(got, root, kind == 1 ? 1e-14 : 4e-15);
                ck_assert_int_le(c.calls, kind == 0 ? 20 : 200);
            }
}
END_TEST

static double tangent(const void *context, double x, double *slope)
{
    const double t = tan(x);
    *slope = 1.0 + t * t;
    return t - *(const double *)context;
}

/* A pole at the end of the range: Newton's first step lands on it, where the next is small but far from the root. */
START_TEST(test_root_before_a_pole)
{
    const double end = asin(1.0) * (1.0 - 1e-9);
    for (int i = -20; i <= 40; i++)
        for (int j = 0; j <= 20; j++) {
            const double target = exp(0.2 * i);
            PM_CHECK_NEAR(pm__increasing_root(tangent, &target, 0.0, end, 0.05 * j * end), atan(target), 4e-15);
        }
}
END_TEST

START_TEST(test_root_without_change_of_sign)
{
    counted above = {0, 0, exp(5.0)}, below = {0, 0, exp(-5.0)};
    PM_CHECK_NEAR(pm__increasing_root(function, &above, 0, 1, 0.5), 1.0, 2e-15);
    PM_CHECK_NEAR(pm__increasing_root(function, &below, 0, 1, 0.5), 0.0, 2e-15);
    counted none = {0, 0, 1.0};
    PM_CHECK_NEAR(pm__increasing_root(function, &none, 0.25, 0.25, 0.5), 0.25, 0.0);
}
END_TEST

/* ---- Vectors and turns ---- */

/* Against libm in extended precision; the ends of all eighths, and their neighbours. */
START_TEST(test_turn)
{
    const long double full = 6.28318530717958647692528676655900577L;
    for (int i = 0; i < 200000; i++) {
        double u, sine, cosine;
        uniform((uint64_t)i, &u, 1);
        if (i < 27) /* 0 to 1 by eighths, the value below and the one above */
            u = nextafter(i / 3 / 8.0, i % 3 - 1.0 + (i % 3 == 1) * (i / 3 / 8.0));
        if (!(u >= 0.0 && u <= 1.0))
            continue;
        pm__turn(u, &sine, &cosine);
        PM_CHECK_NEAR(sine, (double)sinl(full * (long double)u), 0x1p-52);
        PM_CHECK_NEAR(cosine, (double)cosl(full * (long double)u), 0x1p-52);
    }
}
END_TEST

/* At any size, as far as double reaches: the same as with care but for rounding. */
START_TEST(test_normalize)
{
    for (int i = 0; i < 20000; i++) {
        double u[4], v[3], w[3];
        uniform((uint64_t)i, u, 4);
        const double size = ldexp(1.0, (int)(u[3] * 2000.0) - 1000);
        for (int a = 0; a < 3; a++)
            v[a] = w[a] = (2.0 * u[a] - 1.0) * size;
        const double length = pm__normalize(v), same = pm__normalize_near(w);
        PM_CHECK_NEAR(same / length, 1.0, 1e-15);
        PM_CHECK_NEAR(pm__dot(w, w), 1.0, 1e-15);
        for (int a = 0; a < 3; a++)
            PM_CHECK_NEAR(w[a], v[a], 5e-16);
    }
    double zero[3] = {0.0, 0.0, 0.0};
    PM_CHECK_NEAR(pm__normalize_near(zero), 0.0, 0.0);
    PM_CHECK_NEAR(zero[0], 0.0, 0.0);
}
END_TEST

PM_TEST_MAIN("geometry", test_disc_at_a_side, test_disc_limits, test_disc_against_quadrature, test_balls_closed_forms,
             test_balls_against_quadrature, test_root, test_root_before_a_pole, test_root_without_change_of_sign,
             test_turn, test_normalize)
