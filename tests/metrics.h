/* Images for the tests of metrics, and asking one. */
#ifndef PM_TESTS_METRICS_H
#define PM_TESTS_METRICS_H

#include "../src/metrics/list.h"
#include "test.h"

static inline pm__spec spec_of(const char *text)
{
    pm__spec spec;
    pm_error error = {""};
    PM_CHECK_OK(pm__spec_parse(&pm__metrics, text, &spec, &error), error);
    return spec;
}

static inline pm__measured measure(const char *metric, const pm__image *a, const pm__image *b)
{
    pm__measured m;
    pm_error error = {""};
    bool undefined;
    const pm__spec spec = spec_of(metric);
    PM_CHECK_OK(pm__metric_measure(&spec, a, b, &m, &undefined, &error), error);
    ck_assert(!undefined);
    return m;
}

static inline double mean_of(const char *metric, const pm__image *a, const pm__image *b)
{
    pm__measured m = measure(metric, a, b);
    const double mean = m.mean;
    pm__measured_free(&m);
    return mean;
}

static inline pm__image image_of(size_t width, size_t height, float *values)
{
    return (pm__image){width, height, 3, values};
}

static unsigned state = 1; /* of uniform() */

static inline double uniform(void)
{
    state = state * 1664525U + 1013904223U;
    return (double)(state >> 8) / 16777216.0;
}

/* Radiance over five decades. */
static inline pm__image random_image(size_t width, size_t height, unsigned seed)
{
    pm__image image;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(width, height, 3, &image, &error), error);
    state = seed;
    for (size_t i = 0; i < 3 * width * height; i++)
        image.values[i] = (float)pow(10.0, 5.0 * uniform() - 4.0);
    return image;
}

static inline void times(pm__image *image, float factor)
{
    for (size_t i = 0; i < 3 * image->width * image->height; i++)
        image->values[i] *= factor;
}

/* x where HDR-FLIP's tone curve, ACES by Narkowicz without its own exposure, is 0.85: by bisection. */
static inline long double tone_inverse(void)
{
    long double low = 0.0L, high = 100.0L;
    for (int i = 0; i < 200; i++) {
        const long double mid = 0.5L * (low + high), x = 0.6L * mid;
        *(x * (2.51L * x + 0.03L) / (x * (2.43L * x + 0.59L) + 0.14L) < 0.85L ? &low : &high) = mid;
    }
    return low;
}

#endif
