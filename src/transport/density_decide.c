/* Arrivals are dealt to shards of plots, and those of a shard decided by one thread, in their order: so each is decided
 * as it would be one by one. */
#include "density.h"

#include "../base/parallel.h"
#include "../base/random.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- Before ------------------------------------------------------------------------------------- */

float pm__density_at(const pm__density_rule *rule, float importance)
{
    const float there = rule->per_pixel * importance;
    return there > rule->low ? there < rule->high ? there : rule->high : rule->low;
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

/* Those put aside go to no plot. */
static bool is_aside(const pm__density *d, size_t i)
{
    return d->all->aside && d->all->aside[d->begin + i];
}

static void place_all(pm__density *d, size_t first, size_t count, pm__plot_place *places)
{
    const size_t at = d->begin + first;
    float required[PM__DENSITY_PIECE];
    required[0] = d->rule.low;
    for (size_t i = 0; i < count; i++)
        required[i] = pm__density_at(&d->rule, d->all->importance ? d->all->importance[at + i] : 0.0f);
    pm__plots_place(&d->plots, d->all->photons + at, d->all->normals + at, required, d->all->part + at, count, places);
    for (size_t i = 0; i < count && d->global; i++)
        d->global[first + i] =
            (float)((double)places[i].area * global_at(d->storage->config->global, d->all->photons[at + i].position,
                                                       d->all->normals[at + i]));
}

static void prepare_piece(void *argument, size_t piece)
{
    pm__density *const d = argument;
    const size_t first = piece * PM__DENSITY_PIECE, count = pm__density_piece_end(d, piece) - first;
    uint16_t *const begin = d->runs[piece].begin;
    pm__plot_place places[PM__DENSITY_PIECE];
    const bool is_even = d->rule.low == d->rule.high; /* required density is nowhere another */
    uint16_t ends[PM__PLOT_SHARDS] = {0}, sum = 0;
    place_all(d, first, count, places);
    for (size_t i = 0; i < count; i++) {
        const size_t s = places[i].shard;
        ends[s] = (uint16_t)(ends[s] + !is_aside(d, first + i));
    }
    for (size_t s = 0; s < PM__PLOT_SHARDS; s++) {
        begin[s] = sum;
        sum = (uint16_t)(sum + ends[s]);
        ends[s] = begin[s];
    }
    begin[PM__PLOT_SHARDS] = sum;
    for (size_t i = 0; i < count; i++) {
        if (is_aside(d, first + i))
            continue;
        const size_t at = d->begin + first + i;
        pm__seeker *const to = &d->seekers[first + ends[places[i].shard]++];
        to->key = places[i].key;
        to->beside = is_even ? 0 : places[i].beside;
        to->wanted = places[i].wanted;
        memcpy(to->at, places[i].at, sizeof to->at);
        to->arrival = (uint32_t)(first + i) & 0x3fffffff;
        memcpy(to->power, d->all->photons[at].power, sizeof to->power);
        memcpy(to->normal, d->all->normals[at], sizeof to->normal);
        memcpy(to->direction, d->all->photons[at].direction, sizeof to->direction);
    }
}

void pm__density_prepare(pm__density *d)
{
    pm__for(d->storage->config->parallel, pm__density_pieces(d->count), prepare_piece, d);
}

/* ---- Deciding ----------------------------------------------------------------------------------- */

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* (L_g / L_c)^power, 1 at least, by what came to the plot. */
static double criterion(const pm__density *d, const pm__seeker *seeker, double light)
{
    const double caustic = light * d->storage->unit / d->emitted, ratio = (double)d->global[seeker->arrival] / caustic;
    return ratio > 1.0 ? pow(ratio, d->rule.power) : 1.0;
}

static bool is_by_chance(const pm__density *d, const pm__seeker *seeker, double s)
{
    const size_t at = d->begin + seeker->arrival;
    double u[3];
    if (!(s < 2.0))
        return false;
    pm__random_triple(d->storage->config->seed, PM__FOR_STORING, d->storage->trial, d->all->first + d->all->numbers[at],
                      (uint32_t)(at - pm__path_begin(d->all, at)), u);
    return u[0] < 0.5 * (1.0 + cos(0.5 * pi * s));
}

/* By what is stored over what is required. light: power of all that came to the plot; NULL: not asked for. */
static bool is_stored_by_rule(const pm__density *d, const pm__seeker *seeker, const pm__plot *plot, const double *light)
{
    double s = (double)plot->stored / (double)pm__plot_wanted(plot);
    if (light)
        s *= criterion(d, seeker, *light / (double)pm__plot_filled(plot));
    return d->rule.cosine ? is_by_chance(d, seeker, s) : s < 1.0;
}

static pm_status store(pm__density *d, size_t shard, pm__seeker *seeker, pm__plot *plot)
{
    seeker->takes = dot(seeker->direction, plot->normal) < 0.0f;
    plot->takers += seeker->takes;
    plot->stored++;
    if (!seeker->beside)
        return PM_OK;
    pm__plot *const next = pm__plot_add(&d->plots, shard, seeker->beside);
    if (!next)
        return PM_ENOMEM;
    next->stored++;
    return PM_OK;
}

static void wait(const pm__seeker *seeker, pm__plot *plot)
{
    for (int b = 0; b < 3; b++)
        plot->waiting[b] += (double)seeker->power[b];
}

static pm_status decide(pm__density *d, size_t shard, pm__seeker *seeker, pm__density_tally *tally)
{
    pm__plot *const plot = pm__plot_add(&d->plots, shard, seeker->key);
    if (!plot)
        return PM_ENOMEM;
    const pm__plot_shard *const own = &d->plots.shards[shard];
    double *const light = own->light ? &own->light[plot - own->plots] : NULL;
    const bool matters = !d->all->importance || pm__plot_is_important(seeker->key);
    if (plot->came == 0)
        memcpy(plot->normal, seeker->normal, sizeof plot->normal);
    pm__plot_meet(plot, seeker->wanted, seeker->at);
    const bool lacks = !pm__plot_is_full(plot) && (double)plot->stored < (double)pm__plot_wanted(plot);
    tally->arrived += matters;
    tally->lacking += matters && lacks;
    /* None takes what waits there: then it is stored. */
    seeker->is_stored = !plot->takers || (d->rule.cosine || light ? is_stored_by_rule(d, seeker, plot, light) : lacks);
    seeker->takes = false;
    if (light)
        *light += (double)seeker->power[0] + (double)seeker->power[1] + (double)seeker->power[2];
    if (seeker->is_stored)
        return store(d, shard, seeker, plot); /* plots may have moved */
    wait(seeker, plot);
    return PM_OK;
}

/* Fetched while those before them are decided. */
enum { AHEAD = 12 };

static void fetch(const pm__density *d, size_t shard, const pm__seeker *seeker)
{
    pm__plot_prefetch(&d->plots.shards[shard], seeker->key);
    if (seeker->beside)
        pm__plot_prefetch(&d->plots.shards[shard], seeker->beside);
}

static void fetch_run(const pm__density *d, size_t piece, size_t shard)
{
    const pm__density_runs *const runs = &d->runs[piece];
    const pm__seeker *const seekers = d->seekers + piece * PM__DENSITY_PIECE;
    for (size_t i = runs->begin[shard]; i < runs->begin[shard + 1] && i < runs->begin[shard] + (size_t)AHEAD; i++)
        fetch(d, shard, &seekers[i]);
}

static pm_status decide_run(pm__density *d, size_t piece, size_t shard, pm__density_tally *tally)
{
    pm__density_runs *const runs = &d->runs[piece];
    pm__seeker *const seekers = d->seekers + piece * PM__DENSITY_PIECE;
    const size_t begin = runs->begin[shard], end = runs->begin[shard + 1];
    uint16_t stored = 0;
    pm_status status = PM_OK;
    for (size_t i = begin; i < end && status == PM_OK && seekers[i].arrival < d->count; i++) {
        if (i + AHEAD < end)
            fetch(d, shard, &seekers[i + AHEAD]);
        status = decide(d, shard, &seekers[i], tally);
        stored = (uint16_t)(stored + seekers[i].is_stored);
    }
    runs->stored[shard] = stored;
    return status;
}

static void decide_shard(void *argument, size_t shard)
{
    pm__density *const d = argument;
    pm__density_tally tally = {0, 0};
    const size_t pieces = pm__density_pieces(d->count);
    for (size_t piece = 0; piece < pieces; piece++) {
        if (piece + 1 < pieces)
            fetch_run(d, piece + 1, shard);
        if (decide_run(d, piece, shard, &tally))
            d->status = PM_ENOMEM;
    }
    d->tallies[shard] = tally;
}

pm_status pm__density_decide(pm__density *d)
{
    pm__for(d->storage->config->parallel, PM__PLOT_SHARDS, decide_shard, d);
    return d->status;
}
