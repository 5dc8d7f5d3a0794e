/* Many photon maps, their images averaged: each pass has a map of its own, and the answer is the mean of the passes'
 * estimates of k nearest photons. Only noise is averaged away: relative variance 1 / ((k - 2) i) after i passes (disc),
 * while the bias stays that of one pass: k / (k - 1) under even light where the last photon counts in full (errata 1,
 * 31), and m2 / 4 times the mean r_k^2 times the Laplacian elsewhere. Memory is that of one pass. */
#include "progressive.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

enum { SUM, AREA = SUM + 3, COUNT, FIELDS };

static void ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius)
{
    (void)point;
    (void)state;
    *k = run->of->config->k;
    *radius = INFINITY;
}

static void take(const pm__run *run, const pm__found *found, double *state)
{
    (void)run;
    for (int b = 0; b < 3; b++)
        state[SUM + b] += found->radiance[b];
    state[AREA] += found->area;
    state[COUNT] += (double)found->count;
}

static void answer(const pm__run *run, const double *state, double radiance[3])
{
    for (int b = 0; b < 3; b++)
        radiance[b] = state[SUM + b] / (double)run->passes;
}

/* The next radius is not known before its photons: the root of the mean square of those so far. */
static pm__point_view view(const pm__run *run, size_t point, const double *state)
{
    (void)point;
    return (pm__point_view){run->passes ? sqrt(state[AREA] / (pi * run->passes)) : 0.0, state[COUNT]};
}

const pm__progressive pm__progressive_pm_average = {
    .entry = {.name = "pm-average",
              .summary = "the mean over passes of estimates of k photons: the bias of one pass stays",
              .citation = "Jensen 1996; errata 31"},
    .uses_photons = true,
    .fields = FIELDS,
    .ask = ask,
    .take = take,
    .answer = answer,
    .view = view,
    .law = PM__LAW_MEAN,
};
