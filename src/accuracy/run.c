/* The bench's main loop: every case with every sampler and number of photons. */
#include "bench.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TRIALS = 1 << 24 }; /* numbers above are streams of separately drawn maps */

typedef struct run_state {
    const pm__accuracy_config *config;
    size_t jobs, jobs_done;
    atomic_size_t trials_done; /* of the job in hand */
    atomic_flag reporting;
    const char *name;
} run_state;

static void report(run_state *state)
{
    const pm__accuracy_config *const c = state->config;
    if (!c->progress || atomic_flag_test_and_set_explicit(&state->reporting, memory_order_acquire))
        return; /* another thread is at it */
    const double share = (double)atomic_load(&state->trials_done) / (double)c->trials;
    c->progress(c->context, ((double)state->jobs_done + share) / (double)state->jobs, state->name);
    atomic_flag_clear_explicit(&state->reporting, memory_order_release);
}

static void trial_done(pm__job *job)
{
    run_state *const state = job->owner;
    atomic_fetch_add(&state->trials_done, 1);
    report(state);
}

static pm_status measure(pm__job *job, pm__accuracy_row **rows, size_t *row_count)
{
    pm__for(job->config->parallel, job->config->trials, pm__run_trial, job);
    for (size_t t = 0; t < job->config->trials; t++)
        if (job->trial_status[t] != PM_OK)
            return job->trial_status[t];
    pm_status status = pm__predict(job);
    if (status == PM_OK)
        status = pm__apply_oracles(job);
    pm__timing *const timings = job->config->timing ? pm__alloc(job->variant_count, sizeof *timings) : NULL;
    if (status == PM_OK && job->config->timing)
        status = timings ? pm__time_variants(job, timings) : PM_ENOMEM;
    if (status == PM_OK)
        status = pm__append_rows(job, timings, rows, row_count);
    free(timings);
    return status;
}

static pm_status run_job(run_state *state, const pm__spec *case_spec, const pm__spec *sampler_spec, size_t photons,
                         pm__accuracy_row **rows, size_t *row_count, pm_error *error)
{
    pm__job job;
    state->name = case_spec->entry->name;
    atomic_store(&state->trials_done, 0);
    report(state);
    pm_status status = pm__job_plan(&job, state->config, case_spec, sampler_spec, photons, error);
    if (status != PM_OK)
        return status;
    job.trial_done = trial_done;
    job.owner = state;
    status = measure(&job, rows, row_count);
    if (status != PM_OK)
        (void)pm__fail(error, status, "case %s: %s", state->name, pm_status_text(status));
    pm__job_free(&job);
    state->jobs_done++;
    return status;
}

/* Better in both; rows without a time or an error take no part. */
static bool beats(const pm__accuracy_row *a, const pm__accuracy_row *b)
{
    return a->cost_s < b->cost_s && a->rel_rmse < b->rel_rmse;
}

static bool same_race(const pm__accuracy_row *a, const pm__accuracy_row *b)
{
    return a->case_spec == b->case_spec && a->sampler_spec == b->sampler_spec && !strcmp(a->region, b->region);
}

static void mark_pareto(pm__accuracy_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        rows[i].pareto = !isnan(rows[i].cost_s) && !isnan(rows[i].rel_rmse);
        for (size_t j = 0; j < count && rows[i].pareto; j++)
            if (same_race(&rows[i], &rows[j]) && beats(&rows[j], &rows[i]))
                rows[i].pareto = false;
    }
}

static pm_status check_config(const pm__accuracy_config *c, pm_error *error)
{
    if (!c->case_count || !c->estimator_count || !c->sampler_count || !c->photon_count)
        return pm__fail(error, PM_EINVAL, "a case, an estimator, a sampler and a number of photons are needed");
    if (c->trials < 2 || c->trials >= MOST_TRIALS)
        return pm__fail(error, PM_EINVAL, "%zu trials: 2 to %d make intervals", c->trials, MOST_TRIALS - 1);
    if (!c->probes_all || !c->probes_region)
        return pm__fail(error, PM_EINVAL, "no probes");
    if (c->search && !pm_search_find(c->search))
        return pm__fail(error, PM_ENAME, "unknown search '%s'", c->search);
    if (c->search && c->k_count && pm_search_find(c->search)->radius_only)
        return pm__fail(error, PM_EINVAL, "--search %s finds all within a fixed radius: it needs --radius without --k",
                        c->search);
    for (size_t i = 0; i < c->k_count; i++)
        if (!c->ks[i])
            return pm__fail(error, PM_EINVAL, "k = 0: an estimate needs at least 1 photon");
    for (size_t i = 0; i < c->photon_count; i++)
        if (!c->photons[i] || c->photons[i] > PM_MAX_PHOTONS)
            return pm__fail(error, PM_EINVAL, "%zu photons: 1 to %zu make a map", c->photons[i], PM_MAX_PHOTONS);
    return PM_OK;
}

/* Every job, so that the last one's mistake does not cost the time of those before it. */
static pm_status check_jobs(const pm__accuracy_config *config, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t c = 0; c < config->case_count; c++)
        for (size_t s = 0; s < config->sampler_count; s++)
            for (size_t n = 0; n < config->photon_count && status == PM_OK; n++)
                status = pm__job_check(config, &config->cases[c], &config->samplers[s], config->photons[n], error);
    return status;
}

pm_status pm__accuracy_run(const pm__accuracy_config *config, pm__accuracy_row **rows, size_t *row_count,
                           pm_error *error)
{
    *rows = NULL;
    *row_count = 0;
    pm_status status = check_config(config, error);
    if (status == PM_OK)
        status = check_jobs(config, error);
    run_state state = {.config = config,
                       .jobs = config->case_count * config->sampler_count * config->photon_count,
                       .reporting = ATOMIC_FLAG_INIT};
    for (size_t c = 0; c < config->case_count && status == PM_OK; c++)
        for (size_t s = 0; s < config->sampler_count && status == PM_OK; s++)
            for (size_t n = 0; n < config->photon_count && status == PM_OK; n++)
                status = run_job(&state, &config->cases[c], &config->samplers[s], config->photons[n], rows, row_count,
                                 error);
    mark_pareto(*rows, *row_count);
    if (status == PM_OK && config->progress)
        config->progress(config->context, 1.0, "done");
    if (status != PM_OK && status != PM_ECANCELED) {
        free(*rows);
        *rows = NULL;
        *row_count = 0;
    }
    return status;
}
