/* Wall clock that only goes forward. */
#ifndef PM_BASE_CLOCK_H
#define PM_BASE_CLOCK_H

#include <time.h>

/* Seconds since some moment. */
static inline double pm__seconds(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
