/* Two samples by their ranks: Mann and Whitney's test, Hodges and Lehmann's shift and the interval that inverts the
 * test. */
#include "stats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EXACT_SIZE = 50, EXACT_TERMS = EXACT_SIZE * EXACT_SIZE / 2 + 1, HALVINGS = 120 };

/* Sorted samples; pairs = na * nb. */
typedef struct pairs {
    const double *a, *b;
    size_t na, nb;
    double count;
} pairs;

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* How many differences b_j - a_i are below t, or also those that equal it. Both samples ascend, so one walk does. */
static double count_below(const pairs *s, double t, int or_equal)
{
    double count = 0.0;
    size_t i = 0; /* a_i is the first that is near enough to b_j */
    for (size_t j = 0; j < s->nb; j++) {
        while (i < s->na && (or_equal ? s->b[j] - s->a[i] > t : s->b[j] - s->a[i] >= t))
            i++;
        count += (double)(s->na - i);
    }
    return count;
}

/* The largest difference that is not above t. */
static double difference_at(const pairs *s, double t)
{
    double best = s->b[0] - s->a[s->na - 1];
    size_t i = 0;
    for (size_t j = 0; j < s->nb; j++) {
        while (i < s->na && s->b[j] - s->a[i] > t)
            i++;
        if (i < s->na)
            best = fmax(best, s->b[j] - s->a[i]);
    }
    return best;
}

/* The rank-th difference in order, from 1. */
static double ordered_difference(const pairs *s, double rank)
{
    double low = s->b[0] - s->a[s->na - 1], high = s->b[s->nb - 1] - s->a[0];
    if (count_below(s, low, 1) >= rank)
        return low;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * low + 0.5 * high;
        *(count_below(s, middle, 1) >= rank ? &high : &low) = middle;
    }
    return difference_at(s, high);
}

/* The null distribution of U. */
typedef struct null_law {
    double count, sigma;    /* pairs; 0 where all values are equal */
    int exact;
    double cdf[EXACT_TERMS]; /* exact: P(U <= u) for u up to half the pairs */
} null_law;

/* Sum of t^3 - t over groups of t equal values among a and b - offset. */
static double tie_sum(const pairs *s, double offset)
{
    double sum = 0.0;
    size_t i = 0, j = 0;
    while (i < s->na || j < s->nb) {
        const double value = j == s->nb || (i < s->na && s->a[i] < s->b[j] - offset) ? s->a[i] : s->b[j] - offset;
        double t = 0.0;
        for (; i < s->na && s->a[i] <= value; i++)
            t += 1.0;
        for (; j < s->nb && s->b[j] - offset <= value; j++)
            t += 1.0;
        sum += t * t * t - t;
    }
    return sum;
}

/* The counts of U are the coefficients of the Gaussian binomial, the product of (1 - q^(nb+i)) / (1 - q^i) over i to
 * na. */
static void fill_exact(const pairs *s, null_law *law)
{
    double *const c = law->cdf, total = 1.0, sum = 0.0;
    const size_t terms = s->na * s->nb / 2 + 1;
    memset(c, 0, terms * sizeof *c);
    c[0] = 1.0;
    for (size_t i = 1; i <= s->na; i++) {
        for (size_t u = terms; u-- > s->nb + i;)
            c[u] -= c[u - s->nb - i];
        for (size_t u = i; u < terms; u++)
            c[u] += c[u - i];
        total *= (double)(s->nb + i) / (double)i;
    }
    for (size_t u = 0; u < terms; u++) {
        sum += c[u];
        c[u] = sum / total;
    }
}

static void fill_law(const pairs *s, double offset, null_law *law)
{
    const double n = (double)(s->na + s->nb), ties = tie_sum(s, offset);
    law->count = s->count;
    law->sigma = sqrt(fmax(0.0, s->count / 12.0 * (n + 1.0 - ties / (n * (n - 1.0)))));
    law->exact = s->na <= EXACT_SIZE && s->nb <= EXACT_SIZE && !(ties > 0.0);
    if (law->exact)
        fill_exact(s, law);
}

/* P(U <= u). */
static double lower_tail(const null_law *law, double u)
{
    if (u < 0.0)
        return 0.0;
    if (u >= law->count || !(law->sigma > 0.0))
        return 1.0;
    if (!law->exact)
        return 0.5 * erfc(-(u + 0.5 - 0.5 * law->count) / law->sigma * sqrt(0.5));
    if (u <= 0.5 * law->count)
        return law->cdf[(size_t)u];
    const double beyond = law->count - floor(u) - 1.0;
    return beyond < 0.0 ? 1.0 : 1.0 - law->cdf[(size_t)beyond];
}

/* The p-value of "the shift is at most offset" (sign 1) or "at least offset" (sign -1). */
static double one_sided(const pairs *s, double offset, int sign)
{
    null_law law;
    fill_law(s, offset, &law);
    const double below = count_below(s, offset, 0), tied = count_below(s, offset, 1) - below;
    const double u = sign > 0 ? below + 0.5 * tied : s->count - below - 0.5 * tied;
    return lower_tail(&law, u);
}

/* The largest c with P(U <= c - 1) <= error / 2. */
static double critical_rank(const null_law *law, double error)
{
    double low = 0.0, high = floor(0.5 * law->count);
    while (low < high) {
        const double middle = floor(0.5 * (low + high + 1.0));
        if (lower_tail(law, middle - 1.0) <= 0.5 * error)
            low = middle;
        else
            high = middle - 1.0;
    }
    return low;
}

void pm__rank_shift(double *a, size_t na, double *b, size_t nb, double level, double tolerance, pm__shift *out)
{
    qsort(a, na, sizeof *a, by_value);
    qsort(b, nb, sizeof *b, by_value);
    const pairs s = {a, b, na, nb, (double)na * (double)nb};
    null_law law;
    fill_law(&s, 0.0, &law);
    const double rank = fmax(1.0, critical_rank(&law, 1.0 - level)), half = floor(0.5 * s.count);
    out->shift = fmod(s.count, 2.0) > 0.0
                     ? ordered_difference(&s, half + 1.0)
                     : 0.5 * ordered_difference(&s, half) + 0.5 * ordered_difference(&s, half + 1.0);
    out->interval = (pm__interval){ordered_difference(&s, rank), ordered_difference(&s, s.count + 1.0 - rank)};
    out->p = fmin(1.0, 2.0 * fmin(one_sided(&s, tolerance, 1), one_sided(&s, -tolerance, -1)));
}
