/* Every search against an independent brute force in the caller's own coordinates: the same photons to the last tie, in
 * a map created for the search and in one of another order to which its structure was added. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/search/search.h"
#include "../test.h"

#include <string.h>

enum { CLOUDS = 9, SEARCHES = 16 };

/* uniform box; coarse grid (ties); all in one point; a line; a plane with two densities; a box far from the origin;
 * a tiny cluster with a few far off; photons sorted along a line; a cloud whose axes differ by ten powers of ten */
static void make_cloud(int cloud, size_t count, pm_photon *photons)
{
    for (size_t i = 0; i < count; i++) {
        double u[6], d[3];
        pm__random_uniform(11, PM__FOR_TESTS, (uint32_t)cloud, i, u, 6);
        for (int a = 0; a < 3; a++) {
            double x = u[a];
            if (cloud == 1)
                x = floor(8.0 * x) / 8.0;
            else if (cloud == 2)
                x = 0.25;
            else if (cloud == 3 && a > 0)
                x = 0.5;
            else if (cloud == 4)
                x = a == 2 ? 0.0 : i % 2 ? x : 0.01 * x;
            else if (cloud == 5)
                x = 1000.0 + x;
            else if (cloud == 6 && i % 400)
                x = 0.5 + 1e-6 * x;
            else if (cloud == 7)
                x = a == 0 ? (double)i / (double)count : 0.5;
            else if (cloud == 8)
                x = a == 0 ? x : a == 1 ? 0.5 + 1e-5 * x : 1e-10 * x;
            photons[i].position[a] = (float)x;
            d[a] = u[3 + a] - 0.5;
        }
        const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int a = 0; a < 3; a++) {
            photons[i].direction[a] = (float)(d[a] / length);
            photons[i].power[a] = 1.0f;
        }
    }
}

typedef struct hit {
    double distance2;
    uint32_t index;
} hit;

static int by_distance(const void *a, const void *b)
{
    const hit *const x = a, *const y = b;
    if (x->distance2 != y->distance2)
        return x->distance2 < y->distance2 ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

/* The definition of a lookup, in double and by other expressions than the library's. */
static size_t accepted(const pm_photon *photons, size_t count, const pm_query *q, hit *hits)
{
    size_t found = 0;
    double length = 0.0;
    for (int a = 0; a < 3; a++)
        length = hypot(length, (double)q->normal[a]);
    for (size_t i = 0; i < count; i++) {
        double d2 = 0.0, h = 0.0, facing = 0.0;
        for (int a = 0; a < 3; a++) {
            const double d = (double)photons[i].position[a] - (double)q->position[a];
            d2 += d * d;
            h += d * (double)q->normal[a] / length;
            facing += (double)photons[i].direction[a] * (double)q->normal[a];
        }
        const double s = (double)q->shape_parameter;
        if (q->shape == PM_LOOKUP_ELLIPSOID)
            d2 = (d2 - h * h) + s * s * h * h;
        if (q->shape == PM_LOOKUP_DISC)
            d2 = fmax(0.0, d2 - h * h);
        if ((q->front_only && facing >= 0.0) || (q->shape == PM_LOOKUP_DISC && fabs(h) > s) ||
            sqrt(d2) > (double)q->max_radius)
            continue;
        hits[found++] = (hit){d2, (uint32_t)i};
    }
    qsort(hits, found, sizeof *hits, by_distance);
    return found;
}

static pm_query make_query(int cloud, size_t number, int shape)
{
    double u[8];
    pm__random_uniform(12, PM__FOR_TESTS, (uint32_t)cloud, number, u, 8);
    pm_query q;
    pm_query_init(&q);
    for (int a = 0; a < 3; a++) {
        q.position[a] = (float)(u[a] * 1.2 - 0.1 + (cloud == 5 ? 1000.0 : 0.0));
        q.normal[a] = (float)(u[3 + a] - 0.5);
    }
    if (cloud == 1 && number % 2) /* on a grid point: many exact ties */
        for (int a = 0; a < 3; a++)
            q.position[a] = (float)(floor(u[a] * 8.0) / 8.0);
    q.shape = (pm_lookup_shape)(shape % 3);
    q.shape_parameter = q.shape == PM_LOOKUP_DISC ? 0.3f : 2.5f;
    q.front_only = shape >= 3;
    q.max_radius = number % 3 ? INFINITY : (float)(0.05 + 0.5 * u[6]);
    return q;
}

/* Photons whose distance the definition and the library may round to different sides. */
static bool nearly(double a, double b)
{
    return fabs(a - b) <= 4e-6 * (fabs(a) + fabs(b)) + 1e-12;
}

/* Brute force of the library against the definition: the same photons but for such as tie to within rounding. */
static void check_brute(const pm_map *map, const pm_photon *photons, size_t count, const pm_query *q, hit *hits,
                        pm_neighbor *found)
{
    const size_t expected = accepted(photons, count, q, hits);
    size_t got = 0;
    pm_query query = *q;
    query.search = pm_search_find("brute");
    ck_assert_int_eq(pm_map_search(map, &query, found, count, &got), PM_OK);
    const size_t want = expected < q->k ? expected : q->k;
    if (isinf(q->max_radius) && q->shape != PM_LOOKUP_DISC && !q->front_only)
        ck_assert_uint_eq(got, want);
    ck_assert_int_le(abs((int)got - (int)want), 1); /* one may lie on the rim of radius or disc */
    const double unit = pm_map_unit(map);
    size_t same = 0; /* one assertion for all, since each is a message to another process */
    while (same < got && same < want && nearly((double)found[same].distance2 * unit * unit, hits[same].distance2))
        same++;
    if (same < got && same < want)
        ck_abort_msg("%g, not %g", (double)found[same].distance2 * unit * unit, hits[same].distance2);
}

/* The maps of one cloud: one created for each search, and one of the default order prepared for those it can be. */
typedef struct fleet {
    pm_map *own[SEARCHES];
    pm_map *prepared;
} fleet;

static const pm_search *search_of(size_t s)
{
    return pm_search_find(pm__searches.entries[s]->name);
}

static void make_fleet(fleet *f, const pm_photon *photons, size_t count)
{
    pm_error error;
    ck_assert_uint_le(pm__searches.count, SEARCHES);
    PM_CHECK_OK(pm_map_create(photons, count, NULL, &f->prepared, &error), error);
    for (size_t s = 0; s < pm__searches.count; s++) {
        const pm_map_options options = {.search = search_of(s)};
        PM_CHECK_OK(pm_map_create(photons, count, &options, &f->own[s], &error), error);
        PM_CHECK_OK(pm_map_check(f->own[s], &error), error);
        PM_CHECK_OK(pm_map_prepare(f->prepared, search_of(s), NULL, &error), error);
    }
    PM_CHECK_OK(pm_map_check(f->prepared, &error), error);
}

static void free_fleet(fleet *f)
{
    for (size_t s = 0; s < pm__searches.count; s++)
        pm_map_destroy(f->own[s]);
    pm_map_destroy(f->prepared);
}

static void check_one(const pm_map *map, const fleet *f, const pm_query *q, const pm_neighbor *expected, size_t want,
                      const char *name)
{
    pm_neighbor *const found = pm__alloc(pm_map_count(map), sizeof *found);
    size_t got = 0;
    const pm_status status = pm_map_search(map, q, found, pm_map_count(map), &got);
    ck_assert_msg(status == PM_OK && got == want, "%s: %zu, not %zu photons; of %zu, k %zu, shape %d, radius %g", name,
                  got, want, pm_map_count(map), q->k, (int)q->shape, (double)q->max_radius);
    size_t same = 0; /* one assertion for all, since each is a message to another process */
    while (same < got && !memcmp(&found[same].distance2, &expected[same].distance2, sizeof found->distance2) &&
           pm_map_source(map, found[same].number) == pm_map_source(f->prepared, expected[same].number))
        same++;
    ck_assert_msg(same == got, "%s differs at %zu of k %zu", name, same, q->k);
    free(found);
}

/* Every search, in its own map and in the prepared one, against the library's brute force: the same to the last bit.
 * Returns how many photons there are. */
static size_t check_all(const fleet *f, const pm_query *query)
{
    pm_query q = *query;
    const size_t room = pm_map_count(f->prepared);
    pm_neighbor *const expected = pm__alloc(room, sizeof *expected);
    size_t want = 0;
    q.search = pm_search_find("brute");
    ck_assert_int_eq(pm_map_search(f->prepared, &q, expected, room, &want), PM_OK);
    for (size_t s = 0; s < pm__searches.count; s++) {
        q.search = search_of(s);
        if (q.k && q.search->radius_only)
            continue;
        check_one(f->own[s], f, &q, expected, want, pm__searches.entries[s]->name);
        check_one(f->prepared, f, &q, expected, want, pm__searches.entries[s]->name);
    }
    free(expected);
    return want;
}

START_TEST(searches_agree_with_the_definition_and_with_each_other)
{
    enum { COUNT = 700 };
    static const size_t ks[] = {1, 2, 3, 8, 50, 699, 700, 5000};
    pm_photon *const photons = pm__alloc(COUNT, sizeof *photons);
    hit *const hits = pm__alloc(COUNT, sizeof *hits);
    pm_neighbor *const found = pm__alloc(COUNT, sizeof *found);
    for (int cloud = 0; cloud < CLOUDS; cloud++) {
        fleet f;
        make_cloud(cloud, COUNT, photons);
        make_fleet(&f, photons, COUNT);
        for (size_t number = 0; number < 10; number++)
            for (int shape = 0; shape < 6; shape++)
                for (size_t ki = 0; ki < sizeof ks / sizeof *ks; ki++) {
                    pm_query q = make_query(cloud, number, shape);
                    q.k = ks[ki];
                    if (cloud == 0 || cloud == 4)
                        check_brute(f.prepared, photons, COUNT, &q, hits, found);
                    check_all(&f, &q);
                }
        free_fleet(&f);
    }
    free(photons);
    free(hits);
    free(found);
}
END_TEST

/* Equal distances go to the lower index of the caller, whatever a structure did to the order. */
START_TEST(ties_go_to_the_lower_index)
{
    enum { COUNT = 64 };
    pm_photon photons[COUNT];
    fleet f;
    make_cloud(2, COUNT, photons);
    make_fleet(&f, photons, COUNT);
    for (size_t s = 0; s < pm__searches.count; s++)
        for (size_t k = 1; k <= COUNT; k++) {
            pm_query q;
            pm_neighbor found[COUNT];
            size_t count = 0;
            pm_query_init(&q);
            q.k = k;
            const pm_status status = pm_map_search(f.own[s], &q, found, COUNT, &count);
            ck_assert_int_eq(status, search_of(s)->radius_only ? PM_EINVAL : PM_OK);
            ck_assert_uint_eq(count, search_of(s)->radius_only ? 0 : k);
            for (size_t i = 0; i < count; i++)
                ck_assert_uint_eq(pm_map_source(f.own[s], found[i].number), i);
        }
    free_fleet(&f);
}
END_TEST

/* Radii from 0 (at a photon: it and its duplicates) over some hits to far more than the whole cloud; in the coarse grid
 * some lie exactly on the rim, which is inclusive. */
START_TEST(fixed_radii_find_all_and_say_how_many)
{
    enum { COUNT = 2000 };
    static const float radii[] = {0.0f,  1e-30f, 3e-7f, 1e-4f, 0.01f, 0.07f, 0.125f,
                                  0.25f, 0.3f,   1.0f,  7.0f,  1e5f,  3e38f};
    pm_photon *const photons = pm__alloc(COUNT, sizeof *photons);
    hit *const hits = pm__alloc(COUNT, sizeof *hits);
    for (int cloud = 0; cloud < CLOUDS; cloud++) {
        fleet f;
        make_cloud(cloud, COUNT, photons);
        make_fleet(&f, photons, COUNT);
        for (size_t number = 0; number < 8; number++)
            for (int shape = 0; shape < 6; shape++)
                for (size_t r = 0; r < sizeof radii / sizeof *radii; r++) {
                    pm_query q = make_query(cloud, number, shape);
                    q.k = 0;
                    q.max_radius = radii[r];
                    if (number >= 4)
                        memcpy(q.position, photons[number * 17].position, sizeof q.position);
                    const size_t want = check_all(&f, &q);
                    if (!cloud && radii[r] >= 0.01f && radii[r] < 1e6f)
                        ck_assert_int_le(abs((int)accepted(photons, COUNT, &q, hits) - (int)want), 1);
                    if (number >= 4 && !shape)
                        ck_assert_uint_ge(want, cloud == 2 ? COUNT : 1);
                }
        free_fleet(&f);
    }
    free(photons);
    free(hits);
}
END_TEST

START_TEST(too_small_a_buffer_is_told_the_number)
{
    enum { COUNT = 500 };
    pm_photon photons[COUNT];
    fleet f;
    make_cloud(0, COUNT, photons);
    make_fleet(&f, photons, COUNT);
    pm_query q = make_query(0, 1, 0);
    q.k = 0;
    q.max_radius = 0.5f;
    const size_t want = check_all(&f, &q);
    ck_assert_uint_gt(want, 3);
    for (size_t s = 0; s < pm__searches.count; s++) {
        pm_neighbor found[3];
        size_t got = 0;
        q.search = search_of(s);
        ck_assert_int_eq(pm_map_search(f.own[s], &q, found, 3, &got), PM_ETRUNCATED);
        ck_assert_uint_eq(got, want);
    }
    free_fleet(&f);
}
END_TEST

/* Few photons, of which trees and grids are easily wrong, and scales at which squares under- and overflow. */
START_TEST(small_maps_and_extreme_scales)
{
    static const double scales[] = {1.0, 1e-30, 1e30, 1e37};
    pm_photon photons[40];
    for (size_t count = 0; count <= 40; count = count < 8 ? count + 1 : 2 * count)
        for (int cloud = 0; cloud < CLOUDS; cloud++)
            for (size_t scale = 0; scale < 4; scale++) {
                fleet f;
                if (cloud == 5 && scale == 3)
                    continue; /* beyond float */
                make_cloud(cloud, count, photons);
                for (size_t i = 0; i < count; i++)
                    for (int a = 0; a < 3; a++)
                        photons[i].position[a] = (float)((double)photons[i].position[a] * scales[scale]);
                make_fleet(&f, photons, count);
                for (int shape = 0; shape < 6; shape++)
                    for (size_t k = 0; k <= 9; k++) {
                        pm_query q = make_query(cloud, k, shape);
                        q.k = k;
                        q.max_radius = (float)((double)q.max_radius * scales[scale]);
                        if (!k)
                            q.max_radius = (float)(0.4 * scales[scale]);
                        for (int a = 0; a < 3; a++)
                            q.position[a] = (float)((double)q.position[a] * scales[scale]);
                        check_all(&f, &q);
                    }
                free_fleet(&f);
            }
}
END_TEST

START_TEST(bad_queries_are_refused)
{
    pm_photon photons[10];
    make_cloud(0, 10, photons);
    pm_map *map = NULL;
    ck_assert_int_eq(pm_map_create(photons, 10, NULL, &map, NULL), PM_OK);
    pm_neighbor found[10];
    size_t count = 7;
    pm_query good, q;
    pm_query_init(&good);
    good.k = 3;
#define REFUSED(change)                                                          \
    do {                                                                         \
        q = good;                                                                \
        change;                                                                  \
        ck_assert_int_eq(pm_map_search(map, &q, found, 10, &count), PM_EINVAL);  \
        ck_assert_uint_eq(count, 0);                                             \
    } while (0)
    REFUSED(q.position[1] = NAN);
    REFUSED(q.position[0] = INFINITY);
    REFUSED(q.max_radius = -1.0f);
    REFUSED(q.max_radius = NAN);
    REFUSED(q.k = 0);
    REFUSED((q.front_only = true, q.normal[2] = 0.0f));
    REFUSED((q.front_only = true, q.normal[2] = NAN));
    REFUSED((q.shape = PM_LOOKUP_ELLIPSOID, q.shape_parameter = 0.5f));
    REFUSED((q.shape = PM_LOOKUP_DISC, q.shape_parameter = -1.0f));
    REFUSED(q.shape = (pm_lookup_shape)9);
    ck_assert_int_eq(pm_map_search(map, &good, found, 2, &count), PM_EINVAL); /* no room for k */
    ck_assert_int_eq(pm_map_search(map, &good, found, 3, &count), PM_OK);
    ck_assert_uint_eq(count, 3);
    q = good;
    q.k = 0;
    q.max_radius = 0.0f; /* exactly at a photon: found; the rim is inclusive */
    memcpy(q.position, photons[4].position, sizeof q.position);
    ck_assert_int_eq(pm_map_search(map, &q, found, 10, &count), PM_OK);
    ck_assert_uint_eq(count, 1);
    ck_assert_uint_eq(pm_map_source(map, found[0].number), 4);
    q = good;
    q.position[0] = 3e38f; /* far beyond: still an answer */
    ck_assert_int_eq(pm_map_search(map, &q, found, 10, &count), PM_OK);
    ck_assert_uint_eq(count, 3);
    pm_map_destroy(map);
    ck_assert_int_eq(pm_map_create(NULL, 0, NULL, &map, NULL), PM_OK);
    ck_assert_int_eq(pm_map_search(map, &good, found, 10, &count), PM_OK);
    ck_assert_uint_eq(count, 0);
    pm_map_destroy(map);
    ck_assert_ptr_null(pm_search_find("no such search"));
    ck_assert_ptr_null(pm_search_find(NULL));
}
END_TEST

/* [C02] 5.2 with its printed example constants: 1.4235 and 0.72429 (errata 44). */
START_TEST(automatic_radii_have_the_papers_constants)
{
    PM_CHECK_NEAR(pm_max_radius_surface(1, 1.0, 0.05), 1.4235, 5e-5);
    PM_CHECK_NEAR(pm_max_radius_volume(1, 1.0, 1.0, 0.05), 0.72429, 5e-6);
    PM_CHECK_NEAR(pm_max_radius_surface(50, 2.0, 0.1), sqrt(50.0 * 2.0 / 0.1) / acos(-1.0), 1e-12);
    PM_CHECK_NEAR(pm_max_radius_surface(5, 0.0, 0.1), 0.0, 0.0);
    PM_CHECK_NEAR(pm_max_radius_volume(5, 1.0, -1.0, 0.1), 0.0, 0.0);
}
END_TEST

PM_TEST_MAIN("search", searches_agree_with_the_definition_and_with_each_other, ties_go_to_the_lower_index,
             fixed_radii_find_all_and_say_how_many, too_small_a_buffer_is_told_the_number,
             small_maps_and_extreme_scales, bad_queries_are_refused, automatic_radii_have_the_papers_constants)
