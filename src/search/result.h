/* Measuring photons and keeping the best: shared by every search so that all round alike. */
#ifndef PM_SEARCH_RESULT_H
#define PM_SEARCH_RESULT_H

#include "search.h"

/* Is a farther than b? Equal distances: the higher caller's index is farther. */
static inline bool pm__farther(const uint32_t *ids, pm_neighbor a, pm_neighbor b)
{
    if (a.distance2 != b.distance2)
        return a.distance2 > b.distance2;
    return ids[a.number] > ids[b.number];
}

/* The query's distance2 to a position, or NAN where its shape rejects it. The sums of squares are ordered so that
 * distance2 >= (difference along any axis)^2 holds after rounding: pruning by planes is exact. */
static inline float pm__measure(const pm__query *query, const float position[3])
{
    const float d[3] = {position[0] - query->position[0], position[1] - query->position[1],
                        position[2] - query->position[2]};
    const float distance2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (query->shape == PM_LOOKUP_SPHERE)
        return distance2;
    const float *const n = query->normal;
    const float height = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
    if (query->shape == PM_LOOKUP_ELLIPSOID)
        return distance2 + query->squash * (height * height);
    if (!(fabsf(height) <= query->half_height))
        return NAN;
    const float t[3] = {d[0] - height * n[0], d[1] - height * n[1], d[2] - height * n[2]};
    return t[0] * t[0] + t[1] * t[1] + t[2] * t[2];
}

/* Did photon `number` arrive at the front ([C02] 2.1.3)? */
static inline bool pm__in_front(const pm_map *map, const pm__query *query, size_t number)
{
    const float *const w = pm__direction(map, number), *const n = query->normal;
    return w[0] * n[0] + w[1] * n[1] + w[2] * n[2] < 0.0f;
}

/* May anything beyond a plane at this squared distance be wanted? */
static inline bool pm__reaches(const pm__query *query, const pm__result *result, float plane_distance2)
{
    return plane_distance2 * query->prune_scale <= result->bound + query->prune_slack;
}

/* Puts item in the place of the heap's node i and lets it sink. */
static inline void pm__sift_down(pm__result *result, size_t i, pm_neighbor item)
{
    pm_neighbor *const heap = result->list;
    for (size_t child = 2 * i + 1; child < result->count; child = 2 * i + 1) {
        if (child + 1 < result->count && pm__farther(result->ids, heap[child + 1], heap[child]))
            child++;
        if (!pm__farther(result->ids, heap[child], item))
            break;
        heap[i] = heap[child];
        i = child;
    }
    heap[i] = item;
}

/* Keeps a photon that lies within the bound. The bound shrinks only once k photons are held (errata 15). */
static inline void pm__keep(const pm__query *query, pm__result *result, float distance2, uint32_t number)
{
    const pm_neighbor item = {distance2, number};
    if (!query->k) {
        if (result->count == result->capacity && result->deliver && result->count) {
            result->stopped = result->stopped || !result->deliver(result->context, result->list, result->count);
            result->count = 0;
        }
        if (result->count < result->capacity)
            result->list[result->count] = item;
        result->count++;
        return;
    }
    if (result->count < query->k) {
        result->list[result->count++] = item;
        if (result->count < query->k)
            return;
        for (size_t i = result->count / 2; i-- > 0;) /* the heap is only made now: [C02] 2.3.4 */
            pm__sift_down(result, i, result->list[i]);
    } else {
        if (!pm__farther(result->ids, result->list[0], item))
            return;
        pm__sift_down(result, 0, item);
    }
    result->bound = result->list[0].distance2;
}

/* Offers a photon at a position. Its direction is only read once its distance is good enough. */
static inline void pm__offer(const pm_map *map, const pm__query *query, pm__result *result, const float position[3],
                             uint32_t number)
{
    const float distance2 = pm__measure(query, position);
    if (distance2 <= result->bound && (!query->front_only || pm__in_front(map, query, number)))
        pm__keep(query, result, distance2, number);
}

static inline void pm__offer_node(const pm_map *map, const pm__query *query, pm__result *result, const pm__node *node)
{
    pm__offer(map, query, result, node->position, pm__node_number(node));
}

#endif
