/* Medians. */
#include "stats.h"

#include <math.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The largest r with P(Binomial(n, 1/2) <= r - 1) <= 0.025: [x_r, x_(n+1-r)] covers the median with 95 % or more. */
static size_t order_rank(size_t n)
{
    double term = ldexp(1.0, -(int)n), sum = 0.0;
    size_t r = 0;
    while (r < n / 2) {
        sum += term;
        if (sum > 0.025)
            break;
        term *= (double)(n - r) / (double)(r + 1);
        r++;
    }
    return r;
}

double pm__median(double *values, size_t n)
{
    qsort(values, n, sizeof *values, by_value);
    return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

double pm__median_interval(double *values, size_t n, pm__interval *interval)
{
    if (!n) {
        *interval = (pm__interval){NAN, NAN};
        return NAN;
    }
    const double median = pm__median(values, n);
    const size_t r = n <= 1000 ? order_rank(n) : (size_t)((double)n / 2.0 - 0.98 * sqrt((double)n));
    *interval = r ? (pm__interval){values[r - 1], values[n - r]} : (pm__interval){values[0], values[n - 1]};
    return median;
}
