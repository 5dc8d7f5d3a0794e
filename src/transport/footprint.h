/* How far a path's vertex moves with the numbers that the path is made of: path differentials (Suykens and Willems
 * 2001; Igehy 1999 for mirrors and glass; [C02] 3.4.3).
 *
 * Each number, moved by 1, moves the vertex and the direction of the path by a vector each, to first order. The first
 * two numbers are the place in the image, in pixels; each rough bounce adds two unit numbers. What is chosen by a
 * number (reflection or refraction, absorption) does not move with it.
 *
 * begin -> arrive -> pass -> arrive -> ... -> arrive at a rough surface: its area -> bounce -> arrive -> ... */
#ifndef PM_TRANSPORT_FOOTPRINT_H
#define PM_TRANSPORT_FOOTPRINT_H

#include "../scene/camera.h"
#include "../scene/scene.h"

enum { PM__FOOTPRINT_NUMBERS = 6 };

typedef struct pm__footprint {
    double place[PM__FOOTPRINT_NUMBERS][3]; /* m */
    double way[PM__FOOTPRINT_NUMBERS][3];   /* of the unit direction */
    int count;
} pm__footprint;

/* On the way through the point (x, y) of the image. */
void pm__footprint_begin(pm__footprint *footprint, const pm__camera *camera, double x, double y);

/* Along the direction to the surface met: the vertex stays on it. */
void pm__footprint_arrive(pm__footprint *footprint, const double direction[3], const pm__hit *hit);

/* Off a mirror, or off or through glass of index `ior` within (not looked at otherwise), whichever the unit directions
 * tell. Exact to first order on exact shapes; triangles of a mesh are flat, whatever surface they stand for. */
void pm__footprint_pass(pm__footprint *footprint, const pm__scene *scene, const pm__hit *hit, const double in[3],
                        const double out[3], double ior);

/* Off a rough surface. weight: of the path before, by band. A direction that two numbers draw with density p moves over
 * the solid angle 1 / p, taken as a square; and with the surface's normal it turns. Of a glossy lobe it also moves as
 * if mirrored by the facet that sends it there. */
void pm__footprint_bounce(pm__footprint *footprint, const pm__scene *scene, const pm__hit *hit, const double in[3],
                          const double out[3], const double weight[3]);

/* m2: with each number moved by up to 1/2 either way, of the parallelogram whose points have the same mean square off
 * the vertex in every direction, sqrt det(sum of v v^T) in the tangent plane. Of two vectors it is theirs, |v x w|; of
 * more it has no corners to be searched for. 0, infinite or NaN where the vectors are so. */
double pm__footprint_area(const pm__footprint *footprint);

#endif
