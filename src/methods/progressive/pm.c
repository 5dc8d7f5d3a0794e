/* One photon map that holds the photons of all passes so far, and one estimate of k of them, k = floor(k_1 i^beta)
 * after i passes (erratum 30: consistent for 0 < beta < 1, since then k grows and k / i falls). The squared radius goes
 * as i^(beta - 1) and relative variance as i^-beta: beta is to this method what alpha is to those that shrink, 2/3 is
 * best on surfaces, and with beta = 0 noise does not fall.
 *
 * The photons are the run's own and are kept, so memory grows with passes: 36 bytes a photon, and while an answer is
 * read as much again for the map. Photons depend on the pass's number alone, so a run that is resumed shoots those of
 * its passes again. */
#include "progressive.h"

#include "../../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { BETA };
enum { RADIANCE, AREA = RADIANCE + 3, COUNT, FIELDS };

typedef struct kept {
    pm_photon *photons; /* power: as of their own pass, which is `passes` times what they stand for */
    size_t count, capacity;
    uint32_t passes, settled; /* that photons are there of; that the state is the answer of */
} kept;

static const pm__param params[] = {
    {"beta", PM__REAL, 0.667, 0.0, 0.99, "", NULL, "k grows as passes to this power: 0, its noise stays"},
};

static size_t photons_of(const pm__progressive_config *config, uint32_t passes)
{
    return (size_t)floor((double)config->k * pow(passes, config->method->values[BETA]));
}

/* ---- Photons ----------------------------------------------------------------------------------- */

static kept *kept_by(pm__run *run)
{
    if (!run->own)
        run->own = calloc(1, sizeof(kept));
    return run->own;
}

static pm_status keep(pm__run *run, kept *all, pm_error *error)
{
    pm__photon_set set = {0};
    void *photons = all->photons;
    pm_status status = pm__run_shoot(run, all->passes, &set, error);
    if (status == PM_OK && set.count && pm__grow(&photons, &all->capacity, all->count + set.count, sizeof(pm_photon)))
        status = pm__fail(error, PM_ENOMEM, "out of memory for the photons of %u passes", all->passes + 1);
    all->photons = photons;
    if (status == PM_OK && set.count)
        memcpy(all->photons + all->count, set.photons, set.count * sizeof *set.photons);
    if (status == PM_OK) {
        all->count += set.count;
        all->passes++;
    }
    pm__photon_set_free(&set);
    return status;
}

static pm_status pass(pm__run *run, pm_error *error)
{
    kept *const all = kept_by(run);
    return all ? keep(run, all, error) : pm__fail(error, PM_ENOMEM, "out of memory for photons");
}

/* What a resumed run lacks. Its photons have been counted before. */
static pm_status shoot_again(pm__run *run, kept *all, pm_error *error)
{
    const uint64_t emitted = run->emitted, stored = run->stored;
    pm_status status = PM_OK;
    while (status == PM_OK && all->passes < run->passes)
        status = keep(run, all, error);
    run->emitted = emitted;
    run->stored = stored;
    return status;
}

static pm_status settle(pm__run *run, pm_error *error)
{
    kept *const all = kept_by(run);
    if (!all)
        return pm__fail(error, PM_ENOMEM, "out of memory for photons");
    pm_status status = shoot_again(run, all, error);
    if (status != PM_OK || all->settled == run->passes)
        return status;
    const pm__photon_set set = {.photons = all->photons, .count = all->count};
    pm_map *map = NULL;
    status = pm__run_map(run, &set, &map, error);
    if (status == PM_OK)
        status = pm__run_lookups(run, map, error);
    pm_map_destroy(map);
    if (status == PM_OK)
        all->settled = run->passes;
    return status;
}

static void release(pm__run *run)
{
    kept *const all = run->own;
    if (all)
        free(all->photons);
    free(all);
    run->own = NULL;
}

/* ---- Points ------------------------------------------------------------------------------------ */

static void ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius)
{
    (void)point;
    (void)state;
    *k = photons_of(run->of->config, run->passes);
    *radius = INFINITY;
}

static void take(const pm__run *run, const pm__found *found, double *state)
{
    (void)run;
    memcpy(&state[RADIANCE], found->radiance, sizeof found->radiance);
    state[AREA] = found->area;
    state[COUNT] = (double)found->count;
}

static void answer(const pm__run *run, const double *state, double radiance[3])
{
    for (int b = 0; b < 3; b++)
        radiance[b] = state[RADIANCE + b] / (double)run->passes;
}

/* Of the last lookup: there is none before an answer is read. */
static pm__point_view view(const pm__run *run, size_t point, const double *state)
{
    (void)run;
    (void)point;
    return (pm__point_view){sqrt(state[AREA] / pi), state[COUNT]};
}

const pm__progressive pm__progressive_pm = {
    .entry = {.name = "pm",
              .summary = "one map of the photons of all passes, k growing with them; memory grows with passes",
              .citation = "Jensen 1996; errata 30",
              .params = params,
              .param_count = 1},
    .uses_photons = true,
    .fields = FIELDS,
    .ask = ask,
    .take = take,
    .answer = answer,
    .view = view,
    .law = PM__LAW_GROWING,
    .photons_of = photons_of,
    .pass = pass,
    .settle = settle,
    .release = release,
};
