#include "cover.h"

#include "../../base/clock.h"
#include "../../base/memory.h"
#include "list.h"

#include <stdlib.h>
#include <string.h>

/* A trial's own numbers: those of the first are the seed's. */
static uint64_t seed_of(uint64_t seed, uint32_t trial)
{
    uint32_t words[4];
    pm__random_words(seed, PM__FOR_TRIALS, trial, 0, 0, words);
    return trial ? (uint64_t)words[0] << 32 | words[1] : seed;
}

size_t pm__run_state_count(const pm__progression *progression)
{
    const pm__progressive *const method = (const pm__progressive *)(const void *)progression->config->method->entry;
    return progression->points * (method->fields + (progression->config->estimates ? PM__OWN_FIELDS : 0));
}

pm_status pm__run_begin(const pm__progression *progression, uint32_t trial, pm__run *run, pm_error *error)
{
    *run = (pm__run){.of = progression, .seed = seed_of(progression->config->seed, trial)};
    const pm__progressive *const method = pm__progressive_of(run);
    run->state = pm__alloc_zero(pm__run_state_count(progression), sizeof *run->state);
    if (!run->state)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu points", progression->points);
    for (size_t i = 0; i < progression->points && method->begin; i++)
        method->begin(run, i, run->state + i * method->fields);
    return PM_OK;
}

void pm__run_end(pm__run *run)
{
    if (run->of && pm__progressive_of(run)->release)
        pm__progressive_of(run)->release(run);
    pm__cover_free(run->cover);
    free(run->room.photons);
    free(run->state);
    *run = (pm__run){.of = NULL};
}

pm_status pm__run_shoot(pm__run *run, uint32_t pass, pm__photon_set *set, pm_error *error)
{
    const pm__progressive_config *const config = run->of->config;
    const pm__shoot_config shooting = {.scene = run->of->stage.scene,
                                       .paths = run->of->paths,
                                       .seed = run->seed,
                                       .trial = pass,
                                       .sampler = config->sampler,
                                       .count = config->photons,
                                       .emitted = true,
                                       .room = run->of->meeting.by_photons ? &run->room : NULL,
                                       .parallel = config->parallel,
                                       .canceled = config->canceled,
                                       .context = config->context};
    const double start = pm__seconds();
    const pm_status status = pm__shoot(&shooting, set, error);
    run->trace_s += pm__seconds() - start;
    run->emitted += set->emitted;
    run->stored += set->count;
    return status;
}

static pm_status make_map(pm__run *run, const pm__photon_set *set, const pm_search *search, pm_map **map,
                          pm_error *error)
{
    const pm_map_options options = {
        .parallel = run->of->config->parallel, .search = search, .no_directions = !run->of->directions};
    const double start = pm__seconds();
    const pm_status status = pm_map_create(set->photons, set->count, &options, map, error);
    run->build_s += pm__seconds() - start;
    return status;
}

/* First radii are of the k nearest, whatever finds photons within a radius later. */
pm_status pm__run_map(pm__run *run, const pm__photon_set *set, pm_map **map, pm_error *error)
{
    const pm_search *const asked = run->of->config->search;
    const bool cannot = asked && asked->radius_only && pm__progressive_of(run)->shrinks;
    return make_map(run, set, cannot ? NULL : asked, map, error);
}

/* A map of one pass is asked once at each point: what it takes to build counts as much as how it answers, and a grid is
 * built in half the time of the boxes that find the k nearest. */
pm_status pm__run_pass_map(pm__run *run, const pm__photon_set *set, pm_map **map, pm_error *error)
{
    const pm_search *const asked = run->of->config->search;
    const bool radii = pm__progressive_of(run)->shrinks;
    return make_map(run, set, asked || !radii ? asked : pm_search_find("grid"), map, error);
}

/* Whether errors are estimated changes no bit of an answer: photons find the points all the same, once the points have
 * looked further for what tells of the bias. */
static pm_status find_points(pm__run *run, const pm__photon_set *set, bool *found, pm_error *error)
{
    pm_map *map = NULL;
    pm_status status = pm__cover_ready(run, found, error);
    if (status == PM_OK && *found && run->of->config->estimates)
        status = pm__run_pass_map(run, set, &map, error);
    if (status == PM_OK && map)
        status = pm__run_further_lookups(run, map, error);
    pm_map_destroy(map);
    return status == PM_OK && *found ? pm__run_splat(run, set, found, error) : status;
}

/* The photons are freed as soon as the map has them. */
static pm_status look_up(pm__run *run, pm__photon_set *set, pm_error *error)
{
    pm_map *map = NULL;
    pm_status status = pm__run_pass_map(run, set, &map, error);
    pm__photon_set_free(set);
    if (status == PM_OK)
        status = pm__run_lookups(run, map, error);
    pm_map_destroy(map);
    return status;
}

static pm_status photon_pass(pm__run *run, pm_error *error)
{
    pm__photon_set set = {0};
    bool found = false;
    pm_status status = pm__run_shoot(run, run->passes, &set, error);
    if (status == PM_OK && run->of->meeting.by_photons)
        status = find_points(run, &set, &found, error);
    if (status == PM_OK && !found)
        status = look_up(run, &set, error);
    pm__photon_set_free(&set);
    return status;
}

pm_status pm__run_pass(pm__run *run, pm_error *error)
{
    const pm__progressive *const method = pm__progressive_of(run);
    const pm_status status = method->pass ? method->pass(run, error) : photon_pass(run, error);
    if (status != PM_OK)
        return status;
    run->passes++;
    if (run->of->config->estimates)
        pm__run_own_take(run);
    return PM_OK;
}

pm_status pm__run_resume(pm__run *run, const double *state, uint32_t passes, pm_error *error)
{
    const pm__progressive *const method = pm__progressive_of(run);
    memcpy(run->state, state, pm__run_state_count(run->of) * sizeof *state);
    run->passes = passes;
    if (run->cover && !pm__cover_follow(run->cover, run)) {
        pm__cover_free(run->cover);
        run->cover = NULL;
    }
    return method->settle ? method->settle(run, error) : PM_OK;
}

pm_status pm__run_read(pm__run *run, double (*radiance)[3], pm_error *error)
{
    const pm__progressive *const method = pm__progressive_of(run);
    const pm_status status = method->settle ? method->settle(run, error) : PM_OK;
    for (size_t i = 0; i < run->of->points && status == PM_OK; i++) {
        const double *const emitted = run->of->fixed[i].emitted;
        radiance[i][0] = radiance[i][1] = radiance[i][2] = 0.0;
        if (run->passes)
            method->answer(run, run->state + i * method->fields, radiance[i]);
        for (int b = 0; b < 3 && !method->redraws; b++)
            radiance[i][b] += emitted[b];
    }
    return status;
}

pm__point_view pm__run_view(const pm__run *run, size_t point)
{
    const pm__progressive *const method = pm__progressive_of(run);
    return method->view ? method->view(run, point, run->state + point * method->fields) : (pm__point_view){0.0, 0.0};
}
