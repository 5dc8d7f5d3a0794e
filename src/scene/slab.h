/* A ray between two parallel planes, as of a box's sides: one by one and by the hundred alike. */
#ifndef PM_SCENE_SLAB_H
#define PM_SCENE_SLAB_H

#include "../base/inline.h"

/* Cuts [*enter, *leave] to where low <= at + t / rate <= high. Along a plane and on it, 0 * inf compares false: such a
 * ray is within. */
PM__INLINE void pm__slab_cut(double at, double rate, double low, double high, double *enter, double *leave)
{
    const double near = ((rate < 0.0 ? high : low) - at) * rate, far = ((rate < 0.0 ? low : high) - at) * rate;
    *enter = near > *enter ? near : *enter;
    *leave = far < *leave ? far : *leave;
}

#endif
