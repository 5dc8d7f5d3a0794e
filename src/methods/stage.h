/* What is looked at and from where: a scene that has been built, and the camera before it. */
#ifndef PM_METHODS_STAGE_H
#define PM_METHODS_STAGE_H

#include "../../cases/case.h"

typedef struct pm__stage {
    const pm__case *subject;
    const double *values; /* its parameters, the caller's */
    pm__scene *scene;
    pm__camera camera;
} pm__stage;

/* The scene of the spec, and a camera for images of this size; view: NULL: the scene's own. EINVAL: a parameter that
 * the scene refuses, a camera that cannot be or stands in a wall; ENOMEM. On error all is released. */
pm_status pm__stage_open(const pm__spec *spec, const pm__view *view, size_t width, size_t height, pm__stage *stage,
                         pm_error *error);
void pm__stage_close(pm__stage *stage); /* one that was never opened, all zero, is allowed */

/* The exact answer at a surface point, as it sends it back: radiance, W/(m2 sr), by band; NAN where it is not known.
 * normal: unit, on the side that is seen; outgoing: unit, to who looks; brdf: 1/sr, of surfaces that scatter alike in
 * all directions, else NULL. */
void pm__stage_truth(const pm__stage *stage, const double position[3], const double normal[3],
                     const double outgoing[3], const double *brdf, double radiance[3]);

#endif
