/* Photons of a trial, and the maps made of them. */
#include "bench.h"

#include "../base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { SEPARATE, RANDOM, ROUND_ROBIN }; /* the choices of combined's `deal` */

bool pm__is_separate(const pm__deal *deal)
{
    return deal->how == SEPARATE;
}

/* Separately drawn maps are trials of their own: numbers that no trial reaches. */
static uint32_t stream(uint32_t trial, uint32_t part)
{
    return trial + (part << 24);
}

static void init_points(const pm__job *job, uint32_t trial, size_t count, pm__points *points)
{
    double aspect[2] = {1.0, 1.0};
    if (job->subject->aspect)
        job->subject->aspect(job->values, aspect);
    pm__points_init(points, (const pm__sampler *)(const void *)job->sampler_spec->entry, job->config->seed,
                    PM__FOR_PHOTONS, trial, count, job->subject->sample_dimensions,
                    job->subject->strata_dimensions, aspect);
}

size_t pm__drawn_count(const pm__job *job, size_t count)
{
    if (pm__is_traced(job->subject))
        return count;
    pm__points points;
    init_points(job, 0, count, &points);
    return (size_t)points.count;
}

/* Photons until enough are stored. */
typedef struct tracing {
    pm_photon *photons;
    float (*normals)[3];
    size_t wanted, stored;
    uint64_t emitted;
} tracing;

static bool store(void *context, uint64_t number, const pm__stored *photon)
{
    tracing *const t = context;
    pm_photon *const to = &t->photons[t->stored];
    for (int a = 0; a < 3; a++) {
        to->position[a] = (float)photon->position[a];
        to->direction[a] = (float)photon->direction[a];
        to->power[a] = (float)photon->power[a];
        if (t->normals)
            t->normals[t->stored][a] = (float)photon->normal[a];
    }
    t->emitted = number + 1;
    return ++t->stored < t->wanted;
}

/* The number emitted until the N-th is stored is not independent of what is stored: N - 1 of one less is right (errata
 * 37; inverse binomial sampling). */
static pm_status trace_photons(const pm__job *job, uint32_t trial, uint32_t parts, tracing *t)
{
    enum { PATIENCE = 100000 }; /* photons emitted for each that is wanted, before it is given up */
    const pm__trace_config config = {job->scene, job->paths, job->config->seed, trial};
    const uint64_t most = (uint64_t)PATIENCE * t->wanted;
    (void)pm__trace(&config, 0, most < PM__MOST_TRACED ? most : PM__MOST_TRACED, store, t);
    if (t->stored < t->wanted)
        return PM_EINVAL;
    const double share = t->wanted > 1 ? (double)(t->wanted - 1) / (double)(t->emitted - 1) : 1.0 / (double)t->emitted;
    const double factor = share / ((double)t->wanted * parts);
    for (size_t i = 0; i < t->stored; i++)
        for (int a = 0; a < 3; a++)
            t->photons[i].power[a] = (float)((double)t->photons[i].power[a] * factor);
    return PM_OK;
}

pm_status pm__draw_photons(const pm__job *job, uint32_t trial, uint32_t part, uint32_t parts, size_t count,
                           pm_photon *photons, float (*normals)[3])
{
    if (pm__is_traced(job->subject)) {
        tracing t = {.photons = photons, .normals = normals, .wanted = count};
        return count ? trace_photons(job, stream(trial, part), parts, &t) : PM_OK;
    }
    pm__points points;
    init_points(job, stream(trial, part), count, &points);
    const size_t drawn = (size_t)points.count;
    const float power = (float)(job->subject->power(job->values) / ((double)drawn * parts));
    for (size_t i = 0; i < drawn; i++) {
        double u[PM__MAX_DIMENSIONS], position[3], direction[3], normal[3];
        points.sampler->point(&points, i, u);
        job->subject->photon(job->values, u, position, direction, normal);
        for (int a = 0; a < 3; a++) {
            photons[i].position[a] = (float)position[a];
            photons[i].direction[a] = (float)direction[a];
            photons[i].power[a] = power;
            if (normals)
                normals[i][a] = (float)normal[a];
        }
    }
    return PM_OK;
}

/* To which of the deal's maps photon i goes. */
static size_t map_of(const pm__job *job, const pm__deal *deal, uint32_t trial, size_t i)
{
    if (deal->how == ROUND_ROBIN)
        return i % deal->maps;
    double u;
    pm__random_uniform(job->config->seed, PM__FOR_DEALING, trial, i, &u, 1);
    return (size_t)(u * (double)deal->maps);
}

/* A map for the search that the bench uses, built on this thread. */
static pm_status make_map(const pm__job *job, const pm_photon *photons, size_t count, pm_map **map)
{
    const pm_map_options options = {.search = pm_search_find(job->config->search)};
    return pm_map_create(photons, count, &options, map, NULL);
}

static pm_status separate_map(const pm__job *job, const pm__deal *deal, uint32_t trial, size_t m, pm_map **map)
{
    const size_t share = pm__share(job->photons, deal->maps, m);
    pm_photon *const part = pm__alloc(pm__drawn_count(job, share), sizeof *part);
    if (!part)
        return PM_ENOMEM;
    pm_status status = pm__draw_photons(job, trial, (uint32_t)m + 1, (uint32_t)deal->maps, share, part, NULL);
    if (status == PM_OK)
        status = make_map(job, part, pm__drawn_count(job, share), map);
    free(part);
    return status;
}

/* Photons by map, each map's in the order in which they were drawn; end[m]: where map m's end. hand: room for all. */
static pm_status deal_photons(const pm__job *job, const pm__deal *deal, uint32_t trial, const pm_photon *photons,
                              pm_photon *hand, size_t end[PM__MAX_MAPS])
{
    unsigned char *const to = pm__alloc(job->photons, sizeof *to);
    size_t next[PM__MAX_MAPS] = {0}, sum = 0;
    if (!to)
        return PM_ENOMEM;
    for (size_t i = 0; i < job->photons; i++) {
        to[i] = (unsigned char)map_of(job, deal, trial, i);
        next[to[i]]++;
    }
    for (size_t m = 0; m < deal->maps; m++) {
        sum += next[m];
        next[m] = sum - next[m];
        end[m] = sum;
    }
    for (size_t i = 0; i < job->photons; i++)
        hand[next[to[i]]++] = photons[i];
    free(to);
    return PM_OK;
}

static pm_status dealt_maps(const pm__job *job, const pm__deal *deal, uint32_t trial, const pm_photon *photons,
                            pm_map **maps)
{
    size_t end[PM__MAX_MAPS];
    pm_photon *const hand = pm__alloc(job->photons, sizeof *hand);
    pm_status status = hand ? deal_photons(job, deal, trial, photons, hand, end) : PM_ENOMEM;
    for (size_t m = 0, first = 0; m < deal->maps && status == PM_OK; first = end[m++])
        status = make_map(job, hand + first, end[m] - first, &maps[m]);
    free(hand);
    return status;
}

pm_status pm__deal_maps(const pm__job *job, const pm__deal *deal, uint32_t trial, const pm_photon *photons,
                        pm_map **maps)
{
    pm_status status = PM_OK;
    if (!pm__is_separate(deal))
        return dealt_maps(job, deal, trial, photons, maps);
    for (size_t m = 0; m < deal->maps && status == PM_OK; m++)
        status = separate_map(job, deal, trial, m, &maps[m]);
    return status;
}

static pm_status build_maps(const pm__job *job, uint32_t trial, const pm_photon *photons, const float (*normals)[3],
                            pm__trial_maps *maps)
{
    pm_status status = make_map(job, photons, job->photons, &maps->map);
    for (size_t d = 0; d < job->deal_count && status == PM_OK; d++)
        status = pm__deal_maps(job, &job->deals[d], trial, photons, maps->dealt[d]);
    for (size_t f = 0; f < job->fraction_count && status == PM_OK; f++)
        status = pm__carriers_create(&maps->carriers[f], maps->map, job->fractions[f], normals, NULL);
    return status;
}

pm_status pm__trial_maps_create(const pm__job *job, uint32_t trial, pm__trial_maps *maps)
{
    memset(maps, 0, sizeof *maps);
    pm_photon *const photons = pm__alloc(job->photons, sizeof *photons);
    float(*const normals)[3] = job->fraction_count ? pm__alloc(job->photons, sizeof *normals) : NULL;
    pm_status status = PM_ENOMEM;
    if (photons && (normals || !job->fraction_count)) {
        status = pm__draw_photons(job, trial, 0, 1, job->asked_photons, photons, normals);
        if (status == PM_OK)
            status = build_maps(job, trial, photons, (const float(*)[3])normals, maps);
    }
    free(photons);
    free(normals);
    if (status != PM_OK)
        pm__trial_maps_destroy(maps);
    return status;
}

void pm__trial_maps_destroy(pm__trial_maps *maps)
{
    pm_map_destroy(maps->map);
    for (size_t d = 0; d < PM__MAX_VARIETIES; d++) {
        for (size_t m = 0; m < PM__MAX_MAPS; m++)
            pm_map_destroy(maps->dealt[d][m]);
        pm__carriers_destroy(&maps->carriers[d]);
    }
    memset(maps, 0, sizeof *maps);
}
