/* How long a pass of progressive photon mapping takes: beside its parts alone (photons traced, bare searches of the
 * same radii in a map that is there), on several threads beside one, and beside random rays of which Embree alone
 * answers each. */
#include "speed.h"

#include "../src/base/clock.h"
#include "../src/base/memory.h"
#include "../src/base/parallel.h"
#include "../src/base/random.h"
#include "../src/base/turn.h"
#include "../src/methods/progressive/progressive.h"
#include "plain_scene.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Promised: at most 1.3 times the parts' time; of one thread's rate, on two (more are held to no more); at most the
 * time of two million rays. */
static const double of_parts = 1.0 / 1.3, of_one_thread = 1.8, promised_rays = 2e6;

/* The share of new photons that is kept as radii shrink, and the first radius over that of the sphere about the
 * scene's box. */
static const double alpha = 0.75, reach = 0.003;

enum {
    AT_ONCE = 32,  /* queries handed to a search at once: their answers stay in the nearest cache */
    QUERIES = 256, /* of a task */
    RAYS = 100000  /* of a unit */
};

/* A unit of work is the first pass, whatever its number: always the same photons and radii. What it takes to go back to
 * before it is not counted: the clock is put back by that. */
typedef struct passing {
    pm__progressive_config config;
    pm__spec method;
    pm_estimator *kernel;
    pm__progression progression;
    pm__run run;
    double *before; /* the state */
    double *paused; /* s, of the clock of all variants */
    clockid_t clock;
    pm_status status;
} passing;

static double now(clockid_t clock)
{
    struct timespec t;
    (void)clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- A pass ------------------------------------------------------------------------------------ */

static size_t size_of_state(const passing *p)
{
    return p->progression.points * pm__progressive_of(&p->run)->fields * sizeof *p->before;
}

static void go_back(passing *p)
{
    const double start = now(p->clock);
    p->status = p->status ? p->status : pm__run_resume(&p->run, p->before, 0, NULL);
    *p->paused += now(p->clock) - start;
}

static void run_pass(void *context, size_t first, size_t repetitions)
{
    passing *const p = context;
    (void)first;
    for (size_t i = 0; i < repetitions && p->status == PM_OK; i++) {
        go_back(p);
        p->status = p->status ? p->status : pm__run_pass(&p->run, NULL);
    }
}

static void box_of(const pm__scene *scene, double low[3], double high[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
            const pm__object object = pm__scene_object(scene, i);
            low[a] = fmin(low[a], object.low[a]);
            high[a] = fmax(high[a], object.high[a]);
        }
    }
}

static double first_radius(const pm__scene *scene)
{
    double low[3], high[3], square = 0.0;
    box_of(scene, low, high);
    for (int a = 0; a < 3; a++)
        square += (high[a] - low[a]) * (high[a] - low[a]);
    return reach * 0.5 * sqrt(square);
}

static pm_status find_radius(passing *p, pm_error *error)
{
    pm__stage stage;
    const pm_status status = pm__stage_open(p->config.scene, NULL, p->config.width, p->config.height, &stage, error);
    if (status == PM_OK) {
        p->config.radius = first_radius(stage.scene);
        pm__stage_close(&stage);
    }
    return status;
}

static void close_passes(passing *p)
{
    free(p->before);
    pm__run_end(&p->run);
    pm__progression_close(&p->progression);
    pm_estimator_destroy(p->kernel);
}

/* Where it fails there is nothing to close. */
static pm_status open_passes(const pm__speed_config *config, const pm__speed_row *row, const pm_parallel *parallel,
                             clockid_t clock, double *paused, passing *p, pm_error *error)
{
    *p = (passing){.paused = paused, .clock = clock};
    p->config = (pm__progressive_config){.scene = &row->scene, .width = config->width, .height = config->height,
                                         .method = &p->method, .alpha = alpha, .photons = row->photons,
                                         .front_only = true, .seed = config->seed, .parallel = parallel,
                                         .canceled = config->canceled, .context = config->context};
    pm_status status = pm__spec_parse(&pm__progressives, row->method, &p->method, error);
    if (status == PM_OK)
        status = pm_estimator_create("disc", &p->kernel, error);
    p->config.estimator = p->kernel;
    if (status == PM_OK)
        status = find_radius(p, error);
    if (status == PM_OK)
        status = pm__progression_open(&p->config, &p->progression, error);
    if (status != PM_OK) {
        pm_estimator_destroy(p->kernel);
        return status;
    }
    status = pm__run_begin(&p->progression, 0, &p->run, error);
    p->before = status == PM_OK ? pm__alloc(size_of_state(p), 1) : NULL;
    if (p->before)
        memcpy(p->before, p->run.state, size_of_state(p));
    else
        status = pm__fail(error, PM_ENOMEM, "out of memory for a pass");
    if (status != PM_OK)
        close_passes(p);
    return status;
}

/* ---- Its parts --------------------------------------------------------------------------------- */

typedef struct parts {
    passing *of;
    const pm_map *map;
    pm_query *queries;
    size_t count, most; /* photons that a query finds at most */
    uint64_t found;
    double trace_s, map_s, search_s;
    atomic_int failure; /* a pm_status */
} parts;

static void search_some(void *argument, size_t index)
{
    parts *const p = argument;
    const size_t end = (index + 1) * QUERIES < p->count ? (index + 1) * QUERIES : p->count;
    size_t counts[AT_ONCE];
    pm_neighbor *const found = pm__alloc(AT_ONCE * p->most, sizeof *found);
    pm_status status = found ? PM_OK : PM_ENOMEM;
    for (size_t q = index * QUERIES; q < end && status == PM_OK; q += AT_ONCE)
        status = pm_map_search_batch(p->map, p->queries + q, end - q < AT_ONCE ? end - q : AT_ONCE, found, p->most,
                                     counts);
    if (status != PM_OK)
        atomic_store(&p->failure, (int)status);
    free(found);
}

static pm_status make_pass_map(parts *p, pm_map **map, pm_error *error)
{
    pm__run *const run = &p->of->run;
    pm__photon_set set = {0};
    const double start = pm__seconds();
    pm_status status = pm__run_shoot(run, 0, &set, error);
    const double traced = pm__seconds();
    if (status == PM_OK)
        status = pm__run_pass_map(run, &set, map, error);
    pm__photon_set_free(&set);
    p->trace_s += traced - start;
    p->map_s += pm__seconds() - traced;
    return status;
}

/* The map is none of the parts: the clock is put back by what it takes to come and go. */
static void run_parts(void *context, size_t first, size_t repetitions)
{
    parts *const p = context;
    (void)first;
    for (size_t i = 0; i < repetitions && atomic_load(&p->failure) == PM_OK; i++) {
        pm_map *map = NULL;
        const double mapped = p->map_s;
        const pm_status status = make_pass_map(p, &map, NULL);
        const double start = pm__seconds();
        p->map = map;
        if (status == PM_OK)
            pm__for(p->of->config.parallel, (p->count + QUERIES - 1) / QUERIES, search_some, p);
        else
            atomic_store(&p->failure, (int)status);
        const double searched = pm__seconds();
        p->search_s += searched - start;
        pm_map_destroy(map);
        *p->of->paused += p->map_s - mapped + (pm__seconds() - searched);
    }
}

/* The pass's queries, and what they find. */
static pm_status list_queries(parts *p, pm_error *error)
{
    const pm__progression *const progression = &p->of->progression;
    pm_map *map = NULL;
    pm_status status = make_pass_map(p, &map, error);
    p->queries = status == PM_OK ? pm__alloc(progression->points, sizeof *p->queries) : NULL;
    if (status == PM_OK && !p->queries)
        status = pm__fail(error, PM_ENOMEM, "out of memory for the queries of a pass");
    for (size_t i = 0; i < progression->points && status == PM_OK; i++) {
        const pm__hit_point *const point = &progression->fixed[i];
        size_t count = 0;
        if (!point->material)
            continue;
        pm_query *const query = &p->queries[p->count++];
        pm__point_query(progression, point, 0, (double)progression->radius[i], query);
        const pm_status found = pm_map_search(map, query, NULL, 0, &count);
        status = found == PM_ETRUNCATED ? PM_OK : found;
        p->found += count;
        p->most = count > p->most ? count : p->most;
    }
    pm_map_destroy(map);
    p->trace_s = p->map_s = 0.0;
    return status;
}

/* ---- Rays -------------------------------------------------------------------------------------- */

typedef struct random_rays {
    pm__plain_scene plain;
    float (*rays)[6]; /* origin, direction */
    double sink, *paused;
} random_rays;

/* Uniform in the scene's box, uniform in direction. */
static pm_status draw_rays(const pm__scene *scene, uint64_t seed, random_rays *r, pm_error *error)
{
    double low[3], high[3];
    pm_status status = pm__plain_scene_create(scene, false, &r->plain, error);
    box_of(scene, low, high);
    r->rays = status == PM_OK ? pm__alloc(RAYS, sizeof *r->rays) : NULL;
    if (status == PM_OK && !r->rays)
        status = pm__fail(error, PM_ENOMEM, "out of memory for random rays");
    for (size_t i = 0; i < RAYS && status == PM_OK; i++) {
        double u[5], sine, cosine;
        pm__random_uniform(seed, PM__FOR_TIMING, 0, i, u, 5);
        for (int a = 0; a < 3; a++)
            r->rays[i][a] = (float)(low[a] + u[a] * (high[a] - low[a]));
        const double z = 2.0 * u[3] - 1.0, across = sqrt(1.0 - z * z);
        pm__turn(u[4], &sine, &cosine);
        r->rays[i][3] = (float)(across * cosine);
        r->rays[i][4] = (float)(across * sine);
        r->rays[i][5] = (float)z;
    }
    return status;
}

/* Threads that wait for work meanwhile, as those of a pass before, are not counted. */
static void ask_rays(void *context, size_t first, size_t repetitions)
{
    random_rays *const r = context;
    const double others = now(CLOCK_PROCESS_CPUTIME_ID) - now(CLOCK_THREAD_CPUTIME_ID);
    (void)first;
    for (size_t i = 0; i < repetitions * RAYS; i++) {
        const float *const ray = r->rays[i % RAYS];
        struct RTCIntersectContext asked;
        rtcInitIntersectContext(&asked);
        struct RTCRayHit answer = {.ray = {.org_x = ray[0], .org_y = ray[1], .org_z = ray[2], .dir_x = ray[3],
                                           .dir_y = ray[4], .dir_z = ray[5], .tfar = INFINITY, .mask = 0xffffffff},
                                   .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
        rtcIntersect1(r->plain.scene, &asked, &answer);
        r->sink += answer.hit.geomID != RTC_INVALID_GEOMETRY_ID ? (double)answer.ray.tfar : 0.0;
    }
    *r->paused += now(CLOCK_PROCESS_CPUTIME_ID) - now(CLOCK_THREAD_CPUTIME_ID) - others;
}

static bool count_photon(void *context, uint64_t number, const pm__stored *photon)
{
    (void)context;
    (void)number;
    (void)photon;
    return true;
}

static void count_ray(void *context, const double origin[3], const double direction[3], uint32_t from)
{
    (void)origin;
    (void)direction;
    (void)from;
    ++*(uint64_t *)context;
}

/* That the photons of the pass take. */
static uint64_t count_rays(const passing *p)
{
    const pm__trace_config config = {.scene = p->progression.stage.scene, .paths = p->progression.paths,
                                     .seed = p->run.seed, .trial = 0};
    uint64_t rays = 0;
    (void)pm__trace_watched(&config, 0, p->config.photons, count_photon, count_ray, &rays);
    return rays;
}

/* ---- Comparing --------------------------------------------------------------------------------- */

static double running_wall(void *paused)
{
    return now(CLOCK_MONOTONIC) - *(const double *)paused;
}

/* Of all threads together. */
static double running_processors(void *paused)
{
    return now(CLOCK_PROCESS_CPUTIME_ID) - *(const double *)paused;
}

static pm_status compare(const pm__speed_config *config, const pm__bench_variant variants[2], pm__clock clock,
                         double seconds, pm__bench_report *report, pm_error *error)
{
    const pm__bench_config bench = {.clock = clock, .seconds = seconds, .baseline = 0, .seed = config->seed,
                                    .canceled = config->canceled, .context = config->context};
    return pm__bench_run(&bench, variants, 2, report, error);
}

static void begin_row(const pm__speed_config *config, const char *baseline, double promise, pm__speed_row *row)
{
    row->photons = config->pass_photons;
    row->threads = config->threads;
    row->baseline = baseline;
    row->promise = promise;
}

static pm_status compare_parts(const pm__speed_config *config, passing *pass, double *paused, double seconds,
                               pm__speed_row *row, pm_error *error)
{
    enum { PARTS, WHOLE };
    parts p = {.of = pass, .most = 1};
    pm_status status = list_queries(&p, error);
    if (status == PM_OK) {
        const pm__bench_variant variants[] = {{"parts", run_parts, &p}, {"whole", run_pass, pass}};
        pm__bench_report report;
        status = compare(config, variants, (pm__clock){running_wall, paused}, seconds, &report, error);
        if (status == PM_OK)
            status = pass->status ? pass->status : (pm_status)atomic_load(&p.failure);
        if (status == PM_OK) {
            pm__speed_take(&report, WHOLE, PARTS, 1e-9, row);
            const double bare = p.trace_s + p.search_s;
            (void)snprintf(row->detail, sizeof row->detail,
                           "%.2f times its parts (tracing %.0f %%, bare searches %.0f %% of them), %.2f times these "
                           "and a map; %zu x %zu points, %.2f photons each", 1.0 / row->ratio,
                           100.0 * p.trace_s / bare, 100.0 * p.search_s / bare,
                           bare / (row->ratio * (bare + p.map_s)), pass->config.width, pass->config.height,
                           (double)p.found / (double)pass->progression.points);
        }
        pm__bench_free(&report);
    }
    free(p.queries);
    return status;
}

pm_status pm__speed_pass(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    double paused = 0.0;
    passing pass;
    begin_row(config, "parts", of_parts, row);
    pm_status status = open_passes(config, row, config->parallel, CLOCK_MONOTONIC, &paused, &pass, error);
    if (status != PM_OK)
        return status;
    status = compare_parts(config, &pass, &paused, seconds, row, error);
    close_passes(&pass);
    return status;
}

pm_status pm__speed_pass_threads(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    enum { ONE, ALL };
    double paused = 0.0;
    passing pass[2];
    begin_row(config, "one thread", of_one_thread, row);
    pm_status status = open_passes(config, row, NULL, CLOCK_MONOTONIC, &paused, &pass[ONE], error);
    if (status != PM_OK)
        return status;
    status = open_passes(config, row, config->parallel, CLOCK_MONOTONIC, &paused, &pass[ALL], error);
    if (status == PM_OK) {
        const pm__bench_variant variants[] = {{"one thread", run_pass, &pass[ONE]}, {"all", run_pass, &pass[ALL]}};
        pm__bench_report report;
        status = compare(config, variants, (pm__clock){running_wall, &paused}, seconds, &report, error);
        if (status == PM_OK)
            status = pass[ONE].status ? pass[ONE].status : pass[ALL].status;
        if (status == PM_OK) {
            const pm__run *const run = &pass[ALL].run;
            const double all = run->trace_s + run->build_s + run->lookup_s;
            pm__speed_take(&report, ALL, ONE, 1e-9, row);
            (void)snprintf(row->detail, sizeof row->detail,
                           "on all threads tracing is %.0f %% of it, lists of points or a map %.0f %%, meeting %.0f %%",
                           100.0 * run->trace_s / all, 100.0 * run->build_s / all, 100.0 * run->lookup_s / all);
        }
        pm__bench_free(&report);
        close_passes(&pass[ALL]);
    }
    close_passes(&pass[ONE]);
    return status;
}

/* A unit of the baseline is a part of the rays promised, and the ratio that of all of them. */
static void take_rays(const pm__bench_report *report, const passing *pass, uint64_t found, pm__speed_row *row)
{
    enum { RAY_UNIT, PASS };
    const double units = promised_rays / RAYS;
    pm__speed_take(report, PASS, RAY_UNIT, 1e-9, row);
    row->baseline_seconds *= units;
    row->ratio *= units;
    row->ratio_ci95.low *= units;
    row->ratio_ci95.high *= units;
    (void)snprintf(row->detail, sizeof row->detail,
                   "the time of %.3g million rays of %.1f ns, processors' time; %.3g million rays traced, %.3g million "
                   "photons stored, %.3g million found by %zu x %zu points", 1e-6 * promised_rays / row->ratio,
                   1e9 * row->baseline_seconds / promised_rays, 1e-6 * (double)count_rays(pass),
                   1e-6 * (double)pass->run.stored, 1e-6 * (double)found, pass->config.width, pass->config.height);
}

static pm_status compare_rays(const pm__speed_config *config, passing *pass, double *paused, double seconds,
                              pm__speed_row *row, pm_error *error)
{
    parts p = {.of = pass, .most = 1};
    random_rays rays = {.paused = paused};
    pm_status status = draw_rays(pass->progression.stage.scene, config->seed, &rays, error);
    if (status == PM_OK)
        status = list_queries(&p, error);
    if (status == PM_OK) {
        const pm__bench_variant variants[] = {{"rays", ask_rays, &rays}, {"pass", run_pass, pass}};
        pm__bench_report report;
        const uint64_t stored = pass->run.stored; /* of the one pass whose queries are listed */
        status = compare(config, variants, (pm__clock){running_processors, paused}, seconds, &report, error);
        pass->run.stored = stored;
        status = status ? status : pass->status;
        if (status == PM_OK)
            take_rays(&report, pass, p.found, row);
        pm__bench_free(&report);
    }
    pm__plain_scene_destroy(&rays.plain);
    free(rays.rays);
    free(p.queries);
    return status;
}

pm_status pm__speed_pass_rays(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    double paused = 0.0;
    passing pass;
    begin_row(config, "2e6 rays", 1.0, row);
    pm_status status = open_passes(config, row, config->parallel, CLOCK_PROCESS_CPUTIME_ID, &paused, &pass, error);
    if (status != PM_OK)
        return status;
    status = compare_rays(config, &pass, &paused, seconds, row, error);
    close_passes(&pass);
    return status;
}
