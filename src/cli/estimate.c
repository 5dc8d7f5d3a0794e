#include "estimate.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../map/ply_reader.h"
#include "../map/structure.h"
#include "../search/search.h"
#include "../transport/deal.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = 256 };

static const pm__estimator *estimator_of(const pm__estimate *e)
{
    return (const pm__estimator *)(const void *)e->spec->entry;
}

static size_t maps_of(const pm__estimate *e)
{
    return estimator_of(e)->needs & PM__MAPS ? (size_t)pm__spec_value(e->spec, "maps", 1.0) : 1;
}

static int deal_of(const pm__estimate *e)
{
    return (int)pm__spec_value(e->spec, "deal", PM__DEAL_RANDOM);
}

pm_status pm__estimate_check(const pm__estimate *e, pm_error *error)
{
    const pm__estimator *const estimator = estimator_of(e);
    const size_t maps = maps_of(e), least = estimator->min_k * maps;
    if (estimator->needs & PM__TRUTH)
        return pm__fail(error, PM_EINVAL, "--estimator %s needs the truth, which a photon file does not have",
                        estimator->entry.name);
    if (!(estimator->dimensions & 4))
        return pm__fail(error, PM_EINVAL, "--estimator %s does not work on surfaces", estimator->entry.name);
    if (maps > 1 && deal_of(e) == PM__DEAL_SEPARATE)
        return pm__fail(error, PM_EINVAL,
                        "--estimator %s: deal=separate wants maps drawn separately, and a photon file is one "
                        "map; deal=random or deal=roundrobin divide it",
                        estimator->entry.name);
    if (e->lookup.k && e->lookup.search->radius_only)
        return pm__fail(error, PM_EINVAL, "--search %s finds all within a fixed radius: it needs --radius without --k",
                        e->lookup.search->entry.name);
    if (e->lookup.k && e->lookup.k < least)
        return pm__fail(error, PM_EINVAL, "--k %zu is too few for --estimator %s, which needs at least %zu",
                        e->lookup.k, estimator->entry.name, least);
    return PM_OK;
}

/* Bytes a photon of what is built from those read, at its fullest. STORED: an estimate at a photon. */
static double bytes_of_maps(const pm__estimate *e)
{
    enum { NUMBER = sizeof(uint32_t), NORMAL = sizeof(float[3]), STORED = 40 };
    const pm__structure_id structure = e->lookup.search->structure;
    const double photon = sizeof(pm_photon), map = pm__bytes_to_build(structure, true);
    double bytes = map + (maps_of(e) > 1 ? PM__BYTES_TO_DEAL : 0.0);
    if (estimator_of(e)->needs & PM__AT_PHOTON)
        bytes += NUMBER + pm__spec_value(e->spec, "fraction", 1.0) * (map + photon + NUMBER + NORMAL + STORED);
    return bytes;
}

/* What the threads want for a lookup of k photons. */
static double bytes_of_workspaces(const pm__estimate *e, size_t k)
{
    enum { A_PHOTON = sizeof(pm_neighbor) + sizeof(float) + 2 * sizeof(float[3]) };
    return (double)(e->threads ? e->threads : 1) * (double)k * A_PHOTON;
}

pm_status pm__estimate_load(pm__estimate *e, const char *photon_path, const char *query_path, pm_error *error)
{
    pm__ply_budget budget = {.memory = e->memory, .per_vertex = bytes_of_maps(e)};
    const pm_status status =
        pm__ply_read_photons(photon_path, &budget, &e->photons, &e->normals, &e->photon_count, error);
    if (status != PM_OK)
        return status;
    const double read = (double)(sizeof(pm_photon) + (e->normals ? sizeof *e->normals : 0));
    const size_t k = e->lookup.k < e->photon_count ? e->lookup.k : e->photon_count;
    const double taken = (double)e->photon_count * (read + budget.per_vertex) + bytes_of_workspaces(e, k);
    if (e->memory > 0.0) /* what is left, but never 0, which would mean any */
        budget.memory = fmax(e->memory - taken, 1.0);
    budget.per_vertex = sizeof(pm_estimation) + sizeof(pm_status);
    return pm__ply_read_points(query_path, &budget, &e->points, &e->point_count, error);
}

static pm_status build_maps(pm__estimate *e, pm_error *error)
{
    const pm_map_options options = {.parallel = e->parallel, .search = e->lookup.search};
    if (e->map_count == 1)
        return pm_map_create(e->photons, e->photon_count, &options, &e->maps[0], error);
    const pm__dealing dealing = {e->map_count, deal_of(e) == PM__DEAL_ROUND_ROBIN, e->seed, 0};
    return pm__deal(&dealing, e->photons, e->photon_count, &options, e->maps, error);
}

/* k photons of the largest power there is cannot reach the threshold from farther away ([C02] 5.2.3). */
static float automatic_radius(const pm__estimate *e)
{
    double power = 0.0;
    for (size_t m = 0; m < e->map_count; m++)
        power = fmax(power, pm_map_max_power(e->maps[m]));
    return (float)pm_max_radius_surface(e->lookup.k, power, e->auto_threshold);
}

static pm_status precompute(pm__estimate *e, pm_error *error)
{
    const pm_precomputed_options options = {
        .lookup = e->lookup, .normals = (const float (*)[3])e->normals, .parallel = e->parallel, .dimensions = 2};
    return pm_precomputed_create(e->estimator, e->maps[0], &options, &e->precomputed, error);
}

pm_status pm__estimate_build(pm__estimate *e, pm_error *error)
{
    char name[PM__MAX_SPEC];
    e->map_count = maps_of(e);
    e->maps = calloc(e->map_count, sizeof(pm_map *));
    if (!e->maps)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    pm__spec_format(e->spec, name, sizeof name);
    pm_status status = pm_estimator_create(name, &e->estimator, error);
    if (status == PM_OK)
        status = build_maps(e, error);
    if (status == PM_OK && e->auto_threshold > 0.0)
        e->lookup.max_radius = automatic_radius(e);
    if (status == PM_OK && estimator_of(e)->needs & PM__AT_PHOTON)
        status = precompute(e, error);
    return status;
}

static pm_status run_point(const pm__estimate *e, size_t index, const pm_source *source, pm_workspace *workspace)
{
    pm_query query = e->lookup;
    memcpy(query.position, e->points[index].position, sizeof query.position);
    memcpy(query.normal, e->points[index].normal, sizeof query.normal);
    return pm_estimate(e->estimator, source, &query, workspace, &e->estimations[index]);
}

/* A block of points, cut by number so that threads do not matter. */
static void run_block(void *argument, size_t block)
{
    const pm__estimate *const e = argument;
    const size_t first = block * BLOCK, end = first + BLOCK < e->point_count ? first + BLOCK : e->point_count;
    const pm_source source = {.maps = (const pm_map *const *)e->maps,
                              .map_count = e->map_count,
                              .precomputed = e->precomputed,
                              .dimensions = 2};
    const size_t room = e->lookup.k < e->photon_count ? e->lookup.k : e->photon_count;
    pm_workspace *workspace = NULL;
    const pm_status created = e->canceled() ? PM_ECANCELED : pm_workspace_create(room, &workspace);
    for (size_t i = first; i < end; i++)
        e->statuses[i] = created ? created : run_point(e, i, &source, workspace);
    pm_workspace_destroy(workspace);
}

pm_status pm__estimate_run(pm__estimate *e, pm_error *error)
{
    e->estimations = pm__alloc_zero(e->point_count, sizeof *e->estimations);
    e->statuses = pm__alloc_zero(e->point_count, sizeof *e->statuses);
    if (!e->estimations || !e->statuses)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    pm__for(e->parallel, (e->point_count + BLOCK - 1) / BLOCK, run_block, e);
    for (size_t i = 0; i < e->point_count; i++)
        if (e->statuses[i] != PM_OK && e->statuses[i] != PM_EDEGENERATE)
            return pm__fail(error, e->statuses[i], "query %zu: %s", i, pm_status_text(e->statuses[i]));
    return PM_OK;
}

void pm__estimate_free(pm__estimate *e)
{
    pm_precomputed_destroy(e->precomputed);
    for (size_t m = 0; e->maps && m < e->map_count; m++)
        pm_map_destroy(e->maps[m]);
    free(e->maps);
    pm_estimator_destroy(e->estimator);
    pm_free(e->photons);
    pm_free(e->normals);
    pm_free(e->points);
    free(e->estimations);
    free(e->statuses);
}
