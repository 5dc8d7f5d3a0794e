/* How many photons there are, and what each stands for.
 *
 * Emitted: e of them, so each stands for 1/e. Stored: see shares.c.
 *
 * A sampler's set must be whole, so its size may not depend on what it stores: a trial run settles it. */
#include "shoot.h"

#include "emission.h"
#include "harvest.h"
#include "shares.h"

#include <stdlib.h>

enum { FEWEST_TRIED = 500, MOST_TRIED = 10000, TRIED_SHARE = 16 };

static void trace_range(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    (void)pm__trace(tracing, first, count, store, context);
}

static void trace_straight(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    pm__trace_straight(tracing, first, count, store, context);
}

/* ---- Stored photons -------------------------------------------------------------------------- */

static pm_status too_few(const pm__harvest *h, size_t wanted, pm_error *error)
{
    return pm__fail(error, PM_EINVAL, "%zu of %zu photons were stored when %llu had been emitted: given up", h->count,
                    wanted, (unsigned long long)h->emitted);
}

static pm_status shoot_stored(const pm__shoot_config *config, const pm__emission *emission, pm__harvest *h,
                              pm_error *error)
{
    const pm__trace_config tracing = {config->scene, config->paths, config->seed, config->trial, emission};
    const pm__harvest_wish wish = {.tracer = trace_range, .tracing = &tracing, .power = emission->total,
                                   .most = config->most ? config->most : PM__MOST_TRACED,
                                   .wanted = config->count, .marks = true};
    const pm_status status = pm__harvest_paths(config, &wish, h, error);
    if (status != PM_OK)
        return status;
    if (h->count >= config->count)
        return pm__share_wanted(config, h, emission->total, error);
    return config->most ? pm__share_alike(config, h, 1.0 / (double)h->emitted, error)
                        : too_few(h, config->count, error);
}

/* ---- Emitted photons ------------------------------------------------------------------------- */

static pm_status shoot_emitted(const pm__shoot_config *config, const pm__emission *emission, uint64_t count,
                               pm__tracer tracer, pm__harvest *h, pm_error *error)
{
    const pm__trace_config tracing = {config->scene, config->paths, config->seed, config->trial, emission};
    const pm__harvest_wish wish = {.tracer = tracer, .tracing = &tracing, .power = emission->total,
                                   .share = 1.0 / (double)count, .most = count, .wanted = SIZE_MAX,
                                   .marks = tracer == trace_straight};
    const pm_status status = pm__harvest_paths(config, &wish, h, error);
    return status == PM_OK && h->count > 0 ? pm__check_smallness(wish.power, wish.share, error) : status;
}

/* How many to emit for about config->count to be stored: by independent paths with numbers of their own. */
static pm_status try_out(const pm__shoot_config *config, const pm__emission *emission, uint64_t *count, pm_error *error)
{
    const pm__trace_config tracing = {config->scene, config->paths, config->seed, config->trial, emission};
    pm__shoot_config plain = *config;
    plain.normals = false;
    plain.room = NULL;
    size_t wanted = config->count / TRIED_SHARE;
    wanted = wanted < FEWEST_TRIED ? FEWEST_TRIED : wanted > MOST_TRIED ? MOST_TRIED : wanted;
    const pm__harvest_wish wish = {.tracer = trace_range, .tracing = &tracing, .power = emission->total,
                                   .first = PM__MOST_TRACED, .most = PM__MOST_TRACED / 2, .wanted = wanted};
    pm__harvest h;
    pm_status status = pm__harvest_paths(&plain, &wish, &h, error);
    if (status != PM_OK)
        return status;
    const double needed = fmax(1.0, rint((double)config->count * (double)h.emitted / (double)h.count));
    if (config->most && !(h.count >= wanted && needed < (double)config->most))
        *count = config->most;
    else if (h.count < wanted)
        status = too_few(&h, wanted, error);
    else
        *count = (uint64_t)needed;
    pm__harvest_free(&h);
    return status;
}

static pm_status shoot_spread(const pm__shoot_config *config, pm__emission *emission, pm__tracer tracer, pm__harvest *h,
                              pm_error *error)
{
    uint64_t count = config->count;
    pm_status status = config->emitted ? PM_OK : try_out(config, emission, &count, error);
    if (status == PM_OK)
        status = pm__emission_spread(emission, config->sampler, count, error);
    if (status != PM_OK)
        return status;
    status = shoot_emitted(config, emission, pm__emission_count(emission), tracer, h, error);
    if (status == PM_OK && !config->emitted && !config->most && h->count == 0)
        status = too_few(h, config->count, error);
    pm__emission_free(emission);
    return status;
}

/* ---- Both ------------------------------------------------------------------------------------ */

/* Of an array with room to spare, what is in use. */
static void trim(void **array, size_t bytes)
{
    void *const trimmed = *array ? realloc(*array, bytes ? bytes : 1) : NULL;
    if (trimmed)
        *array = trimmed;
}

static bool is_in_room(const pm__shoot_config *config, const pm__harvest *h)
{
    return config->room && h->photons == config->room->photons;
}

static void drop(const pm__shoot_config *config, pm__harvest *h)
{
    if (is_in_room(config, h))
        *config->room = (pm__photon_room){NULL, 0};
    pm__harvest_free(h);
}

static void hand_over(const pm__shoot_config *config, pm__harvest *h, pm__photon_set *set)
{
    if (is_in_room(config, h)) {
        *set = (pm__photon_set){h->photons, NULL, h->count, h->emitted, true};
        return;
    }
    trim((void **)&h->photons, h->count * sizeof *h->photons);
    trim((void **)&h->normals, h->count * sizeof *h->normals);
    *set = (pm__photon_set){h->photons, h->normals, h->count, h->emitted, false};
    free(h->marks);
}

static pm_status check(const pm__shoot_config *config, const pm__emission *emission, pm_error *error)
{
    const uint64_t most = config->emitted ? PM__MOST_TRACED : PM_MAX_PHOTONS;
    if (config->count > most)
        return pm__fail(error, PM_EINVAL, "%zu photons %s: at most %llu can be", config->count,
                        config->emitted ? "emitted" : "stored", (unsigned long long)most);
    if (!isfinite(emission->total))
        return pm__fail(error, PM_EINVAL, "the lights' power adds up to %g W", emission->total);
    if (!config->emitted && config->count > 0 && !(emission->total > 0.0))
        return pm__fail(error, PM_EINVAL, "%zu photons are to be stored, and no light reaches where they are sent",
                        config->count);
    return PM_OK;
}

pm_status pm__shoot(const pm__shoot_config *config, pm__photon_set *set, pm_error *error)
{
    pm__emission emission;
    pm__harvest h = {0};
    *set = (pm__photon_set){0};
    pm__emission_init(config->scene, config->projection, PM__ALL_LIGHTS, config->seed, config->trial, &emission);
    pm_status status = check(config, &emission, error);
    if (status != PM_OK || config->count == 0)
        return status;
    if (config->sampler && !config->sampler->independent)
        status = shoot_spread(config, &emission, trace_range, &h, error);
    else if (config->emitted)
        status = shoot_emitted(config, &emission, config->count, trace_range, &h, error);
    else
        status = shoot_stored(config, &emission, &h, error);
    if (status == PM_OK)
        hand_over(config, &h, set);
    else
        drop(config, &h);
    return status;
}

/* Which of the photons have no power. */
static pm_status list_shadows(const pm__harvest *h, unsigned char **shadow, pm_error *error)
{
    *shadow = malloc(h->count ? h->count : 1);
    if (!*shadow)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu shadow photons", h->count);
    for (size_t i = 0; i < h->count; i++)
        (*shadow)[i] = (h->marks[i] & PM__NO_POWER) != 0;
    return PM_OK;
}

pm_status pm__shoot_shadows(const pm__shoot_config *config, size_t light, pm__photon_set *set, unsigned char **shadow,
                            pm_error *error)
{
    pm__shoot_config all = *config;
    all.emitted = true;
    all.room = NULL;
    pm__emission emission;
    pm__harvest h = {0};
    *set = (pm__photon_set){0};
    *shadow = NULL;
    if (light >= pm__scene_light_count(config->scene))
        return pm__fail(error, PM_EINVAL, "there is no light %zu", light);
    pm__emission_init(config->scene, NULL, light, config->seed, config->trial, &emission);
    pm_status status = check(&all, &emission, error);
    if (status != PM_OK)
        return status;
    if (config->count > 0 && config->sampler && !config->sampler->independent)
        status = shoot_spread(&all, &emission, trace_straight, &h, error);
    else if (config->count > 0)
        status = shoot_emitted(&all, &emission, config->count, trace_straight, &h, error);
    if (status == PM_OK)
        status = list_shadows(&h, shadow, error);
    if (status == PM_OK)
        hand_over(&all, &h, set);
    else
        pm__harvest_free(&h);
    return status;
}

void pm__photon_set_free(pm__photon_set *set)
{
    if (!set->borrowed)
        free(set->photons);
    free(set->normals);
    *set = (pm__photon_set){0};
}
