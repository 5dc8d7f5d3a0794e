/* Truths of the traced scenes against reference values; their probes and their scenes. */
#include "../test.h"

#include "../../cases/scenes/list.h"
#include "../../cases/scenes/scene_case.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static double truth_at(const pm__case *c, const double *values, double x, double y)
{
    const pm__probe probe = {.position = {x, y, 0}, .normal = {0, 0, 1}};
    return c->truth(values, &probe);
}

/* ---- Reference values ---- */

typedef struct row {
    double values[2], x, y, want;
} row;

static void check_rows(const pm__case *c, const row *rows, size_t count, double scale, double tolerance)
{
    for (size_t i = 0; i < count; i++) {
        const double got = scale * truth_at(c, rows[i].values, rows[i].x, rows[i].y);
        ck_assert_msg(fabs(got - rows[i].want) <= tolerance * rows[i].want + 6e-11,
                      "%s row %zu: %.12g, expected %.12g", c->entry.name, i, got, rows[i].want);
    }
}

#define CHECK_ROWS(c, rows, scale, tolerance) check_rows(c, rows, sizeof(rows) / sizeof *(rows), scale, tolerance)

START_TEST(test_glass_sphere)
{
    static const row rows[] = {
        {{1.5, 1}, .05, 0, 11.88195566},  {{1.5, 1}, .1, 0, 14.11352264},   {{1.5, 1}, .15, 0, 21.81978490},
        {{1.5, 1.2}, .05, 0, 81.86549366}, {{1.5, 1.2}, 0, .1, 3.85416545}, {{1.5, 1.2}, .2, 0, .98709686},
        {{1.5, 1.2}, .3, 0, .36289849},   {{1.5, 1.2}, .5, 0, .07680894},   {{1.5, 1.5}, .05, 0, 29.25342681},
        {{1.5, 1.5}, .1, 0, 9.62385484},  {{1.5, 1.5}, -.2, 0, 2.76048465}, {{1.5, 1.5}, .3, 0, 1.19288535},
        {{1.5, 1.5}, .5, 0, .34442708},   {{1.5, 1.5}, .8, 0, .08485269},   {{1.5, 2}, 0, 0, 8.2944},
        {{1.5, 2}, .05, 0, 7.41591183},   {{1.5, 2}, .1, 0, 5.67930674},    {{1.5, 2}, .12, .16, 3.01389468},
        {{1.5, 2}, .3, 0, 1.69732388},    {{1.5, 2}, .5, 0, .66616108},     {{1.5, 2}, .8, 0, .22376596},
    };
    static const row rough[] = {{{1.5, 1}, .2, 0, 7.6964e-4}, {{1.5, 1}, .5, 0, 3.679e-5}};
    CHECK_ROWS(&pm__case_scene_glass_sphere, rows, 1.0, 3e-8);
    CHECK_ROWS(&pm__case_scene_glass_sphere, rough, 1.0, 2e-4);
}
END_TEST

/* Both sides of the folds at |rho| = .18298115 and .07402315: bright within, as 1 / sqrt of the distance. */
START_TEST(test_glass_fold)
{
    static const double folds[][2] = {{1.0, .18298115}, {1.2, .07402315}};
    for (int i = 0; i < 2; i++) {
        const double values[2] = {1.5, folds[i][0]}, fold = folds[i][1];
        const double outside = truth_at(&pm__case_scene_glass_sphere, values, fold + 2e-8, 0);
        const double near = truth_at(&pm__case_scene_glass_sphere, values, fold - 1e-6, 0) - outside;
        const double far = truth_at(&pm__case_scene_glass_sphere, values, fold - 4e-6, 0) - outside;
        ck_assert(outside < 10);
        PM_CHECK_NEAR(near / far, 2.0, 0.02);
    }
}
END_TEST

START_TEST(test_nephroid)
{
    static const row rows[] = {
        {{45, 2}, .7, 0, 4.5833333333},    {{45, 2}, .8, 0, 2.9487179487},    {{45, 2}, .3, 0, 2.5},
        {{45, 2}, 0, 0, 1},                {{45, 2}, .6, .1, 1.1939802926},   {{45, 2}, .2, .5, .6072128461},
        {{45, 2}, .5, .3, .7889309881},    {{45, 2}, -.2, .1, .7016092637},   {{45, 2}, .1, .8, .4056562935},
    };
    CHECK_ROWS(&pm__case_scene_nephroid, rows, sqrt(2.0), 1e-10);
    const double steep[2] = {60, 20}, low[2] = {45, 0.5};
    PM_CHECK_NEAR(truth_at(&pm__case_scene_nephroid, steep, .6, -.1), 1.1939802926 * sin(pi / 3), 1e-10);
    /* A wall too low lights only what lies within its light's reach: on the axis 1 - x for th = 0. */
    PM_CHECK_NEAR(truth_at(&pm__case_scene_nephroid, low, .45, 0), 0.0, 0.0);
    PM_CHECK_NEAR(truth_at(&pm__case_scene_nephroid, low, .51, 0), sqrt(.5) / .02, 1e-9);
    /* Light leaves the half circle by its open side alone: below -x nothing comes but from |th| < 30 degrees. */
    const double high[2] = {45, 20};
    PM_CHECK_NEAR(truth_at(&pm__case_scene_nephroid, high, -3, 0), sqrt(.5) / 7, 1e-12);
    PM_CHECK_NEAR(truth_at(&pm__case_scene_nephroid, high, 1.5, .2), 0.0, 0.0);
    PM_CHECK_NEAR(truth_at(&pm__case_scene_nephroid, high, .2, 1.2), 0.0, 0.0);
    pm_error error;
    double refused[2] = {60, 2};
    ck_assert_int_eq(pm__case_scene_nephroid.entry.resolve(refused, &error), PM_EINVAL);
    double fits[2] = {45, 2};
    ck_assert_int_eq(pm__case_scene_nephroid.entry.resolve(fits, &error), PM_OK);
}
END_TEST

START_TEST(test_cardioid)
{
    static const row rows[] = {
        {{1}, .5, 0, .5342300331},    {{1}, .2, 0, .2663297261},    {{1}, 0, 0, .0948683298},
        {{1}, -.3, .2, .0389519259},  {{1}, .2, .4, .0527442341},   {{1}, .6, .2, .3689113180},
        {{1}, -.5, .5, .0223000230},  {{1}, -.5, -.5, .0223000230},
    };
    CHECK_ROWS(&pm__case_scene_cardioid, rows, 1.0, 1e-10);
}
END_TEST

START_TEST(test_layers)
{
    static const row water[] = {{{1.33}, 0, 0, .3192943474}, {{1.33}, .5, 0, .2920111297},
                                {{1.33}, 0, -1, .2290439997}, {{1.33}, 1.2, 1.6, .1083134713}};
    static const row plate[] = {{{1.5, .2}, 0, 0, .7175086505}, {{1.5, .2}, .5, 0, .5600291664},
                                {{1.5, .2}, 0, -1, .3116503474}, {{1.5, .2}, 1.2, 1.6, .0785115377}};
    CHECK_ROWS(&pm__case_scene_water, water, 1.0, 1e-10);
    CHECK_ROWS(&pm__case_scene_plate, plate, 1.0, 1e-10);
    const double nothing[2] = {1.0, 0.5}; /* of air: a point light 1.5 m up */
    PM_CHECK_NEAR(truth_at(&pm__case_scene_plate, nothing, 2, 0), 1.5 / pow(1.5 * 1.5 + 4, 1.5), 1e-14);
}
END_TEST

START_TEST(test_pool)
{
    static const row rows[] = {
        {{1}, 0, 0, 2.0174112240},   {{1}, .03, 0, 1.8541125907},   {{1}, .1, 0, 1.2561979092},
        {{1}, .25, 1, .8055294593},  {{1}, -.4, 0, .6868500418},    {{1}, .5, 0, .6687730568},
        {{2.5}, 0, 0, 8.2494071376}, {{2.5}, .03, 0, 1.2196041935}, {{2.5}, .1, 0, .7552115313},
        {{2.5}, -.25, 0, .5206342668}, {{2.5}, .4, 0, .4555778930}, {{2.5}, .5, 0, .4454405205},
    };
    CHECK_ROWS(&pm__case_scene_pool, rows, 1.0, 1e-10);
    /* The beam ends at 1.25 m; light that lands at x comes from almost there. */
    const double shallow[1] = {.25};
    ck_assert(truth_at(&pm__case_scene_pool, shallow, 0, 1.249) > .5);
    PM_CHECK_NEAR(truth_at(&pm__case_scene_pool, shallow, 0, 1.251), 0.0, 0.0);
    PM_CHECK_NEAR(truth_at(&pm__case_scene_pool, shallow, 2, 0), 0.0, 0.0);
    const double values[1] = {2.5};
    ck_assert(truth_at(&pm__case_scene_pool, values, .016042, 0) > 100);  /* the fold is at .01604235 */
    ck_assert(truth_at(&pm__case_scene_pool, values, .016043, 0) < 2);
}
END_TEST

START_TEST(test_integrating_sphere)
{
    static const double rows[][2] = {{.2, .0994718394}, {.5, .1591549431}, {.8, .3978873577}, {.9, .7957747155}};
    const pm__probe inside = {.position = {1, 0, 0}, .normal = {-1, 0, 0}};
    for (int i = 0; i < 4; i++) /* totals of a central source: its own light is 1 / (4 pi) */
        PM_CHECK_NEAR(pm__case_scene_integrating_sphere.truth(rows[i], &inside) + 0.25 / pi, rows[i][1], 1e-10);
}
END_TEST

/* ---- Roots ---- */

static double pair(const void *context, double x)
{
    const double *const p = context; /* sign, middle, half distance squared */
    return p[0] * ((x - p[1]) * (x - p[1]) - p[2]);
}

static double wave(const void *context, double x)
{
    (void)context;
    return cos(pi * x);
}

/* Pairs much nearer than a cell, of either sign, in a cell or about a node; and roots at nodes, each once. */
START_TEST(test_roots)
{
    static const double pairs[][3] = {{1, .5003, 1e-12}, {-1, .5003, 1e-12}, {1, .5, 1e-12}, {-1, .1234, 1e-8}};
    double roots[PM__MOST_ROOTS];
    for (int i = 0; i < 4; i++) {
        ck_assert_uint_eq(pm__roots(pair, pairs[i], 0, 1, 10, roots), 2);
        PM_CHECK_NEAR(roots[0], pairs[i][1] - sqrt(pairs[i][2]), 1e-10);
        PM_CHECK_NEAR(roots[1], pairs[i][1] + sqrt(pairs[i][2]), 1e-10);
    }
    static const double none[3] = {1, .3, -1e-9};
    ck_assert_uint_eq(pm__roots(pair, none, 0, 1, 10, roots), 0);
    ck_assert_uint_eq(pm__roots(wave, NULL, 0, 4, 8, roots), 4);
    for (int i = 0; i < 4; i++)
        PM_CHECK_NEAR(roots[i], i + 0.5, 1e-15);
}
END_TEST

/* ---- Every scene with a truth ---- */

static double uniform(unsigned *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (*state + 0.5) / 4294967296.0;
}

/* Probes lie on the surface; away from "core", "crest", "fold", "cusp" and "edge" no lens or fold is so near that a
 * step of 1 mm changes the truth by half. */
START_TEST(test_probes)
{
    for (size_t k = 0; k < pm__scene_cases.count; k++) {
        pm__spec spec;
        pm__spec_default(pm__scene_cases.entries[k], &spec);
        const pm__case *const c = (const pm__case *)(const void *)spec.entry;
        if (!c->truth)
            continue;
        unsigned state = 7;
        for (size_t region = 0; region < c->region_count; region++)
            for (int i = 0; i < 300; i++) {
                const double u[3] = {uniform(&state), uniform(&state), uniform(&state)};
                pm__probe at;
                c->probe(spec.values, region, u, &at);
                const double here = c->truth(spec.values, &at);
                PM_CHECK_NEAR(pm__dot(at.normal, at.normal), 1.0, 1e-12);
                const bool dark = strcmp(c->entry.name, "scene:wall") == 0 && at.normal[2] < 0;
                if (strstr("core crest fold cusp edge", c->regions[region].name) || dark)
                    continue;
                ck_assert_msg(here > 0 && isfinite(here), "%s %s", c->entry.name, c->regions[region].name);
                at.position[0] += 1e-3;
                const double there = c->truth(spec.values, &at);
                ck_assert_msg(there > 0.5 * here && there < 2 * here, "%s %s", c->entry.name, c->regions[region].name);
            }
    }
}
END_TEST

/* ---- Theory ---- */

static const pm__shape ball = {PM_LOOKUP_SPHERE, 0.0, true};

/* Midpoints of polar cells. */
static double disc_of_truth(const pm__case *c, const double *values, const pm__probe *probe, double r0, double r1)
{
    enum { RINGS = 16, ANGLES = 64 };
    double sum = 0.0;
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < ANGLES; j++) {
            const double r = sqrt(r0 * r0 + (r1 * r1 - r0 * r0) * (i + 0.5) / RINGS);
            const double angle = 2 * pi * (j + 0.5) / ANGLES;
            pm__probe at = *probe;
            at.position[0] += r * cos(angle);
            at.position[1] += r * sin(angle);
            sum += c->truth(values, &at);
        }
    return sum * pi * (r1 * r1 - r0 * r0) / (RINGS * ANGLES);
}

/* Scenes of one plane, whose truth is irradiance: not spheres, nor where another surface is near, nor radiance, nor
 * steps as near as 0.03 m. */
static bool is_plain(const pm__case *c)
{
    return c->truth && !strchr(c->paths, '+') && !c->brdf &&
           !strstr("scene:corner scene:wall scene:prism", c->entry.name);
}

/* The power in discs is the truth's integral, from probes that any disc of 0.03 m is smooth around. */
START_TEST(test_mass)
{
    for (size_t k = 0; k < pm__scene_cases.count; k++) {
        pm__spec spec;
        pm__spec_default(pm__scene_cases.entries[k], &spec);
        const pm__case *const c = (const pm__case *)(const void *)spec.entry;
        if (!c->truth || !is_plain(c))
            continue;
        unsigned state = 11;
        for (size_t region = 0; region < c->region_count; region++)
            for (int i = 0; i < 6 && !strstr("fold cusp", c->regions[region].name); i++) {
                const double u[3] = {uniform(&state), uniform(&state), uniform(&state)};
                pm__probe at;
                c->probe(spec.values, region, u, &at);
                const double whole = c->mass(spec.values, &at, &ball, 0.0, 0.03);
                const double ring = c->mass(spec.values, &at, &ball, 0.028, 0.03);
                PM_CHECK_NEAR(whole, disc_of_truth(c, spec.values, &at, 0, 0.03), 2e-3 * whole);
                PM_CHECK_NEAR(ring, disc_of_truth(c, spec.values, &at, 0.028, 0.03), 1e-5 * ring);
                PM_CHECK_NEAR(c->mass(spec.values, &at, &ball, 0, 0.028) + ring, whole, 1e-7 * whole);
            }
    }
}
END_TEST

/* No number where the disc's edge may touch a fold, or a focus, wall or edge of the light is near. */
START_TEST(test_no_mass)
{
    static const struct {
        const pm__case *subject;
        double values[2], x, y, r;
    } rows[] = {
        {&pm__case_scene_nephroid, {45, 2}, .5, 0, .01},   {&pm__case_scene_nephroid, {45, 2}, .6, 0, .1},
        {&pm__case_scene_nephroid, {45, 2}, .9, 0, .11},
        {&pm__case_scene_nephroid, {45, 2}, 0, .7, .31},   {&pm__case_scene_cardioid, {1}, .34, 0, .01},
        {&pm__case_scene_cardioid, {1}, .8, 0, .21},
        {&pm__case_scene_pool, {2.5}, .016, 0, .01},       {&pm__case_scene_pool, {2.5}, .1, 0, .09},
        {&pm__case_scene_pool, {1}, .5, .5, .6},           {&pm__case_scene_glass_sphere, {1.5, 1.2}, .07, 0, .01},
        {&pm__case_scene_glass_sphere, {1.5, 1.6}, 0, 0, .01}, {&pm__case_scene_plate, {1.5, .2}, 2, 0, 2},
        {&pm__case_scene_water, {1.33}, 2, 0, 4},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const pm__probe at = {.position = {rows[i].x, rows[i].y, 0}, .normal = {0, 0, 1}};
        ck_assert_msg(isnan(rows[i].subject->mass(rows[i].values, &at, &ball, 0, rows[i].r)), "row %zu", i);
    }
}
END_TEST

/* Direct light on the integrating sphere's point at the cosine t from the probe: of 1 W at (0.5, 0, 0). */
static double direct(const pm__probe *probe, double t, double angle)
{
    double s[3], u[3], d[3], y[3];
    pm__basis(probe->normal, s, u);
    for (int a = 0; a < 3; a++) {
        y[a] = sqrt(1 - t * t) * (cos(angle) * s[a] + sin(angle) * u[a]) - t * probe->normal[a];
        d[a] = y[a] - (a == 0 ? 0.5 : 0.0);
    }
    const double d2 = pm__dot(d, d);
    return pm__dot(d, y) / (4 * pi * d2 * sqrt(d2));
}

/* What leaves a cap lands everywhere alike: at the front arrives what does not come from the cap up to the photon. */
START_TEST(test_integrating_sphere_mass)
{
    enum { RINGS = 400, ANGLES = 64 };
    static const double offsets[][2] = {{1, 0}, {.6, .8}, {-.8, .6}}, chords[] = {.2, 1, 1.9};
    const pm__case *const c = &pm__case_scene_integrating_sphere;
    const pm__shape open = {PM_LOOKUP_SPHERE, 0.0, false}, flat = {PM_LOOKUP_DISC, 0.1, true};
    const double rho = .8, e = rho / (1 - rho) / (4 * pi);
    for (int i = 0; i < 3; i++) {
        const pm__probe at = {.position = {offsets[i][0], offsets[i][1], 0},
                              .normal = {-offsets[i][0], -offsets[i][1], 0}};
        ck_assert(isnan(c->mass(&rho, &at, &flat, 0, .1)));
        PM_CHECK_NEAR(c->mass(&rho, &at, &open, 0, 2), rho / (1 - rho), 1e-14);
        for (int j = 0; j < 3; j++) {
            const double s = chords[j], step = s * s / 2 / RINGS;
            double cap = 0.0, refused = 0.0;
            for (int ring = 0; ring < RINGS; ring++) {
                double sent = 0.0;
                for (int k = 0; k < ANGLES; k++)
                    sent += rho * (e + direct(&at, 1 - (ring + 0.5) * step, 2 * pi * k / ANGLES)) / ANGLES;
                cap += 2 * pi * step * sent;
                refused += (cap - pi * step * sent) * step / 2; /* the cap up to the ring's middle */
            }
            PM_CHECK_NEAR(c->mass(&rho, &at, &open, 0, s), e * pi * s * s, 1e-14);
            PM_CHECK_NEAR(c->mass(&rho, &at, &ball, 0, s), e * pi * s * s - refused, 1e-5 * refused);
        }
    }
}
END_TEST

START_TEST(test_build)
{
    for (size_t k = 0; k < pm__scene_cases.count; k++) {
        pm__spec spec;
        pm__spec_default(pm__scene_cases.entries[k], &spec);
        const pm__case *const c = (const pm__case *)(const void *)spec.entry;
        if (!c->truth)
            continue;
        pm__scene *scene = NULL;
        pm_error error;
        PM_CHECK_OK(pm__scene_create(&scene, &error), error);
        PM_CHECK_OK(c->build(spec.values, scene, &error), error);
        PM_CHECK_OK(pm__scene_commit(scene, &error), error);
        double lamps[3];
        pm__scene_power(scene, lamps);
        /* of all orders, or of the first; of three bands where they part */
        const double sent = c->truth_bands ? lamps[0] + lamps[1] + lamps[2] : lamps[0];
        ck_assert(!c->truth || strchr(c->paths, '+') || c->power(spec.values) < sent);
        pm__scene_destroy(scene);
    }
}
END_TEST

PM_TEST_MAIN("scene-truths", test_glass_sphere, test_glass_fold, test_nephroid, test_cardioid, test_layers, test_pool,
             test_integrating_sphere, test_roots, test_probes, test_mass, test_no_mass,
             test_integrating_sphere_mass, test_build)
