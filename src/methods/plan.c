#include "maps.h"
#include "plan_steps.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

void pm__plan_step(pm__plan *plan, bool done, const char *name, const char *why, ...)
{
    if (plan->count == PM__MOST_STEPS)
        return;
    pm__step *const step = &plan->steps[plan->count++];
    *step = (pm__step){.name = name, .done = done};
    va_list arguments;
    va_start(arguments, why);
    (void)vsnprintf(step->why, sizeof step->why, why, arguments);
    va_end(arguments);
}

const char *pm__plan_anyway(const pm__render_job *job)
{
    return job->config->no_skip ? ", but --no-skip" : "";
}

/* ---- What is in the scene ---------------------------------------------------------------------- */

size_t pm__count_objects(const pm__scene *scene, bool (*is)(const pm__material *material))
{
    size_t found = 0;
    for (size_t i = 0; i < pm__scene_object_count(scene); i++)
        found += is(pm__scene_object(scene, i).material);
    return found;
}

bool pm__is_specular(const pm__material *material)
{
    return material->kind == PM__MIRROR || material->kind == PM__GLASS;
}

bool pm__is_glossy(const pm__material *material)
{
    return material->kind == PM__GLOSSY;
}

/* The box of where a light's photons start. */
static void light_box(const pm__light *light, double low[3], double high[3])
{
    for (int a = 0; a < 3; a++) {
        const double u = light->edge[0][a], v = light->edge[1][a];
        const bool area = light->kind == PM__RECTANGLE;
        const bool round = light->kind == PM__BALL || light->kind == PM__DIRECTIONAL || light->kind == PM__SUN;
        const double r = round ? light->radius : 0.0;
        low[a] = light->position[a] - r + (area ? fmin(0.0, u) + fmin(0.0, v) : 0.0);
        high[a] = light->position[a] + r + (area ? fmax(0.0, u) + fmax(0.0, v) : 0.0);
    }
}

static void widen(double range[2], double low, double high)
{
    range[0] = fmin(range[0], low);
    range[1] = fmax(range[1], high);
}

/* Does all of its light run one way along the axis? */
static bool is_beam(const pm__light *light, int axis)
{
    return (light->kind == PM__DIRECTIONAL && light->direction[axis] != 0.0) ||
           (light->kind == PM__SUN && fabs(light->direction[axis]) > sin(light->angle));
}

/* A beam that runs away from the plane where coordinate `axis` is `at` starts where its disc is. One that runs toward
 * it meets it from the side that it comes from, and what starts beyond meets nothing. */
static void widen_by_light(double range[2], const pm__light *light, int axis, double at)
{
    double low[3], high[3];
    const double along = light->direction[axis];
    light_box(light, low, high);
    if (is_beam(light, axis)) {
        low[axis] = along < 0.0 ? fmax(low[axis], at) : low[axis];
        high[axis] = along > 0.0 ? fmin(high[axis], at) : high[axis];
        if (!(low[axis] <= high[axis]))
            return; /* it meets nothing */
    }
    widen(range, low[axis], high[axis]);
}

/* Is all of the scene, its lights and who looks (NULL: nobody) included, on one side of the plane where coordinate
 * `axis` is `at`? */
static bool is_one_sided(const pm__scene *scene, const double eye[3], int axis, double at, double slack)
{
    double range[2] = {INFINITY, -INFINITY};
    for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
        const pm__object object = pm__scene_object(scene, i);
        widen(range, object.low[axis], object.high[axis]);
    }
    for (size_t i = 0; i < pm__scene_light_count(scene); i++)
        widen_by_light(range, pm__scene_light_at(scene, i), axis, at);
    if (eye)
        widen(range, eye[axis], eye[axis]);
    return range[0] >= at - slack || range[1] <= at + slack;
}

bool pm__is_single_floor(const pm__scene *scene, const double eye[3])
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
        const pm__object object = pm__scene_object(scene, i);
        for (int a = 0; a < 3 && pm__is_rough(object.material); a++) {
            low[a] = fmin(low[a], object.low[a]);
            high[a] = fmax(high[a], object.high[a]);
        }
    }
    for (int a = 0; a < 3; a++) {
        const double extent = fmax(high[(a + 1) % 3] - low[(a + 1) % 3], high[(a + 2) % 3] - low[(a + 2) % 3]);
        const double slack = 1e-6 * extent;
        if (high[a] - low[a] <= slack && is_one_sided(scene, eye, a, low[a], slack))
            return true;
    }
    return false;
}

/* ---- Steps that several methods have ----------------------------------------------------------- */

void pm__plan_front(const pm__render_job *job, pm__plan *plan, pm__needs *needs)
{
    const bool floor = pm__is_single_floor(job->scene, job->camera.eye);
    const bool glossy = pm__count_objects(job->scene, pm__is_glossy);
    needs->front = job->config->no_skip || !floor;
    needs->directions = job->config->no_skip || needs->front || glossy;
    pm__plan_step(plan, needs->front, "front-side filter", "%s%s",
                  floor ? "one plane holds all rough surfaces, lit and seen from one side alone"
                        : "photons may come from behind a surface, or lie on one nearby",
                  floor ? pm__plan_anyway(job) : "");
    pm__plan_step(plan, needs->directions, "photon directions", "%s%s",
                  !floor   ? "the front-side filter looks at them"
                  : glossy ? "glossy surfaces weigh them"
                           : "nothing looks at them",
                  floor && !glossy ? pm__plan_anyway(job) : "");
}

void pm__plan_maps(const pm__render_job *job, const char *kinds, pm__plan *plan, pm__needs *needs)
{
    const size_t sharing = pm__maps_sharing(job);
    needs->shared = !job->config->no_skip;
    if (sharing > 1)
        pm__plan_step(plan, !needs->shared, "equal maps", "%zu estimators can look into one%s; %s", sharing,
                      pm__plan_anyway(job), kinds);
    else
        pm__plan_step(plan, false, "equal maps", "%s", kinds);
}

void pm__plan_volume(const pm__render_job *job, pm__plan *plan)
{
    (void)job;
    pm__plan_step(plan, false, "volume pass", "no medium that scatters");
}
