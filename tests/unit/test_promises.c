/* docs/promises.md against the header, and every bad input that it lists given to the library. Files are named from the
 * repository's root, where tests run. */
#include "../../src/photonmap.h"
#include "../files.h"
#include "../test.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { TEXT_SIZE = 1 << 18, COUNT = 40, NAME = 64, PHRASE = 120 };

static const char *text_of(const char *path)
{
    static char header[TEXT_SIZE], page[TEXT_SIZE];
    char *const text = strstr(path, ".h") ? header : page;
    if (!*text)
        (void)pm__test_read(path, text, TEXT_SIZE);
    ck_assert_msg(*text != '\0', "%s cannot be read", path);
    return text;
}

/* ---- What bad input is given to ----------------------------------------------------------------- */

static pm_photon photons[COUNT];
static pm_map *map, *no_directions, *together, *lined_up;
static pm_estimator *disc, *hull, *stored;
static pm_workspace *workspace;
static pm_neighbor neighbors[COUNT];
static size_t found;
static pm_query query;
static pm_error error;

static pm_map *map_of(bool without)
{
    pm_map *made = NULL;
    const pm_map_options options = {.no_directions = without};
    PM_CHECK_OK(pm_map_create(photons, COUNT, &options, &made, &error), error);
    return made;
}

static void place(float dx, float dy)
{
    for (int i = 0; i < COUNT; i++)
        photons[i] = (pm_photon){
            {dx * (float)(i % 7), dy * (float)(i / 7), 0.0f}, {0.0f, 0.0f, -1.0f}, {1.0f, 1.0f, 1.0f}};
}

static void setup(void)
{
    place(0.0f, 0.0f);
    together = map_of(false);
    place(1.0f, 0.0f);
    lined_up = map_of(false);
    place(1.0f, 1.0f);
    map = map_of(false);
    no_directions = map_of(true);
    PM_CHECK_OK(pm_estimator_create("disc", &disc, &error), error);
    PM_CHECK_OK(pm_estimator_create("hull", &hull, &error), error);
    PM_CHECK_OK(pm_estimator_create("precomputed", &stored, &error), error);
    ck_assert_int_eq(pm_workspace_create(COUNT, &workspace), PM_OK);
    pm_query_init(&query);
    query.k = 10;
    found = 77;
}

static void teardown(void)
{
    pm_map_destroy(map);
    pm_map_destroy(no_directions);
    pm_map_destroy(together);
    pm_map_destroy(lined_up);
    pm_estimator_destroy(disc);
    pm_estimator_destroy(hull);
    pm_estimator_destroy(stored);
    pm_workspace_destroy(workspace);
}

/* ---- Maps and searches -------------------------------------------------------------------------- */

static pm_status create(const pm_photon *from, size_t count, const pm_map_options *options)
{
    pm_map *made = map;
    const pm_status status = pm_map_create(from, count, options, &made, &error);
    ck_assert_ptr_null(made);
    return status;
}

static pm_status prepare_wide(void)
{
    pm_map *tree = NULL;
    const pm_map_options options = {.search = pm_search_find("recursive")};
    PM_CHECK_OK(pm_map_create(photons, COUNT, &options, &tree, &error), error);
    const pm_status status = pm_map_prepare(tree, pm_search_find("wide"), NULL, &error);
    pm_map_destroy(tree);
    return status;
}

static pm_status search(const pm_map *of, size_t room)
{
    return pm_map_search(of, &query, neighbors, room, &found);
}

static pm_status batch(const pm_map *of, size_t room)
{
    return pm_map_search_batch(of, &query, 1, neighbors, room, &found);
}

/* More photons within the radius than there is room for: their number is told. */
static pm_status search_radius(void)
{
    query.k = 0;
    query.max_radius = 100.0f;
    const pm_status status = search(map, 9);
    ck_assert_uint_eq(found, COUNT);
    found = 0;
    return status;
}

static bool receive(void *context, const pm_neighbor *some, size_t count)
{
    (void)some;
    *(size_t *)context += count;
    return true;
}

static pm_status each(const pm_map *of, pm_deliver deliver)
{
    query.max_radius = 2.0f;
    return pm_map_search_each(of, &query, deliver, &found);
}

/* ---- Estimates ---------------------------------------------------------------------------------- */

static pm_status estimator(const char *spec)
{
    pm_estimator *made = disc;
    const pm_status status = pm_estimator_create(spec, &made, &error);
    ck_assert_ptr_null(made);
    return status;
}

static pm_status huge_workspace(void)
{
    pm_workspace *made = workspace;
    const pm_status status = pm_workspace_create(SIZE_MAX, &made);
    ck_assert_ptr_null(made);
    return status;
}

static pm_status estimate_of(const pm_estimator *by, const pm_source *source, const pm_query *at, pm_workspace *with)
{
    pm_estimation got = {{1.0, 1.0, 1.0}, 1.0, 1};
    const pm_status status = pm_estimate(by, source, at, with, &got);
    for (int b = 0; b < 3; b++)
        PM_CHECK_NEAR(got.value[b], 0.0, 0.0);
    return status;
}

static pm_status estimate(const pm_estimator *by, const pm_map *of, size_t maps, int dimensions)
{
    const pm_source source = {.maps = &of, .map_count = maps, .dimensions = dimensions};
    return estimate_of(by, &source, &query, workspace);
}

static pm_status estimate_without(const pm_query *at, pm_workspace *with)
{
    const pm_map *const of = map;
    const pm_source source = {.maps = &of, .map_count = 1, .dimensions = 2};
    return estimate_of(disc, &source, at, with);
}

static void give_nan(void *context, const float incoming[3], const float outgoing[3], float value[3])
{
    (void)context;
    (void)incoming;
    (void)outgoing;
    value[0] = value[1] = 1.0f;
    value[2] = NAN;
}

static pm_status estimate_with_nan(void)
{
    const pm_map *const of = map;
    const pm_source source = {.maps = &of, .map_count = 1, .dimensions = 2, .brdf = give_nan};
    return estimate_of(disc, &source, &query, workspace);
}

static pm_status precompute(const pm_estimator *by, const pm_map *of)
{
    const pm_precomputed_options options = {.lookup = query, .dimensions = 2};
    pm_precomputed *made = (pm_precomputed *)(void *)map;
    const pm_status status = pm_precomputed_create(by, of, &options, &made, &error);
    ck_assert_ptr_null(made);
    return status;
}

/* ---- Files -------------------------------------------------------------------------------------- */

static pm_status read_photons(const char *path)
{
    pm_photon *read = photons;
    const pm_status status = pm_ply_read_photons(path, &read, NULL, &found, &error);
    ck_assert_ptr_null(read);
    return status;
}

static pm_status write_nan(void)
{
    photons[COUNT - 1].position[1] = NAN;
    return pm_ply_write_photons("/dev/null", photons, COUNT, &error);
}

static pm_status read_points(const char *path)
{
    pm_surface_point *read = (pm_surface_point *)(void *)photons;
    const pm_status status = pm_ply_read_points(path, &read, &found, &error);
    ck_assert_ptr_null(read);
    return status;
}

static pm_status read_text(const char *text, pm_status (*read)(const char *path))
{
    const pm__test_directory directory = pm__test_directory_create();
    char path[PM__TEST_PATH];
    pm__test_write(pm__test_path(&directory, "p.ply", path), text, strlen(text));
    const pm_status status = read(path);
    pm__test_directory_remove(&directory);
    return status;
}

static const char nan_photon[] =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
    "property float dx\nproperty float dy\nproperty float dz\nproperty float r\nproperty float g\nproperty float b\n"
    "end_header\n0 nan 0 0 0 -1 1 1 1\n";

/* ---- The page ----------------------------------------------------------------------------------- */

/* A function, what it is given, and how. */
#define BAD_INPUTS(X)                                                                                                \
    X("pm_map_create", "a NaN position", (photons[3].position[1] = NAN, create(photons, COUNT, NULL)))               \
    X("pm_map_create", "an infinite power", (photons[3].power[1] = INFINITY, create(photons, COUNT, NULL)))          \
    X("pm_map_create", "a NaN direction", (photons[3].direction[2] = NAN, create(photons, COUNT, NULL)))             \
    X("pm_map_create", "no photons but a count", create(NULL, 1, NULL))                                              \
    X("pm_map_create", "more than the largest number", create(photons, PM_MAX_PHOTONS + 1, NULL))                    \
    X("pm_map_create", "no place for the map", pm_map_create(photons, COUNT, NULL, NULL, &error))                    \
    X("pm_map_create", "a width that is none", create(photons, COUNT, &(pm_map_options){.simd = (pm_simd)77}))       \
    X("pm_map_prepare", "no map", pm_map_prepare(NULL, pm_search_find("brute"), NULL, &error))                       \
    X("pm_map_prepare", "no search", pm_map_prepare(map, NULL, NULL, &error))                                        \
    X("pm_map_prepare", "`wide`", prepare_wide())                                                                    \
    X("pm_map_check", "no map", pm_map_check(NULL, &error))                                                          \
    X("pm_map_search", "no map", search(NULL, COUNT))                                                                \
    X("pm_map_search", "no query", pm_map_search(map, NULL, neighbors, COUNT, &found))                               \
    X("pm_map_search", "a NaN position", (query.position[2] = NAN, search(map, COUNT)))                              \
    X("pm_map_search", "an infinite position", (query.position[0] = -INFINITY, search(map, COUNT)))                  \
    X("pm_map_search", "a NaN radius", (query.max_radius = NAN, search(map, COUNT)))                                 \
    X("pm_map_search", "a negative radius", (query.max_radius = -1.0f, search(map, COUNT)))                          \
    X("pm_map_search", "neither k nor a radius", (query.k = 0, search(map, COUNT)))                                  \
    X("pm_map_search", "no normal where the shape needs one",                                                        \
      (query.shape = PM_LOOKUP_DISC, query.normal[2] = 0.0f, search(map, COUNT)))                                    \
    X("pm_map_search", "an ellipsoid's factor below 1",                                                              \
      (query.shape = PM_LOOKUP_ELLIPSOID, query.shape_parameter = 0.5f, search(map, COUNT)))                         \
    X("pm_map_search", "a disc of negative height",                                                                  \
      (query.shape = PM_LOOKUP_DISC, query.shape_parameter = -1.0f, search(map, COUNT)))                             \
    X("pm_map_search", "a search that the map was not made for",                                                     \
      (query.search = pm_search_find("recursive"), search(map, COUNT)))                                              \
    X("pm_map_search", "less room than k", search(map, 9))                                                           \
    X("pm_map_search", "a radius that holds more than the room", search_radius())                                    \
    X("pm_map_search", "a side, of a map without directions",                                                        \
      (query.front_only = true, search(no_directions, COUNT)))                                                       \
    X("pm_map_search_batch", "no map", batch(NULL, COUNT))                                                           \
    X("pm_map_search_batch", "a NaN position", (query.position[0] = NAN, batch(map, COUNT)))                         \
    X("pm_map_search_batch", "less room than k", batch(map, 9))                                                      \
    X("pm_map_search_each", "no map", each(NULL, receive))                                                           \
    X("pm_map_search_each", "no receiver", each(map, NULL))                                                          \
    X("pm_map_search_each", "a NaN position", (query.position[0] = NAN, each(map, receive)))                         \
    X("pm_estimator_create", "no text", estimator(NULL))                                                             \
    X("pm_estimator_create", "a name that is none", estimator("disk"))                                               \
    X("pm_estimator_create", "a parameter that is none", estimator("disc:first=half"))                               \
    X("pm_estimator_create", "a value out of its range", estimator("cone:k=0"))                                      \
    X("pm_workspace_create", "no place for it", pm_workspace_create(COUNT, NULL))                                    \
    X("pm_workspace_create", "more than memory holds", huge_workspace())                                             \
    X("pm_estimate", "no estimator", estimate(NULL, map, 1, 2))                                                      \
    X("pm_estimate", "no source", estimate_of(disc, NULL, &query, workspace))                                        \
    X("pm_estimate", "no query", estimate_without(NULL, workspace))                                                  \
    X("pm_estimate", "no workspace", estimate_without(&query, NULL))                                                 \
    X("pm_estimate", "no maps", estimate(disc, map, 0, 2))                                                           \
    X("pm_estimate", "four dimensions", estimate(disc, map, 1, 4))                                                   \
    X("pm_estimate", "a NaN position", (query.position[0] = NAN, estimate(disc, map, 1, 2)))                         \
    X("pm_estimate", "fewer photons than the estimator can use", (query.k = 2, estimate(hull, map, 1, 2)))           \
    X("pm_estimate", "all photons at distance 0", estimate(disc, together, 1, 2))                                    \
    X("pm_estimate", "neighbours on a line, of a hull", estimate(hull, lined_up, 1, 2))                              \
    X("pm_estimate", "a query farther than floats can tell", (query.position[0] = 1e30f, estimate(disc, map, 1, 2))) \
    X("pm_estimate", "`precomputed` without stored estimates", estimate(stored, map, 1, 2))                          \
    X("pm_estimate", "a BRDF that gives NaN", estimate_with_nan())                                                   \
    X("pm_precomputed_create", "no map", precompute(stored, NULL))                                                   \
    X("pm_precomputed_create", "another estimator", precompute(disc, map))                                           \
    X("pm_precomputed_create", "a lookup that is none", (query.k = 0, precompute(stored, map)))                      \
    X("pm_ply_read_photons", "no path", read_photons(NULL))                                                          \
    X("pm_ply_read_photons", "a file that is not there", read_photons("/nowhere/photons.ply"))                       \
    X("pm_ply_read_photons", "a directory", read_photons("/"))                                                       \
    X("pm_ply_read_photons", "a text that is no PLY", read_text("photons\n", read_photons))                          \
    X("pm_ply_read_photons", "a NaN among its numbers", read_text(nan_photon, read_photons))                         \
    X("pm_ply_read_points", "a file that is not there", read_points("/nowhere/points.ply"))                          \
    X("pm_ply_read_points", "a text that is no PLY", read_text("points\n", read_points))                             \
    X("pm_ply_write_photons", "no path", pm_ply_write_photons(NULL, photons, COUNT, &error))                         \
    X("pm_ply_write_photons", "no photons but a count", pm_ply_write_photons("/dev/null", NULL, COUNT, &error))      \
    X("pm_ply_write_photons", "more than memory holds",                                                              \
      pm_ply_write_photons("/dev/null", photons, SIZE_MAX, &error))                                                  \
    X("pm_ply_write_photons", "a NaN position", write_nan())                                                         \
    X("pm_ply_write_photons", "a folder that is not there",                                                          \
      pm_ply_write_photons("/nowhere/photons.ply", photons, COUNT, &error))

typedef struct bad_input {
    const char *function, *given;
} bad_input;

static const bad_input bad_inputs[] = {
#define X(function, given, how) {function, given},
    BAD_INPUTS(X)
#undef X
};
enum { BAD_COUNT = sizeof bad_inputs / sizeof *bad_inputs };

static pm_status give(int which)
{
    int i = 0;
#define X(function, given, how) \
    if (i++ == which)           \
        return how;
    BAD_INPUTS(X)
#undef X
    return PM_OK;
}

static const char *code_of(pm_status status)
{
    static const char *const codes[] = {
#define X(name, code, text) #name,
        PM_STATUS_LIST(X)
#undef X
    };
    return codes[status];
}

/* Each answers as its row of the page says, with a sentence where it has a pm_error. */
START_TEST(bad_input_gets_what_the_page_says)
{
    const bad_input *const b = &bad_inputs[_i];
    char row[NAME + PHRASE + 40];
    const pm_status status = give(_i);
    ck_assert_msg(status != PM_OK, "%s, given %s: OK", b->function, b->given);
    (void)snprintf(row, sizeof row, "| `%s` | %s | `%s` |", b->function, b->given, code_of(status));
    ck_assert_msg(strstr(text_of("docs/promises.md"), row) != NULL, "docs/promises.md lacks %s", row);
    if (strcmp(b->function, "pm_map_search") == 0 || strcmp(b->function, "pm_map_search_batch") == 0 ||
        strncmp(b->function, "pm_ply_read", 11) == 0)
        ck_assert_uint_eq(found, 0);
    else
        ck_assert_uint_eq(found, 77);
}
END_TEST

/* The next row of a table from `at` on: its first two cells, the first in backticks. */
static const char *next_row(const char *at, char function[NAME], char second[PHRASE])
{
    while ((at = strstr(at, "\n| `pm_")) != NULL) {
        at += 3;
        if (sscanf(at, "`%63[a-z_]` | %119[^|]", function, second) == 2) {
            for (size_t n = strlen(second); n && second[n - 1] == ' '; n--)
                second[n - 1] = '\0';
            return at;
        }
    }
    return NULL;
}

START_TEST(all_that_the_page_says_is_tried)
{
    const char *at = strstr(text_of("docs/promises.md"), "\n## Bad input");
    char function[NAME], given[PHRASE];
    size_t rows = 0;
    ck_assert_ptr_nonnull(at);
    while ((at = next_row(at, function, given)) != NULL) {
        size_t i = 0;
        while (i < BAD_COUNT &&
               (strcmp(function, bad_inputs[i].function) != 0 || strcmp(given, bad_inputs[i].given) != 0))
            i++;
        ck_assert_msg(i < BAD_COUNT, "%s, given %s, is not tried", function, given);
        rows++;
    }
    ck_assert_uint_eq(rows, BAD_COUNT);
}
END_TEST

/* The functions of the header and of the page's first table are the same, each once. */
START_TEST(every_public_function_has_a_promise)
{
    const char *const page = text_of("docs/promises.md"), *const end = strstr(page, "\n## Bad input");
    char name[NAME], row[NAME + 8];
    size_t functions = 0, rows = 0;
    for (const char *at = text_of("src/photonmap.h"); (at = strstr(at, "\nPM_API ")) != NULL;) {
        const char *from = strchr(at += 8, '(');
        ck_assert_ptr_nonnull(from);
        size_t length = 0;
        while (isalnum((unsigned char)from[-1]) || from[-1] == '_')
            from--, length++;
        (void)snprintf(name, sizeof name, "%.*s", (int)length, from);
        (void)snprintf(row, sizeof row, "\n| `%s` |", name);
        const char *const first = strstr(page, row);
        ck_assert_msg(first && first < end, "docs/promises.md has no row of %s", name);
        const char *const second = strstr(first + 1, row);
        ck_assert_msg(!second || second > end, "docs/promises.md has two rows of %s", name);
        functions++;
    }
    for (const char *at = page; (at = strstr(at, "\n| `pm_")) != NULL && at < end; at++)
        rows++;
    ck_assert_uint_eq(functions, rows);
    ck_assert_uint_gt(functions, 30);
}
END_TEST

/* NULL where the page allows it, and readers of anything. */
START_TEST(what_may_be_nothing)
{
    pm_map_destroy(NULL);
    pm_estimator_destroy(NULL);
    pm_workspace_destroy(NULL);
    pm_precomputed_destroy(NULL);
    pm_free(NULL);
    ck_assert_ptr_null(pm_search_find(NULL));
    ck_assert_ptr_null(pm_search_find("widest"));
    for (int status = -3; status < 20; status++)
        ck_assert_ptr_nonnull(pm_status_text((pm_status)status));
    PM_CHECK_NEAR(pm_max_radius_surface(10, -1.0, 1.0), 0.0, 0.0);
    PM_CHECK_NEAR(pm_max_radius_surface(10, NAN, 1.0), 0.0, 0.0);
    PM_CHECK_NEAR(pm_max_radius_surface(10, INFINITY, INFINITY), 0.0, 0.0);
    PM_CHECK_NEAR(pm_max_radius_volume(10, 1.0, 0.0, 1.0), 0.0, 0.0);
    PM_CHECK_NEAR(pm_max_radius_volume(10, INFINITY, 1.0, INFINITY), 0.0, 0.0);
    PM_CHECK_NEAR(pm_max_radius_surface(1, DBL_MAX, DBL_TRUE_MIN), DBL_MAX, 0.0);
    PM_CHECK_NEAR(pm_max_radius_volume(1, DBL_MAX, DBL_TRUE_MIN, DBL_TRUE_MIN), DBL_MAX, 0.0);
}
END_TEST

int main(void)
{
    Suite *const suite = suite_create("promises");
    TCase *const tcase = tcase_create("promises");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, bad_input_gets_what_the_page_says, 0, BAD_COUNT);
    tcase_add_test(tcase, all_that_the_page_says_is_tried);
    tcase_add_test(tcase, every_public_function_has_a_promise);
    tcase_add_test(tcase, what_may_be_nothing);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
