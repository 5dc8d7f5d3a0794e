/* A batch of arrivals at a time: their plots are found, each is decided, those that are stored are put where they stay.
 * What the others give is handed out at the end. */
#include "keep_density.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "density.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Required density is at most so many times that at mean importance. */
static const double ceiling = 100.0;

/* Of a batch. */
typedef struct record {
    uint64_t first; /* path */
    pm__density_tally tally;
} record;

typedef struct keeper {
    pm__density density;
    record *records;
    size_t record_count, record_room;
} keeper;

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

/* The least corner of the scene and how large it is, m; not more than floats can tell places apart in. */
static double box_of(const pm__scene *scene, double low[3])
{
    static const double farthest = 1e18;
    double high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0.0;
    low[0] = low[1] = low[2] = INFINITY;
    for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
        const pm__object object = pm__scene_object(scene, i);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], object.low[a]);
            high[a] = fmax(high[a], object.high[a]);
        }
    }
    for (int a = 0; a < 3; a++) {
        low[a] = fmax(-farthest, fmin(low[a], farthest));
        high[a] = fmax(low[a], fmin(high[a], farthest));
        sum += (high[a] - low[a]) * (high[a] - low[a]);
    }
    return sum > 0.0 ? sqrt(sum) : 1.0;
}

/* Where nothing is required, as many as share power are for the whole scene. */
static pm__density_rule rule_of(const pm__storing_config *config, double across)
{
    const pm__spec *const policy = config->policy;
    const bool caustic = config->kind == PM__CAUSTIC_MAP;
    const double mean = config->importance ? pm__importance_mean(config->importance, config->kind) : 0.0;
    const double neighbors = pm__spec_value(policy, "neighbors", 20.0), least = neighbors / (pi * across * across);
    const double constant = pm__spec_value(policy, "constant", 0.0);
    const double pixel = pm__spec_value(policy, caustic ? "caustic" : "global", 0.0);
    const double low = constant > 0.0 ? constant : pixel * pm__spec_value(policy, "floor", 0.0) * mean;
    const double high = constant > 0.0 ? constant : pixel * ceiling * mean;
    return (pm__density_rule){.neighbors = neighbors,
                              .low = (float)fmax(least, low),
                              .high = (float)fmax(least, high),
                              .per_pixel = (float)pixel,
                              .cosine = pm__spec_value(policy, "accept", 0.0) == 1.0,
                              .power = caustic ? (int)pm__spec_value(policy, "power", 0.0) : 0};
}

/* ---- Storing ------------------------------------------------------------------------------------ */

/* Puts those of a piece that are stored into the stock, in their order. */
static void store_piece(void *argument, size_t piece)
{
    enum { WORD = 64, WORDS = PM__DENSITY_PIECE / WORD };
    const pm__density *const d = argument;
    pm__stock *const stock = &d->storage->stock;
    const size_t first = piece * PM__DENSITY_PIECE;
    const pm__seeker *const seekers = d->seekers + first;
    const pm__density_runs *const runs = &d->runs[piece];
    uint64_t chosen[WORDS] = {0}, keys[PM__DENSITY_PIECE];
    for (size_t s = 0; s < PM__PLOT_SHARDS; s++)
        for (size_t i = runs->begin[s], left = runs->stored[s]; left > 0; i++) {
            const size_t at = seekers[i].arrival - first;
            if (!seekers[i].is_stored)
                continue;
            chosen[at / WORD] |= (uint64_t)1 << at % WORD;
            keys[at] = seekers[i].takes ? seekers[i].key : 0;
            left--;
        }
    for (size_t w = 0, to = d->starts[piece]; w < WORDS; w++)
        for (uint64_t left = chosen[w]; left; left &= left - 1, to++) {
            const size_t i = w * WORD + (size_t)__builtin_ctzll(left), at = d->begin + first + i;
            pm__stock_put(stock, to, &d->all->photons[at], d->all->normals[at], d->all->part[at]);
            d->keys[to - d->before] = keys[i];
        }
}

/* Where in the stock those of each piece go; the end of all. */
static size_t place_pieces(pm__density *d)
{
    size_t sum = d->storage->stock.count;
    for (size_t piece = 0; piece < pm__density_pieces(d->count); piece++) {
        d->starts[piece] = sum;
        for (size_t s = 0; s < PM__PLOT_SHARDS; s++)
            sum += d->runs[piece].stored[s];
    }
    return sum;
}

static pm_status store_all(pm__density *d)
{
    pm__stock *const stock = &d->storage->stock;
    const size_t end = place_pieces(d), wanted = end - d->before;
    if (pm__stock_reserve(stock, end - stock->count) ||
        (wanted > d->keys_room && pm__grow((void **)&d->keys, &d->keys_room, wanted, sizeof *d->keys)))
        return PM_ENOMEM;
    pm__for(d->storage->config->parallel, pm__density_pieces(d->count), store_piece, d);
    stock->count = end;
    return PM_OK;
}

/* ---- Ending ------------------------------------------------------------------------------------- */

/* Arrivals of the batch, which is decided, up to where storing ends. ENOMEM: *taken is 0. */
static pm_status find_end(const pm__density *d, size_t *taken)
{
    const pm__arrivals *const all = d->all;
    unsigned char *const kept = pm__alloc_zero(d->count, sizeof *kept);
    *taken = 0;
    if (!kept)
        return PM_ENOMEM;
    for (size_t piece = 0; piece < pm__density_pieces(d->count); piece++) {
        const pm__seeker *const seekers = d->seekers + piece * PM__DENSITY_PIECE;
        for (size_t i = 0; i < d->runs[piece].begin[PM__PLOT_SHARDS]; i++)
            kept[seekers[i].arrival] = seekers[i].is_stored;
    }
    *taken = pm__stock_taken(&d->storage->stock, d->storage->config->stored, kept, all->numbers + d->begin, all->first,
                             d->count);
    free(kept);
    return PM_OK;
}

/* Decides once more, of the batch's first `taken` alone, from what was before. */
static pm_status decide_again(pm__density *d, pm__plot_shard before[PM__PLOT_SHARDS], size_t taken)
{
    for (int i = 0; i < PM__PLOT_SHARDS; i++) {
        pm__plot_shard_free(&d->plots.shards[i]);
        d->plots.shards[i] = before[i];
        before[i] = (pm__plot_shard){0};
    }
    d->count = taken;
    return pm__density_decide(d);
}

/* Where storing may end with this batch. */
static pm_status decide_to_the_end(pm__density *d)
{
    pm__plot_shard before[PM__PLOT_SHARDS] = {{0}};
    pm_status status = PM_OK;
    size_t taken = d->count;
    for (int i = 0; i < PM__PLOT_SHARDS && status == PM_OK; i++)
        status = pm__plot_shard_copy(&d->plots.shards[i], &before[i]);
    if (status == PM_OK)
        status = pm__density_decide(d);
    if (status == PM_OK)
        status = find_end(d, &taken);
    if (status == PM_OK && taken < d->count)
        status = decide_again(d, before, taken);
    for (int i = 0; i < PM__PLOT_SHARDS; i++)
        pm__plot_shard_free(&before[i]);
    return status;
}

/* ---- Batches ------------------------------------------------------------------------------------ */

static pm_status reserve(pm__density *d)
{
    const size_t pieces = pm__density_pieces(d->count), all = pieces * PM__DENSITY_PIECE;
    if (all <= d->room)
        return PM_OK;
    free(d->seekers);
    free(d->runs);
    free(d->global);
    free(d->starts);
    d->seekers = pm__alloc(all, sizeof *d->seekers);
    d->runs = pm__alloc(pieces, sizeof *d->runs);
    d->global = d->rule.power ? pm__alloc(all, sizeof *d->global) : NULL;
    d->starts = pm__alloc(pieces, sizeof *d->starts);
    d->room = d->seekers && d->runs && d->starts && (d->global || !d->rule.power) ? all : 0;
    return d->room ? PM_OK : PM_ENOMEM;
}

static pm_status count_up(keeper *k)
{
    const pm__density *const d = &k->density;
    record made = {.first = d->all->first + d->all->numbers[d->begin]};
    for (int i = 0; i < PM__PLOT_SHARDS; i++) {
        made.tally.arrived += d->tallies[i].arrived;
        made.tally.lacking += d->tallies[i].lacking;
    }
    if (pm__grow((void **)&k->records, &k->record_room, k->record_count + 1, sizeof *k->records))
        return PM_ENOMEM;
    k->records[k->record_count++] = made;
    return PM_OK;
}

static pm_status run_batch(keeper *k)
{
    pm__density *const d = &k->density;
    const size_t stored = d->storage->stock.count, wanted = d->storage->config->stored;
    d->emitted = (double)(d->all->first + d->all->numbers[d->begin] + 1);
    pm_status status = reserve(d);
    if (status != PM_OK)
        return status;
    pm__density_prepare(d);
    status = wanted < SIZE_MAX && stored + d->count >= wanted ? decide_to_the_end(d) : pm__density_decide(d);
    if (status == PM_OK)
        status = store_all(d);
    return status == PM_OK && d->count > 0 ? count_up(k) : status;
}

/* From arrival `begin` on, whole paths. */
static size_t batch_end(const pm__arrivals *all, size_t begin)
{
    size_t end = all->count - begin < PM__DENSITY_BATCH ? all->count : begin + PM__DENSITY_BATCH;
    while (end < all->count && all->numbers[end] == all->numbers[end - 1])
        end++;
    return end;
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    keeper *const k = storage->own;
    pm__density *const d = &k->density;
    pm_status status = PM_OK;
    d->all = arrivals;
    for (*taken = 0; *taken < arrivals->count && status == PM_OK; *taken += d->count) {
        const size_t wished = batch_end(arrivals, *taken) - *taken;
        d->begin = *taken;
        d->count = wished;
        status = run_batch(k);
        if (d->count < wished) {
            *taken += d->count;
            break;
        }
    }
    return status;
}

/* ---- Beginning and end -------------------------------------------------------------------------- */

static pm_status begin(pm__storage *storage)
{
    const pm__storing_config *const config = storage->config;
    double low[3];
    const double across = box_of(config->scene, low);
    keeper *const k = storage->own = pm__alloc_zero(1, sizeof *k);
    if (!k)
        return PM_ENOMEM;
    pm__density *const d = &k->density;
    d->storage = storage;
    d->before = storage->stock.count;
    d->rule = rule_of(config, across);
    if (d->rule.power && !config->global)
        return pm__fail(storage->error, PM_EINVAL, "the convergence of caustics needs a map of all light");
    const double mean = config->importance ? pm__importance_mean(config->importance, config->kind) : 0.0;
    const double usual = (double)pm__density_at(&d->rule, (float)mean), least = (double)pm__density_at(&d->rule, 0.0f);
    pm__plots_init(&d->plots, d->rule.neighbors, usual, least, low, across, storage->planned, d->rule.power > 0);
    return PM_OK;
}

static const pm__plot *plot_of(const pm__density *d, uint64_t key)
{
    return pm__plot_find(&d->plots.shards[pm__plot_shard_of(&d->plots, key)], key);
}

static size_t stock_end(const pm__density *d, size_t piece)
{
    const size_t end = d->before + (piece + 1) * PM__DENSITY_PIECE;
    return end < d->storage->stock.count ? end : d->storage->stock.count;
}

/* Its plot gives to each alike. */
static void hand_out(void *argument, size_t piece)
{
    enum { AHEAD = 16 };
    const pm__density *const d = argument;
    for (size_t i = d->before + piece * PM__DENSITY_PIECE, end = stock_end(d, piece); i < end; i++) {
        const uint64_t key = d->keys[i - d->before], to_come = i + AHEAD < end ? d->keys[i + AHEAD - d->before] : 0;
        if (to_come)
            pm__plot_prefetch(&d->plots.shards[pm__plot_shard_of(&d->plots, to_come)], to_come);
        if (!key)
            continue;
        const pm__plot *const plot = plot_of(d, key);
        float *const power = d->storage->stock.photons[i].power;
        for (int b = 0; b < 3; b++)
            power[b] = (float)((double)power[b] + plot->waiting[b] / (double)plot->takers);
    }
}

/* Of photons of the last tenth that came to important places one in a hundred found too few. */
static bool is_unmet(const keeper *k)
{
    size_t arrived = 0, lacking = 0;
    for (size_t i = k->record_count; i-- > 0;) {
        if (i + 1 < k->record_count && (double)k->records[i].first < 0.9 * k->density.emitted)
            break;
        arrived += k->records[i].tally.arrived;
        lacking += k->records[i].tally.lacking;
    }
    return (double)lacking > 0.01 * (double)arrived;
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    keeper *const k = storage->own;
    pm__density *const d = &k->density;
    const size_t pieces = pm__density_pieces(storage->stock.count - d->before);
    pm__for(storage->config->parallel, pieces, hand_out, d);
    *unmet = is_unmet(k);
    return PM_OK;
}

static void release(pm__storage *storage)
{
    keeper *const k = storage->own;
    if (!k)
        return;
    pm__density *const d = &k->density;
    pm__plots_free(&d->plots);
    free(d->keys);
    free(d->seekers);
    free(d->runs);
    free(d->global);
    free(d->starts);
    free(k->records);
    free(k);
}

const pm__keeping pm__keep_density = {.begin = begin, .keep = keep, .end = end, .release = release};
