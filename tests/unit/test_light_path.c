/* Path and light tracing pass by pass: against closed forms, against each other on every kind of light path, and as
 * runs that can be taken up again, on any number of threads. Trials are the replicates; Student's bound for a false
 * alarm in 1e-6 over the file (CHECKS comparisons, two-sided). */
#include "../../src/base/gauss.h"
#include "../../src/methods/progressive/list.h"
#include "../../src/stats/stats.h"
#include "../picture.h"

enum { SIDE = 16, POINTS = SIDE * SIDE, BLOCK = 4, BLOCKS = POINTS / (BLOCK * BLOCK), PARTS = BLOCKS + 1 };
enum { VALUES = 3 * PARTS }; /* of blocks, and of the whole, by band */
enum { TRIALS = 64, CHECKS = 1500 };

/* ---- Runs -------------------------------------------------------------------------------------- */

typedef struct setting {
    pm__spec scene, method;
    pm_estimator *kernel; /* looked at by neither method: one that needs more than a lookup */
    pm__progressive_config config;
    pm__progression progression;
} setting;

/* view: NULL: the scene's own. */
static setting *setting_open(const pm__case *scene, const pm__view *view, const char *method, size_t photons,
                             const char *sampler, const pm_parallel *parallel)
{
    setting *const s = calloc(1, sizeof *s);
    pm_error error = {""};
    ck_assert_ptr_nonnull(s);
    pm__spec_default(&scene->entry, &s->scene);
    PM_CHECK_OK(pm__spec_parse(&pm__progressives, method, &s->method, &error), error);
    PM_CHECK_OK(pm_estimator_create("combined", &s->kernel, &error), error);
    s->config = (pm__progressive_config){.scene = &s->scene, .view = view, .width = SIDE, .height = SIDE,
                                         .method = &s->method, .estimator = s->kernel, .photons = photons,
                                         .seed = 3, .sampler = lit_sampler(sampler), .parallel = parallel};
    PM_CHECK_OK(pm__progression_open(&s->config, &s->progression, &error), error);
    return s;
}

static const pm__case *scene_of(const char *name)
{
    const pm__entry *const entry = pm__find(&pm__scene_cases, name);
    ck_assert_ptr_nonnull(entry);
    return (const pm__case *)(const void *)entry;
}

static setting *setting_of(const char *scene, const char *method, size_t photons, const char *sampler)
{
    return setting_open(scene_of(scene), NULL, method, photons, sampler, NULL);
}

static void setting_close(setting *s)
{
    pm__progression_close(&s->progression);
    pm_estimator_destroy(s->kernel);
    free(s);
}

static void pass(pm__run *run, uint32_t count)
{
    pm_error error = {""};
    for (uint32_t i = 0; i < count; i++)
        PM_CHECK_OK(pm__run_pass(run, &error), error);
}

static void run_trial(const setting *s, uint32_t trial, uint32_t passes, double (*radiance)[3])
{
    pm_error error = {""};
    pm__run run;
    PM_CHECK_OK(pm__run_begin(&s->progression, trial, &run, &error), error);
    pass(&run, passes);
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

static void run_trials(const setting *s, uint32_t passes, const bool *counts, blocks *made)
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
static pm__hit_point met_at(const setting *s, double x, double y)
{
    const pm__eye_numbers numbers = pm__eye_numbers_of(1, 0, 0, 0);
    pm__eye eye;
    pm__hit_point point;
    pm__eye_through(&eye, s->progression.stage.scene, &s->progression.stage.camera, &numbers, x, y);
    pm__hit_point_follow(&eye, &point);
    return point;
}

/* A pixel is within a flat convex surface where its corners are; in a ball all are. */
static bool is_whole(const setting *s, size_t pixel)
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
static void exact(const setting *s, size_t pixel, double radiance[3])
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

static void exact_blocks(const setting *s, bool *counts, blocks *want)
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
        setting *const s = setting_open(scene_of(cases[i].scene), cases[i].view, cases[i].method, cases[i].photons,
                                        cases[i].sampler, NULL);
        static bool counts[POINTS];
        blocks got, want;
        char what[100];
        (void)snprintf(what, sizeof what, "%s of %s, %s", cases[i].method, cases[i].scene, cases[i].sampler);
        exact_blocks(s, counts, &want);
        run_trials(s, cases[i].passes, counts, &got);
        compare(what, &got, &want, cases[i].resolved);
        setting_close(s);
    }
}
END_TEST

/* ---- Against each other ------------------------------------------------------------------------ */

START_TEST(a_room_by_both)
{
    setting *const light = setting_of("scene:cornell-diffuse", "light", 4000, "poisson");
    setting *const path = setting_of("scene:cornell-diffuse", "path", 0, "poisson");
    blocks by_light, by_path;
    run_trials(light, 6, NULL, &by_light);
    run_trials(path, 16, NULL, &by_path);
    compare("cornell-diffuse", &by_light, &by_path, 0.04);
    setting_close(light);
    setting_close(path);
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
        setting *const light = setting_open(&bench, NULL, "light", 8000, "poisson", NULL);
        setting *const path = setting_open(&bench, NULL, "path", 0, "poisson", NULL);
        blocks by_light, by_path;
        ck_assert_str_eq(light->progression.expression, kinds[i].paths);
        run_trials(light, 1, NULL, &by_light);
        run_trials(path, 8, NULL, &by_path);
        compare(kinds[i].paths, &by_light, &by_path, kinds[i].resolved);
        setting_close(light);
        setting_close(path);
    }
}
END_TEST

/* A lamp without an area behind glass: paths never find it. A floor seen through glass: no photon is joined there. */
START_TEST(what_is_not_found_is_black)
{
    static const char *const methods[] = {"path", "light"};
    static double radiance[POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        setting *const s = setting_of("scene:plate", methods[m], 5000, "poisson");
        bool seen = false;
        run_trial(s, 0, 2, radiance);
        for (size_t p = 0; p < POINTS; p++) {
            seen = seen || s->progression.fixed[p].material;
            for (int b = 0; b < 3; b++)
                PM_CHECK_NEAR(radiance[p][b], 0.0, 0.0);
        }
        ck_assert(seen);
        setting_close(s);
    }
}
END_TEST

/* ---- Runs -------------------------------------------------------------------------------------- */

/* Several rounds of photons, lights in view. */
enum { MANY = 40000 };
static const char *const both[] = {"path", "light"};

START_TEST(resumed_as_undisturbed)
{
    static double want[POINTS][3], got[POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        setting *const s = setting_of("scene:cornell-diffuse", both[m], MANY, "poisson");
        pm_error error = {""};
        pm__run first, second;
        run_trial(s, 1, 3, want);
        PM_CHECK_OK(pm__run_begin(&s->progression, 1, &first, &error), error);
        PM_CHECK_OK(pm__run_begin(&s->progression, 1, &second, &error), error);
        pass(&first, 1);
        PM_CHECK_OK(pm__run_resume(&second, first.state, first.passes, &error), error);
        pm__run_end(&first);
        pass(&second, 2);
        ck_assert_uint_eq(second.passes, 3);
        PM_CHECK_OK(pm__run_read(&second, got, &error), error);
        pm__run_end(&second);
        ck_assert_msg(memcmp(want, got, sizeof want) == 0, "%s", both[m]);
        setting_close(s);
    }
}
END_TEST

START_TEST(as_one_thread_so_two)
{
    static double want[POINTS][3], got[POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        const pm__case *const room = scene_of("scene:cornell-diffuse");
        setting *const one = setting_open(room, NULL, both[m], MANY, "poisson", NULL);
        setting *const two = setting_open(room, NULL, both[m], MANY, "poisson", &picture_two_threads);
        run_trial(one, 0, 2, want);
        run_trial(two, 0, 2, got);
        ck_assert_msg(memcmp(want, got, sizeof want) == 0, "%s", both[m]);
        setting_close(one);
        setting_close(two);
    }
}
END_TEST

/* Passes and trials have numbers of their own: no answer comes twice. */
START_TEST(passes_and_trials_differ)
{
    static double seen[4][POINTS][3];
    for (size_t m = 0; m < 2; m++) {
        setting *const s = setting_of("scene:cornell-diffuse", both[m], 1000, "poisson");
        for (uint32_t i = 0; i < 4; i++)
            run_trial(s, i % 2, 1 + i / 2, seen[i]);
        for (size_t i = 0; i < 4; i++)
            for (size_t j = 0; j < i; j++)
                ck_assert_msg(memcmp(seen[i], seen[j], sizeof seen[i]) != 0, "%s: %zu and %zu", both[m], i, j);
        setting_close(s);
    }
}
END_TEST

/* What a point says of itself: photons that were joined to it; no radius. */
START_TEST(photons_are_counted)
{
    setting *const s = setting_of("scene:furnace", "light", 3000, "poisson");
    pm_error error = {""};
    pm__run run;
    double sum = 0.0;
    PM_CHECK_OK(pm__run_begin(&s->progression, 0, &run, &error), error);
    pass(&run, 2);
    for (size_t p = 0; p < POINTS; p++) {
        const pm__point_view view = pm__run_view(&run, p);
        PM_CHECK_NEAR(view.radius, 0.0, 0.0);
        sum += view.count;
    }
    ck_assert_uint_eq(run.emitted, 6000);
    ck_assert(sum > 0.0 && sum < (double)run.stored);
    pm__run_end(&run);
    setting_close(s);
}
END_TEST

static bool stops(void *context)
{
    atomic_int *const left = context;
    return atomic_fetch_sub(left, 1) <= 0;
}

START_TEST(passes_are_canceled)
{
    for (size_t m = 0; m < 2; m++) {
        setting *const s = setting_of("scene:cornell-diffuse", both[m], MANY, "poisson");
        pm_status status = PM_ECANCELED;
        int asked = 0;
        for (; status == PM_ECANCELED; asked++) {
            atomic_int left = asked * asked; /* times that it says no */
            pm_error error = {""};
            pm__run run;
            s->config.canceled = stops;
            s->config.context = &left;
            PM_CHECK_OK(pm__run_begin(&s->progression, 0, &run, &error), error);
            status = pm__run_pass(&run, &error);
            ck_assert_msg(status == PM_OK || strstr(error.text, "canceled"), "%s", error.text);
            if (status != PM_OK) { /* as it was before */
                ck_assert_uint_eq(run.passes + run.emitted + run.stored, 0);
                const size_t fields = pm__progressive_of(&run)->fields;
                for (size_t i = 0; i < s->progression.points * fields; i++)
                    ck_assert(run.state[i] == 0.0);
            }
            pm__run_end(&run);
        }
        ck_assert_int_eq(status, PM_OK);
        ck_assert_int_gt(asked, 1);
        setting_close(s);
    }
}
END_TEST

START_TEST(photons_are_needed)
{
    setting *const s = setting_of("scene:furnace", "light", 1, "poisson");
    pm__progression none;
    pm_error error = {""};
    pm__progressive_config config = s->config;
    config.photons = 0;
    ck_assert_int_eq(pm__progression_open(&config, &none, &error), PM_EINVAL);
    ck_assert_msg(strstr(error.text, "no photons"), "%s", error.text);
    setting_close(s);
}
END_TEST

PM_TEST_MAIN("light_path", closed_forms, a_room_by_both, each_kind_of_path_by_both, what_is_not_found_is_black,
             resumed_as_undisturbed, as_one_thread_so_two, passes_and_trials_differ, photons_are_counted,
             passes_are_canceled, photons_are_needed)
