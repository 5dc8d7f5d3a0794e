/* Every progressive method, one row each, in the order in which tables show them. Beside the rows: list.c (this list
 * as data), progression.c (what runs share), run.c (runs), lookups.c (points look for photons), splat.c (photons find
 * points), cover.c (where points lie), choice.c (which of the two it is), shrink.c (radii), means.c (means of passes),
 * curvature.c (how kernels blur), estimates.c (a run's own error). */
#ifndef PM_METHODS_PROGRESSIVE_LIST_H
#define PM_METHODS_PROGRESSIVE_LIST_H

#include "progressive.h"

#define PM_PROGRESSIVE_LIST(X) \
    X(pm)                      \
    X(pm_average)              \
    X(pm_combine)              \
    X(ppm)                     \
    X(sppm)                    \
    X(pppm)                    \
    X(appm)                    \
    X(path)                    \
    X(light)

#define X(name) extern const pm__progressive pm__progressive_##name;
PM_PROGRESSIVE_LIST(X)
#undef X

#endif
