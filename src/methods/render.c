#include "render.h"

#include "../base/clock.h"
#include "../base/memory.h"
#include "../base/parallel.h"
#include "../lookup/lookup.h"
#include "job.h"
#include "stage.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* ---- Setting up -------------------------------------------------------------------------------- */

static const pm__method *method_of(const pm__render_job *job)
{
    return (const pm__method *)(const void *)job->config->method->entry;
}

static pm_status check_estimator(const pm__render_config *config, const pm_estimator *estimator, pm_error *error)
{
    const pm__estimator *const kind = pm__estimator_of(&estimator->spec);
    const char *const name = kind->entry.name;
    const size_t maps = pm__map_count_of(&estimator->spec);
    if (kind->needs & PM__TRUTH)
        return pm__fail(error, PM_EINVAL, "%s knows the truth: it is for `accuracy` alone", name);
    if (!(kind->dimensions & 1U << 2))
        return pm__fail(error, PM_EINVAL, "%s does not work on surfaces", name);
    if (config->k && config->k / maps < kind->min_k)
        return pm__fail(error, PM_EINVAL, "--k %zu is too few for %s: at least %zu", config->k, name,
                        kind->min_k * maps);
    return PM_OK;
}

static pm_status check_config(const pm__render_job *job, pm_error *error)
{
    const pm__render_config *const config = job->config;
    pm_status status = PM_OK;
    if (config->estimator_count > PM__MOST_IMAGES)
        return pm__fail(error, PM_EINVAL, "%zu estimators: at most %d in one render", config->estimator_count,
                        PM__MOST_IMAGES);
    if (!config->trials || (!config->spp && !(config->seconds > 0.0)))
        return pm__fail(error, PM_EINVAL, "no trials, or neither samples nor seconds");
    if (!config->k && isinf(config->radius))
        return pm__fail(error, PM_EINVAL, "neither k nor a radius bounds an estimate");
    for (size_t i = 0; i < job->images && method_of(job)->estimates && status == PM_OK; i++)
        status = check_estimator(config, config->estimators[i], error);
    if (status == PM_OK && method_of(job)->check)
        status = method_of(job)->check(job, error);
    return status;
}

/* The stored image of the scene, where it is of just this scene and view, and of all its light. */
static pm_status find_reference(pm__render_job *job, pm_error *error)
{
    const pm__entry *const entry = &job->subject->entry;
    const char *const name = entry->name + strlen("scene:");
    pm__spec plain;
    pm__spec_default(entry, &plain);
    if (job->config->view || (method_of(job)->shows_all && !method_of(job)->shows_all(job)) ||
        !pm__reference_exists(name) || memcmp(plain.values, job->values, entry->param_count * sizeof *plain.values))
        return PM_OK;
    const pm_status status = pm__reference_load(name, &job->reference, error);
    if (status != PM_OK)
        return status;
    job->misfit = pm__reference_fits(&job->reference.radiance, job->config->width, job->config->height, NULL) != PM_OK;
    if (job->misfit)
        pm__reference_free(&job->reference);
    return PM_OK;
}

static pm_status set_stage(pm__render_job *job, pm_error *error)
{
    const pm__render_config *const config = job->config;
    pm__stage stage;
    const pm_status status =
        pm__stage_open(config->scene, config->view, config->width, config->height, &stage, error);
    job->scene = stage.scene;
    job->camera = stage.camera;
    return status;
}

void pm__job_close(pm__render_job *job)
{
    pm__reference_free(&job->reference);
    pm__projection_destroy(job->needs.aim);
    pm__scene_destroy(job->scene);
    job->needs.aim = NULL;
    job->scene = NULL;
}

pm_status pm__job_open(pm__render_job *job, const pm__render_config *config, pm__plan *plan, pm_error *error)
{
    *job = (pm__render_job){.config = config,
                            .subject = (const pm__case *)(const void *)config->scene->entry,
                            .values = config->scene->values};
    const pm__method *const method = method_of(job);
    job->images = method->estimates ? config->estimator_count : 1;
    pm_status status = check_config(job, error);
    if (status == PM_OK)
        status = set_stage(job, error);
    job->truth = config->aov && method->has_exact && method->has_exact(job);
    if (status == PM_OK && config->aov && !job->truth)
        status = find_reference(job, error);
    if (status == PM_OK) {
        *plan = (pm__plan){.count = 0};
        method->plan(job, plan, &job->needs);
    } else {
        pm__job_close(job);
    }
    return status;
}

pm_status pm__render_plan(const pm__render_config *config, pm__plan *plan, pm_error *error)
{
    pm__render_job job;
    const pm_status status = pm__job_open(&job, config, plan, error);
    if (status == PM_OK)
        pm__job_close(&job);
    return status;
}

/* ---- Samples ----------------------------------------------------------------------------------- */

void pm__tile_eye(const pm__render_job *job, const pm__tile *tile, size_t index, uint32_t trial, pm__eye *eye)
{
    const size_t across = tile->x1 - tile->x0, x = tile->x0 + index % across, y = tile->y0 + index / across;
    const uint64_t pixel = (uint64_t)y * job->config->width + x, seed = job->config->seed;
    const pm__eye_numbers numbers = pm__eye_numbers_of(seed, trial, tile->pass, pixel);
    double at[2];
    pm__place_in_pixel(seed, pixel, tile->pass, at);
    pm__eye_through(eye, job->scene, &job->camera, &numbers, (double)x + at[0], (double)y + at[1]);
}

typedef struct pass_work {
    const pm__render_job *job;
    const void *state;
    pm__film *film;
    uint32_t pass, trial;
    _Atomic int failure;
    atomic_bool cut;
} pass_work;

static bool is_canceled(const pm__render_config *config)
{
    return config->canceled && config->canceled(config->context);
}

static void run_tile(void *argument, size_t index)
{
    pass_work *const work = argument;
    const pm__render_job *const job = work->job;
    if (atomic_load(&work->failure))
        return;
    if (is_canceled(job->config)) {
        atomic_store(&work->cut, true);
        return;
    }
    const pm__tile tile = pm__film_tile(work->film, index, work->pass, work->trial);
    const size_t count = pm__tile_pixels(&tile);
    double truth[PM__TILE_PIXELS][3];
    pm__sample *const samples = pm__alloc_zero(count * job->images, sizeof *samples);
    pm_status status = samples ? PM_OK : PM_ENOMEM;
    if (status == PM_OK)
        status = method_of(job)->sample(job, work->state, &tile, samples, job->truth && !work->trial ? truth : NULL);
    if (status == PM_OK)
        pm__film_add(work->film, index, samples, (const double(*)[3])truth);
    else
        atomic_store(&work->failure, (int)status);
    free(samples);
}

pm_status pm__job_pass(const pm__render_job *job, const void *state, size_t pass, size_t trial, pm__film *film,
                       bool *cut)
{
    pass_work work = {.job = job, .state = state, .film = film, .pass = (uint32_t)pass, .trial = (uint32_t)trial};
    pm__for(job->config->parallel, film->tiles, run_tile, &work);
    *cut = atomic_load(&work.cut);
    return (pm_status)atomic_load(&work.failure);
}

/* ---- Trials ------------------------------------------------------------------------------------ */

/* When to stop, and how far it is. */
typedef struct schedule {
    const pm__render_config *config;
    double start;     /* s */
    size_t passes;    /* of the first trial, once that is done: later trials do the same */
    double last_pass; /* s */
} schedule;

static double deadline(const schedule *s, size_t trial)
{
    return s->start + s->config->seconds * (double)(trial + 1) / (double)s->config->trials;
}

static bool goes_on(const schedule *s, size_t trial, size_t pass)
{
    if (trial)
        return pass < s->passes;
    if (!pass)
        return true;
    if (s->config->spp && pass >= s->config->spp)
        return false;
    return !(s->config->seconds > 0.0) || pm__seconds() + 0.5 * s->last_pass < deadline(s, 0);
}

static void report(const schedule *s, size_t trial, size_t pass)
{
    const pm__render_config *const config = s->config;
    if (!config->progress)
        return;
    const size_t wanted = trial ? s->passes : config->spp;
    double part = wanted ? (double)pass / (double)wanted : 0.0;
    if (!trial && config->seconds > 0.0)
        part = fmax(part, (pm__seconds() - s->start) * (double)config->trials / config->seconds);
    config->progress(config->context, ((double)trial + fmin(part, 1.0)) / (double)config->trials,
                     pass ? "rendering" : "tracing photons");
}

static pm_status run_passes(const pm__render_job *job, const void *state, schedule *s, pm__film *film, size_t trial,
                            pm__render_result *result)
{
    size_t pass = 0;
    for (; goes_on(s, trial, pass) && !result->interrupted; pass++) {
        const double start = pm__seconds();
        const pm_status status = pm__job_pass(job, state, pass, trial, film, &result->interrupted);
        s->last_pass = pm__seconds() - start;
        if (status != PM_OK)
            return status;
        report(s, trial, pass + 1);
    }
    if (!trial)
        s->passes = result->passes = pass - result->interrupted;
    return PM_OK;
}

/* The first trial's image is the one that is shown: cut short, it is there as far as it came; a later trial counts
 * whole or not at all. */
static pm_status run_trial(pm__render_job *job, schedule *s, pm__film *film, size_t trial, pm__render_result *result,
                           pm_error *error)
{
    const pm__method *const method = method_of(job);
    void *state = NULL;
    pm_status status = PM_OK;
    report(s, trial, 0);
    if (method->prepare)
        status = method->prepare(job, (uint32_t)trial, &state, error);
    const double start = pm__seconds();
    if (status == PM_ECANCELED)
        result->interrupted = true;
    else if (status == PM_OK)
        status = run_passes(job, state, s, film, trial, result);
    if (state)
        method->release(state);
    if (!trial) {
        result->image_s = pm__seconds() - start;
        result->trace_s = job->trace_s;
        result->build_s = job->build_s;
        result->emitted = job->emitted;
        result->stored = job->stored;
    }
    if (!trial || !result->interrupted) {
        pm__film_end_trial(film);
        result->trials++;
    }
    return status == PM_ECANCELED ? PM_OK : status;
}

static pm_status run_trials(pm__render_job *job, pm__film *film, pm__render_result *result, pm_error *error)
{
    schedule s = {.config = job->config, .start = pm__seconds()};
    pm_status status = PM_OK;
    for (size_t t = 0; t < job->config->trials && status == PM_OK && !result->interrupted; t++)
        status = run_trial(job, &s, film, t, result, error);
    result->total_s = pm__seconds() - s.start;
    return status;
}

/* ---- Results ----------------------------------------------------------------------------------- */

static pm_status develop(const pm__render_job *job, const pm__film *film, pm__render_result *result, pm_error *error)
{
    const pm__image *const reference = job->reference.radiance.values ? &job->reference.radiance : NULL;
    result->misfit = job->misfit;
    result->truth = film->truth ? "exact" : reference ? "reference" : NULL;
    return pm__film_develop(film, reference, job->config->aov, result, error);
}

pm_status pm__render(const pm__render_config *config, pm__render_result *result, pm_error *error)
{
    pm__render_job job;
    pm__plan plan;
    pm__film film;
    *result = (pm__render_result){.count = 0};
    pm_status status = pm__job_open(&job, config, &plan, error);
    if (status != PM_OK)
        return status;
    pm_error why = {""};
    status = pm__film_create(&job, method_of(&job)->prepare, &film, &why);
    if (status == PM_OK) {
        status = run_trials(&job, &film, result, &why);
        if (status == PM_OK)
            status = develop(&job, &film, result, &why);
        pm__film_destroy(&film);
    }
    pm__job_close(&job);
    return status ? pm__fail(error, status, "%s", *why.text ? why.text : pm_status_text(status)) : PM_OK;
}

void pm__render_free(pm__render_result *result)
{
    for (size_t i = 0; i < result->count; i++) {
        pm__render_images *const images = &result->images[i];
        pm__image *const all[] = {&images->radiance, &images->truth, &images->error, &images->bias,
                                  &images->noise, &images->radius, &images->count};
        for (size_t j = 0; j < sizeof all / sizeof *all; j++)
            pm__image_free(all[j]);
    }
    free(result->images);
    *result = (pm__render_result){.count = 0};
}
