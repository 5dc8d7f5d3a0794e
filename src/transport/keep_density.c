/* A batch of arrivals at a time: all are decided against what is stored when it begins, cell by cell of the crowd, so
 * that neighbours are in the cache; then in the order of their paths those that are to be stored are, after a second
 * look where others have been stored nearby meanwhile: so no place gets more than one by one. At last the power of those
 * not stored is handed out, cell by cell again. */
#include "keep_density.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../base/random.h"
#include "crowd.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Arrivals of a batch, about; that are decided, and prepared, by one thread at once. */
enum { BATCH = 1 << 15, TASK = 256, PIECE = 2048 };

/* Required density is at most so many times that at mean importance. */
static const double ceiling = 100.0;

typedef struct arrival {
    float reach;       /* m: within it M photons are enough */
    float global;      /* W/m2, all bands, of all light; 0: not asked for */
    uint64_t key;      /* of its cell */
    uint16_t found;    /* neighbours, when it was decided */
    uint16_t receivers; /* 0: it is stored */
    bool lacks;        /* it found less than is required */
} arrival;

typedef struct order {
    uint32_t hash, arrival;
} order;

/* What became of a batch's arrivals in important places. */
typedef struct tally {
    uint64_t first; /* path */
    size_t arrived, lacking;
} tally;

typedef struct density {
    pm__storage *storage;
    pm__crowd crowd;
    const pm__crowd_kernel *kernel;
    size_t neighbors; /* M */
    double sphere;    /* m: no reach is longer */
    bool wide;        /* s is asked for below 1 */
    bool cosine;
    int power;        /* 0: off */
    double (*powers)[3]; /* of the stock, in its units */
    size_t powers_room;
    arrival *arrivals;   /* of the batch */
    order *sorted, *spare;
    uint32_t *lists;     /* receivers: M for each arrival */
    size_t room;
    tally *tallies;
    size_t tally_count, tally_room;
    const pm__arrivals *all; /* the chunk in hand */
    size_t begin, count;     /* the batch in it */
    double emitted;          /* paths up to the batch */
} density;

/* ---- What is required --------------------------------------------------------------------------- */

bool pm__density_needs(const pm__spec *policy)
{
    return !(pm__spec_value(policy, "constant", 0.0) > 0.0);
}

double pm__density_required(const pm__spec *policy, pm__map_kind kind, const pm__importance *importance, double there)
{
    const double constant = pm__spec_value(policy, "constant", 0.0);
    if (constant > 0.0 || !importance)
        return constant;
    const double mean = pm__importance_mean(importance, kind), least = pm__spec_value(policy, "floor", 0.0) * mean;
    return fmax(least, fmin(there, ceiling * mean)) *
           pm__spec_value(policy, kind == PM__CAUSTIC_MAP ? "caustic" : "global", 0.0);
}

/* Where nothing is required, as many as are looked for are for the whole scene. */
static double reach_of(const density *d, double required)
{
    static const double least = 1e-15;
    const double reach = required > 0.0 ? sqrt((double)d->neighbors / (pi * required)) : d->sphere;
    return fmax(least, fmin(reach, d->sphere));
}

static double searched(const density *d, double reach)
{
    return d->wide ? 2.0 * reach : reach;
}

/* W/m2 of all light, all bands: the nearest 50 but for the farthest, over their disc. */
static double global_at(const pm_map *map, const float position[3], const float normal[3])
{
    enum { NEAREST = 50 };
    pm_neighbor near[NEAREST];
    pm_query query;
    size_t count;
    double sum = 0.0;
    pm_query_init(&query);
    query.k = NEAREST;
    query.front_only = true;
    memcpy(query.position, position, sizeof query.position);
    memcpy(query.normal, normal, sizeof query.normal);
    if (pm_map_search(map, &query, near, NEAREST, &count) != PM_OK || count < 2)
        return 0.0;
    for (size_t i = 0; i + 1 < count; i++) {
        const pm_photon photon = pm_map_photon(map, near[i].number);
        sum += (double)photon.power[0] + (double)photon.power[1] + (double)photon.power[2];
    }
    const double unit = pm_map_unit(map);
    return sum / (pi * (double)near[count - 1].distance2 * unit * unit);
}

static uint32_t hash_of_key(uint64_t key)
{
    return (uint32_t)(key * 0x9e3779b97f4a7c15u >> 42);
}

static void prepare_piece(void *argument, size_t piece)
{
    const density *const d = argument;
    const pm__storing_config *const config = d->storage->config;
    const size_t end = (piece + 1) * PIECE < d->count ? (piece + 1) * PIECE : d->count;
    for (size_t i = piece * PIECE; i < end; i++) {
        const size_t at = d->begin + i;
        const float *const position = d->all->photons[at].position;
        arrival *const to = &d->arrivals[i];
        const double there = d->all->importance ? (double)d->all->importance[at] : 0.0;
        to->reach = (float)reach_of(d, pm__density_required(config->policy, config->kind, config->importance, there));
        to->key = pm__crowd_place_of(&d->crowd, position, searched(d, (double)to->reach)).key;
        to->global = d->power ? (float)global_at(config->global, position, d->all->normals[at]) : 0.0f;
        d->sorted[i] = (order){hash_of_key(to->key), (uint32_t)i};
    }
}

/* ---- Decisions ---------------------------------------------------------------------------------- */

/* Photons that came to surfaces which lie alike face them. */
static uint32_t tag_of(const float normal[3])
{
    uint32_t bits[3], tag = 0;
    memcpy(bits, normal, sizeof bits);
    for (int a = 0; a < 3; a++)
        tag = (tag ^ (bits[a] == 0x80000000u ? 0 : bits[a])) * 0x9e3779b1u ^ tag >> 15;
    return tag;
}

static bool faces(const pm_photon *photon, const float normal[3])
{
    return photon->direction[0] * normal[0] + photon->direction[1] * normal[1] + photon->direction[2] * normal[2] <
           0.0f;
}

static size_t list_receivers(const density *d, const pm__crowd_found *found, const float normal[3], uint32_t *list)
{
    const uint32_t tag = tag_of(normal);
    size_t count = 0;
    for (size_t i = 0; i < found->count; i++) {
        const uint32_t slot = found->slots[i], id = d->crowd.ids[slot];
        list[count] = id;
        count += d->crowd.tags[slot] == tag || faces(&d->storage->stock.photons[id], normal);
    }
    return count;
}

/* (L_g / L_c)^power, 1 at least. */
static double criterion(const density *d, const arrival *a, const uint32_t *list, size_t count, double area)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += d->powers[list[i]][0] + d->powers[list[i]][1] + d->powers[list[i]][2];
    const double caustic = sum * d->storage->unit / d->emitted / area, ratio = (double)a->global / caustic;
    return ratio > 1.0 ? pow(ratio, d->power) : 1.0;
}

static bool is_accepted(const density *d, size_t at, double s)
{
    double u[3];
    if (!d->cosine)
        return s < 1.0;
    if (!(s < 2.0))
        return false;
    pm__random_triple(d->storage->config->seed, PM__FOR_STORING, d->storage->trial, d->all->first + d->all->numbers[at],
                      (uint32_t)(at - pm__path_begin(d->all, at)), u);
    return u[0] < 0.5 * (1.0 + cos(0.5 * pi * s));
}

/* D_cur / D_r. */
static double density_found(const density *d, double reach, size_t found, double farthest2)
{
    if (found == d->neighbors)
        return reach * reach / farthest2;
    return d->wide ? (double)found / (4.0 * (double)d->neighbors) : 0.0;
}

static void decide(const density *d, size_t i, const pm__crowd_run *run, pm__crowd_found *found)
{
    const size_t at = d->begin + i;
    arrival *const a = &d->arrivals[i];
    uint32_t *const list = d->lists + i * d->neighbors;
    const double reach = (double)a->reach, wide = searched(d, reach);
    const double farthest2 = (double)d->kernel->find(&d->crowd, run, d->all->photons[at].position, (float)wide,
                                                     d->neighbors, found);
    double s = density_found(d, reach, found->count, farthest2);
    a->found = (uint16_t)found->count;
    a->lacks = !(s >= 1.0);
    a->receivers = 0;
    if (found->count == 0 || (!d->wide && found->count < d->neighbors))
        return;
    const size_t receivers = list_receivers(d, found, d->all->normals[at], list);
    if (d->power)
        s *= criterion(d, a, list, receivers, pi * (found->count == d->neighbors ? farthest2 : wide * wide));
    if (d->wide ? !is_accepted(d, at, s) : true)
        a->receivers = (uint16_t)receivers;
}

/* The box of what arrivals sorted[first] .. [last - 1], of one cell, search. */
static void gather_run(const density *d, const order *sorted, size_t first, size_t last, pm__crowd_run *run)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, longest = 0.0;
    for (size_t i = first; i < last; i++) {
        const uint32_t number = sorted[i].arrival;
        const float *const position = d->all->photons[d->begin + number].position;
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], (double)position[a]);
            high[a] = fmax(high[a], (double)position[a]);
        }
        longest = fmax(longest, (double)d->arrivals[number].reach);
    }
    const uint32_t number = sorted[first].arrival;
    const pm__crowd_place place = pm__crowd_place_of(&d->crowd, d->all->photons[d->begin + number].position,
                                                     searched(d, (double)d->arrivals[number].reach));
    for (int a = 0; a < 3; a++) {
        low[a] -= searched(d, longest);
        high[a] += searched(d, longest);
    }
    pm__crowd_gather(&d->crowd, &place, low, high, run);
}

static void decide_task(void *argument, size_t task)
{
    const density *const d = argument;
    const size_t end = (task + 1) * TASK < d->count ? (task + 1) * TASK : d->count;
    pm__crowd_found found;
    for (size_t first = task * TASK, last; first < end; first = last) {
        const uint64_t key = d->arrivals[d->sorted[first].arrival].key;
        pm__crowd_run run;
        last = first + 1;
        while (last < end && d->arrivals[d->sorted[last].arrival].key == key)
            last++;
        gather_run(d, d->sorted, first, last, &run);
        for (size_t i = first; i < last; i++)
            decide(d, d->sorted[i].arrival, &run, &found);
    }
}

/* By the hash of their cells, then by their own order. */
static void sort(density *d)
{
    enum { BITS = 11 };
    for (unsigned shift = 0; shift < 2 * BITS; shift += BITS) {
        uint32_t starts[1 << BITS] = {0}, sum = 0;
        for (size_t i = 0; i < d->count; i++)
            starts[d->sorted[i].hash >> shift & ((1 << BITS) - 1)]++;
        for (size_t b = 0; b < 1 << BITS; b++) {
            const uint32_t own = starts[b];
            starts[b] = sum;
            sum += own;
        }
        for (size_t i = 0; i < d->count; i++)
            d->spare[starts[d->sorted[i].hash >> shift & ((1 << BITS) - 1)]++] = d->sorted[i];
        order *const swapped = d->sorted;
        d->sorted = d->spare;
        d->spare = swapped;
    }
}

/* ---- Storing and handing out -------------------------------------------------------------------- */

/* Others have been stored since it was decided. */
static void decide_again(const density *d, size_t i)
{
    pm__crowd_run run;
    pm__crowd_found found;
    const order only = {0, (uint32_t)i};
    gather_run(d, &only, 0, 1, &run);
    decide(d, i, &run, &found);
}

static pm_status store(density *d, size_t i)
{
    pm__stock *const stock = &d->storage->stock;
    const size_t at = d->begin + i, id = stock->count;
    const pm_photon *const photon = &d->all->photons[at];
    const double reach = searched(d, (double)d->arrivals[i].reach);
    if (pm__stock_reserve(stock, 1) ||
        pm__grow((void **)&d->powers, &d->powers_room, id + 1, sizeof *d->powers))
        return PM_ENOMEM;
    pm__stock_add(stock, photon, d->all->normals[at], d->all->part[at]);
    for (int b = 0; b < 3; b++)
        d->powers[id][b] = (double)photon->power[b];
    return pm__crowd_add(&d->crowd, photon->position, reach, (uint32_t)id, tag_of(d->all->normals[at]));
}

static pm_status settle_one(density *d, size_t i)
{
    arrival *const a = &d->arrivals[i];
    if (a->receivers)
        return PM_OK;
    const pm__crowd_place place = pm__crowd_place_of(&d->crowd, d->all->photons[d->begin + i].position,
                                                     searched(d, (double)a->reach));
    const unsigned fresh = pm__crowd_fresh(&d->crowd, &place);
    if (fresh && (d->wide || a->found + fresh >= d->neighbors))
        decide_again(d, i);
    return a->receivers ? PM_OK : store(d, i);
}

/* In their order, but for the path by which there are enough. *taken: of the batch. */
static pm_status settle_all(density *d, size_t *taken)
{
    pm__stock *const stock = &d->storage->stock;
    const uint32_t *const numbers = d->all->numbers + d->begin;
    const size_t wanted = d->storage->config->stored;
    size_t before = stock->count, begin = 0;
    pm_status status = PM_OK;
    *taken = d->count;
    for (size_t i = 0; i < d->count && status == PM_OK; i++) {
        if (i > 0 && numbers[i] != numbers[i - 1]) {
            if (stock->count >= wanted) {
                *taken = i;
                break;
            }
            before = stock->count;
            begin = i;
        }
        status = settle_one(d, i);
        if (stock->count >= wanted && !pm__path_is_first(d->all, d->begin + i)) {
            stock->count = before;
            *taken = begin;
            break;
        }
    }
    return status;
}

static void hand_out(const density *d, size_t i)
{
    const arrival *const a = &d->arrivals[i];
    const pm_photon *const photon = &d->all->photons[d->begin + i];
    const uint32_t *const list = d->lists + i * d->neighbors;
    double part[3];
    for (int b = 0; b < 3; b++)
        part[b] = (double)photon->power[b] / a->receivers;
    for (size_t r = 0; r < a->receivers; r++)
        for (int b = 0; b < 3; b++)
            d->powers[list[r]][b] += part[b];
}

static pm_status count_up(density *d, size_t taken)
{
    tally counted = {.first = d->all->first + d->all->numbers[d->begin]};
    const bool everywhere = !d->all->importance;
    for (size_t i = 0; i < taken; i++) {
        const bool matters = everywhere || d->all->part[d->begin + i];
        counted.arrived += matters;
        counted.lacking += matters && d->arrivals[i].lacks;
    }
    if (pm__grow((void **)&d->tallies, &d->tally_room, d->tally_count + 1, sizeof *d->tallies))
        return PM_ENOMEM;
    d->tallies[d->tally_count++] = counted;
    return PM_OK;
}

/* ---- Batches ------------------------------------------------------------------------------------ */

static pm_status reserve(density *d, size_t count)
{
    size_t rooms[4] = {d->room, d->room, d->room, d->room};
    if (pm__grow((void **)&d->arrivals, &rooms[0], count, sizeof *d->arrivals) ||
        pm__grow((void **)&d->sorted, &rooms[1], count, sizeof *d->sorted) ||
        pm__grow((void **)&d->spare, &rooms[2], count, sizeof *d->spare) ||
        pm__grow((void **)&d->lists, &rooms[3], count, d->neighbors * sizeof *d->lists))
        return PM_ENOMEM;
    d->room = rooms[0];
    return PM_OK;
}

/* Whole paths. */
static size_t batch_end(const pm__arrivals *all, size_t begin)
{
    if (all->count - begin <= BATCH)
        return all->count;
    size_t end = begin + BATCH;
    while (end < all->count && all->numbers[end] == all->numbers[end - 1])
        end++;
    return end;
}

static pm_status run_batch(density *d, size_t *taken)
{
    const pm_parallel *const parallel = d->storage->config->parallel;
    if (d->count > d->room && reserve(d, d->count))
        return PM_ENOMEM;
    d->emitted = (double)(d->all->first + d->all->numbers[d->begin] + 1);
    pm__crowd_settle(&d->crowd);
    pm__for(parallel, (d->count + PIECE - 1) / PIECE, prepare_piece, d);
    sort(d);
    pm__for(parallel, (d->count + TASK - 1) / TASK, decide_task, d);
    pm_status status = settle_all(d, taken);
    for (size_t i = 0; i < d->count && status == PM_OK; i++)
        if (d->sorted[i].arrival < *taken)
            hand_out(d, d->sorted[i].arrival);
    return status == PM_OK ? count_up(d, *taken) : status;
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    density *const d = storage->own;
    pm_status status = PM_OK;
    d->all = arrivals;
    *taken = 0;
    for (size_t begin = 0, end; begin < arrivals->count && status == PM_OK && *taken == begin; begin = end) {
        size_t some = 0;
        end = batch_end(arrivals, begin);
        d->begin = begin;
        d->count = end - begin;
        status = run_batch(d, &some);
        *taken = begin + some;
        if (storage->stock.count >= storage->config->stored)
            break;
    }
    return status;
}

/* ---- Beginning and end -------------------------------------------------------------------------- */

static double diagonal_of(const pm__scene *scene)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0.0;
    for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
        const pm__object object = pm__scene_object(scene, i);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], object.low[a]);
            high[a] = fmax(high[a], object.high[a]);
        }
    }
    for (int a = 0; a < 3; a++)
        sum += (high[a] - low[a]) * (high[a] - low[a]);
    return sum > 0.0 && isfinite(sum) ? sqrt(sum) : 1.0;
}

static pm_status begin(pm__storage *storage)
{
    const pm__storing_config *const config = storage->config;
    density *const d = storage->own = pm__alloc_zero(1, sizeof *d);
    if (!d)
        return PM_ENOMEM;
    d->storage = storage;
    d->kernel = pm__crowd_choose();
    d->neighbors = (size_t)pm__policy_value(storage, "neighbors", 20.0);
    d->cosine = pm__policy_value(storage, "accept", 0.0) == 1.0;
    d->power = config->kind == PM__CAUSTIC_MAP ? (int)pm__policy_value(storage, "power", 0.0) : 0;
    d->wide = d->cosine || d->power;
    d->sphere = diagonal_of(config->scene);
    if (d->power && !config->global)
        return pm__fail(storage->error, PM_EINVAL, "the convergence of caustics needs a map of all light");
    const double mean = config->importance ? pm__importance_mean(config->importance, config->kind) : 0.0;
    const double usual = pm__density_required(config->policy, config->kind, config->importance, mean);
    return pm__crowd_init(&d->crowd, searched(d, reach_of(d, usual)), !pm__density_needs(config->policy));
}

/* Of photons of the last tenth that came to important places one in a hundred found too few. */
static bool is_unmet(const density *d)
{
    size_t arrived = 0, lacking = 0;
    for (size_t i = d->tally_count; i-- > 0;) {
        if (i + 1 < d->tally_count && (double)d->tallies[i].first < 0.9 * d->emitted)
            break;
        arrived += d->tallies[i].arrived;
        lacking += d->tallies[i].lacking;
    }
    return (double)lacking > 0.01 * (double)arrived;
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    const density *const d = storage->own;
    for (size_t i = 0; i < storage->stock.count; i++)
        for (int b = 0; b < 3; b++)
            storage->stock.photons[i].power[b] = (float)d->powers[i][b];
    *unmet = is_unmet(d);
    return PM_OK;
}

static void release(pm__storage *storage)
{
    density *const d = storage->own;
    if (!d)
        return;
    pm__crowd_free(&d->crowd);
    free(d->powers);
    free(d->arrivals);
    free(d->sorted);
    free(d->spare);
    free(d->lists);
    free(d->tallies);
    free(d);
}

const pm__keeping pm__keep_density = {.begin = begin, .keep = keep, .end = end, .release = release};
