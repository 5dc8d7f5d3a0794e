/* How much each place means to the image: importance, from importons that are traced from the camera exactly as the
 * final pass traces eye paths ([C02] 3.4, 5.7.3).
 *
 * Importance is in pixels to the square metre: photons that are to be so many a pixel, M, are to lie M times as dense
 * ([C02] eq. 3.2, with pixels for A_pix). Caustic and global importance are kept apart: a path's first rough surface
 * looks into the caustic map; what it meets after a rough bounce looks into the global map, and the path ends there. A
 * bounce that comes to its end within `near` looks into no map of global light: there the path stands as at first. */
#ifndef PM_TRANSPORT_IMPORTANCE_H
#define PM_TRANSPORT_IMPORTANCE_H

#include "../photonmap.h"
#include "../scene/camera.h"
#include "../scene/scene.h"

#include <stdbool.h>

typedef enum pm__map_kind { PM__CAUSTIC_MAP, PM__GLOBAL_MAP, PM__MAP_KINDS } pm__map_kind;

/* The light paths whose photons a map holds. */
extern const char *const pm__map_paths[PM__MAP_KINDS]; /* "LS+D", "L.*D" */
extern const char *const pm__map_names[PM__MAP_KINDS]; /* "caustic", "global" */

/* screen: what a photon there means to the whole image, by the density of importons ([C02] eq. 3.3). pixels: to the
 * pixel that sees it, one over the area that moves with it, by path differentials (Suykens 2001; [C02] 3.4.3). both:
 * half and half, pixels scaled so that their averages are alike. */
typedef enum pm__measure { PM__OF_SCREEN, PM__OF_PIXELS, PM__OF_BOTH } pm__measure;

typedef struct pm__importance_config {
    const pm__scene *scene;
    const pm__camera *camera;
    size_t width, height;  /* pixels of the camera's image */
    size_t paths;          /* from the camera, evenly over the image */
    size_t bounces;        /* off each first rough surface: the rays of final gathering, >= 1 */
    double near;           /* m, >= 0 */
    pm__measure measure;
    size_t nearest;        /* importons that an estimate is made of: 200 */
    double share;          /* of importons that carry one: 1, or 0.25 */
    double outlier;        /* importons whose footprint is so many times smaller than their geometric mean have it cut
                            * to that: 100 */
    uint64_t seed;
    const pm_parallel *parallel;     /* NULL: this thread */
    bool (*canceled)(void *context); /* NULL: never. Asked by several threads */
    void *context;
} pm__importance_config;

typedef struct pm__importance pm__importance;

/* The same for any parallel. No importon may reach anything: then importance is 0 everywhere. ENOMEM; ECANCELED;
 * EINVAL: what is out of range. Cost: tracing, and a lookup of `nearest` for each importon that carries an estimate. */
pm_status pm__importance_create(const pm__importance_config *config, pm__importance **importance, pm_error *error);
void pm__importance_destroy(pm__importance *importance); /* NULL is allowed */

size_t pm__importance_count(const pm__importance *importance, pm__map_kind kind); /* importons stored */

/* Over the importons that carry an estimate: 1/m2; 0 where there are none. */
double pm__importance_mean(const pm__importance *importance, pm__map_kind kind);

/* Where importance is at least this much, 1/m2, a place is important: a tenth of the mean over importons. */
double pm__importance_threshold(const pm__importance *importance, pm__map_kind kind);

/* Importance at points on surfaces, 1/m2, finite and >= 0: what the nearest importon says which came to the side of
 * normals[i] and carries an estimate, for all points of a cell alike (cells.h: as large as importons lie apart, and 8
 * times that where there are none) as for its middle. Where all of the cell is farther off than the importons are that
 * the estimate was made of, it falls with the square of the distance; beyond 16 times as far, or 8 times what is usual,
 * it is 0. For many points at once, from any thread;
 * positions in m, normals unit. */
void pm__importance_at(const pm__importance *importance, pm__map_kind kind, const float (*positions)[3],
                       const float (*normals)[3], size_t count, float *values);
/* The same where photons came to surfaces. parallel: NULL: this thread. */
void pm__importance_of_photons(const pm__importance *importance, pm__map_kind kind, const pm_parallel *parallel,
                               const pm_photon *photons, const float (*normals)[3], size_t count, float *values);

#endif
