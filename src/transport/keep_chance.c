#include "keep_chance.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../base/random.h"

#include <stdlib.h>

/* Arrivals that are decided, and stored, at once. */
enum { PIECE = 1024 };

typedef struct drawing {
    pm__storage *storage;
    const pm__arrivals *arrivals;
    pm__chance chance;
    float *factors;    /* of the powers; 0: not kept. NULL: all are, as they are */
    size_t *starts;    /* of a piece: how many are kept; then where they go in the stock */
    size_t taken;      /* arrivals */
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

/* ---- Deciding ----------------------------------------------------------------------------------- */

static float draw(const drawing *d, size_t i)
{
    if (d->arrivals->aside && d->arrivals->aside[i])
        return 0.0f;
    return d->chance ? pm__chance_factor(d->storage, d->arrivals, d->chance, i) : 1.0f;
}

static void draw_piece(void *argument, size_t piece)
{
    const drawing *const d = argument;
    const size_t end = pm__piece_end(piece, PIECE, d->arrivals->count);
    size_t kept = 0;
    for (size_t i = piece * PIECE; i < end; i++) {
        d->factors[i] = draw(d, i);
        kept += d->factors[i] > 0.0f;
    }
    d->starts[piece] = kept;
}

static void count_all(const drawing *d)
{
    for (size_t piece = 0; piece < pm__pieces(d->arrivals->count, PIECE); piece++)
        d->starts[piece] = pm__piece_end(piece, PIECE, d->arrivals->count) - piece * PIECE;
}

/* Where storing may end with these arrivals: by how many does it? */
static pm_status find_end(drawing *d)
{
    const pm__arrivals *const a = d->arrivals;
    const pm__stock *const stock = &d->storage->stock;
    const size_t wanted = d->storage->config->stored;
    d->taken = a->count;
    if (wanted == SIZE_MAX || stock->count + a->count < wanted)
        return PM_OK;
    unsigned char *const kept = d->factors ? pm__alloc(a->count, sizeof *kept) : NULL;
    if (d->factors && !kept)
        return PM_ENOMEM;
    for (size_t i = 0; i < a->count && kept; i++)
        kept[i] = d->factors[i] > 0.0f;
    d->taken = pm__stock_taken(stock, wanted, kept, a->numbers, a->first, a->count);
    free(kept);
    return PM_OK;
}

/* ---- Storing ------------------------------------------------------------------------------------ */

static void store_piece(void *argument, size_t piece)
{
    const drawing *const d = argument;
    const pm__arrivals *const a = d->arrivals;
    const size_t end = pm__piece_end(piece, PIECE, d->taken);
    size_t at = d->starts[piece];
    for (size_t i = piece * PIECE; i < end; i++) {
        const float factor = d->factors ? d->factors[i] : 1.0f;
        if (!(factor > 0.0f))
            continue;
        pm_photon photon = a->photons[i];
        for (int b = 0; b < 3; b++)
            photon.power[b] *= factor;
        pm__stock_put(&d->storage->stock, at++, &photon, a->normals[i], a->part[i]);
    }
    d->starts[piece] = at;
}

static pm_status store_all(drawing *d)
{
    pm__stock *const stock = &d->storage->stock;
    const size_t pieces = pm__pieces(d->arrivals->count, PIECE), taken = pm__pieces(d->taken, PIECE);
    size_t sum = stock->count;
    for (size_t piece = 0; piece < pieces; piece++) {
        const size_t kept = d->starts[piece];
        d->starts[piece] = sum;
        sum += kept;
    }
    if (pm__stock_reserve(stock, sum - stock->count))
        return PM_ENOMEM;
    pm__for(d->storage->config->parallel, taken, store_piece, d);
    stock->count = taken ? d->starts[taken - 1] : stock->count; /* the last piece may be cut */
    return PM_OK;
}

pm_status pm__keep_by_chance(pm__storage *storage, const pm__arrivals *arrivals, pm__chance chance, size_t *taken)
{
    const size_t pieces = pm__pieces(arrivals->count, PIECE);
    const bool draws = chance || arrivals->aside;
    drawing d = {.storage = storage, .arrivals = arrivals, .chance = chance};
    d.starts = pm__alloc(pieces, sizeof *d.starts);
    d.factors = draws ? pm__alloc(arrivals->count, sizeof *d.factors) : NULL;
    pm_status status = d.starts && (d.factors || !draws) ? PM_OK : PM_ENOMEM;
    if (status == PM_OK && draws)
        pm__for(storage->config->parallel, pieces, draw_piece, &d);
    else if (status == PM_OK)
        count_all(&d);
    if (status == PM_OK)
        status = find_end(&d);
    if (status == PM_OK)
        status = store_all(&d);
    *taken = d.taken;
    free(d.starts);
    free(d.factors);
    return status;
}
