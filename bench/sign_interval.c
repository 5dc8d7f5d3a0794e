/* The interval for a median that the sign test gives. */
#include "harness.h"

#include <math.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* 2 P(Binomial(n, 1/2) <= r - 1), for 1 <= r <= n / 2: the binomial's distribution as an incomplete beta function. */
static double miss_probability(size_t n, size_t r)
{
    return 2.0 * pm__beta_cdf((double)(n - r + 1), (double)r, 0.5);
}

size_t pm__sign_rank(size_t n, double level, double *missed)
{
    const double allowed = (1.0 - level) * (1.0 + 1e-9); /* rounding must not cost a rank where both are equal */
    size_t low = 0, high = n / 2;
    while (low < high) {
        const size_t r = low + (high - low + 1) / 2;
        if (miss_probability(n, r) <= allowed)
            low = r;
        else
            high = r - 1;
    }
    *missed = low ? miss_probability(n, low) : 0.0;
    return low;
}

double pm__sign_interval(double *values, size_t n, double level, pm__interval *interval)
{
    if (!n) {
        *interval = (pm__interval){(double)NAN, (double)NAN};
        return (double)NAN;
    }
    double missed;
    const size_t r = pm__sign_rank(n, level, &missed);
    qsort(values, n, sizeof *values, by_value);
    *interval = (pm__interval){values[r ? r - 1 : 0], values[r ? n - r : n - 1]};
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}
