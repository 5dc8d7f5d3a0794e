/* One trial: maps of its own, then every variant at every probe. */
#include "bench.h"

#include "../base/memory.h"

enum { BETWEEN_QUESTIONS = 256 }; /* probes between two looks at whether to stop */

/* Where an error goes. */
static float *cell(const pm__job *job, size_t variant, size_t trial, size_t probe)
{
    return &job->errors[(variant * job->config->trials + trial) * job->probe_count + probe];
}

typedef struct trial_run {
    pm__bench_lookup lookup;
    const pm__job *job;
    size_t trial, probe;
    pm_query query; /* of the probe, for the largest k */
} trial_run;

/* Evaluates the variants of one kind (and variety) on what the workspace holds. */
static pm_status evaluate_kind(const trial_run *run, unsigned kind, size_t variety, const float normal[3],
                               size_t set_count)
{
    const pm__job *const job = run->job;
    const unsigned kinds = PM__MAPS | PM__AT_PHOTON | PM__TRUTH;
    for (size_t v = 0; v < job->variant_count; v++) {
        const pm__variant *const variant = &job->variants[v];
        if (variant->unsupported || (variant->estimator->needs & kinds) != kind || variant->variety != variety)
            continue;
        double value;
        const pm_status status =
            pm__evaluate_variant(&run->lookup, variant, 0, normal, run->lookup.workspace->sets, set_count, &value);
        if (status == PM_EDEGENERATE)
            job->degenerate[run->trial * job->variant_count + v]++;
        else if (status != PM_OK)
            return status;
        *cell(job, v, run->trial, run->probe) = (float)(value - job->truth[run->probe]);
    }
    return PM_OK;
}

/* The disc with each candidate k; oracle.c chooses among them when all trials are there. */
static pm_status evaluate_candidates(const trial_run *run)
{
    const pm__job *const job = run->job;
    const size_t plane = job->config->trials * job->probe_count;
    for (size_t o = 0; o < job->oracle_count; o++)
        for (size_t c = 0; c < job->candidate_count; c++) {
            const pm__variant variant = {.spec = job->oracles[o],
                                         .estimator = pm__estimator_of(job->oracles[o]),
                                         .k = job->candidates[c],
                                         .radius = job->max_radius};
            double value;
            const pm_status status = pm__evaluate_variant(&run->lookup, &variant, 0, run->query.normal,
                                                          run->lookup.workspace->sets, 1, &value);
            if (status != PM_OK && status != PM_EDEGENERATE)
                return status;
            job->oracle_errors[(o * job->candidate_count + c) * plane + run->trial * job->probe_count + run->probe] =
                (float)(value - job->truth[run->probe]);
        }
    return PM_OK;
}

static pm_status evaluate_dealt(const trial_run *run)
{
    pm_status status = PM_OK;
    for (size_t d = 0; d < run->job->deal_count && status == PM_OK; d++) {
        status = pm__gather_dealt(&run->lookup, d, &run->query);
        if (status == PM_OK)
            status = evaluate_kind(run, PM__MAPS, d, run->query.normal, run->job->deals[d].maps);
    }
    return status;
}

static pm_status evaluate_at_carriers(const trial_run *run)
{
    pm_status status = PM_OK;
    for (size_t f = 0; f < run->job->fraction_count && status == PM_OK; f++) {
        const pm__carriers *const carriers = &run->lookup.maps->carriers[f];
        size_t nearest;
        status = pm__nearest_carrier(carriers, &run->query, run->lookup.workspace, &nearest);
        if (status != PM_OK)
            return status;
        pm_query query = run->query;
        if (nearest != SIZE_MAX) {
            query = pm__carrier_query(carriers, run->lookup.maps->map, &run->query, nearest);
            status = pm__gather_main(&run->lookup, &query);
        } else {
            run->lookup.workspace->sets[0].count = 0; /* no photon will do: black */
        }
        if (status == PM_OK)
            status = evaluate_kind(run, PM__AT_PHOTON, f, query.normal, 1);
    }
    return status;
}

/* For what is looked up next: a little more than the radius just found. */
static double guess_from(const pm__bench_lookup *lookup)
{
    const pm__neighbors *const set = &lookup->workspace->sets[0];
    return set->cut || !(set->radius2 > 0.0) ? INFINITY
                                             : 1.2 * sqrt(set->radius2) * pm_map_unit(lookup->maps->map);
}

static pm_status run_probe(trial_run *run)
{
    run->query = pm__probe_query(&run->lookup, run->probe, run->job->max_k, run->job->max_radius);
    pm_status status = pm__gather_main(&run->lookup, &run->query);
    if (status == PM_OK && run->job->max_k)
        run->lookup.guess = guess_from(&run->lookup);
    if (status == PM_OK)
        status = evaluate_kind(run, 0, 0, run->query.normal, 1);
    if (status == PM_OK)
        status = evaluate_candidates(run);
    if (status == PM_OK)
        status = evaluate_dealt(run);
    if (status == PM_OK)
        status = evaluate_at_carriers(run);
    return status;
}

void pm__run_trial(void *argument, size_t trial)
{
    pm__job *const job = argument;
    const pm__accuracy_config *const config = job->config;
    if (pm__is_canceled(config)) {
        job->trial_status[trial] = PM_ECANCELED;
        return;
    }
    pm__trial_maps maps;
    pm_status status = pm__trial_maps_create(job, (uint32_t)trial, &maps);
    if (status != PM_OK) {
        job->trial_status[trial] = status;
        return;
    }
    trial_run run = {.lookup = {.job = job, .maps = &maps, .search = pm_search_find(config->search), .guess = INFINITY},
                     .job = job,
                     .trial = trial};
    status = pm_workspace_create(job->max_k, &run.lookup.workspace);
    for (; run.probe < job->probe_count && status == PM_OK; run.probe++)
        status = run.probe % BETWEEN_QUESTIONS == 0 && pm__is_canceled(config) ? PM_ECANCELED : run_probe(&run);
    pm_workspace_destroy(run.lookup.workspace);
    pm__trial_maps_destroy(&maps);
    job->trial_status[trial] = status;
    if (job->trial_done)
        job->trial_done(job);
}
