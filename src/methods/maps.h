/* Photon maps of one kind of light paths, and every estimator's radiance from them where eye paths end. */
#ifndef PM_METHODS_MAPS_H
#define PM_METHODS_MAPS_H

#include "../lookup/lookup.h"
#include "method.h"

/* What one estimator has beside the map that all share. */
typedef struct pm__own_maps {
    pm_map **dealt; /* of estimators that combine maps, and of those that do not share; else NULL */
    size_t count;
    pm_precomputed *precomputed;
} pm__own_maps;

typedef struct pm__maps {
    const pm__render_job *job;
    pm_map *map;
    pm__own_maps *own;   /* [job->images] */
    float (*normals)[3]; /* of the photons, in the order in which they were stored; NULL unless asked for */
    bool shared;  /* estimates may be made on the map itself: all but those of several maps */
    bool offsets; /* one of them needs these */
} pm__maps;

typedef struct pm__maps_wish {
    const char *paths;
    size_t photons;
    bool emitted;   /* so many are emitted, however few are stored; else stored */
    bool aimed;     /* photons are sent where the job's `aim` is, or specular surfaces are */
    double most;    /* emitted for each that is to be stored, at most: perhaps there is none; 0: no limit */
    bool normals;
    bool estimates; /* each estimator gets what it needs beside the map */
    uint32_t trial;
    uint32_t stream; /* 0 or 1: two kinds of maps of one trial are independent */
} pm__maps_wish;

/* How many of the job's estimators look into one map of photons, where each could have one and all were equal. */
size_t pm__maps_sharing(const pm__render_job *job);

/* Traces and builds; adds to job's counts and times. EINVAL: next to no such photon is stored; ENOMEM; ECANCELED. Where
 * nothing is to be aimed at, `aimed` gives an empty map. On error all is released. */
pm_status pm__maps_create(pm__render_job *job, const pm__maps_wish *wish, pm__maps *maps, pm_error *error);
void pm__maps_destroy(pm__maps *maps); /* an empty one is allowed */

/* Points that are looked up at once: few enough that what is found for them is still near when it is read. */
enum { PM__POINTS_AT_ONCE = 32 };

/* Working memory for one thread: for so many points at once, looked up in `map` (NULL: in none). ENOMEM. */
typedef struct pm__maps_scratch {
    size_t points, stride; /* stride: neighbours of a point */
    pm_workspace *workspace;
    pm_query *queries;
    pm_neighbor *neighbors;
    size_t *counts, *which;
} pm__maps_scratch;
pm_status pm__maps_scratch_create(const pm__render_job *job, const pm_map *map, size_t points,
                                  pm__maps_scratch *scratch);
void pm__maps_scratch_destroy(pm__maps_scratch *scratch);

/* The query at a point on a surface, as the command line asks for it. */
pm_query pm__maps_query(const pm__render_job *job, const double position[3], const double normal[3]);

/* For each point reached (eyes[i], where reached[i]), each estimator's reflected radiance from the map, weighted, is
 * added to samples[image * stride + i], which keeps the estimate's radius and photons. */
pm_status pm__maps_estimate(const pm__maps *maps, const pm__eye *eyes, const bool *reached, size_t count,
                            pm__maps_scratch *scratch, pm__sample *samples, size_t stride);

/* BRDF, 1/sr, of a surface that scatters alike in all directions; false: it does not. */
bool pm__is_even(const pm__eye *eye, double value[3]);

#endif
