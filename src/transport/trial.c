#include "trial.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

static void trace_range(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    (void)pm__trace(tracing, first, count, store, context);
}

static pm_status trace(pm__storage *s, const pm__strata *strata, size_t count, pm__trial *trial)
{
    const pm__storing_config *const config = s->config;
    pm__emission emission = s->emission;
    emission.strata = strata;
    const pm__trace_config tracing = {config->scene, s->paths, config->seed, s->trial, &emission};
    const pm__shoot_config shooting = {.scene = config->scene, .normals = true, .parallel = config->parallel,
                                       .canceled = config->canceled, .context = config->context};
    const pm__harvest_wish wish = {.tracer = trace_range, .tracing = &tracing, .power = emission.total,
                                   .first = PM__MOST_TRACED, .most = count * strata->tests, .wanted = SIZE_MAX,
                                   .numbers = true};
    const pm_status status = pm__harvest_paths(&shooting, &wish, &trial->photons, s->error);
    if (status == PM_OK) {
        s->tried += trial->photons.emitted;
        s->unit = trial->photons.unit;
    }
    return status;
}

/* Photons are in the order of their paths. */
static void sum_up(const pm__storage *s, const pm__strata *strata, const float *importance, pm__trial *trial)
{
    const pm__harvest *const h = &trial->photons;
    const double mean = pm__importance_mean(s->config->importance, s->config->kind);
    for (size_t begin = 0, end; begin < h->count; begin = end) {
        pm__trial_sum *const sum = &trial->sums[h->numbers[begin] / strata->tests];
        double path = 0.0;
        for (end = begin; end < h->count && h->numbers[end] == h->numbers[begin]; end++) {
            const double there = (double)importance[end];
            path += mean > 0.0 ? fmin(1.0, there / mean) : 0.0;
            sum->found += there;
            sum->is_important = sum->is_important || there >= s->threshold;
        }
        sum->square += path * path;
        sum->finders += path > 0.0;
    }
}

pm_status pm__trial_run(pm__storage *storage, const pm__strata *strata, size_t count, pm__trial *trial)
{
    const pm__storing_config *const config = storage->config;
    *trial = (pm__trial){.sums = pm__alloc_zero(strata->count, sizeof *trial->sums)};
    pm_status status = trial->sums ? trace(storage, strata, count, trial) : PM_ENOMEM;
    float *const importance = status == PM_OK ? pm__alloc(trial->photons.count, sizeof *importance) : NULL;
    if (importance) {
        pm__importance_of_photons(config->importance, config->kind, config->parallel, trial->photons.photons,
                                  (const float(*)[3])trial->photons.normals, trial->photons.count, importance);
        for (size_t i = 0; i < count; i++)
            trial->sums[i].count = (double)strata->tests;
        sum_up(storage, strata, importance, trial);
    } else {
        status = status == PM_OK ? PM_ENOMEM : status;
        pm__trial_free(trial);
    }
    free(importance);
    return status;
}

void pm__trial_free(pm__trial *trial)
{
    pm__harvest_free(&trial->photons);
    free(trial->sums);
    *trial = (pm__trial){.sums = NULL};
}
