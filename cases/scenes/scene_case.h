/* What the cases of traced scenes share: roots of light paths, Fresnel's law, quadrature, floors.
 *
 * Every map from emitted rays to floor points here is one equation in one unknown, whose roots are the paths by which
 * light reaches a probe. All functions but the last are pure, in double. */
#ifndef PM_SCENES_SCENE_CASE_H
#define PM_SCENES_SCENE_CASE_H

#include "../planar.h"

enum { PM__MOST_ROOTS = 16 };

typedef double (*pm__function)(const void *context, double x);

/* The roots in (low, high), ascending, to rounding; returns how many. The function is sampled at the ends of `cells`
 * equal cells; where its magnitude has a minimum without a change of sign, that minimum is sought, so pairs that have
 * just been born at a fold are found though they share a cell. Roots that touch without crossing are not: there the
 * irradiance is infinite. Cost: cells + about 60 a root or minimum. */
size_t pm__roots(pm__function function, const void *context, double low, double high, int cells,
                 double roots[PM__MOST_ROOTS]);

/* The integral over [low, high], by Gauss-Legendre quadrature of 128 nodes. */
double pm__integral(pm__function function, const void *context, double low, double high);

/* Fresnel: 1 - reflectance of unpolarised light at a boundary, from the cosine of incidence (0 to 1) and the index n
 * of the far side over the near side (>= 1). The same from the other side along the same ray. */
double pm__transmittance(double cosine, double n);

/* A point light that sends 1 W/sr into the cone of half angle `cone` about the downward normal of a flat layer of index
 * n and thickness `layer`, below which (or above: order does not matter) lies air, `air` in all on the way to the
 * floor. crossings: how many boundaries the light crosses, each with its Fresnel loss. */
typedef struct pm__layered {
    double air, layer, n; /* m, m, >= 1 */
    double cone;          /* radian, < pi / 2 */
    int crossings;
} pm__layered;

/* Irradiance, W/m2, at the distance rho >= 0 from the foot of the light; derived in scene_case.c. */
double pm__layered_irradiance(const pm__layered *layered, double rho);
/* All the power, W, that reaches the floor; and how far from the foot. */
double pm__layered_power(const pm__layered *layered);
double pm__layered_extent(const pm__layered *layered);

/* Adds a horizontal white Lambertian rectangle, |x - x0| <= half, |y| <= half, at height z. ENOMEM. */
pm_status pm__scene_floor(pm__scene *scene, double x0, double half, double z, pm_error *error);
/* A light of the kind that points straight down. */
pm_status pm__scene_lamp(pm__scene *scene, pm__light_kind kind, double z, double watts, double radius, double angle,
                         pm_error *error);

#endif
