/* How long the image of a photon map takes, beside its two parts alone: the rays, and the bare search. */
#include "speed.h"

#include "../estimators/estimator.h"
#include "../src/base/clock.h"
#include "../src/base/memory.h"
#include "../src/base/parallel.h"
#include "../src/methods/job.h"
#include "../src/methods/maps.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

/* Promised: at most 1.5 times the parts' time. */
static const double of_parts = 1.0 / 1.5;

/* Queries handed to a search at once: their answers stay in the nearest cache. */
enum { AT_ONCE = 32 };

typedef struct view {
    pm__render_job job;
    pm__film film;
    void *state;        /* pm__maps */
    pm_query *queries;  /* of all tiles, one behind the other */
    size_t *first;      /* [tiles + 1] */
    atomic_int failure; /* a pm_status */
    double rays_seconds, search_seconds; /* of all runs of the parts */
    size_t runs;
} view;

/* ---- The queries of the image ------------------------------------------------------------------ */

static size_t take_queries(const view *v, size_t index, pm_query *queries)
{
    const pm__tile tile = pm__film_tile(&v->film, index, 0, 0);
    size_t taken = 0;
    for (size_t p = 0; p < pm__tile_pixels(&tile); p++) {
        pm__eye eye;
        pm__tile_eye(&v->job, &tile, p, 0, &eye);
        if (pm__eye_follow(&eye))
            queries[taken++] = pm__maps_query(&v->job, eye.hit.position, eye.facing);
    }
    return taken;
}

static pm_status list_queries(view *v, pm_error *error)
{
    v->queries = pm__alloc(v->film.pixels, sizeof *v->queries);
    v->first = pm__alloc_zero(v->film.tiles + 1, sizeof *v->first);
    if (!v->queries || !v->first)
        return pm__fail(error, PM_ENOMEM, "out of memory for the queries of an image");
    for (size_t t = 0; t < v->film.tiles; t++)
        v->first[t + 1] = v->first[t] + take_queries(v, t, v->queries + v->first[t]);
    return PM_OK;
}

/* ---- Variants: a unit is the whole image ------------------------------------------------------- */

static void search_tile(void *argument, size_t index)
{
    view *const v = argument;
    const pm__maps *const maps = v->state;
    const size_t k = v->job.config->k, end = v->first[index + 1];
    size_t counts[AT_ONCE];
    pm_neighbor *const found = pm__alloc(AT_ONCE * k, sizeof *found);
    pm_status status = found ? PM_OK : PM_ENOMEM;
    for (size_t q = v->first[index]; q < end && status == PM_OK; q += AT_ONCE)
        status = pm_map_search_batch(maps->map, v->queries + q, end - q < AT_ONCE ? end - q : AT_ONCE, found, k,
                                     counts);
    if (status != PM_OK)
        atomic_store(&v->failure, (int)status);
    free(found);
}

static void make_image(view *v, const void *state)
{
    bool cut = false;
    const pm_status status = pm__job_pass(&v->job, state, 0, 0, &v->film, &cut);
    if (status != PM_OK)
        atomic_store(&v->failure, (int)status);
}

static void run_whole(void *context, size_t first, size_t repetitions)
{
    view *const v = context;
    (void)first;
    for (size_t i = 0; i < repetitions; i++)
        make_image(v, v->state);
}

static void run_parts(void *context, size_t first, size_t repetitions)
{
    view *const v = context;
    (void)first;
    for (size_t i = 0; i < repetitions; i++) {
        const double start = pm__seconds();
        make_image(v, NULL);
        const double between = pm__seconds();
        pm__for(v->job.config->parallel, v->film.tiles, search_tile, v);
        v->rays_seconds += between - start;
        v->search_seconds += pm__seconds() - between;
        v->runs++;
    }
}

/* ---- A run ------------------------------------------------------------------------------------- */

static pm_status compare(const pm__speed_config *config, view *v, double seconds, pm__speed_row *row, pm_error *error)
{
    enum { PARTS, WHOLE };
    const pm__bench_variant variants[] = {{"parts", run_parts, v}, {"whole", run_whole, v}};
    const pm__bench_config bench = {.seconds = seconds, .baseline = PARTS, .seed = config->seed,
                                    .canceled = config->canceled, .context = config->context};
    pm__bench_report report;
    pm_status status = pm__bench_run(&bench, variants, 2, &report, error);
    if (status == PM_OK)
        status = (pm_status)atomic_load(&v->failure);
    if (status == PM_OK) {
        const double parts = v->rays_seconds + v->search_seconds;
        pm__speed_take(&report, WHOLE, PARTS, 1e-9, row);
        (void)snprintf(row->detail, sizeof row->detail,
                       "%.2f times its parts (rays %.0f %%, search %.0f %% of them); %zu x %zu, k = %zu, %zu estimates",
                       1.0 / row->ratio, 100.0 * v->rays_seconds / parts, 100.0 * v->search_seconds / parts,
                       v->film.width, v->film.height, v->job.config->k, v->first[v->film.tiles]);
    }
    pm__bench_free(&report);
    return status;
}

static pm_status compare_job(const pm__speed_config *config, const pm__method *method, view *v, double seconds,
                             pm__speed_row *row, pm_error *error)
{
    pm_status status = pm__film_create(&v->job, false, &v->film, error);
    if (status != PM_OK)
        return status;
    status = method->prepare(&v->job, 0, &v->state, error);
    if (status == PM_OK) {
        status = list_queries(v, error);
        if (status == PM_OK)
            status = compare(config, v, seconds, row, error);
        method->release(v->state);
    }
    pm__film_destroy(&v->film);
    free(v->queries);
    free(v->first);
    return status;
}

pm_status pm__speed_visualize(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    pm__spec method;
    pm_estimator *disc = NULL;
    view v = {.runs = 0};
    pm__plan plan;
    row->photons = config->photons;
    row->threads = config->threads;
    row->baseline = "rays + search";
    row->promise = of_parts;
    pm_status status = pm__spec_parse(&pm__methods, row->method, &method, error);
    if (status == PM_OK)
        status = pm_estimator_create("disc", &disc, error);
    const pm_estimator *const estimators[] = {disc};
    const pm__render_config render = {.scene = &row->scene, .method = &method, .estimators = estimators,
                                      .estimator_count = 1, .k = config->k, .radius = (double)INFINITY,
                                      .lookup = {PM_LOOKUP_SPHERE, 0.0, true}, .photons = config->photons,
                                      .width = config->width, .height = config->height, .spp = 1, .trials = 1,
                                      .seed = config->seed, .parallel = config->parallel,
                                      .canceled = config->canceled, .context = config->context};
    if (status == PM_OK)
        status = pm__job_open(&v.job, &render, &plan, error);
    if (status == PM_OK) {
        status = compare_job(config, (const pm__method *)(const void *)method.entry, &v, seconds, row, error);
        pm__job_close(&v.job);
    }
    pm_estimator_destroy(disc);
    return status;
}
