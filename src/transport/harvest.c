#include "harvest.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = 512, ROUND = 64 }; /* paths in a block, blocks in a round at most */

/* Paths for each photon that is stored, and for the first ten, before it is given up. */
enum { PATIENCE = 100000 };

typedef struct record {
    pm_photon photon;
    float normal[3];
    unsigned char mark;
    uint64_t number;
} record;

typedef struct block {
    record *records;
    size_t count, capacity;
    size_t enough; /* photons: what a path stores beyond is not looked at */
    double scale;  /* 1 / unit */
    size_t first, taken; /* where its photons go among all, and how many of them */
    pm_status status;
} block;

typedef struct gathering {
    const pm__shoot_config *config;
    pm__tracer tracer;
    const void *tracing;
    block *blocks;
    uint64_t next, end; /* path numbers of the round */
    pm__harvest *harvest;
    size_t lacking;     /* stored photons, when the round began */
    size_t capacity[3]; /* of photons, normals, marks */
} gathering;

static bool keep(void *context, uint64_t number, const pm__stored *stored)
{
    block *const b = context;
    const bool first = b->count == 0 || b->records[b->count - 1].number != number;
    if (first && b->count >= b->enough)
        return false;
    if (pm__grow((void **)&b->records, &b->capacity, b->count + 1, sizeof *b->records)) {
        b->status = PM_ENOMEM;
        return false;
    }
    record *const to = &b->records[b->count];
    const bool dark = !(stored->power[0] > 0.0 || stored->power[1] > 0.0 || stored->power[2] > 0.0);
    to->number = number;
    to->mark = (unsigned char)((first ? PM__FIRST_OF_PATH : 0) | (dark ? PM__NO_POWER : 0));
    for (int i = 0; i < 3; i++) {
        to->photon.position[i] = (float)stored->position[i];
        to->photon.direction[i] = (float)stored->direction[i];
        to->photon.power[i] = (float)(stored->power[i] * b->scale);
        to->normal[i] = (float)stored->normal[i];
    }
    b->count++;
    return true;
}

static void trace_block(void *argument, size_t index)
{
    gathering *const g = argument;
    block *const b = &g->blocks[index];
    const uint64_t first = g->next + (uint64_t)index * BLOCK, left = g->end - first;
    b->count = 0;
    b->enough = g->lacking;
    b->scale = 1.0 / g->harvest->unit;
    b->status = PM_OK;
    if (g->config->canceled && g->config->canceled(g->config->context))
        b->status = PM_ECANCELED;
    else
        g->tracer(g->tracing, first, left < BLOCK ? left : BLOCK, keep, b);
}

static pm_status reserve(gathering *g, size_t count)
{
    pm__harvest *const h = g->harvest;
    if (pm__grow((void **)&h->photons, &g->capacity[0], count, sizeof *h->photons) ||
        (g->config->normals && pm__grow((void **)&h->normals, &g->capacity[1], count, sizeof *h->normals)) ||
        pm__grow((void **)&h->marks, &g->capacity[2], count, sizeof *h->marks))
        return PM_ENOMEM;
    return PM_OK;
}

/* How many of a block's photons are taken where so many are lacking: up to the end of the path by which there are
 * enough. */
static size_t taken_of(const block *b, size_t lacking)
{
    size_t taken = b->count < lacking ? b->count : lacking;
    while (taken > 0 && taken < b->count && !(b->records[taken].mark & PM__FIRST_OF_PATH))
        taken++;
    return taken;
}

/* Photons of a block to where they belong. */
static void place_block(void *argument, size_t index)
{
    const gathering *const g = argument;
    const block *const b = &g->blocks[index];
    pm__harvest *const h = g->harvest;
    for (size_t i = 0; i < b->taken; i++) {
        const record *const r = &b->records[i];
        h->photons[b->first + i] = r->photon;
        h->marks[b->first + i] = r->mark;
        if (h->normals)
            memcpy(h->normals[b->first + i], r->normal, sizeof r->normal);
    }
}

/* The round's photons behind those before, in order: where each block's go is settled first. */
static pm_status append(gathering *g, size_t blocks, uint64_t first, size_t wanted)
{
    pm__harvest *const h = g->harvest;
    size_t count = h->count;
    for (size_t i = 0; i < blocks; i++) {
        block *const b = &g->blocks[i];
        if (b->status != PM_OK)
            return b->status;
        b->first = count;
        b->taken = count < wanted ? taken_of(b, wanted - count) : 0;
        if (b->taken > 0)
            h->emitted = b->records[b->taken - 1].number + 1 - first;
        count += b->taken;
    }
    if (reserve(g, count) != PM_OK)
        return PM_ENOMEM;
    pm__for(g->config->parallel, blocks, place_block, g);
    h->count = count;
    return PM_OK;
}

static pm_status run_round(gathering *g, uint64_t first, size_t wanted)
{
    const uint64_t paths = g->end - g->next;
    const size_t blocks = (size_t)((paths + BLOCK - 1) / BLOCK);
    g->lacking = wanted - g->harvest->count;
    pm__for(g->config->parallel, blocks, trace_block, g);
    const pm_status status = append(g, blocks, first, wanted);
    if (g->harvest->count < wanted)
        g->harvest->emitted = g->end - first;
    g->next = g->end;
    return status;
}

/* How many paths the next round has: about as many as will do, after an eighth to learn how many that is. */
static uint64_t round_of(const pm__harvest *h, size_t wanted)
{
    const double most = (double)BLOCK * ROUND;
    double paths = most;
    if (wanted != SIZE_MAX) {
        const double left = (double)(wanted - h->count);
        if (h->emitted == 0)
            paths = 0.125 * left;
        else if (h->count == 0)
            paths = 2.0 * (double)h->emitted;
        else
            paths = 1.02 * left * (double)h->emitted / (double)h->count;
    }
    return (uint64_t)fmin(fmax(ceil(paths / BLOCK), 1.0), ROUND) * BLOCK;
}

static bool in_vain(const pm__harvest *h, size_t wanted)
{
    return wanted != SIZE_MAX && (double)h->emitted > (double)PATIENCE * ((double)h->count + 10.0);
}

static pm_status gather(gathering *g, uint64_t first, uint64_t most, size_t wanted)
{
    pm__harvest *const h = g->harvest;
    pm_status status = reserve(g, wanted != SIZE_MAX ? wanted + PM__LONGEST_PATH : 0);
    while (status == PM_OK && h->count < wanted && h->emitted < most && !in_vain(h, wanted)) {
        const uint64_t paths = round_of(h, wanted), left = most - h->emitted;
        g->end = g->next + (paths < left ? paths : left);
        status = run_round(g, first, wanted);
    }
    return status;
}

pm_status pm__harvest_paths(const pm__shoot_config *config, pm__tracer tracer, const void *tracing, double power,
                            uint64_t first, uint64_t most, size_t wanted, pm__harvest *harvest, pm_error *error)
{
    gathering g = {.config = config, .tracer = tracer, .tracing = tracing, .next = first, .end = first,
                   .blocks = pm__alloc_zero(ROUND, sizeof *g.blocks), .harvest = harvest};
    *harvest = (pm__harvest){.unit = power > 0.0 && isfinite(power) ? ldexp(1.0, ilogb(power)) : 1.0};
    pm_status status = g.blocks ? gather(&g, first, most, wanted) : PM_ENOMEM;
    for (size_t i = 0; g.blocks && i < ROUND; i++)
        free(g.blocks[i].records);
    free(g.blocks);
    if (status == PM_OK)
        return PM_OK;
    if (status == PM_ENOMEM)
        (void)pm__fail(error, status, "out of memory behind %zu stored photons", harvest->count);
    else
        (void)pm__fail(error, status, "canceled behind %zu stored photons", harvest->count);
    pm__harvest_free(harvest);
    return status;
}

void pm__harvest_free(pm__harvest *harvest)
{
    free(harvest->photons);
    free(harvest->normals);
    free(harvest->marks);
    *harvest = (pm__harvest){0};
}
