/* The rank test, its shift and its interval against enumeration of everything, Student's p against GSL. */
#include "../../src/stats/stats.h"

#include "../../src/base/random.h"
#include "../test.h"

#include <gsl/gsl_cdf.h>

static double uniform(uint64_t seed, size_t number)
{
    double u;
    pm__random_uniform(seed, PM__FOR_TESTS, 3, number, &u, 1);
    return u;
}

static double statistic(const double *all, const unsigned *is_b, size_t n)
{
    double u = 0.0;
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < n; i++)
            if (is_b[j] && !is_b[i])
                u += all[j] > all[i];
    return u;
}

/* P(U >= u) and P(U <= u) over all ways to choose which nb of the values are b's. */
static void enumerate(const double *all, size_t n, size_t nb, double u, double *above, double *below)
{
    double ways = 0.0;
    *above = *below = 0.0;
    for (unsigned set = 0; set < 1u << n; set++) {
        unsigned is_b[16];
        size_t count = 0;
        for (size_t i = 0; i < n; i++)
            count += is_b[i] = set >> i & 1u;
        if (count != nb)
            continue;
        const double other = statistic(all, is_b, n);
        ways += 1.0;
        *above += other >= u;
        *below += other <= u;
    }
    *above /= ways;
    *below /= ways;
}

START_TEST(p_is_that_of_all_permutations)
{
    for (uint64_t seed = 1; seed <= 40; seed++) {
        const size_t na = 1 + seed % 6, nb = 1 + seed / 6 % 6, n = na + nb;
        double a[8], b[8], all[16], above, below;
        unsigned is_b[16];
        for (size_t i = 0; i < n; i++) {
            is_b[i] = i >= na;
            all[i] = uniform(seed, i) + (is_b[i] ? 0.02 * (double)(seed % 30) : 0.0);
            *(is_b[i] ? &b[i - na] : &a[i]) = all[i];
        }
        enumerate(all, n, nb, statistic(all, is_b, n), &above, &below);
        pm__shift shift;
        pm__rank_shift(a, na, b, nb, 0.95, 0.0, &shift);
        PM_CHECK_NEAR(shift.p, fmin(1.0, 2.0 * fmin(above, below)), 1e-13);
    }
}
END_TEST

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The shift and the ends of the interval are order statistics of all differences; both flip with the samples. */
START_TEST(shift_is_the_median_of_all_differences)
{
    enum { NA = 23, NB = 17 };
    double a[NA], b[NB], d[NA * NB];
    for (size_t i = 0; i < NA; i++)
        a[i] = floor(40.0 * uniform(5, i)) / 8.0; /* with ties */
    for (size_t j = 0; j < NB; j++)
        b[j] = floor(40.0 * uniform(6, j)) / 8.0 + 1.0;
    for (size_t i = 0; i < NA; i++)
        for (size_t j = 0; j < NB; j++)
            d[i * NB + j] = b[j] - a[i];
    qsort(d, NA * NB, sizeof *d, by_value);
    pm__shift shift, back;
    pm__rank_shift(a, NA, b, NB, 0.95, 0.0, &shift);
    pm__rank_shift(b, NB, a, NA, 0.95, 0.0, &back);
    PM_CHECK_NEAR(shift.shift, d[NA * NB / 2], 0.0);
    size_t low = 0;
    while (low < NA * NB && d[low] < shift.interval.low)
        low++;
    ck_assert(d[low] == shift.interval.low);
    /* the normal approximation: mean - 1.96 sigma = 195.5 - 1.96 * 36.6 = 124 */
    ck_assert(d[123 - 4] <= shift.interval.low && shift.interval.low <= d[123 + 4]);
    ck_assert(shift.interval.low <= shift.shift && shift.shift <= shift.interval.high);
    PM_CHECK_NEAR(back.shift, -shift.shift, 0.0);
    PM_CHECK_NEAR(back.interval.low, -shift.interval.high, 0.0);
    PM_CHECK_NEAR(back.p, shift.p, 1e-15);
}
END_TEST

/* Of 3000 pairs of samples from one law, 5 % or hardly more are told apart; with a shift the interval holds it as
 * often; small sizes use the exact law, large ones the approximation. Bounds: 5.5 sigma. */
START_TEST(rates_are_as_stated)
{
    enum { RUNS = 3000, MOST = 70 };
    const size_t sizes[][2] = {{8, 11}, {50, 50}, {70, 60}};
    for (size_t k = 0; k < 3; k++) {
        size_t alarms = 0, missed = 0, tolerated = 0;
        for (uint64_t run = 0; run < RUNS; run++) {
            double a[MOST], b[MOST], c[MOST];
            for (size_t i = 0; i < sizes[k][0]; i++)
                a[i] = log(uniform(100 + k, 1000 * run + i));
            for (size_t j = 0; j < sizes[k][1]; j++) {
                b[j] = log(uniform(200 + k, 1000 * run + j));
                c[j] = b[j] + 0.1;
            }
            pm__shift shift;
            pm__rank_shift(a, sizes[k][0], b, sizes[k][1], 0.95, 0.0, &shift);
            alarms += shift.p < 0.05;
            pm__rank_shift(a, sizes[k][0], c, sizes[k][1], 0.95, 0.1, &shift);
            missed += shift.interval.low > 0.1 || shift.interval.high < 0.1;
            tolerated += shift.p < 0.05;
        }
        const double bound = 0.05 * RUNS + 5.5 * sqrt(0.05 * 0.95 * RUNS);
        ck_assert_msg((double)alarms <= bound && (double)missed <= bound && (double)tolerated <= bound,
                      "sizes %zu: %zu alarms, %zu missed, %zu beyond tolerance", k, alarms, missed, tolerated);
        ck_assert(alarms > RUNS / 50 && missed > RUNS / 50);
    }
}
END_TEST

START_TEST(degenerate_samples)
{
    double same[] = {2, 2, 2, 2}, other[] = {3, 3, 3, 3}, one[] = {1}, two[] = {2};
    pm__shift shift;
    pm__rank_shift(same, 4, same, 4, 0.95, 0.0, &shift);
    ck_assert(shift.p == 1.0 && shift.shift == 0.0 && shift.interval.low == 0.0 && shift.interval.high == 0.0);
    pm__rank_shift(same, 4, other, 4, 0.95, 0.0, &shift);
    ck_assert(shift.p < 0.05 && shift.shift == 1.0);
    pm__rank_shift(same, 4, other, 4, 0.95, 1.5, &shift);
    ck_assert(shift.p == 1.0);
    pm__rank_shift(one, 1, two, 1, 0.95, 0.0, &shift);
    ck_assert(shift.p == 1.0 && shift.shift == 1.0);
}
END_TEST

START_TEST(student_p_agrees_with_gsl)
{
    for (double dof = 1.0; dof < 1e5; dof *= 3.7)
        for (double t = 0.0; t < 30.0; t = 1.3 * t + 0.1) {
            const double want = 2.0 * gsl_cdf_tdist_Q(t, dof);
            PM_CHECK_NEAR(pm__student_p(t, dof), want, 1e-5 * want + 1e-300);
            PM_CHECK_NEAR(pm__student_p(-t, dof), want, 1e-5 * want + 1e-300);
        }
}
END_TEST

PM_TEST_MAIN("rank", p_is_that_of_all_permutations, shift_is_the_median_of_all_differences, rates_are_as_stated,
             degenerate_samples, student_p_agrees_with_gsl)
