/* Importance where there is next to none, or too much, or of what is no number; and whose random numbers it has. */
#include "../../src/scene/rough.h"
#include "../../src/transport/eye.h"
#include "../importance.h"

#include <string.h>

enum { PATHS = 20000 };

START_TEST(a_view_of_nothing)
{
    pm__scene *const scene = make_floor(0.5);
    const pm__camera camera = look(0, 0, above, 0, 0, 5, angle);
    for (int measure = 0; measure < 3; measure++) {
        const pm__importance_config config = importance_of(scene, &camera, 1000, (pm__measure)measure);
        pm__importance *const importance = importance_made(&config);
        for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
            ck_assert_uint_eq(pm__importance_count(importance, (pm__map_kind)kind), 0);
            PM_CHECK_NEAR(pm__importance_mean(importance, (pm__map_kind)kind), 0.0, 0.0);
            PM_CHECK_NEAR(pm__importance_threshold(importance, (pm__map_kind)kind), 0.0, 0.0);
            PM_CHECK_NEAR(importance_at(importance, (pm__map_kind)kind, 0, 0, 0, 0, 0, 1), 0.0, 0.0);
        }
        pm__importance_destroy(importance);
    }
    pm__importance_destroy(NULL);
    pm__scene_destroy(scene);
}
END_TEST

/* A view so narrow that all importons fall into one place, which a float tells from others to 2^-23 of 3 m, and
 * footprints are below any number: finite all the same. And one so short of importons that none has neighbours
 * enough. */
START_TEST(all_in_one_place_or_hardly_any)
{
    pm__scene *const scene = make_floor(0.5);
    const pm__camera narrow = look(3, 0, above, 3, 0, 0, 1e-25), wide = look(0, 0, above, 0, 0, 0, angle);
    for (int measure = 0; measure < 3; measure++)
        for (size_t few = 0; few < 4; few++) {
            const pm__importance_config config =
                importance_of(scene, few ? &wide : &narrow, few ? few : 1000, (pm__measure)measure);
            pm__importance *const importance = importance_made(&config);
            const double mean = pm__importance_mean(importance, PM__CAUSTIC_MAP);
            ck_assert(mean >= 0.0 && isfinite(mean));
            (void)importance_at(importance, PM__CAUSTIC_MAP, 0, 0, 0, 0, 0, 1);
            ck_assert(few || (measure == PM__OF_PIXELS ? !(mean > 0.0) : mean > 1e12 && mean < 1e17));
            ck_assert(few == 0 || few == 3 || measure != PM__OF_SCREEN || !(mean > 0.0));
            pm__importance_destroy(importance);
        }
    pm__scene_destroy(scene);
}
END_TEST

/* Straight down through a plate of index n = 10: beside the way through there are those that are reflected within 2 m
 * times, with (1 - 1/n) / (1 + 1/n) of light each, so they look L = h - t + (2 m + 1) t / n far, into the same place.
 * Pixels are so small that one over the footprint, 1 / (pixel L)^2, is too large for a float for m = 0 alone: what is
 * left has m >= 1, half of it m = 1, hardly any of it m > 6. */
START_TEST(footprints_that_are_none_do_not_count)
{
    const double ten[3] = {10, 10, 10}, largest = 3.4e38, first = above - thick + 0.1 * thick;
    const double second = first + 0.2 * thick, seventh = first + 1.2 * thick;
    const double pixel = 1.0 / (first * sqrt(1.02 * largest));
    pm__scene *const scene = make_plate(ten);
    const pm__camera camera = look(0, 0, above, 0, 0, 0, pixel * SIDE);
    const pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_PIXELS);
    pm__importance *const importance = importance_made(&config);
    const double value = importance_at(importance, PM__CAUSTIC_MAP, 0, 0, 0, 0, 0, 1);
    ck_assert_msg(value < 1.0001 / (pixel * second * pixel * second), "%g", value);
    ck_assert_msg(value > 1.0 / (pixel * seventh * pixel * seventh), "%g", value);
    pm__importance_destroy(importance);
    pm__scene_destroy(scene);
}
END_TEST

START_TEST(points_that_are_none)
{
    pm__scene *const scene = make_floor(0.5);
    const pm__camera camera = look(0, 0, above, 0, 0, 0, angle);
    const pm__importance_config config = importance_of(scene, &camera, 1000, PM__OF_BOTH);
    pm__importance *const importance = importance_made(&config);
    const float bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < 3; i++) {
        PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, (double)bad[i], 0, 0, 0, 0, 1), 0.0, 0.0);
        PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, 0, 0, 0, 0, 0, (double)bad[i]), 0.0, 0.0);
    }
    PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, 0, 0, 0, 0, 0, 0), 0.0, 0.0);
    pm__importance_at(importance, PM__CAUSTIC_MAP, NULL, NULL, 0, NULL);
    pm__importance_destroy(importance);
    pm__scene_destroy(scene);
}
END_TEST

static void refused(const pm__importance_config *config)
{
    pm__importance *importance;
    pm_error error = {""};
    ck_assert_int_eq(pm__importance_create(config, &importance, &error), PM_EINVAL);
    ck_assert(error.text[0] != '\0' && !importance);
}

#define REFUSED(field, value)                                                       \
    do {                                                                            \
        pm__importance_config bad = importance_of(scene, &camera, 100, PM__OF_BOTH); \
        bad.field = value;                                                          \
        refused(&bad);                                                              \
    } while (0)

static bool always(void *context)
{
    (void)context;
    return true;
}

START_TEST(what_is_refused)
{
    pm__scene *const scene = make_floor(0.5);
    const pm__camera camera = look(0, 0, above, 0, 0, 0, angle);
    REFUSED(width, 0);
    REFUSED(height, 0);
    REFUSED(paths, 0);
    REFUSED(paths, PM_MAX_PHOTONS + 1);
    REFUSED(bounces, 0);
    REFUSED(near, -1.0);
    REFUSED(near, NAN);
    REFUSED(nearest, 2);
    REFUSED(share, 0.0);
    REFUSED(share, 1.5);
    REFUSED(share, NAN);
    REFUSED(outlier, 0.5);
    REFUSED(outlier, NAN);
    pm__importance_config config = importance_of(scene, &camera, 100, PM__OF_BOTH);
    pm__importance *importance;
    pm_error error = {""};
    config.canceled = always;
    ck_assert_int_eq(pm__importance_create(&config, &importance, &error), PM_ECANCELED);
    ck_assert(error.text[0] != '\0' && !importance);
    pm__scene_destroy(scene);
}
END_TEST

/* Another seed gives other importons; and what a path does is not what the final pass's path of that number does. */
START_TEST(numbers_are_its_own)
{
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 1, 1, 1), 50.0, 0.0);
    lit_floor(scene, lit_wall(scene, 1, 1, 1), 50.0, 1e-3);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0, 0, 1e-4, 0.1, 0, 0, 0.1);
    pm__importance_config config = importance_of(scene, &camera, 1, PM__OF_SCREEN);
    float ways[2][3], places[2][3];
    for (int i = 0; i < 2; i++) {
        pm__importons sets[PM__MAP_KINDS];
        config.seed = (uint64_t)(i + 1);
        importons_made(&config, sets);
        memcpy(places[i], sets[PM__CAUSTIC_MAP].importons[0].position, sizeof places[i]);
        memcpy(ways[i], sets[PM__GLOBAL_MAP].importons[0].direction, sizeof ways[i]);
        pm__importons_free(sets);
    }
    ck_assert_mem_ne(places[0], places[1], sizeof places[0]);
    ck_assert_mem_ne(ways[0], ways[1], sizeof ways[0]);
    pm__eye_numbers numbers = pm__eye_numbers_of(1, 0, 0, 0);
    const double up[3] = {0, 0, 1};
    double u[3], out[3];
    pm__eye_uniform(&numbers, u);
    pm__cosine_direction(up, u[1], u[2], out);
    ck_assert(fabs(out[0] - (double)ways[0][0]) > 1e-5);
    pm__scene_destroy(scene);
}
END_TEST

/* To the last bit, whoever does the work. */
START_TEST(threads_do_not_matter)
{
    pm__scene *const scene = lit_create();
    lit_sphere(scene, lit_glass(scene), 0.3, 0, 1.0, 0.5, false);
    lit_sphere(scene, lit_wall(scene, 0.7, 0.7, 0.7), 0, 0, 0, 3.0, true);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0, -2, 1, 0, 0, 0.8, 0.9);
    enum { POINTS = 500 };
    static float positions[POINTS][3], normals[POINTS][3], first[2 * POINTS], values[2 * POINTS];
    for (size_t i = 0; i < POINTS; i++) {
        double u[2];
        pm__random_uniform(6, PM__FOR_TESTS, 0, i, u, 2);
        const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z);
        normals[i][0] = (float)(r * cos(6.283185307179586 * u[1]));
        normals[i][1] = (float)(r * sin(6.283185307179586 * u[1]));
        normals[i][2] = (float)z;
        for (int a = 0; a < 3; a++)
            positions[i][a] = -3.0f * normals[i][a];
    }
    for (size_t threads = 0; threads < 4; threads++) {
        size_t some = threads;
        const pm_parallel parallel = pm__parallel_for(&some);
        pm__importance_config config = importance_of(scene, &camera, 6000, PM__OF_BOTH);
        config.parallel = threads ? &parallel : NULL;
        config.share = 0.25;
        config.near = 1.0;
        pm__importance *const importance = importance_made(&config);
        for (int kind = 0; kind < PM__MAP_KINDS; kind++)
            pm__importance_at(importance, (pm__map_kind)kind, (const float(*)[3])positions,
                              (const float(*)[3])normals, POINTS, values + kind * POINTS);
        if (threads == 0)
            memcpy(first, values, sizeof first);
        ck_assert_mem_eq(values, first, sizeof first);
        pm__importance_destroy(importance);
    }
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("importance_bounds", a_view_of_nothing, all_in_one_place_or_hardly_any,
             footprints_that_are_none_do_not_count, points_that_are_none, what_is_refused, numbers_are_its_own,
             threads_do_not_matter)
