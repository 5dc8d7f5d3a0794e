/* Strays: photons of strata that trial photons held to be unimportant, which come to an important place all the same.
 * Stored they would be bright dots among photons of small power ([C02] 5.7.4). */
#include "../base/memory.h"
#include "send_strata.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A photon of little more power than others is none. */
static const double least_load = 1.5;

/* ---- Put aside ---------------------------------------------------------------------------------- */

/* Marks them, and says how many. */
static size_t mark_strays(const pm__storage *storage, const pm__arrivals *arrivals, unsigned char *aside)
{
    size_t strays = 0;
    bool heavy = false;
    for (size_t i = 0; i < arrivals->count; i++) {
        if (i == 0 || arrivals->numbers[i] != arrivals->numbers[i - 1])
            heavy = pm__load_of(storage, arrivals, i) > least_load;
        aside[i] = heavy && arrivals->part[i];
        strays += aside[i];
    }
    return strays;
}

static pm_status put_aside(pm__sender *sender, const pm__arrivals *arrivals, size_t i)
{
    if (pm__grow((void **)&sender->strays, &sender->stray_room, sender->stray_count + 1, sizeof *sender->strays))
        return PM_ENOMEM;
    pm__stray *const stray = &sender->strays[sender->stray_count++];
    stray->photon = arrivals->photons[i];
    memcpy(stray->normal, arrivals->normals[i], sizeof stray->normal);
    return PM_OK;
}

pm_status pm__keep_but_strays(pm__storage *storage, const pm__arrivals *arrivals, pm__keep keep, size_t *taken)
{
    pm__sender *const sender = storage->sender;
    pm__arrivals others = *arrivals;
    if (!(sender->heaviest > least_load) || pm__policy_value(storage, "strays", 0.0) == 1.0)
        return keep(storage, arrivals, taken);
    unsigned char *const aside = pm__alloc(arrivals->count, sizeof *aside);
    if (!aside)
        return PM_ENOMEM;
    others.aside = mark_strays(storage, arrivals, aside) ? aside : NULL;
    pm_status status = keep(storage, &others, taken);
    for (size_t i = 0; others.aside && i < *taken && status == PM_OK; i++)
        if (aside[i])
            status = put_aside(sender, arrivals, i);
    free(aside);
    return status;
}

/* ---- Shared out --------------------------------------------------------------------------------- */

/* Important photons of the stock, and what they have been given. */
typedef struct sharing {
    pm__stock *stock;
    pm_map *map;
    uint32_t *which;     /* their numbers in the stock, by the map's source */
    double (*powers)[3]; /* by the same */
    double *spare;       /* units: what each may still receive */
    size_t count;
    pm_neighbor *near;
} sharing;

static double sum_of(const float power[3])
{
    return (double)power[0] + (double)power[1] + (double)power[2];
}

static pm_status begin_sharing(pm__storage *storage, sharing *s)
{
    pm__stock *const stock = s->stock = &storage->stock;
    const pm_map_options options = {.parallel = storage->config->parallel};
    pm_photon *const photons = pm__alloc(stock->count, sizeof *photons);
    s->which = pm__alloc(stock->count, sizeof *s->which);
    s->powers = pm__alloc(stock->count, sizeof *s->powers);
    s->spare = pm__alloc(stock->count, sizeof *s->spare);
    s->near = pm__alloc(stock->count, sizeof *s->near);
    pm_status status = photons && s->which && s->powers && s->spare && s->near ? PM_OK : PM_ENOMEM;
    for (size_t i = storage->settled; i < stock->count && status == PM_OK; i++) {
        if (!stock->part[i])
            continue;
        photons[s->count] = stock->photons[i];
        s->which[s->count] = (uint32_t)i;
        s->spare[s->count] = sum_of(stock->photons[i].power);
        for (int b = 0; b < 3; b++)
            s->powers[s->count][b] = (double)stock->photons[i].power[b];
        s->count++;
    }
    if (status == PM_OK)
        status = pm_map_create(photons, s->count, &options, &s->map, storage->error);
    free(photons);
    return status;
}

static void end_sharing(sharing *s)
{
    for (size_t i = 0; s->map && i < s->count; i++)
        for (int b = 0; b < 3; b++)
            s->stock->photons[s->which[i]].power[b] = (float)s->powers[i][b];
    pm_map_destroy(s->map);
    free(s->which);
    free(s->powers);
    free(s->spare);
    free(s->near);
}

/* Equal parts to those found that have room for more, again for what is left. `left`: of the stray, a share. */
static double give(sharing *s, const pm__stray *stray, size_t count, double left)
{
    enum { ROUNDS = 4 };
    const double all = sum_of(stray->photon.power);
    for (int round = 0; round < ROUNDS && left > 0.0; round++) {
        size_t takers = 0;
        for (size_t i = 0; i < count; i++)
            takers += s->spare[pm_map_source(s->map, s->near[i].number)] > 0.0;
        if (!takers)
            break;
        const double part = left / (double)takers;
        for (size_t i = 0; i < count; i++) {
            const size_t to = pm_map_source(s->map, s->near[i].number);
            const double given = fmin(part, s->spare[to] / all);
            if (!(given > 0.0))
                continue;
            for (int b = 0; b < 3; b++)
                s->powers[to][b] += given * (double)stray->photon.power[b];
            s->spare[to] = fmax(0.0, s->spare[to] - given * all);
            left = fmax(0.0, left - given);
        }
    }
    return left;
}

/* Among ever more of the nearest, until there is none left to give. */
static pm_status share(pm__storage *storage, sharing *s, const pm__stray *stray)
{
    enum { FIRST = 64, MOST = 16384 };
    static const double nothing = 1e-12;
    double left = sum_of(stray->photon.power) > 0.0 ? 1.0 : 0.0;
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, stray->photon.position, sizeof query.position);
    memcpy(query.normal, stray->normal, sizeof query.normal);
    query.front_only = true;
    query.sorted = false;
    for (size_t k = FIRST, found = k; left > nothing && found == k && k <= MOST; k *= 4) {
        query.k = k < s->count ? k : s->count;
        found = 0;
        const pm_status status = s->count ? pm_map_search(s->map, &query, s->near, s->count, &found) : PM_OK;
        if (status != PM_OK)
            return status;
        left = give(s, stray, found, left);
    }
    if (!(left > 0.0))
        return PM_OK;
    pm_photon rest = stray->photon;
    if (pm__stock_reserve(&storage->stock, 1))
        return PM_ENOMEM;
    for (int b = 0; b < 3; b++)
        rest.power[b] = (float)((double)rest.power[b] * left);
    pm__stock_add(&storage->stock, &rest, stray->normal, true);
    return PM_OK;
}

pm_status pm__share_strays(pm__storage *storage)
{
    const pm__sender *const sender = storage->sender;
    sharing s = {.count = 0};
    if (!sender || !sender->stray_count)
        return PM_OK;
    pm_status status = begin_sharing(storage, &s);
    for (size_t i = 0; i < sender->stray_count && status == PM_OK; i++)
        status = share(storage, &s, &sender->strays[i]);
    end_sharing(&s);
    return status;
}
