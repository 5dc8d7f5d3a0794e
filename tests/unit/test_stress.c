/* Rows of `stress`, and what it found: cases that once went wrong. Its judge: tests/oracle/test_stress_judge.c. */
#include "../../src/stress/stress.h"

#include "../../estimators/estimator.h"
#include "../../src/search/search.h"
#include "../../src/stress/judge.h"
#include "../../src/stress/test.h"
#include "../test.h"

#include <string.h>

/* ---- Rows -------------------------------------------------------------------------------------- */

typedef struct outcome {
    pm__stress_row *rows;
    size_t count;
} outcome;

/* The tests named, with disc, differential and hull, by wide, brute and grid. */
static outcome run(const char *tests, double factor, const pm_parallel *parallel)
{
    static pm__spec *specs;
    static size_t spec_count;
    bool wanted[64] = {false};
    const pm_search *searches[3] = {pm_search_find("wide"), pm_search_find("brute"), pm_search_find("grid")};
    pm_error error = {""};
    outcome o;
    for (size_t t = 0; t < pm__stress_test_count(); t++)
        wanted[t] = strstr(tests, pm__stress_test_name(t)) != NULL;
    if (!specs)
        PM_CHECK_OK(pm__spec_parse_list(&pm__estimators, "disc,differential,hull", &specs, &spec_count, &error), error);
    const pm__stress_config config = {.tests = wanted, .estimators = specs, .estimator_count = spec_count,
                                      .searches = searches, .search_count = 3, .seed = 1, .bound_factor = factor,
                                      .parallel = parallel};
    PM_CHECK_OK(pm__stress_run(&config, &o.rows, &o.count, &error), error);
    return o;
}

static size_t widths_here(void)
{
    pm__stress_widths widths;
    pm_error error = {""};
    PM_CHECK_OK(pm__stress_widths_here(&widths, &error), error);
    ck_assert_uint_eq(widths.count + widths.missing_count, PM__STRESS_WIDTHS);
    return widths.count;
}

START_TEST(test_a_row_for_each_subject)
{
    outcome o = run("collinear", 1.0, NULL);
    ck_assert_uint_eq(o.count, 4 * 3 * widths_here()); /* the searches alone, and three estimators */
    for (size_t i = 0; i < o.count; i++) {
        ck_assert_msg(o.rows[i].passed, "%s: %s", o.rows[i].subject, o.rows[i].detail);
        ck_assert_str_eq(o.rows[i].test, "collinear");
        ck_assert(o.rows[i].measured >= 0.0 && o.rows[i].measured <= o.rows[i].bound);
        ck_assert(*o.rows[i].detail && *o.rows[i].unit);
        for (size_t j = 0; j < i; j++)
            ck_assert_str_ne(o.rows[i].subject, o.rows[j].subject);
    }
    free(o.rows);
}
END_TEST

/* A bound that cannot hold fails the rows that have an error to show. */
START_TEST(test_a_wrong_bound_fails)
{
    outcome o = run("collinear, updates", -1.0, NULL);
    size_t failed = 0;
    for (size_t i = 0; i < o.count; i++) {
        ck_assert(o.rows[i].bound <= 0.0);
        ck_assert(o.rows[i].passed == !(o.rows[i].measured > o.rows[i].bound));
        failed += !o.rows[i].passed;
    }
    ck_assert_uint_gt(failed, o.count / 2);
    free(o.rows);
}
END_TEST

/* One subject of each test that takes long: a million updates, 1e8 terms. Nothing is exact there: their errors are not
 * 0, and below the bound. */
START_TEST(test_long_ones)
{
    static const char *const names[] = {"adapts", "sums"};
    const pm__stress_config config = {.seed = 1, .bound_factor = 1.0};
    for (size_t n = 0; n < 2; n++) {
        size_t t = 0;
        pm__stress_row row = {.unit = NULL};
        while (strcmp(pm__stress_tests[t]->name, names[n]) != 0)
            t++;
        ck_assert_uint_gt(pm__stress_tests[t]->subjects(false), 1);
        ck_assert_int_eq(pm__stress_tests[t]->measure(0, &config, &row), PM_OK);
        ck_assert_msg(row.measured > 0.0 && row.measured <= row.bound, "%s: %g of %g", names[n], row.measured,
                      row.bound);
        ck_assert_msg(strstr(row.detail, n ? "100663296 photons" : "") != NULL, "%s", row.detail);
    }
}
END_TEST

/* The last task first. */
static void backwards(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    (void)context;
    while (count-- > 0)
        task(argument, count);
}

START_TEST(test_rows_do_not_depend_on_who_does_what)
{
    const pm_parallel parallel = {backwards, NULL};
    outcome a = run("signs, grazing", 1.0, NULL), b = run("signs, grazing", 1.0, &parallel);
    ck_assert_uint_eq(a.count, b.count);
    for (size_t i = 0; i < a.count; i++) {
        ck_assert_str_eq(a.rows[i].subject, b.rows[i].subject);
        ck_assert_str_eq(a.rows[i].detail, b.rows[i].detail);
        ck_assert(a.rows[i].measured == b.rows[i].measured && a.rows[i].bound == b.rows[i].bound);
    }
    free(a.rows);
    free(b.rows);
}
END_TEST

static bool always(void *context)
{
    (void)context;
    return true;
}

START_TEST(test_canceled)
{
    pm__stress_row *rows;
    size_t count;
    pm_error error = {""};
    const pm__stress_config config = {.seed = 1, .bound_factor = 1.0, .canceled = always};
    ck_assert_int_eq(pm__stress_run(&config, &rows, &count, &error), PM_ECANCELED);
    ck_assert_uint_eq(count, 0);
    free(rows);
}
END_TEST

/* ---- What was found ---------------------------------------------------------------------------- */

enum { NEAR = 100 };

static pm_photon photons[NEAR + 1];

/* Photons 1 cm apart on a square lattice, 1 W each, and one far away. */
static pm_map *map_with_stray(float distance, const pm_search *search)
{
    const pm_map_options options = {.search = search};
    pm_map *map = NULL;
    pm_error error = {""};
    for (int i = 0; i < NEAR; i++)
        photons[i] = (pm_photon){.position = {0.01f * (float)(i % 10), 0.01f * (float)(i / 10), 0.0f},
                                 .power = {1.0f, 1.0f, 1.0f}};
    photons[NEAR] = photons[0];
    photons[NEAR].position[2] = distance;
    PM_CHECK_OK(pm_map_create(photons, NEAR + 1, &options, &map, &error), error);
    return map;
}

static pm_status ask(const char *name, const pm_map *map, const pm_query *query, pm_estimation *found)
{
    pm_estimator *estimator = NULL;
    pm_workspace *workspace = NULL;
    pm_error error = {""};
    PM_CHECK_OK(pm_estimator_create(name, &estimator, &error), error);
    ck_assert_int_eq(pm_workspace_create(0, &workspace), PM_OK);
    const pm_map *maps[64];
    for (int m = 0; m < 64; m++)
        maps[m] = map;
    const pm_source source = {.maps = maps, .map_count = pm_estimator_maps(estimator), .dimensions = 2};
    const pm_status status = pm_estimate(estimator, &source, query, workspace, found);
    pm_workspace_destroy(workspace);
    pm_estimator_destroy(estimator);
    return status;
}

/* Squared distances underflow in units of the stray photon's distance: once, lookups took photons from anywhere. */
START_TEST(test_a_stray_photon_gives_a_status)
{
    static const char *const names[] = {"disc", "cone", "hull", "differential", "combined", "combined:rule=mean"};
    static const float far[] = {1e3f, 1e10f, 1e15f, 1e19f, 1e20f, 1e25f, 1e30f, 3e38f};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        for (size_t j = 0; j < sizeof far / sizeof *far; j++)
            for (int by_radius = 0; by_radius < 2; by_radius++) {
                pm_map *const map = map_with_stray(far[j], NULL);
                pm_query query;
                pm_estimation found;
                pm_query_init(&query);
                query.position[0] = query.position[1] = 0.045f;
                query.k = by_radius ? 0 : 24;
                query.max_radius = by_radius ? 0.03f : INFINITY;
                const pm_status status = ask(names[i], map, &query, &found);
                const bool tells = far[j] < 1e16f;
                ck_assert_msg(status == (tells ? PM_OK : PM_EDEGENERATE), "%s: status %d at %g m", names[i],
                              (int)status, (double)far[j]);
                if (!tells)
                    ck_assert(found.value[0] == 0.0);
                else if (i == 0) /* 1e4 W/m2, but for where the disc's rim falls among the photons */
                    PM_CHECK_NEAR(found.value[0], 1e4, 2e3);
                pm_map_destroy(map);
            }
}
END_TEST

/* Photons at the very point stay what they were: without an area. */
START_TEST(test_coinciding_photons_are_not_stray)
{
    pm_map *map = map_with_stray(1.0f, NULL);
    pm_query query;
    pm_estimation found;
    pm_query_init(&query);
    query.k = 1;
    ck_assert_int_eq(ask("disc", map, &query, &found), PM_EDEGENERATE);
    query.max_radius = 1e-30f; /* too small to tell, and with nothing in it */
    query.position[0] = 0.005f;
    ck_assert_int_eq(ask("disc", map, &query, &found), PM_OK);
    ck_assert(found.count == 0 && found.value[0] == 0.0);
    pm_map_destroy(map);
}
END_TEST

/* An estimate stored at a photon has its radius to the last digit, also where floats are denormal. */
START_TEST(test_stored_radii_at_the_smallest_extents)
{
    pm_map *map = NULL;
    pm_estimator *estimator = NULL;
    pm_precomputed *stored = NULL;
    pm_workspace *workspace = NULL;
    pm_error error = {""};
    pm_precomputed_options options = {.dimensions = 2};
    pm_estimation found;
    for (int i = 0; i < NEAR; i++)
        photons[i] = (pm_photon){.position = {ldexpf((float)(7 * i), -147), ldexpf((float)i, -147), 0.0f},
                                 .power = {1.0f, 1.0f, 1.0f}};
    PM_CHECK_OK(pm_map_create(photons, NEAR, NULL, &map, &error), error);
    PM_CHECK_OK(pm_estimator_create("precomputed:fraction=1", &estimator, &error), error);
    pm_query_init(&options.lookup);
    options.lookup.k = 4;
    PM_CHECK_OK(pm_precomputed_create(estimator, map, &options, &stored, &error), error);
    ck_assert_int_eq(pm_workspace_create(0, &workspace), PM_OK);
    const pm_source source = {.maps = (const pm_map *const *)&map, .map_count = 1, .precomputed = stored,
                              .dimensions = 2};
    ck_assert_int_eq(pm_estimate(estimator, &source, &options.lookup, workspace, &found), PM_OK);
    /* to the fourth photon, at (21, 3) steps: no whole number of the least denormal */
    PM_CHECK_NEAR(found.radius * 0x1p147, sqrt(450.0), 1e-5);
    ck_assert(found.radius > 0.0 && found.count == 4);
    pm_workspace_destroy(workspace);
    pm_precomputed_destroy(stored);
    pm_estimator_destroy(estimator);
    pm_map_destroy(map);
}
END_TEST

/* A query is brought nearer where its square would overflow, but finds no photon beyond its radius by that. */
START_TEST(test_a_far_query_finds_what_its_radius_holds)
{
    static const char *const searches[] = {"wide",       "recursive", "iterative", "stackfree",
                                           "unbalanced", "grid",      "brute"};
    static const float far[] = {1e10f, 1e17f, 1e19f, 1e25f, 1e37f};
    for (size_t s = 0; s < sizeof searches / sizeof *searches; s++)
        for (size_t i = 0; i < sizeof far / sizeof *far; i++) {
            pm_map *const map = map_with_stray(0.5f, pm_search_find(searches[s]));
            pm_neighbor neighbors[NEAR + 1];
            size_t count;
            pm_query query;
            pm_query_init(&query);
            query.k = 0;
            query.position[1] = -far[i];
            query.max_radius = 0.5f * far[i];
            ck_assert_int_eq(pm_map_search(map, &query, neighbors, NEAR + 1, &count), PM_OK);
            ck_assert_msg(count == 0, "%s: %zu at %g m", searches[s], count, (double)far[i]);
            query.max_radius = 2.0f * far[i];
            ck_assert_int_eq(pm_map_search(map, &query, neighbors, NEAR + 1, &count), PM_OK);
            ck_assert_msg(count == NEAR + 1, "%s: %zu at %g m", searches[s], count, (double)far[i]);
            pm_estimation found;
            const pm_status status = ask("disc", map, &query, &found);
            ck_assert_int_eq(status, far[i] > 1e18f ? PM_EDEGENERATE : PM_OK);
            pm_map_destroy(map);
        }
}
END_TEST

PM_TEST_MAIN("stress", test_a_row_for_each_subject, test_a_wrong_bound_fails, test_long_ones,
             test_rows_do_not_depend_on_who_does_what, test_canceled, test_a_stray_photon_gives_a_status,
             test_coinciding_photons_are_not_stray, test_stored_radii_at_the_smallest_extents,
             test_a_far_query_finds_what_its_radius_holds)
