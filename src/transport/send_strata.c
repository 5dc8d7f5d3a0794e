#include "send_strata.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "harvest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Trial photons ------------------------------------------------------------------------------ */

typedef struct trial {
    pm__harvest photons;
    float *importance;
    double *found;   /* importance that the photons of each stratum came to, 1/m2, the sum */
    double *worth;   /* the same over the mean of importons, a photon at most 1: about how many matter */
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
    const pm__storing_config *const config = s->config;
    t->importance = pm__alloc(t->photons.count, sizeof *t->importance);
    if (!t->importance)
        return PM_ENOMEM;
    pm__importance_of_photons(config->importance, config->kind, config->parallel, t->photons.photons,
                              (const float(*)[3])t->photons.normals, t->photons.count, t->importance);
    return PM_OK;
}

static pm_status sum_up(const pm__storage *s, trial *t)
{
    const pm__strata *const strata = &s->sender->strata;
    t->found = pm__alloc_zero(strata->count, sizeof *t->found);
    t->worth = pm__alloc_zero(strata->count, sizeof *t->worth);
    t->important = pm__alloc_zero(strata->count, sizeof *t->important);
    if (!t->found || !t->worth || !t->important)
        return PM_ENOMEM;
    const double mean = pm__importance_mean(s->config->importance, s->config->kind);
    for (size_t i = 0; i < t->photons.count; i++) {
        const size_t stratum = t->photons.numbers[i] / strata->tests;
        t->found[stratum] += (double)t->importance[i];
        t->worth[stratum] += mean > 0.0 ? fmin(1.0, (double)t->importance[i] / mean) : 0.0;
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
    free(t->worth);
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

/* Worth of a photon of each stratum: of its own trial photons, and of those of its whole light as if they were one
 * more, for chance has too much to say in a few. */
static double worth_of(const pm__storage *s, const trial *t, size_t stratum)
{
    const pm__strata *const strata = &s->sender->strata;
    const size_t light = strata->items[stratum].light;
    size_t begin = stratum, end = stratum;
    double all = 0.0;
    while (begin > 0 && strata->items[begin - 1].light == light)
        begin--;
    while (end < strata->count && strata->items[end].light == light)
        end++;
    for (size_t i = begin; i < end; i++)
        all += t->worth[i];
    const double tests = (double)strata->tests, one = all / ((double)(end - begin) * tests);
    return (t->worth[stratum] + one) / (tests + 1.0);
}

/* The variance of a sum is least for its cost where strata send in proportion to the root of the mean square of what a
 * photon of theirs adds: where a share w of equal photons matters, to the root of w. */
static void share_sets(pm__storage *s, const trial *t, double *shares)
{
    const double ratio = pm__policy_value(s, "ratio", 1.0);
    const bool printed = pm__policy_value(s, "form", 0.0) == 1.0, two = pm__policy_value(s, "sets", 1.0) == 1.0;
    for (size_t i = 0; i < s->sender->strata.count; i++) {
        const double even = evenly(s, i), few = fmax(even / ratio, fmin(even, 1.0));
        const double graded = fmax(few, even * fmin(1.0, sqrt(worth_of(s, t, i))));
        if (printed)
            shares[i] = t->important[i] ? even : 0.0;
        else
            shares[i] = !two ? graded : t->important[i] ? even : few;
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
