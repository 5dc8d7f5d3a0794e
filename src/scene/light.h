/* Lights: where photons come from, and what is seen of them. Power in W by band, all of it emitted. */
#ifndef PM_SCENE_LIGHT_H
#define PM_SCENE_LIGHT_H

#include "../base/status.h"

#include <stdbool.h>

typedef enum pm__light_kind {
    PM__POINT,       /* isotropic, or a cone: spot */
    PM__SPOT,        /* uniform within `angle` of `direction` */
    PM__DIRECTIONAL, /* parallel light along `direction` through the disc of `radius` about `position` */
    PM__RECTANGLE,   /* Lambertian, from one side: that of cross(edge[0], edge[1]) */
    PM__BALL,        /* a Lambertian sphere of `radius`; `inward`: its inside shines */
    PM__SUN          /* a sky's disc of even radiance, as seen through a window: see below */
} pm__light_kind;

typedef struct pm__light {
    pm__light_kind kind;
    double power[3];     /* W */
    double position[3];  /* m; of a rectangle its corner */
    double direction[3]; /* unit */
    double edge[2][3];   /* m */
    double radius;       /* m */
    double angle;        /* radian, of the cone's half */
    bool inward;
} pm__light;

/* A sun is infinitely far and fills the cone of half `angle` (up to pi / 2) about -`direction`. Its light comes in by a
 * window alone, the disc of `radius` about `position` across `direction`: photons start there, shadow rays end there,
 * and it is seen there. All lines within the cone that pass the window have the radiance
 *     L = power / (pi radius^2 pi sin^2 angle),
 * so photons leave evenly over the window, and with the cosine to it over directions. Where the whole cone is seen by
 * the window a surface across the light has the irradiance power / (pi radius^2), as from parallel light. */

/* A photon as it leaves: u[4] uniform. Density of positions and directions as the light emits: all photons of a light
 * carry the same power. */
void pm__emit(const pm__light *light, const double u[4], double position[3], double direction[3]);

/* Lights are immaterial: nothing is hidden by them, rays pass through.
 *
 * Light that arrives at a point, sampled: u[2] uniform. irradiance: W/m2 on a surface that faces it, by band, over the
 * chance of the sample: its mean times BRDF and cosine is the reflected radiance, if nothing is in between. false: none
 * arrives there. */
typedef struct pm__light_sample {
    double direction[3]; /* unit, toward the light */
    double position[3];  /* m, on the light; of parallel light and suns where it starts */
    double irradiance[3];
} pm__light_sample;
bool pm__light_reach(const pm__light *light, const double point[3], const double u[2], pm__light_sample *sample);

/* The radiance, W/(m2 sr), that the light sends against a ray which passes it within `reach`, and how far off, m (of a
 * sun: its window). Only rectangles, balls and suns can be seen. false: it is not, radiance is 0 and the distance not
 * set to any purpose. */
bool pm__light_seen(const pm__light *light, const double origin[3], const double direction[3], double reach,
                    double radiance[3], double *distance);

/* Can it be at all? */
static inline bool pm__light_shows(const pm__light *light)
{
    return light->kind == PM__RECTANGLE || light->kind == PM__BALL || light->kind == PM__SUN;
}

/* EINVAL names what is not finite or out of range. */
pm_status pm__light_check(const pm__light *light, pm_error *error);

#endif
