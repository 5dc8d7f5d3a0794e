/* What all runs of a configuration have in common: the scene, the points through the pixels' middles, and how far the
 * first lookups reach. */
#include "cover.h"
#include "curvature.h"

#include "../../base/memory.h"
#include "../../base/parallel.h"
#include "../plan_steps.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* A pass of its own for the first radii: those of the first pass's own photons would be small where they lie close by
 * chance, and its estimates bright (errata, section 7). */
#define PILOT UINT32_MAX

enum { POINTS = 256, WAYS = 64 }; /* of a task; tried through a pixel's middle */

static const pm__progressive *method_of(const pm__progressive_config *config)
{
    return (const pm__progressive *)(const void *)config->method->entry;
}

static pm_status check_estimates(const pm__progressive_config *config, pm_error *error)
{
    const pm__progressive *const method = method_of(config);
    char name[PM__MAX_SPEC];
    if (!config->estimates || (method->averages && method->averages(config->method->values)))
        return PM_OK;
    pm__spec_format_short(config->method, name, sizeof name);
    return pm__fail(error, PM_EINVAL, "%.60s cannot estimate its own error: that takes a mean of passes in which noise "
                                      "and blur are all that is wrong", name);
}

static pm_status check(const pm__progressive_config *config, pm_error *error)
{
    const pm__progressive *const method = method_of(config);
    const pm__estimator *const kernel = pm__estimator_of(&config->estimator->spec);
    const char *const name = kernel->entry.name;
    if (!config->width || !config->height)
        return pm__fail(error, PM_EINVAL, "an image of %zu x %zu pixels has no points", config->width, config->height);
    if (!method->uses_photons)
        return PM_OK;
    if (!config->photons)
        return pm__fail(error, PM_EINVAL, "no photons in a pass");
    if (method->no_lookups)
        return PM_OK;
    if (kernel->needs & (PM__MAPS | PM__TRUTH | PM__AT_PHOTON) || !(kernel->dimensions & 1U << 2))
        return pm__fail(error, PM_EINVAL, "%s cannot be the kernel of passes: it needs more than one lookup", name);
    if (method->shrinks && !kernel->weight)
        return pm__fail(error, PM_EINVAL, "%s is no kernel of a given radius, as %s needs one", name,
                        method->entry.name);
    if (method->shrinks && !(config->alpha > 0.0 && config->alpha < 1.0))
        return pm__fail(error, PM_EINVAL, "alpha is %g, not above 0 and below 1", config->alpha);
    if (!config->k && (!method->shrinks || !(config->radius > 0.0)))
        return pm__fail(error, PM_EINVAL, "neither k nor a first radius bounds a lookup");
    return PM_OK;
}

/* ---- Points ------------------------------------------------------------------------------------ */

void pm__run_eye(const pm__progression *progression, uint64_t seed, uint32_t pass, size_t point, bool middle,
                 pm__eye *eye)
{
    const size_t width = progression->config->width;
    const pm__eye_numbers numbers = pm__eye_numbers_of(seed, 0, pass, point);
    double at[2] = {0.5, 0.5};
    if (!middle)
        pm__place_in_pixel(seed, point, pass, at);
    pm__eye_through(eye, progression->stage.scene, &progression->stage.camera, &numbers,
                    (double)(point % width) + at[0], (double)(point / width) + at[1]);
}

void pm__hit_point_follow(pm__eye *eye, pm__hit_point *point)
{
    const bool reached = pm__eye_follow(eye);
    pm__hit_point_of(eye, reached, point);
}

void pm__hit_point_of(const pm__eye *eye, bool reached, pm__hit_point *point)
{
    *point = (pm__hit_point){.material = reached ? eye->hit.material : NULL};
    for (int a = 0; a < 3; a++) {
        point->emitted[a] = eye->emitted[a];
        point->weight[a] = eye->weight[a];
        if (reached) {
            point->position[a] = eye->hit.position[a];
            point->normal[a] = eye->facing[a];
            point->outgoing[a] = eye->outgoing[a];
        }
    }
    point->back = reached && pm__dot(eye->facing, eye->hit.normal) < 0.0;
}

/* Where points are drawn anew this one but settles the first radius, so that any that a way through mirrors and glass
 * leads to will do. */
static void find_points(void *argument, size_t block)
{
    pm__progression *const p = argument;
    const uint32_t ways = method_of(p->config)->redraws ? WAYS : 1;
    for (size_t i = block * POINTS; i < (block + 1) * POINTS && i < p->points; i++)
        for (uint32_t way = 0; way < ways && !p->fixed[i].material; way++) {
            pm__eye eye;
            pm__run_eye(p, p->config->seed, way, i, true, &eye);
            pm__hit_point_follow(&eye, &p->fixed[i]);
        }
}

/* ---- First radii ------------------------------------------------------------------------------- */

typedef struct piloting {
    pm__progression *of;
    const pm_map *map;
    _Atomic int failure;
} piloting;

static void find_radii(void *argument, size_t block)
{
    piloting *const work = argument;
    pm__progression *const p = work->of;
    const size_t k = p->config->k;
    pm_neighbor *const found = pm__alloc(k, sizeof *found);
    if (!found)
        atomic_store(&work->failure, PM_ENOMEM);
    for (size_t i = block * POINTS; found && i < (block + 1) * POINTS && i < p->points; i++) {
        const pm__hit_point *const point = &p->fixed[i];
        size_t count = 0;
        pm_query query;
        pm__point_query(p, point, k, INFINITY, &query);
        query.sorted = true;
        p->radius[i] = 0.0f;
        if (!point->material || pm_map_search(work->map, &query, found, k, &count) != PM_OK || count == 0)
            continue;
        p->radius[i] = (float)(sqrt((double)found[count - 1].distance2) * pm_map_unit(work->map));
    }
    free(found);
}

static pm_status pilot(pm__progression *p, pm_error *error)
{
    const pm__progressive_config *const config = p->config;
    pm__run run = {.of = p, .seed = config->seed};
    pm__photon_set set = {0};
    pm_map *map = NULL;
    pm_status status = pm__run_shoot(&run, PILOT, &set, error);
    if (status == PM_OK)
        status = pm__run_map(&run, &set, &map, error);
    pm__photon_set_free(&set);
    piloting work = {.of = p, .map = map};
    if (status == PM_OK)
        pm__for(config->parallel, (p->points + POINTS - 1) / POINTS, find_radii, &work);
    pm_map_destroy(map);
    if (status == PM_OK && atomic_load(&work.failure))
        status = pm__fail(error, (pm_status)atomic_load(&work.failure), "out of memory for the first radii");
    return status;
}

static pm_status set_radii(pm__progression *p, pm_error *error)
{
    const pm__progressive_config *const config = p->config;
    if (!method_of(config)->uses_photons || method_of(config)->no_lookups)
        return PM_OK;
    for (size_t i = 0; i < p->points; i++)
        p->radius[i] = (float)config->radius;
    return method_of(config)->shrinks && !(config->radius > 0.0) ? pilot(p, error) : PM_OK;
}

/* ---- Opening ----------------------------------------------------------------------------------- */

static void look_at_scene(pm__progression *p)
{
    const pm__case *const subject = p->stage.subject;
    p->expression = subject->truth ? subject->paths : "L.*D";
    p->front = p->config->front_only && !pm__is_single_floor(p->stage.scene, p->stage.camera.eye);
    p->directions = p->front || pm__count_objects(p->stage.scene, pm__is_glossy);
}

pm_status pm__progression_open(const pm__progressive_config *config, pm__progression *progression, pm_error *error)
{
    *progression = (pm__progression){.config = config, .points = config->width * config->height};
    pm__progression *const p = progression;
    pm_status status = check(config, error);
    if (status == PM_OK)
        status = check_estimates(config, error);
    if (status == PM_OK)
        status = pm__stage_open(config->scene, config->view, config->width, config->height, &p->stage, error);
    if (status != PM_OK)
        return status;
    look_at_scene(p);
    if (config->estimates && method_of(config)->shrinks)
        p->moment = pm__blur_of(config->estimator).moment;
    p->fixed = pm__alloc_zero(p->points, sizeof *p->fixed);
    p->radius = pm__alloc_zero(p->points, sizeof *p->radius);
    if (!p->fixed || !p->radius)
        status = pm__fail(error, PM_ENOMEM, "out of memory for %zu points", p->points);
    if (status == PM_OK)
        status = pm__paths_create(p->expression, &p->paths, error);
    if (status == PM_OK) {
        pm__for(config->parallel, (p->points + POINTS - 1) / POINTS, find_points, p);
        status = set_radii(p, error);
    }
    if (status == PM_OK)
        status = pm__choose_meeting(p, error);
    if (status != PM_OK)
        pm__progression_close(p);
    return status;
}

void pm__progression_close(pm__progression *progression)
{
    pm__paths_destroy(progression->paths);
    free(progression->fixed);
    free(progression->radius);
    pm__stage_close(&progression->stage);
    *progression = (pm__progression){.config = progression->config};
}
