/* From a public query to an estimator's neighbours. */
#ifndef PM_LOOKUP_LOOKUP_H
#define PM_LOOKUP_LOOKUP_H

#include "../../estimators/estimator.h"
#include "../search/search.h"

/* Checks a public query and puts it into the map's frame. EINVAL: NaN, a negative radius, k = 0 without a limit,
 * a zero normal where one is needed, a side asked of a map without directions. */
pm_status pm__query_prepare(const pm_map *map, const pm_query *query, pm__query *prepared, pm_error *error);

/* Map units from the centre: no sum of three squares overflows. */
static const double pm__frame_limit = 1e18;

/* A coordinate, m, in the map's frame: a float, brought nearer where it is beyond the limit. */
static inline float pm__in_frame(const pm_map *map, int axis, float x)
{
    const double limit = pm__frame_limit, framed = ((double)x - map->centre[axis]) * map->inverse_unit;
    const double above = framed > -limit ? framed : -limit;
    return (float)(above < limit ? above : limit);
}

/* The search that a query is for: NULL where the map has no structure for it, or it cannot do what is asked. */
const pm_search *pm__search_of(const pm_map *map, const pm_query *query);

/* Runs a prepared query into a buffer of `capacity`; unsorted. Returns how many were found (above capacity only with
 * k = 0; then the buffer is of no use). */
size_t pm__run_search(const pm_map *map, const pm_search *search, const pm__query *query, pm_neighbor *neighbors,
                      size_t capacity);

/* All photons within the radius of each of up to PM__AT_ONCE queries, [i * stride] on those of query i, unsorted, by
 * the map's own search: for many queries whose points are finite and whose normals are unit, neither of which is looked
 * at again. Spheres; k and search are not looked at. counts[i] above stride: there are so many, and what is in query
 * i's room is undefined. EINVAL: no radius, a side where no directions are kept. */
enum { PM__AT_ONCE = 16 };
pm_status pm__search_within(const pm_map *map, const pm_query *queries, size_t count, pm_neighbor *neighbors,
                            size_t stride, size_t *counts);

/* Sorts by (distance2, caller's index). O(n log n) for any input. */
void pm__sort_neighbors(const pm_map *map, pm_neighbor *neighbors, size_t count);

/* An estimator with its parameters: a pm_estimator from outside. */
struct pm_estimator {
    pm__spec spec;
    char name[PM__MAX_SPEC];
};

static inline const pm__estimator *pm__estimator_of(const pm__spec *spec)
{
    return (const pm__estimator *)(const void *)spec->entry;
}

/* How many maps a spec draws from, and the share of k that falls to map m of them. */
size_t pm__map_count_of(const pm__spec *spec);
size_t pm__share(size_t k, size_t maps, size_t m);

/* Buffers for one thread. The arrays hold the photons of all sets of a lookup, one set behind the other. */
struct pm_workspace {
    pm_neighbor *neighbors; /* of the search under way */
    float *distance2;
    float (*flux)[3];
    float (*offset)[3];
    size_t neighbor_capacity, capacity;
    pm__neighbors *sets;
    size_t *first; /* where in the arrays a set starts */
    size_t set_capacity;
    void *scratch; /* of the estimator at work */
    size_t scratch_size;
};

/* Room for so many photons of all sets and so many sets; what is there stays. */
pm_status pm__workspace_reserve(pm_workspace *workspace, size_t photons, size_t sets);

/* Room for so many neighbours of one search; what is there is lost. */
pm_status pm__workspace_reserve_neighbors(pm_workspace *workspace, size_t count);

/* What is gathered beside distances and flux. */
typedef struct pm__gathering {
    const pm_source *source; /* for its BRDF; NULL: none */
    double unit;             /* m in the lookup's unit of length */
    bool sorted;
    bool offsets;
} pm__gathering;

/* Looks up `query` in a map and gathers its photons as set number `set`, behind the sets before it. Sets are gathered
 * in order; when all are there pm__point_sets makes their pointers valid. EINVAL also where a BRDF is to be applied to
 * photons without directions. */
pm_status pm__gather(const pm_map *map, const pm_query *query, const pm__gathering *gathering,
                     pm_workspace *workspace, size_t set);
/* The same, as the only set, from neighbours that a search for this query has found; they may be sorted. */
pm_status pm__gather_found(const pm_map *map, const pm_query *query, pm_neighbor *neighbors, size_t count,
                           const pm__gathering *gathering, pm_workspace *workspace);
void pm__point_sets(pm_workspace *workspace, size_t set_count, bool offsets);

/* Evaluates a spec on gathered sets, with the workspace's scratch: 0 where all are empty. */
pm_status pm__evaluate(const pm__spec *spec, const pm__lookup *lookup, pm_workspace *workspace, double result[3]);

/* The estimate at a query from what is stored at photons ([C02] 5.4). */
pm_status pm__precomputed_lookup(const pm_precomputed *precomputed, const pm_query *query, pm_workspace *workspace,
                                 pm_estimation *estimation);

#endif
