/* The bench's own judge: it accepts right answers, and a peer that is planted to be wrong is found out. */
#include "../../bench/exactness.h"
#include "../../bench/workloads.h"
#include "../test.h"

#include <stdlib.h>
#include <string.h>

enum { COUNT = 2000, K = 20, STRIDE = COUNT + 16 };

static pm_photon photons[COUNT];
static pm_surface_point points[COUNT];
static pm_query queries[COUNT];

/* What the planted peer does wrong. */
typedef enum fault { NONE, FARTHER, TWICE, FEWER, UNKNOWN, MISSES_AT_RADIUS } fault;

static fault planted;

static void *build(const float (*p)[3], size_t count, size_t threads)
{
    (void)p;
    (void)count;
    (void)threads;
    pm_map *map = NULL;
    ck_assert_int_eq(pm_map_create(photons, COUNT, NULL, &map, NULL), PM_OK);
    return map;
}

static void destroy(void *index)
{
    pm_map_destroy(index);
}

static size_t ask(void *index, pm_query *query, uint32_t *ids, size_t capacity)
{
    pm_neighbor *const found = malloc(COUNT * sizeof *found);
    size_t count = 0;
    ck_assert_int_eq(pm_map_search(index, query, found, COUNT, &count), PM_OK);
    ck_assert_uint_le(count, capacity);
    for (size_t i = 0; i < count; i++)
        ids[i] = pm_map_source(index, found[i].number);
    free(found);
    return count;
}

static size_t nearest(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    pm_query query;
    uint32_t all[K + 1];
    (void)distances2;
    pm_query_init(&query);
    memcpy(query.position, point, sizeof query.position);
    query.k = k + 1;
    (void)ask(index, &query, all, K + 1);
    memcpy(ids, all, k * sizeof *ids);
    if (planted == FARTHER)
        ids[k - 1] = all[k];
    if (planted == TWICE)
        ids[0] = ids[1];
    if (planted == UNKNOWN)
        ids[0] = COUNT;
    return planted == FEWER ? k - 1 : k;
}

static size_t within(void *index, const float point[3], float radius, size_t capacity, uint32_t *ids)
{
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, point, sizeof query.position);
    query.k = 0;
    query.max_radius = radius;
    const size_t count = ask(index, &query, ids, capacity);
    return planted == MISSES_AT_RADIUS && count ? count - 1 : count;
}

static const pm__peer peer = {"planted", "", false, build, destroy, nearest, within, NULL};

static bool judge(size_t k, float radius, fault what)
{
    char detail[160];
    bool exact = false;
    pm__reference reference;
    const pm__workload *const square = (const pm__workload *)(const void *)pm__find(&pm__workloads, "square");
    pm__workload_photons(square, 1, COUNT, NULL, photons);
    pm__workload_queries(square, 1, COUNT, NULL, points);
    for (size_t i = 0; i < COUNT; i++) {
        pm_query_init(&queries[i]);
        memcpy(queries[i].position, points[i].position, sizeof queries[i].position);
        queries[i].k = k;
        queries[i].max_radius = radius;
    }
    pm__bench_index index = {.contender = {NULL, &peer}, .foreign = build(NULL, 0, 1)};
    planted = what;
    ck_assert_int_eq(pm__reference_create(index.foreign, photons, COUNT, queries, COUNT, STRIDE, NULL, &reference),
                     PM_OK);
    ck_assert_int_eq(pm__exactness_check(&reference, &index, 1, &exact, detail), PM_OK);
    ck_assert_int_eq(exact, *detail == '\0');
    pm__reference_destroy(&reference);
    pm__bench_index_destroy(&index);
    return exact;
}

START_TEST(test_right_answers_pass)
{
    ck_assert(judge(K, INFINITY, NONE));
    ck_assert(judge(0, 0.1f, NONE));
    ck_assert(judge(0, 1e-9f, NONE)); /* nothing found anywhere */
}
END_TEST

START_TEST(test_planted_faults_are_found)
{
    ck_assert(!judge(K, INFINITY, FARTHER));
    ck_assert(!judge(K, INFINITY, TWICE));
    ck_assert(!judge(K, INFINITY, FEWER));
    ck_assert(!judge(K, INFINITY, UNKNOWN));
    ck_assert(!judge(0, 0.1f, MISSES_AT_RADIUS));
}
END_TEST

PM_TEST_MAIN("exactness", test_right_answers_pass, test_planted_faults_are_found)
