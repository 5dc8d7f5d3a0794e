/* Maps: the tree's invariants for every N, ties, scales and offsets, refusals, and independence of the threads. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/cli/parallel.h"
#include "../../src/map/structure.h"
#include "../../src/map/wide.h"
#include "../../src/search/search.h"
#include "../test.h"

#include <string.h>

/* Photons uniform in a box; `levels` > 0 puts them on a coarse grid, so that ties abound. */
static pm_photon *random_photons(size_t count, uint32_t trial, double levels)
{
    pm_photon *const photons = pm__alloc(count, sizeof *photons);
    ck_assert_ptr_nonnull(photons);
    for (size_t i = 0; i < count; i++) {
        double u[3];
        pm__random_uniform(7, PM__FOR_TESTS, trial, i, u, 3);
        for (int a = 0; a < 3; a++) {
            const double x = levels > 0.0 ? floor(u[a] * levels) / levels : u[a];
            photons[i].position[a] = (float)(x * (a == 1 ? 3.0 : 1.0));
            photons[i].direction[a] = a == 2 ? -1.0f : 0.0f;
            photons[i].power[a] = (float)(i + 1);
        }
    }
    return photons;
}

START_TEST(left_sizes_fill_the_last_level_from_the_left)
{
    for (size_t count = 0; count < 5000; count++) {
        /* brute force: heap indices 1..count below the left child */
        size_t expected = 0;
        for (size_t i = 2; i <= count; i++) {
            size_t top = i;
            while (top > 3)
                top /= 2;
            expected += top == 2;
        }
        ck_assert_uint_eq(pm__left_size(count), expected);
    }
}
END_TEST

START_TEST(invariants_hold_for_every_small_count)
{
    for (int levels = 0; levels <= 4; levels += 4)
        for (size_t count = 0; count <= 300; count++)
            for (int split = 0; split < 3; split++) { /* 2: the default structure */
                pm_photon *const photons = random_photons(count, (uint32_t)count, levels);
                const pm_map_options options = {.split = split == 1 ? PM_SPLIT_VARIANCE : PM_SPLIT_EXTENT,
                                                .search = split == 2 ? NULL : pm_search_find("recursive")};
                pm_map *map = NULL;
                pm_error error;
                PM_CHECK_OK(pm_map_create(photons, count, &options, &map, &error), error);
                ck_assert_uint_eq(pm_map_count(map), count);
                PM_CHECK_OK(pm_map_check(map, &error), error);
                for (size_t i = 0; i < count; i++) {
                    const pm_photon got = pm_map_photon(map, (uint32_t)i);
                    ck_assert_mem_eq(&got, &photons[pm_map_source(map, (uint32_t)i)], sizeof got);
                }
                pm_map_destroy(map);
                free(photons);
            }
}
END_TEST

/* What is asked for before a map is built is what it then takes: beside pm_map_bytes, direction and power. */
START_TEST(memory_is_foretold)
{
    enum { COUNT = 5000, DIRECTION_AND_POWER = 24, POSITION = 12 };
    pm_photon *const photons = random_photons(COUNT, 1, 0);
    for (size_t s = 0; s < pm__searches.count; s++) {
        const pm_search *const search = pm_search_find(pm__searches.entries[s]->name);
        const pm_map_options options = {.search = search};
        pm_map *map = NULL;
        pm_error error;
        PM_CHECK_OK(pm_map_create(photons, COUNT, &options, &map, &error), error);
        /* A tree has positions of its own, beside the blocks. */
        const bool twice = search->structure == PM__KD_TREE || search->structure == PM__GROWN;
        const double held = (double)pm_map_bytes(map) / COUNT + DIRECTION_AND_POWER + (twice ? POSITION : 0);
        const double foretold = pm__bytes_when_built(search->structure, true);
        ck_assert_msg(held <= foretold + 0.5 && held > foretold - 5.0, "%s: %g bytes, not %g", search->entry.name, held,
                      foretold);
        ck_assert(pm__bytes_to_build(search->structure, true) >= foretold);
        pm_map_destroy(map);
    }
    free(photons);
}
END_TEST

START_TEST(the_checker_sees_broken_trees)
{
    pm_photon *const photons = random_photons(100, 1, 0);
    pm_map *map = NULL;
    pm_error error;
    PM_CHECK_OK(pm_map_create(photons, 100, NULL, &map, &error), error);
    PM_CHECK_OK(pm_map_prepare(map, pm_search_find("recursive"), NULL, &error), error);
    PM_CHECK_OK(pm_map_check(map, &error), error);
    pm__node *const nodes = map->index[PM__KD_TREE];
    const pm__node saved = nodes[7];
    nodes[7] = nodes[8]; /* a photon twice */
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    nodes[7] = saved;
    const unsigned axis = pm__node_axis(&nodes[1]);
    const pm__node left = nodes[2];
    nodes[2].position[axis] = 100.0f; /* on the wrong side of the root */
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    nodes[2] = left;
    const uint32_t id = map->ids[5];
    map->ids[5] = map->ids[6];
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    map->ids[5] = id;
    pm__boxes *const boxes = ((pm__wide *)map->index[PM__WIDE])->level[0];
    const float high = boxes->high[1][3];
    boxes->high[1][3] = boxes->low[1][3]; /* a block's box too small */
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    boxes->high[1][3] = high;
    map->carried[3 * map->carried_size + 1] = NAN;
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    map->carried[3 * map->carried_size + 1] = 1.0f;
    PM_CHECK_OK(pm_map_check(map, &error), error);
    pm_map_destroy(map);
    free(photons);
}
END_TEST

/* The tree itself, and the order of the default structure. */
static bool same_maps(const pm_map *a, const pm_map *b)
{
    if (a->index[PM__KD_TREE])
        return !memcmp(pm__tree(a) + 1, pm__tree(b) + 1, a->count * sizeof(pm__node));
    return !memcmp(a->ids, b->ids, a->count * sizeof *a->ids) &&
           !memcmp(a->blocks, b->blocks, a->block_count * sizeof *a->blocks) &&
           !memcmp(a->carried, b->carried, a->count * a->carried_size * sizeof *a->carried);
}

START_TEST(threads_do_not_change_the_map)
{
    const size_t count = 50000;
    for (int levels = 0; levels <= 48; levels += 16) {
        pm_photon *const photons = random_photons(count, 3, levels % 32);
        size_t threads = 3;
        pm_error error;
        const pm_parallel parallel = pm__parallel_for(&threads);
        const pm_search *const search = levels == 32 ? NULL : pm_search_find(levels == 48 ? "grid" : "recursive");
        const pm_map_options alone = {.search = search}, options = {.search = search, .parallel = &parallel};
        pm_map *serial = NULL, *threaded = NULL;
        PM_CHECK_OK(pm_map_create(photons, count, &alone, &serial, &error), error);
        PM_CHECK_OK(pm_map_create(photons, count, &options, &threaded, &error), error);
        ck_assert(same_maps(serial, threaded));
        pm_map_destroy(serial);
        pm_map_destroy(threaded);
        free(photons);
    }
}
END_TEST

/* Orders that defeat simple pivots, and clouds without any extent. */
START_TEST(hard_orders_stay_fast_and_right)
{
    const size_t count = 200000;
    pm_photon *const photons = random_photons(count, 5, 0);
    for (int order = 0; order < 4; order++) {
        for (size_t i = 0; i < count; i++) {
            const double x = order == 0   ? 1.0                                     /* all the same */
                             : order == 1 ? (double)i                               /* sorted */
                             : order == 2 ? (double)(i % 2 ? i : count - i)         /* two interleaved runs */
                                          : (double)((i * i) % 3);                  /* three values */
            photons[i].position[0] = (float)x;
            photons[i].position[1] = photons[i].position[2] = 0.0f;
        }
        pm_map *map = NULL;
        pm_error error;
        PM_CHECK_OK(pm_map_create(photons, count, NULL, &map, &error), error);
        static const char *const searches[] = {"recursive", "unbalanced", "grid"};
        for (size_t i = 0; i < sizeof searches / sizeof *searches; i++)
            PM_CHECK_OK(pm_map_prepare(map, pm_search_find(searches[i]), NULL, &error), error);
        PM_CHECK_OK(pm_map_check(map, &error), error);
        pm_map_destroy(map);
    }
    free(photons);
}
END_TEST

/* At most 24 bytes a photon for the structure of any search with the ids: in space, on walls, all in one point. */
START_TEST(structures_stay_within_their_memory)
{
    static const char *const searches[] = {"wide", "recursive", "unbalanced", "grid"};
    const size_t count = 160000;
    for (int cloud = 0; cloud < 3; cloud++) {
        pm_photon *const photons = random_photons(count, 4, cloud == 2 ? 1.0 : 0.0);
        for (size_t i = 0; i < count && cloud == 1; i++)
            photons[i].position[i % 3] = i % 2 ? 1.0f : 0.0f;
        for (size_t s = 0; s < sizeof searches / sizeof *searches; s++) {
            const pm_map_options options = {.search = pm_search_find(searches[s])};
            pm_map *map = NULL;
            pm_error error;
            PM_CHECK_OK(pm_map_create(photons, count, &options, &map, &error), error);
            ck_assert_msg(pm_map_bytes(map) <= 24 * count + 64, "%s: %zu bytes", searches[s], pm_map_bytes(map));
            pm_map_destroy(map);
        }
        free(photons);
    }
}
END_TEST

/* Recentring and scaling round no position: it is read back to the bit, at any offset and extent. */
START_TEST(positions_come_back_to_the_bit)
{
    static const double offsets[] = {0.0, 1e5, -1e5, 3e37, 1e-30}, extents[] = {1.0, 1e-30, 1e30, 1e-3, 1e38};
    pm_photon *const photons = random_photons(500, 9, 0);
    for (size_t o = 0; o < 5; o++)
        for (size_t e = 0; e < 5; e++) {
            pm_photon *const moved = random_photons(500, 9, 0);
            for (size_t i = 0; i < 500; i++)
                for (int a = 0; a < 3; a++)
                    moved[i].position[a] = (float)(offsets[o] + extents[e] * (double)photons[i].position[a]);
            pm_map *map = NULL;
            pm_error error;
            PM_CHECK_OK(pm_map_create(moved, 500, NULL, &map, &error), error);
            PM_CHECK_OK(pm_map_check(map, &error), error);
            for (uint32_t i = 0; i < 500; i++) {
                const pm_photon got = pm_map_photon(map, i);
                ck_assert_mem_eq(&got, &moved[pm_map_source(map, i)], sizeof got);
            }
            pm_map_destroy(map);
            free(moved);
        }
    free(photons);
}
END_TEST

START_TEST(non_finite_photons_are_refused_by_index)
{
    pm_photon *const photons = random_photons(10, 2, 0);
    float *const values[] = {&photons[7].position[1], &photons[7].direction[0], &photons[7].power[2]};
    static const char *const words[] = {"position", "direction", "power"};
    for (int v = 0; v < 3; v++)
        for (int bad = 0; bad < 2; bad++) {
            const float saved = *values[v];
            pm_map *map = (pm_map *)(void *)photons;
            pm_error error = {""};
            *values[v] = bad ? INFINITY : NAN;
            ck_assert_int_eq(pm_map_create(photons, 10, NULL, &map, &error), PM_ENONFINITE);
            ck_assert_ptr_null(map);
            ck_assert_ptr_nonnull(strstr(error.text, "photon 7"));
            ck_assert_ptr_nonnull(strstr(error.text, words[v]));
            *values[v] = saved;
        }
    pm_map *map = NULL;
    ck_assert_int_eq(pm_map_create(photons, PM_MAX_PHOTONS + 1, NULL, &map, NULL), PM_EINVAL);
    ck_assert_int_eq(pm_map_create(NULL, 3, NULL, &map, NULL), PM_EINVAL);
    ck_assert_int_eq(pm_map_create(NULL, 0, NULL, &map, NULL), PM_OK);
    PM_CHECK_NEAR(pm_map_max_power(map), 0.0, 0.0);
    pm_map_destroy(map);
    pm_map_destroy(NULL);
    free(photons);
}
END_TEST

PM_TEST_MAIN("map", left_sizes_fill_the_last_level_from_the_left, invariants_hold_for_every_small_count,
             the_checker_sees_broken_trees, threads_do_not_change_the_map, hard_orders_stay_fast_and_right,
             structures_stay_within_their_memory, memory_is_foretold,
             positions_come_back_to_the_bit, non_finite_photons_are_refused_by_index)
