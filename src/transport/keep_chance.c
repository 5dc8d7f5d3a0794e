#include "keep_chance.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../base/random.h"

#include <stdlib.h>

/* Arrivals that are decided at once. */
enum { PIECE = 1024 };

typedef struct drawing {
    const pm__storage *storage;
    const pm__arrivals *arrivals;
    pm__chance chance;
    float *factors; /* of the powers; 0: not kept */
} drawing;

float pm__chance_factor(const pm__storage *storage, const pm__arrivals *arrivals, pm__chance of, size_t i)
{
    const double chance = of(storage, arrivals, i);
    double u[3];
    if (chance >= 1.0)
        return 1.0f;
    pm__random_triple(storage->config->seed, PM__FOR_STORING, storage->trial, arrivals->first + arrivals->numbers[i],
                      (uint32_t)(i - pm__path_begin(arrivals, i)), u);
    return u[0] < chance ? (float)(1.0 / chance) : 0.0f;
}

static void draw_piece(void *argument, size_t piece)
{
    const drawing *const d = argument;
    const size_t end = (piece + 1) * PIECE < d->arrivals->count ? (piece + 1) * PIECE : d->arrivals->count;
    for (size_t i = piece * PIECE; i < end; i++)
        d->factors[i] = pm__chance_factor(d->storage, d->arrivals, d->chance, i);
}

static void add(pm__stock *stock, const pm__arrivals *arrivals, size_t i, float factor)
{
    pm_photon photon = arrivals->photons[i];
    for (int b = 0; b < 3; b++)
        photon.power[b] *= factor;
    pm__stock_add(stock, &photon, arrivals->normals[i], arrivals->part[i]);
}

/* All arrivals, but that path by which there are enough; factors NULL: 1. */
static size_t take(pm__storage *storage, const pm__arrivals *arrivals, const float *factors)
{
    pm__stock *const stock = &storage->stock;
    size_t before = stock->count, begin = 0; /* of the path in hand */
    for (size_t i = 0; i < arrivals->count; i++) {
        if (i > 0 && arrivals->numbers[i] != arrivals->numbers[i - 1]) {
            if (stock->count >= storage->config->stored)
                return i; /* one path is enough */
            begin = i;
            before = stock->count;
        }
        if ((factors && factors[i] == 0.0f) || (arrivals->aside && arrivals->aside[i]))
            continue;
        add(stock, arrivals, i, factors ? factors[i] : 1.0f);
        if (stock->count >= storage->config->stored && !pm__path_is_first(arrivals, i)) {
            stock->count = before;
            return begin;
        }
    }
    return arrivals->count;
}

pm_status pm__keep_by_chance(pm__storage *storage, const pm__arrivals *arrivals, pm__chance chance, size_t *taken)
{
    float *const factors = chance ? pm__alloc(arrivals->count, sizeof *factors) : NULL;
    drawing d = {storage, arrivals, chance, factors};
    if ((chance && !factors) || pm__stock_reserve(&storage->stock, arrivals->count)) {
        free(factors);
        return PM_ENOMEM;
    }
    if (chance)
        pm__for(storage->config->parallel, (arrivals->count + PIECE - 1) / PIECE, draw_piece, &d);
    *taken = take(storage, arrivals, factors);
    free(factors);
    return PM_OK;
}
