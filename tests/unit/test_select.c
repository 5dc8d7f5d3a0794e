/* The cut of `wide` (search/wide_select.h) against sorting: ties in all places, zeros, denormals, huge values. In plain
 * C; the other widths are compared with brute force in tests/oracle. */
#define PM__SIMD_WIDTH 0
#include "../../src/search/wide_select.h"

#include "../../src/base/random.h"
#include "../test.h"

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* What a cut must leave: exactly k, of which the ties at its distance count only as far as it says. */
static void check_cut(const float *values, size_t count, float bound, size_t k)
{
    static _Alignas(64) float d2[CAPACITY + PM__LANES];
    static float sorted[CAPACITY];
    size_t within = 0, below = 0, equal = 0;
    for (size_t i = 0; i < count; i++)
        if (values[i] <= bound)
            sorted[within++] = values[i];
    memcpy(d2, values, count * sizeof *d2);
    for (size_t i = 0; i < PM__LANES; i++)
        d2[count + i] = INFINITY;
    qsort(sorted, within, sizeof *sorted, by_value);
    const cut at = cut_at(d2, count, within, bound, k);
    for (size_t i = 0; i < within; i++) {
        below += sorted[i] < at.distance2;
        equal += !(sorted[i] < at.distance2) && !(sorted[i] > at.distance2);
    }
    const size_t kept = below + (at.ties == ALL_TIES ? equal : at.ties);
    ck_assert_msg(kept == k && (at.ties == ALL_TIES || (at.ties > 0 && at.ties <= equal)),
                  "%zu of %zu at %g: %zu kept, %zu below, %zu equal, ties %zu", k, within, (double)at.distance2, kept,
                  below, equal, at.ties);
    ck_assert_msg(at.ties == ALL_TIES || !memcmp(&at.distance2, &sorted[k - 1], sizeof at.distance2),
                  "cut at %g, not %g", (double)at.distance2, (double)sorted[k - 1]);
}

static void check_all_k(const float *values, size_t count, float bound)
{
    size_t within = 0;
    for (size_t i = 0; i < count; i++)
        within += values[i] <= bound;
    const size_t step = within < 120 ? 1 : within / 23;
    for (size_t k = 1; k < within; k += step)
        check_cut(values, count, bound, k);
    if (within > 1)
        check_cut(values, count, bound, within - 1);
}

/* A permutation of 0 .. count - 1. */
static void shuffle(size_t *order, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        double u;
        pm__random_uniform(41, PM__FOR_TESTS, 0, i, &u, 1);
        const size_t j = (size_t)(u * (double)(i + 1));
        order[i] = order[j];
        order[j] = i;
    }
}

static const size_t counts[] = {2, 3, 4, 5, 16, 47, 48, 49, 50, 97, 1000, CAPACITY};
enum { COUNTS = sizeof counts / sizeof *counts };

START_TEST(ties_in_every_place)
{
    static float values[CAPACITY];
    static size_t order[CAPACITY];
    for (size_t n = 0; n < COUNTS; n++) {
        const size_t count = counts[n];
        shuffle(order, count);
        for (size_t equal = 1; equal <= count; equal = equal < 4 ? equal + 1 : 2 * equal)
            for (size_t first = 0; first + equal <= count; first += 1 + count / 7) {
                for (size_t i = 0; i < count; i++) {
                    const size_t rank = order[i] > first && order[i] < first + equal ? first : order[i];
                    values[i] = (float)(rank + 1);
                }
                check_all_k(values, count, (float)(count + 1));
                check_all_k(values, count, (float)count);
                for (size_t k = first ? first : 1; k <= first + equal && k < count; k += 1 + equal / 9)
                    check_cut(values, count, (float)count, k);
            }
    }
}
END_TEST

START_TEST(all_equal)
{
    static float values[CAPACITY];
    static const float all[] = {0.0f, 1e-45f, FLT_MIN, 1.0f, 1e30f, FLT_MAX};
    for (size_t n = 0; n < COUNTS; n++)
        for (size_t a = 0; a < sizeof all / sizeof *all; a++) {
            for (size_t i = 0; i < counts[n]; i++)
                values[i] = all[a];
            check_all_k(values, counts[n], all[a]);
            check_all_k(values, counts[n], FLT_MAX);
        }
}
END_TEST

/* Of ranges that no interpolation halves: powers of ten from denormals to the largest float, with zeros, with values
 * beyond the bound and with such as a filter rejects. */
START_TEST(values_of_all_sizes)
{
    static float values[CAPACITY];
    for (uint32_t seed = 0; seed < 6; seed++)
        for (size_t n = 0; n < COUNTS; n++) {
            for (size_t i = 0; i < counts[n]; i++) {
                double u[2];
                pm__random_uniform(42, PM__FOR_TESTS, seed, i, u, 2);
                values[i] = seed == 1 && u[1] < 0.5 ? 0.0f : (float)pow(10.0, -45.0 + 83.5 * u[0]);
                if (seed == 2)
                    values[i] = 1e-42f * (float)u[0];
                if (seed == 3)
                    values[i] = 1e38f * (1.0f + 2.0f * (float)u[0]);
                if (seed == 4 && u[1] < 0.3)
                    values[i] = u[1] < 0.2 ? NAN : INFINITY;
                if (seed == 5)
                    values[i] = (float)u[0] + (i + 1 == counts[n] ? 1e30f : 0.0f);
            }
            check_all_k(values, counts[n], FLT_MAX);
            check_all_k(values, counts[n], seed == 2 ? 5e-43f : seed == 3 ? 2e38f : 1e-3f);
        }
}
END_TEST

START_TEST(ranks_are_those_of_sorting)
{
    static uint32_t values[CAPACITY], work[CAPACITY];
    for (uint32_t distinct = 1; distinct < 100000; distinct *= 7)
        for (size_t count = 1; count <= CAPACITY; count = 3 * count + 1) {
            for (size_t i = 0; i < count; i++) {
                double u;
                pm__random_uniform(43, PM__FOR_TESTS, distinct, i, &u, 1);
                values[i] = (uint32_t)(u * distinct) * (UINT32_MAX / distinct);
            }
            for (size_t wanted = 1; wanted <= count; wanted += 1 + count / 40) {
                memcpy(work, values, count * sizeof *work);
                const uint32_t got = value_of_rank(work, count, wanted);
                size_t below = 0, up_to = 0;
                for (size_t i = 0; i < count; i++) {
                    below += values[i] < got;
                    up_to += values[i] <= got;
                }
                ck_assert_msg(below < wanted && wanted <= up_to, "rank %zu of %zu", wanted, count);
            }
        }
    (void)in_front; /* which comes with the header */
}
END_TEST

/* Different ids, crowded and spread: exactly as many as tie are not above what is returned. */
START_TEST(ids_are_parted_where_asked)
{
    enum { IDS = 700 };
    static const size_t strides[] = {1, 3, 1000, 6000000};
    uint32_t ids[IDS + PM__LANES];
    ck_assert_uint_eq(last_id(ids, 0, ALL_TIES, 1), UINT32_MAX);
    for (int s = 0; s < 4; s++)
        for (size_t count = 1; count <= IDS; count = count < 40 ? count + 1 : count + 97)
            for (size_t ties = 1; ties <= count; ties += 1 + count / 30) {
                for (size_t i = 0; i < count; i++) /* in an order that is neither: 389 is prime */
                    ids[i] = (uint32_t)((i * 389 % count) * strides[s] + (i * i % strides[s]) % strides[s]);
                const uint32_t last = last_id(ids, count, ties, count * strides[s]);
                size_t up_to = 0;
                for (size_t i = 0; i < count; i++)
                    up_to += ids[i] <= last;
                ck_assert_msg(up_to == ties, "%zu, not %zu of %zu", up_to, ties, count);
            }
}
END_TEST

PM_TEST_MAIN("select", ties_in_every_place, all_equal, values_of_all_sizes, ranks_are_those_of_sorting,
             ids_are_parted_where_asked)
