/* Light tracing (Dutre, Lafortune and Willems 1993): each photon is joined to the camera and counts for the pixel in
 * which its surface point is seen. No lookup, so no kernel and no blur: without a bias where it finds the light at all.
 *
 * Derivation. A pixel's value is the mean of the radiance L over its area in the image, 1 pixel^2,
 *     I = integral over the pixel of L(x, y) dx dy.
 * Let the image have q(w) pixels to the steradian about the direction w (pm__camera_project): dx dy = q dw. The surface
 * dA at p that is seen there, d m off under the angle a to its normal, fills dw = |cos a| dA / d^2. So
 *     I = integral over the surfaces seen in the pixel of L(p, to the eye) q |cos a| / d^2 dA,
 *     L(p, to the eye) = integral of f(p, in, to the eye) dE(in), f the BRDF.
 * Stored photons are samples of power, dE dA: the sum over those of power Phi that lie on surfaces seen in the pixel
 *     sum of Phi f q |cos a| / d^2
 * has the mean I. The cosine of `in` does not show: it is in dE, so in the power that arrives.
 *
 * What mirrors or glass hide from the straight way to the eye is not found, however many photons: surfaces seen through
 * glass and in mirrors stay black. Lights themselves are seen as by the other methods, by a path from the eye. */
#include "means.h"
#include "progressive.h"

#include "../../base/clock.h"
#include "../../base/memory.h"
#include "../../base/parallel.h"

#include <float.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 256, PHOTONS = 1024, BLOCKS = 64 }; /* of one task; tasks at once */

/* What a photon adds, and to which point. */
typedef struct splat {
    size_t point;
    double radiance[3];
} splat;

#define NOWHERE SIZE_MAX

typedef struct joining {
    pm__run *run;
    const pm__photon_set *set;
    size_t first;  /* photon of this round */
    splat *splats; /* [PHOTONS * BLOCKS]: of its photons */
    _Atomic bool canceled;
} joining;

/* Is this the place of the photon, which was rounded to floats? Its height over the surface met says so: what the
 * rounding does along the ray grows without bound as the ray gets flat. */
static bool is_place(const pm__hit *hit, const double eye[3], const double place[3])
{
    double height = 0.0, size = hit->distance;
    for (int i = 0; i < 3; i++) {
        height += hit->normal[i] * (place[i] - hit->position[i]);
        size = fmax(size, fmax(fabs(eye[i]), fabs(place[i])));
    }
    return fabs(height) <= 8.0 * (double)FLT_EPSILON * size;
}

/* The point in whose pixel the photon would be seen. */
static bool find_point(const pm__progression *p, const double place[3], size_t *point, double *density)
{
    double at[2];
    if (!pm__camera_project(&p->stage.camera, place, at, density))
        return false;
    if (!(at[0] >= 0.0 && at[0] < (double)p->config->width && at[1] >= 0.0 && at[1] < (double)p->config->height))
        return false;
    *point = (size_t)at[1] * p->config->width + (size_t)at[0];
    return true;
}

static void join(const pm__progression *p, const pm_photon *photon, splat *made)
{
    const double *const eye = p->stage.camera.eye;
    double place[3], way[3], in[3], out[3], brdf[3], density;
    pm__hit hit;
    made->point = NOWHERE;
    for (int i = 0; i < 3; i++) {
        place[i] = (double)photon->position[i];
        way[i] = place[i] - eye[i];
        in[i] = -(double)photon->direction[i];
    }
    size_t point;
    if (!find_point(p, place, &point, &density))
        return;
    const double distance = pm__normalize(way);
    if (!pm__scene_intersect(p->stage.scene, eye, way, INFINITY, PM__NO_SHAPE, &hit) || !pm__is_rough(hit.material) ||
        !is_place(&hit, eye, place))
        return;
    for (int i = 0; i < 3; i++)
        out[i] = -way[i];
    pm__material_brdf(hit.material, hit.normal, in, out, brdf);
    const double share = density * fabs(pm__dot(hit.normal, way)) / (distance * distance);
    made->point = point;
    for (int b = 0; b < 3; b++)
        made->radiance[b] = (double)photon->power[b] * brdf[b] * share;
}

static bool is_canceled(joining *work)
{
    const pm__progressive_config *const config = work->run->of->config;
    if (config->canceled && config->canceled(config->context))
        atomic_store(&work->canceled, true);
    return atomic_load(&work->canceled);
}

static void join_block(void *argument, size_t block)
{
    joining *const work = argument;
    const size_t from = block * PHOTONS;
    if (is_canceled(work))
        return;
    for (size_t i = from; i < from + PHOTONS && work->first + i < work->set->count; i++)
        join(work->run->of, &work->set->photons[work->first + i], &work->splats[i]);
}

/* In the order of the photons, so that sums do not depend on threads. */
static void add_round(const joining *work, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const splat *const s = &work->splats[i];
        if (s->point == NOWHERE)
            continue;
        double *const state = work->run->state + s->point * PM__MEAN_FIELDS;
        for (int b = 0; b < 3; b++)
            state[PM__SUM + b] += s->radiance[b];
        state[PM__FOUND] += 1.0;
    }
}

static void join_photons(joining *work)
{
    const pm_parallel *const parallel = work->run->of->config->parallel;
    const size_t round = (size_t)PHOTONS * BLOCKS;
    for (work->first = 0; work->first < work->set->count && !atomic_load(&work->canceled); work->first += round) {
        const size_t left = work->set->count - work->first, count = left < round ? left : round;
        pm__for(parallel, (count + PHOTONS - 1) / PHOTONS, join_block, work);
        if (!atomic_load(&work->canceled))
            add_round(work, count);
    }
}

/* ---- Lights seen ------------------------------------------------------------------------------- */

static bool sees_lights(const pm__scene *scene)
{
    bool any = false;
    for (size_t i = 0; i < pm__scene_light_count(scene); i++)
        any = any || pm__light_shows(pm__scene_light_at(scene, i));
    return any;
}

static void see_block(void *argument, size_t block)
{
    joining *const work = argument;
    pm__run *const run = work->run;
    if (is_canceled(work))
        return;
    for (size_t i = block * POINTS; i < (block + 1) * POINTS && i < run->of->points; i++) {
        pm__eye eye;
        pm__run_eye(run->of, run->seed, run->passes, i, false, &eye);
        (void)pm__eye_follow(&eye);
        for (int b = 0; b < 3; b++)
            run->state[i * PM__MEAN_FIELDS + PM__SEEN + (size_t)b] += eye.emitted[b];
    }
}

/* ---- The method -------------------------------------------------------------------------------- */

static pm_status whole_pass(pm__run *run, pm_error *error)
{
    pm__photon_set set = {0};
    joining work = {.run = run, .set = &set, .splats = pm__alloc((size_t)PHOTONS * BLOCKS, sizeof *work.splats)};
    pm_status status =
        work.splats ? pm__run_shoot(run, run->passes, &set, error) : pm__fail(error, PM_ENOMEM, "out of memory");
    const double start = pm__seconds();
    if (status == PM_OK)
        join_photons(&work);
    if (status == PM_OK && sees_lights(run->of->stage.scene))
        pm__for(run->of->config->parallel, (run->of->points + POINTS - 1) / POINTS, see_block, &work);
    run->lookup_s += pm__seconds() - start;
    if (atomic_load(&work.canceled))
        status = pm__fail(error, PM_ECANCELED, "canceled while photons were joined to the camera");
    pm__photon_set_free(&set);
    free(work.splats);
    return status;
}

/* Canceled between rounds, the run is as it was before: some had been added. */
static pm_status pass(pm__run *run, pm_error *error)
{
    const size_t size = run->of->points * PM__MEAN_FIELDS * sizeof *run->state;
    const uint64_t emitted = run->emitted, stored = run->stored;
    double *const before = pm__alloc(size, 1);
    if (!before)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu points", run->of->points);
    memcpy(before, run->state, size);
    const pm_status status = whole_pass(run, error);
    if (status != PM_OK) {
        memcpy(run->state, before, size);
        run->emitted = emitted;
        run->stored = stored;
    }
    free(before);
    return status;
}

static pm__point_view view(const pm__run *run, size_t point, const double *state)
{
    (void)run;
    (void)point;
    return (pm__point_view){0.0, state[PM__FOUND]};
}

const pm__progressive pm__progressive_light = {
    .entry = {.name = "light",
              .summary = "light tracing: photons joined to the camera; black where mirrors or glass are seen",
              .citation = "Dutre et al. 1993"},
    .uses_photons = true,
    .no_lookups = true,
    .redraws = true,
    .fields = PM__MEAN_FIELDS,
    .answer = pm__mean_answer,
    .averages = pm__always_averages,
    .view = view,
    .law = PM__LAW_UNBIASED,
    .pass = pass,
};
