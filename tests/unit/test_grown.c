/* Trees grown photon by photon: maps that grow while they are searched, orders that defeat growing, refusals. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/map/grown.h"
#include "../../src/search/search.h"
#include "../test.h"

#include <string.h>

enum { ORDERS = 8 };

/* random; sorted; falling; all equal; alternately from both ends; sorted along x only; on walls; sorted with
 * duplicates */
static pm_photon make_photon(int order, size_t i, size_t count)
{
    double u[6], x[3];
    pm__random_uniform(21, PM__FOR_TESTS, (uint32_t)order, i, u, 6);
    const double t = (double)i / (double)count;
    for (int a = 0; a < 3; a++)
        x[a] = order == 0   ? u[a]
               : order == 1 ? t
               : order == 2 ? 1.0 - t
               : order == 3 ? 0.75
               : order == 4 ? (i % 2 ? 1.0 - t : t)
               : order == 5 ? (a == 0 ? t : u[a])
               : order == 6 ? ((size_t)a == i % 3 ? floor(2.0 * u[a]) : u[a])
                            : floor(t * 20.0);
    return (pm_photon){{(float)x[0], (float)x[1], (float)x[2]},
                       {0.0f, 0.0f, u[3] < 0.5 ? 1.0f : -1.0f},
                       {(float)u[4], (float)(i + 1), 0.0f}};
}

static unsigned height(const pm__grown *tree, uint32_t root)
{
    if (root == PM__NO_CHILD)
        return 0;
    const unsigned left = height(tree, pm__grown_child(&tree->nodes[root], 0));
    const unsigned right = height(tree, pm__grown_child(&tree->nodes[root], 1));
    return 1 + (left > right ? left : right);
}

static pm_map *growing(double extent)
{
    pm_map *map = NULL;
    pm_error error;
    const pm_map_options options = {.search = pm_search_find("unbalanced")};
    PM_CHECK_OK(pm__growing_create(extent, &options, &map, &error), error);
    return map;
}

/* What `unbalanced` finds in the map as it is must be what brute force does. */
static void check_against_brute(const pm_map *map, const pm_photon *near, size_t k)
{
    pm_neighbor *const found = pm__alloc(map->count, sizeof *found), *const expected =
                                                                         pm__alloc(map->count, sizeof *found);
    for (int kind = 0; kind < 4; kind++) {
        pm_query q;
        pm_query_init(&q);
        memcpy(q.position, near->position, sizeof q.position);
        q.position[0] += kind ? 0.01f : 0.0f;
        q.k = kind == 1 ? 0 : k;
        q.max_radius = kind == 1 ? 0.2f : INFINITY;
        q.front_only = kind == 2;
        q.shape = kind == 3 ? PM_LOOKUP_DISC : PM_LOOKUP_SPHERE;
        q.shape_parameter = 0.05f;
        size_t got = 0, want = 0;
        ck_assert_int_eq(pm_map_search(map, &q, found, map->count, &got), PM_OK);
        q.search = pm_search_find("brute");
        ck_assert_int_eq(pm_map_search(map, &q, expected, map->count, &want), PM_OK);
        ck_assert_uint_eq(got, want);
        ck_assert(!memcmp(found, expected, got * sizeof *found));
    }
    free(found);
    free(expected);
}

START_TEST(maps_are_searched_while_they_grow)
{
    enum { COUNT = 1500 };
    for (int order = 0; order < ORDERS; order++) {
        pm_map *const map = growing(1.0);
        pm_error error;
        check_against_brute(map, &(pm_photon){.power = {0}}, 3);
        for (size_t i = 0; i < COUNT; i++) {
            const pm_photon photon = make_photon(order, i, COUNT);
            PM_CHECK_OK(pm__growing_add(map, &photon, &error), error);
            ck_assert_uint_eq(pm_map_count(map), i + 1);
            if (i < 20 || i % 97 == 0) {
                const pm_photon near = make_photon(order, i / 2, COUNT);
                check_against_brute(map, &near, 1 + i % 60);
                PM_CHECK_OK(pm_map_check(map, &error), error);
            }
        }
        double largest = 0.0;
        for (uint32_t i = 0; i < COUNT; i++) {
            const pm_photon given = make_photon(order, i, COUNT), got = pm_map_photon(map, i);
            ck_assert_mem_eq(&given, &got, sizeof got);
            ck_assert_uint_eq(pm_map_source(map, i), i);
            for (int c = 0; c < 3; c++)
                largest = fmax(largest, (double)given.power[c]);
        }
        PM_CHECK_NEAR(pm_map_max_power(map), largest, 0.0);
        pm_map_destroy(map);
    }
}
END_TEST

/* Grown one by one or all at once: the same tree. */
START_TEST(growing_and_creating_agree)
{
    enum { COUNT = 3000 };
    pm_photon *const photons = pm__alloc(COUNT, sizeof *photons);
    pm_map *const grown = growing(0.9);
    pm_map *created = NULL;
    pm_error error;
    const pm_map_options options = {.search = pm_search_find("unbalanced")};
    for (size_t i = 0; i < COUNT; i++) {
        photons[i] = make_photon(0, i, COUNT);
        PM_CHECK_OK(pm__growing_add(grown, &photons[i], &error), error);
    }
    PM_CHECK_OK(pm_map_create(photons, COUNT, &options, &created, &error), error);
    ck_assert(!memcmp(pm__grown_of(grown)->nodes, pm__grown_of(created)->nodes, COUNT * sizeof(pm__grown_node)));
    pm_map_destroy(grown);
    pm_map_destroy(created);
    free(photons);
}
END_TEST

/* 4 log2 N + 8 links at most, for any order; a random one keeps the height of a random tree, mean 2.99 log2 N less a
 * few (Devroye 1986), so is more than 1.5 and less than 3 log2 N high. */
START_TEST(no_order_grows_a_deep_tree)
{
    enum { COUNT = 60000 };
    for (int order = 0; order < ORDERS; order++) {
        pm_map *const map = growing(1.0);
        pm_error error;
        for (size_t i = 0; i < COUNT; i++) {
            const pm_photon photon = make_photon(order, i, COUNT);
            PM_CHECK_OK(pm__growing_add(map, &photon, &error), error);
        }
        PM_CHECK_OK(pm_map_check(map, &error), error);
        const double links = (double)height(pm__grown_of(map), pm__grown_of(map)->root) - 1.0;
        ck_assert_msg(links <= 4.0 * log2(COUNT) + 8.0, "order %d: %g links", order, links);
        if (order == 0)
            ck_assert_msg(links > 1.5 * log2(COUNT) && links < 3.0 * log2(COUNT), "%g links in random order", links);
        pm_map_destroy(map);
    }
}
END_TEST

/* Nodes that a search within a radius visits. */
static size_t visits(const pm__grown *tree, uint32_t at, const float position[3], float radius)
{
    size_t count = 0;
    while (at != PM__NO_CHILD) {
        const pm__grown_node *const node = &tree->nodes[at];
        const float to_plane = position[pm__grown_axis(node)] - node->position[pm__grown_axis(node)];
        const unsigned side = to_plane >= 0.0f;
        if (fabsf(to_plane) <= radius)
            count += visits(tree, pm__grown_child(node, !side), position, radius);
        count++;
        at = pm__grown_child(node, side);
    }
    return count;
}

/* The same uniform cube in random order and sorted along an axis: sorted, its cells are longer, so a radius that holds
 * about 50 photons reaches more of them, but no more than SLOWER times as many. */
START_TEST(sorted_photons_are_searched_nearly_as_fast)
{
    enum { COUNT = 60000, QUERIES = 2000, SLOWER = 4 };
    const float radius = 0.058f; /* 4/3 pi r^3 COUNT = 49 */
    size_t total[2] = {0, 0};
    for (int sorted = 0; sorted < 2; sorted++) {
        pm_map *const map = growing(1.0);
        pm_error error;
        for (size_t i = 0; i < COUNT; i++) {
            const pm_photon photon = make_photon(sorted ? 5 : 0, i, COUNT);
            PM_CHECK_OK(pm__growing_add(map, &photon, &error), error);
        }
        const pm__grown *const tree = pm__grown_of(map);
        for (size_t i = 0; i < QUERIES; i++) {
            const pm_photon at = make_photon(0, COUNT + i, COUNT);
            total[sorted] += visits(tree, tree->root, at.position, radius);
        }
        pm_map_destroy(map);
    }
    ck_assert_msg(total[1] <= SLOWER * total[0], "%zu visits a query, %zu sorted", total[0] / QUERIES,
                  total[1] / QUERIES);
}
END_TEST

START_TEST(the_checker_sees_broken_trees)
{
    pm_map *const map = growing(1.0);
    pm_error error;
    for (size_t i = 0; i < 200; i++) {
        const pm_photon photon = make_photon(0, i, 200);
        PM_CHECK_OK(pm__growing_add(map, &photon, &error), error);
    }
    pm__grown *const tree = map->index[PM__GROWN];
    pm__grown_node *const root = &tree->nodes[tree->root];
    const pm__grown_node saved = *root;
    root->right = pm__grown_child(&saved, 0); /* sides exchanged */
    root->left_axis = saved.right << 2 | pm__grown_axis(&saved);
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    *root = saved;
    root->right = PM__NO_CHILD; /* a subtree lost */
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    *root = saved;
    root->position[1] += 1.0f;
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    *root = saved;
    root->left_axis = tree->root << 2 | pm__grown_axis(&saved); /* a ring */
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    *root = saved;
    PM_CHECK_OK(pm_map_check(map, &error), error);
    pm_map_destroy(map);
}
END_TEST

START_TEST(what_cannot_grow_is_refused)
{
    pm_map *map = NULL;
    pm_error error;
    const pm_map_options options = {.search = pm_search_find("unbalanced")};
    const double bad[] = {0.0, -1.0, INFINITY, NAN};
    for (size_t i = 0; i < 4; i++)
        ck_assert_int_eq(pm__growing_create(bad[i], &options, &map, &error), PM_EINVAL);
    const pm_photon good = make_photon(0, 0, 1);
    map = growing(1e-17);
    pm_photon photon = good;
    photon.power[1] = NAN;
    ck_assert_int_eq(pm__growing_add(map, &photon, &error), PM_ENONFINITE);
    ck_assert_int_eq(pm__growing_add(map, &good, &error), PM_OK); /* far beyond the unit, but within float */
    photon = good;
    photon.position[0] = 1e-3f;
    ck_assert_int_eq(pm__growing_add(map, &photon, &error), PM_OK);
    photon.position[0] = 1e30f;
    ck_assert_int_eq(pm__growing_add(map, &photon, &error), PM_EINVAL);
    ck_assert_uint_eq(pm_map_count(map), 2);
    PM_CHECK_OK(pm_map_check(map, &error), error);
    PM_CHECK_OK(pm_map_prepare(map, pm_search_find("recursive"), NULL, &error), error);
    ck_assert_int_eq(pm__growing_add(map, &good, &error), PM_EINVAL); /* the other structure would be left behind */
    pm_map_destroy(map);
}
END_TEST

PM_TEST_MAIN("grown", maps_are_searched_while_they_grow, growing_and_creating_agree, no_order_grows_a_deep_tree,
             sorted_photons_are_searched_nearly_as_fast, the_checker_sees_broken_trees, what_cannot_grow_is_refused)
