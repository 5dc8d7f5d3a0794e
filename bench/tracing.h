/* How fast photons are traced, beside how fast Embree alone answers the rays that this takes: end to end (light, random
 * numbers, surfaces, storing), one thread. */
#ifndef PM_BENCH_TRACING_H
#define PM_BENCH_TRACING_H

#include "../src/base/param.h"
#include "harness.h"

#include <stdbool.h>

/* All rates are of the same rays in one run: ratios are taken within rounds. */
typedef struct pm__tracing_row {
    const char *scene;          /* its entry's name */
    size_t photons, rays;
    double ns_per_ray_traced;   /* end to end */
    double ns_per_ray_scene;    /* the rays alone, answered by the scene: in double, on exact shapes */
    double ns_per_ray_embree;   /* and by Embree alone, in float, at its fastest */
    double ns_per_ray_robust;   /* and so that no ray slips through between triangles, as the scene has them answered */
    double ratio;               /* the rate traced over Embree's at its fastest: 1 would be no cost but Embree's */
    pm__interval ratio_ci95;
    double scene_ratio;         /* the rate of the scene's answers over the same */
    pm__interval scene_ratio_ci95;
    double robust_ratio;        /* the rate of Embree where none slips through over the same */
    pm__interval robust_ratio_ci95;
    double agreement;           /* the share of rays that Embree alone finds to hit or miss as the scene does */
    double aa_ratio;            /* the harness's control */
    pm__interval aa_ci95;
    bool aa_alarm;
    size_t samples;
} pm__tracing_row;

/* Photons 0 to photons - 1 of a traced case's scene, all paths. Embree's own scene has the same meshes, spheres as
 * points, and as triangles rectangles (2), discs (their square: 2), cylinders and waves (128). EINVAL: no such scene,
 * no ray; ENOMEM. Takes about `seconds`. */
pm_status pm__bench_tracing(const pm__spec *scene, size_t photons, double seconds, pm__tracing_row *row,
                            pm_error *error);
/* The same for a committed scene, called `name`. */
struct pm__scene;
pm_status pm__bench_tracing_scene(const char *name, const struct pm__scene *scene, size_t photons, double seconds,
                                  pm__tracing_row *row, pm_error *error);

#endif
