#include "strays.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "send_strata.h"
#include "surroundings.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Powers to those of photons sent evenly: beyond it one is a stray, and what its parts carry at most. */
static const double most_load = 2.4;

/* ---- Put aside ---------------------------------------------------------------------------------- */

/* Of a photon sent evenly as it leaves, in units. */
static double even_power(const pm__storage *storage)
{
    return storage->emission.total / storage->unit * (double)storage->planned / (double)storage->config->emitted;
}

static float power_of(const pm_photon *photon)
{
    return photon->power[0] + photon->power[1] + photon->power[2];
}

/* Marks them, and says how many. */
static size_t mark_strays(const pm__storage *storage, const pm__arrivals *arrivals, bool everywhere,
                          unsigned char *aside)
{
    const float most = (float)(most_load * even_power(storage));
    size_t strays = 0;
    for (size_t i = 0; i < arrivals->count; i++) {
        aside[i] = power_of(&arrivals->photons[i]) > most && (everywhere || arrivals->part[i]);
        strays += aside[i];
    }
    return strays;
}

static pm_status put_aside(pm__storage *storage, const pm__arrivals *arrivals, const unsigned char *aside, size_t taken,
                           size_t strays)
{
    pm__sender *const sender = storage->sender;
    const float even = (float)even_power(storage);
    if (pm__grow((void **)&sender->strays, &sender->stray_room, sender->stray_count + strays, sizeof *sender->strays))
        return PM_ENOMEM;
    for (size_t i = 0; i < taken; i++) {
        if (!aside[i])
            continue;
        pm__stray *const stray = &sender->strays[sender->stray_count++];
        stray->photon = arrivals->photons[i];
        memcpy(stray->normal, arrivals->normals[i], sizeof stray->normal);
        stray->load = power_of(&stray->photon) / even;
        stray->important = arrivals->part[i];
    }
    return PM_OK;
}

pm_status pm__keep_but_strays(pm__storage *storage, const pm__arrivals *arrivals, pm__keep keep, bool everywhere,
                              size_t *taken)
{
    pm__arrivals others = *arrivals;
    if (!(storage->sender->heaviest > most_load) || pm__policy_value(storage, "strays", 0.0) == 1.0)
        return keep(storage, arrivals, taken);
    unsigned char *const aside = pm__alloc(arrivals->count, sizeof *aside);
    pm_status status = aside ? PM_OK : PM_ENOMEM;
    if (status == PM_OK) {
        const bool counted = storage->config->stored < SIZE_MAX;
        const size_t strays = mark_strays(storage, arrivals, everywhere && !counted, aside);
        others.aside = strays ? aside : NULL;
        status = keep(storage, &others, taken);
        if (status == PM_OK && strays)
            status = put_aside(storage, arrivals, aside, *taken, strays);
    }
    free(aside);
    return status;
}

/* ---- Whom they meet ----------------------------------------------------------------------------- */

enum { PIECE = 64, MOST = 256 };

/* Photons near important ones: of the stock, numbers below `stored`, and strays behind them. */
typedef struct meeting {
    pm__storage *storage;
    const pm__stray *strays;
    size_t stored, stray_count;
    bool splits;            /* strays, else their power is given to photons of the stock */
    size_t *parts;          /* of each stray: 1 where it may stay as it is */
    size_t *places;         /* in the stock, of the first part */
    pm_map *map;
    uint32_t *who;          /* by the map's source */
    size_t count;
    _Atomic pm_status status;
} meeting;

static const pm_photon *photon_of(const meeting *m, size_t who)
{
    return who < m->stored ? &m->storage->stock.photons[who] : &m->strays[who - m->stored].photon;
}

static const float *normal_of(const meeting *m, size_t who)
{
    return who < m->stored ? m->storage->stock.normals[who] : m->strays[who - m->stored].normal;
}

static bool is_important(const meeting *m, size_t who)
{
    return who < m->stored ? m->storage->stock.part[who] : m->strays[who - m->stored].important;
}

/* false: nothing is important. */
static bool find_box(const meeting *m, float low[3], float high[3])
{
    bool any = false;
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (size_t who = 0; who < m->stored + m->stray_count; who++) {
        if (!is_important(m, who))
            continue;
        any = true;
        for (int a = 0; a < 3; a++) {
            low[a] = fminf(low[a], photon_of(m, who)->position[a]);
            high[a] = fmaxf(high[a], photon_of(m, who)->position[a]);
        }
    }
    return any;
}

static pm_status find_surroundings(const meeting *m, pm__surroundings *near)
{
    const size_t all = m->stored + m->stray_count;
    float low[3], high[3];
    *near = (pm__surroundings){.per_edge = 0.0f};
    if (!find_box(m, low, high))
        return PM_OK;
    if (pm__surroundings_create(low, high, near))
        return PM_ENOMEM;
    for (size_t who = 0; who < all; who++)
        pm__surroundings_count(near, photon_of(m, who)->position);
    pm__surroundings_gather(near);
    for (size_t who = 0; who < all; who++)
        if (is_important(m, who))
            pm__surroundings_mark(near, photon_of(m, who)->position);
    pm__surroundings_spread(near);
    return PM_OK;
}

/* All that are near, and into how many parts strays are split. */
static pm_status choose(meeting *m, const pm__surroundings *near, pm_photon *photons)
{
    const size_t all = m->stored + (m->splits ? m->stray_count : 0);
    for (size_t i = 0; i < m->stray_count; i++) {
        const pm__stray *const stray = &m->strays[i];
        const bool split = near->counts && pm__surroundings_hold(near, stray->photon.position);
        m->parts[i] = split ? (size_t)ceil((double)stray->load / most_load - 1e-6) : 1;
    }
    for (size_t who = m->storage->settled; who < all && near->counts; who++)
        if (pm__surroundings_hold(near, photon_of(m, who)->position)) {
            photons[m->count] = *photon_of(m, who);
            m->who[m->count++] = (uint32_t)who;
        }
    const pm_map_options options = {.parallel = m->storage->config->parallel};
    return m->count ? pm_map_create(photons, m->count, &options, &m->map, m->storage->error) : PM_OK;
}

static pm_status meet(meeting *m)
{
    const size_t all = m->stored + m->stray_count;
    pm__surroundings near;
    m->parts = pm__alloc(m->stray_count, sizeof *m->parts);
    m->places = pm__alloc(m->stray_count, sizeof *m->places);
    m->who = pm__alloc(all, sizeof *m->who);
    pm_photon *const photons = pm__alloc(all, sizeof *photons);
    pm_status status = m->parts && m->places && m->who && photons ? find_surroundings(m, &near) : PM_ENOMEM;
    if (status == PM_OK) {
        status = choose(m, &near, photons);
        pm__surroundings_free(&near);
    }
    free(photons);
    return status;
}

/* ---- Split -------------------------------------------------------------------------------------- */

/* May a part of the stray lie where this one does? */
static bool is_alike(const meeting *m, const pm__stray *stray, size_t who)
{
    static const float least_cosine = 0.7f;
    const float *const n = normal_of(m, who), *const own = stray->normal, *const d = stray->photon.direction;
    return is_important(m, who) == stray->important && n[0] * own[0] + n[1] * own[1] + n[2] * own[2] > least_cosine &&
           n[0] * d[0] + n[1] * d[1] + n[2] * d[2] < 0.0f;
}

/* Up to `wanted` of its nearest. */
static pm_status find_alike(const meeting *m, const pm__stray *stray, size_t wanted, uint32_t *alike, size_t *count)
{
    pm_neighbor near[MOST];
    size_t found = 0;
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, stray->photon.position, sizeof query.position);
    memcpy(query.normal, stray->normal, sizeof query.normal);
    query.k = 2 * wanted + 6 < MOST ? 2 * wanted + 6 : MOST;
    query.k = query.k < m->count ? query.k : m->count;
    query.front_only = true;
    *count = 0;
    const pm_status status = m->count ? pm_map_search(m->map, &query, near, MOST, &found) : PM_OK;
    for (size_t i = 0; i < found && *count < wanted && status == PM_OK; i++) {
        const uint32_t who = m->who[pm_map_source(m->map, near[i].number)];
        if (is_alike(m, stray, who))
            alike[(*count)++] = who;
    }
    return status;
}

static void store_at(pm__stock *stock, size_t at, const pm_photon *photon, const float normal[3], bool important)
{
    stock->photons[at] = *photon;
    memcpy(stock->normals[at], normal, sizeof stock->normals[at]);
    stock->part[at] = important;
}

/* Its parts as photons, each where another lies. */
static pm_status split(meeting *m, size_t i)
{
    const pm__stray *const stray = &m->strays[i];
    const size_t parts = m->parts[i];
    uint32_t alike[MOST];
    size_t count = 0;
    const pm_status status = parts > 1 ? find_alike(m, stray, parts < MOST ? parts : MOST, alike, &count) : PM_OK;
    pm_photon part = stray->photon;
    for (int b = 0; b < 3; b++)
        part.power[b] /= (float)parts;
    for (size_t p = 0; p < parts && status == PM_OK; p++) {
        const float *const normal = count ? normal_of(m, alike[p % count]) : stray->normal;
        if (count)
            memcpy(part.position, photon_of(m, alike[p % count])->position, sizeof part.position);
        store_at(&m->storage->stock, m->places[i] + p, &part, normal, stray->important);
    }
    return status;
}

/* Its power in parts to those that are stored; to nobody: itself. */
static pm_status give(meeting *m, size_t i)
{
    const pm__stray *const stray = &m->strays[i];
    pm__stock *const stock = &m->storage->stock;
    uint32_t alike[MOST];
    size_t count = 0;
    const pm_status status = find_alike(m, stray, m->parts[i] < MOST ? m->parts[i] : MOST, alike, &count);
    for (size_t p = 0; p < count; p++)
        for (int b = 0; b < 3; b++)
            stock->photons[alike[p]].power[b] += stray->photon.power[b] / (float)count;
    if (!count && status == PM_OK)
        store_at(stock, stock->count++, &stray->photon, stray->normal, stray->important);
    return status;
}

static void split_piece(void *argument, size_t piece)
{
    meeting *const m = argument;
    const size_t end = (piece + 1) * PIECE < m->stray_count ? (piece + 1) * PIECE : m->stray_count;
    for (size_t i = piece * PIECE; i < end; i++) {
        const pm_status status = split(m, i);
        if (status != PM_OK)
            atomic_store(&m->status, status);
    }
}

static pm_status split_all(meeting *m)
{
    pm__stock *const stock = &m->storage->stock;
    size_t more = 0;
    for (size_t i = 0; i < m->stray_count; i++) {
        m->places[i] = stock->count + more;
        more += m->parts[i];
    }
    if (pm__stock_reserve(stock, more))
        return PM_ENOMEM;
    pm__for(m->storage->config->parallel, (m->stray_count + PIECE - 1) / PIECE, split_piece, m);
    stock->count += more;
    return m->status;
}

static pm_status give_all(meeting *m)
{
    pm_status status = pm__stock_reserve(&m->storage->stock, m->stray_count);
    for (size_t i = 0; i < m->stray_count && status == PM_OK; i++)
        status = give(m, i);
    return status;
}

pm_status pm__place_strays(pm__storage *storage, bool split)
{
    const pm__sender *const sender = storage->sender;
    if (!sender || !sender->stray_count)
        return PM_OK;
    meeting m = {.storage = storage, .strays = sender->strays, .stored = storage->stock.count,
                 .stray_count = sender->stray_count, .splits = split && storage->config->stored == SIZE_MAX};
    pm_status status = meet(&m);
    if (status == PM_OK)
        status = m.splits ? split_all(&m) : give_all(&m);
    pm_map_destroy(m.map);
    free(m.parts);
    free(m.places);
    free(m.who);
    return status;
}
