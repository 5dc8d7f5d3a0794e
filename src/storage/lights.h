/* Direct light where there are many lights, most of which do not matter: those that lit what a few paths from the
 * camera found are asked everywhere, the others by turns, one of them at each place, for all. What is found has the
 * right mean either way. */
#ifndef PM_STORAGE_LIGHTS_H
#define PM_STORAGE_LIGHTS_H

#include "../transport/eye.h"

typedef struct pm__lights {
    const pm__light **list; /* the first `always` of them are asked everywhere */
    size_t always, count;
} pm__lights;

/* width, height: of the camera's image. ENOMEM. Cost: some thousand paths, and a shadow ray to each light. */
pm_status pm__lights_choose(const pm__scene *scene, const pm__camera *camera, size_t width, size_t height,
                            uint64_t seed, pm__lights *lights);
void pm__lights_free(pm__lights *lights); /* all 0 is allowed */

/* Adds to radiance what the point reached sends back of all lights, weighted. */
void pm__lights_add(const pm__lights *lights, pm__eye *eye, double radiance[3]);

/* What is seen of lamps through the point (x, y) of the image, W/(m2 sr): straight and by every way through mirrors and
 * glass that carries a ten-thousandth of the light, without chance. */
void pm__lamps_seen(const pm__scene *scene, const pm__camera *camera, double x, double y, double seen[3]);

/* Is that not the same all over the pixel, as far as an 8 x 8 grid shows? */
bool pm__lamps_edge(const pm__scene *scene, const pm__camera *camera, size_t x, size_t y);

#endif
