/* Cases: their exact values, and what holds for every one of them at the ends of its parameters' ranges. */
#include "../case_charts.h"

#include "../../cases/list.h"
#include "../../src/base/geometry.h"
#include "../../src/base/random.h"

#include <gsl/gsl_integration.h>

static const double pi = 3.14159265358979323846;

static const pm__shape sphere = {PM_LOOKUP_SPHERE, 0.0, false};

static const pm__case *parse(const char *text, pm__spec *spec)
{
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__cases, text, spec, &error), error);
    return (const pm__case *)(const void *)spec->entry;
}

static pm__probe at(double x, double y, double z, double nx, double ny, double nz)
{
    return (pm__probe){.position = {x, y, z}, .normal = {nx, ny, nz}};
}

static double truth(const char *text, double x, double y)
{
    pm__spec spec;
    const pm__case *const c = parse(text, &spec);
    const pm__probe probe = at(x, y, 0, 0, 0, 1);
    return c->truth(spec.values, &probe);
}

/* Expectation of a disc estimate of fixed radius. */
static double disc(const char *text, const pm__probe *probe, const pm__shape *shape, double r)
{
    pm__spec spec;
    const pm__case *const c = parse(text, &spec);
    return c->mass(spec.values, probe, shape, 0.0, r) / (pi * r * r);
}

static double disc_at(const char *text, double x, double y, double r)
{
    const pm__probe probe = at(x, y, 0, 0, 0, 1);
    return disc(text, &probe, &sphere, r);
}

/* Fraction of a disc on the inner side of a line at q radii from its centre. */
static const double fractions[][2] = {
    {0.0, 0.5}, {0.25, 0.6574811788}, {0.5, 0.8044988905}, {0.75, 0.9278531936}, {0.9, 0.9813069633}};

START_TEST(test_square)
{
    for (int i = 0; i < 5; i++) {
        const double d = 0.1 * fractions[i][0];
        PM_CHECK_NEAR(disc_at("square:irradiance=3", d, 0.5, 0.1), 3 * fractions[i][1], 3e-10);
        PM_CHECK_NEAR(disc_at("square", 0.5, 1 - d, 0.1), fractions[i][1], 1e-10);
    }
    PM_CHECK_NEAR(disc_at("square", 0, 1, 0.1), 0.25, 1e-14);
    PM_CHECK_NEAR(truth("square:irradiance=3", 0, 0), 3.0, 0.0);
}
END_TEST

static double along_x(double x, void *y)
{
    return disc_at("square", x, *(double *)y, 0.1);
}

static double along_y(double y, void *rule)
{
    const gsl_function f = {along_x, &y};
    return gsl_integration_glfixed(&f, 0.0, 0.1, rule) * 2 + 0.8 * along_x(0.5, &y);
}

/* Mean over the square: 1 - 8R / (3 pi) + R^2 / (2 pi). */
START_TEST(test_square_mean)
{
    gsl_integration_glfixed_table *const rule = gsl_integration_glfixed_table_alloc(48);
    const gsl_function f = {along_y, rule};
    const double mean = gsl_integration_glfixed(&f, 0.0, 0.1, rule) * 2 + 0.8 * along_y(0.5, rule);
    PM_CHECK_NEAR(mean, 1 - 0.8 / (3 * pi) + 0.01 / (2 * pi), 1e-7);
    PM_CHECK_NEAR(mean, 0.9167089, 2e-7);
    gsl_integration_glfixed_table_free(rule);
}
END_TEST

START_TEST(test_smooth_fields)
{
    PM_CHECK_NEAR(truth("gradient:slope=1.5,irradiance=2", 0.75, 0.1), 2 * 1.375, 1e-15);
    PM_CHECK_NEAR(disc_at("gradient:slope=1.5", 0.6, 0.3, 0.2), 1.15, 1e-14);

    PM_CHECK_NEAR(truth("quadratic:curvature=100,irradiance=2", 0.8, 0.9), 2 * 26.0, 1e-13);
    PM_CHECK_NEAR(disc_at("quadratic:curvature=100", 0.5, 0.5, 0.1), 1.5, 1e-14); /* 1 + a R^2 / 2 */
    PM_CHECK_NEAR(disc_at("quadratic:curvature=100", 0.6, 0.7, 0.1), 6.5, 1e-13);

    PM_CHECK_NEAR(truth("blob:sigma=0.2", 0.5, 0.9), exp(-2.0), 1e-15);
    PM_CHECK_NEAR(disc_at("blob:sigma=0.2", 0.5, 0.5, 0.1), 0.94002478, 5e-9);
    PM_CHECK_NEAR(disc_at("blob:sigma=0.2", 0.5, 0.5, 0.3), 0.60030892, 5e-9);
}
END_TEST

/* E0 (1 + c H(kR) cos kx), H(z) = 2 J1(z) / z. */
START_TEST(test_sinusoid)
{
    static const double table[][2] = {{0.5, 0.9690738307}, {1.0, 0.8801011715}, {2.0, 0.5767248078},
                                      {3.8317059702, 0.0}, {5.0, -0.1310316550}};
    const double k = 2 * pi * 20, x = 0.51;
    PM_CHECK_NEAR(truth("sinusoid:cycles=20,contrast=0.7,irradiance=2", x, 0.3), 2 + 1.4 * cos(k * x), 1e-12);
    for (int i = 0; i < 5; i++) {
        const double mean = disc_at("sinusoid:cycles=20,contrast=0.7,irradiance=2", x, 0.3, table[i][0] / k);
        PM_CHECK_NEAR((0.5 * mean - 1) / (0.7 * cos(k * x)), table[i][1], 2e-10);
    }
}
END_TEST

START_TEST(test_edge)
{
    for (int i = 0; i < 5; i++) {
        const double q = fractions[i][0], f = fractions[i][1];
        PM_CHECK_NEAR(disc_at("edge", 0.5 - 0.1 * q, 0.5, 0.1), f, 1e-10);
        PM_CHECK_NEAR(disc_at("edge", 0.5 + 0.1 * q, 0.5, 0.1), 1 - f, 1e-10);
        PM_CHECK_NEAR(disc_at("edge:dark=0.25", 0.5 + 0.1 * q, 0.5, 0.1), 1 - 0.75 * f, 1e-10);
    }
    PM_CHECK_NEAR(truth("edge:dark=0.25,irradiance=4", 0.499, 0.5), 4.0, 0.0);
    PM_CHECK_NEAR(truth("edge:dark=0.25,irradiance=4", 0.501, 0.5), 1.0, 0.0);
}
END_TEST

START_TEST(test_point_light)
{
    static const double table[][2] = {
        {0.0, .079577471546}, {0.5, .056941003473}, {1.0, .028134884880}, {2.0, .007117625434}};
    for (int i = 0; i < 4; i++) {
        PM_CHECK_NEAR(truth("point-light", table[i][0] * 0.6, table[i][0] * 0.8), table[i][1], 1e-12);
        PM_CHECK_NEAR(truth("point-light:power=3,height=2", table[i][0] * 2, 0), 0.75 * table[i][1], 1e-12);
    }
    /* Around the foot: half the power, times 1 - h / sqrt(h^2 + r^2). */
    PM_CHECK_NEAR(disc_at("point-light:power=3", 0, 0, 0.75) * pi * 0.5625, 1.5 * (1 - 0.8), 1e-8);
}
END_TEST

START_TEST(test_rect_light)
{
    static const double table[][3] = {{0, 0, .752274688454},   {.5, 0, .566645112050}, {.5, .5, .435209875684},
                                      {1, 0, .265004852345},   {1, 1, .124353233794},  {2, 0, .043742648315},
                                      {0, -.5, .566645112050}, {-1, 1, .124353233794}};
    for (int i = 0; i < 8; i++) {
        PM_CHECK_NEAR(truth("rect-light", table[i][0], table[i][1]), table[i][2], 1e-12);
        PM_CHECK_NEAR(truth("rect-light:radiance=5,width=3,depth=3,height=3", 3 * table[i][0], 3 * table[i][1]),
                      5 * table[i][2], 1e-11);
    }
}
END_TEST

/* Of pi L A, the rest falls beyond a large floor: the fraction within 1.5 h of the outline grows to 1 with the
 * light. */
START_TEST(test_rect_light_power)
{
    pm__spec spec;
    const pm__case *c = parse("rect-light", &spec);
    ck_assert(c->power(spec.values) < pi && c->power(spec.values) > 0.75 * pi);
    c = parse("rect-light:width=100,depth=100,height=0.1", &spec);
    PM_CHECK_NEAR(c->power(spec.values) / (pi * 1e4), 1.0, 1e-3);
}
END_TEST

START_TEST(test_corner)
{
    static const double wall[] = {0.5, 0.46875, 0.375, 0.21875, 0.095};
    const double r = 0.1;
    const pm__shape squashed = {PM_LOOKUP_ELLIPSOID, 4.0, false}, flat = {PM_LOOKUP_DISC, 0.01, false},
                    front = {PM_LOOKUP_SPHERE, 0.0, true};
    for (int i = 0; i < 5; i++) {
        const double q = fractions[i][0], f = fractions[i][1];
        const pm__probe probe = at(q * r, 0.5, 0, 0, 0, 1);
        PM_CHECK_NEAR(disc("corner:irradiance=2,wall=3", &probe, &sphere, r), 2 * f + 3 * wall[i], 1e-9);
        PM_CHECK_NEAR(disc("corner:irradiance=2,wall=3", &probe, &squashed, r), 2 * f + 0.75 * wall[i], 1e-9);
        PM_CHECK_NEAR(disc("corner:irradiance=2,wall=3", &probe, &front, r), 2 * f, 1e-9);
        PM_CHECK_NEAR(disc("corner:irradiance=2,wall=3", &probe, &flat, r),
                      2 * f + 3 * 2 * r * sqrt(1 - q * q) * 0.01 / (pi * r * r), 1e-9);
    }
    PM_CHECK_NEAR(truth("corner:irradiance=2,wall=3", 0, 0.5), 2.0, 0.0);
}
END_TEST

START_TEST(test_wall)
{
    const double r = 0.1, t = 0.03;
    const pm__probe lit = at(0.5, 0.5, 0, 0, 0, 1), dark = at(0.5, 0.5, -t, 0, 0, -1);
    const pm__shape front = {PM_LOOKUP_SPHERE, 0.0, true}, squashed = {PM_LOOKUP_ELLIPSOID, 3.0, false},
                    thin = {PM_LOOKUP_DISC, 0.02, false}, thick = {PM_LOOKUP_DISC, 0.04, false};
    const char *const text = "wall:irradiance=2,thickness=0.03";
    PM_CHECK_NEAR(disc(text, &lit, &sphere, r), 2.0, 1e-14);
    PM_CHECK_NEAR(disc(text, &lit, &front, r), 2.0, 1e-14);
    PM_CHECK_NEAR(disc(text, &dark, &sphere, r), 2 * 0.91, 1e-14);
    PM_CHECK_NEAR(disc(text, &dark, &squashed, r), 2 * 0.19, 1e-14);
    PM_CHECK_NEAR(disc(text, &dark, &thin, r), 0.0, 0.0);
    PM_CHECK_NEAR(disc(text, &dark, &thick, r), 2.0, 1e-14);
    PM_CHECK_NEAR(disc(text, &dark, &front, r), 0.0, 0.0);
    pm__spec spec;
    const pm__case *const c = parse(text, &spec);
    PM_CHECK_NEAR(c->truth(spec.values, &lit), 2.0, 0.0);
    PM_CHECK_NEAR(c->truth(spec.values, &dark), 0.0, 0.0);
    PM_CHECK_NEAR(c->reach(spec.values), 0.2, 0.0);
}
END_TEST

/* Lit caps: cos theta (1 - r^2 / 4a^2). At the terminator the lit half of the ring: mean of cos over it. */
START_TEST(test_sphere)
{
    const pm__shape front = {PM_LOOKUP_SPHERE, 0.0, true}, flat = {PM_LOOKUP_DISC, 0.1, false};
    for (int i = 0; i <= 10; i++) {
        const double z = 0.5 + 0.05 * i, s = sqrt(fmax(0.0, 1 - z * z));
        const pm__probe lit = at(2 * s, 0, 2 * z, s, 0, z), dark = at(0, -2 * s, -2 * z, 0, -s, -z);
        const char *const text = "sphere:irradiance=3,radius=2";
        PM_CHECK_NEAR(disc(text, &lit, &sphere, 0.4), 3 * z * (1 - 0.01), 1e-13);
        PM_CHECK_NEAR(disc(text, &lit, &front, 0.4), 3 * z * (1 - 0.01), 1e-13);
        PM_CHECK_NEAR(disc(text, &dark, &sphere, 0.4), 0.0, 1e-15);
        PM_CHECK_NEAR(disc(text, &lit, &sphere, 4.0), 3.0 / 4, 1e-14); /* all of E0 pi a^2 over pi (2a)^2 */
        ck_assert(isnan(disc(text, &lit, &flat, 0.4)));
    }
    const double r = 1e-3;
    const pm__probe rim = at(1, 0, 0, 1, 0, 0);
    PM_CHECK_NEAR(disc("sphere", &rim, &sphere, r), 2 * r / (3 * pi), 1e-10); /* and O(r^3) */
    PM_CHECK_NEAR(disc("sphere", &rim, &front, r), 0.0, 0.0); /* travels across the normal: rejected */
}
END_TEST

START_TEST(test_volume)
{
    pm__spec spec;
    const pm__case *const c = parse("volume:density=2", &spec);
    const double r = 0.2, ball = 4.0 / 3 * pi * r * r * r;
    const pm__shape front = {PM_LOOKUP_SPHERE, 0.0, true}, flat = {PM_LOOKUP_DISC, 0.1, false};
    const pm__probe inside = at(0.3, -0.4, 0.5, 0, 0, 1), edge = at(0, 0.6, 0.8, 0, 0, 1), back = at(0, 0, 0, 0, 0, -1);
    PM_CHECK_NEAR(c->mass(spec.values, &inside, &sphere, 0, r), 2 * ball, 1e-15);
    PM_CHECK_NEAR(c->mass(spec.values, &inside, &front, 0, r), 2 * ball, 1e-15);
    PM_CHECK_NEAR(c->mass(spec.values, &back, &front, 0, r), 0.0, 0.0);
    /* On the boundary: 1/2 - 3r/16 of the ball (lens of balls of radii 1 and r, 1 apart). */
    PM_CHECK_NEAR(c->mass(spec.values, &edge, &sphere, 0, r), 2 * ball * (0.5 - 3 * r / 16), 1e-14);
    ck_assert(isnan(c->mass(spec.values, &edge, &flat, 0, r)));
    PM_CHECK_NEAR(c->power(spec.values), 8 * pi / 3, 1e-14);
}
END_TEST

/* ---- What holds for all ---- */

/* Runs check on every case at its default and with each parameter at either end of its range. */
static void each_case(void (*check)(const pm__case *c, const double *values))
{
    for (size_t i = 0; i < pm__cases.count; i++) {
        const pm__case *const c = pm__test_case(i);
        pm__spec spec;
        pm__spec_default(&c->entry, &spec);
        check(c, spec.values);
        for (size_t p = 0; p < c->entry.param_count; p++)
            for (int end = 0; end < 2; end++) {
                pm__spec_default(&c->entry, &spec);
                spec.values[p] = end ? c->entry.params[p].max : c->entry.params[p].min;
                check(c, spec.values);
            }
    }
}

START_TEST(test_catalogue)
{
    static const char *const names[] = {"square",      "gradient",   "quadratic", "blob", "sinusoid", "edge",
                                        "point-light", "rect-light", "corner",    "wall", "sphere",   "volume"};
    ck_assert_uint_eq(pm__cases.count, 12);
    for (size_t i = 0; i < 12; i++) {
        const pm__case *const c = pm__test_case(i);
        ck_assert_str_eq(c->entry.name, names[i]);
        ck_assert(c->entry.param_count <= PM__MAX_PARAMS && c->entry.summary && c->entry.citation);
        ck_assert_str_eq(c->regions[0].name, "all");
        ck_assert_int_ge(c->sample_dimensions, c->strata_dimensions);
        ck_assert(c->dimensions == (pm__is(c, "volume") ? 3 : 2));
        for (size_t r = 0; r < c->region_count; r++)
            ck_assert(c->regions[r].uniform || !c->regions[r].interior);
    }
}
END_TEST

static void check_photons(const pm__case *c, const double *values)
{
    static const double corners[] = {0.0, 0x1p-53, 0.25, 0.5, 0x1.fffffffffffffp-1};
    double aspect[2];
    c->aspect(values, aspect);
    ck_assert(aspect[0] > 1e-7 && aspect[0] < 1e7 && aspect[1] > 1e-7 && aspect[1] < 1e7);
    ck_assert(c->power(values) > 0.0 && isfinite(c->power(values)));
    for (int i = 0; i < 625 + 200; i++) {
        double u[4], position[3], direction[3], normal[3], again[3], st[3];
        if (i < 625)
            for (int d = 0, rest = i; d < 4; d++, rest /= 5)
                u[d] = corners[rest % 5];
        else
            pm__random_uniform(1, PM__FOR_TESTS, 0, (uint64_t)i, u, 4);
        c->photon(values, u, position, direction, normal);
        PM_CHECK_NEAR(pm__dot(direction, direction), 1.0, 1e-14);
        PM_CHECK_NEAR(pm__dot(normal, normal), 1.0, 1e-12);
        ck_assert_msg(pm__dot(direction, normal) <= 0.0, "%s: photon from behind", c->entry.name);
        for (int d = 0; d < 3; d++)
            ck_assert(isfinite((float)position[d]) && isfinite((float)direction[d]));
        (void)pm__chart_locate(c, values, position, normal, st); /* on the surface */
        c->photon(values, u, again, direction, normal);
        ck_assert_mem_eq(position, again, sizeof again);
    }
}

START_TEST(test_photons)
{
    each_case(check_photons);
}
END_TEST

static void check_probes(const pm__case *c, const double *values)
{
    for (size_t r = 0; r < c->region_count; r++)
        for (uint64_t i = 0; i < 300; i++) {
            pm__probe probe;
            double u[3], st[3];
            pm__random_uniform(1, PM__FOR_TESTS, 0, i, u, 3);
            c->probe(values, r, u, &probe);
            (void)pm__chart_locate(c, values, probe.position, probe.normal, st);
            for (size_t other = 0; other < c->region_count; other++) {
                const bool in = pm__in_region(c, values, c->regions[other].name, &probe);
                if (other == r)
                    ck_assert_msg(in, "%s: probe outside %s", c->entry.name, c->regions[r].name);
                else if (other && r) /* apart but for `all` */
                    ck_assert_msg(!in, "%s: %s reaches into %s", c->entry.name, c->regions[r].name,
                                  c->regions[other].name);
            }
            const double e = c->truth(values, &probe);
            ck_assert(e >= 0.0 && isfinite(e));
            if (c->regions[r].uniform) {
                pm__probe first;
                c->probe(values, r, (const double[]){0.5, 0.5, 0.5}, &first);
                PM_CHECK_NEAR(e, c->truth(values, &first), 0.0);
            }
        }
}

START_TEST(test_probes)
{
    each_case(check_probes);
}
END_TEST

/* Mass adds up over shells, grows, ends at the power of all, is less with a filter, and tends to E times the
 * measure. */
static void check_mass(const pm__case *c, const double *values)
{
    const double power = c->power(values);
    /* Lookups are as large as the light is high: farther away the quadrature promises nothing. */
    const bool lamp = pm__is(c, "point-light") || pm__is(c, "rect-light");
    const double unit = lamp ? pm__test_value(c, values, "height") : 1.0;
    const double r0 = 0.03 * unit, r1 = 0.07 * unit;
    for (size_t r = 0; r < c->region_count; r++)
        for (uint64_t i = 0; i < 10; i++) {
            pm__probe probe;
            double u[3];
            pm__random_uniform(2, PM__FOR_TESTS, 0, i, u, 3);
            c->probe(values, r, u, &probe);
            for (int s = 0; s < 6; s++) {
                const pm__shape shape = {(pm_lookup_shape)(s / 2), s / 2 == 1 ? 2.0 : 0.02, s % 2 == 1};
                pm__shape open = shape;
                open.front_only = false;
                const double inner = c->mass(values, &probe, &shape, 0.0, r0);
                if (isnan(inner))
                    continue;
                const double outer = c->mass(values, &probe, &shape, r0, r1);
                const double whole = c->mass(values, &probe, &shape, 0.0, r1);
                ck_assert(inner >= 0.0 && outer >= 0.0 && whole <= power * (1 + 1e-9));
                PM_CHECK_NEAR(inner + outer, whole, 3e-7 * whole + 1e-15 * power);
                ck_assert(whole <= c->mass(values, &probe, &open, 0.0, r1) + 1e-15 * power);
                PM_CHECK_NEAR(c->mass(values, &probe, &shape, r1, r1), 0.0, 0.0);
            }
            if (c->regions[r].uniform && c->regions[r].interior) {
                const double radius = 0.1, e = c->truth(values, &probe);
                const double measure = c->dimensions == 3 ? 4.0 / 3 * pi * pow(radius, 3) : pi * radius * radius;
                const pm__shape front = {PM_LOOKUP_SPHERE, 0.0, true};
                PM_CHECK_NEAR(c->mass(values, &probe, &front, 0.0, radius), e * measure, 1e-13 * e);
            }
        }
}

START_TEST(test_mass)
{
    each_case(check_mass);
}
END_TEST

/* All photons are within 2 m (the sphere's diameter); the point light's are not. */
START_TEST(test_whole_mass)
{
    for (size_t i = 0; i < pm__cases.count; i++) {
        const pm__case *const c = pm__test_case(i);
        pm__spec spec;
        pm__spec_default(&c->entry, &spec);
        pm__probe probe;
        c->probe(spec.values, 0, (const double[]){0.3, 0.4, 0.1}, &probe);
        const double r = pm__is(c, "rect-light") ? 6.0 : pm__is(c, "point-light") ? 1e9 : 2.0;
        const double whole = c->mass(spec.values, &probe, &sphere, 0.0, r);
        if (!pm__is(c, "point-light")) /* its scale is far from r / 3 */
            PM_CHECK_NEAR(whole, c->power(spec.values), 1e-4 * c->power(spec.values));
    }
}
END_TEST

PM_TEST_MAIN("cases", test_square, test_square_mean, test_smooth_fields, test_sinusoid, test_edge, test_point_light,
             test_rect_light, test_rect_light_power, test_corner, test_wall, test_sphere, test_volume, test_catalogue,
             test_photons, test_probes, test_mass, test_whole_mass)
