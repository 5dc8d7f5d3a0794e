/* What photons do at rough surfaces, one by one or many at once. */
#ifndef PM_SCENE_ROUGH_H
#define PM_SCENE_ROUGH_H

#include "../base/turn.h"
#include "../base/vec3.h"

static inline double pm__largest(const double v[3])
{
    const double larger = v[0] > v[1] ? v[0] : v[1];
    return v[2] > larger ? v[2] : larger;
}

static inline void pm__cosine_direction(const double normal[3], double u0, double u1, double outgoing[3])
{
    double s[3], t[3], sine, cosine;
    pm__basis(normal, s, t);
    pm__turn(u0, &sine, &cosine);
    const double r = sqrt(u1), x = r * cosine, y = r * sine, z = sqrt(1.0 - u1);
    for (int i = 0; i < 3; i++)
        outgoing[i] = x * s[i] + y * t[i] + z * normal[i];
}

typedef struct pm__chances {
    double diffuse, specular; /* the rest: absorption */
} pm__chances;

/* Erratum 20: the course's P_d + P_s may pass 1. Their sum must be the largest band of what goes on over the largest
 * that came, shared out by the power that goes each way. */
static inline pm__chances pm__roulette(const double diffuse[3], const double specular[3], const double power[3])
{
    double on[3], by_diffuse = 0.0, by_both = 0.0;
    for (int b = 0; b < 3; b++) {
        on[b] = (diffuse[b] + specular[b]) * power[b];
        by_diffuse += diffuse[b] * power[b];
        by_both += on[b];
    }
    const double share = pm__largest(on) / pm__largest(power), total = share < 1.0 ? share : 1.0;
    const double p = total * by_diffuse / by_both;
    return by_both > 0.0 ? (pm__chances){p, total - p} : (pm__chances){0.0, 0.0};
}

/* G over v: finite at grazing. */
static inline double pm__masking_over_cosine(double cosine, double alpha)
{
    return 2.0 / (cosine + sqrt(alpha + (1.0 - alpha) * cosine * cosine));
}

/* A facet as seen from `from` (away from the surface), by the density of visible facets. In the frame where facets of
 * width sqrt(alpha) become those of a hemisphere, their mirrored directions are uniform over a spherical cap (Dupuy and
 * Benyoub 2023, "Sampling visible GGX normals with spherical caps"). */
static inline void pm__sample_facet(const double normal[3], const double from[3], double alpha, double u0,
                                    double u1, double facet[3])
{
    double s[3], t[3];
    pm__basis(normal, s, t);
    const double width = sqrt(alpha);
    double view[3] = {width * pm__dot(s, from), width * pm__dot(t, from), pm__dot(normal, from)};
    pm__normalize_known(view); /* at least sqrt(alpha) long */
    const double z = (1.0 - u1) * (1.0 + view[2]) - view[2];
    double sine, cosine;
    pm__turn(u0, &sine, &cosine);
    const double r = sqrt(1.0 - z * z > 0.0 ? 1.0 - z * z : 0.0);
    const double x = width * (r * cosine + view[0]), y = width * (r * sine + view[1]), h = z + view[2];
    for (int i = 0; i < 3; i++)
        facet[i] = x * s[i] + y * t[i] + h * normal[i];
    pm__normalize_known(facet); /* at least 1 - u1 */
}

#endif
