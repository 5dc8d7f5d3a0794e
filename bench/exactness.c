#include "exactness.h"

#include "../src/base/memory.h"
#include "../src/base/parallel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double tolerance = 4.0 * 0x1p-23; /* 4 float ulp, relative */

static int compare_ids(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double distance_to(const pm_photon *photon, const pm_query *query)
{
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double d = (double)photon->position[a] - (double)query->position[a];
        sum += d * d;
    }
    return sqrt(sum);
}

/* The k least in a max-heap. */
static void sink(double *heap, size_t count, size_t i)
{
    const double item = heap[i];
    for (size_t child = 2 * i + 1; child < count; child = 2 * i + 1) {
        child += child + 1 < count && heap[child + 1] > heap[child];
        if (heap[child] <= item)
            break;
        heap[i] = heap[child];
        i = child;
    }
    heap[i] = item;
}

static size_t least(const pm__reference *r, const pm_query *query, double *list)
{
    size_t count = 0;
    for (size_t i = 0; i < r->photon_count; i++) {
        const double distance = distance_to(&r->photons[i], query);
        if (count < query->k) {
            list[count++] = distance;
            if (count == query->k)
                for (size_t j = count / 2; j-- > 0;)
                    sink(list, count, j);
        } else if (distance < list[0]) {
            list[0] = distance;
            sink(list, count, 0);
        }
    }
    return count;
}

static size_t near(const pm__reference *r, const pm_query *query, double *list)
{
    const double limit = (double)query->max_radius * (1.0 + tolerance);
    size_t count = 0;
    for (size_t i = 0; i < r->photon_count && count < r->stride; i++) {
        const double distance = distance_to(&r->photons[i], query);
        if (distance <= limit)
            list[count++] = distance;
    }
    return count;
}

static void loop(void *argument, size_t q)
{
    pm__reference *const r = argument;
    const pm_query *const query = &r->queries[q];
    double *const list = &r->distances[q * r->stride];
    r->distance_counts[q] = query->k ? least(r, query, list) : near(r, query, list);
    qsort(list, r->distance_counts[q], sizeof *list, compare_doubles);
}

static bool is_plain(const pm_query *query)
{
    return query->shape == PM_LOOKUP_SPHERE && !query->front_only;
}

static pm_status ask_brute(const pm_map *map, pm__reference *r)
{
    pm_neighbor *const neighbors = pm__alloc(r->stride, sizeof *neighbors);
    pm_status status = neighbors ? PM_OK : PM_ENOMEM;
    for (size_t q = 0; q < PM__CHECKED_QUERIES && status == PM_OK; q++) {
        pm_query query = r->queries[q];
        query.search = pm_search_find("brute");
        status = pm_map_search(map, &query, neighbors, r->stride, &r->counts[q]);
        for (size_t i = 0; i < r->counts[q] && status == PM_OK; i++)
            r->ids[q * r->stride + i] = pm_map_source(map, neighbors[i].number);
        if (status == PM_OK)
            qsort(&r->ids[q * r->stride], r->counts[q], sizeof *r->ids, compare_ids);
    }
    free(neighbors);
    return status;
}

pm_status pm__reference_create(const pm_map *map, const pm_photon *photons, size_t photon_count,
                               const pm_query *queries, size_t query_count, size_t stride, const pm_parallel *parallel,
                               pm__reference *reference)
{
    pm__reference *const r = reference;
    /* A loop in double may find a few at the radius that float leaves out. */
    *r = (pm__reference){.photons = photons, .photon_count = photon_count, .stride = stride + stride / 8 + 64};
    r->ids = pm__alloc(PM__CHECKED_QUERIES * r->stride, sizeof *r->ids);
    r->distances = pm__alloc(PM__CHECKED_QUERIES * r->stride, sizeof *r->distances);
    if (!r->ids || !r->distances)
        return PM_ENOMEM;
    for (size_t q = 0; q < PM__CHECKED_QUERIES; q++)
        r->queries[q] = queries[q * query_count / PM__CHECKED_QUERIES];
    if (is_plain(&r->queries[0]))
        pm__for(parallel, PM__CHECKED_QUERIES, loop, r);
    return ask_brute(map, r);
}

void pm__reference_destroy(pm__reference *reference)
{
    free(reference->ids);
    free(reference->distances);
    reference->ids = NULL;
    reference->distances = NULL;
}

double pm__reference_mean_count(const pm__reference *reference)
{
    double sum = 0.0;
    for (size_t q = 0; q < PM__CHECKED_QUERIES; q++)
        sum += (double)reference->counts[q];
    return sum / PM__CHECKED_QUERIES;
}

/* ids are ascending. */
static bool distinct_and_known(const pm__reference *r, const uint32_t *ids, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (ids[i] >= r->photon_count || (i && ids[i] == ids[i - 1]))
            return false;
    return true;
}

/* At a radius, what lies within the tolerance of it may be in or out. */
static bool right_count(const pm__reference *r, size_t q, size_t count)
{
    const double *const want = &r->distances[q * r->stride];
    const size_t most = r->distance_counts[q];
    size_t fewest = most;
    if (r->queries[q].k)
        return count == most;
    while (fewest > 0 && want[fewest - 1] > (double)r->queries[q].max_radius * (1.0 - tolerance))
        fewest--;
    return count >= fewest && count <= most;
}

static bool right_distances(const pm__reference *r, size_t q, const uint32_t *ids, size_t count, double *scratch)
{
    for (size_t i = 0; i < count; i++)
        scratch[i] = distance_to(&r->photons[ids[i]], &r->queries[q]);
    qsort(scratch, count, sizeof *scratch, compare_doubles);
    for (size_t i = 0; i < count; i++) {
        const double want = r->distances[q * r->stride + i];
        if (!(fabs(scratch[i] - want) <= tolerance * want))
            return false;
    }
    return true;
}

/* What is wrong with the answer to query q, or NULL. Sorts ids. */
static const char *fault(const pm__reference *r, size_t q, bool own, uint32_t *ids, size_t count, double *scratch)
{
    qsort(ids, count, sizeof *ids, compare_ids);
    if (!distinct_and_known(r, ids, count))
        return "a photon twice, or one that does not exist";
    if (own && (count != r->counts[q] || memcmp(ids, &r->ids[q * r->stride], count * sizeof *ids) != 0))
        return "not the photons that brute force finds";
    if (!is_plain(&r->queries[q]))
        return NULL;
    if (!right_count(r, q, count))
        return "not as many photons as brute force finds";
    return right_distances(r, q, ids, count, scratch) ? NULL : "not the distances that brute force finds";
}

static pm_status check_all(const pm__reference *r, pm__asker *asker, uint32_t *ids, double *scratch, bool *exact,
                           char detail[160])
{
    size_t counts[PM__CHECKED_QUERIES];
    pm_status status = PM_OK;
    for (size_t first = 0; first < PM__CHECKED_QUERIES && status == PM_OK && *exact; first += asker->batch) {
        status = pm__asker_collect(asker, first, asker->batch, ids, r->stride, counts);
        for (size_t i = 0; i < asker->batch && status == PM_OK && *exact; i++) {
            const char *const what =
                fault(r, first + i, asker->index->map != NULL, &ids[i * r->stride], counts[i], scratch);
            *exact = !what;
            if (what)
                (void)snprintf(detail, 160, "checked query %zu: %s", first + i, what);
        }
    }
    return status;
}

pm_status pm__exactness_check(const pm__reference *reference, const pm__bench_index *index, size_t batch, bool *exact,
                              char detail[160])
{
    pm__asker asker;
    uint32_t *const ids = pm__alloc(batch * reference->stride, sizeof *ids);
    double *const scratch = pm__alloc(reference->stride, sizeof *scratch);
    pm_status status =
        pm__asker_init(&asker, index, reference->queries, PM__CHECKED_QUERIES, batch, reference->stride);
    *exact = true;
    *detail = '\0';
    if (status == PM_OK)
        status = ids && scratch ? check_all(reference, &asker, ids, scratch, exact, detail) : PM_ENOMEM;
    if (status == PM_ETRUNCATED) { /* more than brute force finds: a fault, not a failure */
        *exact = false;
        (void)snprintf(detail, 160, "more photons than brute force finds");
        status = PM_OK;
    }
    pm__asker_free(&asker);
    free(ids);
    free(scratch);
    return status;
}
