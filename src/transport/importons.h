/* Importons: what eye paths leave where the final pass would look into a photon map ([C02] 3.4.1). */
#ifndef PM_TRANSPORT_IMPORTONS_H
#define PM_TRANSPORT_IMPORTONS_H

#include "importance.h"

/* In the order of their paths. importons: position, m, and direction of travel; for power its importance in pixels, and
 * one over its footprint, 1/m2 (0: it has none that is neither 0 nor infinite). normals: of the surface, on the side
 * that it came to. */
typedef struct pm__importons {
    pm_photon *importons;
    float (*normals)[3];
    size_t count;
} pm__importons;

enum { PM__IMPORTON_PIXELS, PM__IMPORTON_DENSITY }; /* within `power` */

/* Importons of all paths, by the map that is looked into. The importance of the first surfaces adds up to that of the
 * pixels which see one. The same for any parallel. The config is not checked. ENOMEM; ECANCELED; EINVAL: more importons
 * than a map holds. On error nothing is to be freed. Cost: for each path a ray, and `bounces` more. */
pm_status pm__importons_trace(const pm__importance_config *config, pm__importons sets[PM__MAP_KINDS], pm_error *error);
void pm__importons_free(pm__importons sets[PM__MAP_KINDS]);

#endif
