/* Mean and spread of what trials give. */
#ifndef PM_TESTS_MOMENTS_H
#define PM_TESTS_MOMENTS_H

#include <math.h>
#include <stddef.h>

typedef struct pm__moments {
    double sum, square;
    size_t count;
} pm__moments;

static inline void pm__moments_add(pm__moments *m, double x)
{
    m->sum += x;
    m->square += x * x;
    m->count++;
}

static inline double pm__moments_mean(const pm__moments *m)
{
    return m->sum / (double)m->count;
}

static inline double pm__moments_variance(const pm__moments *m)
{
    const double n = (double)m->count, mean = m->sum / n;
    return fmax(0.0, m->square / n - mean * mean) * n / (n - 1.0);
}

/* Standard error of the mean. */
static inline double pm__moments_error(const pm__moments *m)
{
    return sqrt(pm__moments_variance(m) / (double)m->count);
}

#endif
