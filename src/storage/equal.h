/* Costs at equal error, from measurements at a few sizes. */
#ifndef PM_STORAGE_EQUAL_H
#define PM_STORAGE_EQUAL_H

#include "../stats/stats.h"

#include <stddef.h>

/* One policy at `count` sizes: [size][trial]. */
typedef struct pm__sizes {
    size_t count, trials;
    const double *const *square; /* squared errors */
    const double *const *cost;
} pm__sizes;

typedef struct pm__equal {
    double error;          /* at which both are compared; NAN */
    double ratio;          /* the other's cost over mine; NAN */
    pm__interval ci95;     /* over trials, which are paired: jackknife of the logarithm */
    const char *why;       /* NULL, or why there is none */
} pm__equal;

/* At the least error that both reach. It is that of a size of one of both; the other's cost there: by straight lines
 * through logarithms, from size to size by ascending cost, the first that meets the error. Sizes whose mean square or
 * cost is not above 0 are passed over. Both of as many trials, two or more. ENOMEM shows as no ratio. */
pm__equal pm__equal_error(const pm__sizes *mine, const pm__sizes *other);

/* The sizes that no other one beats in both mean cost and error, by ascending cost: into front[count]; how many. */
size_t pm__undominated(const pm__sizes *sizes, size_t *front);

#endif
