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

/* Where a photon's flux and distance come from and go to. */
typedef struct reading {
    const float *carried;
    size_t size;
    float scale2;
    float *distance2, (*flux)[3];
} reading;

static inline float larger(float a, float b)
{
    return a > b ? a : b;
}

/* The farther of the photon and `farthest`. */
static inline float read_photon(const reading *r, const pm_neighbor *neighbor, size_t i, float farthest)
{
    r->distance2[i] = neighbor->distance2 * r->scale2;
    memcpy(r->flux[i], r->carried + neighbor->number * r->size, sizeof r->flux[i]);
    return larger(neighbor->distance2, farthest);
}

/* What every estimate wants, flux and distance, is what an image waits for. Returns the largest distance2, in map
 * units; 0 where there is no photon. Four at a time, since each maximum would wait for the one before. */
static float read_plain(const reading *of, const pm_neighbor *neighbors, size_t count)
{
    const reading r = *of;
    float a = 0.0f, b = 0.0f, c = 0.0f, d = 0.0f;
    size_t i = 0;
    for (; i + 4 <= count; i += 4) {
        a = read_photon(&r, &neighbors[i], i, a);
        b = read_photon(&r, &neighbors[i + 1], i + 1, b);
        c = read_photon(&r, &neighbors[i + 2], i + 2, c);
        d = read_photon(&r, &neighbors[i + 3], i + 3, d);
    }
    for (; i < count; i++)
        a = read_photon(&r, &neighbors[i], i, a);
    return larger(larger(a, b), larger(c, d));
}

static void add_brdf(const pm_map *map, const pm_neighbor *neighbors, size_t count, const pm_source *source,
                     float (*flux)[3])
{
    for (size_t i = 0; i < count; i++)
        apply_brdf(source, pm__direction(map, neighbors[i].number), flux[i]);
}

static void read_offsets(const pm_map *map, const pm_neighbor *neighbors, size_t count, const float from[3],
                         float scale, float (*offset)[3])
{
    for (size_t i = 0; i < count; i++) {
        float position[3];
        pm__position(map, neighbors[i].number, position);
        for (int a = 0; a < 3; a++)
            offset[i][a] = (position[a] - from[a]) * scale;
    }
}

/* from: the query's position in the map's frame; looked at only where offsets are gathered. Returns the largest
 * distance2, in map units. */
static float read_photons(const pm_map *map, const float from[3], const pm_neighbor *neighbors, size_t count,
                          const pm__gathering *gathering, pm_workspace *workspace, size_t first)
{
    const float scale = (float)(map->unit / gathering->unit);
    const reading plain = {map->carried, map->carried_size, scale * scale, workspace->distance2 + first,
                           workspace->flux + first};
    const float farthest = read_plain(&plain, neighbors, count);
    if (gathering->source && gathering->source->brdf)
        add_brdf(map, neighbors, count, gathering->source, workspace->flux + first);
    if (gathering->offsets)
        read_offsets(map, neighbors, count, from, scale, workspace->offset + first);
    return farthest;
}

/* Squares of distances below 2^-60 map units lose digits and then vanish, and a query beyond 1e18 units was brought
 * nearer (pm__in_frame): which photons were found means nothing then. Photons at the very point are no such case. */
static bool is_blurred(const pm_map *map, const pm_query *query, const pm_neighbor *neighbors, size_t count,
                       double region2, float farthest)
{
    if (!count || (region2 >= 0x1p-120 && farthest < 0.99e36f))
        return false;
    if (region2 > 0.0)
        return true;
    for (size_t i = 0; i < count; i++) {
        float position[3];
        pm__position(map, neighbors[i].number, position);
        for (int a = 0; a < 3; a++)
            if (position[a] != pm__in_frame(map, a, query->position[a]))
                return true;
    }
    return false;
}

/* The neighbours of a query as set number `set`. from: as of read_photons. */
static pm_status gather_neighbors(const pm_map *map, const pm_query *query, const float from[3],
                                  const pm_neighbor *neighbors, size_t count, const pm__gathering *gathering,
                                  pm_workspace *workspace, size_t set)
{
    if (gathering->source && gathering->source->brdf && !pm__has_directions(map))
        return PM_EINVAL;
    const size_t first = set ? workspace->first[set - 1] + workspace->sets[set - 1].count : 0;
    const pm_status status = pm__workspace_reserve(workspace, first + count, set + 1);
    if (status != PM_OK)
        return status;
    const float farthest = read_photons(map, from, neighbors, count, gathering, workspace, first);
    const double radius = (double)query->max_radius / gathering->unit, scale = map->unit / gathering->unit;
    const bool cut = !query->k || (count < query->k && !isinf(query->max_radius));
    const double own_radius = (double)query->max_radius * map->inverse_unit;
    workspace->first[set] = first;
    workspace->sets[set] = (pm__neighbors){
        .count = count,
        .cut = cut,
        .radius2 = cut ? radius * radius : (double)farthest * (scale * scale),
        .blurred = is_blurred(map, query, neighbors, count, cut ? own_radius * own_radius : (double)farthest, farthest),
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
    if (status == PM_OK && gathering->sorted)
        pm__sort_neighbors(map, workspace->neighbors, count);
    return status == PM_OK ? gather_neighbors(map, query, prepared.position, workspace->neighbors, count, gathering,
                                              workspace, set)
                           : status;
}

/* The search has checked the query: it need not be prepared again but for its position. */
pm_status pm__gather_found(const pm_map *map, const pm_query *query, pm_neighbor *neighbors, size_t count,
                           const pm__gathering *gathering, pm_workspace *workspace)
{
    pm__query prepared = {.k = 0};
    const pm_status status = gathering->offsets ? pm__query_prepare(map, query, &prepared, NULL) : PM_OK;
    if (status != PM_OK)
        return status;
    if (gathering->sorted)
        pm__sort_neighbors(map, neighbors, count);
    return gather_neighbors(map, query, prepared.position, neighbors, count, gathering, workspace, 0);
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
