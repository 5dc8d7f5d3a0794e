/* A pass's photons at every point. */
#include "progressive.h"

#include "../../base/clock.h"
#include "../../base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Of one task; photons of a lookup for which there is room where several are looked up together. */
enum { POINTS = 256, STRIDE = 64 };
#define NONE SIZE_MAX

void pm__point_query(const pm__progression *progression, const pm__hit_point *point, size_t k, double radius,
                     pm_query *query)
{
    pm_query_init(query);
    for (int a = 0; a < 3; a++) {
        query->position[a] = (float)point->position[a];
        query->normal[a] = (float)point->normal[a];
    }
    query->k = k;
    query->max_radius = (float)radius;
    query->front_only = progression->front;
    query->sorted = false;
}

void pm__hit_point_brdf(const pm__hit_point *point, const double in[3], double value[3])
{
    const double sign = point->back ? -1.0 : 1.0;
    const double normal[3] = {sign * point->normal[0], sign * point->normal[1], sign * point->normal[2]};
    pm__material_brdf(point->material, normal, in, point->outgoing, value);
}

/* For estimates with a BRDF. */
static void brdf_at(void *context, const float incoming[3], const float outgoing[3], float value[3])
{
    const double in[3] = {-(double)incoming[0], -(double)incoming[1], -(double)incoming[2]};
    double brdf[3];
    (void)outgoing;
    pm__hit_point_brdf(context, in, brdf);
    for (int b = 0; b < 3; b++)
        value[b] = (float)brdf[b];
}

typedef struct looking {
    pm__run *run;
    const pm_map *map;
    bool bare; /* the kernel needs no more of photons than distances */
    _Atomic int failure;
} looking;

/* ---- One point --------------------------------------------------------------------------------- */

static pm_source source_at(const looking *work, const pm__hit_point *point)
{
    const bool even = point->material->kind == PM__DIFFUSE;
    return (pm_source){.maps = &work->map, .map_count = 1, .dimensions = 2, .brdf = even ? NULL : brdf_at,
                       .brdf_context = (void *)(uintptr_t)point};
}

static void tell(const looking *work, const pm__hit_point *point, const pm_estimation *estimation,
                 const pm_workspace *workspace, pm__found *found)
{
    double brdf[3] = {1.0, 1.0, 1.0};
    if (point->material->kind == PM__DIFFUSE)
        pm__hit_point_brdf(point, point->normal, brdf);
    for (int b = 0; b < 3; b++) {
        found->share[b] = point->weight[b] * brdf[b];
        found->radiance[b] = found->share[b] * estimation->value[b];
    }
    found->area = 3.14159265358979323846 * estimation->radius * estimation->radius;
    found->count = estimation->count;
    found->neighbors = workspace->sets;
    found->unit = pm_map_unit(work->map);
}

static bool is_told(pm_status status)
{
    return status == PM_OK || status == PM_EDEGENERATE; /* such a neighbourhood stays black */
}

static pm_status look(const looking *work, const pm__hit_point *point, size_t k, double radius,
                      pm_workspace *workspace, pm__found *found)
{
    const pm__progression *const p = work->run->of;
    const pm_source source = source_at(work, point);
    pm_query query;
    pm_estimation estimation;
    pm__point_query(p, point, k, radius, &query);
    const pm_status status = pm_estimate(p->config->estimator, &source, &query, workspace, &estimation);
    if (!is_told(status))
        return status;
    tell(work, point, &estimation, workspace, found);
    return PM_OK;
}

/* The radius of the lookup under way, as the method counts it: it may have looked further. */
static double radius_of(const pm__run *run, size_t i)
{
    return run->of->config->estimates ? pm__run_view(run, i).radius : 0.0;
}

/* What is found further out, where the lookup has not gone there itself, tells how light curves. */
static pm_status look_further(const looking *work, const pm__hit_point *point, size_t i, double radius,
                              pm_workspace *workspace, pm__found *found)
{
    const double reach = pm__own_reach(radius);
    const bool there = found->area >= 3.14159265358979323846 * reach * reach;
    const pm_status status = there ? PM_OK : look(work, point, 0, reach, workspace, found);
    if (status == PM_OK)
        pm__run_own_bias(work->run, i, found, radius);
    return status;
}

/* The same from photons that have been found, within a radius alone and for a bare kernel. */
static pm_status look_among(const looking *work, const pm__hit_point *point, const pm_query *query,
                            pm_neighbor *neighbors, size_t count, pm_workspace *workspace, pm__found *found)
{
    const pm_estimator *const kernel = work->run->of->config->estimator;
    const pm_source source = source_at(work, point);
    const pm__gathering gathering = {.source = &source, .unit = pm_map_unit(work->map)};
    pm_estimation estimation = {.radius = (double)query->max_radius, .count = count};
    pm_status status = pm__gather_found(work->map, query, neighbors, count, &gathering, workspace);
    if (status != PM_OK)
        return status;
    pm__point_sets(workspace, 1, false);
    const pm__lookup lookup = {.sets = workspace->sets, .set_count = 1, .dimensions = source.dimensions,
                               .unit = gathering.unit};
    status = pm__evaluate(&kernel->spec, &lookup, workspace, estimation.value);
    if (!is_told(status))
        return status;
    tell(work, point, &estimation, workspace, found);
    return PM_OK;
}

/* ---- Several together -------------------------------------------------------------------------- */

/* What a point asks for, and the photons that lie within its radius where that is all. */
typedef struct asking {
    const pm__hit_point *point;
    pm__hit_point drawn;
    size_t k;
    double radius;
    size_t query; /* of the group; NONE: it is looked up by itself, or not at all */
} asking;

typedef struct group {
    asking points[PM__AT_ONCE];
    pm_query queries[PM__AT_ONCE];
    size_t query_count, counts[PM__AT_ONCE];
    pm_neighbor neighbors[PM__AT_ONCE * STRIDE];
} group;

static void ask(const looking *work, size_t i, group *g, asking *to)
{
    pm__run *const run = work->run;
    const pm__progressive *const method = pm__progressive_of(run);
    to->point = &run->of->fixed[i];
    to->k = 0;
    to->radius = 0.0;
    to->query = NONE;
    if (method->redraws) {
        pm__eye eye;
        pm__run_eye(run->of, run->seed, run->passes, i, false, &eye);
        pm__hit_point_follow(&eye, &to->drawn);
        to->point = &to->drawn;
    }
    if (!to->point->material)
        return;
    to->radius = INFINITY;
    method->ask(run, i, run->state + i * method->fields, &to->k, &to->radius);
    if (to->k || !(to->radius > 0.0) || !work->bare)
        return;
    to->query = g->query_count++;
    pm__point_query(run->of, to->point, 0, to->radius, &g->queries[to->query]);
}

static pm_status take(const looking *work, size_t i, group *g, const asking *from, pm_workspace *workspace)
{
    const pm__run *const run = work->run;
    const pm__progressive *const method = pm__progressive_of(run);
    pm__found found = {.count = 0};
    pm_status status = PM_OK;
    memcpy(found.emitted, from->point->emitted, sizeof found.emitted);
    if (from->query != NONE && g->counts[from->query] <= STRIDE)
        status = look_among(work, from->point, &g->queries[from->query], g->neighbors + from->query * STRIDE,
                            g->counts[from->query], workspace, &found);
    else if (from->k || from->radius > 0.0)
        status = look(work, from->point, from->k, from->radius, workspace, &found);
    if (status != PM_OK)
        return status;
    const double radius = radius_of(run, i);
    method->take(run, &found, run->state + i * method->fields);
    return found.neighbors && radius > 0.0 ? look_further(work, from->point, i, radius, workspace, &found) : PM_OK;
}

/* What the next group reads comes from far off: points and states are many times what caches hold. */
static void fetch(const pm__run *run, size_t i)
{
    const size_t fields = pm__progressive_of(run)->fields;
    if (i >= run->of->points)
        return;
    for (size_t at = 0; at < sizeof *run->of->fixed; at += 64)
        __builtin_prefetch((const char *)&run->of->fixed[i] + at);
    for (size_t f = 0; f < fields; f += 8)
        __builtin_prefetch(&run->state[i * fields + f], 1);
}

static pm_status look_at_group(const looking *work, size_t first, size_t count, group *g, pm_workspace *workspace)
{
    g->query_count = 0;
    for (size_t i = 0; i < count; i++) {
        fetch(work->run, first + i + PM__AT_ONCE);
        ask(work, first + i, g, &g->points[i]);
    }
    pm_status status = pm__search_within(work->map, g->queries, g->query_count, g->neighbors, STRIDE, g->counts);
    for (size_t i = 0; i < count && status == PM_OK; i++)
        status = take(work, first + i, g, &g->points[i], workspace);
    return status;
}

static void look_at_block(void *argument, size_t block)
{
    looking *const work = argument;
    const pm__progression *const p = work->run->of;
    const size_t end = (block + 1) * POINTS < p->points ? (block + 1) * POINTS : p->points;
    group g; /* not initialised as a whole: it is large */
    pm_workspace *workspace = NULL;
    pm_status status = pm_workspace_create(p->config->k ? p->config->k : 64, &workspace);
    for (size_t i = block * POINTS; i < end && status == PM_OK; i += PM__AT_ONCE)
        status = look_at_group(work, i, end - i < PM__AT_ONCE ? end - i : PM__AT_ONCE, &g, workspace);
    if (status != PM_OK)
        atomic_store(&work->failure, (int)status);
    pm_workspace_destroy(workspace);
}

/* Only what tells of the bias: the points are looked up, or found, otherwise. */
static void look_further_at_block(void *argument, size_t block)
{
    looking *const work = argument;
    const pm__progression *const p = work->run->of;
    const size_t end = (block + 1) * POINTS < p->points ? (block + 1) * POINTS : p->points;
    pm_workspace *workspace = NULL;
    pm_status status = pm_workspace_create(64, &workspace);
    for (size_t i = block * POINTS; i < end && status == PM_OK; i++) {
        const double radius = p->fixed[i].material ? radius_of(work->run, i) : 0.0;
        pm__found found = {.count = 0};
        if (radius > 0.0)
            status = look_further(work, &p->fixed[i], i, radius, workspace, &found);
    }
    if (status != PM_OK)
        atomic_store(&work->failure, (int)status);
    pm_workspace_destroy(workspace);
}

static pm_status look_everywhere(pm__run *run, const pm_map *map, void (*block)(void *argument, size_t index),
                                 pm_error *error)
{
    const pm__estimator *const kernel = pm__estimator_of(&run->of->config->estimator->spec);
    looking work = {.run = run, .map = map, .bare = kernel->weight && !kernel->needs};
    const double start = pm__seconds();
    pm__for(run->of->config->parallel, (run->of->points + POINTS - 1) / POINTS, block, &work);
    run->lookup_s += pm__seconds() - start;
    const pm_status status = (pm_status)atomic_load(&work.failure);
    return status == PM_OK ? PM_OK : pm__fail(error, status, "lookups of a pass: %s", pm_status_text(status));
}

pm_status pm__run_lookups(pm__run *run, const pm_map *map, pm_error *error)
{
    return look_everywhere(run, map, look_at_block, error);
}

pm_status pm__run_further_lookups(pm__run *run, const pm_map *map, pm_error *error)
{
    return look_everywhere(run, map, look_further_at_block, error);
}
