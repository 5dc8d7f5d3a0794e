/* The crowd of keep_density against brute force, in every width of SIMD; and what it says of photons added of late. */
#include "../../src/base/random.h"
#include "../../src/transport/crowd.h"
#include "../test.h"

#include <string.h>

enum { COUNT = 3000, QUERIES = 200 };

typedef struct fixture {
    pm__crowd crowd;
    float positions[COUNT][3];
    double reaches[COUNT];
} fixture;

static double uniform(uint64_t number, int which)
{
    double u[4];
    pm__random_uniform(3, PM__FOR_TESTS, 0, number, u, 4);
    return u[which];
}

/* Over two walls and a floor, reaches over a factor of `spread`; a tenth in one point. */
static fixture *fill(double scale, double spread)
{
    fixture *const f = calloc(1, sizeof *f);
    ck_assert(pm__crowd_init(&f->crowd, 0.1 * scale, spread == 1.0) == PM_OK);
    for (size_t i = 0; i < COUNT; i++) {
        const int wall = (int)(i % 3);
        for (int a = 0; a < 3; a++)
            f->positions[i][a] = (float)(scale * (i % 10 == 9 ? 0.3 : a == wall ? 0.0 : uniform(i, a) - 0.5));
        f->reaches[i] = 0.1 * scale * pow(spread, uniform(i, 3));
        ck_assert(pm__crowd_add(&f->crowd, f->positions[i], f->reaches[i], (uint32_t)i, (uint32_t)wall) == PM_OK);
    }
    return f;
}

static void drop(fixture *f)
{
    pm__crowd_free(&f->crowd);
    free(f);
}

static float distance2(const float a[3], const float b[3])
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

typedef struct candidate {
    float distance2;
    uint32_t id;
} candidate;

static int compare(const void *a, const void *b)
{
    const candidate *const x = a, *const y = b;
    if (x->distance2 != y->distance2)
        return x->distance2 < y->distance2 ? -1 : 1;
    return x->id > y->id ? -1 : 1; /* the latest first */
}

static size_t search(const fixture *f, const pm__crowd_kernel *kernel, size_t i, double reach, size_t wanted,
                     candidate *found)
{
    double low[3], high[3];
    pm__crowd_hood hood = {0};
    pm__crowd_found result = {0};
    const pm__crowd_place place = pm__crowd_place_of(&f->crowd, f->positions[i], reach);
    for (int a = 0; a < 3; a++) {
        low[a] = (double)f->positions[i][a] - reach;
        high[a] = (double)f->positions[i][a] + reach;
    }
    ck_assert(pm__crowd_gather(&f->crowd, &place, low, high, &hood) == PM_OK);
    ck_assert(pm__crowd_found_reserve(&result, &hood) == PM_OK);
    kernel->find(&hood, f->positions[i], (float)reach, wanted, &result);
    for (size_t n = 0; n < result.count; n++)
        found[n] = (candidate){result.distance2[n], hood.ids[result.places[n]]};
    qsort(found, result.count, sizeof *found, compare);
    ck_assert(result.count == 0 || kernel->farthest(&result) == found[result.count - 1].distance2);
    const size_t count = result.count;
    pm__crowd_hood_free(&hood);
    pm__crowd_found_free(&result);
    return count;
}

/* All within reach whose own is between the same and half, or twice, one third at least; and none twice. */
static void check_one_reach(const fixture *f, const pm__crowd_kernel *kernel, double reach, size_t wanted)
{
    static candidate expected[COUNT], found[COUNT];
    for (size_t q = 0; q < QUERIES; q++) {
        size_t all = 0;
        for (size_t j = 0; j < COUNT; j++) {
            const float d2 = distance2(f->positions[j], f->positions[q]);
            if (d2 <= (float)reach * (float)reach)
                expected[all++] = (candidate){d2, (uint32_t)j};
        }
        qsort(expected, all, sizeof *expected, compare);
        const size_t count = search(f, kernel, q, reach, wanted, found);
        ck_assert_uint_eq(count, all < wanted ? all : wanted);
        for (size_t n = 0; n < count; n++) {
            ck_assert_uint_eq(found[n].id, expected[n].id);
            ck_assert(found[n].distance2 == expected[n].distance2);
        }
    }
}

static const pm__crowd_kernel *kernels(size_t i)
{
    const pm__crowd_kernel *all[] = {&pm__crowd_plain, pm__crowd_choose(), NULL, NULL};
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2"))
        all[2] = &pm__crowd_avx2;
#endif
    return all[i];
}

START_TEST(test_finds_what_brute_force_does)
{
    static const double scales[] = {1.0, 1e-6, 1e6};
    static const size_t wanted[] = {1, 20, 63, 200, 5000};
    for (int s = 0; s < 3; s++) {
        fixture *const f = fill(scales[s], 1.0);
        for (size_t w = 0; w < 5; w++)
            for (size_t k = 0; kernels(k); k++)
                check_one_reach(f, kernels(k), f->reaches[0], wanted[w]);
        drop(f);
    }
}
END_TEST

/* Where reaches differ: every photon found is one within reach, none twice, and those of about the own reach are all
 * there. */
START_TEST(test_reaches_that_differ)
{
    static candidate found[COUNT];
    fixture *const f = fill(1.0, 8.0);
    for (size_t q = 0; q < QUERIES; q++) {
        bool seen[COUNT] = {false};
        const double reach = f->reaches[q];
        const size_t count = search(f, pm__crowd_choose(), q, reach, COUNT, found);
        for (size_t n = 0; n < count; n++) {
            ck_assert(!seen[found[n].id]);
            seen[found[n].id] = true;
            ck_assert(found[n].distance2 <= (float)reach * (float)reach);
        }
        for (size_t j = 0; j < COUNT; j++) {
            const double ratio = f->reaches[j] / reach;
            const bool near = distance2(f->positions[j], f->positions[q]) <= (float)reach * (float)reach;
            ck_assert(!near || seen[j] || ratio < 0.72 || ratio > 1.40);
            ck_assert(!seen[j] || (ratio > 0.34 && ratio < 2.83));
        }
    }
    drop(f);
}
END_TEST

/* Never fewer than were added within an edge. */
START_TEST(test_fresh)
{
    fixture *const f = fill(1.0, 8.0);
    pm__crowd_settle(&f->crowd);
    for (size_t i = 0; i < COUNT; i++) {
        const pm__crowd_place place = pm__crowd_place_of(&f->crowd, f->positions[i], f->reaches[i]);
        ck_assert_uint_eq(pm__crowd_fresh(&f->crowd, &place), 0);
    }
    for (uint32_t i = 0; i < 100; i++)
        ck_assert(pm__crowd_add(&f->crowd, f->positions[i], f->reaches[i], COUNT + i, 0) == PM_OK);
    for (size_t q = 0; q < COUNT; q++) {
        static candidate found[COUNT + 100];
        const pm__crowd_place place = pm__crowd_place_of(&f->crowd, f->positions[q], f->reaches[q]);
        const size_t count = search(f, pm__crowd_choose(), q, f->reaches[q], COUNT + 100, found);
        unsigned fresh = 0;
        for (size_t n = 0; n < count; n++)
            fresh += found[n].id >= COUNT;
        ck_assert_uint_ge(pm__crowd_fresh(&f->crowd, &place), fresh);
    }
    drop(f);
}
END_TEST

/* Far out, where cells have no numbers left, and reaches of any size. */
START_TEST(test_extremes)
{
    static const float where[][3] = {{0.0f, 0.0f, 0.0f}, {1e30f, -1e30f, 1e30f}, {1e-30f, 0.0f, 0.0f}};
    static const double reaches[] = {1e-15, 1.0, 1e18};
    pm__crowd crowd;
    ck_assert(pm__crowd_init(&crowd, 1.0, false) == PM_OK);
    for (uint32_t i = 0; i < 9; i++)
        ck_assert(pm__crowd_add(&crowd, where[i / 3], reaches[i % 3], i, 0) == PM_OK);
    for (uint32_t i = 0; i < 9; i++) {
        pm__crowd_hood hood = {0};
        const pm__crowd_place place = pm__crowd_place_of(&crowd, where[i / 3], reaches[i % 3]);
        const double low[3] = {-INFINITY, -INFINITY, -INFINITY}, high[3] = {INFINITY, INFINITY, INFINITY};
        bool there = false;
        ck_assert(pm__crowd_gather(&crowd, &place, low, high, &hood) == PM_OK);
        for (size_t n = 0; n < hood.count; n++)
            there = there || hood.ids[n] == i;
        ck_assert(there);
        pm__crowd_hood_free(&hood);
    }
    pm__crowd_free(&crowd);
}
END_TEST

PM_TEST_MAIN("crowd", test_finds_what_brute_force_does, test_reaches_that_differ, test_fresh, test_extremes)
