#include "maps.h"

#include "../base/clock.h"
#include "../base/memory.h"
#include "../base/parallel.h"
#include "../transport/deal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const pm__spec *spec_of(const pm__render_job *job, size_t image)
{
    return &job->config->estimators[image]->spec;
}

static unsigned needs_of(const pm__render_job *job, size_t image)
{
    return pm__estimator_of(spec_of(job, image))->needs;
}

static bool may_share(const pm__render_job *job, size_t image)
{
    return !(needs_of(job, image) & (PM__MAPS | PM__AT_PHOTON));
}

size_t pm__maps_sharing(const pm__render_job *job)
{
    size_t found = 0;
    for (size_t i = 0; i < job->images; i++)
        found += may_share(job, i);
    return found;
}

/* Unless a map is to be made for each of them. */
static bool is_shared(const pm__render_job *job, size_t image)
{
    return may_share(job, image) && (job->needs.shared || pm__maps_sharing(job) == 1);
}

/* ---- Making ------------------------------------------------------------------------------------ */

static pm_map_options options_of(const pm__render_job *job)
{
    return (pm_map_options){.parallel = job->config->parallel,
                            .search = job->config->search,
                            .no_directions = !job->needs.directions};
}

static bool reaches_any(const pm__scene *scene, const pm__projection *projection)
{
    for (size_t i = 0; i < pm__scene_light_count(scene); i++)
        if (pm__projection_share(projection, i) > 0.0)
            return true;
    return false;
}

/* Does an estimator make its estimates at photons? */
static bool wants_normals(const pm__render_job *job)
{
    for (size_t i = 0; i < job->images; i++)
        if (needs_of(job, i) & PM__AT_PHOTON)
            return true;
    return false;
}

/* Photons of the wish: `count` of them, of the part-th of several samples. */
static pm_status shoot(pm__render_job *job, const pm__maps_wish *wish, size_t count, uint32_t part,
                       pm__photon_set *set, pm_error *error)
{
    const pm__render_config *const config = job->config;
    pm__paths *paths = NULL;
    pm__projection *projection = wish->aimed ? job->needs.aim : NULL;
    const bool made = wish->aimed && !projection;
    const double start = pm__seconds();
    pm_status status = pm__paths_create(wish->paths, &paths, error);
    if (status == PM_OK && made)
        status = pm__projection_create(job->scene, true, &projection, error);
    if (status != PM_OK || (projection && !reaches_any(job->scene, projection))) {
        pm__paths_destroy(paths);
        pm__projection_destroy(made ? projection : NULL);
        return status; /* nothing is there to be met: there are no such photons */
    }
    const double most = fmin(ceil(wish->most * (double)count), (double)PM__MOST_TRACED);
    const pm__shoot_config shooting = {.scene = job->scene,
                                       .paths = paths,
                                       .seed = config->seed,
                                       .trial = wish->trial + ((part + 128 * wish->stream) << 24),
                                       .sampler = config->sampler,
                                       .projection = projection,
                                       .count = count,
                                       .emitted = wish->emitted,
                                       .most = (uint64_t)most,
                                       .normals = wish->normals || (wish->estimates && wants_normals(job)),
                                       .parallel = config->parallel,
                                       .canceled = config->canceled,
                                       .context = config->context};
    if (status == PM_OK)
        status = pm__shoot(&shooting, set, error);
    pm__paths_destroy(paths);
    pm__projection_destroy(made ? projection : NULL);
    job->trace_s += pm__seconds() - start;
    if (status == PM_OK) {
        job->emitted += set->emitted;
        job->stored += set->count;
    }
    return status;
}

/* Maps of samples of their own: each has its share of the photons, and of the power. */
static pm_status make_separate(pm__render_job *job, const pm__maps_wish *wish, pm__own_maps *own, pm_error *error)
{
    const pm_map_options options = options_of(job);
    pm_status status = PM_OK;
    for (size_t m = 0; m < own->count && status == PM_OK; m++) {
        pm__photon_set set = {0};
        status = shoot(job, wish, pm__share(wish->photons, own->count, m), (uint32_t)m + 1, &set, error);
        for (size_t i = 0; i < set.count; i++)
            for (int b = 0; b < 3; b++)
                set.photons[i].power[b] /= (float)own->count;
        const double start = pm__seconds();
        if (status == PM_OK)
            status = pm_map_create(set.photons, set.count, &options, &own->dealt[m], error);
        job->build_s += pm__seconds() - start;
        pm__photon_set_free(&set);
    }
    return status;
}

static pm_status make_combined(pm__render_job *job, const pm__maps_wish *wish, const pm__photon_set *set,
                               const pm__spec *spec, pm__own_maps *own, pm_error *error)
{
    const int how = (int)pm__spec_value(spec, "deal", PM__DEAL_RANDOM);
    own->count = pm__map_count_of(spec);
    own->dealt = pm__alloc_zero(own->count, sizeof *own->dealt);
    if (!own->dealt)
        return pm__fail(error, PM_ENOMEM, "out of memory for photon maps");
    if (how == PM__DEAL_SEPARATE)
        return make_separate(job, wish, own, error);
    const pm__dealing dealing = {own->count, how == PM__DEAL_ROUND_ROBIN, job->config->seed, wish->trial};
    const pm_map_options options = options_of(job);
    return pm__deal(&dealing, set->photons, set->count, &options, own->dealt, error);
}

/* The very map that it could share. */
static pm_status make_equal(const pm__render_job *job, const pm__photon_set *set, pm__own_maps *own, pm_error *error)
{
    const pm_map_options options = options_of(job);
    own->count = 1;
    own->dealt = pm__alloc_zero(1, sizeof *own->dealt);
    return own->dealt ? pm_map_create(set->photons, set->count, &options, &own->dealt[0], error)
                      : pm__fail(error, PM_ENOMEM, "out of memory for photon maps");
}

/* A parallel-for that does no more once it is canceled: what it was to fill is then not to be used. */
typedef struct stoppable {
    const pm__render_config *config;
    void (*task)(void *argument, size_t index);
    void *argument;
} stoppable;

static void unless_canceled(void *context, size_t index)
{
    const stoppable *const work = context;
    if (!work->config->canceled || !work->config->canceled(work->config->context))
        work->task(work->argument, index);
}

static void run_stoppable(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    stoppable work = {context, task, argument};
    pm__for(work.config->parallel, count, unless_canceled, &work);
}

static pm_status make_precomputed(pm__render_job *job, const pm_map *map, const float (*normals)[3],
                                  const pm_estimator *estimator, pm__own_maps *own, pm_error *error)
{
    static const double nowhere[3] = {0.0, 0.0, 0.0}, up[3] = {0.0, 0.0, 1.0};
    const pm__render_config *const config = job->config;
    const pm_parallel parallel = {run_stoppable, (void *)(uintptr_t)config};
    const pm_precomputed_options options = {.lookup = pm__maps_query(job, nowhere, up),
                                            .normals = normals,
                                            .parallel = &parallel,
                                            .dimensions = 2};
    const pm_status status = pm_precomputed_create(estimator, map, &options, &own->precomputed, error);
    return status == PM_OK && config->canceled && config->canceled(config->context) ? PM_ECANCELED : status;
}

static pm_status make_own(pm__render_job *job, const pm__maps_wish *wish, const pm__photon_set *set, pm__maps *maps,
                          pm_error *error)
{
    maps->own = pm__alloc_zero(job->images, sizeof *maps->own);
    pm_status status = maps->own ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory for photon maps");
    for (size_t i = 0; i < job->images && status == PM_OK; i++) {
        const unsigned needs = needs_of(job, i);
        if (needs & PM__MAPS)
            status = make_combined(job, wish, set, spec_of(job, i), &maps->own[i], error);
        else if (needs & PM__AT_PHOTON)
            status = make_precomputed(job, maps->map, (const float(*)[3])maps->normals, job->config->estimators[i],
                                      &maps->own[i], error);
        else if (!is_shared(job, i))
            status = make_equal(job, set, &maps->own[i], error);
        maps->offsets = maps->offsets || (is_shared(job, i) && needs & PM__OFFSETS);
        maps->shared = maps->shared || is_shared(job, i) || maps->own[i].precomputed;
    }
    return status;
}

pm_status pm__maps_create(pm__render_job *job, const pm__maps_wish *wish, pm__maps *maps, pm_error *error)
{
    *maps = (pm__maps){.job = job};
    pm__photon_set set = {0};
    const pm_map_options options = options_of(job);
    pm_status status = shoot(job, wish, wish->photons, 0, &set, error);
    const double start = pm__seconds();
    if (status == PM_OK)
        status = pm_map_create(set.photons, set.count, &options, &maps->map, error);
    job->build_s += pm__seconds() - start;
    maps->normals = set.normals;
    set.normals = NULL;
    if (status == PM_OK && wish->estimates)
        status = make_own(job, wish, &set, maps, error);
    pm__photon_set_free(&set);
    if (status != PM_OK)
        pm__maps_destroy(maps);
    return status;
}

void pm__maps_destroy(pm__maps *maps)
{
    for (size_t i = 0; maps->own && i < maps->job->images; i++) {
        for (size_t m = 0; maps->own[i].dealt && m < maps->own[i].count; m++)
            pm_map_destroy(maps->own[i].dealt[m]);
        free(maps->own[i].dealt);
        pm_precomputed_destroy(maps->own[i].precomputed);
    }
    free(maps->own);
    free(maps->normals);
    pm_map_destroy(maps->map);
    *maps = (pm__maps){0};
}

/* ---- Estimating -------------------------------------------------------------------------------- */

pm_status pm__maps_scratch_create(const pm__render_job *job, const pm_map *map, size_t points,
                                  pm__maps_scratch *scratch)
{
    const size_t all = map ? pm_map_count(map) : 0, neighbors = job->config->k < all ? job->config->k : all;
    *scratch = (pm__maps_scratch){.points = points,
                                  .stride = neighbors,
                                  .queries = pm__alloc(points, sizeof *scratch->queries),
                                  .neighbors = pm__alloc(points * neighbors, sizeof *scratch->neighbors),
                                  .counts = pm__alloc(points, sizeof *scratch->counts),
                                  .which = pm__alloc(points, sizeof *scratch->which)};
    pm_status status = scratch->queries && scratch->neighbors && scratch->counts && scratch->which ? PM_OK : PM_ENOMEM;
    if (status == PM_OK)
        status = pm_workspace_create(neighbors, &scratch->workspace);
    if (status != PM_OK)
        pm__maps_scratch_destroy(scratch);
    return status;
}

void pm__maps_scratch_destroy(pm__maps_scratch *scratch)
{
    pm_workspace_destroy(scratch->workspace);
    free(scratch->queries);
    free(scratch->neighbors);
    free(scratch->counts);
    free(scratch->which);
    *scratch = (pm__maps_scratch){0};
}

pm_query pm__maps_query(const pm__render_job *job, const double position[3], const double normal[3])
{
    const pm__render_config *const config = job->config;
    pm_query query;
    pm_query_init(&query);
    for (int a = 0; a < 3; a++) {
        query.position[a] = (float)position[a];
        query.normal[a] = (float)normal[a];
    }
    query.k = config->k;
    query.max_radius = (float)config->radius;
    query.shape = config->lookup.shape;
    query.shape_parameter = (float)config->lookup.parameter;
    query.front_only = config->lookup.front_only && job->needs.front;
    query.sorted = false;
    return query;
}

bool pm__is_even(const pm__eye *eye, double value[3])
{
    pm__material_brdf(eye->hit.material, eye->hit.normal, eye->facing, eye->facing, value);
    return eye->hit.material->kind == PM__DIFFUSE;
}

/* For estimates with a BRDF: that of a point, for a photon's direction of travel. */
static void brdf_at(void *context, const float incoming[3], const float outgoing[3], float value[3])
{
    const pm__eye *const eye = context;
    const double in[3] = {-(double)incoming[0], -(double)incoming[1], -(double)incoming[2]};
    const double out[3] = {(double)outgoing[0], (double)outgoing[1], (double)outgoing[2]};
    double brdf[3];
    pm__material_brdf(eye->hit.material, eye->hit.normal, in, out, brdf);
    for (int b = 0; b < 3; b++)
        value[b] = (float)brdf[b];
}

static pm_source source_at(const pm__eye *eye, bool even)
{
    pm_source source = {.dimensions = 2, .brdf = even ? NULL : brdf_at, .brdf_context = (void *)(uintptr_t)eye};
    for (int a = 0; a < 3; a++)
        source.outgoing[a] = (float)eye->outgoing[a];
    return source;
}

static void add(const pm__eye *eye, const double brdf[3], const double value[3], double radius, size_t count,
                pm__sample *sample)
{
    for (int b = 0; b < 3; b++)
        sample->radiance[b] += eye->weight[b] * brdf[b] * value[b];
    sample->radius = (float)radius;
    sample->count = (float)count;
}

/* A degenerate neighbourhood has no estimate: it stays black, as its radius and count show. */
static pm_status without_degenerate(pm_status status)
{
    return status == PM_EDEGENERATE ? PM_OK : status;
}

/* What an estimator with maps of its own says; `precomputed` has irradiance only, so where the surface does not scatter
 * evenly it is evaluated at the point itself, on the shared map's photons. */
static pm_status estimate_own(const pm__maps *maps, size_t image, const pm__eye *eye, const pm_query *query,
                              const pm_source *even_source, const double brdf[3], pm_workspace *workspace,
                              pm__sample *sample)
{
    const pm__own_maps *const own = &maps->own[image];
    const pm_map *const dealt[1] = {maps->map};
    pm_estimation estimation;
    pm_source source = *even_source;
    source.maps = own->dealt ? (const pm_map *const *)own->dealt : dealt;
    source.map_count = own->dealt ? own->count : 1;
    source.precomputed = own->precomputed;
    const pm_status status =
        without_degenerate(pm_estimate(maps->job->config->estimators[image], &source, query, workspace, &estimation));
    if (status == PM_OK)
        add(eye, brdf, estimation.value, estimation.radius, estimation.count, sample);
    return status;
}

/* On the gathered set. */
static pm_status evaluate(const pm__maps *maps, size_t image, const pm__eye *eye, const pm_query *query,
                          const double brdf[3], pm_workspace *workspace, pm__sample *sample)
{
    const pm__lookup lookup = {.sets = workspace->sets,
                               .set_count = 1,
                               .dimensions = 2,
                               .normal = {query->normal[0], query->normal[1], query->normal[2]},
                               .unit = pm_map_unit(maps->map)};
    double value[3];
    const pm_status status = without_degenerate(pm__evaluate(spec_of(maps->job, image), &lookup, workspace, value));
    if (status == PM_OK)
        add(eye, brdf, value, sqrt(workspace->sets[0].radius2) * lookup.unit, workspace->sets[0].count, sample);
    return status;
}

static bool is_sorted(const pm__render_job *job, size_t image)
{
    return needs_of(job, image) & PM__SORTED;
}

/* Is the estimate made on the map that all share? Those made at photons are where there is a BRDF. */
static bool is_on_map(const pm__maps *maps, size_t image, bool even)
{
    return is_shared(maps->job, image) || (!even && maps->own[image].precomputed);
}

/* What an estimator says must not depend on the others of the render, so photons are sorted for those alone that need
 * it: order tells in the last digits of a sum. */
static pm_status estimate_on_map(const pm__maps *maps, bool sorted, const pm__eye *eye, const pm_query *query,
                                 pm_neighbor *neighbors, size_t count, const pm_source *source,
                                 const double brdf[3], pm_workspace *workspace, pm__sample *samples, size_t stride)
{
    const bool even = !source->brdf;
    const pm__gathering gathering = {source, pm_map_unit(maps->map), sorted, maps->offsets};
    bool wanted = false;
    for (size_t i = 0; i < maps->job->images; i++)
        wanted = wanted || (is_on_map(maps, i, even) && is_sorted(maps->job, i) == sorted);
    if (!wanted)
        return PM_OK;
    pm_status status = query->k ? pm__gather_found(maps->map, query, neighbors, count, &gathering, workspace)
                                : pm__gather(maps->map, query, &gathering, workspace, 0);
    if (status == PM_OK)
        pm__point_sets(workspace, 1, gathering.offsets);
    for (size_t i = 0; i < maps->job->images && status == PM_OK; i++)
        if (is_on_map(maps, i, even) && is_sorted(maps->job, i) == sorted)
            status = evaluate(maps, i, eye, query, brdf, workspace, &samples[i * stride]);
    return status;
}

static pm_status estimate_at(const pm__maps *maps, const pm__eye *eye, const pm_query *query,
                             pm_neighbor *neighbors, size_t count, pm_workspace *workspace, pm__sample *samples,
                             size_t stride)
{
    static const double one[3] = {1.0, 1.0, 1.0};
    double even_brdf[3];
    const bool even = pm__is_even(eye, even_brdf);
    const double *const brdf = even ? even_brdf : one;
    const pm_source source = source_at(eye, even);
    pm_status status = PM_OK;
    for (int sorted = 0; sorted < 2 && status == PM_OK; sorted++)
        status = estimate_on_map(maps, sorted, eye, query, neighbors, count, &source, brdf, workspace, samples, stride);
    for (size_t i = 0; i < maps->job->images && status == PM_OK; i++) /* these use the workspace themselves */
        if (!is_on_map(maps, i, even))
            status = estimate_own(maps, i, eye, query, &source, brdf, workspace, &samples[i * stride]);
    return status;
}

/* At the points of scratch->which. */
static pm_status estimate_some(const pm__maps *maps, const pm__eye *eyes, size_t points, pm__maps_scratch *scratch,
                               pm__sample *samples, size_t stride)
{
    const size_t k = maps->job->config->k;
    pm_status status = PM_OK;
    memset(scratch->counts, 0, points * sizeof *scratch->counts);
    if (points && k && maps->shared)
        status = pm_map_search_batch(maps->map, scratch->queries, points, scratch->neighbors, scratch->stride,
                                     scratch->counts);
    for (size_t p = 0; p < points && status == PM_OK; p++)
        status = estimate_at(maps, &eyes[scratch->which[p]], &scratch->queries[p],
                             scratch->neighbors + p * scratch->stride, scratch->counts[p], scratch->workspace,
                             &samples[scratch->which[p]], stride);
    return status;
}

/* A few points at a time, so that what is found for them is still near when it is read. */
pm_status pm__maps_estimate(const pm__maps *maps, const pm__eye *eyes, const bool *reached, size_t count,
                            pm__maps_scratch *scratch, pm__sample *samples, size_t stride)
{
    size_t points = 0;
    pm_status status = PM_OK;
    for (size_t i = 0; i < count && status == PM_OK; i++) {
        if (reached[i]) {
            scratch->queries[points] = pm__maps_query(maps->job, eyes[i].hit.position, eyes[i].facing);
            scratch->which[points++] = i;
        }
        if (points == scratch->points || i + 1 == count) {
            status = estimate_some(maps, eyes, points, scratch, samples, stride);
            points = 0;
        }
    }
    return status;
}
