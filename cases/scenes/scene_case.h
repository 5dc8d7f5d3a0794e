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

/* Light that arrives in sheets: rays of one parameter t cover the floor, each as a straight strip, so that the power in
 * a disc needs no irradiance and no roots of it:
 *     integral dt strip(t, sqrt(r^2 - miss(t)^2))  over |miss(t)| < r,
 * miss: signed distance, m, of the disc's middle from the line of t; strip: power per t on the line's part that is
 * within `half` of the point nearest the middle. */
typedef struct pm__sheets {
    double (*miss)(const void *context, double t, double *slope);
    double (*strip)(const void *context, double t, double half);
    double low, high; /* of t */
} pm__sheets;

/* Power, W, at distances in (r0, r1] from the middle. Relative error of the disc of r1 below 1e-8; NAN where a
 * circle of up to 1.25 r1 touches a fold (its tangent is its ray, so there miss has an extremum; elsewhere the power is
 * smooth in r, even where the disc holds a cusp), or an end of t is as near, and where no light is. Cost: some 300
 * calls. */
double pm__mass_sheets(const pm__sheets *sheets, const void *context, double r0, double r1);

/* The same for an irradiance that is smooth on the disc, and even about an axis through its middle: given r and the
 * cosine of the angle from the axis. Relative error below 1e-7 where it varies over lengths of r / 3; NAN where it
 * varies faster. Cost: 30 to 500 calls. */
double pm__mass_even(double (*irradiance)(const void *context, double r, double cosine), const void *context, double r0,
                     double r1);

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
/* The power, W, at distances in (r0, r1] from a point rho from the foot; NAN where that reaches beyond the light. */
double pm__layered_mass(const pm__layered *layered, double rho, double r0, double r1);
/* What the cases of layers share beside that: regions by the distance from the foot, and their probes; irradiance and
 * power within a lookup at a probe. */
enum { PM__LAYERED_REGIONS = 3 };
extern const pm__region pm__layered_regions[PM__LAYERED_REGIONS];
void pm__layered_probe(const double *values, size_t region, const double *u, pm__probe *point);
double pm__layered_truth(const pm__layered *layered, const pm__probe *point);
double pm__layered_within(const pm__layered *layered, const pm__probe *point, const pm__shape *shape, double r0,
                          double r1);

/* All the power, W, that reaches the floor; and how far from the foot. */
double pm__layered_power(const pm__layered *layered);
double pm__layered_extent(const pm__layered *layered);

/* Is the upper side asked for? (Backs of floors get no light of the scenes' paths.) And of a sphere about the origin,
 * the inside? */
static inline bool pm__is_upside(const pm__probe *point)
{
    return point->normal[2] > 0.0;
}
static inline bool pm__is_inside(const pm__probe *point)
{
    return pm__dot(point->normal, point->position) < 0.0;
}

/* A probe uniform on the inside of the unit sphere, from u[0..1]. */
void pm__probe_sphere(const double *u, pm__probe *point);

/* Adds a horizontal white Lambertian rectangle, |x - x0| <= half, |y| <= half, at height z. ENOMEM. */
pm_status pm__scene_floor(pm__scene *scene, double x0, double half, double z, pm_error *error);
/* The inside of a Lambertian sphere of radius 1 about the origin, with its light; and how it is looked at. */
pm_status pm__scene_ball_room(pm__scene *scene, double albedo, const pm__light *light, pm_error *error);
void pm__ball_room_view(const double *values, pm__view *view);
/* A light of the kind that points straight down. */
pm_status pm__scene_lamp(pm__scene *scene, pm__light_kind kind, double z, double watts, double radius, double angle,
                         pm_error *error);

#endif
