/* The public estimate from end to end: exact scaling, hopeless clouds, absurd requests, and threads. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/photonmap.h"
#include "../test.h"

#include <pthread.h>
#include <string.h>

enum { COUNT = 1000, MAX_MAPS = 64 };

static const char *const names[] = {"disc",
                                    "disc:last=none",
                                    "cone",
                                    "cone:k=0.5",
                                    "gaussian",
                                    "gaussian:form=pavicic",
                                    "gaussian:form=normalised",
                                    "epanechnikov",
                                    "biweight",
                                    "differential",
                                    "differential:rule=significance",
                                    "hull",
                                    "hull:boundary=0,outside=zero",
                                    "combined",
                                    "combined:rule=mean",
                                    "combined:maps=64",
                                    "precomputed",
                                    "precomputed:when=demand,form=unbiased"};
enum { NAMES = sizeof names / sizeof *names };

static pm_photon photons[COUNT], moved[COUNT];

static void draw(void)
{
    for (size_t i = 0; i < COUNT; i++) {
        double u[5];
        pm__random_uniform(3, PM__FOR_TESTS, 0, i, u, 4);
        pm__random_uniform(3, PM__FOR_TESTS, 1, i, u + 4, 1);
        photons[i] = (pm_photon){{(float)u[0], (float)u[1], 0.0f}, {0.0f, 0.0f, -1.0f},
                                 {(float)u[2], (float)u[3], (float)u[4]}};
    }
    memcpy(moved, photons, sizeof moved);
}

static pm_status estimate_with(pm_estimator *estimator, pm_map *const *maps, const pm_query *query, int dimensions,
                               pm_estimation *result)
{
    pm_workspace *workspace = NULL;
    pm_precomputed *stored = NULL;
    pm_status status = pm_workspace_create(0, &workspace);
    if (status == PM_OK && strncmp(pm_estimator_name(estimator), "precomputed", 11) == 0) {
        const pm_precomputed_options options = {.lookup = *query, .dimensions = dimensions};
        status = pm_precomputed_create(estimator, maps[0], &options, &stored, NULL);
    }
    const pm_source source = {.maps = (const pm_map *const *)maps, .map_count = pm_estimator_maps(estimator),
                              .precomputed = stored, .dimensions = dimensions};
    if (status == PM_OK)
        status = pm_estimate(estimator, &source, query, workspace, result);
    pm_precomputed_destroy(stored);
    pm_workspace_destroy(workspace);
    return status;
}

/* An estimate of `count` photons, dealt in turn to the maps that the estimator wants. */
static pm_status estimate(const char *name, const pm_photon *of, size_t count, const float at[3], size_t k,
                          double radius, int dimensions, pm_estimation *result)
{
    pm_map *maps[MAX_MAPS];
    pm_estimator *estimator = NULL;
    pm_error error = {""};
    PM_CHECK_OK(pm_estimator_create(name, &estimator, &error), error);
    const size_t map_count = pm_estimator_maps(estimator);
    pm_photon *const hand = pm__alloc(count, sizeof *hand);
    for (size_t m = 0; m < map_count; m++) {
        size_t held = 0;
        for (size_t i = m; i < count; i += map_count)
            hand[held++] = of[i];
        PM_CHECK_OK(pm_map_create(hand, held, NULL, &maps[m], &error), error);
    }
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, at, sizeof query.position);
    query.k = k;
    query.max_radius = (float)radius;
    const pm_status status = estimate_with(estimator, maps, &query, dimensions, result);
    for (size_t m = 0; m < map_count; m++)
        pm_map_destroy(maps[m]);
    free(hand);
    pm_estimator_destroy(estimator);
    return status;
}

static bool works_in(const char *name, int dimensions)
{
    return dimensions == 2 || strncmp(name, "hull", 4) != 0;
}

/* Lengths times 2^e: areal densities times 2^-2e and volume densities times 2^-3e, to the last bit. */
START_TEST(scales_exactly)
{
    static const int exponents[] = {-100, -30, -1, 17, 60, 120};
    const float at[3] = {0.5f, 0.5f, 0.0f};
    draw();
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++) {
        const double f = ldexp(1.0, exponents[e]);
        const float there[3] = {(float)(0.5 * f), (float)(0.5 * f), 0.0f};
        for (size_t i = 0; i < COUNT; i++)
            for (int a = 0; a < 2; a++)
                moved[i].position[a] = (float)((double)photons[i].position[a] * f);
        for (size_t n = 0; n < NAMES; n++)
            for (int dimensions = 2; dimensions <= 3 && works_in(names[n], dimensions); dimensions++)
                for (int cut = 0; cut < 2; cut++) {
                    const double radius = cut ? 0.0625 : INFINITY;
                    pm_estimation near, far;
                    const pm_status status = estimate(names[n], photons, COUNT, at, 200, radius, dimensions, &near);
                    ck_assert_int_eq(estimate(names[n], moved, COUNT, there, 200, radius * f, dimensions, &far),
                                     status);
                    ck_assert_uint_eq(near.count, far.count);
                    PM_CHECK_NEAR(far.radius, near.radius * f, 0.0);
                    for (int c = 0; c < 3; c++)
                        PM_CHECK_NEAR(far.value[c], ldexp(near.value[c], -dimensions * exponents[e]), 0.0);
                }
    }
}
END_TEST

/* Whatever the cloud, an estimate is a number that is not negative, or says that it does not exist. */
START_TEST(hopeless_clouds)
{
    static const struct {
        float even, odd, offset, even_power, odd_power;
    } clouds[] = {{1e30f, 1e30f, 0, 1, 1},   {1e-30f, 1e-30f, 0, 1, 1}, {1e-30f, 1e30f, 0, 1, 1},
                  {1, 1, 0, 1e-38f, 1e38f},  {1, 1, 1e5f, 1, 1},        {3e38f, 3e38f, 0, 3e38f, 3e38f},
                  {1e-44f, 1e-44f, 0, 1, 1}, {0, 0, 0.5f, 1, 1}};
    draw();
    for (size_t c = 0; c < sizeof clouds / sizeof *clouds; c++) {
        for (size_t i = 0; i < COUNT; i++)
            for (int a = 0; a < 3; a++) {
                const float size = i % 2 ? clouds[c].odd : clouds[c].even;
                moved[i].position[a] = a < 2 ? photons[i].position[a] * size + clouds[c].offset : 0.0f;
                moved[i].power[a] = photons[i].power[a] * (i % 2 ? clouds[c].odd_power : clouds[c].even_power);
            }
        for (size_t n = 0; n < NAMES; n++)
            for (size_t k = 200; k <= 2000; k += 1800) {
                pm_estimation result;
                const pm_status status = estimate(names[n], moved, COUNT, moved[7].position, k, INFINITY, 2, &result);
                ck_assert_msg(status == PM_OK || status == PM_EDEGENERATE, "%s: %s", names[n], pm_status_text(status));
                for (int a = 0; a < 3; a++)
                    ck_assert_msg(result.value[a] >= 0.0, "%s in cloud %zu: %g", names[n], c, result.value[a]);
                ck_assert(result.radius >= 0.0);
            }
    }
}
END_TEST

/* Powers below 0 are powers: with all signs turned the estimate's turns, and with some it is a number. */
START_TEST(negative_powers)
{
    const float at[3] = {0.5f, 0.5f, 0.0f};
    draw();
    for (size_t n = 0; n < NAMES; n++) {
        pm_estimation bright, dark, mixed;
        for (int sign = 0; sign < 2; sign++) { /* some, then all */
            for (size_t i = 0; i < COUNT; i++)
                for (int c = 0; c < 3; c++)
                    moved[i].power[c] = photons[i].power[c] * (sign || i % 2 ? -1.0f : 1.0f);
            ck_assert_int_eq(estimate(names[n], moved, COUNT, at, 200, INFINITY, 2, sign ? &dark : &mixed), PM_OK);
        }
        ck_assert_int_eq(estimate(names[n], photons, COUNT, at, 200, INFINITY, 2, &bright), PM_OK);
        ck_assert_msg(bright.value[0] > 0.0, "%s", names[n]);
        for (int c = 0; c < 3; c++) {
            ck_assert_msg(dark.value[c] == -bright.value[c], "%s: %g, %g", names[n], dark.value[c], bright.value[c]);
            ck_assert_msg(fabs(mixed.value[c]) < bright.value[c], "%s: %g", names[n], mixed.value[c]);
        }
    }
    pm_map *map = NULL;
    ck_assert_int_eq(pm_map_create(moved, COUNT, NULL, &map, NULL), PM_OK);
    ck_assert(pm_map_max_power(map) == 0.0);
    pm_map_destroy(map);
}
END_TEST

START_TEST(no_handles)
{
    pm_query query;
    pm_estimation result;
    pm_error error;
    size_t count;
    pm_query_init(&query);
    ck_assert_int_eq(pm_map_check(NULL, &error), PM_EINVAL);
    ck_assert_int_eq(pm_map_prepare(NULL, pm_search_find("brute"), NULL, &error), PM_EINVAL);
    ck_assert_int_eq(pm_map_search(NULL, &query, NULL, 0, &count), PM_EINVAL);
    ck_assert_int_eq(pm_map_search_batch(NULL, &query, 1, NULL, 0, &count), PM_EINVAL);
    ck_assert_int_eq(pm_map_search_each(NULL, &query, NULL, NULL), PM_EINVAL);
    ck_assert_int_eq(pm_map_create(photons, COUNT, NULL, NULL, &error), PM_EINVAL);
    ck_assert_int_eq(pm_estimator_create(NULL, NULL, &error), PM_EINVAL);
    ck_assert_int_eq(pm_workspace_create(1, NULL), PM_EINVAL);
    ck_assert_int_eq(pm_estimate(NULL, NULL, &query, NULL, &result), PM_EINVAL);
    ck_assert_int_eq(pm_precomputed_create(NULL, NULL, NULL, NULL, &error), PM_EINVAL);
    ck_assert_ptr_null(pm_search_find(NULL));
    pm_map_destroy(NULL);
    pm_estimator_destroy(NULL);
    pm_workspace_destroy(NULL);
    pm_precomputed_destroy(NULL);
    pm_free(NULL);
}
END_TEST

/* A map without photons sets no scale for the others, and has no part in the radius. */
START_TEST(empty_maps_among_others)
{
    static const int exponents[] = {-100, 0, 100};
    pm_estimator *estimator = NULL;
    ck_assert_int_eq(pm_estimator_create("combined:maps=2", &estimator, NULL), PM_OK);
    draw();
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++) {
        const double f = ldexp(1.0, exponents[e]);
        for (size_t i = 0; i < COUNT; i++)
            for (int a = 0; a < 2; a++)
                moved[i].position[a] = (float)((double)photons[i].position[a] * f);
        for (int first = 0; first < 2; first++) {
            pm_map *maps[2];
            ck_assert_int_eq(pm_map_create(moved, first ? COUNT : 0, NULL, &maps[0], NULL), PM_OK);
            ck_assert_int_eq(pm_map_create(moved, first ? 0 : COUNT, NULL, &maps[1], NULL), PM_OK);
            pm_query query;
            pm_query_init(&query);
            query.position[0] = query.position[1] = (float)(0.5 * f);
            query.k = 100; /* 50 of them in the one map that has photons */
            pm_estimation combined, alone;
            ck_assert_int_eq(estimate_with(estimator, maps, &query, 2, &combined), PM_OK);
            ck_assert_int_eq(estimate("disc", moved, COUNT, query.position, 50, INFINITY, 2, &alone), PM_OK);
            ck_assert_uint_eq(combined.count, 50);
            PM_CHECK_NEAR(combined.radius, alone.radius, 1e-15 * alone.radius);
            PM_CHECK_NEAR(combined.value[0], alone.value[0], 1e-14 * alone.value[0]);
            pm_map_destroy(maps[0]);
            pm_map_destroy(maps[1]);
        }
    }
    pm_estimator_destroy(estimator);
}
END_TEST

/* Which search answers never shows in an estimate that is stored at photons: not where it knows fixed radii only, nor
 * where the map was made for another first. */
START_TEST(stored_estimates_with_any_search)
{
    pm_estimator *estimator = NULL;
    pm_query query;
    pm_query_init(&query);
    query.position[0] = query.position[1] = 0.4f;
    query.k = 0;
    query.max_radius = 0.1f;
    pm_estimation plain, other;
    draw();
    ck_assert_int_eq(pm_estimator_create("precomputed", &estimator, NULL), PM_OK);
    for (int own = 0; own < 2; own++) { /* the map's own search, or one of the query's */
        static const char *const searches[] = {"recursive", "grid"};
        for (size_t s = 0; s < 2; s++) {
            const pm_search *const search = pm_search_find(searches[s]);
            const pm_map_options options = {.search = own ? search : pm_search_find("iterative")};
            pm_map *map = NULL;
            ck_assert_int_eq(pm_map_create(photons, COUNT, &options, &map, NULL), PM_OK);
            ck_assert_int_eq(pm_map_prepare(map, search, NULL, NULL), PM_OK);
            query.search = NULL;
            ck_assert_int_eq(estimate("precomputed", photons, COUNT, query.position, 0, 0.1, 2, &plain), PM_OK);
            query.search = own ? NULL : search;
            ck_assert_int_eq(estimate_with(estimator, &map, &query, 2, &other), PM_OK);
            ck_assert_uint_gt(other.count, 0);
            ck_assert_uint_eq(other.count, plain.count);
            PM_CHECK_NEAR(other.value[0], plain.value[0], 1e-12 * plain.value[0]);
            pm_map_destroy(map);
        }
    }
    pm_estimator_destroy(estimator);
}
END_TEST

START_TEST(absurd_requests)
{
    pm_estimation result, all;
    const float at[3] = {0.5f, 0.5f, 0.0f};
    draw();
    for (size_t n = 0; n < NAMES; n++) { /* any k is min(k, N) and takes no more memory than that */
        ck_assert_int_eq(estimate(names[n], photons, COUNT, at, (size_t)1 << 40, INFINITY, 2, &result), PM_OK);
        ck_assert_int_eq(estimate(names[n], photons, COUNT, at, (size_t)1 << 12, INFINITY, 2, &all), PM_OK);
        ck_assert(result.value[0] == all.value[0] || strncmp(names[n], "combined", 8) == 0);
        ck_assert_uint_eq(result.count, COUNT);
    }
    const pm_map_options options = {.split = (pm_split)7};
    pm_map *map = NULL;
    ck_assert_int_eq(pm_map_create(photons, COUNT, &options, &map, NULL), PM_EINVAL);
    ck_assert_ptr_null(map);

    pm_estimator *estimator = NULL;
    pm_workspace *workspace = NULL;
    pm_query query;
    pm_query_init(&query);
    ck_assert_int_eq(pm_estimator_create("disc", &estimator, NULL), PM_OK);
    ck_assert_int_eq(pm_workspace_create(0, &workspace), PM_OK);
    const pm_map *const none[] = {NULL};
    pm_source source = {.maps = none, .map_count = 1, .dimensions = 2};
    ck_assert_int_eq(pm_estimate(estimator, &source, &query, workspace, &result), PM_EINVAL);
    source.maps = NULL;
    ck_assert_int_eq(pm_estimate(estimator, &source, &query, workspace, &result), PM_EINVAL);
    ck_assert_int_eq(pm_estimate(NULL, &source, &query, workspace, &result), PM_EINVAL);
    ck_assert_int_eq(pm_estimate(estimator, NULL, &query, workspace, &result), PM_EINVAL);
    ck_assert_int_eq(pm_estimate(estimator, &source, NULL, workspace, &result), PM_EINVAL);
    ck_assert_int_eq(pm_estimate(estimator, &source, &query, NULL, &result), PM_EINVAL);
    ck_assert_int_eq(pm_estimate(estimator, &source, &query, workspace, NULL), PM_EINVAL);
    pm_workspace_destroy(workspace);
    pm_estimator_destroy(estimator);
}
END_TEST

enum { THREADS = 8, QUERIES = 400 };

typedef struct reader {
    const pm_map *map;
    const pm_precomputed *stored;
    const pm_estimator *hull, *precomputed;
    double got[QUERIES][2];
} reader;

static void *read_map(void *argument)
{
    reader *const r = argument;
    pm_workspace *workspace = NULL;
    pm_query query;
    pm_query_init(&query);
    if (pm_workspace_create(0, &workspace) != PM_OK)
        return NULL;
    for (size_t q = 0; q < QUERIES; q++) {
        double u[2];
        pm_estimation result;
        pm__random_uniform(4, PM__FOR_TESTS, 2, q, u, 2);
        query.position[0] = (float)u[0];
        query.position[1] = (float)u[1];
        const pm_source source = {.maps = &r->map, .map_count = 1, .dimensions = 2};
        (void)pm_estimate(r->hull, &source, &query, workspace, &result);
        r->got[q][0] = result.value[0];
        const pm_source from_stored = {.precomputed = r->stored, .dimensions = 2};
        (void)pm_estimate(r->precomputed, &from_stored, &query, workspace, &result);
        r->got[q][1] = result.value[0];
    }
    pm_workspace_destroy(workspace);
    return NULL;
}

/* One map and one set of estimates on demand, asked by many threads at once: all are told the same. */
START_TEST(threads_share_a_map)
{
    static reader readers[THREADS];
    pm_map *map = NULL;
    pm_precomputed *stored = NULL;
    pm_estimator *hull = NULL, *precomputed = NULL;
    pm_precomputed_options options = {.dimensions = 2};
    pthread_t threads[THREADS];
    draw();
    pm_query_init(&options.lookup);
    ck_assert_int_eq(pm_map_create(photons, COUNT, NULL, &map, NULL), PM_OK);
    ck_assert_int_eq(pm_estimator_create("hull", &hull, NULL), PM_OK);
    ck_assert_int_eq(pm_estimator_create("precomputed:when=demand", &precomputed, NULL), PM_OK);
    ck_assert_int_eq(pm_precomputed_create(precomputed, map, &options, &stored, NULL), PM_OK);
    ck_assert_uint_eq(pm_precomputed_computed(stored), 0);
    for (size_t t = 0; t < THREADS; t++) {
        readers[t] = (reader){.map = map, .stored = stored, .hull = hull, .precomputed = precomputed};
        ck_assert_int_eq(pthread_create(&threads[t], NULL, read_map, &readers[t]), 0);
    }
    for (size_t t = 0; t < THREADS; t++)
        ck_assert_int_eq(pthread_join(threads[t], NULL), 0);
    for (size_t q = 0; q < QUERIES; q++)
        ck_assert(readers[0].got[q][0] > 0.0 && readers[0].got[q][1] > 0.0);
    for (size_t t = 1; t < THREADS; t++)
        ck_assert(!memcmp(readers[t].got, readers[0].got, sizeof readers[0].got));
    ck_assert_uint_gt(pm_precomputed_computed(stored), 0);
    ck_assert_uint_le(pm_precomputed_computed(stored), COUNT / 4);
    pm_precomputed_destroy(stored);
    pm_estimator_destroy(precomputed);
    pm_estimator_destroy(hull);
    pm_map_destroy(map);
}
END_TEST

PM_TEST_MAIN("lookup", scales_exactly, hopeless_clouds, negative_powers, no_handles, empty_maps_among_others,
             stored_estimates_with_any_search, absurd_requests, threads_share_a_map)
