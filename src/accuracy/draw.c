/* Photons of a trial, and the maps made of them. */
#include "bench.h"

#include "../base/memory.h"
#include "../transport/deal.h"

#include <stdlib.h>
#include <string.h>

bool pm__is_separate(const pm__deal_kind *deal)
{
    return deal->how == PM__DEAL_SEPARATE;
}

/* Separately drawn maps are trials of their own: numbers that no trial reaches. */
static uint32_t stream(uint32_t trial, uint32_t part)
{
    return trial + (part << 24);
}

static const pm__sampler *sampler_of(const pm__job *job)
{
    return (const pm__sampler *)(const void *)job->sampler_spec->entry;
}

static void init_points(const pm__job *job, uint32_t trial, size_t count, pm__points *points)
{
    double aspect[2] = {1.0, 1.0};
    if (job->subject->aspect)
        job->subject->aspect(job->values, aspect);
    pm__points_init(points, sampler_of(job), job->config->seed, PM__FOR_PHOTONS, trial, count,
                    job->subject->sample_dimensions, job->subject->strata_dimensions, aspect);
}

bool pm__is_about(const pm__job *job)
{
    return pm__is_traced(job->subject) && !sampler_of(job)->independent;
}

size_t pm__drawn_count(const pm__job *job, size_t count)
{
    if (pm__is_traced(job->subject))
        return count;
    pm__points points;
    init_points(job, 0, count, &points);
    return (size_t)points.count;
}

/* Each of several maps has its part of the power. */
static pm_status shoot_photons(const pm__job *job, uint32_t trial, uint32_t parts, size_t count, bool normals,
                               pm__photon_set *set)
{
    const pm__shoot_config config = {.scene = job->scene,
                                     .paths = job->paths,
                                     .seed = job->config->seed,
                                     .trial = trial,
                                     .sampler = sampler_of(job),
                                     .count = count,
                                     .normals = normals,
                                     .canceled = job->config->canceled,
                                     .context = job->config->context};
    const pm_status status = pm__shoot(&config, set, NULL);
    for (size_t i = 0; i < set->count && parts > 1; i++)
        for (int a = 0; a < 3; a++)
            set->photons[i].power[a] /= (float)parts;
    return status;
}

static void draw_photon(const pm__job *job, const pm__points *points, size_t i, float power, pm__photon_set *set)
{
    double u[PM__MAX_DIMENSIONS], position[3], direction[3], normal[3];
    points->sampler->point(points, i, u);
    job->subject->photon(job->values, u, position, direction, normal);
    for (int a = 0; a < 3; a++) {
        set->photons[i].position[a] = (float)position[a];
        set->photons[i].direction[a] = (float)direction[a];
        set->photons[i].power[a] = power;
        if (set->normals)
            set->normals[i][a] = (float)normal[a];
    }
}

pm_status pm__draw_photons(const pm__job *job, uint32_t trial, uint32_t part, uint32_t parts, size_t count,
                           bool normals, pm__photon_set *set)
{
    if (pm__is_traced(job->subject))
        return shoot_photons(job, stream(trial, part), parts, count, normals, set);
    pm__points points;
    init_points(job, stream(trial, part), count, &points);
    const size_t drawn = (size_t)points.count;
    *set = (pm__photon_set){.photons = pm__alloc(drawn, sizeof *set->photons),
                            .normals = normals ? pm__alloc(drawn, sizeof *set->normals) : NULL,
                            .count = drawn,
                            .emitted = drawn};
    if (!set->photons || (normals && !set->normals)) {
        pm__photon_set_free(set);
        return PM_ENOMEM;
    }
    const float power = (float)(job->subject->power(job->values) / ((double)drawn * parts));
    for (size_t i = 0; i < drawn; i++)
        draw_photon(job, &points, i, power, set);
    return PM_OK;
}

/* Of a map for the search that the bench uses, built on this thread. */
static pm_map_options options_of(const pm__job *job)
{
    return (pm_map_options){.search = pm_search_find(job->config->search)};
}

static pm_status make_map(const pm__job *job, const pm_photon *photons, size_t count, pm_map **map)
{
    const pm_map_options options = options_of(job);
    return pm_map_create(photons, count, &options, map, NULL);
}

static pm_status separate_map(const pm__job *job, const pm__deal_kind *deal, uint32_t trial, size_t m, pm_map **map)
{
    const size_t share = pm__share(job->photons, deal->maps, m);
    pm__photon_set part;
    pm_status status = pm__draw_photons(job, trial, (uint32_t)m + 1, (uint32_t)deal->maps, share, false, &part);
    if (status == PM_OK)
        status = make_map(job, part.photons, part.count, map);
    pm__photon_set_free(&part);
    return status;
}

static pm_status dealt_maps(const pm__job *job, const pm__deal_kind *deal, uint32_t trial, const pm__photon_set *set,
                            pm_map **maps)
{
    const pm__dealing dealing = {deal->maps, deal->how == PM__DEAL_ROUND_ROBIN, job->config->seed, trial};
    const pm_map_options options = options_of(job);
    return pm__deal(&dealing, set->photons, set->count, &options, maps, NULL);
}

pm_status pm__deal_maps(const pm__job *job, const pm__deal_kind *deal, uint32_t trial, const pm__photon_set *set,
                        pm_map **maps)
{
    pm_status status = PM_OK;
    if (!pm__is_separate(deal))
        return dealt_maps(job, deal, trial, set, maps);
    for (size_t m = 0; m < deal->maps && status == PM_OK; m++)
        status = separate_map(job, deal, trial, m, &maps[m]);
    return status;
}

static pm_status build_maps(const pm__job *job, uint32_t trial, const pm__photon_set *set, pm__trial_maps *maps)
{
    pm_status status = make_map(job, set->photons, set->count, &maps->map);
    for (size_t d = 0; d < job->deal_count && status == PM_OK; d++)
        status = pm__deal_maps(job, &job->deals[d], trial, set, maps->dealt[d]);
    for (size_t f = 0; f < job->fraction_count && status == PM_OK; f++)
        status = pm__carriers_create(&maps->carriers[f], maps->map, job->fractions[f],
                                     (const float(*)[3])set->normals, NULL);
    return status;
}

pm_status pm__trial_maps_create(const pm__job *job, uint32_t trial, pm__trial_maps *maps)
{
    memset(maps, 0, sizeof *maps);
    pm__photon_set set;
    pm_status status = pm__draw_photons(job, trial, 0, 1, job->asked_photons, job->fraction_count > 0, &set);
    if (status == PM_OK)
        status = build_maps(job, trial, &set, maps);
    pm__photon_set_free(&set);
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
