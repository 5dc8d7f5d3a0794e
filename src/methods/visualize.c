/* A photon map as it is: at the first rough surface that is seen, directly or through mirrors and glass, the radiance
 * estimate ([C02] 2.3), and no other light. What a renderer's estimates rest on, with nothing to hide their errors. */
#include "maps.h"
#include "plan_steps.h"
#include "stage.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAP, AIM };
enum { EVERYWHERE, OBJECTS };
enum { AUTO, ALL, CAUSTIC, DIRECT, INDIRECT, EXACT };

static const double MOST_SENT = 1000.0; /* for each photon of paths that the scene may not have */

static const pm__param params[] = {
    {"map", PM__CHOICE, AUTO, 0, 0, "", "auto|all|caustic|direct|indirect|exact",
     "the light paths in it: L.*D, LS+D, LD, L.*D.*D, or those of the scene's exact answer; auto: exact where there is "
     "one, else all"},
    {"aim", PM__CHOICE, EVERYWHERE, 0, 0, "", "everywhere|objects",
     "objects: photons are sent only where something is, of a mirror or glass where all paths begin at one; those of "
     "map=caustic always are"}};

static const char *paths_of(const pm__render_job *job)
{
    static const char *const paths[] = {NULL, "L.*D", "LS+D", "LD", "L.*D.*D"};
    const int map = (int)job->config->method->values[MAP];
    return map == EXACT || (map == AUTO && job->subject->truth) ? job->subject->paths : paths[map == AUTO ? ALL : map];
}

/* May lookups and truths be of the scene's exact answer? */
static bool has_exact(const pm__render_job *job)
{
    const int map = (int)job->config->method->values[MAP];
    return job->subject->truth && (map == AUTO || map == EXACT);
}

static bool shows_all(const pm__render_job *job)
{
    return strcmp(paths_of(job), "L.*D") == 0;
}

static pm_status check(const pm__render_job *job, pm_error *error)
{
    if (job->config->method->values[MAP] == EXACT && !job->subject->truth)
        return pm__fail(error, PM_EINVAL, "%s has no exact answer: map=all shows all light",
                        job->subject->entry.name);
    return PM_OK;
}

/* Do all the paths that are shown begin at a mirror or glass? */
static bool begin_specular(const pm__render_job *job)
{
    pm__paths *paths;
    if (pm__paths_create(paths_of(job), &paths, NULL) != PM_OK)
        return false; /* told where they are traced */
    const bool all = !pm__paths_match(paths, "LD") && pm__paths_end(paths, "LD");
    pm__paths_destroy(paths);
    return all;
}

static void plan_projection(const pm__render_job *job, bool specular, pm__plan *plan, pm__needs *needs)
{
    const bool begin = begin_specular(job), objects = job->config->method->values[AIM] == OBJECTS;
    const bool caustic = strcmp(paths_of(job), "LS+D") == 0; /* the exact scenes' lamps are aimed already */
    const bool wanted = begin ? specular && (caustic || objects) : objects;
    needs->projection = wanted && !job->config->no_skip;
    if (needs->projection && !begin)
        (void)pm__projection_create(job->scene, false, &needs->aim, NULL); /* what fails here fails again when traced */
    pm__plan_step(plan, needs->projection, "projection map",
                  wanted && !needs->projection ? "--no-skip: photons are sent everywhere"
                  : wanted && begin            ? "photons are sent where specular surfaces are"
                  : begin && !specular         ? "no specular surface"
                  : objects                    ? "photons are sent where something is"
                                               : "photons are wanted from everywhere");
}

static void plan(const pm__render_job *job, pm__plan *plan, pm__needs *needs)
{
    const size_t specular = pm__count_objects(job->scene, pm__is_specular);
    pm__plan_step(plan, true, "photon map", "the image shows it: %s", paths_of(job));
    pm__plan_step(plan, false, "caustic pass",
                  specular ? "one map holds all the paths that are shown" : "no specular surface");
    plan_projection(job, specular > 0, plan, needs);
    pm__plan_step(plan, false, "shadow rays", "direct light is in the map, or not shown");
    pm__plan_step(plan, false, "final gathering", "not part of visualize");
    pm__plan_maps(job, "one map is shown", plan, needs);
    pm__plan_front(job, plan, needs);
    pm__plan_volume(job, plan);
}

static pm_status prepare(pm__render_job *job, uint32_t trial, void **state, pm_error *error)
{
    pm__maps *const maps = pm__alloc_zero(1, sizeof *maps);
    if (!maps)
        return pm__fail(error, PM_ENOMEM, "out of memory for photon maps");
    const pm__maps_wish wish = {.paths = paths_of(job),
                                .photons = job->config->photons,
                                .aimed = job->needs.projection,
                                .estimates = true,
                                .most = has_exact(job) || shows_all(job) ? 0.0 : MOST_SENT,
                                .trial = trial};
    const pm_status status = pm__maps_create(job, &wish, maps, error);
    if (status != PM_OK) {
        free(maps);
        return status;
    }
    *state = maps;
    return PM_OK;
}

static void release(void *state)
{
    pm__maps *const maps = state;
    pm__maps_destroy(maps);
    free(maps);
}

/* The exact radiance of a sample: of what is lit at the point reached, weighted as the estimate is. */
static void find_truth(const pm__render_job *job, const pm__eye *eye, bool reached, double truth[3])
{
    const pm__stage stage = {.subject = job->subject, .values = job->values};
    double value[3] = {0.0, 0.0, 0.0}, brdf[3];
    if (reached)
        pm__stage_truth(&stage, eye->hit.position, eye->facing, eye->outgoing, pm__is_even(eye, brdf) ? brdf : NULL,
                        value);
    for (int b = 0; b < 3; b++)
        truth[b] = eye->emitted[b] + (reached ? eye->weight[b] * value[b] : 0.0);
}

static pm_status sample(const pm__render_job *job, const void *state, const pm__tile *tile, pm__sample *samples,
                        double (*truth)[3])
{
    const pm__maps *const maps = state;
    pm__eye eyes[PM__TILE_PIXELS];
    bool reached[PM__TILE_PIXELS];
    const size_t count = pm__tile_pixels(tile);
    for (size_t p = 0; p < count; p++) {
        pm__tile_eye(job, tile, p, 0, &eyes[p]);
        reached[p] = pm__eye_follow(&eyes[p]);
        for (size_t i = 0; i < job->images; i++)
            memcpy(samples[i * count + p].radiance, eyes[p].emitted, sizeof eyes[p].emitted);
        if (truth)
            find_truth(job, &eyes[p], reached[p], truth[p]);
    }
    if (!maps)
        return PM_OK;
    pm__maps_scratch scratch;
    pm_status status = pm__maps_scratch_create(job, maps->map, PM__POINTS_AT_ONCE, &scratch);
    if (status == PM_OK)
        status = pm__maps_estimate(maps, eyes, reached, count, &scratch, samples, count);
    pm__maps_scratch_destroy(&scratch);
    return status;
}

const pm__method pm__method_visualize = {
    .entry = {.name = "visualize",
              .summary = "the radiance estimate of a photon map where the eye first meets a rough surface",
              .citation = "Jensen 1996; course 43, 2.3",
              .params = params,
              .param_count = 2},
    .estimates = true,
    .check = check,
    .has_exact = has_exact,
    .shows_all = shows_all,
    .plan = plan,
    .prepare = prepare,
    .sample = sample,
    .release = release,
};
