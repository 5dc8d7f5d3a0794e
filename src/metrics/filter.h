/* Filters over planes of numbers that are products of a filter along rows and one along columns. */
#ifndef PM_METRICS_FILTER_H
#define PM_METRICS_FILTER_H

#include <stddef.h>

/* Weights at -radius ... radius; owned by who made it. */
typedef struct pm__kernel {
    double *weights; /* [2 radius + 1] */
    size_t radius;
} pm__kernel;

/* w(i) proportional to `shape` at distance i from the middle; free with pm__kernel_free, always. -1: out of memory. */
int pm__kernel_create(size_t radius, double (*shape)(double x, double width), double width, pm__kernel *kernel);
void pm__kernel_free(pm__kernel *kernel);

/* Makes the positive weights sum to 1, and the negative ones to -1. */
void pm__kernel_normalize(pm__kernel *kernel);

/* exp(-x^2 / (2 width^2)). */
double pm__gaussian(double x, double width);

/* A plane of w x h numbers, row by row. */
typedef struct pm__plane {
    size_t width, height;
} pm__plane;

/* to(x, y) = sum over i, j of along(i) down(j) from(x + i, y + j); beyond the border the nearest pixel. scratch: w * h;
 * none of the three may overlap. Cost: w * h (both radii * 2 + 2). */
void pm__filter(const pm__plane *plane, const double *from, const pm__kernel *along, const pm__kernel *down,
                double *scratch, double *to);

#endif
