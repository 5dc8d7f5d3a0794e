/* Maps without directions: the same neighbours and estimates as with them, less memory, and a refusal wherever a
 * direction would be read. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/map/grown.h"
#include "../../src/map/structure.h"
#include "../../src/search/search.h"
#include "../test.h"

#include <malloc.h>
#include <string.h>

enum { COUNT = 3000, QUERIES = 40, K = 30 };

/* On three faces of a unit cube; some share a place, so that ties abound. Directions are of any length. */
static pm_photon *random_photons(size_t count)
{
    pm_photon *const photons = pm__alloc(count, sizeof *photons);
    ck_assert_ptr_nonnull(photons);
    for (size_t i = 0; i < count; i++) {
        double u[9];
        pm__random_uniform(11, PM__FOR_TESTS, 0, i % 7 ? i : i / 2, u, 9);
        for (int a = 0; a < 3; a++) {
            photons[i].position[a] = i % 3 == (size_t)a ? 0.0f : (float)u[a];
            photons[i].direction[a] = (float)(u[3 + a] - 0.5);
            photons[i].power[a] = (float)u[6 + a];
        }
    }
    return photons;
}

typedef struct pair {
    pm_photon *photons;
    pm_map *full, *bare; /* the same photons with directions, and without */
} pair;

static pair create(size_t count, const pm_search *search, pm_simd simd)
{
    pair p = {.photons = random_photons(count)};
    pm_map_options options = {.search = search, .simd = simd};
    pm_error error;
    PM_CHECK_OK(pm_map_create(p.photons, count, &options, &p.full, &error), error);
    options.no_directions = true;
    PM_CHECK_OK(pm_map_create(p.photons, count, &options, &p.bare, &error), error);
    PM_CHECK_OK(pm_map_check(p.bare, &error), error);
    return p;
}

static void destroy(pair *p)
{
    pm_map_destroy(p->full);
    pm_map_destroy(p->bare);
    free(p->photons);
}

static const pm_search *search_at(size_t s)
{
    return pm_search_find(pm__searches.entries[s]->name);
}

static pm_query query_at(size_t i, const pm_search *search)
{
    static const pm_lookup_shape shapes[] = {PM_LOOKUP_SPHERE, PM_LOOKUP_ELLIPSOID, PM_LOOKUP_DISC};
    static const float parameters[] = {1.0f, 3.0f, 0.02f};
    double u[6];
    pm_query query;
    pm_query_init(&query);
    pm__random_uniform(11, PM__FOR_TESTS, 1, i, u, 6);
    for (int a = 0; a < 3; a++) {
        query.position[a] = i % 3 == (size_t)a ? 0.0f : (float)u[a];
        query.normal[a] = (float)(u[3 + a] - 0.5);
    }
    query.shape = shapes[i / 3 % 3];
    query.shape_parameter = parameters[i / 3 % 3];
    query.k = search->radius_only || i % 2 ? 0 : K;
    query.max_radius = query.k ? INFINITY : 0.15f;
    query.search = search;
    return query;
}

static size_t find(const pm_map *map, const pm_query *query, pm_neighbor *neighbors)
{
    size_t count = 0;
    ck_assert_int_eq(pm_map_search(map, query, neighbors, COUNT, &count), PM_OK);
    return count;
}

static void same_neighbors(const pm_map *full, const pm_map *bare, const pm_search *search)
{
    static pm_neighbor want[COUNT], got[COUNT], batch[QUERIES * COUNT];
    pm_query queries[QUERIES];
    size_t counts[QUERIES], found = 0;
    for (size_t i = 0; i < QUERIES; i++)
        queries[i] = query_at(i, search);
    ck_assert_int_eq(pm_map_search_batch(bare, queries, QUERIES, batch, COUNT, counts), PM_OK);
    for (size_t i = 0; i < QUERIES; i++) {
        const size_t count = find(full, &queries[i], want);
        ck_assert_uint_eq(find(bare, &queries[i], got), count);
        ck_assert_uint_eq(counts[i], count);
        ck_assert_mem_eq(got, want, count * sizeof *want);
        ck_assert_mem_eq(batch + i * COUNT, want, count * sizeof *want);
        found += count;
    }
    ck_assert_uint_gt(found, QUERIES * K / 4);
}

START_TEST(neighbors_are_the_same)
{
    for (size_t s = 0; s < pm__searches.count; s++) {
        pair p = create(COUNT, search_at(s), PM_SIMD_AUTO);
        same_neighbors(p.full, p.bare, search_at(s));
        for (uint32_t i = 0; i < COUNT; i++) {
            const pm_photon got = pm_map_photon(p.bare, i);
            pm_photon want = pm_map_photon(p.full, i);
            ck_assert_uint_eq(pm_map_source(p.bare, i), pm_map_source(p.full, i));
            memset(want.direction, 0, sizeof want.direction);
            ck_assert_mem_eq(&got, &want, sizeof got);
        }
        ck_assert(pm_map_max_power(p.bare) == pm_map_max_power(p.full));
        destroy(&p);
    }
}
END_TEST

/* `wide` in every width, and the structures that are added to its map. */
START_TEST(neighbors_are_the_same_in_maps_of_all_searches)
{
    for (int simd = PM_SIMD_AUTO; simd <= PM_SIMD_AVX512; simd++) {
        pm_map *probe = NULL;
        if (pm_map_create(NULL, 0, &(pm_map_options){.simd = (pm_simd)simd}, &probe, NULL) != PM_OK)
            continue; /* this processor has it not */
        pm_map_destroy(probe);
        pair p = create(COUNT, NULL, (pm_simd)simd);
        for (size_t s = 0; s < pm__searches.count; s++) {
            ck_assert_int_eq(pm_map_prepare(p.full, search_at(s), NULL, NULL), PM_OK);
            ck_assert_int_eq(pm_map_prepare(p.bare, search_at(s), NULL, NULL), PM_OK);
            same_neighbors(p.full, p.bare, search_at(s));
        }
        ck_assert_int_eq(pm_map_check(p.bare, NULL), PM_OK);
        destroy(&p);
    }
}
END_TEST

static bool deliver_none(void *context, const pm_neighbor *neighbors, size_t count)
{
    (void)neighbors;
    *(size_t *)context += count;
    return true;
}

static void refuses_sides(const pm_map *map, const pm_search *search)
{
    static pm_neighbor neighbors[3 * COUNT];
    pm_query queries[3] = {query_at(0, search), query_at(1, search), query_at(2, search)};
    size_t count = 1, counts[3] = {1, 1, 1}, delivered = 0;
    queries[1].front_only = true;
    ck_assert_int_eq(pm_map_search(map, &queries[1], neighbors, COUNT, &count), PM_EINVAL);
    ck_assert_uint_eq(count, 0);
    queries[1].max_radius = 0.1f;
    ck_assert_int_eq(pm_map_search_each(map, &queries[1], deliver_none, &delivered), PM_EINVAL);
    ck_assert_uint_eq(delivered, 0);
    ck_assert_int_eq(pm_map_search_batch(map, queries, 3, neighbors, COUNT, counts), PM_EINVAL);
    ck_assert_uint_eq(counts[1], 0);
    ck_assert_uint_eq(counts[2], 0);
    ck_assert_int_eq(pm_map_search_batch(map, queries, 1, neighbors, COUNT, counts), PM_OK);
    ck_assert(counts[0] > 0 || !pm_map_count(map));
}

START_TEST(sides_are_refused)
{
    static const size_t sizes[] = {COUNT, 1, 0};
    for (size_t s = 0; s < pm__searches.count; s++)
        for (size_t n = 0; n < 3; n++) {
            pair p = create(sizes[n], search_at(s), PM_SIMD_AUTO);
            if (n != 1) /* one photon may lie outside the radius */
                refuses_sides(p.bare, search_at(s));
            pm_query query = query_at(0, search_at(s));
            pm_neighbor neighbors[COUNT];
            size_t count;
            query.front_only = true;
            ck_assert_int_eq(pm_map_search(p.bare, &query, neighbors, COUNT, &count), PM_EINVAL);
            ck_assert_int_eq(pm_map_search(p.full, &query, neighbors, COUNT, &count), PM_OK);
            destroy(&p);
        }
}
END_TEST

static void half(void *context, const float incoming[3], const float outgoing[3], float value[3])
{
    (void)outgoing;
    ++*(size_t *)context;
    value[0] = value[1] = value[2] = 0.5f + 0.0f * incoming[0];
}

static pm_status estimate(const char *spec, const pm_map *first, const pm_map *second, pm_brdf brdf, bool front,
                          pm_estimation *estimation)
{
    pm_estimator *estimator = NULL;
    pm_workspace *workspace = NULL;
    ck_assert_int_eq(pm_estimator_create(spec, &estimator, NULL), PM_OK);
    ck_assert_int_eq(pm_workspace_create(0, &workspace), PM_OK);
    size_t calls = 0;
    const pm_map *const maps[] = {first, second};
    const pm_source source = {.maps = maps, .map_count = pm_estimator_maps(estimator), .dimensions = 2, .brdf = brdf,
                              .brdf_context = &calls, .outgoing = {0.0f, 0.0f, 1.0f}};
    pm_query query;
    pm_query_init(&query);
    query.position[0] = query.position[1] = 0.4f;
    query.front_only = front;
    const pm_status status = pm_estimate(estimator, &source, &query, workspace, estimation);
    if (status != PM_OK)
        ck_assert(estimation->value[0] == 0.0);
    ck_assert(!brdf || calls > 0 || status != PM_OK);
    pm_workspace_destroy(workspace);
    pm_estimator_destroy(estimator);
    return status;
}

START_TEST(estimates_are_the_same_or_refused)
{
    static const char *const specs[] = {"disc", "cone", "hull", "combined:maps=2"};
    pair p = create(COUNT, NULL, PM_SIMD_AUTO), none = create(0, NULL, PM_SIMD_AUTO);
    for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) {
        pm_estimation want, got;
        ck_assert_int_eq(estimate(specs[i], p.full, p.full, NULL, false, &want), PM_OK);
        ck_assert_int_eq(estimate(specs[i], p.bare, p.bare, NULL, false, &got), PM_OK);
        ck_assert(want.value[0] > 0.0);
        ck_assert_mem_eq(&got, &want, sizeof got);
        ck_assert_int_eq(estimate(specs[i], p.full, p.full, half, true, &got), PM_OK);
        ck_assert_int_eq(estimate(specs[i], p.bare, p.bare, half, false, &got), PM_EINVAL);
        ck_assert_int_eq(estimate(specs[i], p.bare, p.bare, NULL, true, &got), PM_EINVAL);
        ck_assert_int_eq(estimate(specs[i], none.bare, none.bare, half, false, &got), PM_EINVAL);
    }
    pm_estimation got;
    ck_assert_int_eq(estimate("combined:maps=2", p.full, p.bare, half, false, &got), PM_EINVAL);
    ck_assert_int_eq(estimate("combined:maps=2", p.full, p.bare, NULL, false, &got), PM_OK);
    destroy(&none);
    destroy(&p);
}
END_TEST

static pm_status stored(const pm_map *map, const float (*normals)[3], bool front_lookup, bool front_query,
                        pm_estimation *estimation)
{
    pm_estimator *estimator = NULL;
    pm_precomputed *precomputed = NULL;
    pm_workspace *workspace = NULL;
    pm_precomputed_options options = {.normals = normals, .dimensions = 2};
    pm_error error = {""};
    pm_query query;
    pm_query_init(&query);
    pm_query_init(&options.lookup);
    options.lookup.front_only = front_lookup;
    query.front_only = front_query;
    query.position[0] = query.position[1] = 0.4f;
    ck_assert_int_eq(pm_estimator_create("precomputed:fraction=0.25", &estimator, NULL), PM_OK);
    ck_assert_int_eq(pm_workspace_create(0, &workspace), PM_OK);
    pm_status status = pm_precomputed_create(estimator, map, &options, &precomputed, &error);
    if (status == PM_OK) {
        const pm_source source = {.precomputed = precomputed, .dimensions = 2};
        status = pm_estimate(estimator, &source, &query, workspace, estimation);
    } else {
        ck_assert_ptr_null(precomputed);
        ck_assert_ptr_nonnull(strstr(error.text, "no directions"));
    }
    pm_precomputed_destroy(precomputed);
    pm_workspace_destroy(workspace);
    pm_estimator_destroy(estimator);
    return status;
}

START_TEST(stored_estimates_are_the_same_or_refused)
{
    static float normals[COUNT][3];
    pair p = create(COUNT, NULL, PM_SIMD_AUTO);
    for (size_t i = 0; i < COUNT; i++)
        normals[i][2] = 1.0f;
    for (int known = 0; known < 2; known++) {
        const float(*const n)[3] = known ? (const float(*)[3])normals : NULL;
        pm_estimation want, got;
        ck_assert_int_eq(stored(p.full, n, false, false, &want), PM_OK);
        ck_assert_int_eq(stored(p.bare, n, false, false, &got), PM_OK);
        ck_assert(want.value[0] > 0.0);
        ck_assert_mem_eq(&got, &want, sizeof got);
        ck_assert_int_eq(stored(p.full, n, true, true, &got), PM_OK);
        ck_assert_int_eq(stored(p.bare, n, true, false, &got), PM_EINVAL);
        ck_assert_int_eq(stored(p.bare, n, false, true, &got), PM_EINVAL);
    }
    destroy(&p);
}
END_TEST

/* What the map holds of its photons, as the allocator says, which rounds up by at most a page or so. */
static double held(const pm_map *map)
{
    const size_t bytes = malloc_usable_size(map->blocks) + malloc_usable_size(map->ids) +
                         malloc_usable_size(map->carried);
    return (double)bytes / (double)map->count;
}

START_TEST(twelve_bytes_a_photon_are_saved)
{
    for (size_t s = 0; s < pm__searches.count; s++) {
        pair p = create(COUNT, search_at(s), PM_SIMD_AUTO);
        const pm__structure_id structure = search_at(s)->structure;
        const double sides = structure == PM__WIDE ? 3.0 : 0.0;
        PM_CHECK_NEAR(held(p.full) - held(p.bare), 12.0, 0.1);
        PM_CHECK_NEAR((double)(pm_map_bytes(p.full) - pm_map_bytes(p.bare)) / COUNT, sides, 0.02);
        const double built = pm__bytes_when_built(structure, false), building = pm__bytes_to_build(structure, false);
        PM_CHECK_NEAR(pm__bytes_when_built(structure, true) - built, 12.0 + sides, 0.0);
        PM_CHECK_NEAR(pm__bytes_to_build(structure, true) - building, 8.0 + sides, 0.0);
        destroy(&p);
    }
}
END_TEST

/* Where arrays are so large that they are mapped and not cut from the heap, what was given back is gone all the same.
 * The allocator rounds up by a huge page. */
START_TEST(twelve_bytes_a_photon_are_saved_of_many)
{
    enum { MANY = 1 << 20, HUGE_PAGE = 2 << 20 };
    pair p = create(MANY, pm_search_find("brute"), PM_SIMD_AUTO);
    PM_CHECK_NEAR((double)malloc_usable_size(p.full->carried), 24.0 * MANY, HUGE_PAGE);
    PM_CHECK_NEAR((double)malloc_usable_size(p.bare->carried), 12.0 * MANY, HUGE_PAGE);
    for (uint32_t i = 0; i < MANY; i += 7)
        ck_assert_mem_eq(pm__power(p.bare, i), p.photons[pm_map_source(p.bare, i)].power, 3 * sizeof(float));
    destroy(&p);
}
END_TEST

START_TEST(growing_maps_do_without_too)
{
    enum { GROWN = 300 };
    pm_photon *const photons = random_photons(GROWN);
    const pm_search *const search = pm_search_find("unbalanced");
    pm_map *maps[2] = {NULL, NULL};
    static pm_neighbor neighbors[2][COUNT];
    for (int bare = 0; bare < 2; bare++) {
        const pm_map_options options = {.search = search, .no_directions = bare};
        ck_assert_int_eq(pm__growing_create(1.0, &options, &maps[bare], NULL), PM_OK);
        for (size_t i = 0; i < GROWN; i++)
            ck_assert_int_eq(pm__growing_add(maps[bare], &photons[i], NULL), PM_OK);
        ck_assert_int_eq(pm_map_check(maps[bare], NULL), PM_OK);
    }
    for (size_t i = 0; i < QUERIES; i++) {
        const pm_query query = query_at(i, search);
        const size_t count = find(maps[0], &query, neighbors[0]);
        ck_assert_uint_eq(find(maps[1], &query, neighbors[1]), count);
        ck_assert_mem_eq(neighbors[1], neighbors[0], count * sizeof neighbors[0][0]);
    }
    refuses_sides(maps[1], search);
    for (uint32_t i = 0; i < GROWN; i++)
        ck_assert_mem_eq(pm_map_photon(maps[1], i).power, photons[i].power, sizeof photons[i].power);
    ck_assert_uint_lt(malloc_usable_size(maps[1]->carried), malloc_usable_size(maps[0]->carried) / 2 + 100);
    pm_map_destroy(maps[0]);
    pm_map_destroy(maps[1]);
    free(photons);
}
END_TEST

START_TEST(the_checker_reads_what_is_there)
{
    pair p = create(COUNT, NULL, PM_SIMD_AUTO);
    float *const last = p.bare->carried + 3 * COUNT - 1;
    const float power = *last;
    *last = INFINITY;
    ck_assert_int_eq(pm_map_check(p.bare, NULL), PM_EBROKEN);
    *last = power;
    ck_assert_int_eq(pm_map_check(p.bare, NULL), PM_OK);
    p.full->carried[6 * COUNT - 1] = NAN; /* a direction */
    ck_assert_int_eq(pm_map_check(p.full, NULL), PM_EBROKEN);
    destroy(&p);
    pm_photon *const photons = random_photons(2);
    const pm_map_options options = {.no_directions = true};
    pm_map *map = NULL;
    photons[1].direction[2] = NAN; /* refused though it would not be kept */
    ck_assert_int_eq(pm_map_create(photons, 2, &options, &map, NULL), PM_ENONFINITE);
    free(photons);
}
END_TEST

PM_TEST_MAIN("directions", neighbors_are_the_same, neighbors_are_the_same_in_maps_of_all_searches, sides_are_refused,
             estimates_are_the_same_or_refused, stored_estimates_are_the_same_or_refused,
             twelve_bytes_a_photon_are_saved, twelve_bytes_a_photon_are_saved_of_many, growing_maps_do_without_too,
             the_checker_reads_what_is_there)
