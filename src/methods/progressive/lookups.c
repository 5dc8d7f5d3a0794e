/* A pass's photons at every point. */
#include "progressive.h"

#include "../../base/clock.h"
#include "../../base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum { POINTS = 256 }; /* of one task */

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
    _Atomic int failure;
} looking;

static pm_status look(const looking *work, const pm__hit_point *point, size_t k, double radius,
                      pm_workspace *workspace, pm__found *found)
{
    const pm__progression *const p = work->run->of;
    const bool even = point->material->kind == PM__DIFFUSE;
    pm_source source = {.maps = &work->map, .map_count = 1, .dimensions = 2, .brdf = even ? NULL : brdf_at,
                        .brdf_context = (void *)(uintptr_t)point};
    pm_query query;
    pm_estimation estimation;
    double brdf[3] = {1.0, 1.0, 1.0};
    if (even)
        pm__hit_point_brdf(point, point->normal, brdf);
    pm__point_query(p, point, k, radius, &query);
    const pm_status status = pm_estimate(p->config->estimator, &source, &query, workspace, &estimation);
    if (status != PM_OK && status != PM_EDEGENERATE) /* such a neighbourhood stays black */
        return status;
    for (int b = 0; b < 3; b++) {
        found->share[b] = point->weight[b] * brdf[b];
        found->radiance[b] = found->share[b] * estimation.value[b];
    }
    found->area = 3.14159265358979323846 * estimation.radius * estimation.radius;
    found->count = estimation.count;
    found->neighbors = workspace->sets;
    found->unit = pm_map_unit(work->map);
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

static pm_status look_at(const looking *work, size_t i, pm_workspace *workspace)
{
    pm__run *const run = work->run;
    const pm__progressive *const method = pm__progressive_of(run);
    double *const state = run->state + i * method->fields;
    const pm__hit_point *point = &run->of->fixed[i];
    pm__hit_point drawn;
    pm__found found = {.count = 0};
    if (method->redraws) {
        pm__eye eye;
        pm__run_eye(run->of, run->seed, run->passes, i, false, &eye);
        pm__hit_point_follow(&eye, &drawn);
        point = &drawn;
    }
    memcpy(found.emitted, point->emitted, sizeof found.emitted);
    pm_status status = PM_OK;
    if (point->material) {
        size_t k = 0;
        double radius = INFINITY;
        method->ask(run, i, state, &k, &radius);
        if (k || radius > 0.0)
            status = look(work, point, k, radius, workspace, &found);
    }
    if (status != PM_OK)
        return status;
    const double radius = radius_of(run, i);
    method->take(run, &found, state);
    return found.neighbors && radius > 0.0 ? look_further(work, point, i, radius, workspace, &found) : PM_OK;
}

static void look_at_block(void *argument, size_t block)
{
    looking *const work = argument;
    const pm__progression *const p = work->run->of;
    pm_workspace *workspace = NULL;
    pm_status status = pm_workspace_create(p->config->k ? p->config->k : 64, &workspace);
    for (size_t i = block * POINTS; i < (block + 1) * POINTS && i < p->points && status == PM_OK; i++)
        status = look_at(work, i, workspace);
    if (status != PM_OK)
        atomic_store(&work->failure, (int)status);
    pm_workspace_destroy(workspace);
}

pm_status pm__run_lookups(pm__run *run, const pm_map *map, pm_error *error)
{
    looking work = {.run = run, .map = map};
    const double start = pm__seconds();
    pm__for(run->of->config->parallel, (run->of->points + POINTS - 1) / POINTS, look_at_block, &work);
    run->lookup_s += pm__seconds() - start;
    const pm_status status = (pm_status)atomic_load(&work.failure);
    return status == PM_OK ? PM_OK : pm__fail(error, status, "lookups of a pass: %s", pm_status_text(status));
}
