/* How much of the disc of a lookup is surface. Beyond an edge there is nothing for photons to lie on, so estimates that
 * divide by the whole disc are dark there (truths: half at an edge, a quarter in a corner). A renderer has what an
 * estimator has not, the scene: rays along the normal tell where the surface goes on. */
#ifndef PM_METHODS_COVERAGE_H
#define PM_METHODS_COVERAGE_H

#include "../lookup/lookup.h"
#include "../scene/scene.h"

enum { PM__DISC_POINTS = 32 };

/* Which of the points of the disc, of equal area each, from the middle outward, are on the surface. */
typedef struct pm__coverage {
    bool there[PM__DISC_POINTS];
} pm__coverage;

/* The disc of `radius`, m, about a point on a surface whose unit normal on the lit side is `normal`. phase: 0 to 1,
 * turns the points. Surfaces may bend away by a quarter of the radius. Cost: 33 rays at most, one where all is far. */
void pm__coverage_find(const pm__scene *scene, const double position[3], const double normal[3], double radius,
                       double phase, pm__coverage *coverage);

/* The share of the estimator's weight that lies on the surface: its kernel's, or of the disc's area. 1 for those that
 * find the surface's edge themselves (the hull). */
double pm__coverage_share(const pm__coverage *coverage, const pm__spec *estimator);

#endif
