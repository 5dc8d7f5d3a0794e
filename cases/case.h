/* What a case is: photons of a known irradiance, its exact truth, and what theory says of estimates of it.
 *
 * Lengths in m, irradiance in W/m2 (media: flux density in W/m3), all three bands alike. Photons are drawn
 * from the irradiance itself, so only the estimator is under test; or, with `build`, traced through a scene. All
 * functions are pure. */
#ifndef PM_CASES_CASE_H
#define PM_CASES_CASE_H

#include "../src/base/param.h"
#include "../src/base/vec3.h"
#include "../src/scene/camera.h"
#include "../src/scene/scene.h"

/* A point where an estimate is asked for. */
typedef struct pm__probe {
    double position[3];
    double normal[3]; /* unit; the side that is asked for */
    double outgoing[3]; /* cases of radiance (brdf): unit, toward who looks */
} pm__probe;

/* How a lookup is shaped: as pm_query says it. */
typedef struct pm__shape {
    pm_lookup_shape shape;
    double parameter;
    bool front_only;
} pm__shape;

typedef struct pm__region {
    const char *name;    /* "all" is the first of every case: uniform over the probed surface or volume */
    const char *summary;
    bool uniform;        /* E is constant over a convex domain around it: theorems of T1 hold here ... */
    bool interior;       /* ... and no domain edge or change of E is within reach of a lookup of 0.15 m */
} pm__region;

typedef struct pm__case {
    pm__entry entry;
    const char *paths;       /* the light-path expression that the truth covers: "LD", in a medium "LV" */
    int dimensions;          /* 2: photons on surfaces; 3: in a volume */
    int sample_dimensions;   /* how many numbers a photon takes, 2 to 4 */
    int strata_dimensions;   /* the first so many are stratified by the sampler `stratified`: 2 or 3 */
    const pm__region *regions;
    size_t region_count;

    /* Aspect ratios of the domain behind u[0]:u[1] and u[0]:u[2], for near-square strata. */
    void (*aspect)(const double *values, double aspect[2]);

    /* The power of all photons together, W: each of N photons carries 1/N of it. */
    double (*power)(const double *values);

    /* The photon of the sample u: density proportional to irradiance. direction: of travel, unit. normal: of the
     * surface that it lies on, unit (media: any). */
    void (*photon)(const double *values, const double *u, double position[3], double direction[3], double normal[3]);

    /* A point uniform by area (volume) in a region, from u[0..2]. */
    void (*probe)(const double *values, size_t region, const double *u, pm__probe *probe);

    /* Exact irradiance on the probe's side (with `brdf` radiance, W/(m2 sr)). Of scenes: at any point of any rough
     * surface, NAN where it is not known. NULL: a scene without an exact answer, to be rendered only; then it has no
     * paths, regions, power, probe and mass. */
    double (*truth)(const double *values, const pm__probe *probe);

    /* Theory. mass: the power, W, of the photons expected at distances in (r0, r1] (in the lookup's metric) from the
     * probe that the lookup accepts; NAN where no formula is known for this shape. NULL: no theory at all. Where E
     * is smooth over a rectangle of the plane z = 0, pm__mass_rectangle of planar.h serves. */
    double (*mass)(const double *values, const pm__probe *probe, const pm__shape *shape, double r0, double r1);

    /* A lookup radius, m, beyond which a lookup is cut in this case even if the user gives none (because some
     * probes accept no photon at all); 0: none. */
    double (*reach)(const double *values);

    /* Cases of traced scenes: adds materials, shapes and lights to a scene that the caller has created and will commit.
     * Such a case has no `photon`: its photons are those that pm__trace stores along `paths`, and `power` is what they
     * carry together, or NAN where no formula is known. NULL: photons are drawn from the irradiance. */
    pm_status (*build)(const double *values, pm__scene *scene, pm_error *error);

    /* Scenes: where they are looked at from. */
    void (*view)(const double *values, pm__view *view);
    /* Exact irradiance where bands differ (truth is then that of red); NULL: all bands as truth. */
    void (*truth_bands)(const double *values, const pm__probe *probe, double truth[3]);
    /* Cases of radiance: 1/sr, for light that travels along `incoming` and leaves along `outgoing`; NULL: irradiance is
     * asked for. */
    void (*brdf)(const double *values, const double incoming[3], const double outgoing[3], double value[3]);
    /* Theory of cases of radiance: the direction in which all light travels that comes to a probe, unit. NULL: it comes
     * from several, and there are no predictions. */
    void (*incoming)(const double *values, const pm__probe *probe, double direction[3]);
} pm__case;

static inline bool pm__is_traced(const pm__case *subject)
{
    return subject->build;
}

extern const pm__catalogue pm__cases;     /* photons drawn from a known irradiance */
extern const pm__catalogue pm__all_cases; /* and those of traced scenes */

#endif
