/* Maps: the tree's invariants for every N, ties, scales and offsets, refusals, and independence of the threads. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/cli/parallel.h"
#include "../../src/map/map.h"
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
            for (int split = 0; split < 2; split++) {
                pm_photon *const photons = random_photons(count, (uint32_t)count, levels);
                const pm_map_options options = {(pm_split)split, NULL};
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

START_TEST(the_checker_sees_broken_trees)
{
    pm_photon *const photons = random_photons(100, 1, 0);
    pm_map *map = NULL;
    pm_error error;
    PM_CHECK_OK(pm_map_create(photons, 100, NULL, &map, &error), error);
    const pm__node saved = map->nodes[7];
    map->nodes[7] = map->nodes[8]; /* an id twice */
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    map->nodes[7] = saved;
    const unsigned axis = pm__node_axis(&map->nodes[1]);
    const pm__node left = map->nodes[2];
    map->nodes[2].position[axis] = 100.0f; /* on the wrong side of the root */
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    map->nodes[2] = left;
    map->power[3][1] = NAN;
    ck_assert_int_eq(pm_map_check(map, &error), PM_EBROKEN);
    map->power[3][1] = 1.0f;
    PM_CHECK_OK(pm_map_check(map, &error), error);
    pm_map_destroy(map);
    free(photons);
}
END_TEST

START_TEST(threads_do_not_change_the_tree)
{
    const size_t count = 50000;
    for (int levels = 0; levels <= 16; levels += 16) {
        pm_photon *const photons = random_photons(count, 3, levels);
        size_t threads = 3;
        pm_error error;
        const pm_parallel parallel = pm__parallel_for(&threads);
        const pm_map_options options = {PM_SPLIT_EXTENT, &parallel};
        pm_map *serial = NULL, *threaded = NULL;
        PM_CHECK_OK(pm_map_create(photons, count, NULL, &serial, &error), error);
        PM_CHECK_OK(pm_map_create(photons, count, &options, &threaded, &error), error);
        ck_assert(!memcmp(serial->nodes + 1, threaded->nodes + 1, count * sizeof *serial->nodes));
        ck_assert(!memcmp(serial->power, threaded->power, count * sizeof *serial->power));
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
        PM_CHECK_OK(pm_map_check(map, &error), error);
        pm_map_destroy(map);
    }
    free(photons);
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
             the_checker_sees_broken_trees, threads_do_not_change_the_tree, hard_orders_stay_fast_and_right,
             positions_come_back_to_the_bit, non_finite_photons_are_refused_by_index)
