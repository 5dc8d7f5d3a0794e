/* Every method of rendering, one row each, in the order in which tables show them. Beside the rows: list.c (this list
 * as data), render.c, film.c, develop.c and memory.c (what drives them), plan.c, stage.c, maps.c, irradiance.c
 * and coverage.c (what they share). */
#ifndef PM_METHODS_LIST_H
#define PM_METHODS_LIST_H

#include "method.h"

#define PM_METHOD_LIST(X) \
    X(visualize)          \
    X(full)               \
    X(path)

#define X(name) extern const pm__method pm__method_##name;
PM_METHOD_LIST(X)
#undef X

#endif
