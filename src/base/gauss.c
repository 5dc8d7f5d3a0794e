#include "gauss.h"

#include <math.h>

/* P_n and its derivative at x, by the three-term recurrence. */
static double legendre(int n, double x, double *slope)
{
    double before = 1.0, value = x;
    for (int m = 2; m <= n; m++) {
        const double next = ((2.0 * m - 1.0) * x * value - (m - 1.0) * before) / m;
        before = value;
        value = next;
    }
    *slope = n * (x * value - before) / (x * x - 1.0);
    return value;
}

void pm__gauss_legendre(int n, double *nodes, double *weights)
{
    const double pi = 3.14159265358979323846;
    for (int i = 0; i < n; i++) {
        double x = -cos(pi * (i + 0.75) / (n + 0.5)), slope = 1.0; /* Tricomi's first guess */
        for (int step = 0; step < 20; step++) {
            const double change = legendre(n, x, &slope) / slope;
            x -= change;
            if (fabs(change) < 1e-16)
                break;
        }
        (void)legendre(n, x, &slope);
        nodes[i] = 0.5 * (1.0 + x);
        weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
}
