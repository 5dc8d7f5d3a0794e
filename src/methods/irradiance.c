#include "irradiance.h"

#include "coverage.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { BLOCK = 256 };

typedef struct work {
    pm__irradiance *irradiance;
    _Atomic int failure;
} work;

static void keep(pm__irradiance *irradiance, size_t image, size_t carrier, const double value[3])
{
    float *const to = irradiance->values[image * irradiance->carriers.count + carrier];
    for (int b = 0; b < 3; b++)
        to[b] = (float)value[b];
}

/* On the neighbours in the workspace. A degenerate set is black. */
static pm_status evaluate(pm__irradiance *irradiance, const pm__coverage *coverage, const pm_query *query, size_t image,
                          size_t carrier, pm_workspace *workspace)
{
    const pm__spec *const spec = &irradiance->job->config->estimators[image]->spec;
    const pm__lookup lookup = {.sets = workspace->sets,
                               .set_count = 1,
                               .dimensions = 2,
                               .normal = {query->normal[0], query->normal[1], query->normal[2]},
                               .unit = pm_map_unit(irradiance->maps->map)};
    double value[3];
    const pm_status status = pm__evaluate(spec, &lookup, workspace, value);
    if (status != PM_OK && status != PM_EDEGENERATE)
        return status;
    const double share = irradiance->whole ? pm__coverage_share(coverage, spec) : 1.0;
    for (int b = 0; b < 3; b++)
        value[b] /= share;
    keep(irradiance, image, carrier, value);
    return PM_OK;
}

/* Leaves those whose surfaces are turned as the query's: a wall's photons are none of the floor's. */
static size_t of_this_surface(const pm__maps *maps, const pm_query *query, pm_neighbor *neighbors, size_t count)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        const float *const normal = maps->normals[pm_map_source(maps->map, neighbors[i].number)];
        if (pm__similar_normals(normal, query->normal))
            neighbors[kept++] = neighbors[i];
    }
    return kept;
}

static void find_coverage(const pm__irradiance *irradiance, const pm_query *query, size_t carrier,
                          pm__coverage *coverage)
{
    double position[3], normal[3];
    for (int a = 0; a < 3; a++) {
        position[a] = (double)query->position[a];
        normal[a] = (double)query->normal[a];
    }
    (void)pm__normalize(normal);
    const double phase = 0.6180339887498949 * (double)carrier;
    pm__coverage_find(irradiance->job->scene, position, normal, (double)irradiance->radius[carrier],
                      phase - floor(phase), coverage);
}

/* All estimators at one photon, from its k nearest, of which it is one. */
static pm_status compute(pm__irradiance *irradiance, const pm_query *query, pm_neighbor *neighbors, size_t count,
                         size_t carrier, pm_workspace *workspace)
{
    const pm__render_job *const job = irradiance->job;
    const pm_map *const map = irradiance->maps->map;
    const pm__gathering gathering = {NULL, pm_map_unit(map), true, true};
    pm__coverage coverage;
    if (irradiance->whole)
        count = of_this_surface(irradiance->maps, query, neighbors, count);
    pm_status status = pm__gather_found(map, query, neighbors, count, &gathering, workspace);
    if (status != PM_OK)
        return status;
    pm__point_sets(workspace, 1, true);
    irradiance->radius[carrier] = (float)(sqrt(workspace->sets[0].radius2) * gathering.unit);
    if (irradiance->whole)
        find_coverage(irradiance, query, carrier, &coverage);
    for (size_t i = 0; i < job->images && status == PM_OK; i++)
        status = evaluate(irradiance, &coverage, query, i, carrier, workspace);
    return status;
}

static pm_status compute_block(pm__irradiance *irradiance, size_t first, size_t count, pm__maps_scratch *scratch)
{
    const pm_map *const map = irradiance->maps->map;
    static const double nowhere[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    const pm_query model = pm__maps_query(irradiance->job, nowhere, up);
    for (size_t i = 0; i < count; i++)
        scratch->queries[i] = pm__carrier_query(&irradiance->carriers, map, &model, first + i);
    pm_status status =
        pm_map_search_batch(map, scratch->queries, count, scratch->neighbors, scratch->stride, scratch->counts);
    for (size_t i = 0; i < count && status == PM_OK; i++)
        status = compute(irradiance, &scratch->queries[i], scratch->neighbors + i * scratch->stride, scratch->counts[i],
                         first + i, scratch->workspace);
    return status;
}

static void run_block(void *argument, size_t block)
{
    work *const w = argument;
    pm__irradiance *const irradiance = w->irradiance;
    const pm__render_config *const config = irradiance->job->config;
    const size_t first = block * BLOCK, rest = irradiance->carriers.count - first;
    pm__maps_scratch scratch;
    if (config->canceled && config->canceled(config->context)) {
        atomic_store(&w->failure, (int)PM_ECANCELED);
        return;
    }
    pm_status status = pm__maps_scratch_create(irradiance->job, irradiance->maps->map, BLOCK, &scratch);
    if (status == PM_OK)
        status = compute_block(irradiance, first, rest < BLOCK ? rest : BLOCK, &scratch);
    pm__maps_scratch_destroy(&scratch);
    if (status != PM_OK)
        atomic_store(&w->failure, (int)status);
}

pm_status pm__irradiance_create(const pm__render_job *job, const pm__maps *maps, double fraction, bool whole,
                                pm__irradiance *irradiance, pm_error *error)
{
    *irradiance = (pm__irradiance){.job = job, .maps = maps, .whole = whole};
    pm_status status = pm__carriers_create(&irradiance->carriers, maps->map, fraction,
                                           (const float(*)[3])maps->normals, job->config->parallel);
    const size_t count = irradiance->carriers.count;
    irradiance->values = pm__alloc_zero(count * job->images, sizeof *irradiance->values);
    irradiance->radius = pm__alloc_zero(count, sizeof *irradiance->radius);
    if (status == PM_OK && irradiance->values && irradiance->radius) {
        work w = {irradiance, PM_OK};
        pm__for(job->config->parallel, (count + BLOCK - 1) / BLOCK, run_block, &w);
        status = (pm_status)atomic_load(&w.failure);
    } else if (status == PM_OK) {
        status = PM_ENOMEM;
    }
    if (status == PM_OK)
        return PM_OK;
    pm__irradiance_destroy(irradiance);
    return pm__fail(error, status, "irradiance at photons: %s", pm_status_text(status));
}

void pm__irradiance_destroy(pm__irradiance *irradiance)
{
    pm__carriers_destroy(&irradiance->carriers);
    free(irradiance->values);
    free(irradiance->radius);
    *irradiance = (pm__irradiance){0};
}

pm_status pm__irradiance_find(const pm__irradiance *irradiance, const pm__eye *eye, pm_workspace *workspace,
                              size_t *carrier)
{
    pm_query query = pm__maps_query(irradiance->job, eye->hit.position, eye->facing);
    query.max_radius = INFINITY;
    return pm__nearest_carrier(&irradiance->carriers, &query, workspace, carrier);
}
