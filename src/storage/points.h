/* Points on surfaces that look into a photon map, and what they see there. For the sources of this folder. */
#ifndef PM_STORAGE_POINTS_H
#define PM_STORAGE_POINTS_H

#include "../photonmap.h"
#include "../transport/eye.h"

/* Of surfaces that scatter unevenly. */
typedef struct pm__point_gloss {
    const pm__material *material;
    double normal[3], outgoing[3]; /* unit: of the surface as it was made; to who looks */
} pm__point_gloss;

typedef struct pm__point {
    float position[3], normal[3]; /* m; unit, on the side that is seen */
    float weight[3];              /* of irradiance (with gloss: radiance) in what its cell adds up to */
    uint32_t cell;
    uint32_t gloss;               /* number; UINT32_MAX: none, it scatters alike in all directions */
} pm__point;

typedef struct pm__points_list {
    pm__point *items;
    pm__point_gloss *gloss;
    size_t count, capacity, gloss_count, gloss_capacity;
} pm__points_list;

/* Where the eye stands, its light to be weighted by `share`. ENOMEM. */
pm_status pm__points_add(pm__points_list *list, const pm__eye *eye, uint32_t cell, double share);
void pm__points_clear(pm__points_list *list); /* its memory stays */
void pm__points_free(pm__points_list *list);

/* How photons are looked up: the k nearest that come from the front, within a radius (m), by the disc estimate without
 * the last photon, whose mean is right where light is even (errata 1). */
typedef struct pm__looking {
    size_t k;
    double radius;
} pm__looking;

/* Adds each point's weighted light, W/(m2 sr), to sums[3 * cell]. On this thread. ENOMEM. */
pm_status pm__points_look(const pm__points_list *list, const pm_map *map, const pm__looking *looking, double *sums);

/* A front-side query of k photons. */
pm_query pm__points_query(const float position[3], const float normal[3], const pm__looking *looking);

#endif
