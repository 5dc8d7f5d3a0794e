#include "send_strata.h"

#include "../base/memory.h"
#include "harvest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Trial photons ------------------------------------------------------------------------------ */

typedef struct trial {
    pm__harvest photons;
    float *importance;
    double *found;   /* importance that the photons of each stratum came to, 1/m2, the sum */
    bool *important; /* strata of which a photon came to an important place */
} trial;

static void trace_range(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    (void)pm__trace(tracing, first, count, store, context);
}

static pm_status trace_trial(pm__storage *s, trial *t)
{
    const pm__strata *const strata = &s->sender->strata;
    const pm__trace_config tracing = {s->config->scene, s->paths, s->config->seed, s->trial, &s->emission};
    const pm__shoot_config shooting = {.scene = s->config->scene, .normals = true, .parallel = s->config->parallel,
                                       .canceled = s->config->canceled, .context = s->config->context};
    const pm__harvest_wish wish = {.tracer = trace_range, .tracing = &tracing, .power = s->emission.total,
                                   .first = PM__MOST_TRACED, .most = strata->count * strata->tests,
                                   .wanted = SIZE_MAX, .numbers = true};
    const pm_status status = pm__harvest_paths(&shooting, &wish, &t->photons, s->error);
    s->tried = status == PM_OK ? t->photons.emitted : 0;
    s->unit = t->photons.unit;
    return status;
}

static pm_status look_up(const pm__storage *s, trial *t)
{
    const pm__harvest *const h = &t->photons;
    float (*const positions)[3] = pm__alloc(h->count, sizeof *positions);
    t->importance = pm__alloc(h->count, sizeof *t->importance);
    pm_status status = positions && t->importance ? PM_OK : PM_ENOMEM;
    for (size_t i = 0; i < h->count && status == PM_OK; i++)
        memcpy(positions[i], h->photons[i].position, sizeof positions[i]);
    if (status == PM_OK)
        status = pm__importance_at(s->config->importance, s->config->kind, (const float(*)[3])positions,
                                   (const float(*)[3])h->normals, h->count, t->importance);
    free(positions);
    return status;
}

static pm_status sum_up(const pm__storage *s, trial *t)
{
    const pm__strata *const strata = &s->sender->strata;
    t->found = pm__alloc_zero(strata->count, sizeof *t->found);
    t->important = pm__alloc_zero(strata->count, sizeof *t->important);
    if (!t->found || !t->important)
        return PM_ENOMEM;
    for (size_t i = 0; i < t->photons.count; i++) {
        const size_t stratum = t->photons.numbers[i] / strata->tests;
        t->found[stratum] += (double)t->importance[i];
        t->important[stratum] = t->important[stratum] || (double)t->importance[i] >= s->threshold;
    }
    return PM_OK;
}

static pm_status run_trial(pm__storage *s, trial *t)
{
    pm_status status = trace_trial(s, t);
    if (status == PM_OK)
        status = look_up(s, t);
    return status == PM_OK ? sum_up(s, t) : status;
}

static void free_trial(trial *t)
{
    pm__harvest_free(&t->photons);
    free(t->importance);
    free(t->found);
    free(t->important);
}

/* ---- Sets --------------------------------------------------------------------------------------- */

/* What even sending would send of a stratum. */
static double evenly(const pm__storage *s, size_t stratum)
{
    return (double)s->config->emitted * s->sender->strata.items[stratum].power / s->emission.total;
}

/* Shares are numbers of photons. */
static void send_shares(pm__storage *s, const double *shares)
{
    pm__strata *const strata = &s->sender->strata;
    double all = 0.0;
    for (size_t i = 0; i < strata->count; i++)
        all += shares[i];
    s->planned = (uint64_t)ceil(all);
    if (s->planned == 0)
        return;
    for (size_t i = 0; i < strata->count; i++) {
        strata->items[i].load = shares[i] > 0.0 ? evenly(s, i) / shares[i] : 0.0;
        s->sender->heaviest = fmax(s->sender->heaviest, strata->items[i].load);
    }
    pm__strata_share(&s->emission, strata, shares);
}

/* Of strata that sent none to important places, what was stored is kept. */
static pm_status keep_printed(pm__storage *s, const trial *t)
{
    const pm__harvest *const h = &t->photons;
    if (pm__stock_reserve(&s->stock, h->count))
        return PM_ENOMEM;
    for (size_t i = 0; i < h->count; i++) {
        const pm_photon *const photon = &h->photons[i];
        if (t->important[h->numbers[i] / s->sender->strata.tests])
            continue;
        pm__stock_add(&s->stock, photon, h->normals[i], false);
        s->settled_came[PM__EVERYWHERE] +=
            (double)photon->power[0] + (double)photon->power[1] + (double)photon->power[2];
    }
    s->settled = s->settled_arrived = s->stock.count;
    return PM_OK;
}

static void share_sets(pm__storage *s, const trial *t, double *shares)
{
    const double ratio = pm__policy_value(s, "ratio", 1.0);
    const bool printed = pm__policy_value(s, "form", 0.0) == 1.0;
    for (size_t i = 0; i < s->sender->strata.count; i++) {
        const double even = evenly(s, i), few = fmax(even / ratio, fmin(even, 1.0));
        shares[i] = t->important[i] ? even : printed ? 0.0 : few;
    }
}

static void share_importance(pm__storage *s, const trial *t, double *shares)
{
    const double least = pm__policy_value(s, "least", 1.0);
    double all = 0.0;
    for (size_t i = 0; i < s->sender->strata.count; i++)
        all += evenly(s, i) * t->found[i];
    for (size_t i = 0; i < s->sender->strata.count; i++) {
        const double even = evenly(s, i);
        shares[i] = all > 0.0 ? least * even + (1.0 - least) * (double)s->config->emitted * even * t->found[i] / all
                              : even;
    }
}

static pm_status plan(pm__storage *s, void (*share)(pm__storage *s, const trial *t, double *shares))
{
    trial t = {.importance = NULL};
    pm__sender *const sender = s->sender = pm__alloc_zero(1, sizeof *s->sender);
    const size_t per_light = (size_t)pm__policy_value(s, "strata", 1.0);
    const size_t tests = (size_t)pm__policy_value(s, "tests", 1.0);
    if (!sender || pm__strata_create(&s->emission, per_light, tests, &sender->strata))
        return PM_ENOMEM;
    s->emission.strata = &sender->strata;
    double *const shares = pm__alloc(sender->strata.count, sizeof *shares);
    pm_status status = shares ? run_trial(s, &t) : PM_ENOMEM;
    if (status == PM_OK && pm__policy_value(s, "form", 0.0) == 1.0)
        status = keep_printed(s, &t);
    if (status == PM_OK) {
        share(s, &t, shares);
        send_shares(s, shares);
    }
    free(shares);
    free_trial(&t);
    return status;
}

static pm_status plan_sets(pm__storage *s)
{
    return plan(s, share_sets);
}

static pm_status plan_by_importance(pm__storage *s)
{
    return plan(s, share_importance);
}

static void release(pm__storage *s)
{
    if (!s->sender)
        return;
    pm__strata_free(&s->sender->strata);
    free(s->sender->strays);
    free(s->sender);
}

const pm__sending pm__send_sets = {plan_sets, release};
const pm__sending pm__send_by_importance = {plan_by_importance, release};
