/* Arrivals are decided cell by cell of the crowd, so that what they search is gathered once and stays in the cache;
 * what those of one cell give to a neighbour is summed up there, in their order. */
#include "density.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../base/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { PIECE = 2048 };

/* ---- Before ------------------------------------------------------------------------------------- */

/* Where nothing is required, as many as are looked for are for the whole scene. */
double pm__density_reach(const pm__density_rule *rule, double required)
{
    static const double least = 1e-15;
    const double reach = required > 0.0 ? sqrt((double)rule->neighbors / (pi * required)) : rule->longest;
    return fmax(least, fmin(reach, rule->longest));
}

static double required(const pm__density_rule *rule, double importance)
{
    return rule->constant > 0.0 ? rule->constant
                                : rule->per_pixel * fmax(rule->low, fmin(importance, rule->high));
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

/* The last ten bits, two places between each. */
static uint32_t spread(int64_t coordinate)
{
    uint32_t bits = (uint32_t)coordinate & 0x3ff;
    bits = (bits | bits << 16) & 0x030000ff;
    bits = (bits | bits << 8) & 0x0300f00f;
    bits = (bits | bits << 4) & 0x030c30c3;
    return (bits | bits << 2) & 0x09249249;
}

/* Its place along a Morton curve, so that cells which share neighbours come one after the other. */
static uint32_t code_of(const pm__crowd_place *place)
{
    return (uint32_t)place->level << 30 | spread(place->cell[0]) << 2 | spread(place->cell[1]) << 1 |
           spread(place->cell[2]);
}

static void prepare_piece(void *argument, size_t piece)
{
    const pm__density *const d = argument;
    const pm__density_rule *const rule = &d->rule;
    const size_t end = (piece + 1) * PIECE < d->count ? (piece + 1) * PIECE : d->count;
    for (size_t i = piece * PIECE; i < end; i++) {
        const size_t at = d->begin + i;
        const float *const position = d->all->photons[at].position;
        const double importance = d->all->importance ? (double)d->all->importance[at] : 0.0;
        const double reach = pm__density_reach(rule, required(rule, importance));
        pm__arrival *const to = &d->arrivals[i];
        to->reach = (float)reach;
        const pm__crowd_place place =
            pm__crowd_place_of(&d->crowd, position, pm__density_searched(rule, (double)to->reach));
        to->key = place.key;
        to->global = rule->power ? (float)global_at(d->storage->config->global, position, d->all->normals[at]) : 0.0f;
        d->sorted[i] = (pm__order){code_of(&place), (uint32_t)i};
    }
}

/* By the codes of their cells, then by their own order. */
static void sort(pm__density *d)
{
    enum { BITS = 11 };
    for (unsigned shift = 0; shift < 3 * BITS; shift += BITS) {
        uint32_t starts[1 << BITS] = {0}, sum = 0;
        for (size_t i = 0; i < d->count; i++)
            starts[d->sorted[i].code >> shift & ((1 << BITS) - 1)]++;
        for (size_t b = 0; b < 1 << BITS; b++) {
            const uint32_t own = starts[b];
            starts[b] = sum;
            sum += own;
        }
        for (size_t i = 0; i < d->count; i++)
            d->spare[starts[d->sorted[i].code >> shift & ((1 << BITS) - 1)]++] = d->sorted[i];
        pm__order *const swapped = d->sorted;
        d->sorted = d->spare;
        d->spare = swapped;
    }
}

/* ---- Searching ---------------------------------------------------------------------------------- */

uint32_t pm__density_tag(const float normal[3], bool important)
{
    uint32_t bits[3], tag = important;
    memcpy(bits, normal, sizeof bits);
    for (int a = 0; a < 3; a++)
        tag = (tag ^ (bits[a] == 0x80000000u ? 0 : bits[a])) * 0x9e3779b1u ^ tag >> 15;
    return tag;
}

static pm__seeker seeker_of(const pm__density *d, uint32_t arrival)
{
    const size_t at = d->begin + arrival;
    const float *const position = d->all->photons[at].position;
    return (pm__seeker){.key = d->arrivals[arrival].key,
                        .position = {position[0], position[1], position[2]},
                        .reach = d->arrivals[arrival].reach,
                        .arrival = arrival,
                        .tag = pm__density_tag(d->all->normals[at], d->all->part[at])};
}

void pm__searcher_free(pm__searcher *with)
{
    pm__crowd_hood_free(&with->hood);
    pm__crowd_found_free(&with->found);
    free(with->sums);
}

/* What seekers of one cell search. */
static pm_status gather(const pm__density *d, const pm__seeker *seekers, size_t count, pm__searcher *with)
{
    double low[3], high[3], longest = 0.0;
    for (int a = 0; a < 3; a++) {
        float least = seekers[0].position[a], most = least;
        for (size_t i = 1; i < count; i++) {
            least = seekers[i].position[a] < least ? seekers[i].position[a] : least;
            most = seekers[i].position[a] > most ? seekers[i].position[a] : most;
        }
        low[a] = (double)least;
        high[a] = (double)most;
    }
    for (size_t i = 0; i < count; i++)
        longest = fmax(longest, (double)seekers[i].reach);
    longest = pm__density_searched(&d->rule, longest);
    for (int a = 0; a < 3; a++) {
        low[a] -= longest;
        high[a] += longest;
    }
    const pm__crowd_place place = pm__crowd_place_of(&d->crowd, seekers[0].position,
                                                     pm__density_searched(&d->rule, (double)seekers[0].reach));
    if (pm__crowd_gather(&d->crowd, &place, low, high, &with->hood) ||
        pm__crowd_found_reserve(&with->found, &with->hood) ||
        pm__grow((void **)&with->sums, &with->room, with->hood.count + 1, sizeof *with->sums))
        return PM_ENOMEM;
    memset(with->sums, 0, with->hood.count * sizeof *with->sums);
    return PM_OK;
}

/* ---- Deciding ----------------------------------------------------------------------------------- */

static bool faces(const pm_photon *photon, const float normal[3])
{
    return photon->direction[0] * normal[0] + photon->direction[1] * normal[1] + photon->direction[2] * normal[2] <
           0.0f;
}

/* Does it take power of the arrival? Only what faces it, and no light goes to where it matters from where it does not,
 * or the other way round: at that border densities may differ, and much would (erratum 42). */
static bool takes(const pm__density *d, uint32_t id, size_t at)
{
    const pm__stock *const stock = &d->storage->stock;
    return stock->part[id] == d->all->part[at] && faces(&stock->photons[id], d->all->normals[at]);
}

/* Of those found, those that take power of the seeker. */
static void keep_takers(const pm__density *d, const pm__seeker *seeker, pm__searcher *with)
{
    const pm__crowd_hood *const hood = &with->hood;
    const size_t at = d->begin + seeker->arrival;
    size_t kept = 0;
    if (hood->alike && hood->tags[0] == seeker->tag)
        return;
    for (size_t i = 0; i < with->found.count; i++) {
        const uint32_t place = with->found.places[i];
        with->found.places[kept] = place;
        kept += hood->tags[place] == seeker->tag || takes(d, hood->ids[place], at);
    }
    with->found.count = kept;
}

/* (L_g / L_c)^power, 1 at least; of the facing ones, in an area. */
static double criterion(const pm__density *d, double global, const pm__searcher *with, double area)
{
    double sum = 0.0;
    for (size_t i = 0; i < with->found.count; i++) {
        const double *const power = d->powers[with->hood.ids[with->found.places[i]]];
        sum += power[0] + power[1] + power[2];
    }
    const double caustic = sum * d->storage->unit / d->emitted / area, ratio = global / caustic;
    return ratio > 1.0 ? pow(ratio, d->rule.power) : 1.0;
}

/* By s = D_cur / D_r. */
static bool is_accepted(const pm__density *d, size_t arrival, double s)
{
    const size_t at = d->begin + arrival;
    double u[3];
    if (!d->rule.cosine)
        return s < 1.0;
    if (!(s < 2.0))
        return false;
    pm__random_triple(d->storage->config->seed, PM__FOR_STORING, d->storage->trial, d->all->first + d->all->numbers[at],
                      (uint32_t)(at - pm__path_begin(d->all, at)), u);
    return u[0] < 0.5 * (1.0 + cos(0.5 * pi * s));
}

/* Where D_cur itself is asked for; false: to be stored. */
static bool is_enough(const pm__density *d, const pm__seeker *seeker, pm__arrival *arrival, pm__searcher *with)
{
    const double reach = (double)seeker->reach, farthest2 = (double)d->kernel->farthest(&with->found);
    const bool all = with->found.count == d->rule.neighbors;
    double s = all ? reach * reach / farthest2 : (double)with->found.count / (4.0 * (double)d->rule.neighbors);
    arrival->lacks = !(s >= 1.0);
    if (with->found.count == 0)
        return false;
    keep_takers(d, seeker, with);
    if (d->rule.power)
        s *= criterion(d, (double)arrival->global, with, pi * (all ? farthest2 : 4.0 * reach * reach));
    return !is_accepted(d, seeker->arrival, s);
}

/* Leaves in `with` who is given the power, unless it is to be stored. */
static void decide(const pm__density *d, const pm__seeker *seeker, pm__searcher *with)
{
    const pm__density_rule *const rule = &d->rule;
    pm__arrival *const arrival = &d->arrivals[seeker->arrival];
    const double searched = pm__density_searched(rule, (double)seeker->reach);
    if (d->all->aside && d->all->aside[d->begin + seeker->arrival]) {
        arrival->verdict = PM__ASIDE;
        arrival->lacks = false;
        return;
    }
    d->kernel->find(&with->hood, seeker->position, (float)searched, rule->neighbors, &with->found);
    arrival->found = (uint16_t)with->found.count;
    bool enough = with->found.count == rule->neighbors;
    arrival->lacks = !enough;
    if (rule->wide)
        enough = is_enough(d, seeker, arrival, with);
    else if (enough)
        keep_takers(d, seeker, with);
    arrival->verdict = enough && with->found.count > 0 ? PM__SHARE_OUT : PM__STORE;
}

static void parts_of(const pm__density *d, uint32_t arrival, size_t receivers, double part[4])
{
    const pm_photon *const photon = &d->all->photons[d->begin + arrival];
    for (int b = 0; b < 3; b++)
        part[b] = (double)photon->power[b] / (double)receivers;
    part[3] = 1.0; /* who has been given anything */
}

static pm_status list_gifts(const pm__searcher *with, pm__gifts *gifts)
{
    const size_t count = with->hood.count;
    if (gifts->count + count > gifts->room &&
        pm__grow((void **)&gifts->items, &gifts->room, gifts->count + count, sizeof *gifts->items))
        return PM_ENOMEM;
    for (size_t i = 0; i < count; i++) {
        const double *const sum = with->sums[i];
        pm__gift *const to = &gifts->items[gifts->count];
        *to = (pm__gift){with->hood.ids[i], {sum[0], sum[1], sum[2]}};
        gifts->count += sum[3] > 0.0;
    }
    return PM_OK;
}

/* Seekers of one cell. */
static pm_status decide_run(const pm__density *d, const pm__seeker *seekers, size_t count, pm__searcher *with,
                            pm__gifts *gifts)
{
    if (gather(d, seekers, count, with))
        return PM_ENOMEM;
    for (size_t i = 0; i < count; i++) {
        decide(d, &seekers[i], with);
        if (d->arrivals[seekers[i].arrival].verdict == PM__SHARE_OUT) {
            double part[4];
            parts_of(d, seekers[i].arrival, with->found.count, part);
            d->kernel->give(with->found.places, with->found.count, part, with->sums);
        }
    }
    return with->hood.count ? list_gifts(with, gifts) : PM_OK;
}

static void decide_task(void *argument, size_t task)
{
    pm__density *const d = argument;
    const size_t begin = task * PM__DENSITY_TASK;
    const size_t count = d->count - begin < PM__DENSITY_TASK ? d->count - begin : PM__DENSITY_TASK;
    pm__seeker seekers[PM__DENSITY_TASK];
    pm__searcher with = {0};
    d->gifts[task].count = 0;
    for (size_t i = 0; i < count; i++)
        seekers[i] = seeker_of(d, d->sorted[begin + i].arrival);
    for (size_t first = 0, last; first < count; first = last) {
        for (last = first + 1; last < count && seekers[last].key == seekers[first].key;)
            last++;
        if (decide_run(d, seekers + first, last - first, &with, &d->gifts[task])) {
            d->status = PM_ENOMEM;
            break;
        }
    }
    pm__searcher_free(&with);
}

pm_status pm__density_decide(pm__density *d)
{
    const pm_parallel *const parallel = d->storage->config->parallel;
    pm__for(parallel, (d->count + PIECE - 1) / PIECE, prepare_piece, d);
    sort(d);
    pm__for(parallel, (d->count + PM__DENSITY_TASK - 1) / PM__DENSITY_TASK, decide_task, d);
    return d->status;
}

pm_status pm__density_again(pm__density *d, size_t arrival, pm__searcher *with)
{
    const pm__seeker seeker = seeker_of(d, (uint32_t)arrival);
    double part[4];
    if (gather(d, &seeker, 1, with))
        return PM_ENOMEM;
    decide(d, &seeker, with);
    if (d->arrivals[arrival].verdict != PM__SHARE_OUT)
        return PM_OK;
    parts_of(d, seeker.arrival, with->found.count, part);
    for (size_t i = 0; i < with->found.count; i++)
        for (int b = 0; b < 3; b++)
            d->powers[with->hood.ids[with->found.places[i]]][b] += part[b];
    return PM_OK;
}
