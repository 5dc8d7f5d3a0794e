/* Time per query and cost of each variant, on one thread, as one user of that variant alone would pay. */
#include "bench.h"

#include "../base/clock.h"
#include "../base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { BATCHES = 13, MINIMUM_QUERIES = 8 };
static const double batch_seconds = 150e-6; /* thousands of ticks of the clock */

typedef struct stopwatch {
    pm__bench_lookup lookup;
    const pm__job *job;
    const pm__variant *variant;
    size_t next;    /* probe of region `all` that comes next */
    bool at_photon; /* time the estimate at carriers, not the lookup of one */
    double checksum;
} stopwatch;

static pm_status estimate_sets(stopwatch *w, const pm_query *query, size_t set_count)
{
    double value = 0.0;
    const pm_status status = pm__evaluate_variant(&w->lookup, w->variant, 0, query->normal,
                                                  w->lookup.workspace->sets, set_count, &value);
    w->checksum += value;
    return status == PM_EDEGENERATE ? PM_OK : status;
}

/* One map, searched and gathered as far as this variant needs and no further. */
static pm_status plain_query(stopwatch *w, const pm_query *query)
{
    const unsigned needs = w->variant->estimator->needs;
    const pm_map *const map = w->lookup.maps->map;
    const pm__gathering gathering = {pm__source_of(&w->lookup), pm_map_unit(map), needs & PM__SORTED,
                                     needs & PM__OFFSETS};
    pm_status status = pm__gather(map, query, &gathering, w->lookup.workspace, 0);
    if (status != PM_OK)
        return status;
    pm__point_sets(w->lookup.workspace, 1, gathering.offsets);
    const pm__lookup view = {.sets = w->lookup.workspace->sets,
                             .set_count = 1,
                             .dimensions = w->job->subject->dimensions,
                             .normal = {query->normal[0], query->normal[1], query->normal[2]},
                             .unit = gathering.unit};
    double bands[3];
    status = pm__evaluate(w->variant->spec, &view, w->lookup.workspace, bands);
    w->checksum += bands[0];
    return status == PM_EDEGENERATE ? PM_OK : status;
}

static pm_status carrier_query(stopwatch *w, const pm_query *query, size_t number)
{
    const pm__carriers *const carriers = &w->lookup.maps->carriers[w->variant->variety];
    size_t nearest = number % (carriers->count ? carriers->count : 1);
    if (!w->at_photon || !carriers->count) {
        const pm_status status = pm__nearest_carrier(carriers, query, w->lookup.workspace, &nearest);
        w->checksum += (double)nearest;
        return status;
    }
    const pm_query at = pm__carrier_query(carriers, w->lookup.maps->map, query, nearest);
    return plain_query(w, &at);
}

static pm_status one_query(stopwatch *w)
{
    const pm__job *const job = w->job;
    const size_t probe = w->next++ % job->config->probes_all;
    const pm_query query = pm__probe_query(&w->lookup, probe, w->variant->k, w->variant->radius);
    const unsigned needs = w->variant->estimator->needs;
    if (needs & PM__AT_PHOTON)
        return carrier_query(w, &query, w->next * 7919);
    if (!(needs & PM__MAPS))
        return plain_query(w, &query);
    const pm_status status = pm__gather_dealt(&w->lookup, w->variant->variety, &query);
    return status == PM_OK ? estimate_sets(w, &query, job->deals[w->variant->variety].maps) : status;
}

static pm_status run_batch(stopwatch *w, size_t queries, double *seconds)
{
    const double start = pm__seconds();
    for (size_t i = 0; i < queries; i++) {
        const pm_status status = one_query(w);
        if (status != PM_OK)
            return status;
    }
    *seconds = (pm__seconds() - start) / (double)queries;
    return PM_OK;
}

/* Median over batches; the first run only warms up and sizes the batches. */
static pm_status time_queries(stopwatch *w, double *ns, pm__interval *ci95)
{
    double seconds[BATCHES] = {0.0};
    pm_status status = run_batch(w, 2 * MINIMUM_QUERIES, &seconds[0]);
    size_t queries = (size_t)fmin(batch_seconds / fmax(seconds[0], 1e-9), 1e4);
    queries = queries < MINIMUM_QUERIES ? MINIMUM_QUERIES : queries;
    for (int i = 0; i < BATCHES && status == PM_OK; i++)
        status = run_batch(w, queries, &seconds[i]);
    for (int i = 0; i < BATCHES; i++)
        seconds[i] *= 1e9;
    *ns = pm__median_interval(seconds, BATCHES, ci95);
    return status;
}

/* What comes before the first query. */
typedef struct setup_times {
    double draw, build, carriers[PM__MAX_VARIETIES];
    double deal[PM__MAX_VARIETIES]; /* and build; of separate maps: draw and build */
} setup_times;

static pm_status time_deal(const pm__job *job, const pm__deal_kind *deal, const pm__photon_set *set, double *seconds)
{
    pm_map *maps[PM__MAX_MAPS] = {NULL};
    const double start = pm__seconds();
    const pm_status status = pm__deal_maps(job, deal, 0, set, maps);
    *seconds = pm__seconds() - start;
    for (size_t m = 0; m < deal->maps; m++)
        pm_map_destroy(maps[m]);
    return status;
}

static pm_status time_setup(const pm__job *job, setup_times *times)
{
    memset(times, 0, sizeof *times);
    pm__photon_set set;
    double start = pm__seconds();
    pm_status status = pm__draw_photons(job, 0, 0, 1, job->asked_photons, false, &set);
    times->draw = pm__seconds() - start;
    start = pm__seconds();
    pm_map *map = NULL;
    const pm_map_options options = {.search = pm_search_find(job->config->search)};
    if (status == PM_OK)
        status = pm_map_create(set.photons, set.count, &options, &map, NULL);
    times->build = pm__seconds() - start;
    for (size_t f = 0; f < job->fraction_count && status == PM_OK; f++) {
        pm__carriers carriers;
        start = pm__seconds();
        status = pm__carriers_create(&carriers, map, job->fractions[f], NULL, NULL);
        times->carriers[f] = pm__seconds() - start;
        if (status == PM_OK)
            pm__carriers_destroy(&carriers);
    }
    pm_map_destroy(map);
    for (size_t d = 0; d < job->deal_count && status == PM_OK; d++)
        status = time_deal(job, &job->deals[d], &set, &times->deal[d]);
    pm__photon_set_free(&set);
    return status;
}

/* How many different carriers the probes of `all` ask for: what the demand form computes. */
static pm_status count_asked(stopwatch *w, size_t *asked)
{
    const pm__job *const job = w->job;
    const pm__carriers *const carriers = &w->lookup.maps->carriers[w->variant->variety];
    unsigned char *const seen = pm__alloc_zero(carriers->count, 1);
    pm_status status = seen ? PM_OK : PM_ENOMEM;
    *asked = 0;
    for (size_t q = 0; q < job->config->probes_all && status == PM_OK; q++) {
        const pm_query query = pm__probe_query(&w->lookup, q, w->variant->k, w->variant->radius);
        size_t nearest;
        status = pm__nearest_carrier(carriers, &query, w->lookup.workspace, &nearest);
        if (status == PM_OK && nearest != SIZE_MAX && !seen[nearest]) {
            seen[nearest] = 1;
            ++*asked;
        }
    }
    free(seen);
    return status;
}

/* 5.4: estimates at photons are paid for before (eager) or by the queries that ask for them (demand). */
static pm_status add_stored_estimates(stopwatch *w, pm__timing *timing, double *before)
{
    const bool demand = pm__spec_value(w->variant->spec, "when", 0.0) != 0.0;
    size_t paid = w->lookup.maps->carriers[w->variant->variety].count;
    double ns = 0.0;
    pm__interval ci95;
    w->at_photon = true;
    pm_status status = time_queries(w, &ns, &ci95);
    w->at_photon = false;
    if (status == PM_OK && demand)
        status = count_asked(w, &paid);
    const double share = (double)paid / (double)w->job->config->probes_all;
    if (demand) {
        timing->ns_per_query += share * ns;
        timing->ns_per_query_ci95.low += share * ci95.low;
        timing->ns_per_query_ci95.high += share * ci95.high;
    } else {
        *before += 1e-9 * ns * (double)paid;
    }
    return status;
}

static pm_status time_variant(stopwatch *w, const setup_times *setup, pm__timing *timing)
{
    const unsigned needs = w->variant->estimator->needs;
    double before = setup->draw + setup->build;
    pm_status status = time_queries(w, &timing->ns_per_query, &timing->ns_per_query_ci95);
    if (needs & PM__MAPS) {
        const bool separate = pm__is_separate(&w->job->deals[w->variant->variety]);
        before = (separate ? 0.0 : setup->draw) + setup->deal[w->variant->variety];
    }
    if (status == PM_OK && (needs & PM__AT_PHOTON)) {
        before += setup->carriers[w->variant->variety];
        status = add_stored_estimates(w, timing, &before);
    }
    timing->cost_s = before + 1e-9 * timing->ns_per_query * (double)w->job->config->probes_all;
    return status;
}

pm_status pm__time_variants(const pm__job *job, pm__timing *timings)
{
    pm__trial_maps maps;
    setup_times setup;
    pm_status status = pm__trial_maps_create(job, 0, &maps);
    if (status != PM_OK)
        return status;
    stopwatch w = {.lookup = {.job = job,
                              .maps = &maps,
                              .search = pm_search_find(job->config->search),
                              .guess = INFINITY}, /* a query on its own has nothing to guess from */
                   .job = job};
    status = pm_workspace_create(job->max_k, &w.lookup.workspace);
    if (status == PM_OK)
        status = time_setup(job, &setup);
    for (size_t v = 0; v < job->variant_count; v++) {
        const pm__interval none = {NAN, NAN};
        timings[v] = (pm__timing){NAN, none, NAN};
        w.variant = &job->variants[v];
        if (status == PM_OK && pm__is_canceled(job->config))
            status = PM_ECANCELED;
        if (status == PM_OK && !w.variant->unsupported && !(w.variant->estimator->needs & PM__TRUTH))
            status = time_variant(&w, &setup, &timings[v]);
    }
    pm_workspace_destroy(w.lookup.workspace);
    pm__trial_maps_destroy(&maps);
    return status;
}
