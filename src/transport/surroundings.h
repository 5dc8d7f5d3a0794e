/* The surroundings of important photons, as voxels: all that lies within about the reach of a lookup of 50 from one. */
#ifndef PM_TRANSPORT_SURROUNDINGS_H
#define PM_TRANSPORT_SURROUNDINGS_H

#include "../photonmap.h"

#include <stdbool.h>

enum { PM__SURROUNDING_LEVELS = 4 };

typedef struct pm__surroundings {
    float low[3], per_edge;                         /* of the finest voxels; m, 1/m */
    uint32_t *counts;                               /* photons in each, finest level first */
    unsigned char *marked[PM__SURROUNDING_LEVELS]; /* 1: an important one is in it, 2: or next to it */
} pm__surroundings;

/* A box about the important photons; where there are none nothing is near. Photons are then counted, and at the end
 * those that are important mark their surroundings: of voxels so large that they hold enough. ENOMEM. */
pm_status pm__surroundings_create(const float low[3], const float high[3], pm__surroundings *s);
void pm__surroundings_count(pm__surroundings *s, const float position[3]);
void pm__surroundings_gather(pm__surroundings *s);
void pm__surroundings_mark(pm__surroundings *s, const float position[3]);
void pm__surroundings_spread(pm__surroundings *s);
bool pm__surroundings_hold(const pm__surroundings *s, const float position[3]);
void pm__surroundings_free(pm__surroundings *s);

#endif
