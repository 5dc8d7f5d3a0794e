/* The incomplete beta function and what follows from it. */
#include "stats.h"

#include <math.h>

/* The continued fraction of I_x(a, b) by the modified Lentz method (DLMF 8.17.22); converges fast for
 * x < (a + 1) / (a + b + 2). */
static double beta_fraction(double a, double b, double x)
{
    const double tiny = 1e-300;
    double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
    d = 1.0 / (fabs(d) < tiny ? tiny : d);
    double value = d;
    for (int m = 1; m < 10000; m++) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double step = 1.0;
        for (int half = 0; half < 2; half++) {
            const double term = half ? odd : even;
            d = 1.0 + term * d;
            d = 1.0 / (fabs(d) < tiny ? tiny : d);
            c = 1.0 + term / c;
            c = fabs(c) < tiny ? tiny : c;
            step = c * d;
            value *= step;
        }
        if (fabs(step - 1.0) < 1e-16)
            break;
    }
    return value;
}

/* x > 0. lgamma would write its sign to a global variable. */
static double log_gamma(double x)
{
    int sign;
    return lgamma_r(x, &sign);
}

double pm__beta_cdf(double a, double b, double x)
{
    if (!(x > 0.0))
        return 0.0;
    if (x >= 1.0)
        return 1.0;
    const double front = exp(a * log(x) + b * log1p(-x) + log_gamma(a + b) - log_gamma(a) - log_gamma(b));
    if (x < (a + 1.0) / (a + b + 2.0))
        return front * beta_fraction(a, b, x) / a;
    return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

static double student_cdf(double t, double dof)
{
    return 1.0 - 0.5 * pm__beta_cdf(0.5 * dof, 0.5, dof / (dof + t * t));
}

double pm__student_p(double t, double dof)
{
    return pm__beta_cdf(0.5 * dof, 0.5, dof / (dof + t * t));
}

double pm__student_quantile(double p, double dof)
{
    double low = 0.0, high = 2.0;
    while (student_cdf(high, dof) < p && high < 1e12)
        high *= 2.0;
    for (int i = 0; i < 200 && high - low > 1e-14 * high; i++) {
        const double middle = 0.5 * (low + high);
        *(student_cdf(middle, dof) < p ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}
