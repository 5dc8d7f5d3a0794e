/* Lights: where photons start and where they go, by moments and a chi-square. Bounds are 6 standard deviations of the
 * true distribution: a false alarm once in 5e8 comparisons, 2e-7 for the file. */
#include "../../src/base/random.h"
#include "../../src/base/vec3.h"
#include "../../src/scene/light.h"
#include "../test.h"

#include <string.h>

enum { SAMPLES = 200000 };

static const double pi = 3.14159265358979323846;

typedef struct ray {
    double position[3], direction[3];
} ray;

static ray emit(const pm__light *light, uint64_t number)
{
    double u[4];
    ray r;
    pm__random_uniform(1, PM__FOR_TESTS, (uint32_t)light->kind, number, u, 4);
    pm__emit(light, u, r.position, r.direction);
    PM_CHECK_NEAR(pm__dot(r.direction, r.direction), 1.0, 1e-14);
    return r;
}

static void check_mean(const char *what, double sum, double want, double variance)
{
    const double error = sqrt(variance / SAMPLES), got = sum / SAMPLES;
    ck_assert_msg(fabs(got - want) <= 6.0 * error, "%s: %g, expected %g, error %g", what, got, want, error);
}

/* Uniform in [0, 1)? 100 bins; chi-square by the cube root of Wilson and Hilferty, 6 standard deviations. */
static void check_uniform(const char *what, const unsigned counts[100])
{
    double chi2 = 0.0;
    const double want = SAMPLES / 100.0;
    for (int i = 0; i < 100; i++)
        chi2 += (counts[i] - want) * (counts[i] - want) / want;
    const double v = 2.0 / (9.0 * 99.0), z = (cbrt(chi2 / 99.0) - (1.0 - v)) / sqrt(v);
    ck_assert_msg(z < 6.0, "%s: chi-square %g of 99", what, chi2);
}

static int bin(double x)
{
    return x <= 0.0 ? 0 : x >= 1.0 ? 99 : (int)(100.0 * x);
}

START_TEST(test_point)
{
    const pm__light light = {.kind = PM__POINT, .position = {1.0, 2.0, 3.0}};
    unsigned heights[100] = {0}, turns[100] = {0};
    for (uint64_t i = 0; i < SAMPLES; i++) {
        const ray r = emit(&light, i);
        PM_CHECK_NEAR(r.position[1], 2.0, 0.0);
        heights[bin(0.5 + 0.5 * r.direction[2])]++; /* Archimedes: uniform */
        turns[bin(0.5 + atan2(r.direction[1], r.direction[0]) / (2.0 * pi))]++;
    }
    check_uniform("height", heights);
    check_uniform("turn", turns);
}
END_TEST

START_TEST(test_spot)
{
    const pm__light light = {.kind = PM__SPOT, .direction = {0.6, 0.0, -0.8}, .angle = 0.3};
    unsigned below[100] = {0};
    double side = 0.0;
    for (uint64_t i = 0; i < SAMPLES; i++) {
        const ray r = emit(&light, i);
        const double cosine = pm__dot(r.direction, light.direction);
        ck_assert(cosine >= cos(0.3) - 1e-12);
        below[bin((1.0 - cosine) / (1.0 - cos(0.3)))]++;
        side += r.direction[1];
    }
    check_uniform("cosine", below);
    check_mean("sideways", side, 0.0, 0.5 * sin(0.3) * sin(0.3));
}
END_TEST

START_TEST(test_directional)
{
    const pm__light light = {
        .kind = PM__DIRECTIONAL, .position = {0.0, 0.0, 5.0}, .direction = {0.6, 0.0, -0.8}, .radius = 2.0};
    unsigned radii[100] = {0};
    double y = 0.0, y2 = 0.0;
    for (uint64_t i = 0; i < SAMPLES; i++) {
        const ray r = emit(&light, i);
        const double offset[3] = {r.position[0], r.position[1], r.position[2] - 5.0};
        PM_CHECK_NEAR(r.direction[0], 0.6, 0.0);
        PM_CHECK_NEAR(pm__dot(offset, light.direction), 0.0, 1e-14);
        radii[bin(pm__dot(offset, offset) / 4.0)]++;
        y += offset[1];
        y2 += offset[1] * offset[1];
    }
    check_uniform("squared radius", radii);
    check_mean("y", y, 0.0, 1.0);        /* R^2 / 4 */
    check_mean("y squared", y2, 1.0, 1.0); /* E y^4 = R^4 / 8 = 2 */
}
END_TEST

START_TEST(test_rectangle)
{
    const pm__light light = {
        .kind = PM__RECTANGLE, .position = {-1.0, -1.0, 2.0}, .edge = {{0.0, 4.0, 0.0}, {2.0, 0.0, 0.0}}};
    unsigned along[100] = {0}, across[100] = {0}, cosines[100] = {0};
    double x = 0.0;
    for (uint64_t i = 0; i < SAMPLES; i++) {
        const ray r = emit(&light, i);
        ck_assert(r.direction[2] < 0.0); /* y cross x is -z */
        PM_CHECK_NEAR(r.position[2], 2.0, 0.0);
        along[bin((r.position[1] + 1.0) / 4.0)]++;
        across[bin((r.position[0] + 1.0) / 2.0)]++;
        cosines[bin(r.direction[2] * r.direction[2])]++; /* Lambert: cos^2 is uniform */
        x += r.direction[0];
    }
    check_uniform("along", along);
    check_uniform("across", across);
    check_uniform("squared cosine", cosines);
    check_mean("x", x, 0.0, 0.25);
}
END_TEST

/* sign: of the side that shines. */
static void check_ball(bool inward, double sign)
{
    const pm__light light = {.kind = PM__BALL, .position = {0.0, 1.0, 0.0}, .radius = 0.5, .inward = inward};
    unsigned heights[100] = {0}, cosines[100] = {0}, ways[100] = {0};
    for (uint64_t i = 0; i < SAMPLES; i++) {
        const ray r = emit(&light, i);
        const double normal[3] = {2.0 * r.position[0], 2.0 * (r.position[1] - 1.0), 2.0 * r.position[2]};
        PM_CHECK_NEAR(pm__dot(normal, normal), 1.0, 1e-14);
        const double cosine = sign * pm__dot(normal, r.direction);
        ck_assert(cosine > 0.0);
        heights[bin(0.5 + 0.5 * normal[1])]++;
        cosines[bin(cosine * cosine)]++;
        ways[bin(0.5 + 0.5 * r.direction[0])]++; /* all in all, isotropic */
    }
    check_uniform("height", heights);
    check_uniform("squared cosine", cosines);
    check_uniform("way", ways);
}

START_TEST(test_ball)
{
    check_ball(false, 1.0);
    check_ball(true, -1.0);
}
END_TEST

static void check_refused(pm__light light, const char *name)
{
    pm_error error;
    ck_assert_int_eq(pm__light_check(&light, &error), PM_EINVAL);
    ck_assert_msg(strstr(error.text, name) != NULL, "'%s' does not name '%s'", error.text, name);
}

START_TEST(test_refusals)
{
    pm_error error;
    const double white[3] = {1.0, 1.0, 0.0};
    pm__light good = {.kind = PM__SPOT, .direction = {0.0, 0.0, 1.0}, .angle = 0.5, .radius = 1.0,
                      .edge = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}};
    check_refused(good, "power");
    memcpy(good.power, white, sizeof white);
    for (int kind = PM__POINT; kind <= PM__SUN; kind++) {
        good.kind = (pm__light_kind)kind;
        PM_CHECK_OK(pm__light_check(&good, &error), error);
        pm__light bad = good;
        bad.power[1] = -1.0;
        check_refused(bad, "power[1]");
        bad = good;
        bad.position[2] = NAN;
        check_refused(bad, "position[2]");
    }
    pm__light bad = good;
    bad.kind = PM__SPOT;
    bad.angle = 0.0;
    check_refused(bad, "angle");
    bad.angle = 0.5;
    bad.direction[0] = 0.1;
    check_refused(bad, "direction");
    bad.kind = PM__SUN;
    check_refused(bad, "direction");
    bad.angle = 0.51 * pi;
    check_refused(bad, "angle");
    bad.angle = 0.0;
    check_refused(bad, "angle");
    bad.radius = 0.0;
    bad.angle = 0.5;
    check_refused(bad, "radius");
    bad = good;
    bad.kind = PM__BALL;
    bad.radius = -1.0;
    check_refused(bad, "radius");
    bad.radius = 1.0;
    bad.inward = true;
    PM_CHECK_OK(pm__light_check(&bad, &error), error);
    bad.kind = PM__POINT;
    check_refused(bad, "inward");
    bad = good;
    bad.kind = PM__RECTANGLE;
    bad.edge[1][0] = 3.0;
    bad.edge[1][1] = 0.0;
    check_refused(bad, "edges");
}
END_TEST

PM_TEST_MAIN("light", test_point, test_spot, test_directional, test_rectangle, test_ball, test_refusals)
