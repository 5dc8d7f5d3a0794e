#include "search_inside.h"

#include "../src/base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_QUERIES = 131072, FEWEST_QUERIES = 4096, SLOW_BRUTE = 100000, NONE = -1 };

double pm__search_clock(void)
{
    const pm__clock clock = pm__monotonic_clock();
    return clock.now(clock.context);
}

static bool is_brute(const pm__contender *contender)
{
    return contender->search && strcmp(contender->search->entry.name, "brute") == 0;
}

static bool takes_part(const pm__search_config *config, const pm__contender *contender, size_t photons)
{
    if (contender->peer)
        return photons > 0; /* peers index no empty set */
    return !is_brute(contender) || photons <= config->brute_limit;
}

/* Bytes that may be taken. */
static double available_memory(const pm__search_config *config)
{
    return config->memory > 0.0 ? config->memory : (double)INFINITY;
}

/* All that take part, and which of them is the baseline: `recursive`, or the first. */
typedef struct team {
    pm__contender *members;
    size_t count, baseline;
    bool together; /* all fit in memory at once */
    long slow;     /* brute force among so many photons that its samples would take all the time; NONE: not so */
} team;

static pm_status make_team(const pm__search_config *config, size_t photons, team *t)
{
    *t = (team){.members = pm__alloc(config->contender_count, sizeof *t->members), .slow = NONE};
    if (!t->members)
        return PM_ENOMEM;
    for (size_t i = 0; i < config->contender_count; i++) {
        const pm__contender *const contender = &config->contenders[i];
        if (!takes_part(config, contender, photons))
            continue;
        if (strcmp(pm__contender_name(contender), "recursive") == 0)
            t->baseline = t->count;
        if (is_brute(contender) && photons > SLOW_BRUTE)
            t->slow = (long)t->count;
        t->members[t->count++] = *contender;
    }
    t->together = (double)photons * (double)t->count * PM__INDEX_BYTES < 0.5 * available_memory(config);
    return PM_OK;
}

/* One group of all, one of all but the slow one and a pair for that, or pairs only. */
static size_t team_groups(const team *t)
{
    if (t->count < 3)
        return 1;
    if (!t->together)
        return t->count - 1;
    return t->slow != NONE && (size_t)t->slow != t->baseline ? 2 : 1;
}

/* Whom group number g compares: fills in the contenders, sets the baseline's place. */
static void choose_members(const team *t, size_t g, pm__search_group *group)
{
    const size_t other = t->together ? (size_t)t->slow : g + (g >= t->baseline);
    group->built_count = 0;
    if (team_groups(t) == 1 || (t->together && g == 0)) {
        for (size_t i = 0; i < t->count; i++) {
            if (team_groups(t) > 1 && (long)i == t->slow)
                continue;
            if (i == t->baseline)
                group->baseline = group->built_count;
            group->built[group->built_count++].index.contender = t->members[i];
        }
        return;
    }
    group->baseline = 0;
    group->built[group->built_count++].index.contender = t->members[t->baseline];
    group->built[group->built_count++].index.contender = t->members[other];
}

/* How much of the time a group's runs get, relative to others. */
static size_t group_weight(const team *t, size_t g)
{
    return t->together && t->slow != NONE && g == 1 ? 1 : 10;
}

static size_t kinds_of_query(const pm__search_config *config)
{
    return config->k_count + (config->radius > 0.0 || config->radius_hits > 0);
}

static pm_status run_group(pm__search_group *group, pm__search_progress *progress, pm_error *error)
{
    const pm__search_config *const config = group->config;
    pm_status status = PM_OK;
    for (size_t order = 2; order-- > 0 && status == PM_OK;)
        for (size_t i = 0; i < kinds_of_query(config) && status == PM_OK; i++) {
            if (!group->queries[order])
                continue;
            if (config->progress)
                config->progress(config->context, (double)progress->weight_done / (double)progress->weight,
                                 group->case_name);
            status = pm__search_compare(group, i < config->k_count ? config->ks[i] : 0, order == 1, progress, error);
            progress->runs_done++;
            progress->weight_done += group->weight;
        }
    return status;
}

/* A contender that could not be built has a row that says so. */
static pm_status report_problems(const pm__search_group *group, pm__search_progress *progress)
{
    for (size_t i = 0; i < group->built_count; i++) {
        const pm__built *const built = &group->built[i];
        void *rows = progress->rows;
        if (!*built->problem || (group->hide_baseline && i == group->baseline))
            continue;
        if (pm__grow(&rows, &progress->capacity, progress->count + 1, sizeof *progress->rows))
            return PM_ENOMEM;
        progress->rows = rows;
        pm__search_row *const row = &progress->rows[progress->count++];
        *row = (pm__search_row){.run = SIZE_MAX, .contender = built->index.contender, .case_name = group->case_name,
                                .photons = group->photons.count, .filter = group->config->filters[0], .batch = 1,
                                .threads = group->photons.threads, .radius = NAN, .build_ms = NAN,
                                .build_ms_ci95 = {NAN, NAN}, .ns = NAN, .ns_min = NAN, .ns_ci95 = {NAN, NAN},
                                .ratio = NAN, .ratio_ci95 = {NAN, NAN}, .cycles = NAN, .instructions = NAN,
                                .aa_ratio = NAN, .aa_ci95 = {NAN, NAN}, .aa_false_alarm_rate = NAN, .noise = NAN,
                                .bytes_per_photon = NAN, .count = NAN, .status = "failed"};
        (void)snprintf(row->detail, sizeof row->detail, "%s", built->problem);
    }
    return PM_OK;
}

static pm_status build_and_run(pm__search_group *group, const team *t, size_t g, pm__search_progress *progress,
                               pm_error *error)
{
    group->built = pm__alloc_zero(t->count, sizeof *group->built);
    if (!group->built)
        return PM_ENOMEM;
    choose_members(t, g, group);
    group->weight = group_weight(t, g);
    group->hide_baseline = g > 0; /* it has its row from the first group */
    pm_status status = pm__search_build(group);
    if (status == PM_OK)
        status = report_problems(group, progress);
    if (status == PM_OK)
        status = run_group(group, progress, error);
    for (size_t i = 0; i < group->built_count; i++)
        pm__bench_index_destroy(&group->built[i].index);
    free(group->built);
    return status;
}

/* The photons and queries of a set; workload NULL: the config's given photons. */
typedef struct set {
    pm_photon *photons; /* NULL where given */
    float (*points)[3];
    pm_surface_point *queries[2];
} set;

static void release(set *s)
{
    free(s->photons);
    free(s->points);
    free(s->queries[0]);
    free(s->queries[1]);
}

static pm_status pack_points(set *s, pm__bench_photons *photons, const pm__search_config *config)
{
    bool wanted = false;
    for (size_t i = 0; i < config->contender_count; i++)
        wanted |= config->contenders[i].peer != NULL;
    if (!wanted)
        return PM_OK;
    s->points = pm__alloc(photons->count, sizeof *s->points);
    for (size_t i = 0; s->points && i < photons->count; i++)
        memcpy(s->points[i], photons->photons[i].position, sizeof *s->points);
    photons->points = (const float (*)[3])s->points;
    return s->points ? PM_OK : PM_ENOMEM;
}

static pm_status make_queries(set *s, const pm__workload *workload, pm__search_group *group)
{
    const pm__search_config *const config = group->config;
    const size_t photons = group->photons.count;
    group->query_count = photons < FEWEST_QUERIES ? FEWEST_QUERIES : photons > MOST_QUERIES ? MOST_QUERIES : photons;
    for (size_t order = 0; order < 2; order++) {
        if (!(order ? config->coherent : config->random))
            continue;
        s->queries[order] = pm__alloc(group->query_count, sizeof *s->queries[order]);
        if (!s->queries[order])
            return PM_ENOMEM;
        if (workload)
            pm__workload_queries(workload, config->seed, group->query_count, config->parallel, s->queries[order]);
        else
            pm__photon_queries(config->given, config->given_normals, photons, config->seed, group->query_count,
                               s->queries[order]);
        if (order && pm__morton_order(s->queries[order], group->query_count))
            return PM_ENOMEM;
        group->queries[order] = s->queries[order];
    }
    return PM_OK;
}

static pm_status make_set(set *s, const pm__workload *workload, pm__search_group *group)
{
    const pm__search_config *const config = group->config;
    group->photons.photons = config->given;
    if (workload) {
        s->photons = pm__alloc(group->photons.count, sizeof *s->photons);
        if (!s->photons)
            return PM_ENOMEM;
        pm__workload_photons(workload, config->seed, group->photons.count, config->parallel, s->photons);
        group->photons.photons = s->photons;
    }
    const pm_status status = pack_points(s, &group->photons, config);
    return status ? status : make_queries(s, workload, group);
}

static pm_status run_set(const pm__search_config *config, const pm__workload *workload, size_t photons,
                         pm__search_progress *progress, pm_error *error)
{
    set s = {NULL, NULL, {NULL, NULL}};
    team t;
    pm__search_group group = {.config = config,
                              .case_name = workload ? workload->entry.name : config->given_name,
                              .photons = {.count = photons, .threads = config->threads, .parallel = config->parallel}};
    pm_status status = make_team(config, photons, &t);
    if (status == PM_OK)
        status = make_set(&s, workload, &group);
    for (size_t g = 0; status == PM_OK && t.count && g < team_groups(&t); g++)
        status = build_and_run(&group, &t, g, progress, error);
    free(t.members);
    release(&s);
    return status;
}

/* A system that promises more memory than it has kills who takes it at its word: so ask first. At least two indices
 * are there at once, one of them the baseline's. */
static pm_status check_memory(const pm__search_config *config, size_t photons, const team *t, pm_error *error)
{
    const size_t point = sizeof(float[3]), drawn = config->given_name ? 0 : sizeof(pm_photon);
    const double a_photon = (double)(point + drawn + (t->count < 2 ? t->count : 2) * PM__INDEX_BYTES);
    const double needed = (double)photons * a_photon, memory = available_memory(config);
    if (needed <= memory)
        return PM_OK;
    return pm__fail(error, PM_ENOMEM, "%zu photons and two indices of them take %.3g GB of memory; %.3g GB are free",
                    photons, 1e-9 * needed, 1e-9 * memory);
}

/* Runs to come, for the time that each may take. ENOMEM where they would not fit. */
static pm_status count_runs(const pm__search_config *config, size_t photons, pm__search_progress *progress,
                            pm_error *error)
{
    team t;
    pm_status status = make_team(config, photons, &t);
    if (status != PM_OK)
        return pm__fail(error, status, "out of memory");
    status = check_memory(config, photons, &t, error);
    for (size_t g = 0; status == PM_OK && g < team_groups(&t); g++)
        progress->weight +=
            group_weight(&t, g) * kinds_of_query(config) * ((size_t)config->coherent + (size_t)config->random);
    free(t.members);
    return status;
}

static pm_status run_all(const pm__search_config *config, bool count_only, pm__search_progress *progress,
                         pm_error *error)
{
    pm_status status = PM_OK;
    if (config->given_name)
        return count_only ? count_runs(config, config->given_count, progress, error)
                          : run_set(config, NULL, config->given_count, progress, error);
    for (size_t c = 0; c < config->case_count; c++)
        for (size_t n = 0; n < config->photon_count && status == PM_OK; n++)
            status = count_only ? count_runs(config, config->photons[n], progress, error)
                                : run_set(config, (const pm__workload *)(const void *)config->cases[c].entry,
                                          config->photons[n], progress, error);
    return status;
}

pm_status pm__search_run(const pm__search_config *config, pm__search_row **rows, size_t *count, pm_error *error)
{
    pm__search_progress progress = {.start = pm__search_clock()};
    pm_status status = run_all(config, true, &progress, error);
    if (status == PM_OK) {
        status = run_all(config, false, &progress, error);
        if (status == PM_ENOMEM)
            (void)pm__fail(error, PM_ENOMEM, "out of memory");
    }
    *rows = progress.rows;
    *count = progress.count;
    return status;
}

void pm__search_free(pm__search_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++)
        free(rows[i].ratio_samples);
    free(rows);
}
