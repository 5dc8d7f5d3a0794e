/* Scenes whose light is simple: truths against reference values, closed forms and rays traced by hand; views of all
 * scenes and truths wherever they look; what is refused. */
#include "../test.h"

#include "../../cases/scenes/list.h"
#include "../../src/accuracy/bench.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static double truth_of(const pm__case *c, const double *values, double x, double y, double z, double nx, double nz)
{
    const pm__probe at = {.position = {x, y, z}, .normal = {nx, 0, nz}, .outgoing = {0, 0, 1}};
    return c->truth(values, &at);
}

static double on_floor(const pm__case *c, const double *values, double x, double y)
{
    return truth_of(c, values, x, y, 0, 0, 1);
}

/* ---- Reference values ---- */

START_TEST(test_furnace)
{
    static const double rows[][2] = {{0, 1}, {.5, 2}, {.9, 10}, {.95, 20}}; /* albedo, 1 / (1 - albedo) */
    const pm__case *const c = &pm__case_scene_furnace;
    for (int i = 0; i < 4; i++) {
        PM_CHECK_NEAR(truth_of(c, rows[i], 1, 0, 0, -1, 0), pi * rows[i][1], 1e-12 * rows[i][1]);
        PM_CHECK_NEAR(c->power(rows[i]), 4 * pi * pi * rows[i][1], 1e-11 * rows[i][1]);
        PM_CHECK_NEAR(truth_of(c, rows[i], 1, 0, 0, 1, 0), 0, 0); /* outside */
    }
}
END_TEST

/* Every point of the sphere sends alike to every other: at the front of a probe arrives what travels against its
 * normal. */
START_TEST(test_furnace_mass)
{
    enum { RINGS = 200, HEIGHTS = 1999, TURNS = 2 };
    static const double chords[] = {.3, 1, 1.7, 2};
    const pm__case *const c = &pm__case_scene_furnace;
    const pm__shape front = {PM_LOOKUP_SPHERE, 0, true}, open = {PM_LOOKUP_SPHERE, 0, false};
    const pm__probe at = {.position = {0, 0, -1}, .normal = {0, 0, 1}};
    const double albedo = .5, e = 2 * pi;
    for (int i = 0; i < 4; i++) {
        const double s = chords[i], step = s * s / 2 / RINGS;
        double sum = 0;
        for (int ring = 0; ring < RINGS; ring++) {
            const double z = -1 + (ring + .5) * step, x = sqrt(1 - z * z); /* the photon lands at (x, 0, z) */
            int accepted = 0;
            for (int j = 0; j < HEIGHTS; j++)
                for (int k = 0; k < TURNS; k++) {
                    const double from = 2 * (j + .5) / HEIGHTS - 1, r = sqrt(1 - from * from);
                    const double turn = 2 * pi * (k + .5) / TURNS;
                    const double way[3] = {x - r * cos(turn), -r * sin(turn), z - from};
                    accepted += pm__dot(way, at.normal) < 0;
                }
            sum += 2 * pi * step * e * accepted / (HEIGHTS * TURNS);
        }
        PM_CHECK_NEAR(c->mass(&albedo, &at, &front, 0, s), sum, 1e-3 * sum);
        PM_CHECK_NEAR(c->mass(&albedo, &at, &open, 0, s), e * pi * s * s, 1e-13);
        PM_CHECK_NEAR(c->mass(&albedo, &at, &front, .2, s) + c->mass(&albedo, &at, &front, 0, .2),
                      c->mass(&albedo, &at, &front, 0, s), 1e-13);
    }
}
END_TEST

/* All of the midpoints' sum. */
static double floor_sum(const pm__case *c, const double *values, double a, double b)
{
    enum { CELLS = 400 };
    double sum = 0;
    for (int i = 0; i < CELLS; i++)
        for (int j = 0; j < CELLS; j++)
            sum += on_floor(c, values, a * (2 * (i + .5) / CELLS - 1), b * (2 * (j + .5) / CELLS - 1));
    return sum * 4 * a * b / (CELLS * CELLS);
}

START_TEST(test_lamps)
{
    static const double lamp[2] = {1, 1}, other[2] = {3, .5}, panel[4] = {1, 1, 1, 1}, wide[4] = {2, 1, 2, .5};
    static const double point[][2] = {{0, .079577471546}, {.5, .056941003473}, {1, .028134884880}, {2, .007117625434}};
    static const double rect[][3] = {{0, 0, .752274688454}, {.5, 0, .566645112050}, {.5, .5, .435209875684},
                                     {1, 0, .265004852345}, {1, 1, .124353233794},  {2, 0, .043742648315}};
    for (int i = 0; i < 4; i++)
        PM_CHECK_NEAR(on_floor(&pm__case_scene_point_light, lamp, point[i][0], 0), point[i][1], 1e-12);
    for (int i = 0; i < 6; i++)
        PM_CHECK_NEAR(on_floor(&pm__case_scene_rect_light, panel, rect[i][0], rect[i][1]), rect[i][2], 1e-12);
    /* What falls on the floor: all light of a point within its solid angle, quadrature for both. */
    PM_CHECK_NEAR(pm__case_scene_point_light.power(lamp), floor_sum(&pm__case_scene_point_light, lamp, 4, 4), 1e-5);
    PM_CHECK_NEAR(pm__case_scene_point_light.power(other), floor_sum(&pm__case_scene_point_light, other, 2, 2), 3e-5);
    PM_CHECK_NEAR(pm__case_scene_rect_light.power(wide), floor_sum(&pm__case_scene_rect_light, wide, 1.25, 1.75), 3e-5);
    PM_CHECK_NEAR(truth_of(&pm__case_scene_point_light, lamp, 0, 0, 0, 0, -1), 0, 0);
    PM_CHECK_NEAR(truth_of(&pm__case_scene_rect_light, panel, 0, 0, 0, 0, -1), 0, 0);
}
END_TEST

/* Query on the floor of a corner at q R from the wall: shares of a disc on the floor and of a half disc on the wall. */
START_TEST(test_corner)
{
    static const double share[][3] = {{0, .5, .5}, {.25, .6574811788, .46875}, {.5, .8044988905, .375},
                                      {.75, .9278531936, .21875}, {1, 1, 0}};
    const pm__shape front = {PM_LOOKUP_SPHERE, 0, true};
    const pm__case *const c = &pm__case_scene_corner;
    const double angle = 30, r = .05, e1 = sqrt(.75), e2 = .5;
    PM_CHECK_NEAR(truth_of(c, &angle, .3, .3, 0, 0, 1), e1, 1e-15);
    PM_CHECK_NEAR(truth_of(c, &angle, 0, .3, .3, 1, 0), e2, 1e-15);
    PM_CHECK_NEAR(truth_of(c, &angle, .3, .3, 0, 0, -1), 0, 0);
    PM_CHECK_NEAR(truth_of(c, &angle, 0, .3, .3, -1, 0), 0, 0);
    PM_CHECK_NEAR(c->power(&angle), e1 + e2, 1e-15);
    for (int i = 0; i < 5; i++) {
        const pm__probe at = {.position = {share[i][0] * r, .5, 0}, .normal = {0, 0, 1}};
        PM_CHECK_NEAR(c->mass(&angle, &at, &front, 0, r) / (pi * r * r), e1 * share[i][1] + e2 * share[i][2], 1e-10);
    }
}
END_TEST

START_TEST(test_wall)
{
    const pm__case *const c = &pm__case_scene_wall;
    const double values[2] = {2.5, .01};
    PM_CHECK_NEAR(truth_of(c, values, .3, .3, 0, 0, 1), 2.5, 0);
    PM_CHECK_NEAR(truth_of(c, values, .3, .3, -.01, 0, -1), 0, 0);
    PM_CHECK_NEAR(c->power(values), 2.5, 0);
}
END_TEST

/* ---- Glossy plane ---- */

/* The lobe as microfacet theory writes it: GGX of width sqrt(alpha), Smith's masking on both sides. */
static double facets(double alpha, const double in[3], const double out[3])
{
    double h[3] = {in[0] + out[0], in[1] + out[1], in[2] + out[2]};
    pm__normalize(h);
    const double c2 = h[2] * h[2], density = alpha / (pi * pow(c2 * (alpha - 1) + 1, 2));
    double masking = 1;
    for (int i = 0; i < 2; i++) {
        const double v = i ? out[2] : in[2], tan2 = (1 - v * v) / (v * v);
        masking *= 2 / (1 + sqrt(1 + alpha * tan2));
    }
    return density * masking / (4 * in[2] * out[2]);
}

/* [J96a] eq. 5 with t = +-1. */
static double as_printed(double alpha, const double in[3], const double out[3])
{
    const double g = in[2] / (alpha - alpha * in[2] + in[2]) * out[2] / (alpha - alpha * out[2] + out[2]);
    return .3 * (1 - g) / pi + .6 * g / (alpha * 4 * pi * in[2] * out[2]);
}

START_TEST(test_glossy_plane)
{
    static const double rows[][2] = {{.01, 0}, {.01, 30}, {.1, 30}, {.3, 60}, {1, 45}, {1e-4, 10}};
    static const double outs[][3] = {{0, 0, 1}, {.6, 0, .8}, {-.36, .48, .8}, {.5, .5, .70710678118654752}};
    const pm__case *const c = &pm__case_scene_glossy_plane;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 4; j++) {
            const double a = rows[i][1] * pi / 180, in[3] = {-sin(a), 0, cos(a)};
            double values[3] = {rows[i][0], rows[i][1], 0};
            const pm__probe at = {.position = {.5, .5, 0}, .normal = {0, 0, 1},
                                  .outgoing = {outs[j][0], outs[j][1], outs[j][2]}};
            const double safe = (.3 / pi + .6 * facets(values[0], in, outs[j])) * cos(a);
            PM_CHECK_NEAR(c->truth(values, &at), safe, 1e-9 * safe);
            values[2] = 1;
            const double printed = as_printed(values[0], in, outs[j]) * cos(a);
            PM_CHECK_NEAR(c->truth(values, &at), printed, 1e-12 * printed);
        }
}
END_TEST

/* What leaves in all directions. For alpha = 1 in closed form: with G = 2 v / (1 + v) the lobe has the albedo
 * 2 (1 - ln 2) / (1 + v), as printed the diffuse term has 1 - 2 v / 3 and the other 1 / 4. */
START_TEST(test_glossy_albedo)
{
    enum { HEIGHTS = 200, TURNS = 64 };
    const pm__case *const c = &pm__case_scene_glossy_plane;
    const double v = cos(30 * pi / 180), want[2] = {.3 + .6 * 2 * (1 - log(2)) / (1 + v), .3 * (1 - 2 * v / 3) + .15};
    for (int form = 0; form < 2; form++) {
        const double values[3] = {1, 30, form};
        double sum = 0;
        for (int i = 0; i < HEIGHTS; i++)
            for (int j = 0; j < TURNS; j++) {
                const double z = (i + .5) / HEIGHTS, r = sqrt(1 - z * z), turn = 2 * pi * (j + .5) / TURNS;
                const pm__probe at = {.normal = {0, 0, 1}, .outgoing = {r * cos(turn), r * sin(turn), z}};
                sum += c->truth(values, &at) * z * 2 * pi / (HEIGHTS * TURNS);
            }
        PM_CHECK_NEAR(sum / v, want[form], 1e-5);
    }
    const double values[3] = {.1, 30, 0};
    PM_CHECK_NEAR(truth_of(c, values, .5, .5, 0, 0, -1), 0, 0);
}
END_TEST

/* ---- Prism ---- */

/* Snell in the plane x, z, and what Fresnel lets through, in its terms by angles. Returns the share. */
static double refract(double d[2], const double out[2], double ratio)
{
    const double facing = d[0] * out[0] + d[1] * out[1] < 0 ? 1 : -1; /* toward where the light comes from */
    const double n[2] = {facing * out[0], facing * out[1]};
    const double ci = -(d[0] * n[0] + d[1] * n[1]), i = acos(fmin(1, ci)), t = asin(sin(i) / ratio);
    for (int k = 0; k < 2; k++)
        d[k] = d[k] / ratio + (ci / ratio - cos(t)) * n[k];
    if (i < 1e-9)
        return 1 - pow((1 - ratio) / (1 + ratio), 2);
    const double s = sin(i - t) / sin(i + t), p = tan(i - t) / tan(i + t);
    return 1 - (s * s + p * p) / 2;
}

/* Where the ray straight down at x lands, and with what share. */
static double land(double x, double angle, double n, double *share)
{
    const double a = angle * pi / 180, top[2] = {0, 1}, slope[2] = {-sin(a), -cos(a)};
    double d[2] = {0, -1};
    *share = refract(d, top, n);
    const double z = 5 - x * tan(a);
    *share *= refract(d, slope, 1 / n);
    return x - d[0] * z / d[1];
}

static void check_prism(double angle, double dispersion)
{
    const pm__case *const c = &pm__case_scene_prism;
    const double values[2] = {angle, dispersion}, step = 1e-5;
    for (int band = 0; band < 3; band++) {
        const double n = 1.6 + .5 * (band - 1) * dispersion;
        double share, bands[3];
        const double ends[2] = {land(0, angle, n, &share), land(.1, angle, n, &share)};
        for (int i = 0; i < 5; i++) {
            const double x = .02 * (i + .5);
            const double low = land(x - step, angle, n, &share), high = land(x + step, angle, n, &share);
            const pm__probe at = {.position = {land(x, angle, n, &share), .09, 0}, .normal = {0, 0, 1}};
            c->truth_bands(values, &at, bands);
            PM_CHECK_NEAR(bands[band], share * 2 * step / (high - low), 1e-8 * bands[band]);
        }
        for (int side = 0; side < 2; side++)
            for (int within = 0; within < 2; within++) {
                pm__probe at = {.position = {ends[side] + (side == within ? -1e-9 : 1e-9), 0, 0}, .normal = {0, 0, 1}};
                c->truth_bands(values, &at, bands);
                ck_assert_msg((bands[band] > 0) == within, "angle %g, band %d, side %d", angle, band, side);
                at.position[0] = .5 * (ends[0] + ends[1]);
                at.position[1] = within ? -.1 + 1e-9 : .1 + 1e-9;
                c->truth_bands(values, &at, bands);
                ck_assert((bands[band] > 0) == within);
            }
    }
}

/* Where only red is near: an evenly lit rectangle, its sides and all. */
START_TEST(test_prism_mass)
{
    const pm__shape front = {PM_LOOKUP_SPHERE, 0, true};
    const pm__case *const c = &pm__case_scene_prism;
    const double split[2] = {30, .05}, alike[2] = {30, 0}, close[2] = {30, .001}, e = 1.1480292141541;
    const pm__probe middle = {.position = {2.05, 0, 0}, .normal = {0, 0, 1}};
    const pm__probe side = {.position = {2.0153101857178, 0, 0}, .normal = {0, 0, 1}};
    PM_CHECK_NEAR(c->mass(split, &middle, &front, 0, .03), e * pi * .0009, 1e-12);
    PM_CHECK_NEAR(c->mass(split, &side, &front, .01, .03), e * pi * .0004, 1e-12);
    ck_assert(isnan(c->mass(split, &middle, &front, 0, .09))); /* green is near */
    const pm__probe mixed = {.position = {2.13, 0, 0}, .normal = {0, 0, 1}};
    ck_assert(isnan(c->mass(close, &mixed, &front, 0, .01)));
    ck_assert(c->mass(alike, &mixed, &front, 0, .01) > 0);
    const double widths = e * .0767292024 + 1.1566349886598 * .0753380643 + 1.1659828176386 * .0738819892;
    PM_CHECK_NEAR(c->power(split), .2 * widths, 1e-10);
    PM_CHECK_NEAR(c->power(alike), 1.1566349886598 * .0753380643 * .2, 1e-9);
}
END_TEST

START_TEST(test_prism)
{
    check_prism(30, .05);
    check_prism(35, .1);
    check_prism(10, 0);
    /* Reference values at high precision. */
    const pm__case *const c = &pm__case_scene_prism;
    const double values[2] = {30, .05}, want[3] = {1.1480292141541, 1.1566349886598, 1.1659828176386};
    static const double middles[3] = {2.05, 2.17, 2.3};
    for (int band = 0; band < 3; band++) {
        const pm__probe at = {.position = {middles[band], 0, 0}, .normal = {0, 0, 1}};
        double bands[3];
        c->truth_bands(values, &at, bands);
        for (int b = 0; b < 3; b++)
            PM_CHECK_NEAR(bands[b], b == band ? want[b] : 0, 1e-12);
        PM_CHECK_NEAR(c->truth(values, &at), bands[0], 0);
    }
}
END_TEST

/* ---- Views, and truths wherever they look ---- */

static void passes(const pm__material *material, const double normal[3], double direction[3])
{
    const double cosine = pm__dot(direction, normal), sign = cosine > 0 ? -1 : 1;
    const double ratio = cosine > 0 ? 1 / material->ior[0] : material->ior[0];
    double far;
    if (material->kind == PM__GLASS && pm__fresnel(fabs(cosine), ratio, &far) < 1)
        for (int i = 0; i < 3; i++)
            direction[i] = direction[i] / ratio + (fabs(cosine) / ratio - far) * sign * normal[i];
    else
        for (int i = 0; i < 3; i++)
            direction[i] -= 2 * cosine * normal[i];
    pm__normalize(direction);
}

typedef struct sight {
    int rough, lit;
} sight;

/* Through glass and by mirrors to a rough surface: the truth is a number there, on either side. */
static void look(const pm__case *c, const double *values, const pm__scene *scene, const double eye[3],
                 double direction[3], sight *seen)
{
    double origin[3] = {eye[0], eye[1], eye[2]};
    uint32_t from = PM__NO_SHAPE;
    for (int bounce = 0; bounce < 12; bounce++) {
        pm__hit hit;
        if (!pm__scene_intersect(scene, origin, direction, INFINITY, from, &hit))
            return;
        if (pm__is_rough(hit.material)) {
            const double sign = pm__dot(direction, hit.normal) > 0 ? -1 : 1;
            pm__probe at, behind;
            for (int i = 0; i < 3; i++) {
                at.position[i] = behind.position[i] = hit.position[i];
                at.normal[i] = sign * hit.normal[i];
                behind.normal[i] = -at.normal[i];
                at.outgoing[i] = -direction[i];
                behind.outgoing[i] = direction[i];
            }
            const double truth = c->truth(values, &at), other = c->truth(values, &behind);
            ck_assert_msg(truth >= 0 && isfinite(truth), "%s: truth %g at %g %g %g", c->entry.name, truth,
                          hit.position[0], hit.position[1], hit.position[2]);
            ck_assert(other >= 0 && isfinite(other));
            ck_assert_msg(!(truth > 0 && other > 0), "%s: both sides are lit", c->entry.name);
            seen->rough++;
            seen->lit += truth > 0;
            return;
        }
        passes(hit.material, hit.normal, direction);
        for (int i = 0; i < 3; i++)
            origin[i] = hit.position[i];
        from = hit.shape;
    }
}

/* Every scene with an answer, with its defaults and with its parameters at their ends. */
static void check_view(const pm__case *c, const double *values, bool at_home)
{
    enum { SIZE = 48 };
    pm__scene *scene = NULL;
    pm_error error;
    pm__view view;
    pm__camera camera;
    sight seen = {0, 0};
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(c->build(values, scene, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    c->view(values, &view);
    PM_CHECK_OK(pm__camera_init(&view, SIZE, SIZE, &camera, &error), error);
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x < SIZE; x++) {
            double direction[3];
            pm__camera_direction(&camera, x + .5, y + .5, direction);
            look(c, values, scene, camera.eye, direction, &seen);
        }
    pm__scene_destroy(scene);
    const bool dark = strcmp(c->entry.name, "scene:wall") == 0; /* seen from its dark side */
    ck_assert_msg(seen.rough > SIZE * SIZE / (at_home ? 4 : 20), "%s: %d of %d", c->entry.name, seen.rough,
                  SIZE * SIZE);
    ck_assert_msg(dark ? seen.lit == 0 : seen.lit > SIZE * SIZE / (at_home ? 20 : 1000), "%s: %d of %d lit",
                  c->entry.name, seen.lit, SIZE * SIZE);
}

START_TEST(test_views)
{
    for (size_t k = 0; k < pm__scene_cases.count; k++) {
        const pm__entry *const entry = pm__scene_cases.entries[k];
        const pm__case *const c = (const pm__case *)(const void *)entry;
        pm__spec spec;
        pm__spec_default(entry, &spec);
        ck_assert_ptr_nonnull((void *)(uintptr_t)c->view);
        if (!c->truth)
            continue;
        check_view(c, spec.values, true);
        for (size_t i = 0; i < entry->param_count; i++)
            for (int end = 0; end < 2; end++) {
                const pm__param *const param = &entry->params[i];
                pm__spec_default(entry, &spec);
                spec.values[i] = param->type == PM__CHOICE ? end : end ? param->max : param->min;
                if (!entry->resolve || entry->resolve(spec.values, NULL) == PM_OK)
                    check_view(c, spec.values, false);
            }
    }
}
END_TEST

/* ---- What is refused ---- */

START_TEST(test_bad_parameters)
{
    static const char *const specs[] = {
        "scene:furnace:albedo=1", "scene:furnace:albedo=-0.1", "scene:furnace:albedo=nan", "scene:point-light:height=0",
        "scene:rect-light:width=0", "scene:corner:angle=0", "scene:corner:angle=90", "scene:wall:thickness=0",
        "scene:glossy-plane:roughness=1.5", "scene:glossy-plane:form=wrong", "scene:glossy-plane:angle=90",
        "scene:prism:angle=45", "scene:prism:dispersion=-0.01", "scene:prism:ior=1.5",
    };
    for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) {
        pm__spec spec;
        pm_error error = {""};
        ck_assert_msg(pm__spec_parse(&pm__all_cases, specs[i], &spec, &error) != PM_OK, "%s", specs[i]);
        ck_assert_uint_gt(strlen(error.text), 0);
    }
}
END_TEST

/* A scene that can only be rendered is refused before any work. */
START_TEST(test_no_answer)
{
    static const pm__case unknown = {.entry = {.name = "scene:mystery", .summary = "", .citation = ""}};
    static const size_t ks[] = {10}, photons = 100;
    pm__spec estimator, sampler;
    pm_error error = {""};
    PM_CHECK_OK(pm__spec_parse(&pm__estimators, "disc", &estimator, &error), error);
    PM_CHECK_OK(pm__spec_parse(&pm__samplers, "poisson", &sampler, &error), error);
    pm__spec cases[2];
    pm__spec_default(pm__cases.entries[0], &cases[0]);
    cases[1] = (pm__spec){.entry = &unknown.entry};
    const pm__accuracy_config config = {
        .cases = cases, .case_count = 2, .estimators = &estimator, .estimator_count = 1, .ks = ks, .k_count = 1,
        .photons = &photons, .photon_count = 1, .samplers = &sampler, .sampler_count = 1, .trials = 2,
        .probes_all = 1, .probes_region = 1, .seed = 1};
    pm__accuracy_row *rows;
    size_t count;
    ck_assert_int_eq(pm__accuracy_run(&config, &rows, &count, &error), PM_EINVAL);
    ck_assert_str_eq(error.text, "scene:mystery has no exact answer: see it with `photonbench render mystery`");
    ck_assert_ptr_null(rows);
}
END_TEST

PM_TEST_MAIN("scene-exact", test_furnace, test_furnace_mass, test_lamps, test_corner, test_wall, test_glossy_plane,
             test_glossy_albedo, test_prism_mass, test_prism, test_views, test_bad_parameters, test_no_answer)
