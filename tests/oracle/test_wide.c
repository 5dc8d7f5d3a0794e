/* The search `wide` on maps large enough to have hints (map/wide.h), in every SIMD width of the machine, one query a
 * call and in batches, against brute force: the same photons to the last tie. And the memory that such maps hold. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/map/wide.h"
#include "../../src/search/search.h"
#include "../test.h"

#include <malloc.h>
#include <string.h>

/* More than have hints, and a last block, node and level that are not full. */
enum { COUNT = (1 << 16) + 4711, WIDTHS = PM_SIMD_AVX512 + 1, QUERIES = 10, SHAPES = 6, MOST = 1500 };

static const size_t ks[] = {1, 3, 8, 50, 500, 1000, 1024, 1025, 1500};
enum { KS = sizeof ks / sizeof *ks };

typedef struct cloud {
    const char *name;
    double scale, offset, far; /* m: of its extent, of its corner; how far an outlier lies */
    void (*place)(const double u[4], size_t i, double x[3]);
    bool together; /* most of it is in one place, or float cannot tell it apart */
} cloud;

static void square(const double u[4], size_t i, double x[3])
{
    (void)i;
    x[0] = u[0];
    x[1] = u[1];
    x[2] = 0.5;
}

static void faces(const double u[4], size_t i, double x[3])
{
    (void)i;
    const int axis = (int)(3.0 * u[2]);
    x[axis] = u[3] < 0.5 ? 0.0 : 1.0;
    x[(axis + 1) % 3] = u[0];
    x[(axis + 2) % 3] = u[1];
}

/* Nineteen in twenty along a curve, ever nearer to it, the others in the box around it. */
static void uneven(const double u[4], size_t i, double x[3])
{
    const double t = 6.0 * u[0], blur = 0.01 * pow(u[1], 6.0);
    x[0] = i % 20 ? 0.5 + 0.4 * cos(t) + blur * (u[2] - 0.5) : u[0];
    x[1] = i % 20 ? 0.5 + 0.4 * sin(t) + blur * (u[3] - 0.5) : u[1];
    x[2] = i % 20 ? 0.5 : u[2];
}

/* A quarter in ten points, a quarter in a thousand, the others on a grid. */
static void duplicates(const double u[4], size_t i, double x[3])
{
    const double steps = i % 4 ? 64.0 : 10.0;
    x[0] = floor(steps * u[0]) / steps;
    x[1] = i % 4 == 0 ? 0.25 : i % 4 == 1 ? floor(16.0 * u[1]) / 16.0 : floor(steps * u[1]) / steps;
    x[2] = 0.5;
}

static void line(const double u[4], size_t i, double x[3])
{
    (void)i;
    x[0] = x[1] = x[2] = u[0];
}

static void point(const double u[4], size_t i, double x[3])
{
    (void)u;
    x[0] = x[1] = x[2] = i % 1000 ? 0.5 : 0.25;
}

/* Most so close together that squared distances are below the least normal float. */
static void crowd(const double u[4], size_t i, double x[3])
{
    for (int a = 0; a < 3; a++)
        x[a] = i % 8 ? 1e-20 * u[a] : u[a];
}

static const cloud clouds[] = {{"square", 1.0, 0.0, 0.0, square, false},
                               {"box faces", 3.0, -1.0, 0.0, faces, false},
                               {"uneven", 1.0, 0.0, 0.0, uneven, false},
                               {"duplicates", 1.0, 0.0, 0.0, duplicates, false},
                               {"line", 1.0, 2.0, 0.0, line, false},
                               {"one point", 1.0, 0.0, 0.0, point, true},
                               {"crowd", 1.0, 0.0, 0.0, crowd, true},
                               {"outlier", 1.0, 0.0, 1e5, square, false},
                               {"outlier beyond float", 1.0, 0.0, 1e25, square, true},
                               {"tiny", 1e-30, 0.0, 0.0, uneven, false},
                               {"huge", 1e30, 0.0, 0.0, faces, false},
                               {"offset", 1e-2, 1e6, 0.0, faces, true}};
enum { CLOUDS = sizeof clouds / sizeof *clouds };

static void make_photons(const cloud *c, size_t count, pm_photon *photons)
{
    for (size_t i = 0; i < count; i++) {
        double u[7], x[3];
        pm__random_uniform(31, PM__FOR_TESTS, 0, i, u, 7);
        c->place(u, i, x);
        const double length = i % 64 == 5 ? 1e-44 : i % 64 == 6 ? 6e38 : 1.0; /* products that are rounded away */
        for (int a = 0; a < 3; a++) {
            photons[i].position[a] = (float)(c->offset + c->scale * (i == 77 ? x[a] + c->far : x[a]));
            photons[i].direction[a] = (float)(length * (u[4 + a] - 0.5));
            photons[i].power[a] = 1.0f;
        }
    }
}

/* At photons, beside the surface, anywhere in the box, and far outside. */
static pm_query make_query(const cloud *c, const pm_photon *photons, size_t number, int shape)
{
    double u[7];
    pm_query q;
    pm__random_uniform(32, PM__FOR_TESTS, 0, number, u, 7);
    pm_query_init(&q);
    const pm_photon *const at = &photons[number == 1 ? 77 : (size_t)(u[0] * COUNT)];
    for (int a = 0; a < 3; a++) {
        const double inside = c->offset + c->scale * u[1 + a];
        const double moved = number < 5 ? 0.0 : 0.01 * c->scale * (u[1 + a] - 0.5);
        q.position[a] = number < 7 ? (float)((double)at->position[a] + moved) : (float)inside;
        if (number == 8)
            q.position[a] = (float)(c->offset + c->scale * (20.0 * u[1 + a] - 10.0));
        if (number == 9 && a == 0)
            q.position[a] = 1e36f;
        q.normal[a] = (float)(u[4 + a] - 0.5);
    }
    q.shape = (pm_lookup_shape)(shape % 3);
    q.shape_parameter = q.shape == PM_LOOKUP_DISC ? (float)(0.02 * c->scale) : 3.0f;
    q.front_only = shape >= 3;
    return q;
}

/* The same cloud in every width that the machine has. */
typedef struct fleet {
    pm_map *map[WIDTHS]; /* [0] NULL, as where a width is missing */
    const pm_map *any;   /* whose brute force is the oracle; it uses no SIMD */
} fleet;

static void make_fleet(fleet *f, const pm_photon *photons, size_t count)
{
    *f = (fleet){.any = NULL};
    for (unsigned width = PM_SIMD_PLAIN; width < WIDTHS; width++) {
        pm_error error = {""};
        const pm_map_options options = {.simd = (pm_simd)width};
        const pm_status status = pm_map_create(photons, count, &options, &f->map[width], &error);
        if (status == PM_EINVAL && width > PM_SIMD_PLAIN)
            continue; /* this processor has no such width */
        PM_CHECK_OK(status, error);
        f->any = f->map[width];
    }
}

static void free_fleet(fleet *f)
{
    for (unsigned width = PM_SIMD_PLAIN; width < WIDTHS; width++)
        pm_map_destroy(f->map[width]);
}

static size_t brute(const fleet *f, const pm_query *query, pm_neighbor *found)
{
    pm_query q = *query;
    size_t count = 0;
    q.search = pm_search_find("brute");
    ck_assert_int_eq(pm_map_search(f->any, &q, found, f->any->count, &count), PM_OK);
    return count;
}

static void compare(const fleet *f, unsigned width, const pm_query *q, const char *name, const pm_neighbor *found,
                    size_t got, const pm_neighbor *expected, size_t want)
{
    ck_assert_msg(got == want, "%s, width %u, k %zu, shape %d, front %d, radius %g: %zu, not %zu photons", name, width,
                  q->k, (int)q->shape, q->front_only, (double)q->max_radius, got, want);
    size_t same = 0; /* one assertion for all, since each is a message to another process */
    while (same < got && !memcmp(&found[same].distance2, &expected[same].distance2, sizeof found->distance2) &&
           f->map[width]->ids[found[same].number] == f->any->ids[expected[same].number])
        same++;
    ck_assert_msg(same == got, "%s, width %u, k %zu, shape %d, front %d, radius %g: differs at %zu", name, width, q->k,
                  (int)q->shape, q->front_only, (double)q->max_radius, same);
}

static void check_widths(const fleet *f, const pm_query *q, const char *name, const pm_neighbor *expected, size_t want)
{
    static pm_neighbor found[COUNT];
    for (unsigned width = PM_SIMD_PLAIN; width < WIDTHS; width++) {
        if (!f->map[width])
            continue;
        size_t got = 0;
        ck_assert_int_eq(pm_map_search(f->map[width], q, found, q->k ? q->k : COUNT, &got), PM_OK);
        compare(f, width, q, name, found, got, expected, want);
    }
}

/* Every k's neighbours are the first of the largest k's. Then radii that hold few, some, and more than the kernels
 * collect at a time, and k within such a radius. */
static void check_query(const fleet *f, pm_query q, const char *name, pm_neighbor *expected)
{
    q.k = MOST;
    const size_t most = brute(f, &q, expected);
    for (size_t i = 0; i < KS; i++) {
        q.k = ks[i];
        check_widths(f, &q, name, expected, most < q.k ? most : q.k);
    }
    const size_t ranks[] = {0, 5, 30, 1400};
    float radii[6] = {0.0f, 1e-26f};
    for (size_t r = 0; r < 4; r++)
        radii[2 + r] = (float)(sqrt((double)expected[ranks[r] < most ? ranks[r] : 0].distance2) * pm_map_unit(f->any) *
                               (r < 3 ? 1.0 : 2.5));
    for (size_t r = 0; r < sizeof radii / sizeof *radii && most; r++) {
        q.k = 0;
        q.max_radius = radii[r];
        const size_t all = brute(f, &q, expected);
        check_widths(f, &q, name, expected, all);
        q.k = 40;
        check_widths(f, &q, name, expected, all < q.k ? all : q.k);
    }
}

START_TEST(every_width_finds_what_brute_force_does)
{
    const cloud *const c = &clouds[_i];
    pm_photon *const photons = pm__alloc(COUNT, sizeof *photons);
    pm_neighbor *const expected = pm__alloc(COUNT, sizeof *expected);
    fleet f;
    make_photons(c, COUNT, photons);
    make_fleet(&f, photons, COUNT);
    ck_assert_uint_gt(pm__wide_of(f.any)->hints.count, 0);
    /* All plain, every other one with a filter too. Where all are in one place all are found, which takes its time. */
    for (size_t number = 0; number < QUERIES; number += c->together ? 3 : 1)
        for (int filter = 0; filter <= (int)number % 2; filter++) {
            const int shape = filter ? 1 + (int)number % (SHAPES - 1) : 0;
            check_query(&f, make_query(c, photons, number, shape), c->name, expected);
        }
    free_fleet(&f);
    make_fleet(&f, photons, 3000); /* without hints, too */
    ck_assert_uint_eq(pm__wide_of(f.any)->hints.count, 0);
    for (size_t number = 0; number < QUERIES; number++)
        check_query(&f, make_query(c, photons, number, 0), c->name, expected);
    free_fleet(&f);
    free(photons);
    free(expected);
}
END_TEST

/* k of all sizes, fixed radii and filters side by side in one batch; each must find what it finds alone. */
START_TEST(batches_find_what_single_queries_do)
{
    enum { BATCH = 50, STRIDE = 4096 };
    static const size_t mixed[] = {8, 8, 0, 50, 1500, 1, 0, 500, 3, 1000, 0, 8};
    const cloud *const c = &clouds[_i];
    pm_photon *const photons = pm__alloc(COUNT, sizeof *photons);
    pm_neighbor *const found = pm__alloc((size_t)WIDTHS * BATCH * STRIDE, sizeof *found);
    pm_neighbor *const expected = pm__alloc(COUNT, sizeof *expected);
    pm_query queries[BATCH];
    size_t counts[WIDTHS][BATCH];
    fleet f;
    make_photons(c, COUNT, photons);
    make_fleet(&f, photons, COUNT);
    for (size_t i = 0; i < BATCH; i++) {
        queries[i] = make_query(c, photons, i % 9, i % 3 ? 0 : (int)(i / 3 % SHAPES));
        queries[i].k = i < 20 ? 8 : mixed[i % (sizeof mixed / sizeof *mixed)]; /* first a batch all alike */
        if (!queries[i].k) {
            queries[i].k = 1000;
            const size_t n = brute(&f, &queries[i], expected);
            queries[i].k = 0;
            queries[i].max_radius =
                n ? 0.99f * (float)(sqrt((double)expected[n - 1].distance2) * pm_map_unit(f.any)) : 0.0f;
            if (brute(&f, &queries[i], expected) > STRIDE)
                queries[i].k = 2; /* so many in one place */
        }
    }
    for (unsigned width = PM_SIMD_PLAIN; width < WIDTHS; width++)
        if (f.map[width])
            ck_assert_int_eq(pm_map_search_batch(f.map[width], queries, BATCH, found + width * BATCH * STRIDE, STRIDE,
                                                 counts[width]),
                             PM_OK);
    for (size_t i = 0; i < BATCH; i++) {
        const size_t want = brute(&f, &queries[i], expected);
        for (unsigned width = PM_SIMD_PLAIN; width < WIDTHS; width++)
            if (f.map[width])
                compare(&f, width, &queries[i], c->name, found + (width * BATCH + i) * STRIDE, counts[width][i],
                        expected, want);
    }
    free_fleet(&f);
    free(photons);
    free(found);
    free(expected);
}
END_TEST

/* As many as there are, or more, and many more than are collected at a time. */
START_TEST(k_up_to_all)
{
    static const size_t many[] = {4096, 5000, COUNT - 1, COUNT, COUNT + 1, SIZE_MAX};
    const cloud *const c = &clouds[_i];
    pm_photon *const photons = pm__alloc(COUNT, sizeof *photons);
    pm_neighbor *const expected = pm__alloc(COUNT, sizeof *expected), *const found = pm__alloc(COUNT, sizeof *found);
    fleet f;
    make_photons(c, COUNT, photons);
    make_fleet(&f, photons, COUNT);
    for (size_t number = 0; number < 9; number += 4) {
        pm_query q = make_query(c, photons, number, 0);
        q.k = COUNT;
        ck_assert_uint_eq(brute(&f, &q, expected), COUNT);
        for (size_t i = 0; i < sizeof many / sizeof *many; i++)
            for (unsigned width = PM_SIMD_PLAIN; width < WIDTHS; width++) {
                size_t got = 0;
                q.k = many[i];
                if (!f.map[width])
                    continue;
                ck_assert_int_eq(pm_map_search(f.map[width], &q, found, COUNT, &got), PM_OK);
                compare(&f, width, &q, c->name, found, got, expected, q.k < COUNT ? q.k : COUNT);
            }
    }
    free_fleet(&f);
    free(photons);
    free(expected);
    free(found);
}
END_TEST

/* Photons on an axis, so that their squared distances are what we like: some equal, at all places around the cut. */
START_TEST(ties_at_the_cut_go_to_the_lower_index)
{
    static const size_t counts[] = {17, 47, 48, 49, 64, 300, 3000};
    pm_photon *const photons = pm__alloc(3000, sizeof *photons);
    pm_neighbor *const expected = pm__alloc(3000, sizeof *expected);
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        const size_t count = counts[n];
        for (size_t equal = 1; equal <= count; equal = equal < 4 ? equal + 1 : 3 * equal) {
            const size_t first = (count - equal) / 2;
            fleet f;
            for (size_t i = 0; i < count; i++) {
                const size_t rank = i * 1237 % count; /* a permutation: 1237 is prime and divides none of the counts */
                const size_t place = rank < first ? rank : rank < first + equal ? first : rank;
                photons[i] = (pm_photon){.direction = {0.0f, 0.0f, -1.0f}};
                photons[i].position[rank % 3] = (float)(place + 1) / 4096.0f;
            }
            make_fleet(&f, photons, count);
            pm_query q;
            pm_query_init(&q);
            q.k = count;
            ck_assert_uint_eq(brute(&f, &q, expected), count);
            for (q.k = 1; q.k <= count; q.k += 1 + count / 50)
                check_widths(&f, &q, "ties", expected, q.k);
            for (q.k = first ? first : 1; q.k <= first + equal && q.k <= first + 20; q.k++)
                check_widths(&f, &q, "ties", expected, q.k);
            free_fleet(&f);
        }
    }
    free(photons);
    free(expected);
}
END_TEST

/* Hints count in a map's bytes, are all that is held for them, and keep it below 24 bytes a photon. */
START_TEST(maps_with_hints_stay_below_24_bytes)
{
    const cloud *const c = &clouds[_i];
    pm_photon *const photons = pm__alloc(COUNT, sizeof *photons);
    fleet f;
    make_photons(c, COUNT, photons);
    make_fleet(&f, photons, COUNT);
    const pm__wide *const wide = pm__wide_of(f.any);
    const size_t blocks = (COUNT + PM__LANES - 1) / PM__LANES, hints = wide->hints.count * sizeof(pm__hint);
    size_t want = COUNT * sizeof(uint32_t) + blocks * (sizeof(pm__block) + sizeof(pm__facing)) + hints;
    for (size_t nodes = blocks; nodes > 1;) {
        nodes = (nodes + 15) / 16;
        want += nodes * sizeof(pm__boxes);
    }
    ck_assert_uint_gt(hints, 0);
    ck_assert_uint_eq(pm_map_bytes(f.any), want);
    ck_assert_uint_le(want, (size_t)(24 * COUNT));
    ck_assert_uint_le(malloc_usable_size(wide->hints.cells), hints + 4096); /* 4096: at most a page for malloc */
    free_fleet(&f);
    make_fleet(&f, photons, (1 << 16) - 1);
    ck_assert_uint_eq(pm__wide_of(f.any)->hints.count, 0);
    free_fleet(&f);
    free(photons);
}
END_TEST

int main(void)
{
    Suite *const suite = suite_create("wide");
    TCase *const tcase = tcase_create("wide");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, every_width_finds_what_brute_force_does, 0, CLOUDS);
    tcase_add_loop_test(tcase, batches_find_what_single_queries_do, 0, CLOUDS);
    tcase_add_loop_test(tcase, k_up_to_all, 0, 3);
    tcase_add_loop_test(tcase, maps_with_hints_stay_below_24_bytes, 0, CLOUDS);
    tcase_add_test(tcase, ties_at_the_cut_go_to_the_lower_index);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
