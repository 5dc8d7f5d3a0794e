/* The nearest photon by cells, against brute force: a cell is asked about at its middle, so by the triangle inequality
 * what it names is no farther from any point in it than the point's own nearest and twice the way to the middle.
 * Normals are along axes, where cones have their middles: the photons in front are then those of the point. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/cli/parallel.h"
#include "../../src/map/map.h"
#include "../../src/transport/cells.h"
#include "../../src/transport/vicinity.h"
#include "../test.h"

#include <string.h>

enum { PHOTONS = 3000, POINTS = 2000, TASKS = 12 };

static pm_photon photons[PHOTONS];
static float positions[POINTS][3], normals[POINTS][3], values[TASKS][POINTS];

static void uniform(uint32_t what, size_t i, double u[4])
{
    pm__random_uniform(11, PM__FOR_TESTS, what, i, u, 4);
}

/* Photons denser toward one corner of the unit cube, from all sides; points there, some far off. */
static pm_map *set_up(void)
{
    pm_map *map = NULL;
    pm_error error;
    double u[4];
    for (size_t i = 0; i < PHOTONS; i++) {
        uniform(1, i, u);
        const double z = 2.0 * u[3] - 1.0, r = sqrt(1.0 - z * z), phi = 6.283185307179586 * (double)i * 0.618;
        for (int a = 0; a < 3; a++)
            photons[i].position[a] = (float)(u[a] * u[a]);
        photons[i].direction[0] = (float)(r * cos(phi));
        photons[i].direction[1] = (float)(r * sin(phi));
        photons[i].direction[2] = (float)z;
    }
    for (size_t i = 0; i < POINTS; i++) {
        uniform(2, i, u);
        memset(normals[i], 0, sizeof normals[i]);
        normals[i][i % 3] = i % 2 ? 1.0f : -1.0f;
        for (int a = 0; a < 3; a++)
            positions[i][a] = (float)(u[a] * u[a] * (i % 10 ? 1.0 : 8.0));
    }
    PM_CHECK_OK(pm_map_create(photons, PHOTONS, NULL, &map, &error), error);
    return map;
}

/* The caller's index and one, so that a test sees who was found. */
static float name_of(const void *context, uint32_t photon, double distance)
{
    ck_assert(distance >= 0.0 && distance < 200.0);
    return (float)(pm_map_source(context, photon) + 1);
}

static double distance(const float a[3], const float b[3])
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        sum += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
    return sqrt(sum);
}

static bool is_in_front(size_t photon, const float normal[3])
{
    const float *const w = photons[photon].direction;
    return w[0] * normal[0] + w[1] * normal[1] + w[2] * normal[2] < 0.0f;
}

static void nearest_of(size_t point, double *front, double *any)
{
    *front = *any = INFINITY;
    for (size_t i = 0; i < PHOTONS; i++) {
        const double d = distance(photons[i].position, positions[point]);
        *any = fmin(*any, d);
        if (is_in_front(i, normals[point]))
            *front = fmin(*front, d);
    }
}

static void check_point(size_t i, double reach, double size, size_t *found, size_t *none)
{
    double front, any;
    nearest_of(i, &front, &any);
    const double cell = 1.4143 * size, large = 8.0 * cell;
    const double across = any > sqrt(3.0) * 0.5 * large ? sqrt(3.0) * large : sqrt(3.0) * cell;
    const float value = values[0][i];
    if (!(value > 0.0f)) {
        ck_assert_msg(front > reach - across, "point %zu: none, and there is one %g m off", i, front);
        ++*none;
        return;
    }
    const size_t named = (size_t)value - 1;
    const double d = distance(photons[named].position, positions[i]);
    ck_assert(named < PHOTONS && is_in_front(named, normals[i]));
    ck_assert_msg(d <= front + across + 1e-6, "point %zu: %g m off, the nearest at %g, cells of %g", i, d, front, cell);
    ck_assert(d <= reach + across);
    ++*found;
}

static void ask_all(void *argument, size_t task)
{
    for (size_t first = 0; first < POINTS; first += PM__CELLS_AT_ONCE) {
        const size_t rest = POINTS - first, some = rest < PM__CELLS_AT_ONCE ? rest : PM__CELLS_AT_ONCE;
        pm__cells_find(argument, (const float(*)[3])positions + first, (const float(*)[3])normals + first, some,
                       values[task] + first);
    }
}

static void check(double reach, double size, size_t *found, size_t *none)
{
    size_t threads = 3;
    const pm_parallel parallel = pm__parallel_for(&threads);
    pm_map *const map = set_up();
    pm__cells *cells = NULL;
    *found = *none = 0;
    ck_assert_int_eq(pm__cells_create(map, reach, size, name_of, map, &cells), PM_OK);
    parallel.run(parallel.context, TASKS, ask_all, cells);
    for (size_t t = 1; t < TASKS; t++)
        ck_assert(memcmp(values[t], values[0], sizeof values[0]) == 0);
    for (size_t i = 0; i < POINTS; i++)
        check_point(i, reach, size, found, none);
    pm__cells_destroy(cells);
    pm_map_destroy(map);
}

START_TEST(the_nearest_of_the_middle)
{
    size_t found, none;
    check(100.0, 0.02, &found, &none);
    ck_assert_uint_eq(none, 0);
    check(100.0, 1e-5, &found, &none); /* too many cells to be counted, or to be kept */
    check(100.0, 4.0, &found, &none);  /* few */
    check(0.1, 0.01, &found, &none);
    ck_assert(found > POINTS / 3 && none > POINTS / 20);
}
END_TEST

START_TEST(points_that_are_none)
{
    static const float bad[4][3] = {{NAN, 0.0f, 0.0f}, {0.0f, INFINITY, 0.0f}, {0.1f, 0.1f, 0.1f}, {0.1f, 0.1f, 0.1f}};
    static const float up[4][3] = {{0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 1.0f}, {0.0f, NAN, 1.0f}, {0.0f, 0.0f, 0.0f}};
    float got[4] = {1.0f, 1.0f, 1.0f, 1.0f};
    pm_map *const map = set_up();
    pm__cells *cells = NULL;
    ck_assert_int_eq(pm__cells_create(map, 10.0, 0.1, name_of, map, &cells), PM_OK);
    pm__cells_find(cells, bad, up, 4, got);
    for (int i = 0; i < 4; i++)
        ck_assert(got[i] == 0.0f);
    pm__cells_destroy(cells);
    pm__cells_destroy(NULL);
    pm_map_destroy(map);
}
END_TEST

/* What is marked holds every place within reach of a photon, and not all of space. */
START_TEST(vicinity)
{
    const double reach = 0.03; /* map units */
    pm_map *const map = set_up();
    pm__vicinity near_by = {.marked = NULL};
    size_t outside = 0;
    ck_assert(pm__vicinity_holds(&near_by, positions[0]));
    ck_assert_int_eq(pm__vicinity_create(map, reach, &near_by), PM_OK);
    for (size_t i = 0; i < 20000; i++) {
        double u[4];
        float place[3];
        pm__position(map, (uint32_t)(i % PHOTONS), place);
        uniform(3, i, u);
        const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z), phi = 6.283185307179586 * u[1];
        const double step[3] = {r * cos(phi), r * sin(phi), z};
        for (int a = 0; a < 3; a++)
            place[a] += (float)(reach * u[2] * step[a]);
        ck_assert(pm__vicinity_holds(&near_by, place));
        for (int a = 0; a < 3; a++)
            place[a] += (float)(20.0 * reach * step[a]);
        outside += !pm__vicinity_holds(&near_by, place);
    }
    ck_assert_uint_gt(outside, 2000);
    pm__vicinity_free(&near_by);
    pm_map_destroy(map);
}
END_TEST

PM_TEST_MAIN("cells", the_nearest_of_the_middle, points_that_are_none, vicinity)
