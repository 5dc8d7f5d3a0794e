/* One run: all contenders of a group, each with all filters and batches that it knows, on one kind of query. */
#include "search_inside.h"
#include "exactness.h"

#include "../src/base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One filter's queries and what is right for them. */
typedef struct asked {
    pm_query *queries;
    pm__reference reference;
} asked;

typedef struct run {
    const pm__search_group *group;
    size_t k, capacity;
    double radius; /* m */
    bool coherent;
    asked *asked;  /* [filter_count] */
    pm__asker *askers;
    pm__bench_variant *variants;
    pm__search_row *rows; /* one a variant */
    size_t count, baseline;
} run;

/* Some map that can be asked anything at good speed; *temporary is to be destroyed. */
static pm_status find_scout(const pm__search_group *group, const pm_map **scout, pm_map **temporary, pm_error *error)
{
    *scout = *temporary = NULL;
    for (size_t i = 0; i < group->built_count && !*scout; i++) {
        const pm_search *const search = group->built[i].index.contender.search;
        if (search && !search->radius_only && strcmp(search->entry.name, "brute") != 0)
            *scout = group->built[i].index.map;
    }
    if (*scout)
        return PM_OK;
    const pm_status status = pm_map_create(group->photons.photons, group->photons.count, NULL, temporary, error);
    *scout = *temporary;
    return status;
}

static pm_query base_query(const pm_surface_point *at, const pm__shape *filter, size_t k, double radius)
{
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, at->position, sizeof query.position);
    memcpy(query.normal, at->normal, sizeof query.normal);
    query.k = k;
    query.max_radius = k ? INFINITY : (float)radius;
    query.shape = filter->shape;
    query.shape_parameter = (float)filter->parameter;
    query.front_only = filter->front_only;
    query.sorted = false;
    return query;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median over a sample of queries of the distance to the n-th photon. */
static pm_status radius_for(const pm_map *scout, const pm_surface_point *queries, size_t count, size_t n,
                            double *radius)
{
    static const pm__shape plain = {PM_LOOKUP_SPHERE, 0.0, false};
    double distances[PM__CHECKED_QUERIES];
    pm_neighbor *const neighbors = pm__alloc(n, sizeof *neighbors);
    pm_status status = neighbors ? PM_OK : PM_ENOMEM;
    for (size_t q = 0; q < PM__CHECKED_QUERIES && status == PM_OK; q++) {
        pm_query query = base_query(&queries[q * count / PM__CHECKED_QUERIES], &plain, n, 0.0);
        size_t found = 0;
        query.sorted = true;
        status = pm_map_search(scout, &query, neighbors, n, &found);
        distances[q] = found ? sqrt((double)neighbors[found - 1].distance2) * pm_map_unit(scout) : 1.0;
    }
    free(neighbors);
    if (status == PM_OK) {
        qsort(distances, PM__CHECKED_QUERIES, sizeof *distances, compare_doubles);
        *radius = distances[PM__CHECKED_QUERIES / 2];
    }
    return status;
}

/* The most that any query finds. */
static pm_status most_found(const pm_map *scout, const pm_query *queries, size_t count, size_t *most)
{
    for (size_t q = 0; q < count; q++) {
        pm_neighbor none[1];
        size_t found = 0;
        const pm_status status = pm_map_search(scout, &queries[q], none, 1, &found);
        if (status != PM_OK && status != PM_ETRUNCATED)
            return status;
        *most = found > *most ? found : *most;
    }
    return PM_OK;
}

static pm_status fill_queries(run *r, const pm_map *scout)
{
    const pm__search_config *const config = r->group->config;
    const pm_surface_point *const points = r->group->queries[r->coherent];
    const size_t count = r->group->query_count, photons = r->group->photons.count;
    r->radius = config->radius;
    pm_status status = PM_OK;
    if (!r->k && config->radius_hits)
        status = radius_for(scout, points, count, config->radius_hits, &r->radius);
    r->capacity = r->k < photons ? r->k : photons;
    for (size_t f = 0; f < config->filter_count && status == PM_OK; f++) {
        asked *const a = &r->asked[f];
        a->queries = pm__alloc(count, sizeof *a->queries);
        if (!a->queries)
            return PM_ENOMEM;
        for (size_t q = 0; q < count; q++)
            a->queries[q] = base_query(&points[q], &config->filters[f], r->k, r->radius);
        if (!r->k)
            status = most_found(scout, a->queries, count, &r->capacity);
    }
    r->capacity += r->capacity / 8 + 16; /* peers may round in a few at the radius */
    return status;
}

static pm_status make_references(run *r, const pm_map *scout)
{
    const pm__search_config *const config = r->group->config;
    pm_status status = PM_OK;
    for (size_t f = 0; f < config->filter_count && status == PM_OK; f++)
        status = pm__reference_create(scout, r->group->photons.photons, r->group->photons.count, r->asked[f].queries,
                                      r->group->query_count, r->capacity, config->parallel, &r->asked[f].reference);
    return status;
}

static pm__search_row row_of(const run *r, const pm__built *built, size_t filter, size_t batch)
{
    const pm__search_group *const group = r->group;
    const size_t photons = group->photons.count;
    return (pm__search_row){
        .contender = built->index.contender,
        .case_name = group->case_name,
        .photons = photons,
        .k = r->k,
        .radius = r->k ? (double)NAN : r->radius,
        .filter = group->config->filters[filter],
        .batch = batch,
        .coherent = r->coherent,
        .threads = group->photons.threads,
        .build_ms = built->ms,
        .build_ms_ci95 = built->ms_ci95,
        .ns = NAN, .ns_min = NAN, .ns_ci95 = {NAN, NAN},
        .ratio = NAN, .ratio_ci95 = {NAN, NAN},
        .cycles = NAN, .instructions = NAN, .aa_ratio = NAN, .aa_ci95 = {NAN, NAN}, .aa_false_alarm_rate = NAN,
        .noise = NAN,
        .bytes_per_photon = photons ? (double)pm__bench_index_bytes(&built->index) / (double)photons : (double)NAN,
        .count = pm__reference_mean_count(&r->asked[filter].reference),
        .status = "ok",
    };
}

static pm_status add_variant(run *r, const pm__built *built, size_t filter, size_t batch)
{
    const asked *const a = &r->asked[filter];
    pm__asker *const asker = &r->askers[r->count];
    pm__search_row *const row = &r->rows[r->count];
    *row = row_of(r, built, filter, batch);
    pm_status status = pm__exactness_check(&a->reference, &built->index, batch, &row->exact, row->detail);
    if (!row->exact)
        row->status = "inexact";
    if (status == PM_OK)
        status = pm__asker_init(asker, &built->index, a->queries, r->group->query_count, batch, r->capacity);
    r->variants[r->count] = (pm__bench_variant){pm__contender_name(&built->index.contender), pm__asker_run, asker};
    r->count++;
    return status;
}

/* The group's baseline, one a call, with the first filter, is the baseline of the run. */
static pm_status add_variants(run *r)
{
    const pm__search_group *const group = r->group;
    pm_status status = PM_OK;
    for (size_t i = 0; i < group->built_count; i++)
        for (size_t f = 0; f < group->config->filter_count && status == PM_OK; f++) {
            const pm__built *const built = &group->built[i];
            const pm_search *const search = built->index.contender.search;
            if (*built->problem || !pm__contender_can(&built->index.contender, &r->asked[f].queries[0]))
                continue;
            if (i == group->baseline && !f)
                r->baseline = r->count;
            status = add_variant(r, built, f, 1);
            if (status == PM_OK && search && search->find_batch)
                status = add_variant(r, built, f, search->batch);
        }
    return status;
}

static double share_of_time(const pm__search_group *group, const pm__search_progress *progress)
{
    const double left = group->config->seconds - (pm__search_clock() - progress->start);
    return fmax(left, 0.0) * (double)group->weight / (double)(progress->weight - progress->weight_done);
}

static void take_result(const run *r, size_t i, pm__bench_report *report)
{
    pm__search_row *const row = &r->rows[i];
    pm__bench_result *const result = &report->results[i];
    row->ns = result->ns;
    row->ns_ci95 = result->ns_ci95;
    row->ns_min = result->ns_min;
    row->samples = result->samples;
    row->outliers = result->outliers;
    row->ratio = result->ratio;
    row->ratio_ci95 = result->ratio_ci95;
    row->ratio_samples = result->ratio_samples;
    result->ratio_samples = NULL; /* the row's now */
    row->cycles = result->cycles;
    row->instructions = result->instructions;
    row->aa_ratio = report->aa_ratio;
    row->aa_ci95 = report->aa_ci95;
    row->aa_false_alarm_rate = report->false_alarm_rate;
    row->noise = report->noise;
    row->warning = report->warning;
    row->baseline = pm__contender_name(&r->rows[r->baseline].contender);
    if (r->askers[i].status != PM_OK) {
        row->status = "failed";
        row->exact = false;
        (void)snprintf(row->detail, sizeof row->detail, "%s", pm_status_text(r->askers[i].status));
    }
}

static pm_status time_all(run *r, const pm__search_progress *progress, pm_error *error)
{
    const pm__search_config *const config = r->group->config;
    const pm__bench_config bench = {.clock = pm__monotonic_clock(),
                                    .seconds = share_of_time(r->group, progress),
                                    .min_rounds = config->samples,
                                    .max_rounds = config->samples,
                                    .baseline = r->baseline,
                                    .seed = config->seed,
                                    .counters = true,
                                    .canceled = config->canceled,
                                    .context = config->context};
    pm__bench_report report;
    const pm_status status = pm__bench_run(&bench, r->variants, r->count, &report, error);
    if (status == PM_OK)
        for (size_t i = 0; i < r->count; i++)
            take_result(r, i, &report);
    if (status == PM_OK || status == PM_ECANCELED)
        pm__bench_free(&report);
    return status;
}

static bool is_baseline(const run *r, size_t i)
{
    const pm__contender *const baseline = &r->group->built[r->group->baseline].index.contender;
    return r->rows[i].contender.search == baseline->search && r->rows[i].contender.peer == baseline->peer;
}

static pm_status keep_rows(const run *r, pm__search_progress *progress)
{
    void *rows = progress->rows;
    if (pm__grow(&rows, &progress->capacity, progress->count + r->count, sizeof *progress->rows)) {
        for (size_t i = 0; i < r->count; i++)
            free(r->rows[i].ratio_samples);
        return PM_ENOMEM;
    }
    progress->rows = rows;
    for (size_t i = 0; i < r->count; i++) {
        if (r->group->hide_baseline && is_baseline(r, i)) {
            free(r->rows[i].ratio_samples);
            continue;
        }
        progress->rows[progress->count] = r->rows[i];
        progress->rows[progress->count++].run = progress->runs_done;
    }
    return PM_OK;
}

static pm_status allocate(run *r)
{
    const size_t filters = r->group->config->filter_count, variants = 2 * filters * r->group->built_count;
    r->asked = pm__alloc_zero(filters, sizeof *r->asked);
    r->askers = pm__alloc_zero(variants, sizeof *r->askers);
    r->variants = pm__alloc_zero(variants, sizeof *r->variants);
    r->rows = pm__alloc_zero(variants, sizeof *r->rows);
    return r->asked && r->askers && r->variants && r->rows ? PM_OK : PM_ENOMEM;
}

static void release(run *r)
{
    for (size_t f = 0; r->asked && f < r->group->config->filter_count; f++) {
        free(r->asked[f].queries);
        pm__reference_destroy(&r->asked[f].reference);
    }
    for (size_t i = 0; r->askers && i < r->count; i++)
        pm__asker_free(&r->askers[i]);
    free(r->asked);
    free(r->askers);
    free(r->variants);
    free(r->rows);
}

pm_status pm__search_compare(const pm__search_group *group, size_t k, bool coherent, pm__search_progress *progress,
                             pm_error *error)
{
    run r = {.group = group, .k = k, .coherent = coherent};
    const pm_map *scout = NULL;
    pm_map *temporary = NULL;
    pm_status status = allocate(&r);
    if (status == PM_OK)
        status = find_scout(group, &scout, &temporary, error);
    if (status == PM_OK)
        status = fill_queries(&r, scout);
    if (status == PM_OK)
        status = make_references(&r, scout);
    pm_map_destroy(temporary);
    if (status == PM_OK)
        status = add_variants(&r);
    if (status == PM_OK && r.count)
        status = time_all(&r, progress, error);
    if (status == PM_OK)
        status = keep_rows(&r, progress);
    release(&r);
    return status;
}
