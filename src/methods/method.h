/* What a method is: how the radiance of a sample of a pixel is found, from maps of its own or from none. */
#ifndef PM_METHODS_METHOD_H
#define PM_METHODS_METHOD_H

#include "../image/reference.h"
#include "../transport/shoot.h"
#include "../transport/eye.h"
#include "render.h"

/* What the plan says is to be done. */
typedef struct pm__needs {
    bool caustic;    /* full: a caustic map, and its estimates */
    pm__projection *aim; /* where photons that are aimed are sent; the job's. NULL: where specular surfaces are */
    double reach;    /* full: the share of all lights' power that is sent there */
    bool projection; /* photons are aimed: full, those of the caustic map; visualize, all */
    bool global;     /* full: indirect light */
    bool front;      /* lookups must refuse photons from behind */
    bool directions; /* maps must keep the photons' directions */
    bool shared;     /* estimators whose maps would be equal look into one */
    bool behind;     /* shadow rays even to lights that send nothing: --no-skip */
} pm__needs;

typedef struct pm__render_job {
    const pm__render_config *config;
    const pm__case *subject;
    const double *values;
    pm__scene *scene;
    pm__camera camera;
    pm__needs needs;
    size_t images; /* estimators, or 1 */
    bool misfit;   /* there is a reference, and images of this size cannot be compared with it */
    bool truth;    /* the exact truth of each sample is wanted */
    pm__reference reference; /* that judges the image; empty: there is none, or the exact truth does */
    uint64_t emitted;
    size_t stored;
    double trace_s, build_s;
} pm__render_job;

/* Pixels x0 <= x < x1, y0 <= y < y1. */
typedef struct pm__tile {
    size_t x0, y0, x1, y1;
    uint32_t pass, trial;
} pm__tile;

/* One sample of a pixel by one estimator: W/(m2 sr); of the estimate its radius, m, and photons (0: none made). */
typedef struct pm__sample {
    double radiance[3];
    float radius, count;
} pm__sample;

typedef struct pm__method {
    pm__entry entry;
    bool estimates; /* photon maps and estimators */
    /* EINVAL: the method cannot do what is asked of it in this scene. NULL: it can. */
    pm_status (*check)(const pm__render_job *job, pm_error *error);
    /* Does the scene's exact answer cover what is shown? NULL: no. */
    bool (*has_exact)(const pm__render_job *job);
    /* Is all the light of the scene shown, so that a stored reference may judge the image? NULL: yes. */
    bool (*shows_all)(const pm__render_job *job);
    /* Steps of the plan, and what follows from them. */
    void (*plan)(const pm__render_job *job, pm__plan *plan, pm__needs *needs);
    /* The maps of a trial. job: counts and times are added. NULL: none. */
    pm_status (*prepare)(pm__render_job *job, uint32_t trial, void **state, pm_error *error);
    /* samples: [image * pixels + pixel], all 0 before; truth: [pixel], NULL unless job->truth. Called by several
     * threads for different tiles. state NULL (visualize only): no estimate is made, as if no photon were stored. */
    pm_status (*sample)(const pm__render_job *job, const void *state, const pm__tile *tile, pm__sample *samples,
                        double (*truth)[3]);
    void (*release)(void *state);
} pm__method;

/* Estimators of one render. */
enum { PM__MOST_IMAGES = 64 };

/* A tile is at most so many pixels wide and high. */
enum { PM__TILE = 16, PM__TILE_PIXELS = PM__TILE * PM__TILE };

static inline size_t pm__tile_pixels(const pm__tile *tile)
{
    return (tile->x1 - tile->x0) * (tile->y1 - tile->y0);
}

/* An eye path through pixel `index` of the tile, row by row. trial: of the path's numbers; where the sample lies in the
 * pixel depends on the pass alone. */
void pm__tile_eye(const pm__render_job *job, const pm__tile *tile, size_t index, uint32_t trial, pm__eye *eye);

#endif
