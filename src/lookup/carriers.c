#include "carriers.h"

#include "../base/memory.h"
#include "../base/vec3.h"

#include <stdlib.h>
#include <string.h>

/* The chosen are every so many in the caller's order: a choice that no search's order of the map can change.
 * number_of: scratch of the whole map's count. */
static pm_status fill(pm__carriers *c, const pm_map *map, const float (*normals)[3], const pm_parallel *parallel,
                      uint32_t *number_of, pm_photon *photons)
{
    const size_t all = pm_map_count(map);
    for (size_t number = 0; number < all; number++)
        number_of[pm_map_source(map, (uint32_t)number)] = (uint32_t)number;
    for (size_t i = 0; i < c->count; i++) {
        const size_t source = i * all / c->count;
        c->number[i] = number_of[source];
        photons[i] = pm_map_photon(map, c->number[i]);
        if (c->normals)
            memcpy(c->normals[i], normals[source], sizeof c->normals[i]);
    }
    /* The nearest carrier is asked for, whatever the radius of the estimates. */
    const pm_map_options options = {.parallel = parallel,
                                    .search = map->search->radius_only ? NULL : map->search,
                                    .no_directions = !pm__has_directions(map)};
    return pm_map_create(photons, c->count, &options, &c->map, NULL);
}

pm_status pm__carriers_create(pm__carriers *carriers, const pm_map *map, double fraction, const float (*normals)[3],
                              const pm_parallel *parallel)
{
    const size_t all = pm_map_count(map), some = (size_t)ceil(fraction * (double)all);
    *carriers = (pm__carriers){.count = some < all ? some : all};
    uint32_t *const number_of = pm__alloc(all, sizeof *number_of);
    pm_photon *const photons = pm__alloc(carriers->count, sizeof *photons);
    carriers->number = pm__alloc(carriers->count, sizeof *carriers->number);
    if (normals)
        carriers->normals = pm__alloc(carriers->count, sizeof *carriers->normals);
    pm_status status = PM_ENOMEM;
    if (number_of && photons && carriers->number && (!normals || carriers->normals))
        status = fill(carriers, map, normals, parallel, number_of, photons);
    free(number_of);
    free(photons);
    if (status != PM_OK)
        pm__carriers_destroy(carriers);
    return status;
}

void pm__carriers_destroy(pm__carriers *carriers)
{
    pm_map_destroy(carriers->map);
    free(carriers->number);
    free(carriers->normals);
    *carriers = (pm__carriers){0};
}

/* 5.4.1: the nearest photon "with a surface normal similar to" the query's. */
bool pm__similar_normals(const float a[3], const float b[3])
{
    double x[3] = {(double)a[0], (double)a[1], (double)a[2]}, y[3] = {(double)b[0], (double)b[1], (double)b[2]};
    (void)pm__normalize(x);
    (void)pm__normalize(y);
    return pm__dot(x, y) > 0.9;
}

pm_status pm__nearest_carrier(const pm__carriers *carriers, const pm_query *query, pm_workspace *workspace,
                              size_t *carrier)
{
    *carrier = SIZE_MAX;
    for (size_t k = 1, seen = 0;; k *= 8) {
        pm_query nearest = *query;
        nearest.k = k;
        nearest.sorted = true;
        nearest.search = NULL; /* the carriers' map has its own */
        size_t found = 0;
        pm_status status = pm__workspace_reserve_neighbors(workspace, k < carriers->count ? k : carriers->count);
        if (status == PM_OK)
            status = pm_map_search(carriers->map, &nearest, workspace->neighbors, workspace->neighbor_capacity, &found);
        if (status != PM_OK)
            return status;
        for (; seen < found; seen++) {
            const uint32_t source = pm_map_source(carriers->map, workspace->neighbors[seen].number);
            if (!carriers->normals || pm__similar_normals(carriers->normals[source], query->normal)) {
                *carrier = source;
                return PM_OK;
            }
        }
        if (found < k)
            return PM_OK;
    }
}

pm_query pm__carrier_query(const pm__carriers *carriers, const pm_map *map, const pm_query *lookup, size_t index)
{
    const pm_photon photon = pm_map_photon(map, carriers->number[index]);
    pm_query query = *lookup;
    memcpy(query.position, photon.position, sizeof query.position);
    if (carriers->normals) {
        memcpy(query.normal, carriers->normals[index], sizeof query.normal);
    } else {
        query.shape = PM_LOOKUP_SPHERE;
        query.front_only = false;
    }
    return query;
}
