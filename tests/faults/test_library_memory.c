/* libphotonmap when memory runs out at any moment: each public function that allocates, one allocation after the other
 * refused. */
#include "../../src/photonmap.h"
#include "../files.h"
#include "allocation.h"

#include <stdlib.h>

/* Enough for hints of `wide` (4096 photons and more), few enough for some hundred builds. */
enum { PHOTONS = 5000, K = 20 };

static pm_photon photons[PHOTONS];
static float normals[PHOTONS][3];

static const char *const searches[] = {"wide", "recursive", "iterative", "stackfree", "unbalanced", "grid", "brute"};
enum { SEARCHES = sizeof searches / sizeof *searches };

static void scatter(void)
{
    uint32_t x = 1;
    for (size_t i = 0; i < PHOTONS; i++) {
        for (int axis = 0; axis < 3; axis++) {
            x = x * 1664525u + 1013904223u;
            photons[i].position[axis] = axis < 2 ? (float)(x >> 8) / (float)(1 << 24) : 0.0f;
            photons[i].power[axis] = 1.0f;
            photons[i].direction[axis] = axis < 2 ? 0.0f : -1.0f;
            normals[i][axis] = axis < 2 ? 0.0f : 1.0f;
        }
    }
}

static pm_query query_of(const char *search)
{
    pm_query query;
    pm_query_init(&query);
    query.position[0] = query.position[1] = 0.5f;
    query.k = strcmp(search, "grid") == 0 ? 0 : K;
    query.max_radius = query.k ? INFINITY : 0.05f;
    return query;
}

static void digest_found(const pm_map *map, const char *search, uint64_t *digest)
{
    static pm_neighbor found[PHOTONS];
    size_t count = 0;
    const pm_query query = query_of(search);
    PM_MUST(pm_map_search(map, &query, found, PHOTONS, &count) == PM_OK);
    for (size_t i = 0; i < count; i++) {
        const uint32_t source = pm_map_source(map, found[i].number);
        pm__digest(digest, &source, sizeof source);
    }
}

/* ---- Maps -------------------------------------------------------------------------------------- */

typedef struct building {
    const char *search, *further;
    bool no_directions;
} building;

static pm_status build(void *context, uint64_t *digest, pm_error *error)
{
    const building *const b = context;
    const pm_map_options options = {.search = pm_search_find(b->search), .no_directions = b->no_directions};
    pm_map *map = (pm_map *)(uintptr_t)1;
    pm_status status = pm_map_create(photons, PHOTONS, &options, &map, error);
    PM_MUST(status == PM_OK || map == NULL);
    if (status == PM_OK && b->further)
        status = pm_map_prepare(map, pm_search_find(b->further), NULL, error);
    if (status == PM_OK)
        digest_found(map, b->search, digest);
    pm_map_destroy(map);
    return status;
}

START_TEST(maps)
{
    scatter();
    for (size_t i = 0; i < SEARCHES; i++)
        for (int bare = 0; bare < 2; bare++)
            pm__each_refusal(searches[i], build, &(building){searches[i], NULL, bare == 1});
}
END_TEST

START_TEST(further_structures)
{
    scatter();
    for (size_t i = 1; i < SEARCHES; i++)
        for (size_t j = 1; j < SEARCHES; j++)
            pm__each_refusal(searches[j], build, &(building){searches[i], searches[j], false});
}
END_TEST

/* A structure that could not be added can be added later, and the map is as it was meanwhile. */
START_TEST(a_map_survives)
{
    pm_error error;
    scatter();
    for (size_t i = 1; i < SEARCHES; i++) {
        pm_map *map;
        uint64_t before = 0, after = 0, at_last = 0;
        PM_CHECK_OK(pm_map_create(photons, PHOTONS, &(pm_map_options){.search = pm_search_find("brute")}, &map, &error),
                    error);
        digest_found(map, "brute", &before);
        pm_status status = PM_ENOMEM;
        for (uint64_t n = 1; status != PM_OK; n++) {
            after = 0;
            pm__refuse_from(n, false);
            status = pm_map_prepare(map, pm_search_find(searches[i]), NULL, &error);
            (void)pm__refuse_none();
            PM_MUST(status == PM_OK || status == PM_ENOMEM);
            digest_found(map, "brute", &after);
            ck_assert_uint_eq(before, after);
        }
        pm_query query = query_of(searches[i]);
        pm_neighbor found[1000];
        size_t count;
        query.search = pm_search_find(searches[i]);
        ck_assert_int_eq(pm_map_search(map, &query, found, 1000, &count), PM_OK);
        ck_assert_uint_ge(count, K);
        pm__digest(&at_last, &count, sizeof count);
        pm_map_destroy(map);
    }
}
END_TEST

static pm_status check_map(void *context, uint64_t *digest, pm_error *error)
{
    (void)digest;
    return pm_map_check(context, error);
}

START_TEST(checks_of_maps)
{
    pm_error error;
    scatter();
    for (size_t i = 0; i < SEARCHES; i++) {
        pm_map *map;
        PM_CHECK_OK(pm_map_create(photons, PHOTONS, &(pm_map_options){.search = pm_search_find(searches[i])}, &map,
                                  &error), error);
        pm__each_refusal(searches[i], check_map, map);
        pm_map_destroy(map);
    }
}
END_TEST

/* Searches allocate nothing, whatever is asked. */
static bool take(void *context, const pm_neighbor *neighbors, size_t count)
{
    (void)neighbors;
    *(size_t *)context += count;
    return true;
}

START_TEST(searches_need_none)
{
    enum { QUERIES = 40, STRIDE = 400 };
    static pm_neighbor found[QUERIES * STRIDE];
    pm_error error;
    scatter();
    for (size_t i = 0; i < SEARCHES; i++) {
        pm_map *map;
        pm_query queries[QUERIES];
        size_t counts[QUERIES], delivered = 0;
        PM_CHECK_OK(pm_map_create(photons, PHOTONS, &(pm_map_options){.search = pm_search_find(searches[i])}, &map,
                                  &error), error);
        for (size_t q = 0; q < QUERIES; q++) {
            queries[q] = query_of(searches[i]);
            queries[q].position[0] = (float)q / QUERIES;
        }
        pm_query each = queries[0];
        each.max_radius = 0.5f;
        pm__refuse_from(1, true);
        const pm_status one = pm_map_search(map, &queries[20], found, STRIDE, &counts[0]);
        const pm_status many = pm_map_search_batch(map, queries, QUERIES, found, STRIDE, counts);
        const pm_status all = pm_map_search_each(map, &each, take, &delivered);
        ck_assert_msg(!pm__refuse_none(), "%s allocates", searches[i]);
        ck_assert(one == PM_OK && many == PM_OK && all == PM_OK && delivered > 0);
        pm_map_destroy(map);
    }
}
END_TEST

/* ---- Estimates --------------------------------------------------------------------------------- */

static const char *const estimators[] = {
    "disc", "disc:last=half", "cone", "gaussian", "epanechnikov", "biweight", "differential", "hull", "hull:boundary=0",
    "combined", "precomputed", "precomputed:when=demand"};
enum { ESTIMATORS = sizeof estimators / sizeof *estimators };

typedef struct estimating {
    const char *spec;
    const pm_map *maps[8];
    size_t max_k, k;
} estimating;

static pm_status say(pm_status status, pm_error *error)
{
    return status == PM_OK ? status : pm__fail(error, status, "%s", pm_status_text(status));
}

static bool needs_precomputed(const estimating *e)
{
    return strncmp(e->spec, "precomputed", 11) == 0;
}

static pm_status precompute(const estimating *e, const pm_estimator *estimator, pm_source *source,
                            pm_precomputed **made, pm_error *error)
{
    if (!needs_precomputed(e))
        return PM_OK;
    pm_precomputed_options options = {.normals = (const float (*)[3])normals, .dimensions = 2};
    pm_query_init(&options.lookup);
    options.lookup.k = 5;
    const pm_status status = pm_precomputed_create(estimator, e->maps[0], &options, made, error);
    PM_MUST(status == PM_OK || *made == NULL);
    source->precomputed = *made;
    return status;
}

static pm_status estimate(void *context, uint64_t *digest, pm_error *error)
{
    const estimating *const e = context;
    pm_estimator *estimator = NULL;
    pm_workspace *workspace = NULL;
    pm_precomputed *precomputed = NULL;
    pm_estimation estimation;
    pm_query query = query_of("wide");
    query.k = e->k;
    pm_status status = pm_estimator_create(e->spec, &estimator, error);
    pm_source source = {.maps = e->maps, .map_count = estimator ? pm_estimator_maps(estimator) : 0, .dimensions = 2};
    if (status == PM_OK)
        status = say(pm_workspace_create(e->max_k, &workspace), error);
    if (status == PM_OK)
        status = precompute(e, estimator, &source, &precomputed, error);
    if (status == PM_OK)
        status = say(pm_estimate(estimator, &source, &query, workspace, &estimation), error);
    /* A workspace that could not grow is as good as before. */
    if (status == PM_ENOMEM && workspace && (!needs_precomputed(e) || precomputed)) {
        pm__the_heap.refused = 0;
        PM_MUST(pm_estimate(estimator, &source, &query, workspace, &estimation) == PM_OK);
    }
    if (status == PM_OK)
        pm__digest(digest, &estimation, sizeof estimation);
    pm_precomputed_destroy(precomputed);
    pm_workspace_destroy(workspace);
    pm_estimator_destroy(estimator);
    return status;
}

START_TEST(estimates)
{
    pm_error error;
    pm_map *map;
    scatter();
    PM_CHECK_OK(pm_map_create(photons, 500, NULL, &map, &error), error);
    for (size_t i = 0; i < ESTIMATORS; i++)
        for (size_t max_k = 0; max_k < 100; max_k += 50) {
            estimating e = {.spec = estimators[i], .max_k = max_k, .k = 48};
            for (size_t m = 0; m < sizeof e.maps / sizeof *e.maps; m++)
                e.maps[m] = map;
            pm__each_refusal(estimators[i], estimate, &e);
        }
    pm_map_destroy(map);
}
END_TEST

/* ---- Files ------------------------------------------------------------------------------------- */

static char path[PM__TEST_PATH];

static pm_status read_photons(void *context, uint64_t *digest, pm_error *error)
{
    (void)context;
    pm_photon *read = NULL;
    float(*along)[3] = NULL;
    size_t count = 1;
    const pm_status status = pm_ply_read_photons(path, &read, &along, &count, error);
    PM_MUST(status == PM_OK || (!read && !along && !count));
    if (status == PM_OK)
        pm__digest(digest, read, count * sizeof *read);
    if (along)
        pm__digest(digest, along, count * sizeof *along);
    pm_free(along);
    pm_free(read);
    return status;
}

static pm_status read_points(void *context, uint64_t *digest, pm_error *error)
{
    (void)context;
    pm_surface_point *read = NULL;
    size_t count = 1;
    const pm_status status = pm_ply_read_points(path, &read, &count, error);
    PM_MUST(status == PM_OK || (!read && !count));
    if (status == PM_OK)
        pm__digest(digest, read, count * sizeof *read);
    pm_free(read);
    return status;
}

static pm_status write_photons(void *context, uint64_t *digest, pm_error *error)
{
    (void)digest;
    return pm_ply_write_photons(context, photons, 100, error);
}

START_TEST(ply_files)
{
    static const char ascii[] =
        "ply\nformat ascii 1.0\ncomment by hand\nelement other 1\nproperty list uchar int many\nelement vertex 2\n"
        "property float x\nproperty float y\nproperty float z\nproperty float dx\nproperty float dy\n"
        "property float dz\nproperty float r\nproperty float g\nproperty float b\nproperty float nx\n"
        "property float ny\nproperty float nz\nend_header\n3 1 2 3\n0 0 0 0 0 -1 1 1 1 0 0 1\n"
        "1 0 0 0 0 -1 1 1 1 0 0 1\n";
    const pm__test_directory place = pm__test_directory_create();
    pm_error error;
    scatter();
    (void)pm__test_path(&place, "photons.ply", path);
    pm__test_write(path, ascii, sizeof ascii - 1);
    pm__each_refusal("reading photons, ascii", read_photons, NULL);
    pm__each_refusal("reading points", read_points, NULL);
    PM_CHECK_OK(pm_ply_write_photons(path, photons, PHOTONS, &error), error);
    pm__each_refusal("reading photons, binary", read_photons, NULL);
    pm__each_refusal("writing photons", write_photons, path);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    pm__test_directory_remove(&place);
}
END_TEST

PM_TEST_MAIN("memory of the library", maps, further_structures, a_map_survives, checks_of_maps, searches_need_none,
             estimates, ply_files)
