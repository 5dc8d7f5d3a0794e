/* Path tracing (Kajiya 1986) of the light paths that the photons of the other methods take: one path from the eye
 * through each pixel a pass, without a bias where it finds the light at all.
 *
 * A path is spelled from the surface where radiance is wanted, against the light: letters go before those found, and
 * light counts where L before them makes a path of the expression. At rough surfaces each light is sampled; behind
 * mirrors and glass lights are met by chance, so that lights without an area are never found there: their caustics are
 * missing, and the error does not fall below what they would add. */
#include "progressive.h"

#include "../../base/clock.h"
#include "../../base/memory.h"
#include "../../base/parallel.h"
#include "../../transport/paths.h"

#include <stdatomic.h>
#include <stdlib.h>

enum { SUM, FIELDS = SUM + 3 };
enum { POINTS = 256 }; /* of one task */

/* Through mirrors and glass to the next rough surface; lights are seen on the way where they end a path that is wanted.
 * false: there is no such surface, or none further is of use. */
static bool go_on(const pm__paths *paths, pm__eye *eye, pm__places *places)
{
    for (;;) {
        const pm__eye_met met = pm__eye_step(eye);
        if (met == PM__EYE_ENDS)
            return false;
        *places = pm__paths_step_back(paths, *places, met == PM__EYE_STANDS ? 'D' : 'S');
        eye->sees_lights = met == PM__EYE_PASSES && pm__paths_whole(paths, *places);
        if (!pm__paths_whole(paths, *places) && !pm__paths_grow(paths, *places))
            return false;
        if (met == PM__EYE_STANDS)
            return true;
    }
}

static void trace(const pm__run *run, size_t point, double radiance[3])
{
    const pm__paths *const paths = run->of->paths;
    pm__places places = pm__paths_from_end(paths);
    pm__eye eye;
    pm__run_eye(run->of, run->seed, run->passes, point, false, &eye);
    radiance[0] = radiance[1] = radiance[2] = 0.0;
    for (bool on = pm__eye_follow(&eye); on; on = go_on(paths, &eye, &places)) {
        if (pm__paths_whole(paths, places))
            pm__eye_direct(&eye, false, radiance);
        if (!pm__paths_grow(paths, places) || !pm__eye_bounce(&eye))
            break;
    }
    for (int b = 0; b < 3; b++)
        radiance[b] += eye.emitted[b];
}

typedef struct tracing {
    pm__run *run;
    double (*radiance)[3]; /* [points]: the state takes them when all are there, so that a pass is whole or not done */
    _Atomic bool canceled;
} tracing;

static void trace_block(void *argument, size_t block)
{
    tracing *const work = argument;
    const pm__progressive_config *const config = work->run->of->config;
    const size_t points = work->run->of->points, end = (block + 1) * POINTS;
    if (config->canceled && config->canceled(config->context)) {
        atomic_store(&work->canceled, true);
        return;
    }
    for (size_t i = block * POINTS; i < end && i < points; i++)
        trace(work->run, i, work->radiance[i]);
}

static void take(const tracing *work)
{
    for (size_t i = 0; i < work->run->of->points; i++)
        for (size_t b = 0; b < 3; b++)
            work->run->state[i * FIELDS + SUM + b] += work->radiance[i][b];
}

static pm_status pass(pm__run *run, pm_error *error)
{
    tracing work = {.run = run, .radiance = pm__alloc(run->of->points, sizeof *work.radiance)};
    const double start = pm__seconds();
    if (!work.radiance)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu points", run->of->points);
    pm__for(run->of->config->parallel, (run->of->points + POINTS - 1) / POINTS, trace_block, &work);
    const bool canceled = atomic_load(&work.canceled);
    if (!canceled)
        take(&work);
    free(work.radiance);
    run->trace_s += pm__seconds() - start;
    return canceled ? pm__fail(error, PM_ECANCELED, "canceled while paths were traced") : PM_OK;
}

static void answer(const pm__run *run, const double *state, double radiance[3])
{
    for (int b = 0; b < 3; b++)
        radiance[b] = state[SUM + b] / (double)run->passes;
}

const pm__progressive pm__progressive_path = {
    .entry = {.name = "path",
              .summary = "path tracing, a path a pixel and pass; caustics of lights without an area are missing",
              .citation = "Kajiya 1986"},
    .redraws = true,
    .fields = FIELDS,
    .answer = answer,
    .averages = pm__always_averages,
    .law = PM__LAW_UNBIASED,
    .pass = pass,
};
