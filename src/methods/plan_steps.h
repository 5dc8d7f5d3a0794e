/* Steps of a plan that several methods have, and the questions about a scene that plans ask. */
#ifndef PM_METHODS_PLAN_STEPS_H
#define PM_METHODS_PLAN_STEPS_H

#include "method.h"

size_t pm__count_objects(const pm__scene *scene, bool (*is)(const pm__material *material));
bool pm__is_specular(const pm__material *material);
bool pm__is_glossy(const pm__material *material);
/* Are all rough surfaces in one plane, and everything, lights and the camera included, on one side of it? Then no
 * photon comes from behind, none of another surface is near, and the side without light is not seen. eye: NULL: it does
 * not matter from where it is seen. */
bool pm__is_single_floor(const pm__scene *scene, const double eye[3]);

/* A step with a reason, as by printf. */
void pm__plan_step(pm__plan *plan, bool done, const char *name, const char *why, ...)
    __attribute__((format(printf, 4, 5)));
/* What follows the reason why something is not needed: that it is done all the same. */
const char *pm__plan_anyway(const pm__render_job *job);
/* Must lookups refuse photons from behind, must maps keep directions; and the media that no scene has yet. */
void pm__plan_front(const pm__render_job *job, pm__plan *plan, pm__needs *needs);
/* One map where several would be equal: of estimators; kinds: what is said of the method's own maps. */
void pm__plan_maps(const pm__render_job *job, const char *kinds, pm__plan *plan, pm__needs *needs);
void pm__plan_volume(const pm__render_job *job, pm__plan *plan);

#endif
