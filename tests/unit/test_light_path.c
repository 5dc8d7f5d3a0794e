/* Path and light tracing pass by pass: against closed forms, and against each other on every kind of light path. Trials
 * are the replicates; Student's bound for a false alarm in 1e-6 over the file (CHECKS comparisons, two-sided). */
#include "../../src/base/gauss.h"
#include "../../src/stats/stats.h"
#include "../progress.h"

enum { SIDE = 16, POINTS = SIDE * SIDE, BLOCK = 4, BLOCKS = POINTS / (BLOCK * BLOCK), PARTS = BLOCKS + 1 };
enum { VALUES = 3 * PARTS }; /* of blocks, and of the whole, by band */
enum { TRIALS = 64, CHECKS = 1500 };

/* ---- Runs -------------------------------------------------------------------------------------- */

/* view: NULL: the scene's own. */
static progress *image_open(const pm__case *scene, const pm__view *view, const char *method, size_t photons,
                            const char *sampler)
{
    progress *const s = progress_create("scene:furnace", method, "combined", 0.0); /* a kernel that others refuse */
    pm__spec_default(&scene->entry, &s->scene);
    s->config.view = view;
    s->config.width = s->config.height = SIDE;
    s->config.photons = photons;
    s->config.k = 0;
    s->config.seed = 3;
    s->config.sampler = lit_sampler(sampler);
    return progress_open(s);
}

static const pm__case *scene_of(const char *name)
{
    const pm__entry *const entry = pm__find(&pm__scene_cases, name);
    ck_assert_ptr_nonnull(entry);
    return (const pm__case *)(const void *)entry;
}

static progress *image_of(const char *scene, const char *method, size_t photons, const char *sampler)
{
    return image_open(scene_of(scene), NULL, method, photons, sampler);
}

static void run_trial(const progress *s, uint32_t trial, uint32_t passes, double (*radiance)[3])
{
    pm_error error = {""};
    pm__run run = progress_begin(s, trial);
    progress_pass(&run, passes);
    PM_CHECK_OK(pm__run_read(&run, radiance, &error), error);
    pm__run_end(&run);
}

/* ---- Blocks ------------------------------------------------------------------------------------ */

typedef struct blocks {
    double mean[VALUES], error[VALUES]; /* standard error, over trials */
} blocks;

/* Sums over the pixels that count (NULL: all), over the pixels of a block or image. */
static void add_up(const double (*radiance)[3], const bool *counts, double sums[VALUES])
{
    memset(sums, 0, VALUES * sizeof *sums);
    for (size_t p = 0; p < POINTS; p++)
        for (size_t b = 0; b < 3 && (!counts || counts[p]); b++) {
            const size_t part = p / SIDE / BLOCK * (SIDE / BLOCK) + p % SIDE / BLOCK;
            sums[3 * part + b] += radiance[p][b] / (BLOCK * BLOCK);
            sums[3 * (size_t)BLOCKS + b] += radiance[p][b] / POINTS;
        }
}

static void run_trials(const progress *s, uint32_t passes, const bool *counts, blocks *made)
{
    static double radiance[POINTS][3], sums[TRIALS][VALUES];
    for (uint32_t t = 0; t < TRIALS; t++) {
        run_trial(s, t, passes, radiance);
        add_up((const double(*)[3])radiance, counts, sums[t]);
    }
    for (size_t v = 0; v < VALUES; v++) {
        double mean = 0.0, square = 0.0;
        for (size_t t = 0; t < TRIALS; t++)
            mean += sums[t][v] / TRIALS;
        for (size_t t = 0; t < TRIALS; t++)
            square += (sums[t][v] - mean) * (sums[t][v] - mean);
        made->mean[v] = mean;
        made->error[v] = sqrt(square / (TRIALS * (TRIALS - 1.0)));
    }
}

/* In standard errors of a mean of TRIALS, or of the difference of two. */
static double bound(void)
{
    return pm__student_quantile(1.0 - 0.5e-6 / CHECKS, TRIALS - 1.0);
}

/* resolved: what an error of the whole image must not hide, relative. */
static void compare(const char *what, const blocks *got, const blocks *want, double resolved)
{
    for (size_t v = 0; v < VALUES; v++) {
        const double off = got->mean[v] - want->mean[v];
        const double error = sqrt(got->error[v] * got->error[v] + want->error[v] * want->error[v]);
        ck_assert_msg(fabs(off) <= bound() * error + 1e-5 * fabs(want->mean[v]),
                      "%s: value %zu: %.6f, expected %.6f, %.1f standard errors", what, v, got->mean[v],
                      want->mean[v], off / error);
        ck_assert_msg(v < 3 * BLOCKS || bound() * error <= resolved * want->mean[v],
                      "%s: value %zu: known within %.2f %% only", what, v, 100.0 * bound() * error / want->mean[v]);
    }
}

/* ---- Exact scenes ------------------------------------------------------------------------------ */

/* What the eye meets at a place of the image. */
static pm__hit_point met_at(const progress *s, double x, double y)
{
    const pm__eye_numbers numbers = pm__eye_numbers_of(1, 0, 0, 0);
    pm__eye eye;
    pm__hit_point point;
    pm__eye_through(&eye, s->progression.stage.scene, &s->progression.stage.camera, &numbers, x, y);
    pm__hit_point_follow(&eye, &point);
    return point;
}

/* A pixel is within a flat convex surface where its corners are; in a ball all are. */
static bool is_whole(const progress *s, size_t pixel)
{
    const double x = (double)(pixel % SIDE), y = (double)(pixel / SIDE);
    const pm__hit_point first = met_at(s, x, y);
    for (int i = 0; i < 4; i++) {
        const pm__hit_point corner = met_at(s, x + i % 2, y + i / 2); /* NOLINT: halves are meant */
        if (!corner.material || !(pm__dot(corner.normal, first.normal) > 0.3))
            return false;
    }
    return true;
}

/* The mean over a pixel, by the product of two Gauss rules. */
static void exact(const progress *s, size_t pixel, double radiance[3])
{
    enum { N = 4 };
    double nodes[N], weights[N];
    pm__gauss_legendre(N, nodes, weights);
    radiance[0] = radiance[1] = radiance[2] = 0.0;
    for (size_t i = 0; i < (size_t)N * N; i++) {
        const double x = (double)(pixel % SIDE) + nodes[i % N], y = (double)(pixel / SIDE) + nodes[i / N];
        const pm__hit_point point = met_at(s, x, y);
        double brdf[3], sent[3];
        pm__hit_point_brdf(&point, point.normal, brdf);
        pm__stage_truth(&s->progression.stage, point.position, point.normal, point.outgoing, brdf, sent);
        for (int b = 0; b < 3; b++)
            radiance[b] += weights[i % N] * weights[i / N] * (sent[b] + point.emitted[b]);
    }
}

static void exact_blocks(const progress *s, bool *counts, blocks *want)
{
    static double radiance[POINTS][3];
    size_t whole = 0;
    *want = (blocks){{0.0}, {0.0}};
    for (size_t p = 0; p < POINTS; p++) {
        counts[p] = is_whole(s, p);
        whole += counts[p];
        if (counts[p])
            exact(s, p, radiance[p]);
    }
    ck_assert_uint_gt(whole, POINTS / 8);
    add_up((const double(*)[3])radiance, counts, want->mean);
}

/* Beneath the plate, so that the floor is seen straight. */
static const pm__view beneath = {.eye = {0, -0.5, 0.35}, .at = {0, 0.1, 0}, .up = {0, 0, 1}, .angle = 0.7};

/* Direct light, caustics, light of several bounces, light of at least two, lights that are seen themselves. Photons by
 * Sobol' points, which are as good as thousands more; and independent ones. */
START_TEST(closed_forms)
{
    static const struct {
        const char *scene, *method, *sampler;
        size_t photons;
        uint32_t passes;
        double resolved;
        const pm__view *view;
    } cases[] = {{"scene:point-light", "light", "sobol", 4096, 2, 0.01, NULL},
                 {"scene:rect-light", "light", "sobol", 4096, 2, 0.01, NULL},
                 {"scene:corner", "light", "sobol", 4096, 2, 0.01, NULL},
                 {"scene:point-light", "light", "poisson", 4000, 4, 0.04, NULL},
                 {"scene:furnace", "light", "poisson", 2000, 2, 0.01, NULL},
                 {"scene:integrating-sphere", "light", "poisson", 4000, 4, 0.02, NULL},
                 {"scene:glossy-plane", "light", "sobol", 4096, 2, 0.01, NULL},
                 {"scene:plate", "light", "sobol", 16384, 1, 0.04, &beneath},
                 {"scene:point-light", "path", "poisson", 0, 4, 0.01, NULL},
                 {"scene:rect-light", "path", "poisson", 0, 16, 0.02, NULL},
                 {"scene:corner", "path", "poisson", 0, 1, 0.01, NULL},
                 {"scene:furnace", "path", "poisson", 0, 16, 0.01, NULL},
                 {"scene:integrating-sphere", "path", "poisson", 0, 16, 0.03, NULL},
                 {"scene:glossy-plane", "path", "poisson", 0, 4, 0.01, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        progress *const s = image_open(scene_of(cases[i].scene), cases[i].view, cases[i].method, cases[i].photons,
                                      cases[i].sampler);
        static bool counts[POINTS];
        blocks got, want;
        char what[100];
        (void)snprintf(what, sizeof what, "%s of %s, %s", cases[i].method, cases[i].scene, cases[i].sampler);
        exact_blocks(s, counts, &want);
        run_trials(s, cases[i].passes, counts, &got);
        compare(what, &got, &want, cases[i].resolved);
        progress_free(s);
    }
}
END_TEST

/* ---- Against each other ------------------------------------------------------------------------ */

START_TEST(a_room_by_both)
{
    progress *const light = image_of("scene:cornell-diffuse", "light", 4000, "poisson");
    progress *const path = image_of("scene:cornell-diffuse", "path", 0, "poisson");
    blocks by_light, by_path;
    run_trials(light, 6, NULL, &by_light);
    run_trials(path, 16, NULL, &by_path);
    compare("cornell-diffuse", &by_light, &by_path, 0.04);
    progress_free(light);
    progress_free(path);
}
END_TEST

/* A closed room with a mirror for a wall and a glass ball under its lamp; seen are parts of the floor and the rear. */
static pm_status build_bench(const double *values, pm__scene *scene, pm_error *error)
{
    (void)values;
    static const double walls[][3][3] = { /* corner and edges: floor, ceiling, front, rear, left, right */
        {{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, {{-1, -1, 2}, {0, 2, 0}, {2, 0, 0}}, {{-1, -1, 0}, {0, 0, 2}, {2, 0, 0}},
        {{-1, 1, 0}, {2, 0, 0}, {0, 0, 2}},  {{-1, -1, 0}, {0, 2, 0}, {0, 0, 2}}, {{1, -1, 0}, {0, 0, 2}, {0, 2, 0}}};
    const pm__light lamp = {.kind = PM__RECTANGLE, .power = {40, 30, 20}, .position = {-0.7, -0.4, 1.99},
                            .edge = {{0, 0.8, 0}, {0.8, 0, 0}}};
    const pm__material mirror = {.kind = PM__MIRROR, .specular = {0.9, 0.8, 0.7}};
    const uint32_t matte = lit_wall(scene, 0.7, 0.6, 0.5), bright = lit_material(scene, &mirror);
    for (size_t i = 0; i < 6; i++)
        PM_CHECK_OK(pm__scene_rectangle(scene, i == 5 ? bright : matte, walls[i][0], walls[i][1], walls[i][2], error),
                    *error);
    lit_sphere(scene, lit_glass(scene), -0.4, 0.1, 1.3, 0.25, false);
    lit_lamp(scene, &lamp);
    return PM_OK;
}

static void view_bench(const double *values, pm__view *view)
{
    (void)values;
    *view = (pm__view){.eye = {0, -0.95, 1}, .at = {-0.3, 0.3, 0}, .up = {0, 0, 1}, .angle = 0.9};
}

/* Only that there is a truth matters: the expression is then the scene's. */
static double no_truth(const double *values, const pm__probe *point)
{
    (void)values;
    (void)point;
    return (double)NAN;
}

START_TEST(each_kind_of_path_by_both)
{
    static const struct {
        const char *paths;
        double resolved;
    } kinds[] = {{"LD", 0.05}, {"LS+D", 0.2}, {"LDD", 0.07}, {"LDSD", 0.2}, {"LS+D.*D", 0.3}, {"L(D|DD+)", 0.04},
                 {"L.*D", 0.07}};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const pm__case bench = {.entry = {.name = "scene:bench"}, .dimensions = 2, .paths = kinds[i].paths,
                                .truth = no_truth, .build = build_bench, .view = view_bench};
        progress *const light = image_open(&bench, NULL, "light", 8000, "poisson");
        progress *const path = image_open(&bench, NULL, "path", 0, "poisson");
        blocks by_light, by_path;
        ck_assert_str_eq(light->progression.expression, kinds[i].paths);
        run_trials(light, 1, NULL, &by_light);
        run_trials(path, 8, NULL, &by_path);
        compare(kinds[i].paths, &by_light, &by_path, kinds[i].resolved);
        progress_free(light);
        progress_free(path);
    }
}
END_TEST

/* A kind of light that can be seen is seen where nothing hides it, and by both: a lamp in the middle of the view. */
static pm__light shown;

static pm_status build_shown(const double *values, pm__scene *scene, pm_error *error)
{
    (void)values;
    (void)error;
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 2.0, -1.0);
    lit_lamp(scene, &shown);
    return PM_OK;
}

static void view_shown(const double *values, pm__view *view)
{
    (void)values;
    *view = (pm__view){.eye = {0, 0, 0}, .at = {0, 1, 0}, .up = {0, 0, 1}, .angle = 1.2};
}

START_TEST(lights_in_view_by_both)
{
    static const pm__light lamps[] = {
        {.kind = PM__RECTANGLE, .power = {3, 2, 1}, .position = {-0.5, 2, -0.5}, .edge = {{1, 0, 0}, {0, 0, 1}}},
        {.kind = PM__BALL, .power = {3, 2, 1}, .position = {0, 2, 0}, .radius = 0.5},
        {.kind = PM__SUN, .power = {3, 2, 1}, .position = {0, 2, 0}, .direction = {0, -1, 0}, .radius = 1,
         .angle = 0.3}};
    const pm__case scene = {.entry = {.name = "scene:shown"}, .dimensions = 2, .build = build_shown,
                            .view = view_shown};
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++) {
        static double radiance[2][POINTS][3];
        const size_t middle = SIDE / 2 * SIDE + SIDE / 2;
        shown = lamps[i];
        for (size_t m = 0; m < 2; m++) {
            const char *const methods[] = {"path", "light"};
            progress *const s = image_open(&scene, NULL, methods[m], 1000, "poisson");
            run_trial(s, 0, 2, radiance[m]);
            for (int b = 0; b < 3; b++)
                PM_CHECK_NEAR(radiance[m][middle][b], s->progression.fixed[middle].emitted[b], 1e-12);
            progress_free(s);
        }
        ck_assert(radiance[0][middle][0] > 0.1);
    }
}
END_TEST

/* A lamp without an area behind glass: paths never find it. A floor seen through glass: no photon is joined there. */
START_TEST(what_is_not_found_is_black)
{
    static const char *const methods[] = {"path", "light"};
    static double radiance[POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        progress *const s = image_of("scene:plate", methods[m], 5000, "poisson");
        bool seen = false;
        run_trial(s, 0, 2, radiance);
        for (size_t p = 0; p < POINTS; p++) {
            seen = seen || s->progression.fixed[p].material;
            for (int b = 0; b < 3; b++)
                PM_CHECK_NEAR(radiance[p][b], 0.0, 0.0);
        }
        ck_assert(seen);
        progress_free(s);
    }
}
END_TEST

PM_TEST_MAIN("light_path", closed_forms, a_room_by_both, each_kind_of_path_by_both, lights_in_view_by_both,
             what_is_not_found_is_black)
