/* Samplers: uniform, stratified as they say, unbiased over trials, and pure. Chi-square tests have a false-alarm rate
 * of 1e-8 each. */
#include "../test.h"

#include "../../src/base/sampler.h"
#include "../../src/base/sobol.h"

#include <gsl/gsl_cdf.h>
#include <string.h>

/* Defines test_<name>, which runs the body for each sampler in turn. */
#define EACH_SAMPLER(name)                                      \
    static void check_##name(size_t which);                     \
    START_TEST(test_##name)                                     \
    {                                                           \
        for (size_t sampler_ = 0; sampler_ < 3; sampler_++)     \
            check_##name(sampler_);                             \
    }                                                           \
    END_TEST                                                    \
    static void check_##name(size_t which)

static const double square[2] = {1.0, 1.0};

static const pm__sampler *sampler(const char *name)
{
    const pm__entry *const entry = pm__find(&pm__samplers, name);
    ck_assert_ptr_nonnull(entry);
    return (const pm__sampler *)(const void *)entry;
}

static pm__points points_of(const char *name, uint32_t trial, uint64_t count, int dimensions, int strata,
                            const double aspect[2])
{
    pm__points points;
    pm__points_init(&points, sampler(name), 7, PM__FOR_TESTS, trial, count, dimensions, strata, aspect);
    return points;
}

static void point(const pm__points *points, uint64_t index, double *u)
{
    points->sampler->point(points, index, u);
    for (int i = 0; i < points->dimensions; i++)
        ck_assert(u[i] >= 0.0 && u[i] < 1.0);
}

START_TEST(test_catalogue)
{
    static const char *const names[] = {"poisson", "stratified", "sobol"};
    ck_assert_uint_eq(pm__samplers.count, 3);
    for (int i = 0; i < 3; i++) {
        ck_assert_str_eq(pm__samplers.entries[i]->name, names[i]);
        ck_assert(sampler(names[i])->independent == (i == 0));
    }
}
END_TEST

/* All pairs of dimensions on 16 x 16 cells. Points of one set are not independent unless the sampler says so, so each
 * trial gives one point of a random number. */
EACH_SAMPLER(uniform)
{
    enum { CELLS = 16, TRIALS = 25000 };
    const char *const name = pm__samplers.entries[which]->name;
    static double counts[6][CELLS * CELLS];
    memset(counts, 0, sizeof counts);
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        const pm__points points = points_of(name, trial, 100, 4, 2, square);
        double chosen, u[4];
        pm__random_uniform(99, PM__FOR_TESTS, trial, 0, &chosen, 1);
        point(&points, (uint64_t)(chosen * (double)points.count), u);
        for (int a = 0, pair = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++, pair++)
                counts[pair][(int)(u[a] * CELLS) * CELLS + (int)(u[b] * CELLS)]++;
    }
    const double expected = (double)TRIALS / (CELLS * CELLS);
    for (int pair = 0; pair < 6; pair++) {
        double chi2 = 0.0;
        for (int i = 0; i < CELLS * CELLS; i++)
            chi2 += (counts[pair][i] - expected) * (counts[pair][i] - expected) / expected;
        const double p = gsl_cdf_chisq_Q(chi2, CELLS * CELLS - 1);
        ck_assert_msg(p > 1e-8 && p < 1 - 1e-8, "%s, pair %d: chi2 %g", name, pair, chi2);
    }
}

/* Independent points of one set: the variance of counts is that of independence. */
START_TEST(test_poisson_is_independent)
{
    const pm__points points = points_of("poisson", 0, 100000, 2, 2, square);
    static double counts[400];
    for (uint64_t i = 0; i < points.count; i++) {
        double u[2];
        point(&points, i, u);
        counts[(int)(u[0] * 20) * 20 + (int)(u[1] * 20)]++;
    }
    double chi2 = 0.0;
    for (int i = 0; i < 400; i++)
        chi2 += (counts[i] - 250) * (counts[i] - 250) / 250;
    const double p = gsl_cdf_chisq_Q(chi2, 399);
    ck_assert_msg(p > 1e-8 && p < 1 - 1e-8, "chi2 %g", chi2);
}
END_TEST

START_TEST(test_one_point_a_cell)
{
    static const struct {
        uint64_t count;
        int strata;
        double aspect[2];
    } sets[] = {{40000, 2, {1, 1}}, {1000, 2, {1, 1}}, {40000, 2, {0.5, 1}},  {7, 2, {1, 1}},
                {1, 2, {1, 1}},     {997, 2, {4, 1}},  {40000, 3, {0.85, 0.67}}, {1, 3, {1, 1}}};
    for (size_t s = 0; s < sizeof sets / sizeof *sets; s++) {
        const pm__points points = points_of("stratified", 3, sets[s].count, 4, sets[s].strata, sets[s].aspect);
        const uint32_t *const n = points.cells;
        ck_assert_uint_eq(points.count, (uint64_t)n[0] * n[1] * n[2]);
        unsigned char *const seen = calloc(points.count, 1);
        for (uint64_t i = 0; i < points.count; i++) {
            double u[4];
            point(&points, i, u);
            uint64_t cell = 0;
            for (int d = sets[s].strata - 1; d >= 0; d--)
                cell = cell * n[d] + (uint64_t)(u[d] * n[d]);
            ck_assert_uint_lt(cell, points.count);
            ck_assert_int_eq(seen[cell]++, 0);
        }
        free(seen);
    }
}
END_TEST

/* The grid nearest in count among those of near-square cells: a square count is met exactly, others within the 4 %
 * that the choice of rows leaves. */
START_TEST(test_grid)
{
    for (uint64_t count = 1; count < 3000000; count += 1 + count / 7) {
        static const double aspects[] = {0.2, 0.5, 1.0, 3.0};
        for (int a = 0; a < 4; a++) {
            const double aspect[2] = {aspects[a], 1.0};
            const pm__points points = points_of("stratified", 0, count, 2, 2, aspect);
            const double columns = points.cells[0], rows = points.cells[1];
            ck_assert_double_le(fabs((double)points.count - (double)count), fmax(0.5 * columns, 1.0));
            const double cell = aspects[a] / columns * rows; /* width over height */
            if (count > 10000)
                PM_CHECK_NEAR(cell, 1.0, 0.08);
        }
    }
    for (uint64_t side = 1; side < 300; side++) {
        const pm__points points = points_of("stratified", 0, side * side, 2, 2, square);
        ck_assert_uint_eq(points.count, side * side);
        ck_assert_uint_eq(points.cells[0], side);
        const pm__points cube = points_of("stratified", 0, side * side * side, 3, 3, square);
        ck_assert_uint_eq(cube.count, side * side * side);
    }
    static const double box[2] = {0.85, 0.67};
    for (uint64_t count = 10000; count < 3000000; count += count / 5) {
        const pm__points points = points_of("stratified", 0, count, 3, 3, box);
        ck_assert_double_le(fabs((double)points.count / (double)count - 1), 0.005);
        PM_CHECK_NEAR(0.85 * points.cells[1] / points.cells[0], 1.0, 0.15); /* a row or two of some twenty */
        PM_CHECK_NEAR(0.67 * points.cells[2] / points.cells[0], 1.0, 0.15);
    }
    const pm__points none = points_of("stratified", 0, 0, 2, 2, square);
    ck_assert_uint_eq(none.count, 0);
}
END_TEST

/* The recurrence of the direction numbers, from their polynomials and first numbers. */
START_TEST(test_sobol_directions)
{
    static const struct {
        int degree, middle; /* a_1 ... a_(s-1) as bits */
        uint32_t first[3];
    } polynomials[] = {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}};
    for (int d = 1; d < PM__SOBOL_DIMENSIONS; d++) {
        const int s = polynomials[d - 1].degree, a = polynomials[d - 1].middle;
        uint32_t v[32];
        for (int k = 0; k < 32; k++) {
            if (k < s) {
                v[k] = polynomials[d - 1].first[k] << (31 - k);
            } else {
                v[k] = v[k - s] ^ v[k - s] >> s;
                for (int j = 1; j < s; j++)
                    v[k] ^= a >> (s - 1 - j) & 1 ? v[k - j] : 0;
            }
            ck_assert_uint_eq(pm__sobol(UINT32_C(1) << k, d), v[k]);
            ck_assert_uint_eq(pm__sobol(UINT32_C(1) << k, 0), UINT32_C(0x80000000) >> k);
        }
        ck_assert_uint_eq(pm__sobol(0xb, d), v[0] ^ v[1] ^ v[3]);
    }
}
END_TEST

/* Every elementary interval of the first two dimensions holds exactly one of 2^m points, also when a set starts at any
 * multiple of 2^m; and each single dimension is stratified. */
START_TEST(test_sobol_is_a_net)
{
    enum { M = 10, N = 1 << M };
    for (uint32_t trial = 0; trial < 20; trial++) {
        const pm__points points = points_of("sobol", trial, 4 * N, 4, 2, square);
        static double u[N][4];
        for (uint64_t i = 0; i < N; i++)
            point(&points, i + (trial & 3) * N, u[i]);
        for (int split = 0; split <= M; split++) {
            unsigned char seen[N] = {0};
            for (int i = 0; i < N; i++) {
                const int x = (int)ldexp(u[i][0], split), y = (int)ldexp(u[i][1], M - split);
                ck_assert_int_eq(seen[(x << (M - split)) + y]++, 0);
            }
        }
        for (int d = 0; d < 4; d++) {
            unsigned char seen[N] = {0};
            for (int i = 0; i < N; i++)
                ck_assert_int_eq(seen[(int)ldexp(u[i][d], M)]++, 0);
        }
    }
}
END_TEST

/* Digit b of a scrambled number depends on digits 0 to b only: flipping digit b of x flips digit b of the result,
 * keeps those above, and what it does to those below looks random. */
START_TEST(test_scrambling_is_nested)
{
    static double flips[32][32];
    enum { TRIALS = 20000 };
    for (uint32_t i = 0; i < TRIALS; i++) {
        uint32_t keys[4], x[4];
        pm__random_words(1, PM__FOR_TESTS, 0, i, 0, keys);
        pm__random_words(1, PM__FOR_TESTS, 0, i, 1, x);
        for (int b = 0; b < 32; b++) {
            const uint32_t digit = UINT32_C(0x80000000) >> b;
            const uint32_t changed = pm__owen_scramble(x[0], keys) ^ pm__owen_scramble(x[0] ^ digit, keys);
            ck_assert_uint_eq(changed & ~(digit - 1), digit);
            for (int c = b + 1; c < 32; c++)
                flips[b][c] += (double)(changed >> (31 - c) & 1);
        }
    }
    /* 496 binomials, 6 sigma: 1e-6 in all. */
    for (int b = 0; b < 32; b++)
        for (int c = b + 1; c < 32; c++)
            ck_assert_msg(fabs(flips[b][c] / TRIALS - 0.5) < 6 * 0.5 / sqrt(TRIALS), "digit %d flips %d: %g", b, c,
                          flips[b][c] / TRIALS);
}
END_TEST

/* The mean over a set of f = (u0 - 1/2)^3 + u0 u1 + sin(7 u1) + u2^2 is unbiased over trials; its variance is far below
 * that of independent points. */
static double test_function(const double *u)
{
    return pow(u[0] - 0.5, 3) + u[0] * u[1] + sin(7 * u[1]) + u[2] * u[2];
}

EACH_SAMPLER(unbiased)
{
    enum { TRIALS = 2000, N = 64 };
    static const double largest[3] = {2.0, 0.4, 0.05}; /* variance against independent points */
    const double exact = 0.25 + (1 - cos(7.0)) / 7 + 1.0 / 3.0;
    double sum = 0.0, sum2 = 0.0, single = 0.0;
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        const pm__points points = points_of(pm__samplers.entries[which]->name, trial, N, 3, 3, square);
        ck_assert_uint_eq(points.count, N);
        double mean = 0.0;
        for (uint64_t i = 0; i < N; i++) {
            double u[3];
            point(&points, i, u);
            const double f = test_function(u);
            mean += f / N;
            single += (f - exact) * (f - exact) / N / TRIALS;
        }
        sum += mean - exact;
        sum2 += (mean - exact) * (mean - exact);
    }
    const double variance = sum2 / TRIALS;
    ck_assert_double_le(fabs(sum / TRIALS), 5.5 * sqrt(variance / TRIALS));
    ck_assert_double_le(variance, largest[which] * single / N);
}

EACH_SAMPLER(pure)
{
    const char *const name = pm__samplers.entries[which]->name;
    const pm__points a = points_of(name, 1, 900, 4, 2, square), b = points_of(name, 2, 900, 4, 2, square);
    pm__points other = a;
    other.purpose = PM__FOR_PROBES;
    for (uint64_t i = a.count; i-- > 0;) {
        double u[4], again[4], v[4], w[4];
        point(&a, i, u);
        point(&b, i, v);
        point(&other, i, w);
        point(&a, i, again);
        ck_assert_mem_eq(u, again, sizeof u);
        for (int d = 0; d < 4; d++)
            ck_assert(u[d] != v[d] && u[d] != w[d]);
    }
}

/* A point of one trial says nothing of the same point in the next (dimensions beyond the strata, where even one cell
 * is shared by chance only): sums of products of standard deviation 1/12. */
EACH_SAMPLER(trials_are_independent)
{
    enum { TRIALS = 4000 };
    double before[4], product[4] = {0.0, 0.0, 0.0, 0.0};
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        const pm__points points = points_of(pm__samplers.entries[which]->name, trial, 900, 4, 1, square);
        double u[4];
        point(&points, 450, u);
        for (int d = 1; d < 4; d++) {
            product[d] += trial ? (u[d] - 0.5) * (before[d] - 0.5) : 0.0;
            before[d] = u[d];
        }
    }
    for (int d = 1; d < 4; d++)
        ck_assert_double_le(fabs(product[d]), 5.5 * sqrt(TRIALS) / 12);
}

/* Fewer dimensions are the first of more, so that a case may ask for what it needs. */
EACH_SAMPLER(dimensions)
{
    const char *const name = pm__samplers.entries[which]->name;
    const pm__points two = points_of(name, 1, 900, 2, 2, square), four = points_of(name, 1, 900, 4, 2, square);
    for (uint64_t i = 0; i < two.count; i++) {
        double u[2], v[4];
        point(&two, i, u);
        point(&four, i, v);
        ck_assert_mem_eq(u, v, sizeof u);
    }
}

PM_TEST_MAIN("samplers", test_catalogue, test_uniform, test_poisson_is_independent, test_one_point_a_cell, test_grid,
             test_sobol_directions, test_sobol_is_a_net, test_scrambling_is_nested, test_unbiased, test_pure,
             test_trials_are_independent, test_dimensions)
