/* Materials: what a surface does with a photon or a ray. All values by band (red, green, blue). */
#ifndef PM_SCENE_MATERIAL_H
#define PM_SCENE_MATERIAL_H

#include "../base/status.h"
#include "../base/vec3.h"

#include <stdbool.h>

typedef enum pm__material_kind {
    PM__DIFFUSE, /* Lambert */
    PM__GLOSSY,  /* Schlick's model over a Lambert base ([J96a] eq. 5; errata 25, 26) */
    PM__MIRROR,
    PM__GLASS,   /* a smooth boundary of two media: Fresnel, unpolarised; Beer's law within */
    PM__BLACK    /* absorbs all: screens that catch nothing */
} pm__material_kind;

typedef struct pm__material {
    pm__material_kind kind;
    double diffuse[3];    /* albedo, 0 to 1, of the side that the normal points to */
    double back[3];       /* and of the other side (two_sided); else the other side is as the front */
    bool two_sided;
    double specular[3];   /* mirror: reflectance; glossy: of the facets, which the lobe's albedo comes near for small
                             roughness and nowhere exceeds. 0 to 1; with diffuse (and back) at most 1 by band */
    double roughness;     /* glossy: Schlick's alpha, 0 (mirror; taken as 1e-6) to 1 (facets of all directions alike) */
    bool printed;         /* glossy: the printed formula instead of the form that conserves energy */
    double ior[3];        /* glass: of the inside (against the normal) over the outside, > 0 */
    double absorption[3]; /* glass: of the inside, 1/m, >= 0 */
    double outside[3];    /* glass: absorption of what the normal points into, where that is not air */
} pm__material;

/* EINVAL names what is not finite or out of range. */
pm_status pm__material_check(const pm__material *material, pm_error *error);

/* What became of a photon at a surface. */
typedef enum pm__event { PM__ABSORBED, PM__REFLECTED_DIFFUSE, PM__REFLECTED_SPECULAR, PM__TRANSMITTED } pm__event;

/* Chance of reflection, unpolarised light: 1 under total reflection. cosine: of the angle of incidence, >= 0. eta:
 * index of the far side over the near side. *refracted: cosine of the angle of refraction. */
double pm__fresnel(double cosine, double eta, double *refracted);

/* Russian roulette over what the surface can do ([C02] 2.1.2 with errata 20: right for materials whose bands add up to
 * more than 1): the photon goes on as one of them with its power divided by the chance, or ends. `incoming` and
 * `outgoing` are directions of travel, unit; normal: unit, of the surface as it was made. u: three uniform numbers.
 * power changes by band. Glass bends bands differently where ior differs: the photon then goes on in one band alone,
 * chosen by its power. No absorption within is applied here: see pm__beer. */
pm__event pm__scatter(const pm__material *material, const double normal[3], const double incoming[3], const double u[3],
                      double power[3], double outgoing[3]);

/* Beer's law: what is left of the power, by band, after `distance` (m) inside the glass. */
void pm__beer(const pm__material *material, double distance, double power[3]);
/* The same for a medium of this absorption, 1/m by band. */
void pm__attenuate(const double absorption[3], double distance, double power[3]);

/* The absorption, 1/m by band, on the side of a glass boundary that `direction` points into. */
static inline const double *pm__medium_beyond(const pm__material *glass, const double normal[3],
                                              const double direction[3])
{
    return pm__dot(direction, normal) < 0.0 ? glass->absorption : glass->outside;
}
/* And on the side that it comes from. */
static inline const double *pm__medium_before(const pm__material *glass, const double normal[3],
                                              const double direction[3])
{
    return pm__dot(direction, normal) > 0.0 ? glass->absorption : glass->outside;
}

/* BRDF, 1/sr, for directions that point away from the surface, both on the same side of it: that of `normal`, or the
 * other (which has `back` for its albedo where the material is two-sided). 0 for mirror, glass and across the
 * surface. */
void pm__material_brdf(const pm__material *material, const double normal[3], const double in[3], const double out[3],
                       double value[3]);

/* Of a glossy material: its roughness, kept off 0. */
static inline double pm__alpha(const pm__material *material)
{
    return material->roughness > 1e-6 ? material->roughness : 1e-6;
}

/* Is light stored here: can it leave in other directions than the mirrored ones? */
static inline bool pm__is_rough(const pm__material *material)
{
    return material->kind == PM__DIFFUSE || material->kind == PM__GLOSSY;
}

#endif
