/* A batch of arrivals at a time: all are decided against what is stored when it begins; then those that are to be
 * stored are, in the order of their paths, after a second look where others have been stored nearby meanwhile: so no
 * place gets more than it would one by one. What the others give is handed out at the end. */
#include "keep_density.h"

#include "../base/memory.h"
#include "density.h"

#include <math.h>
#include <stdlib.h>

/* Arrivals of a batch, about: so many at most, and at least; and so many that of those stored when it ends it stored
 * one in so many, to judge by the last one. Then few have to be looked at again. */
enum { MOST = 1 << 17, LEAST = 1 << 12, SHARE_STORED = 8 };

/* Required density is at most so many times that at mean importance. */
static const double ceiling = 100.0;

/* What became of a batch's arrivals in important places. */
typedef struct tally {
    uint64_t first; /* path */
    size_t arrived, lacking;
} tally;

typedef struct keeper {
    pm__density density;
    tally *tallies;
    size_t tally_count, tally_room;
    double rate; /* of arrivals of the last batch, stored */
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

static double diagonal_of(const pm__scene *scene)
{
    static const double longest = 1e18;
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
    return sum > 0.0 ? fmin(sqrt(sum), longest) : 1.0;
}

static pm__density_rule rule_of(const pm__storing_config *config)
{
    const pm__spec *const policy = config->policy;
    const bool caustic = config->kind == PM__CAUSTIC_MAP;
    const double mean = config->importance ? pm__importance_mean(config->importance, config->kind) : 0.0;
    pm__density_rule rule = {.neighbors = (size_t)pm__spec_value(policy, "neighbors", 20.0),
                             .constant = pm__spec_value(policy, "constant", 0.0),
                             .low = pm__spec_value(policy, "floor", 0.0) * mean,
                             .high = ceiling * mean,
                             .per_pixel = pm__spec_value(policy, caustic ? "caustic" : "global", 0.0),
                             .longest = diagonal_of(config->scene),
                             .cosine = pm__spec_value(policy, "accept", 0.0) == 1.0,
                             .power = caustic ? (int)pm__spec_value(policy, "power", 0.0) : 0};
    rule.wide = rule.cosine || rule.power;
    return rule;
}

/* ---- Storing ------------------------------------------------------------------------------------ */

static pm_status store(pm__density *d, size_t i)
{
    pm__stock *const stock = &d->storage->stock;
    const size_t at = d->begin + i, id = stock->count;
    const pm_photon *const photon = &d->all->photons[at];
    const double searched = pm__density_searched(&d->rule, (double)d->arrivals[i].reach);
    if ((id == stock->capacity && pm__stock_reserve(stock, 1)) ||
        (id == d->powers_room && pm__grow((void **)&d->powers, &d->powers_room, id + 1, sizeof *d->powers)))
        return PM_ENOMEM;
    pm__stock_add(stock, photon, d->all->normals[at], d->all->part[at]);
    for (int b = 0; b < 3; b++)
        d->powers[id][b] = (double)photon->power[b];
    const uint32_t tag = pm__density_tag(d->all->normals[at], d->all->part[at]);
    return pm__crowd_add(&d->crowd, photon->position, searched, (uint32_t)id, tag);
}

static pm_status settle_one(pm__density *d, size_t i, pm__searcher *with)
{
    const pm__arrival *const arrival = &d->arrivals[i];
    const float *const position = d->all->photons[d->begin + i].position;
    if (arrival->verdict != PM__STORE)
        return PM_OK;
    const pm__crowd_place place =
        pm__crowd_place_of(&d->crowd, position, pm__density_searched(&d->rule, (double)arrival->reach));
    const unsigned fresh = pm__crowd_fresh(&d->crowd, &place);
    if (fresh && (d->rule.wide || arrival->found + fresh >= d->rule.neighbors) && pm__density_again(d, i, with))
        return PM_ENOMEM;
    return arrival->verdict == PM__STORE ? store(d, i) : PM_OK;
}

static pm_status settle_all(pm__density *d)
{
    pm__searcher with = {0};
    pm_status status = PM_OK;
    for (size_t i = 0; i < d->count && status == PM_OK; i++)
        status = settle_one(d, i, &with);
    pm__searcher_free(&with);
    return status;
}

static void hand_out(const pm__density *d)
{
    for (size_t list = 0; list * PM__DENSITY_TASK < d->count; list++)
        for (size_t i = 0; i < d->gifts[list].count; i++) {
            const pm__gift *const gift = &d->gifts[list].items[i];
            for (int b = 0; b < 3; b++)
                d->powers[gift->id][b] += gift->power[b];
        }
}

static pm_status count_up(keeper *k)
{
    const pm__density *const d = &k->density;
    tally counted = {.first = d->all->first + d->all->numbers[d->begin]};
    const bool everywhere = !d->all->importance;
    for (size_t i = 0; i < d->count; i++) {
        const bool matters = everywhere || d->all->part[d->begin + i];
        counted.arrived += matters;
        counted.lacking += matters && d->arrivals[i].lacks;
    }
    if (pm__grow((void **)&k->tallies, &k->tally_room, k->tally_count + 1, sizeof *k->tallies))
        return PM_ENOMEM;
    k->tallies[k->tally_count++] = counted;
    return PM_OK;
}

/* ---- Batches ------------------------------------------------------------------------------------ */

static pm_status reserve(pm__density *d)
{
    size_t rooms[3] = {d->room, d->room, d->room};
    const size_t lists = (d->count + PM__DENSITY_TASK - 1) / PM__DENSITY_TASK;
    if (d->count > d->room) {
        if (pm__grow((void **)&d->arrivals, &rooms[0], d->count, sizeof *d->arrivals) ||
            pm__grow((void **)&d->sorted, &rooms[1], d->count, sizeof *d->sorted) ||
            pm__grow((void **)&d->spare, &rooms[2], d->count, sizeof *d->spare))
            return PM_ENOMEM;
        d->room = rooms[0];
    }
    const size_t before = d->gift_lists;
    if (lists > before && pm__grow((void **)&d->gifts, &d->gift_lists, lists, sizeof *d->gifts))
        return PM_ENOMEM;
    for (size_t i = before; i < d->gift_lists; i++)
        d->gifts[i] = (pm__gifts){0};
    return PM_OK;
}

/* From arrival `begin` on about `count`, whole paths; at least one. */
static size_t batch_end(const pm__arrivals *all, size_t begin, size_t count)
{
    size_t end = all->count - begin < count ? all->count : begin + count;
    while (end < all->count && end > begin && all->numbers[end] == all->numbers[end - 1])
        end++;
    return end;
}

/* Whole paths of the batch that are sure not to store as many as are still wanted: none are stored that the decision
 * did not say. The first path at least. */
static size_t harmless(const pm__density *d)
{
    const size_t wanted = d->storage->config->stored, left = wanted - d->storage->stock.count;
    const uint32_t *const numbers = d->all->numbers + d->begin;
    size_t end = 0;
    for (size_t i = 0, stored = 0; i < d->count; i++) {
        stored += d->arrivals[i].verdict == PM__STORE;
        if (stored >= left)
            return end > 0 ? end : batch_end(d->all, d->begin, 1) - d->begin;
        if (i + 1 < d->count && numbers[i + 1] != numbers[i])
            end = i + 1;
    }
    return d->count;
}

static pm_status decide(pm__density *d)
{
    return reserve(d) ? PM_ENOMEM : pm__density_decide(d);
}

/* Decides so many of the batch that those before the last path do not end storing. */
static pm_status decide_harmless(pm__density *d)
{
    pm_status status = decide(d);
    const size_t some = status == PM_OK ? harmless(d) : d->count;
    if (some == d->count)
        return status;
    d->count = some;
    return decide(d);
}

/* *ended: by its one path there would be enough. */
static pm_status run_batch(keeper *k, bool *ended)
{
    pm__density *const d = &k->density;
    pm__stock *const stock = &d->storage->stock;
    const size_t before = stock->count;
    d->emitted = (double)(d->all->first + d->all->numbers[d->begin] + 1);
    pm__crowd_settle(&d->crowd);
    pm_status status = decide_harmless(d);
    if (status == PM_OK)
        status = settle_all(d);
    *ended = stock->count >= d->storage->config->stored;
    if (status != PM_OK)
        return status;
    if (*ended && !pm__path_is_first(d->all, d->begin)) {
        stock->count = before;
        return PM_OK;
    }
    hand_out(d);
    return count_up(k);
}

static size_t batch_size(const keeper *k)
{
    const double stored = (double)k->density.storage->stock.count;
    return (size_t)fmax((double)LEAST, fmin(stored / SHARE_STORED / fmax(k->rate, 1e-3), (double)MOST));
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    keeper *const k = storage->own;
    pm__density *const d = &k->density;
    pm_status status = PM_OK;
    bool ended = false;
    d->all = arrivals;
    for (*taken = 0; *taken < arrivals->count && status == PM_OK && !ended;) {
        d->begin = *taken;
        d->count = batch_end(arrivals, *taken, batch_size(k)) - *taken;
        const size_t before = storage->stock.count;
        status = run_batch(k, &ended);
        k->rate = status == PM_OK ? (double)(storage->stock.count - before) / (double)d->count : 0.0;
        if (!ended || pm__path_is_first(arrivals, d->begin))
            *taken += d->count;
    }
    return status;
}

/* ---- Beginning and end -------------------------------------------------------------------------- */

static pm_status begin(pm__storage *storage)
{
    const pm__storing_config *const config = storage->config;
    keeper *const k = storage->own = pm__alloc_zero(1, sizeof *k);
    if (!k)
        return PM_ENOMEM;
    pm__density *const d = &k->density;
    d->storage = storage;
    d->kernel = pm__crowd_choose();
    d->rule = rule_of(config);
    if (d->rule.power && !config->global)
        return pm__fail(storage->error, PM_EINVAL, "the convergence of caustics needs a map of all light");
    const double mean = config->importance ? pm__importance_mean(config->importance, config->kind) : 0.0;
    const double usual = pm__density_required(config->policy, config->kind, config->importance, mean);
    return pm__crowd_init(&d->crowd, pm__density_searched(&d->rule, pm__density_reach(&d->rule, usual)),
                          d->rule.constant > 0.0);
}

/* Of photons of the last tenth that came to important places one in a hundred found too few. */
static bool is_unmet(const keeper *k)
{
    size_t arrived = 0, lacking = 0;
    for (size_t i = k->tally_count; i-- > 0;) {
        if (i + 1 < k->tally_count && (double)k->tallies[i].first < 0.9 * k->density.emitted)
            break;
        arrived += k->tallies[i].arrived;
        lacking += k->tallies[i].lacking;
    }
    return (double)lacking > 0.01 * (double)arrived;
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    const keeper *const k = storage->own;
    for (size_t i = 0; i < storage->stock.count; i++)
        for (int b = 0; b < 3; b++)
            storage->stock.photons[i].power[b] = (float)k->density.powers[i][b];
    *unmet = is_unmet(k);
    return PM_OK;
}

static void release(pm__storage *storage)
{
    keeper *const k = storage->own;
    if (!k)
        return;
    pm__density *const d = &k->density;
    for (size_t i = 0; i < d->gift_lists; i++)
        free(d->gifts[i].items);
    pm__crowd_free(&d->crowd);
    free(d->powers);
    free(d->arrivals);
    free(d->sorted);
    free(d->spare);
    free(d->gifts);
    free(k->tallies);
    free(k);
}

const pm__keeping pm__keep_density = {.begin = begin, .keep = keep, .end = end, .release = release};
