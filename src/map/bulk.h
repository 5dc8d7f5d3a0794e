/* The bulk of a sample: what a grid covers, so that a few photons far off make no cell larger. */
#ifndef PM_MAP_BULK_H
#define PM_MAP_BULK_H

#include <stdlib.h>

static inline int pm__by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The range of all but 0.5 % of the sample at each end. Sorts it; count > 0. */
static inline void pm__bulk(float *sample, size_t count, float *from, float *to)
{
    const size_t skipped = count / 200;
    qsort(sample, count, sizeof *sample, pm__by_value);
    *from = sample[skipped];
    *to = sample[count - 1 - skipped];
}

#endif
