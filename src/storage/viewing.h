/* An image of a scene as far as photon maps make it: the final pass with its eye paths held fixed, so that what differs
 * from map to map is the map.
 *
 * Eye paths go through mirrors and glass to the first rough surface, which looks into the caustic map; from there
 * `gather` rays go on to points that look into the global map. One that comes to its end within `near` looks into the
 * caustic map instead, and goes on: as importance.h has it. Direct light by shadow rays, lights by eye paths.
 *
 * Paths are dealt into PM__GROUPS groups, which are independent, and of which each has large maps of its own. The image
 * of a group with a map in question, of infinitely many paths the same but for noise of mean 0, is
 *
 *     fixed: direct and seen light, and both large maps', of `deep` paths a pixel, less the large map's of `samples`
 *     + the light of the map in question at the points of `samples` of those paths
 *
 * where the last two err alike. Products of two groups' errors have the mean of the error squared that an image of
 * infinitely many paths has: the variance of eye paths and of the large maps is not in it (what the large maps blur
 * is). */
#ifndef PM_STORAGE_VIEWING_H
#define PM_STORAGE_VIEWING_H

#include "../image/reference.h"
#include "../transport/importance.h"

enum { PM__GROUPS = 4 };

typedef struct pm__viewing_config {
    const pm__scene *scene;
    const pm__camera *camera;
    const pm__image *reference; /* W/(m2 sr), R G B; black nowhere but in parts */
    size_t width, height;       /* pixels: a whole multiple of the reference's, across as down */
    size_t samples, deep;       /* eye paths of a pixel and group; 1 <= samples <= deep */
    size_t gather;              /* rays, >= 1 */
    double near;                /* m */
    size_t k;                   /* photons in a lookup, >= 2 ... */
    double radius;              /* ... within so many m */
    size_t photons;             /* stored in each of the large maps */
    uint64_t seed;
    const pm_parallel *parallel;
    void (*progress)(void *context, double fraction); /* of the making; may be NULL */
    bool (*canceled)(void *context);                  /* NULL: never. Asked by several threads */
    void *context;
} pm__viewing_config;

typedef struct pm__viewing pm__viewing;

/* The same for any parallel. ENOMEM; ECANCELED. Cost: the large maps of every group, and deep paths a pixel and group
 * with their lookups. */
pm_status pm__viewing_create(const pm__viewing_config *config, pm__viewing **viewing, pm_error *error);
void pm__viewing_destroy(pm__viewing *viewing); /* NULL is allowed */

/* What it will hold, bytes, at the most. */
double pm__viewing_bytes(const pm__viewing_config *config);

/* Does any photon come to such a map? */
bool pm__viewing_has(const pm__viewing *viewing, pm__map_kind kind);

/* A large map of light of all paths; valid as long as the viewing. */
const pm_map *pm__viewing_global(const pm__viewing *viewing);

/* Points looked up in such a map in each trial. */
size_t pm__viewing_points(const pm__viewing *viewing, pm__map_kind kind);

/* Values of one group's image: 3 a pixel of the reference. */
size_t pm__viewing_values(const pm__viewing *viewing);

/* The image's relative error with large maps alone, as below; valid as long as the viewing. */
const float *pm__viewing_base(const pm__viewing *viewing);

/* The image's relative error with this map in place of the large one: (radiance - reference) / mean of the reference,
 * errors[group * values + value]. The same for any parallel. ENOMEM; ECANCELED. */
pm_status pm__viewing_errors(const pm__viewing *viewing, pm__map_kind kind, const pm_map *map, float *errors);

#endif
