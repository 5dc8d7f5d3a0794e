/* Public queries: checked, brought into the map's frame, run. */
#include "lookup.h"

#include "../base/status.h"
#include "../base/vec3.h"

#include <float.h>

void pm_query_init(pm_query *query)
{
    *query = (pm_query){.normal = {0.0f, 0.0f, 1.0f},
                        .k = 50,
                        .max_radius = INFINITY,
                        .shape = PM_LOOKUP_SPHERE,
                        .shape_parameter = 1.0f,
                        .sorted = true};
}

static float squared(double x)
{
    const double square = x * x;
    return (float)(square < (double)FLT_MAX ? square : (double)FLT_MAX);
}

static pm_status prepare_shape(const pm_map *map, const pm_query *query, pm__query *prepared, pm_error *error)
{
    const double parameter = (double)query->shape_parameter;
    prepared->prune_scale = 1.0f;
    switch (query->shape) {
    case PM_LOOKUP_SPHERE:
        return PM_OK;
    case PM_LOOKUP_ELLIPSOID:
        if (!(parameter >= 1.0 && parameter <= 1e9))
            return pm__fail(error, PM_EINVAL, "the ellipsoid's squash is %g: it lies in 1 to 1e9", parameter);
        prepared->squash = (float)(parameter * parameter - 1.0);
        return PM_OK;
    case PM_LOOKUP_DISC:
        if (!(parameter >= 0.0))
            return pm__fail(error, PM_EINVAL, "the disc's half height is %g m: it is at least 0", parameter);
        /* Tangential distances are differences, so they round; the slack keeps pruning on the safe side. */
        prepared->half_height = (float)fmin(parameter * map->inverse_unit, (double)FLT_MAX);
        prepared->prune_scale = 1.0f - 1e-5f;
        prepared->prune_slack = squared((double)prepared->half_height * (1.0 + 1e-5));
        return PM_OK;
    }
    return pm__fail(error, PM_EINVAL, "lookup shape %d is none", (int)query->shape);
}

/* The squared limit of a lookup by radius from `position`, in the map's frame. A query beyond pm__frame_limit is looked
 * up from there; photons, which lie within 1 of the centre, are then all within the radius, or none is. */
static float limit_of(const pm_map *map, const pm_query *query, const float position[3])
{
    const double radius = (double)query->max_radius * map->inverse_unit;
    const float largest = fmaxf(fabsf(position[0]), fmaxf(fabsf(position[1]), fabsf(position[2])));
    if (largest < (float)pm__frame_limit)
        return squared(radius);
    double reach = 0.0;
    for (int a = 0; a < 3; a++)
        reach = fmax(reach, fabs(((double)query->position[a] - map->centre[a]) * map->inverse_unit));
    return radius < reach ? 0.0f : FLT_MAX;
}

static bool finite3(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

pm_status pm__query_prepare(const pm_map *map, const pm_query *query, pm__query *prepared, pm_error *error)
{
    const double radius = (double)query->max_radius;
    if (!finite3(query->position))
        return pm__fail(error, PM_EINVAL, "the query's position is not finite");
    if (!(radius >= 0.0))
        return pm__fail(error, PM_EINVAL, "the maximum radius is %g m: it is at least 0", radius);
    if (!query->k && isinf(radius))
        return pm__fail(error, PM_EINVAL, "a query needs a k or a finite radius");
    if (query->front_only && !pm__has_directions(map))
        return pm__fail(error, PM_EINVAL, "the map keeps no directions, so no photon has a side");
    *prepared = (pm__query){.k = query->k < map->count ? query->k : map->count,
                            .shape = query->shape,
                            .front_only = query->front_only};
    if (query->k && !prepared->k)
        prepared->k = 1; /* an empty map: any k will do, 0 would mean a fixed radius */
    for (int a = 0; a < 3; a++)
        prepared->position[a] = pm__in_frame(map, a, query->position[a]);
    prepared->max_distance2 = limit_of(map, query, prepared->position);
    if (query->front_only || query->shape != PM_LOOKUP_SPHERE) {
        double n[3] = {(double)query->normal[0], (double)query->normal[1], (double)query->normal[2]};
        if (!finite3(query->normal) || !(pm__normalize(n) > 0.0))
            return pm__fail(error, PM_EINVAL, "the query's normal has no direction");
        for (int a = 0; a < 3; a++)
            prepared->normal[a] = (float)n[a];
    }
    return prepare_shape(map, query, prepared, error);
}

const pm_search *pm__search_of(const pm_map *map, const pm_query *query)
{
    const pm_search *const search = query->search ? query->search : map->search;
    if (search->structure != PM__NO_STRUCTURE && !map->index[search->structure])
        return NULL;
    return search->radius_only && query->k ? NULL : search;
}

size_t pm__run_search(const pm_map *map, const pm_search *search, const pm__query *query, pm_neighbor *neighbors,
                      size_t capacity)
{
    pm__result result = {.list = neighbors, .capacity = capacity, .bound = query->max_distance2, .ids = map->ids};
    search->find(map, query, &result);
    return result.count;
}

pm_status pm_map_search(const pm_map *map, const pm_query *query, pm_neighbor *neighbors, size_t capacity,
                        size_t *count)
{
    if (count)
        *count = 0;
    if (!map || !query || !count || (capacity && !neighbors))
        return PM_EINVAL;
    pm__query prepared;
    const pm_search *const search = pm__search_of(map, query);
    const pm_status status = pm__query_prepare(map, query, &prepared, NULL);
    if (status != PM_OK || !search)
        return search ? status : PM_EINVAL;
    if (prepared.k && map->count && capacity < prepared.k)
        return PM_EINVAL;
    *count = pm__run_search(map, search, &prepared, neighbors, capacity);
    if (*count > capacity)
        return PM_ETRUNCATED;
    if (query->sorted)
        pm__sort_neighbors(map, neighbors, *count);
    return PM_OK;
}

enum { BATCH = 32 };

/* Up to BATCH queries from the first on that the same search answers; how many are done, fewer where one failed. */
static size_t search_some(const pm_map *map, const pm_query *queries, size_t count, pm_neighbor *neighbors,
                          size_t stride, size_t *counts, pm_status *status)
{
    pm__query prepared[BATCH];
    pm__result results[BATCH];
    const pm_search *const search = pm__search_of(map, &queries[0]);
    const size_t most = search && search->batch > 1 ? search->batch : 1;
    size_t n = 0;
    *status = search ? PM_OK : PM_EINVAL;
    for (; n < count && n < most && *status == PM_OK && pm__search_of(map, &queries[n]) == search; n++) {
        *status = pm__query_prepare(map, &queries[n], &prepared[n], NULL);
        if (*status == PM_OK && prepared[n].k && map->count && stride < prepared[n].k)
            *status = PM_EINVAL;
        if (*status != PM_OK)
            break;
        results[n] = (pm__result){.list = neighbors + n * stride, .capacity = stride,
                                  .bound = prepared[n].max_distance2, .ids = map->ids};
    }
    if (n == 1 || !search || !search->find_batch)
        for (size_t i = 0; i < n; i++)
            search->find(map, &prepared[i], &results[i]);
    else
        search->find_batch(map, prepared, results, n);
    for (size_t i = 0; i < n; i++) {
        counts[i] = results[i].count;
        if (counts[i] > stride) {
            *status = PM_ETRUNCATED;
            return i + 1;
        }
        if (queries[i].sorted)
            pm__sort_neighbors(map, results[i].list, counts[i]);
    }
    return n;
}

pm_status pm_map_search_batch(const pm_map *map, const pm_query *queries, size_t query_count, pm_neighbor *neighbors,
                              size_t stride, size_t *counts)
{
    for (size_t i = 0; i < query_count && counts; i++)
        counts[i] = 0;
    if (!map || (query_count && (!queries || !counts || (stride && !neighbors))))
        return PM_EINVAL;
    pm_status status = PM_OK;
    for (size_t done = 0; done < query_count && status == PM_OK;)
        done += search_some(map, queries + done, query_count - done, neighbors + done * stride, stride, counts + done,
                            &status);
    return status;
}

pm_status pm__search_within(const pm_map *map, const pm_query *queries, size_t count, pm_neighbor *neighbors,
                            size_t stride, size_t *counts)
{
    pm__query prepared[PM__AT_ONCE];
    pm__result results[PM__AT_ONCE];
    const pm_search *const search = map->search;
    for (size_t i = 0; i < count; i++) {
        const pm_query *const query = &queries[i];
        if (!(query->max_radius >= 0.0f) || (query->front_only && !pm__has_directions(map)))
            return PM_EINVAL;
        prepared[i] = (pm__query){.prune_scale = 1.0f, .front_only = query->front_only};
        for (int a = 0; a < 3; a++) {
            prepared[i].position[a] = pm__in_frame(map, a, query->position[a]);
            prepared[i].normal[a] = query->normal[a];
        }
        prepared[i].max_distance2 = limit_of(map, query, prepared[i].position);
        results[i] = (pm__result){.list = neighbors + i * stride, .capacity = stride,
                                  .bound = prepared[i].max_distance2, .ids = map->ids};
    }
    if (search->find_batch && search->batch >= count)
        search->find_batch(map, prepared, results, count);
    else
        for (size_t i = 0; i < count; i++)
            search->find(map, &prepared[i], &results[i]);
    for (size_t i = 0; i < count; i++)
        counts[i] = results[i].count;
    return PM_OK;
}

pm_status pm_map_search_each(const pm_map *map, const pm_query *query, pm_deliver deliver, void *context)
{
    if (!map || !query || !deliver)
        return PM_EINVAL;
    pm_query all = *query;
    all.k = 0;
    pm__query prepared;
    const pm_search *const search = pm__search_of(map, &all);
    const pm_status status = pm__query_prepare(map, &all, &prepared, NULL);
    if (status != PM_OK || !search)
        return search ? status : PM_EINVAL;
    pm_neighbor block[1024];
    pm__result result = {.list = block, .capacity = sizeof block / sizeof *block, .bound = prepared.max_distance2,
                         .ids = map->ids, .deliver = deliver, .context = context};
    search->find(map, &prepared, &result);
    if (result.count && !result.stopped)
        (void)deliver(context, block, result.count);
    return PM_OK;
}

/* Roots are taken one by one below, so that no product of numbers like these over- or underflows. */
static bool is_positive(double x)
{
    return x > 0.0 && isfinite(x);
}

double pm_max_radius_surface(size_t n, double max_power, double threshold)
{
    const double pi = 3.14159265358979323846;
    if (!(is_positive(max_power) && is_positive(threshold)))
        return 0.0;
    return fmin(sqrt((double)n) * sqrt(max_power) / sqrt(threshold) / pi, DBL_MAX); /* [C02] 5.2.3 */
}

double pm_max_radius_volume(size_t n, double max_power, double sigma, double threshold)
{
    const double pi = 3.14159265358979323846;
    if (!(is_positive(max_power) && is_positive(threshold) && is_positive(sigma)))
        return 0.0;
    const double radius = cbrt(3.0 * (double)n / (16.0 * pi * pi)) * cbrt(max_power) / cbrt(sigma) / cbrt(threshold);
    return fmin(radius, DBL_MAX); /* [C02] 5.2.4, errata 44 */
}
