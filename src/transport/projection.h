/* Projection maps ([C02] 2.2; errata 35): which of a light's photons can meet an object at all. Cells are cells of the
 * numbers that a photon is emitted by, so all carry the same flux; a cell is on if a photon in it may meet the box of
 * an object (conservative: what is off meets none). */
#ifndef PM_TRANSPORT_PROJECTION_H
#define PM_TRANSPORT_PROJECTION_H

#include "../scene/scene.h"

typedef struct pm__projection pm__projection;

/* specular: of mirrors and glass alone; else of all surfaces. ENOMEM. Cost: cells x objects, for each light. */
pm_status pm__projection_create(const pm__scene *scene, bool specular, pm__projection **projection, pm_error *error);
void pm__projection_destroy(pm__projection *projection); /* NULL is allowed */

/* The share of a light's power in cells that are on: 0 where it reaches no such object. */
double pm__projection_share(const pm__projection *projection, size_t light);

/* Are photons sent by these numbers? false: none by them meets the box of such an object. */
bool pm__projection_covers(const pm__projection *projection, size_t light, const double u[4]);

/* Moves u[0..3], uniform over the unit cube, to the cells that are on, uniformly. Only where the share is above 0. */
void pm__projection_aim(const pm__projection *projection, size_t light, double u[4]);

#endif
