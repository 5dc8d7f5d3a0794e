/* Light that arrives at a point and light that is seen, against closed forms and against each other.
 *
 * Closed forms of the irradiance E on a plane whose upper side, with unit normal n, sees all of the light:
 * point, power Phi                Phi cos / (4 pi d^2)
 * spot of half angle a            Phi cos / (2 pi (1 - cos a) d^2) within the cone
 * parallel through a disc         Phi cos / (pi R^2) within the cylinder ahead of it
 * polygon of radiance L           (L / 2) sum over edges of beta_i gamma_i: beta_i the angle of the edge as seen,
 *                                 gamma_i the cosine between n and the normal of the edge's plane (Lambert 1760)
 * ball of radiance L              pi L (R / d)^2 cos: each cosine-weighted direction of its cone has its mirror image
 *                                 about the axis
 * inside of a ball                pi L from within (all directions show L), as a ball from without
 * A light of area A and power Phi has L = Phi / (pi A). */
#include "../../src/base/sobol.h"
#include "../../src/base/vec3.h"
#include "../../src/scene/light.h"
#include "../test.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

enum { GRID = 300, DIRECTIONS = 1 << 18 };

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Is the sample sound: a unit direction toward its place, bands in the ratio of the power? */
static bool is_sound(const pm__light *light, const double point[3], const pm__light_sample *sample)
{
    double way[3], off = 0.0;
    for (int a = 0; a < 3; a++)
        way[a] = sample->position[a] - point[a];
    const double length = sqrt(pm__dot(way, way));
    for (int a = 0; a < 3; a++)
        off = fmax(off, fabs(way[a] - length * sample->direction[a]) / (length + fabs(point[a])));
    const double ratio = sample->irradiance[1] / sample->irradiance[0] * light->power[0] / light->power[1];
    const double unit = pm__dot(sample->direction, sample->direction);
    return off < 1e-11 && fabs(ratio - 1.0) < 1e-12 && fabs(unit - 1.0) < 1e-13;
}

/* The mean over u of what arrives, in red, by the midpoint rule. */
static double received(const pm__light *light, const double point[3], const double normal[3], int grid)
{
    double sum = 0.0;
    for (int i = 0; i < grid * grid; i++) {
        const double u[2] = {(i % grid + 0.5) / grid, (i / grid + 0.5) / grid};
        pm__light_sample s;
        if (!pm__light_reach(light, point, u, &s))
            continue;
        if (!is_sound(light, point, &s))
            ck_abort_msg("what arrives from u = (%g, %g) is not sound", u[0], u[1]);
        sum += s.irradiance[0] * fmax(0.0, pm__dot(s.direction, normal));
    }
    return sum / (grid * grid);
}

/* pi times the mean of what is seen over cosine-weighted directions. */
static double seen(const pm__light *light, const double point[3], const double normal[3])
{
    double s[3], t[3], sum = 0.0;
    pm__basis(normal, s, t);
    for (uint32_t i = 0; i < DIRECTIONS; i++) {
        const double angle = 2.0 * pi * pm__sobol(i, 0) * 0x1p-32, r2 = (pm__sobol(i, 1) + 0.5) * 0x1p-32;
        double direction[3], radiance[3], distance;
        for (int a = 0; a < 3; a++)
            direction[a] = sqrt(r2) * (cos(angle) * s[a] + sin(angle) * t[a]) + sqrt(1.0 - r2) * normal[a];
        (void)pm__light_seen(light, point, direction, (double)INFINITY, radiance, &distance);
        sum += radiance[0];
    }
    return pi * sum / DIRECTIONS;
}

static void unit_normal(double x, double y, double z, double n[3])
{
    n[0] = x;
    n[1] = y;
    n[2] = z;
    pm__normalize(n);
}

/* Lambert's formula for a parallelogram that is wholly above the receiver's plane. */
static double polygon(const pm__light *light, const double point[3], const double normal[3])
{
    double corner[4][3], sum = 0.0;
    for (int i = 0; i < 4; i++) /* counterclockwise from its dark side, so that the sum is positive */
        for (int a = 0; a < 3; a++)
            corner[i][a] = light->position[a] - point[a] + (i == 1 || i == 2 ? light->edge[1][a] : 0.0) +
                           (i == 2 || i == 3 ? light->edge[0][a] : 0.0);
    double area[3];
    cross(light->edge[0], light->edge[1], area);
    for (int i = 0; i < 4; i++) {
        double plane[3];
        const double *const a = corner[i], *const b = corner[(i + 1) % 4];
        cross(a, b, plane);
        const double beta = atan2(sqrt(pm__dot(plane, plane)), pm__dot(a, b));
        pm__normalize(plane);
        sum += beta * pm__dot(plane, normal);
    }
    return 0.5 * light->power[0] / (pi * sqrt(pm__dot(area, area))) * sum;
}

START_TEST(points_and_spots)
{
    const double at[3] = {0.5, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    pm__light light = {.kind = PM__POINT, .power = {1, 2, 3}, .position = {0, 0, 1}};
    PM_CHECK_NEAR(received(&light, at, up, 2), .056941003473, 1e-12);
    light.kind = PM__SPOT;
    light.angle = 0.5;
    light.direction[2] = -1.0;
    const double all = 1.0 / (2.0 * pi * (1.0 - cos(0.5)) * 1.25) / sqrt(1.25);
    PM_CHECK_NEAR(received(&light, at, up, 2), all, 1e-12 * all);
    pm__light_sample s;
    static const double u[2] = {0.5, 0.5};
    for (double angle = pi / 2.0; angle > 1e-9; angle *= 0.1) /* just within and just beyond the edge */
        for (int i = 0; i < 20; i++) {
            double a[3], b[3], inside[3], outside[3];
            unit_normal(cos(i), sin(2.0 * i), cos(3.0 * i + 1.0), light.direction);
            pm__basis(light.direction, a, b);
            light.angle = angle;
            memset(light.position, 0, sizeof light.position);
            const double in = angle * (1.0 - 1e-6), out = angle * (1.0 + 1e-6);
            for (int j = 0; j < 3; j++) {
                inside[j] = 2.0 * (sin(in) * a[j] + cos(in) * light.direction[j]);
                outside[j] = 2.0 * (sin(out) * a[j] + cos(out) * light.direction[j]);
            }
            ck_assert_msg(pm__light_reach(&light, inside, u, &s), "angle %g: dark inside", angle);
            const double e = 1.0 / (4.0 * pi * pow(sin(0.5 * angle), 2) * 4.0);
            PM_CHECK_NEAR(s.irradiance[0], e, 1e-12 * e);
            ck_assert_msg(!pm__light_reach(&light, outside, u, &s), "angle %g: lit outside", angle);
        }
    light.angle = pi; /* a point light */
    ck_assert(pm__light_reach(&light, at, u, &s));
    PM_CHECK_NEAR(s.irradiance[0], 1.0 / (4.0 * pi * 0.25), 1e-12);
    ck_assert(!pm__light_reach(&light, light.position, u, &s));
}
END_TEST

START_TEST(parallel_light)
{
    pm__light light = {.kind = PM__DIRECTIONAL, .power = {2, 1, 4}, .position = {1, 2, 3}, .radius = 0.7};
    static const double u[2] = {0.1, 0.9};
    unit_normal(0.3, -0.4, -0.8, light.direction);
    double s[3], t[3];
    pm__basis(light.direction, s, t);
    static const double ahead[] = {1e-6, 1.0, 1e6}, across[] = {0.0, 0.69999, 0.70001, 5.0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            for (int side = -1; side <= 1; side += 2) {
                double point[3];
                pm__light_sample sample;
                for (int a = 0; a < 3; a++)
                    point[a] = light.position[a] + side * ahead[i] * light.direction[a] + across[j] * t[a];
                const bool lit = pm__light_reach(&light, point, u, &sample);
                ck_assert_msg(lit == (side > 0 && j < 2), "%g m ahead, %g m across", side * ahead[i], across[j]);
                for (int a = 0; lit && a < 3; a++) {
                    PM_CHECK_NEAR(sample.direction[a], -light.direction[a], 0.0);
                    PM_CHECK_NEAR(sample.position[a], light.position[a] + across[j] * t[a], 1e-9);
                    PM_CHECK_NEAR(sample.irradiance[a], light.power[a] / (pi * 0.49), 1e-12);
                }
            }
}
END_TEST

START_TEST(a_square_has_lamberts_irradiance)
{
    static const double places[][3] = {{0, 0, .752274688454},  {.5, 0, .566645112050},   {.5, .5, .435209875684},
                                       {1, 0, .265004852345}, {1, 1, .124353233794}, {2, 0, .043742648315}};
    static const double up[3] = {0, 0, 1};
    const pm__light light = {.kind = PM__RECTANGLE, .power = {pi, pi, pi}, .position = {-.5, -.5, 1},
                             .edge = {{0, 1, 0}, {1, 0, 0}}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const double at[3] = {places[i][0], places[i][1], 0.0};
        PM_CHECK_NEAR(polygon(&light, at, up), places[i][2], 1e-11);
        PM_CHECK_NEAR(received(&light, at, up, GRID), places[i][2], 1e-5 * places[i][2]);
        PM_CHECK_NEAR(seen(&light, at, up), places[i][2], 5e-4 * places[i][2] + 1e-4);
    }
}
END_TEST

START_TEST(a_parallelogram_has_lamberts_irradiance)
{
    static const double skews[] = {0.0, 0.5, -3.0, 20.0};
    for (size_t i = 0; i < sizeof skews / sizeof *skews; i++) {
        const pm__light light = {.kind = PM__RECTANGLE, .power = {3, 2, 1}, .position = {-.3, .2, 2},
                                 .edge = {{skews[i], 1.1, 0.2}, {0.9, 0.0, -0.1}}};
        double normal[3];
        const double at[3] = {0.4, 0.1, -0.5};
        unit_normal(0.1, 0.1, 1.0, normal);
        const double want = polygon(&light, at, normal);
        ck_assert_double_gt(want, 0.0);
        PM_CHECK_NEAR(received(&light, at, normal, GRID), want, 1e-3 * want);
        PM_CHECK_NEAR(seen(&light, at, normal), want, 2e-3 * want + 1e-4);
    }
}
END_TEST

START_TEST(balls_from_without)
{
    for (int inward = 0; inward < 2; inward++)
        for (int i = 0; i < 8; i++) {
            const double radius = 0.5, distance = i < 4 ? 0.6 + 0.3 * i : pow(100.0, i - 3);
            const pm__light light = {.kind = PM__BALL, .power = {2, 2, 2}, .radius = radius, .inward = inward,
                                     .position = {1, -2, 3}};
            double axis[3], s[3], t[3], normal[3], at[3];
            unit_normal(0.2 + i, 0.5, -0.7, axis);
            pm__basis(axis, s, t);
            const double ratio = radius / distance, tilt = i % 2 ? 0.5 * acos(ratio) : 0.0; /* all of it above */
            for (int a = 0; a < 3; a++) {
                at[a] = light.position[a] - distance * axis[a];
                normal[a] = cos(tilt) * axis[a] + sin(tilt) * s[a];
            }
            const double radiance = 2.0 / (pi * 4.0 * pi * radius * radius);
            const double want = pi * radiance * ratio * ratio * cos(tilt);
            if (!inward || distance < 2.0) /* an inward one is sampled by area: points on its rim count little */
                PM_CHECK_NEAR(received(&light, at, normal, GRID), want, (inward ? 2e-3 : 1e-9) * want);
            else
                PM_CHECK_NEAR(received(&light, at, normal, GRID), want, 1e-4 * want);
            if (distance < 2.0)
                PM_CHECK_NEAR(seen(&light, at, normal), want, 2e-3 * want);
        }
}
END_TEST

START_TEST(balls_from_within)
{
    const double radius = 2.0, radiance = 5.0 / (pi * 4.0 * pi * radius * radius);
    for (int i = 0; i < 4; i++) {
        pm__light light = {.kind = PM__BALL, .power = {5, 5, 5}, .radius = radius, .inward = true,
                           .position = {1, 1, 1}};
        const double at[3] = {1.0 + 0.4 * i, 1.0, 1.0 - 0.2 * i};
        double normal[3];
        unit_normal(i, 1.0, 0.5 - i, normal);
        PM_CHECK_NEAR(received(&light, at, normal, GRID), pi * radiance, 3e-3 * pi * radiance);
        PM_CHECK_NEAR(seen(&light, at, normal), pi * radiance, 1e-9);
        light.inward = false;
        PM_CHECK_NEAR(received(&light, at, normal, 8), 0.0, 0.0);
        PM_CHECK_NEAR(seen(&light, at, normal), 0.0, 0.0);
    }
}
END_TEST

static bool is_seen(const pm__light *light, const double origin[3], const double toward[3], double reach)
{
    double direction[3] = {toward[0] - origin[0], toward[1] - origin[1], toward[2] - origin[2]};
    double radiance[3], distance;
    const double length = pm__normalize(direction);
    const bool met = pm__light_seen(light, origin, direction, reach, radiance, &distance);
    ck_assert(met == (radiance[0] > 0.0));
    ck_assert(!met || light->kind != PM__RECTANGLE || fabs(distance / length - 1.0) < 1e-12);
    return met;
}

/* Far off a light is a point; what is aimed at its rim meets or misses it as it should. */
START_TEST(from_afar)
{
    const pm__light square = {.kind = PM__RECTANGLE, .power = {4, 4, 4}, .position = {-.5, -.5, 0},
                              .edge = {{0, 1, 0}, {1, 0, 0}}};
    const pm__light ball = {.kind = PM__BALL, .power = {4, 4, 4}, .radius = 0.5};
    for (double distance = 1e2; distance < 2e7; distance *= 1e2) {
        double at[3], up[3];
        unit_normal(0.3, 0.2, 1.0, up);
        for (int a = 0; a < 3; a++)
            at[a] = -distance * up[a];
        const double wide = 4.0 * up[2] / (pi * distance * distance), each = 1.0 / (pi * distance * distance);
        PM_CHECK_NEAR(received(&square, at, up, 16), wide, (1e-9 + pow(distance, -2)) * wide);
        PM_CHECK_NEAR(received(&ball, at, up, 4), each, 1e-9 * each);
        for (int i = 0; i < 4; i++) {
            const double x = i % 2 ? 0.499 : 0.501, sign = i < 2 ? 1.0 : -1.0;
            const double on[3] = {sign * x, 0.3, 0.0}, s[3] = {up[2] * sign, 0.0, -up[0] * sign};
            const double length = sqrt(pm__dot(s, s)) / x;
            const double rim[3] = {s[0] / length, s[1] / length, s[2] / length};
            ck_assert_msg(is_seen(&square, at, on, INFINITY) == (i % 2 == 1), "square from %g m, %g", distance, x);
            ck_assert_msg(is_seen(&ball, at, rim, INFINITY) == (i % 2 == 1), "ball from %g m, %g", distance, x);
        }
    }
}
END_TEST

/* Seen as far as the ray goes, and from the front alone; in its own plane a flat light sends and shows nothing. */
START_TEST(how_far_and_from_where)
{
    static const double u[2] = {0.3, 0.6}, origin[3] = {0, 0, 0}, middle[3] = {0, 0, 2}, above[3] = {0, 0, 5};
    const pm__light square = {.kind = PM__RECTANGLE, .power = {1, 1, 1}, .position = {-1, -1, 2},
                              .edge = {{0, 2, 0}, {2, 0, 0}}};
    pm__light ball = {.kind = PM__BALL, .power = {1, 1, 1}, .radius = 0.5, .position = {0, 0, 2}};
    pm__light_sample s;
    ck_assert(is_seen(&square, origin, middle, 2.0 + 1e-12) && !is_seen(&square, origin, middle, 2.0 - 1e-12));
    ck_assert(is_seen(&ball, origin, middle, 1.5 + 1e-12) && !is_seen(&ball, origin, middle, 1.5 - 1e-12));
    ck_assert(is_seen(&ball, above, middle, 2.5 + 1e-12) && !is_seen(&ball, above, middle, 2.5 - 1e-12));
    ball.inward = true; /* its far side */
    ck_assert(is_seen(&ball, origin, middle, 2.5 + 1e-12) && !is_seen(&ball, origin, middle, 2.5 - 1e-12));
    ck_assert(!is_seen(&square, above, middle, INFINITY) && !pm__light_reach(&square, above, u, &s));
    static const double beside[3] = {3, 0, 2}, within[3] = {0.2, 0.1, 2};
    ck_assert(!is_seen(&square, beside, middle, INFINITY) && !pm__light_reach(&square, beside, u, &s));
    ck_assert(!is_seen(&square, within, middle, INFINITY) && !pm__light_reach(&square, within, u, &s));
    ck_assert(!is_seen(&square, middle, above, INFINITY)); /* behind the ray */
}
END_TEST

PM_TEST_MAIN("light seen", points_and_spots, parallel_light, a_square_has_lamberts_irradiance,
             a_parallelogram_has_lamberts_irradiance, balls_from_without, balls_from_within, from_afar,
             how_far_and_from_where)
