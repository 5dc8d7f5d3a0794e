/* Searches of a radius that are run together find what each finds alone, by every search, SIMD width and side; the
 * reference is the search that looks at all photons. */
#include "../../src/base/random.h"
#include "../../src/lookup/lookup.h"
#include "../test.h"

#include <math.h>
#include <stdlib.h>

enum { PHOTONS = 20000, QUERIES = 64, STRIDE = 64 };

/* The walls of a cube, or what it holds; every tenth photon and query stands on a lattice, where distances tie. */
static void place(uint64_t number, bool walls, float position[3])
{
    double u[5];
    pm__random_uniform(29, PM__FOR_TESTS, walls, number, u, 5);
    for (int a = 0; a < 3; a++)
        position[a] = (float)(number % 10 ? u[a] : floor(16.0 * u[a]) / 16.0);
    if (walls)
        position[(int)(3.0 * u[3])] = u[4] < 0.5 ? 0.0f : 1.0f;
}

static void head(uint64_t number, float direction[3])
{
    double u[2];
    pm__random_uniform(29, PM__FOR_TESTS, 2, number, u, 2);
    const double z = 2.0 * u[0] - 1.0, across = sqrt(1.0 - z * z);
    direction[0] = (float)(across * cos(6.283185307179586 * u[1]));
    direction[1] = (float)(across * sin(6.283185307179586 * u[1]));
    direction[2] = (float)z;
}

static pm_photon *make_photons(bool walls)
{
    pm_photon *const photons = calloc(PHOTONS, sizeof *photons);
    ck_assert_ptr_nonnull(photons);
    for (size_t i = 0; i < PHOTONS; i++) {
        place(i, walls, photons[i].position);
        head(i, photons[i].direction);
    }
    return photons;
}

/* The radii differ from query to query: none, next to none, as cells are wide, several cells. */
static void make_queries(bool walls, bool front, float scale, pm_query queries[QUERIES])
{
    static const float radii[] = {0.0f, 1e-4f, 0.01f, 0.02f, 0.03f, 0.05f};
    for (size_t i = 0; i < QUERIES; i++) {
        pm_query_init(&queries[i]);
        place(100 * PHOTONS + i, walls, queries[i].position);
        if (i % 7 == 0)
            place(i, walls, queries[i].position); /* on a photon */
        head(100 * PHOTONS + i, queries[i].normal);
        queries[i].k = 0;
        queries[i].max_radius = scale * radii[i % 6];
        queries[i].front_only = front;
    }
}

static void check_alike(const pm_map *map, const pm_map *plain, const pm_query *query, pm_neighbor *found, size_t count,
                        bool sorted)
{
    static pm_neighbor want[PHOTONS];
    size_t expected;
    ck_assert_int_eq(pm_map_search(plain, query, want, PHOTONS, &expected), PM_OK);
    ck_assert_uint_eq(count, expected);
    if (count > STRIDE)
        return;
    if (!sorted)
        pm__sort_neighbors(map, found, count);
    for (size_t i = 0; i < count; i++) {
        ck_assert_uint_eq(pm_map_source(map, found[i].number), pm_map_source(plain, want[i].number));
        ck_assert(found[i].distance2 == want[i].distance2);
    }
}

static void check_map(const pm_map *map, const pm_map *plain, bool walls, bool front, float scale)
{
    static pm_neighbor found[QUERIES * STRIDE];
    pm_query queries[QUERIES];
    size_t counts[QUERIES];
    make_queries(walls, front, scale, queries);
    for (size_t first = 0; first < QUERIES; first += PM__AT_ONCE - 1) { /* groups of all sizes up to the largest */
        const size_t left = QUERIES - first, some = left < PM__AT_ONCE ? left : PM__AT_ONCE;
        ck_assert_int_eq(pm__search_within(map, queries + first, some, found, STRIDE, counts), PM_OK);
        for (size_t i = 0; i < some; i++)
            check_alike(map, plain, &queries[first + i], found + i * STRIDE, counts[i], false);
    }
    const pm_status status = pm_map_search_batch(map, queries, QUERIES, found, STRIDE, counts);
    ck_assert(status == PM_OK || status == PM_ETRUNCATED);
    for (size_t i = 0; i < QUERIES; i++) {
        check_alike(map, plain, &queries[i], found + i * STRIDE, counts[i], true);
        if (counts[i] > STRIDE)
            break;
    }
}

static pm_map *make_map(const pm_photon *photons, size_t count, const char *search, pm_simd simd)
{
    const pm_map_options options = {.search = pm_search_find(search), .simd = simd};
    pm_map *map = NULL;
    pm_error error;
    if (pm_map_create(photons, count, &options, &map, &error) == PM_OK)
        PM_CHECK_OK(pm_map_check(map, &error), error);
    return map;
}

START_TEST(together_as_alone)
{
    static const char *const searches[] = {"grid", "wide", "iterative"};
    const bool walls = _i & 1, front = _i & 2;
    pm_photon *const photons = make_photons(walls);
    pm_map *const plain = make_map(photons, PHOTONS, "brute", PM_SIMD_PLAIN);
    for (int s = 0; s < 3; s++)
        for (int simd = PM_SIMD_PLAIN; simd <= PM_SIMD_AVX512; simd++) {
            pm_map *const map = make_map(photons, PHOTONS, searches[s], (pm_simd)simd);
            if (!map)
                continue; /* the processor lacks it */
            check_map(map, plain, walls, front, 1.0f);
            check_map(map, plain, walls, front, 4.0f); /* most find more than there is room for */
            pm_map_destroy(map);
        }
    pm_map_destroy(plain);
    free(photons);
}
END_TEST

/* A structure that another's map was given, and maps of a photon or none. */
START_TEST(of_any_map)
{
    pm_photon *const photons = make_photons(true);
    pm_map *const plain = make_map(photons, PHOTONS, "brute", PM_SIMD_PLAIN);
    const pm_search *const grid = pm_search_find("grid");
    pm_map *const map = make_map(photons, PHOTONS, "iterative", PM_SIMD_AUTO);
    pm_error error;
    PM_CHECK_OK(pm_map_prepare(map, grid, NULL, &error), error);
    map->search = grid;
    check_map(map, plain, true, true, 1.0f);
    pm_map_destroy(map);
    for (size_t count = 0; count < 2; count++) {
        pm_map *const small = make_map(photons, count, "grid", PM_SIMD_AUTO);
        pm_map *const all = make_map(photons, count, "brute", PM_SIMD_AUTO);
        check_map(small, all, true, false, 1.0f);
        pm_map_destroy(small);
        pm_map_destroy(all);
    }
    pm_map_destroy(plain);
    free(photons);
}
END_TEST

START_TEST(refusals)
{
    pm_photon *const photons = make_photons(true);
    const pm_map_options options = {.search = pm_search_find("grid"), .no_directions = true};
    pm_map *map;
    pm_error error;
    pm_neighbor found[4];
    size_t count;
    pm_query query;
    pm_query_init(&query);
    query.max_radius = 1e-3f;
    PM_CHECK_OK(pm_map_create(photons, PHOTONS, &options, &map, &error), error);
    ck_assert_int_eq(pm__search_within(map, &query, 1, found, 4, &count), PM_OK);
    query.front_only = true;
    ck_assert_int_eq(pm__search_within(map, &query, 1, found, 4, &count), PM_EINVAL);
    query.front_only = false;
    query.max_radius = -1.0f;
    ck_assert_int_eq(pm__search_within(map, &query, 1, found, 4, &count), PM_EINVAL);
    query.max_radius = (float)NAN;
    ck_assert_int_eq(pm__search_within(map, &query, 1, found, 4, &count), PM_EINVAL);
    pm_map_destroy(map);
    free(photons);
}
END_TEST

int main(void)
{
    Suite *const suite = suite_create("searches of a radius together");
    TCase *const tcase = tcase_create("within");
    tcase_set_timeout(tcase, 120);
    tcase_add_loop_test(tcase, together_as_alone, 0, 4);
    tcase_add_test(tcase, of_any_map);
    tcase_add_test(tcase, refusals);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
