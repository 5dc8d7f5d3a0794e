#include "tracing.h"

#include "../cases/case.h"
#include "../src/base/memory.h"
#include "../src/transport/trace.h"
#include "plain_scene.h"

#include <stdlib.h>
#include <string.h>

/* Embree alone leaves a surface by so much of the scene's extent, lest it meet it again. */
static const double CLEARANCE = 1e-5;

/* Photons are kept in a ring: storing costs what it costs, memory stays bounded. */
enum { KEPT = 1 << 14 };

/* The variants. */
enum { TRACED, SCENE, EMBREE, ROBUST, VARIANTS };

typedef struct recorded_ray {
    double origin[3], direction[3];
    uint32_t from;
    float tnear;
} recorded_ray;

typedef struct workload {
    const pm__scene *scene;
    pm__plain_scene plain, robust;
    size_t photons;
    recorded_ray *rays;
    size_t *first; /* [photons + 1]: which rays are whose */
    size_t count, capacity;
    bool failed;   /* memory ran out while rays were recorded */
    pm_photon *kept;
    uint64_t stored;
    double sink;   /* what is answered is used */
} workload;

/* ---- Recording ---------------------------------------------------------------------------------- */

static void record_ray(void *context, const double origin[3], const double direction[3], uint32_t from)
{
    workload *const w = context;
    void *rays = w->rays;
    if (w->failed || pm__grow(&rays, &w->capacity, w->count + 1, sizeof *w->rays)) {
        w->failed = true;
        return;
    }
    w->rays = rays;
    recorded_ray *const ray = &w->rays[w->count++];
    memcpy(ray->origin, origin, sizeof ray->origin);
    memcpy(ray->direction, direction, sizeof ray->direction);
    ray->from = from;
}

/* As a photon map takes it. */
static bool keep(void *context, uint64_t number, const pm__stored *stored)
{
    workload *const w = context;
    pm_photon *const photon = &w->kept[w->stored++ % KEPT];
    (void)number;
    for (int i = 0; i < 3; i++) {
        photon->position[i] = (float)stored->position[i];
        photon->direction[i] = (float)stored->direction[i];
        photon->power[i] = (float)stored->power[i];
    }
    return true;
}

static double extent_of(const pm__scene *scene)
{
    double extent = 0.0;
    for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
        const pm__object object = pm__scene_object(scene, i);
        for (int axis = 0; axis < 3; axis++)
            extent = fmax(extent, fmax(fabs(object.low[axis]), fabs(object.high[axis])));
    }
    return extent;
}

static pm_status record(workload *w, pm_error *error)
{
    const pm__trace_config config = {.scene = w->scene, .seed = 1};
    w->first = pm__alloc(w->photons + 1, sizeof *w->first);
    w->kept = pm__alloc_zero(KEPT, sizeof *w->kept);
    if (!w->first || !w->kept)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu photons", w->photons);
    for (size_t i = 0; i < w->photons; i++) {
        w->first[i] = w->count;
        (void)pm__trace_watched(&config, i, 1, keep, record_ray, w);
    }
    w->first[w->photons] = w->count;
    if (w->failed)
        return pm__fail(error, PM_ENOMEM, "out of memory for the rays of %zu photons", w->photons);
    const float clearance = (float)(CLEARANCE * extent_of(w->scene));
    for (size_t i = 0; i < w->count; i++)
        w->rays[i].tnear = w->rays[i].from == PM__NO_SHAPE ? 0.0f : clearance;
    return w->count > 0 ? PM_OK : pm__fail(error, PM_EINVAL, "the scene's photons take no ray");
}

/* ---- Variants: a unit is a photon, or all its rays ------------------------------------------------ */

/* Calls piece for each run of photons without a wrap. */
static void in_pieces(workload *w, size_t first, size_t repetitions, void (*piece)(workload *, size_t, size_t))
{
    while (repetitions > 0) {
        const size_t start = first % w->photons, room = w->photons - start;
        const size_t count = repetitions < room ? repetitions : room;
        piece(w, start, count);
        first += count;
        repetitions -= count;
    }
}

static void trace_piece(workload *w, size_t start, size_t count)
{
    const pm__trace_config config = {.scene = w->scene, .seed = 1};
    (void)pm__trace(&config, start, count, keep, w);
}

static void scene_piece(workload *w, size_t start, size_t count)
{
    for (size_t i = w->first[start]; i < w->first[start + count]; i++) {
        const recorded_ray *const ray = &w->rays[i];
        pm__hit hit;
        if (pm__scene_intersect(w->scene, ray->origin, ray->direction, INFINITY, ray->from, &hit))
            w->sink += hit.distance;
    }
}

static bool ask_embree(RTCScene scene, const recorded_ray *ray, struct RTCRayHit *answer)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    *answer = (struct RTCRayHit){.ray = {.org_x = (float)ray->origin[0],
                                         .org_y = (float)ray->origin[1],
                                         .org_z = (float)ray->origin[2],
                                         .dir_x = (float)ray->direction[0],
                                         .dir_y = (float)ray->direction[1],
                                         .dir_z = (float)ray->direction[2],
                                         .tnear = ray->tnear,
                                         .tfar = INFINITY,
                                         .mask = 0xffffffff},
                                 .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
    rtcIntersect1(scene, &context, answer);
    return answer->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

static void ask_all(workload *w, RTCScene scene, size_t start, size_t count)
{
    for (size_t i = w->first[start]; i < w->first[start + count]; i++) {
        struct RTCRayHit answer;
        if (ask_embree(scene, &w->rays[i], &answer))
            w->sink += (double)answer.ray.tfar;
    }
}

static void embree_piece(workload *w, size_t start, size_t count)
{
    ask_all(w, w->plain.scene, start, count);
}

static void robust_piece(workload *w, size_t start, size_t count)
{
    ask_all(w, w->robust.scene, start, count);
}

static void run_traced(void *context, size_t first, size_t repetitions)
{
    in_pieces(context, first, repetitions, trace_piece);
}

static void run_scene(void *context, size_t first, size_t repetitions)
{
    in_pieces(context, first, repetitions, scene_piece);
}

static void run_embree(void *context, size_t first, size_t repetitions)
{
    in_pieces(context, first, repetitions, embree_piece);
}

static void run_robust(void *context, size_t first, size_t repetitions)
{
    in_pieces(context, first, repetitions, robust_piece);
}

/* ---- A run ---------------------------------------------------------------------------------------- */

static double agreement_of(const workload *w)
{
    size_t agreeing = 0;
    for (size_t i = 0; i < w->count; i++) {
        const recorded_ray *const ray = &w->rays[i];
        struct RTCRayHit answer;
        pm__hit hit;
        const bool met = pm__scene_intersect(w->scene, ray->origin, ray->direction, INFINITY, ray->from, &hit);
        agreeing += met == ask_embree(w->plain.scene, ray, &answer);
    }
    return (double)agreeing / (double)w->count;
}

static pm_status compare(workload *w, double seconds, pm__tracing_row *row, pm_error *error)
{
    const pm__bench_variant variants[VARIANTS] = {
        {"traced", run_traced, w}, {"scene", run_scene, w}, {"embree", run_embree, w}, {"robust", run_robust, w}};
    const pm__bench_config config = {.clock = pm__monotonic_clock(),
                                     .sample_seconds = fmin(0.01, 0.05 * seconds),
                                     .seconds = seconds,
                                     .baseline = EMBREE};
    pm__bench_report report;
    const pm_status status = pm__bench_run(&config, variants, VARIANTS, &report, error);
    if (status == PM_OK) {
        const double per_ray = (double)w->photons / (double)w->count;
        const pm__bench_result *const traced = &report.results[TRACED], *const scene = &report.results[SCENE];
        row->ns_per_ray_traced = traced->ns * per_ray;
        row->ns_per_ray_scene = scene->ns * per_ray;
        row->ns_per_ray_embree = report.results[EMBREE].ns * per_ray;
        row->ns_per_ray_robust = report.results[ROBUST].ns * per_ray;
        row->robust_ratio = report.results[ROBUST].ratio;
        row->robust_ratio_ci95 = report.results[ROBUST].ratio_ci95;
        row->ratio = traced->ratio;
        row->ratio_ci95 = traced->ratio_ci95;
        row->scene_ratio = scene->ratio;
        row->scene_ratio_ci95 = scene->ratio_ci95;
        row->aa_ratio = report.aa_ratio;
        row->aa_ci95 = report.aa_ci95;
        row->aa_alarm = report.aa_alarm;
        row->samples = traced->samples;
    }
    pm__bench_free(&report);
    return status;
}

pm_status pm__bench_tracing_scene(const char *name, const pm__scene *scene, size_t photons, double seconds,
                                  pm__tracing_row *row, pm_error *error)
{
    workload w = {.scene = scene, .photons = photons};
    *row = (pm__tracing_row){.scene = name, .photons = photons};
    pm_status status = pm__plain_scene_create(scene, false, &w.plain, error);
    if (status == PM_OK)
        status = pm__plain_scene_create(scene, true, &w.robust, error);
    if (status == PM_OK)
        status = record(&w, error);
    if (status == PM_OK) {
        row->rays = w.count;
        row->agreement = agreement_of(&w);
        status = compare(&w, seconds, row, error);
    }
    pm__plain_scene_destroy(&w.plain);
    pm__plain_scene_destroy(&w.robust);
    free(w.rays);
    free(w.first);
    free(w.kept);
    return status;
}

pm_status pm__bench_tracing(const pm__spec *spec, size_t photons, double seconds, pm__tracing_row *row,
                            pm_error *error)
{
    const pm__case *const subject = (const pm__case *)spec->entry; /* entries are the first members of cases */
    pm__scene *scene = NULL;
    if (!pm__is_traced(subject))
        return pm__fail(error, PM_EINVAL, "%s is not a scene that photons are traced in", spec->entry->name);
    pm_status status = pm__scene_create(&scene, error);
    if (status == PM_OK)
        status = subject->build(spec->values, scene, error);
    if (status == PM_OK)
        status = pm__scene_commit(scene, error);
    if (status == PM_OK)
        status = pm__bench_tracing_scene(spec->entry->name, scene, photons, seconds, row, error);
    pm__scene_destroy(scene);
    return status;
}
