/* Neighbours found, then read from the map into the arrays that estimators see. */
#include "lookup.h"

#include "../search/result.h"

#include <string.h>

/* A fixed radius does not say how many photons it holds: look, and look again with room for them. */
static pm_status find_neighbors(const pm_map *map, const pm_query *query, const pm__query *prepared,
                                pm_workspace *workspace, size_t *found)
{
    const pm_search *const search = pm__search_of(map, query);
    size_t room = prepared->k ? prepared->k : 64;
    if (!search)
        return PM_EINVAL;
    for (;;) {
        if (pm__workspace_reserve_neighbors(workspace, room) != PM_OK)
            return PM_ENOMEM;
        *found = pm__run_search(map, search, prepared, workspace->neighbors, workspace->neighbor_capacity);
        if (*found <= workspace->neighbor_capacity)
            return PM_OK;
        room = *found;
    }
}

static void apply_brdf(const pm_source *source, const float direction[3], float flux[3])
{
    float value[3] = {0.0f, 0.0f, 0.0f};
    source->brdf(source->brdf_context, direction, source->outgoing, value);
    for (int c = 0; c < 3; c++)
        flux[c] *= value[c];
}

static void read_photons(const pm_map *map, const pm__query *prepared, const pm__gathering *gathering,
                         pm_workspace *workspace, size_t first, size_t count)
{
    const float scale = (float)(map->unit / gathering->unit);
    const bool brdf = gathering->source && gathering->source->brdf;
    for (size_t i = 0; i < count; i++) {
        const pm_neighbor neighbor = workspace->neighbors[i];
        const float *const power = pm__power(map, neighbor.number);
        float *const flux = workspace->flux[first + i];
        workspace->distance2[first + i] = neighbor.distance2 * (scale * scale);
        memcpy(flux, power, sizeof workspace->flux[0]);
        if (brdf)
            apply_brdf(gathering->source, power + PM__POWER, flux);
        if (gathering->offsets) {
            float position[3];
            pm__position(map, neighbor.number, position);
            for (int a = 0; a < 3; a++)
                workspace->offset[first + i][a] = (position[a] - prepared->position[a]) * scale;
        }
    }
}

/* The largest distance2 found; 0 where nothing was. */
static float farthest_distance2(const pm_workspace *workspace, size_t count)
{
    float farthest = 0.0f;
    for (size_t i = 0; i < count; i++)
        if (workspace->neighbors[i].distance2 > farthest)
            farthest = workspace->neighbors[i].distance2;
    return farthest;
}

/* The workspace's neighbours, `count` of them, as set number `set`. */
static pm_status gather_neighbors(const pm_map *map, const pm_query *query, const pm__query *prepared,
                                  const pm__gathering *gathering, pm_workspace *workspace, size_t set, size_t count)
{
    if (gathering->source && gathering->source->brdf && !pm__has_directions(map))
        return PM_EINVAL;
    const size_t first = set ? workspace->first[set - 1] + workspace->sets[set - 1].count : 0;
    const pm_status status = pm__workspace_reserve(workspace, first + count, set + 1);
    if (status != PM_OK)
        return status;
    if (gathering->sorted)
        pm__sort_neighbors(map, workspace->neighbors, count);
    read_photons(map, prepared, gathering, workspace, first, count);
    const double radius = (double)query->max_radius / gathering->unit, scale = map->unit / gathering->unit;
    const bool cut = !query->k || (count < query->k && !isinf(query->max_radius));
    workspace->first[set] = first;
    workspace->sets[set] = (pm__neighbors){
        .count = count,
        .cut = cut,
        .radius2 = cut ? radius * radius : (double)farthest_distance2(workspace, count) * (scale * scale),
    };
    return PM_OK;
}

pm_status pm__gather(const pm_map *map, const pm_query *query, const pm__gathering *gathering,
                     pm_workspace *workspace, size_t set)
{
    pm__query prepared;
    size_t count = 0;
    pm_status status = pm__query_prepare(map, query, &prepared, NULL);
    if (status == PM_OK)
        status = find_neighbors(map, query, &prepared, workspace, &count);
    return status == PM_OK ? gather_neighbors(map, query, &prepared, gathering, workspace, set, count) : status;
}

pm_status pm__gather_found(const pm_map *map, const pm_query *query, const pm_neighbor *neighbors, size_t count,
                           const pm__gathering *gathering, pm_workspace *workspace)
{
    pm__query prepared;
    pm_status status = pm__query_prepare(map, query, &prepared, NULL);
    if (status == PM_OK)
        status = pm__workspace_reserve_neighbors(workspace, count);
    if (status != PM_OK)
        return status;
    memcpy(workspace->neighbors, neighbors, count * sizeof *neighbors);
    return gather_neighbors(map, query, &prepared, gathering, workspace, 0, count);
}

void pm__point_sets(pm_workspace *workspace, size_t set_count, bool offsets)
{
    for (size_t s = 0; s < set_count; s++) {
        const size_t first = workspace->first[s];
        workspace->sets[s].distance2 = workspace->distance2 + first;
        workspace->sets[s].flux = (const float(*)[3])(workspace->flux + first);
        workspace->sets[s].offset = offsets ? (const float(*)[3])(workspace->offset + first) : NULL;
    }
}
