/* What a search is. A search knows geometry only: positions, and for the front-side filter directions.
 *
 * Contract of `find`: leaves in `result` exactly the query's neighbours - those with the smallest
 * (distance2, caller's index) among the photons that pm__measure and pm__in_front accept - in any order, result->count
 * of them. All searches measure with the same operations in the same order, so all agree to the last bit. */
#ifndef PM_SEARCH_SEARCH_H
#define PM_SEARCH_SEARCH_H

#include "../base/param.h"
#include "../map/map.h"

#include <math.h>

/* A query in the map's units, checked and prepared. */
typedef struct pm__query {
    float position[3];
    float normal[3];      /* unit */
    size_t k;             /* 0: fixed radius */
    float max_distance2;  /* inclusive */
    float squash;         /* ellipsoid: shape_parameter^2 - 1, else 0 */
    float half_height;    /* disc: |height| <= this, else infinite */
    float prune_scale;    /* what lies beyond a plane at squared distance p2 is not wanted where */
    float prune_slack;    /* p2 * prune_scale > bound + prune_slack: 1 and 0 but for the disc */
    pm_lookup_shape shape;
    bool front_only;
} pm__query;

/* Neighbours so far. k > 0: a max-heap of at most k, `bound` the distance2 beyond which nothing is wanted.
 * k = 0: a plain list; where it is full it is delivered, or, with nobody to deliver to, count goes on past capacity. */
typedef struct pm__result {
    pm_neighbor *list;
    size_t count, capacity;
    float bound; /* inclusive: equal distances may still win by their index */
    const uint32_t *ids;
    pm_deliver deliver; /* NULL: none */
    void *context;
    bool stopped; /* deliver wants no more */
} pm__result;

struct pm_search {
    pm__entry entry;
    pm__structure_id structure;
    bool radius_only;
    /* What a new map's structure is still to be told that takes a search; NULL: nothing. */
    pm_status (*finish)(const pm_map *map, const pm_parallel *parallel);
    void (*find)(const pm_map *map, const pm__query *query, pm__result *result);
    /* Several at once; NULL: one by one. */
    void (*find_batch)(const pm_map *map, const pm__query *queries, pm__result *results, size_t count);
    size_t batch; /* how many find_batch takes */
};

extern const pm__catalogue pm__searches;

#endif
