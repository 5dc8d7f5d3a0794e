#include "send_strata.h"

#include "../base/memory.h"
#include "trial.h"

#include <math.h>
#include <stdlib.h>

/* What a photon of each stratum does, by its trial photons: first a few of each light, and where these find anything
 * more of each stratum of it. */
typedef struct looking {
    pm__trial fine;      /* of the strata that are sent from */
    pm__trial_sum *whole; /* of each light, both times */
    bool *cut;           /* lights */
} looking;

static double at_most_one(double x)
{
    return fmin(1.0, x);
}

/* ---- Looks -------------------------------------------------------------------------------------- */

/* Trial photons of each of so many: a hundredth of what is to be sent, within bounds. */
static size_t tests_of(const pm__storage *s, size_t count)
{
    enum { MOST = 1024 };
    static const double share = 0.01;
    const double least = pm__policy_value(s, "tests", 1.0), some = share * (double)s->config->emitted / (double)count;
    return (size_t)fmax(least, fmin(some, MOST));
}

static void add_sum(const pm__trial_sum *sum, pm__trial_sum *to)
{
    to->count += sum->count;
    to->finders += sum->finders;
    to->found += sum->found;
    to->square += sum->square;
}

static void add_sums(const pm__strata *strata, const pm__trial *trial, looking *l)
{
    for (size_t i = 0; i < strata->count; i++)
        add_sum(&trial->sums[i], &l->whole[strata->items[i].light]);
}

/* Lights of which two photons find something are to be cut. */
static pm_status look_first(pm__storage *s, looking *l)
{
    enum { ENOUGH = 2 };
    const size_t lights = pm__scene_light_count(s->config->scene);
    pm__trial trial;
    pm__strata whole;
    if (pm__strata_create(&s->emission, 1, NULL, tests_of(s, lights), &whole))
        return PM_ENOMEM;
    const pm_status status = pm__trial_run(s, &whole, whole.count, &trial);
    if (status == PM_OK) {
        add_sums(&whole, &trial, l);
        for (size_t i = 0; i < lights; i++)
            l->cut[i] = l->whole[i].finders >= ENOUGH;
        pm__trial_free(&trial);
    }
    pm__strata_free(&whole);
    return status;
}

static pm_status look(pm__storage *s, bool twice, looking *l)
{
    const size_t lights = pm__scene_light_count(s->config->scene);
    const size_t per_light = (size_t)pm__policy_value(s, "strata", 1.0);
    pm__strata *const strata = &s->sender->strata;
    l->whole = pm__alloc_zero(lights, sizeof *l->whole);
    l->cut = pm__alloc_zero(lights, sizeof *l->cut);
    pm_status status = l->whole && l->cut ? PM_OK : PM_ENOMEM;
    if (status == PM_OK && twice)
        status = look_first(s, l);
    if (status == PM_OK)
        status = pm__strata_create(&s->emission, per_light, twice ? l->cut : NULL,
                                   (size_t)pm__policy_value(s, "tests", 1.0), strata);
    if (status != PM_OK)
        return status;
    if (twice && strata->fine)
        strata->tests = tests_of(s, strata->fine);
    status = pm__trial_run(s, strata, strata->fine, &l->fine);
    if (status == PM_OK)
        add_sums(strata, &l->fine, l);
    return status;
}

static void free_looking(looking *l)
{
    pm__trial_free(&l->fine);
    free(l->whole);
    free(l->cut);
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
    for (size_t i = 0; i < strata->count; i++) {
        all += shares[i];
        strata->items[i].load = shares[i] > 0.0 ? evenly(s, i) / shares[i] : 0.0;
        s->sender->heaviest = fmax(s->sender->heaviest, strata->items[i].load);
    }
    s->planned = (uint64_t)ceil(all);
    if (s->planned > 0 && s->config->stored < SIZE_MAX)
        pm__strata_share(&s->emission, strata, shares);
    else if (s->planned > 0)
        s->planned = pm__strata_deal(&s->emission, strata, shares);
    s->emission.strata = strata;
}

/* Of strata that sent none to important places, what was stored is kept. */
static pm_status keep_printed(pm__storage *s, const pm__trial *t)
{
    const pm__harvest *const h = &t->photons;
    if (pm__stock_reserve(&s->stock, h->count))
        return PM_ENOMEM;
    for (size_t i = 0; i < h->count; i++) {
        const pm_photon *const photon = &h->photons[i];
        if (t->sums[h->numbers[i] / s->sender->strata.tests].is_important)
            continue;
        pm__stock_add(&s->stock, photon, h->normals[i], false);
        s->settled_came[PM__EVERYWHERE] +=
            (double)photon->power[0] + (double)photon->power[1] + (double)photon->power[2];
    }
    s->settled = s->settled_arrived = s->stock.count;
    return PM_OK;
}

/* Of a light of which one photon found something at most chance has all to say: such lights are taken together. */
static double worth_of_few(const pm__storage *s, const looking *l)
{
    double count = 0.0, square = 0.0;
    for (size_t i = 0; i < pm__scene_light_count(s->config->scene); i++)
        if (l->whole[i].finders <= 1.0) {
            count += l->whole[i].count;
            square += l->whole[i].square;
        }
    return count > 0.0 ? square / count : 0.0;
}

/* Mean square of what a photon finds: by those of the stratum, and two more that do as those of its whole light. */
static double worth_of(const pm__storage *s, const looking *l, size_t stratum, double few)
{
    static const double more = 2.0;
    const pm__trial_sum *const own = &l->fine.sums[stratum];
    const pm__trial_sum *const light = &l->whole[s->sender->strata.items[stratum].light];
    const double of_light = light->finders <= 1.0 ? few : light->square / light->count;
    return (own->square + more * of_light) / (own->count + more);
}

/* The variance of a sum is least for its cost where strata send by their power times the root of the mean square of
 * what a photon of theirs adds (Neyman 1934). Those worth as much as the average of what is found, or more, send as
 * many as even sending would: where it matters powers are even. So do all where nothing is found. */
static void share_sets(pm__storage *s, const looking *l, double *shares)
{
    const double ratio = pm__policy_value(s, "ratio", 1.0), few = worth_of_few(s, l);
    double sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < s->sender->strata.count; i++) {
        const double worth = shares[i] = worth_of(s, l, i, few);
        sum += evenly(s, i) * worth;
        squares += evenly(s, i) * worth * worth;
    }
    for (size_t i = 0; i < s->sender->strata.count; i++) {
        const double even = evenly(s, i), least = fmax(even / ratio, at_most_one(even));
        const double graded = sum > 0.0 ? even * sqrt(at_most_one(shares[i] * sum / squares)) : even;
        shares[i] = fmax(least, graded);
    }
}

static void share_printed(pm__storage *s, const looking *l, double *shares)
{
    for (size_t i = 0; i < s->sender->strata.count; i++)
        shares[i] = l->fine.sums[i].is_important ? evenly(s, i) : 0.0;
}

static double found_by(const pm__storage *s, const looking *l, size_t stratum)
{
    const pm__trial_sum *const own = &l->fine.sums[stratum];
    const pm__trial_sum *const sum = own->count > 0.0 ? own : &l->whole[s->sender->strata.items[stratum].light];
    return sum->found / sum->count;
}

static void share_importance(pm__storage *s, const looking *l, double *shares)
{
    const double least = pm__policy_value(s, "least", 1.0);
    double all = 0.0;
    for (size_t i = 0; i < s->sender->strata.count; i++)
        all += shares[i] = evenly(s, i) * found_by(s, l, i);
    for (size_t i = 0; i < s->sender->strata.count; i++) {
        const double even = evenly(s, i);
        shares[i] = all > 0.0 ? least * even + (1.0 - least) * (double)s->config->emitted * shares[i] / all : even;
    }
}

static pm_status plan(pm__storage *s, bool printed, void (*share)(pm__storage *s, const looking *l, double *shares))
{
    looking l = {.cut = NULL};
    s->sender = pm__alloc_zero(1, sizeof *s->sender);
    pm_status status = s->sender ? look(s, !printed, &l) : PM_ENOMEM;
    double *const shares = status == PM_OK ? pm__alloc(s->sender->strata.count, sizeof *shares) : NULL;
    if (status == PM_OK && !shares)
        status = PM_ENOMEM;
    if (status == PM_OK && printed)
        status = keep_printed(s, &l.fine);
    if (status == PM_OK) {
        share(s, &l, shares);
        send_shares(s, shares);
    }
    free(shares);
    free_looking(&l);
    return status;
}

static pm_status plan_sets(pm__storage *s)
{
    const bool printed = pm__policy_value(s, "form", 0.0) == 1.0;
    return plan(s, printed, printed ? share_printed : share_sets);
}

static pm_status plan_by_importance(pm__storage *s)
{
    return plan(s, false, share_importance);
}

static void release(pm__storage *s)
{
    if (!s->sender)
        return;
    pm__strata_free(&s->sender->strata);
    free(s->sender->strays);
    free(s->sender->places);
    free(s->sender->paths);
    free(s->sender);
}

const pm__sending pm__send_sets = {plan_sets, release};
const pm__sending pm__send_by_importance = {plan_by_importance, release};
