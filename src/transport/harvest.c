/* Threads take blocks of paths in the order of their numbers. Where a block's photons go among all is known once all
 * blocks before it are traced: whoever finishes a block copies its photons there, and those of the blocks that had
 * waited for it. So nobody waits for a slower thread, and what a block stored is in the cache when it is copied. */
#include "harvest.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <float.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Paths in a block; blocks that may be traced while an earlier one is not. */
enum { BLOCK = 512, WINDOW = 256 };

/* Paths for each photon that is stored, and for the first ten, before it is given up. */
enum { PATIENCE = 100000 };

/* Photons at most that are made room for before it is known how many a path stores. */
enum { FIRST_ROOM = 1 << 20 };

typedef struct record {
    pm_photon photon;
    float normal[3];
    uint16_t mark, path; /* path: its number in the block */
} record;

typedef struct block {
    const pm__harvest_wish *wish;
    double unit, scale;  /* scale: 1 / unit */
    uint64_t number;     /* among all blocks */
    record *records;
    size_t count, capacity;
    size_t enough;       /* photons: what a path stores beyond is not looked at */
    size_t first, taken; /* where its photons go among all, and how many of them */
    double refused;      /* W: EINVAL, a power that no float holds */
    pm_status status;
    struct block *next;  /* in a list of blocks */
} block;

typedef struct gathering {
    const pm__shoot_config *config;
    const pm__harvest_wish *wish;
    pm__harvest *harvest;
    size_t room;            /* photons that its arrays hold */
    pthread_mutex_t lock;   /* of what follows, and of the harvest's numbers */
    uint64_t begun, placed; /* blocks; the latter have their place at least */
    block *traced[WINDOW];  /* those between that wait for it, by number */
    block *idle;
    bool stopped;           /* it is all over, or there is no room */
    pm_status status;
    double refused;
} gathering;

/* ---- A block's paths ------------------------------------------------------------------------- */

static uint64_t first_path(const block *b)
{
    return b->wish->first + b->number * BLOCK;
}

static uint64_t end_of(const block *b)
{
    const uint64_t end = (b->number + 1) * BLOCK;
    return end < b->wish->most ? end : b->wish->most;
}

/* In units as long as no share is known, and by way of them where it is: the same bits either way. */
static bool take_power(block *b, const double power[3], float taken[3])
{
    for (int i = 0; i < 3; i++) {
        taken[i] = (float)(power[i] * b->scale);
        if (b->wish->share > 0.0) {
            b->refused = (double)taken[i] * b->unit * b->wish->share;
            if (!(b->refused <= (double)FLT_MAX))
                return false;
            taken[i] = (float)b->refused;
        }
    }
    return true;
}

static bool keep(void *context, uint64_t number, const pm__stored *stored)
{
    block *const b = context;
    const uint16_t path = (uint16_t)(number - first_path(b));
    if (b->count >= b->enough && b->records[b->count - 1].path != path)
        return false;
    void *records = b->records;
    if (pm__grow(&records, &b->capacity, b->count + 1, sizeof *b->records)) {
        b->status = PM_ENOMEM;
        return false;
    }
    b->records = records;
    record *const to = &b->records[b->count];
    if (!take_power(b, stored->power, to->photon.power)) {
        b->status = PM_EINVAL;
        return false;
    }
    to->path = path;
    to->mark = stored->power[0] > 0.0 || stored->power[1] > 0.0 || stored->power[2] > 0.0 ? 0 : PM__NO_POWER;
    for (int i = 0; i < 3; i++) {
        to->photon.position[i] = (float)stored->position[i];
        to->photon.direction[i] = (float)stored->direction[i];
        to->normal[i] = (float)stored->normal[i];
    }
    b->count++;
    return true;
}

/* The end of the path that photon i is of. */
static size_t path_end(const block *b, size_t i)
{
    const uint16_t path = b->records[i].path;
    while (i < b->count && b->records[i].path == path)
        i++;
    return i;
}

static void mark_paths(block *b)
{
    for (size_t i = 0, end; i < b->count; i = end) {
        end = path_end(b, i);
        for (size_t j = i; j < end; j++)
            b->records[j].mark |= (uint16_t)((j == i ? PM__FIRST_OF_PATH : 0) | (int)(end - i));
    }
}

static void trace_block(const gathering *g, block *b)
{
    b->count = 0;
    b->status = PM_OK;
    if (g->config->canceled && g->config->canceled(g->config->context))
        b->status = PM_ECANCELED;
    else
        g->wish->tracer(g->wish->tracing, first_path(b), end_of(b) - b->number * BLOCK, keep, b);
    if (g->wish->marks)
        mark_paths(b);
}

static void place_block(const gathering *g, const block *b)
{
    pm__harvest *const h = g->harvest;
    for (size_t i = 0; i < b->taken; i++) {
        const record *const r = &b->records[i];
        h->photons[b->first + i] = r->photon;
        if (h->normals)
            memcpy(h->normals[b->first + i], r->normal, sizeof r->normal);
        if (h->marks)
            h->marks[b->first + i] = r->mark;
        if (h->numbers)
            h->numbers[b->first + i] = (uint32_t)(b->number * BLOCK + r->path);
    }
}

static void free_block(block *b)
{
    if (b)
        free(b->records);
    free(b);
}

/* ---- Blocks in their order ------------------------------------------------------------------- */

static bool is_over(const gathering *g)
{
    const pm__harvest *const h = g->harvest;
    const size_t wanted = g->wish->wanted;
    const bool in_vain = wanted != SIZE_MAX && (double)h->emitted > (double)PATIENCE * ((double)h->count + 10.0);
    return g->status != PM_OK || h->count >= wanted || h->emitted >= g->wish->most || in_vain;
}

/* The next block in order has its place, up to the end of the path by which there are enough photons. false: it has an
 * error, or there is no room. */
static bool give_place(gathering *g, block *b)
{
    pm__harvest *const h = g->harvest;
    const size_t lacking = g->wish->wanted - h->count;
    g->status = b->status;
    g->refused = b->refused;
    b->taken = b->count < lacking ? b->count : path_end(b, lacking - 1);
    if (b->status != PM_OK || b->taken > g->room - h->count)
        return false;
    b->first = h->count;
    h->count += b->taken;
    h->emitted = b->count < lacking ? end_of(b) : b->number * BLOCK + b->records[b->taken - 1].path + 1;
    g->placed++;
    return true;
}

/* Blocks that have their place now. */
static block *take_traced(gathering *g)
{
    block *list = NULL;
    while (!g->stopped && g->traced[g->placed % WINDOW]) {
        block **const from = &g->traced[g->placed % WINDOW], *const b = *from;
        if (give_place(g, b)) {
            *from = NULL;
            b->next = list;
            list = b;
            g->stopped = is_over(g);
        } else {
            g->stopped = true;
        }
    }
    return list;
}

/* A traced block is handed in; NULL: only those are looked at that wait. */
static void finish_block(gathering *g, block *b)
{
    (void)pthread_mutex_lock(&g->lock);
    if (b)
        g->traced[b->number % WINDOW] = b;
    block *list = take_traced(g), *last = list;
    (void)pthread_mutex_unlock(&g->lock);
    if (!list)
        return;
    for (block *at = list; at; last = at, at = at->next)
        place_block(g, at);
    (void)pthread_mutex_lock(&g->lock);
    last->next = g->idle;
    g->idle = list;
    (void)pthread_mutex_unlock(&g->lock);
}

static uint64_t blocks_left(const gathering *g)
{
    const uint64_t all = g->wish->most / BLOCK + (g->wish->most % BLOCK > 0);
    return all - g->begun;
}

/* NULL: none is to be traced now. */
static block *begin_block(gathering *g)
{
    block *b = NULL;
    (void)pthread_mutex_lock(&g->lock);
    if (!g->stopped && g->begun - g->placed < WINDOW && blocks_left(g) > 0) {
        b = g->idle ? g->idle : pm__alloc_zero(1, sizeof *b);
        g->idle = b ? b->next : NULL;
        if (b) {
            b->wish = g->wish;
            b->unit = g->harvest->unit;
            b->scale = 1.0 / b->unit;
            b->number = g->begun++;
            b->enough = g->wish->wanted - g->harvest->count;
        } else {
            g->status = PM_ENOMEM;
            g->stopped = true;
        }
    }
    (void)pthread_mutex_unlock(&g->lock);
    return b;
}

/* One block: not that of the index, since which are held back must not depend on the order of indices. */
static void work(void *argument, size_t index)
{
    gathering *const g = argument;
    block *const b = begin_block(g);
    (void)index;
    if (!b)
        return;
    trace_block(g, b);
    finish_block(g, b);
}

/* ---- All of them ----------------------------------------------------------------------------- */

/* Room for so many photons, or more. */
static pm_status reserve(gathering *g, size_t count)
{
    pm__harvest *const h = g->harvest;
    size_t rooms[4] = {g->room, g->room, g->room, g->room};
    if (pm__grow((void **)&h->photons, &rooms[0], count, sizeof *h->photons) ||
        (g->config->normals && pm__grow((void **)&h->normals, &rooms[1], count, sizeof *h->normals)) ||
        (g->wish->marks && pm__grow((void **)&h->marks, &rooms[2], count, sizeof *h->marks)) ||
        (g->wish->numbers && pm__grow((void **)&h->numbers, &rooms[3], count, sizeof *h->numbers)))
        return PM_ENOMEM;
    g->room = rooms[0];
    return PM_OK;
}

/* Room for all photons: as many as are wanted, or as the paths store after a sixteenth or so to learn how many that
 * is. What is not used is not touched, and so costs nothing. */
static pm_status make_room(gathering *g)
{
    const pm__harvest *const h = g->harvest;
    const block *const next = g->traced[g->placed % WINDOW];
    if (g->wish->wanted != SIZE_MAX)
        return reserve(g, g->wish->wanted + PM__LONGEST_PATH);
    if (g->room == 0)
        return reserve(g, (size_t)fmin((double)g->wish->most / 16.0, FIRST_ROOM) + PM__LONGEST_PATH);
    if (!next)
        return PM_OK;
    const double all = 1.05 * (double)h->count * (double)g->wish->most / fmax((double)h->emitted, 1.0);
    const size_t least = h->count + next->taken;
    return reserve(g, all > (double)least ? (size_t)fmin(all, (double)(SIZE_MAX / 2)) : least);
}

/* Blocks until it is looked at again how it stands: all, or about one photon a path, or as many as before. */
static size_t round_of(const gathering *g)
{
    const uint64_t left = blocks_left(g), guess = g->wish->wanted / BLOCK + 1;
    if (g->wish->wanted == SIZE_MAX)
        return (size_t)left;
    return (size_t)fmin((double)left, fmax((double)guess, (double)g->begun));
}

static pm_status gather(gathering *g)
{
    while (!is_over(g)) {
        g->status = make_room(g);
        g->stopped = g->status != PM_OK;
        finish_block(g, NULL);
        if (!g->stopped)
            pm__for(g->config->parallel, round_of(g), work, g);
    }
    return g->status;
}

static void free_blocks(gathering *g)
{
    for (int i = 0; i < WINDOW; i++)
        free_block(g->traced[i]);
    while (g->idle) {
        block *const b = g->idle;
        g->idle = b->next;
        free_block(b);
    }
    (void)pthread_mutex_destroy(&g->lock);
}

pm_status pm__harvest_paths(const pm__shoot_config *config, const pm__harvest_wish *wish, pm__harvest *harvest,
                            pm_error *error)
{
    gathering g = {.config = config, .wish = wish, .harvest = harvest, .lock = PTHREAD_MUTEX_INITIALIZER};
    const bool usual = wish->power > 0.0 && isfinite(wish->power);
    *harvest = (pm__harvest){.unit = usual ? ldexp(1.0, ilogb(wish->power)) : 1.0};
    pm__photon_room *const room = config->normals || wish->marks || wish->numbers ? NULL : config->room;
    if (room) {
        harvest->photons = room->photons;
        g.room = room->capacity;
        *room = (pm__photon_room){NULL, 0};
    }
    const pm_status status = gather(&g);
    free_blocks(&g);
    if (status == PM_OK && room)
        *room = (pm__photon_room){harvest->photons, g.room};
    if (status == PM_OK)
        return PM_OK;
    if (status == PM_EINVAL)
        (void)pm__fail(error, status, "a photon of %g W is more than a float holds", g.refused);
    else
        (void)pm__fail(error, status, "%s behind %zu stored photons",
                       status == PM_ENOMEM ? "out of memory" : "canceled", harvest->count);
    pm__harvest_free(harvest);
    return status;
}

void pm__harvest_free(pm__harvest *harvest)
{
    free(harvest->photons);
    free(harvest->normals);
    free(harvest->marks);
    free(harvest->numbers);
    *harvest = (pm__harvest){0};
}
