/* Every image metric, one row each, in the order in which tables show them.
 * Beside the rows: list.c (this list as data); measure.c (asking one); image_means.c, colour.c, filter.c, flip_map.c
 * (what they share). */
#ifndef PM_METRICS_LIST_H
#define PM_METRICS_LIST_H

#include "metric.h"

#define PM_METRIC_LIST(X) \
    X(mse)                \
    X(relmse)             \
    X(mape)               \
    X(smape)              \
    X(ssim)               \
    X(flip)               \
    X(hdrflip)

#define X(name) extern const pm__metric pm__metric_##name;
PM_METRIC_LIST(X)
#undef X

#endif
