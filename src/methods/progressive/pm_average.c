/* Many photon maps, their images averaged: each pass has a map of its own, and the answer is the mean of the passes'
 * estimates of k nearest photons. Only noise is averaged away: relative variance 1 / ((k - 2) i) after i passes (disc),
 * while the bias stays that of one pass: k / (k - 1) under even light where the last photon counts in full (errata 1,
 * 31), and m2 / 4 times the mean r_k^2 times the Laplacian elsewhere. Memory is that of one pass. */
#include "means.h"

static void take(const pm__run *run, const pm__found *found, double *state)
{
    (void)run;
    for (int b = 0; b < 3; b++)
        state[PM__NEAREST_SUM + b] += found->radiance[b];
    state[PM__NEAREST_AREA] += found->area;
    state[PM__NEAREST_COUNT] += (double)found->count;
}

static void answer(const pm__run *run, const double *state, double radiance[3])
{
    for (int b = 0; b < 3; b++)
        radiance[b] = state[PM__NEAREST_SUM + b] / (double)run->passes;
}

const pm__progressive pm__progressive_pm_average = {
    .entry = {.name = "pm-average",
              .summary = "the mean over passes of estimates of k photons: the bias of one pass stays",
              .citation = "Jensen 1996; errata 31"},
    .uses_photons = true,
    .fields = PM__NEAREST_FIELDS,
    .ask = pm__nearest_ask,
    .take = take,
    .answer = answer,
    .view = pm__nearest_view,
    .law = PM__LAW_MEAN,
};
