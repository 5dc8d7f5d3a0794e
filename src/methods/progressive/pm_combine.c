/* Many photon maps, their lookups pooled ([C02] 5.6): the answer is the flux of all passes' k nearest photons over the
 * sum of the areas that hold them, M / pi times sum P / sum r^2 for M maps that share the photons (errata 11, 31).
 *
 * Under even light of D photons per area the areas of M passes add up to a Gamma(M k) variable over D, so the pooled
 * disc is bright by M k / (M k - 1), which goes to 1, with relative variance 1 / (M k - 2). That is with the kernel's
 * last photon in full, as printed. A kernel leaves out its last photon in every pass: last=none gives (k - 1) / k in
 * the limit, and any kernel (k - 1 + last w(1) / c) / k. The bias of the Laplacian, m2 / 4 times mean r^4 over mean
 * r^2, which is (k + 1) / k mean r^2, stays that of one pass. */
#include "means.h"

/* Radiance times area, W/sr. */
enum { FLUX = PM__NEAREST_SUM };

static void take(const pm__run *run, const pm__found *found, double *state)
{
    (void)run;
    for (int b = 0; b < 3; b++)
        state[FLUX + b] += found->radiance[b] * found->area;
    state[PM__NEAREST_AREA] += found->area;
    state[PM__NEAREST_COUNT] += (double)found->count;
}

static void answer(const pm__run *run, const double *state, double radiance[3])
{
    (void)run;
    for (int b = 0; b < 3; b++)
        radiance[b] = state[PM__NEAREST_AREA] > 0.0 ? state[FLUX + b] / state[PM__NEAREST_AREA] : 0.0;
}

const pm__progressive pm__progressive_pm_combine = {
    .entry = {.name = "pm-combine",
              .summary = "flux of all passes' k photons over the sum of their areas: the bias of curved light stays",
              .citation = "course 43, section 5.6; errata 11, 31"},
    .uses_photons = true,
    .fields = PM__NEAREST_FIELDS,
    .ask = pm__nearest_ask,
    .take = take,
    .answer = answer,
    .view = pm__nearest_view,
    .law = PM__LAW_POOLED,
};
