#include "strays.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "send_strata.h"
#include "stray_places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Powers to those of photons sent evenly: beyond it one is a stray, and what its parts carry at most. */
static const double most_load = 2.4;

/* Photons of one task, and strays. */
enum { PIECE = 2048, STRAYS = 64 };

/* ---- Which are ---------------------------------------------------------------------------------- */

/* Of a photon sent evenly as it leaves, in units. */
static double even_power(const pm__storage *storage)
{
    return storage->emission.total / storage->unit * (double)storage->planned / (double)storage->config->emitted;
}

static float power_of(const pm_photon *photon)
{
    return photon->power[0] + photon->power[1] + photon->power[2];
}

static bool has_strays(const pm__storage *storage)
{
    return storage->sender->heaviest > most_load && pm__policy_value(storage, "strays", 0.0) != 1.0;
}

/* Of `count` photons those of more than `most`, in their order. */
typedef struct sifting {
    const pm_photon *photons;
    const unsigned char *part; /* NULL: in all places, else in important ones alone */
    size_t count;
    float most;
    size_t *starts;            /* of each piece: how many, then where they are listed */
    size_t *listed;
    size_t base;               /* of the numbers that are listed */
} sifting;

static bool is_stray(const sifting *s, size_t i)
{
    return power_of(&s->photons[i]) > s->most && (!s->part || s->part[i]);
}

static void count_piece(void *argument, size_t piece)
{
    const sifting *const s = argument;
    const size_t end = pm__piece_end(piece, PIECE, s->count);
    size_t count = 0;
    for (size_t i = piece * PIECE; i < end; i++)
        count += is_stray(s, i);
    s->starts[piece] = count;
}

static void list_piece(void *argument, size_t piece)
{
    const sifting *const s = argument;
    const size_t end = pm__piece_end(piece, PIECE, s->count);
    size_t at = s->starts[piece];
    const size_t behind = s->starts[piece + 1];
    for (size_t i = piece * PIECE; i < end && at < behind; i++)
        if (is_stray(s, i))
            s->listed[at++] = s->base + i;
}

/* Behind those of `list`. */
static pm_status sift(const pm_parallel *parallel, sifting *s, size_t **list, size_t *count, size_t *room)
{
    const size_t pieces = pm__pieces(s->count, PIECE);
    size_t sum = *count;
    s->starts = pm__alloc(pieces + 1, sizeof *s->starts);
    if (!s->starts)
        return PM_ENOMEM;
    pm__for(parallel, pieces, count_piece, s);
    for (size_t piece = 0; piece <= pieces; piece++) {
        const size_t own = piece < pieces ? s->starts[piece] : 0;
        s->starts[piece] = sum;
        sum += own;
    }
    pm_status status = PM_OK;
    if (sum > *count) {
        status = pm__grow((void **)list, room, sum, sizeof **list) ? PM_ENOMEM : PM_OK;
        s->listed = *list;
        if (status == PM_OK)
            pm__for(parallel, pieces, list_piece, s);
    }
    *count = status == PM_OK ? sum : *count;
    free(s->starts);
    return status;
}

pm_status pm__note_strays(pm__storage *storage, size_t first)
{
    pm__sender *const sender = storage->sender;
    const pm__stock *const stock = &storage->stock;
    sifting s = {.photons = stock->photons + first, .count = stock->count - first,
                 .most = (float)(most_load * even_power(storage)), .base = first};
    if (!s.count || !has_strays(storage))
        return PM_OK;
    return sift(storage->config->parallel, &s, &sender->places, &sender->place_count, &sender->place_room);
}

pm_status pm__note_paths(pm__storage *storage, const pm__arrivals *arrivals, size_t first)
{
    pm__sender *const sender = storage->sender;
    const size_t settled = storage->settled, count = storage->stock.count - first;
    if (storage->config->stored == SIZE_MAX || !has_strays(storage))
        return PM_OK;
    if (pm__grow((void **)&sender->paths, &sender->path_room, first + count - settled, sizeof *sender->paths))
        return PM_ENOMEM;
    for (size_t i = 0; i < count; i++)
        sender->paths[first - settled + i] = arrivals->first + arrivals->numbers[i];
    return PM_OK;
}

/* ---- Put aside ---------------------------------------------------------------------------------- */

pm__stray pm__stray_of(const pm__storage *storage, const pm_photon *photon, const float normal[3], bool important)
{
    pm__stray stray = {.photon = *photon, .important = important};
    memcpy(stray.normal, normal, sizeof stray.normal);
    stray.parts = (size_t)ceil((double)power_of(photon) / (most_load * even_power(storage)) - 1e-6);
    return stray;
}

static pm_status put_aside(pm__storage *storage, const pm__arrivals *arrivals, const size_t *listed, size_t count,
                           size_t taken)
{
    pm__sender *const sender = storage->sender;
    if (pm__grow((void **)&sender->strays, &sender->stray_room, sender->stray_count + count, sizeof *sender->strays))
        return PM_ENOMEM;
    for (size_t i = 0; i < count && listed[i] < taken; i++)
        sender->strays[sender->stray_count++] =
            pm__stray_of(storage, &arrivals->photons[listed[i]], arrivals->normals[listed[i]],
                         arrivals->part[listed[i]]);
    return PM_OK;
}

pm_status pm__keep_but_strays(pm__storage *storage, const pm__arrivals *arrivals, pm__keep keep, size_t *taken)
{
    pm__arrivals others = *arrivals;
    sifting s = {.photons = arrivals->photons, .part = arrivals->part, .count = arrivals->count,
                 .most = (float)(most_load * even_power(storage))};
    size_t *listed = NULL, count = 0, room = 0;
    if (!has_strays(storage))
        return keep(storage, arrivals, taken);
    pm_status status = sift(storage->config->parallel, &s, &listed, &count, &room);
    unsigned char *const aside = status == PM_OK && count ? pm__alloc_zero(arrivals->count, sizeof *aside) : NULL;
    if (status == PM_OK && count && !aside)
        status = PM_ENOMEM;
    for (size_t i = 0; i < count && aside; i++)
        aside[listed[i]] = 1;
    others.aside = aside;
    if (status == PM_OK)
        status = keep(storage, &others, taken);
    if (status == PM_OK && count)
        status = put_aside(storage, arrivals, listed, count, *taken);
    free(aside);
    free(listed);
    return status;
}

/* ---- Shared out ---------------------------------------------------------------------------------- */

typedef struct splitting {
    pm__storage *storage;
    const pm__stray_places *places;
    size_t *behind; /* of each stray: in the stock, its parts but the first */
} splitting;

/* Its first part stays where it is. */
static void split(const splitting *s, size_t i)
{
    const pm__stray *const stray = &s->places->strays[i];
    const uint32_t *const alike = s->places->alike + s->places->first[i];
    pm__stock *const stock = &s->storage->stock;
    const size_t count = s->places->count[i];
    pm_photon part = stray->photon;
    for (int b = 0; b < 3; b++)
        stock->photons[stray->place].power[b] = part.power[b] = stray->photon.power[b] / (float)stray->parts;
    for (size_t p = 1; p < stray->parts; p++) {
        const size_t who = count ? alike[p % count] : stray->place;
        memcpy(part.position, stock->photons[who].position, sizeof part.position);
        pm__stock_put(stock, s->behind[i] + p - 1, &part, stock->normals[who], stray->important);
    }
}

static void split_some(void *argument, size_t block)
{
    const splitting *const s = argument;
    const size_t end = pm__piece_end(block, STRAYS, s->places->stray_count);
    for (size_t i = block * STRAYS; i < end; i++)
        split(s, i);
}

/* Parts but the first of each. */
static size_t more_of(const pm__stray_places *places)
{
    size_t more = 0;
    for (size_t i = 0; i < places->stray_count; i++)
        more += places->strays[i].parts - 1;
    return more;
}

static pm_status split_all(pm__storage *storage, const pm__stray_places *places)
{
    size_t more = 0;
    splitting s = {storage, places, pm__alloc(places->stray_count, sizeof *s.behind)};
    for (size_t i = 0; i < places->stray_count && s.behind; i++) {
        s.behind[i] = storage->stock.count + more;
        more += places->strays[i].parts - 1;
    }
    const pm_status status = s.behind && !pm__stock_reserve(&storage->stock, more) ? PM_OK : PM_ENOMEM;
    if (status == PM_OK) {
        pm__for(storage->config->parallel, pm__pieces(places->stray_count, STRAYS), split_some, &s);
        storage->stock.count += more;
    }
    free(s.behind);
    return status;
}

/* The stock is that of the paths before photon `end`. */
static void take_back(pm__storage *storage, size_t end, bool one_is_enough)
{
    pm__sender *const sender = storage->sender;
    pm__stock *const stock = &storage->stock;
    pm__account *const account = &storage->account;
    const size_t settled = storage->settled;
    *account = (pm__account){.arrived = end - settled};
    pm__account_end(account, sender->paths[end - settled], one_is_enough);
    pm__add_powers(stock->photons + settled, stock->part + settled, end - settled, account->came);
    stock->count = end;
    while (sender->place_count > 0 && sender->places[sender->place_count - 1] >= end)
        sender->place_count--;
}

/* Where the paths end by which, each with its parts, as many as are wanted are there: as pm__stock_taken has it, so
 * that paths are still equally likely in all orders (errata 37). */
static size_t end_with_parts(const pm__storage *storage, const pm__stray_places *places, bool *one_is_enough)
{
    const size_t settled = storage->settled, wanted = storage->config->stored;
    const uint64_t *const paths = storage->sender->paths;
    size_t sum = settled, begin = settled, next = 0; /* of the path in hand; of the strays */
    *one_is_enough = false;
    for (size_t i = settled; i < storage->stock.count; i++) {
        if (i > settled && paths[i - settled] != paths[i - settled - 1]) {
            begin = i;
            *one_is_enough = sum >= wanted;
        }
        if (*one_is_enough)
            return i;
        sum += next < places->stray_count && places->strays[next].place == i ? places->strays[next++].parts : 1;
        if (sum >= wanted && paths[i - settled] > 0)
            return begin;
    }
    return storage->stock.count;
}

/* Are there too many with the parts? */
static bool is_taken_back(pm__storage *storage, const pm__stray_places *places)
{
    const size_t count = storage->stock.count, wanted = storage->config->stored;
    bool one_is_enough;
    if (wanted == SIZE_MAX || count + more_of(places) <= wanted)
        return false;
    const size_t end = end_with_parts(storage, places, &one_is_enough);
    if (end < count)
        take_back(storage, end, one_is_enough);
    return end < count;
}

/* With fewer photons lookups reach farther, to more strays: so again. */
pm_status pm__split_strays(pm__storage *storage)
{
    bool again = true;
    pm_status status = PM_OK;
    while (again && status == PM_OK && storage->sender && storage->sender->place_count) {
        pm__stray_places places;
        status = pm__find_near_importance(storage, &places);
        again = status == PM_OK && is_taken_back(storage, &places);
        if (status == PM_OK && !again)
            status = split_all(storage, &places);
        pm__stray_places_free(&places);
    }
    return status;
}

static void give(pm__stock *stock, const pm__stray *stray, const uint32_t *alike, size_t count)
{
    for (size_t p = 0; p < count; p++)
        for (int b = 0; b < 3; b++)
            stock->photons[alike[p]].power[b] += stray->photon.power[b] / (float)count;
    if (!count)
        pm__stock_add(stock, &stray->photon, stray->normal, stray->important);
}

pm_status pm__give_strays(pm__storage *storage)
{
    pm__stray_places places;
    if (!storage->sender || !storage->sender->stray_count)
        return PM_OK;
    pm_status status = pm__find_near_strays(storage, &places);
    if (status == PM_OK && pm__stock_reserve(&storage->stock, places.stray_count))
        status = PM_ENOMEM;
    for (size_t i = 0; i < places.stray_count && status == PM_OK; i++)
        give(&storage->stock, &places.strays[i], places.alike + places.first[i], places.count[i]);
    pm__stray_places_free(&places);
    return status;
}
