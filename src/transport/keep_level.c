#include "keep_level.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../stats/stats.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { NEAR = 50, AT_ONCE = 32, PIECE = 512, MOST = 4096 };

/* Of the median of those about it: what a photon may carry. */
static const double most_of_median = 2.0;

static const uint32_t nowhere = UINT32_MAX;

/* A photon that chance decided about, and its place in the stock, or nowhere. */
typedef struct waiting {
    pm_photon photon;
    float normal[3];
    uint32_t place;
} waiting;

typedef struct leveling {
    waiting *items;
    size_t count, room;
} leveling;

pm_status pm__level_begin(pm__storage *storage)
{
    storage->own = pm__alloc_zero(1, sizeof(leveling));
    return storage->own ? PM_OK : PM_ENOMEM;
}

void pm__level_release(pm__storage *storage)
{
    leveling *const l = storage->own;
    if (!l)
        return;
    free(l->items);
    free(l);
    storage->own = NULL;
}

pm_status pm__level_keep(pm__storage *storage, const pm__arrivals *arrivals, pm__chance chance, size_t *taken)
{
    leveling *const l = storage->own;
    size_t place = storage->stock.count;
    const pm_status status = pm__keep_by_chance(storage, arrivals, chance, taken);
    if (status != PM_OK || storage->config->stored < SIZE_MAX)
        return status;
    if (pm__grow((void **)&l->items, &l->room, l->count + *taken, sizeof *l->items))
        return PM_ENOMEM;
    for (size_t i = 0; i < *taken; i++) {
        const float factor = arrivals->part[i] ? 1.0f : pm__chance_factor(storage, arrivals, chance, i);
        const size_t kept = place;
        place += factor > 0.0f;
        if (factor == 1.0f)
            continue;
        waiting *const w = &l->items[l->count++];
        w->photon = arrivals->photons[i];
        memcpy(w->normal, arrivals->normals[i], sizeof w->normal);
        w->place = factor > 0.0f ? (uint32_t)kept : nowhere;
    }
    return PM_OK;
}

/* ---- Neighbourhoods ----------------------------------------------------------------------------- */

/* All photons, those that wait nowhere behind the stock: with the power that each came with. */
typedef struct field {
    pm__storage *storage;
    pm_map *map;
    const leveling *waiting;
    uint32_t *behind;         /* of the waiting, those that are behind the stock */
    size_t count;             /* of all */
    double (*powers)[3];      /* units */
    _Atomic float *most;      /* units, all bands: what it may carry; INFINITY: it is near no important photon */
    pm_neighbor *near;        /* room for MOST */
    unsigned char *whole;     /* 1: chance has no say */
    _Atomic pm_status status;
} field;

static double sum_of(const double power[3])
{
    return power[0] + power[1] + power[2];
}

static const float *normal_of(const field *f, size_t i)
{
    const pm__stock *const stock = &f->storage->stock;
    return i < stock->count ? stock->normals[i] : f->waiting->items[f->behind[i - stock->count]].normal;
}

static bool is_important(const field *f, size_t i)
{
    return i < f->storage->stock.count && f->storage->stock.part[i];
}

static pm_query query_of(const field *f, size_t i, size_t k)
{
    const pm__stock *const stock = &f->storage->stock;
    const pm_photon *const photon =
        i < stock->count ? &stock->photons[i] : &f->waiting->items[f->behind[i - stock->count]].photon;
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, photon->position, sizeof query.position);
    memcpy(query.normal, normal_of(f, i), sizeof query.normal);
    query.k = k < f->count ? k : f->count;
    query.front_only = true;
    query.sorted = false;
    return query;
}

static void bound(const field *f, const pm_neighbor *near, size_t count)
{
    double powers[NEAR];
    if (count < 2)
        return;
    for (size_t i = 0; i < count; i++)
        powers[i] = sum_of(f->powers[pm_map_source(f->map, near[i].number)]);
    const float most = (float)(most_of_median * pm__median(powers, count));
    for (size_t i = 0; i < count; i++) {
        _Atomic float *const of = &f->most[pm_map_source(f->map, near[i].number)];
        float before = atomic_load(of);
        while (most < before && !atomic_compare_exchange_weak(of, &before, most))
            ;
    }
}

static void bound_piece(void *argument, size_t piece)
{
    field *const f = argument;
    const size_t end = (piece + 1) * PIECE < f->storage->stock.count ? (piece + 1) * PIECE : f->storage->stock.count;
    pm_query queries[AT_ONCE] = {{.k = 0}};
    pm_neighbor near[AT_ONCE * NEAR];
    size_t found[AT_ONCE], some = 0;
    for (size_t i = piece * PIECE; i < end; i++) {
        if (is_important(f, i))
            queries[some++] = query_of(f, i, NEAR);
        if (some < AT_ONCE && i + 1 < end)
            continue;
        const pm_status status = some ? pm_map_search_batch(f->map, queries, some, near, NEAR, found) : PM_OK;
        if (status != PM_OK) {
            f->status = status;
            return;
        }
        for (size_t q = 0; q < some; q++)
            bound(f, near + q * NEAR, found[q]);
        some = 0;
    }
}

/* ---- Giving ------------------------------------------------------------------------------------- */

/* What one may receive of i beside what it carries; one that is near nothing important: to what i may carry. */
static double spare_of(const field *f, size_t i, size_t to)
{
    const double most = isfinite(f->most[to]) ? (double)f->most[to] : (double)f->most[i];
    return fmax(0.0, most - sum_of(f->powers[to]));
}

/* May i give to another? Any side of the same part will do in the end: `far`. */
static bool is_alike(const field *f, size_t i, size_t to, bool far)
{
    static const float least_cosine = 0.7f;
    const float *const n = normal_of(f, i), *const m = normal_of(f, to);
    return i != to && is_important(f, i) == is_important(f, to) &&
           (far || n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > least_cosine);
}

/* Gives of i's `excess`, equal parts to those that are alike and may have more, again for what is left. */
static double give(field *f, size_t i, const pm_neighbor *near, size_t count, bool far, double excess)
{
    enum { ROUNDS = 4 };
    const double all = sum_of(f->powers[i]);
    double power[3];
    memcpy(power, f->powers[i], sizeof power);
    for (int round = 0; round < ROUNDS && excess > 0.0; round++) {
        size_t takers = 0;
        for (size_t n = 0; n < count; n++) {
            const size_t to = pm_map_source(f->map, near[n].number);
            takers += is_alike(f, i, to, far) && spare_of(f, i, to) > 0.0;
        }
        const double part = takers ? excess / (double)takers : 0.0;
        for (size_t n = 0; n < count && takers; n++) {
            const size_t to = pm_map_source(f->map, near[n].number);
            const double given = is_alike(f, i, to, far) ? fmin(fmin(part, spare_of(f, i, to)), excess) : 0.0;
            if (!(given > 0.0))
                continue;
            f->whole[to] = 1;
            for (int b = 0; b < 3; b++) {
                f->powers[to][b] += given / all * power[b];
                f->powers[i][b] -= given / all * power[b];
            }
            excess -= given;
        }
    }
    return excess;
}

static pm_status relieve(field *f, size_t i)
{
    enum { STEPS = 5 };
    static const size_t steps[STEPS] = {8, 32, 128, 512, MOST};
    static const double nothing = 1e-9;
    const double has = sum_of(f->powers[i]);
    double excess = has - (double)f->most[i];
    for (int step = 0; step < STEPS && excess > nothing * has; step++) {
        size_t found = 0;
        const pm_query query = query_of(f, i, steps[step]);
        const pm_status status = pm_map_search(f->map, &query, f->near, MOST, &found);
        if (status != PM_OK)
            return status;
        excess = give(f, i, f->near, found, step == STEPS - 1, excess);
    }
    return PM_OK;
}

/* ---- All of it ---------------------------------------------------------------------------------- */

static void set_up(field *f, pm_photon *photons)
{
    const pm__stock *const stock = &f->storage->stock;
    const leveling *const l = f->waiting;
    f->count = stock->count;
    memcpy(photons, stock->photons, stock->count * sizeof *photons);
    for (size_t i = 0; i < l->count; i++) {
        const uint32_t place = l->items[i].place;
        if (place == nowhere)
            f->behind[f->count - stock->count] = (uint32_t)i;
        photons[place == nowhere ? f->count++ : (size_t)place] = l->items[i].photon;
    }
    for (size_t i = 0; i < f->count; i++)
        for (int b = 0; b < 3; b++)
            f->powers[i][b] = (double)photons[i].power[b];
}

static pm_status find_bounds(field *f)
{
    for (size_t i = 0; i < f->count; i++)
        atomic_init(&f->most[i], INFINITY);
    pm__for(f->storage->config->parallel, (f->storage->stock.count + PIECE - 1) / PIECE, bound_piece, f);
    for (size_t i = 0; i < f->count; i++)
        f->whole[i] = f->whole[i] || isfinite(f->most[i]);
    return f->status;
}

static pm_status create(field *f)
{
    const pm__storage *const s = f->storage;
    const size_t most = s->stock.count + f->waiting->count;
    const pm_map_options options = {.parallel = s->config->parallel};
    pm_photon *const photons = pm__alloc(most, sizeof *photons);
    f->behind = pm__alloc(most, sizeof *f->behind);
    f->powers = pm__alloc(most, sizeof *f->powers);
    f->most = pm__alloc(most, sizeof *f->most);
    f->whole = pm__alloc_zero(most, 1);
    f->near = pm__alloc(MOST, sizeof *f->near);
    pm_status status = photons && f->behind && f->powers && f->most && f->whole && f->near ? PM_OK : PM_ENOMEM;
    if (status == PM_OK) {
        set_up(f, photons);
        status = pm_map_create(photons, f->count, &options, &f->map, s->error);
    }
    free(photons);
    return status;
}

static void set_power(pm_photon *photon, const double power[3])
{
    for (int b = 0; b < 3; b++)
        photon->power[b] = (float)fmax(0.0, power[b]);
}

/* Chance has its say about those that are near nothing important. */
static pm_status put_back(field *f)
{
    pm__stock *const stock = &f->storage->stock;
    const size_t before = stock->count;
    size_t more = 0;
    unsigned char *const by_chance = pm__alloc_zero(before, 1);
    for (size_t i = before; i < f->count; i++)
        more += f->whole[i];
    if (!by_chance || pm__stock_reserve(stock, more)) {
        free(by_chance);
        return PM_ENOMEM;
    }
    for (size_t i = 0; i < f->waiting->count; i++)
        if (f->waiting->items[i].place != nowhere)
            by_chance[f->waiting->items[i].place] = 1;
    for (size_t i = f->storage->settled; i < before; i++)
        if (!by_chance[i] || f->whole[i])
            set_power(&stock->photons[i], f->powers[i]);
    for (size_t i = before; i < f->count; i++) {
        const waiting *const w = &f->waiting->items[f->behind[i - before]];
        pm_photon photon = w->photon;
        if (!f->whole[i])
            continue;
        set_power(&photon, f->powers[i]);
        pm__stock_add(stock, &photon, w->normal, false);
    }
    free(by_chance);
    return PM_OK;
}

/* Giving changes medians: they rise by what is received, and fall where those above them give to others. */
static pm_status level(field *f)
{
    enum { TIMES = 6 };
    static const double slack = 1.001;
    bool again = true;
    pm_status status = PM_OK;
    for (int time = 0; time < TIMES && again && status == PM_OK; time++) {
        again = false;
        status = find_bounds(f);
        for (size_t i = f->storage->settled; i < f->count && status == PM_OK; i++)
            if (sum_of(f->powers[i]) > slack * (double)f->most[i]) {
                again = true;
                status = relieve(f, i);
            }
    }
    return status;
}

pm_status pm__level_end(pm__storage *storage)
{
    field f = {.storage = storage, .waiting = storage->own};
    if (!storage->stock.count)
        return PM_OK;
    pm_status status = create(&f);
    if (status == PM_OK)
        status = level(&f);
    if (status == PM_OK)
        status = put_back(&f);
    pm_map_destroy(f.map);
    free(f.behind);
    free(f.powers);
    free(f.most);
    free(f.whole);
    free(f.near);
    return status;
}
