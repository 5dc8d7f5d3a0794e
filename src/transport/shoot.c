/* How many photons there are, and what each stands for.
 *
 * Emitted: e of them, so each stands for 1/e.
 *
 * Stored, N of them, independent paths. Path i stores k_i photons; tracing ends with the path e by which there are N
 * or more, S = N + o in all. e depends on what was stored, so 1/e would be bright (errata 37). Unbiased of the light
 * F that a path carries is F_1, that of the first path; and so is its expectation given all e paths but not their order
 * (Rao and Blackwell). All orders in which tracing ends with the last path are equally likely: those whose last path
 * stores more than o, since S less it must be below N. With J the paths that store more than o, the first path is any
 * but the last, which is any of J:
 *     E[F_1 | paths] = (sum_i F_i - (1/|J|) sum_J F_i) / (e - 1)    (F_1 itself if e = 1).
 * Where a path stores one photon at most, this is (N - 1)/(e - 1)/N for each. The o that are too many are dropped at
 * random among all, so that each left stands for S/N.
 *
 * Where tracing ends with path m at the latest, and there are not N by then, each stands for 1/m: the orders of those
 * paths are equally likely too, and none ends sooner, so that the two cases together are unbiased.
 *
 * A sampler's set must be whole, so its size may not depend on what it stores: a trial run settles it. */
#include "shoot.h"

#include "../base/parallel.h"
#include "emission.h"
#include "harvest.h"

#include <float.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* The number whose blocks say which photons are dropped. */
#define DROPPING (PM__OTHER_NUMBERS + 2)

enum { FEWEST_TRIED = 500, MOST_TRIED = 10000, TRIED_SHARE = 16 };

static void trace_range(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    (void)pm__trace(tracing, first, count, store, context);
}

static void trace_straight(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    pm__trace_straight(tracing, first, count, store, context);
}

/* ---- Powers ---------------------------------------------------------------------------------- */

/* Powers in W of photons from .. to - 1, each of which stands for `share` of what is sent. */
static pm_status scale(pm__harvest *h, size_t from, size_t to, double share, pm_error *error)
{
    for (size_t i = from; i < to; i++)
        for (int b = 0; b < 3; b++) {
            const double power = (double)h->photons[i].power[b] * h->unit * share;
            if (!(power <= (double)FLT_MAX))
                return pm__fail(error, PM_EINVAL, "a photon of %g W is more than a float holds", power);
            h->photons[i].power[b] = (float)power;
        }
    return PM_OK;
}

static pm_status check_smallness(double sent, double share, pm_error *error)
{
    if (sent * share >= (double)FLT_MIN)
        return PM_OK;
    return pm__fail(error, PM_EINVAL, "photons of %g W are less than a float holds", sent * share);
}

/* ---- Stored photons -------------------------------------------------------------------------- */

/* How many photons the path that begins at i stores. */
static size_t path_length(const pm__harvest *h, size_t i)
{
    size_t end = i + 1;
    while (end < h->count && !(h->marks[end] & PM__FIRST_OF_PATH))
        end++;
    return end - i;
}

/* What the photons of long paths stand for, and those of others; by photons, a block at a time. */
typedef struct scaling {
    pm__harvest *h;
    size_t over;
    double share, last;
    _Atomic size_t longer;    /* paths that store more than `over` photons */
    _Atomic size_t too_large; /* 1 + the number of a photon that no float holds; 0: none */
} scaling;

enum { SCALED_AT_ONCE = 8192 };

/* The first photon from i on that begins a path. */
static size_t path_from(const pm__harvest *h, size_t i)
{
    while (i < h->count && !(h->marks[i] & PM__FIRST_OF_PATH))
        i++;
    return i;
}

/* Blocks have the paths that begin within them. */
static void count_block(void *argument, size_t block)
{
    scaling *const s = argument;
    const size_t end = (block + 1) * SCALED_AT_ONCE;
    size_t longer = 0;
    for (size_t i = path_from(s->h, end - SCALED_AT_ONCE), length; i < end && i < s->h->count; i += length) {
        length = path_length(s->h, i);
        longer += length > s->over;
    }
    s->longer += longer;
}

static void scale_block(void *argument, size_t block)
{
    scaling *const s = argument;
    const size_t end = (block + 1) * SCALED_AT_ONCE;
    for (size_t i = path_from(s->h, end - SCALED_AT_ONCE), length; i < end && i < s->h->count; i += length) {
        length = path_length(s->h, i);
        if (scale(s->h, i, i + length, length > s->over ? s->share * s->last : s->share, NULL) != PM_OK)
            s->too_large = i + 1;
    }
}

static pm_status scale_stored(const pm__shoot_config *config, pm__harvest *h, double sent, pm_error *error)
{
    const size_t blocks = (h->count + SCALED_AT_ONCE - 1) / SCALED_AT_ONCE;
    const double each = (double)h->count / (double)config->count;
    scaling s = {.h = h, .over = h->count - config->count,
                 .share = h->emitted > 1 ? each / (double)(h->emitted - 1) : each};
    const pm_status status = check_smallness(sent, s.share, error);
    if (status != PM_OK)
        return status;
    pm__for(config->parallel, blocks, count_block, &s);
    s.last = h->emitted > 1 ? 1.0 - 1.0 / (double)s.longer : 1.0;
    pm__for(config->parallel, blocks, scale_block, &s);
    if (s.too_large)
        return pm__fail(error, PM_EINVAL, "a photon of the path of stored photon %zu has more W than a float holds",
                        (size_t)s.too_large);
    return PM_OK;
}

/* `over` different numbers below count, ascending (Floyd's algorithm); over is below PM__LONGEST_PATH. */
static void choose_dropped(const pm__shoot_config *config, size_t count, size_t over, size_t dropped[])
{
    for (size_t j = count - over, made = 0; j < count; j++, made++) {
        double u[3];
        pm__trace_uniform(config->seed, config->trial, DROPPING, (uint32_t)made, u);
        const size_t tried = (size_t)(u[0] * (double)(j + 1));
        size_t at = 0;
        while (at < made && dropped[at] < tried)
            at++;
        const bool taken = at < made && dropped[at] == tried;
        if (taken)
            at = made;
        memmove(&dropped[at + 1], &dropped[at], (made - at) * sizeof *dropped);
        dropped[at] = taken ? j : tried;
    }
}

static void drop(const pm__shoot_config *config, pm__harvest *h, size_t wanted)
{
    size_t dropped[PM__LONGEST_PATH], next = 0;
    const size_t over = h->count - wanted;
    choose_dropped(config, h->count, over, dropped);
    for (size_t i = over > 0 ? dropped[0] : h->count; i < h->count; i++) {
        if (next < over && dropped[next] == i) {
            next++;
            continue;
        }
        h->photons[i - next] = h->photons[i];
        if (h->normals)
            memcpy(h->normals[i - next], h->normals[i], sizeof h->normals[i]);
    }
    h->count = wanted;
}

static pm_status too_few(const pm__harvest *h, size_t wanted, pm_error *error)
{
    return pm__fail(error, PM_EINVAL, "%zu of %zu photons were stored when %llu had been emitted: given up", h->count,
                    wanted, (unsigned long long)h->emitted);
}

static pm_status shoot_stored(const pm__shoot_config *config, const pm__emission *emission, pm__harvest *h,
                              pm_error *error)
{
    const pm__trace_config tracing = {config->scene, config->paths, config->seed, config->trial, emission};
    pm_status status = pm__harvest_paths(config, trace_range, &tracing, emission->total, 0,
                                         config->most ? config->most : PM__MOST_TRACED, config->count, h, error);
    if (status == PM_OK && h->count < config->count)
        return config->most ? scale(h, 0, h->count, 1.0 / (double)h->emitted, error)
                            : too_few(h, config->count, error);
    if (status == PM_OK)
        status = scale_stored(config, h, emission->total, error);
    if (status == PM_OK)
        drop(config, h, config->count);
    return status;
}

/* ---- Emitted photons ------------------------------------------------------------------------- */

static pm_status shoot_emitted(const pm__shoot_config *config, const pm__emission *emission, uint64_t count,
                               pm__tracer tracer, pm__harvest *h, pm_error *error)
{
    const pm__trace_config tracing = {config->scene, config->paths, config->seed, config->trial, emission};
    const double share = 1.0 / (double)count;
    pm_status status = pm__harvest_paths(config, tracer, &tracing, emission->total, 0, count, SIZE_MAX, h, error);
    if (status == PM_OK && h->count > 0)
        status = check_smallness(emission->total, share, error);
    return status == PM_OK ? scale(h, 0, h->count, share, error) : status;
}

/* How many to emit for about config->count to be stored: by independent paths with numbers of their own. */
static pm_status try_out(const pm__shoot_config *config, const pm__emission *emission, uint64_t *count, pm_error *error)
{
    const pm__trace_config tracing = {config->scene, config->paths, config->seed, config->trial, emission};
    pm__shoot_config plain = *config;
    plain.normals = false;
    size_t wanted = config->count / TRIED_SHARE;
    wanted = wanted < FEWEST_TRIED ? FEWEST_TRIED : wanted > MOST_TRIED ? MOST_TRIED : wanted;
    pm__harvest h;
    pm_status status = pm__harvest_paths(&plain, trace_range, &tracing, emission->total, PM__MOST_TRACED,
                                         PM__MOST_TRACED / 2, wanted, &h, error);
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

/* Of arrays that grew by doubling, what is in use. */
static void trim(void **array, size_t bytes)
{
    void *const trimmed = *array ? realloc(*array, bytes ? bytes : 1) : NULL;
    if (trimmed)
        *array = trimmed;
}

static void hand_over(pm__harvest *h, pm__photon_set *set)
{
    trim((void **)&h->photons, h->count * sizeof *h->photons);
    trim((void **)&h->normals, h->count * sizeof *h->normals);
    *set = (pm__photon_set){h->photons, h->normals, h->count, h->emitted};
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
        hand_over(&h, set);
    else
        pm__harvest_free(&h);
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
        hand_over(&h, set);
    else
        pm__harvest_free(&h);
    return status;
}

void pm__photon_set_free(pm__photon_set *set)
{
    free(set->photons);
    free(set->normals);
    *set = (pm__photon_set){0};
}
