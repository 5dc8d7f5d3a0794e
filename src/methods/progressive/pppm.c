/* Progressive photon mapping by probability (Knaus and Zwicker 2011): passes are independent but for their radius,
 * which shrinks by a rule that looks at no photon, r_{i+1}^2 / r_i^2 = (i + alpha) / (i + 1) with i from 1 (their eq.
 * 17); the answer is the mean of the passes. Any kernel serves. */
#include "means.h"
#include "shrink.h"

#include <math.h>

/* SHARE: squared radius over that of the first pass. */
enum { SHARE = PM__MEAN_FIELDS, FIELDS };

static double shrink(double alpha, uint32_t pass)
{
    return (pass + 1.0 + alpha) / (pass + 2.0);
}

static double schedule(const double *values, double alpha, double pass)
{
    (void)values;
    return pm__shrink_product(1.0, pass + 1.0, alpha);
}

static void begin(const pm__run *run, size_t point, double *state)
{
    (void)run;
    (void)point;
    state[SHARE] = 1.0;
}

static double radius_of(const pm__run *run, size_t point, const double *state)
{
    return (double)run->of->radius[point] * sqrt(state[SHARE]);
}

static void ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius)
{
    *k = 0;
    *radius = radius_of(run, point, state);
}

static void take(const pm__run *run, const pm__found *found, double *state)
{
    for (int b = 0; b < 3; b++) {
        state[PM__SUM + b] += found->radiance[b];
        state[PM__SEEN + b] += found->emitted[b];
    }
    state[PM__FOUND] += (double)found->count;
    state[SHARE] *= shrink(run->of->config->alpha, run->passes);
}

static pm__point_view view(const pm__run *run, size_t point, const double *state)
{
    return (pm__point_view){radius_of(run, point, state), state[PM__FOUND]};
}

const pm__progressive pm__progressive_pppm = {
    .entry = {.name = "pppm",
              .summary = "progressive photon mapping by probability: independent passes, radii by a rule of their own",
              .citation = "Knaus and Zwicker 2011"},
    .uses_photons = true,
    .redraws = true,
    .shrinks = true,
    .fields = FIELDS,
    .begin = begin,
    .ask = ask,
    .take = take,
    .answer = pm__mean_answer,
    .averages = pm__always_averages,
    .view = view,
    .law = PM__LAW_SHRINKING,
    .schedule = schedule,
};
