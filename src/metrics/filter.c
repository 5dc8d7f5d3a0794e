#include "filter.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double pm__gaussian(double x, double width)
{
    return exp(-x * x / (2.0 * width * width));
}

int pm__kernel_create(size_t radius, double (*shape)(double x, double width), double width, pm__kernel *kernel)
{
    *kernel = (pm__kernel){pm__alloc(2 * radius + 1, sizeof *kernel->weights), radius};
    for (size_t i = 0; kernel->weights && i <= 2 * radius; i++)
        kernel->weights[i] = shape((double)i - (double)radius, width);
    return kernel->weights ? 0 : -1;
}

void pm__kernel_free(pm__kernel *kernel)
{
    free(kernel->weights);
    *kernel = (pm__kernel){0};
}

void pm__kernel_normalize(pm__kernel *kernel)
{
    double above = 0.0, below = 0.0;
    for (size_t i = 0; i <= 2 * kernel->radius; i++)
        *(kernel->weights[i] > 0.0 ? &above : &below) += kernel->weights[i];
    for (size_t i = 0; i <= 2 * kernel->radius; i++)
        if (kernel->weights[i] != 0.0)
            kernel->weights[i] /= kernel->weights[i] > 0.0 ? above : -below;
}

/* Where place `at` + i - radius is, kept within 0 ... size - 1. */
static size_t kept_within(size_t at, size_t i, size_t radius, size_t size)
{
    const size_t place = at + i < radius ? 0 : at + i - radius;
    return place < size ? place : size - 1;
}

static void filter_row(const double *from, size_t width, const pm__kernel *kernel, double *to)
{
    const size_t taps = 2 * kernel->radius + 1;
    for (size_t x = 0; x < width; x++) {
        double sum = 0.0;
        if (x >= kernel->radius && x + kernel->radius < width)
            for (size_t i = 0; i < taps; i++)
                sum += kernel->weights[i] * from[x - kernel->radius + i];
        else
            for (size_t i = 0; i < taps; i++)
                sum += kernel->weights[i] * from[kept_within(x, i, kernel->radius, width)];
        to[x] = sum;
    }
}

void pm__filter(const pm__plane *plane, const double *from, const pm__kernel *along, const pm__kernel *down,
                double *scratch, double *to)
{
    const size_t width = plane->width, height = plane->height;
    for (size_t y = 0; y < height; y++)
        filter_row(&from[y * width], width, along, &scratch[y * width]);
    memset(to, 0, width * height * sizeof *to);
    for (size_t y = 0; y < height; y++)
        for (size_t i = 0; i <= 2 * down->radius; i++) { /* whole rows, in the order of memory */
            const double weight = down->weights[i];
            const double *const row = &scratch[kept_within(y, i, down->radius, height) * width];
            for (size_t x = 0; x < width; x++)
                to[y * width + x] += weight * row[x];
        }
}
