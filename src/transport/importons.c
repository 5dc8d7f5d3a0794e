#include "importons.h"

#include "eye.h"
#include "footprint.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../base/sobol.h"

#include <float.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 512 }; /* paths */

const char *const pm__map_paths[PM__MAP_KINDS] = {"LS+D", "L.*D"};
const char *const pm__map_names[PM__MAP_KINDS] = {"caustic", "global"};

/* What one block of paths leaves. */
typedef struct harvest {
    pm__importons sets[PM__MAP_KINDS];
    size_t room[PM__MAP_KINDS], normal_room[PM__MAP_KINDS];
} harvest;

typedef struct tracing {
    const pm__importance_config *config;
    double pixels;           /* that a path stands for */
    uint64_t seed;           /* of numbers that no other eye path takes */
    uint32_t keys[2][4];     /* of the places on the screen */
    harvest *blocks;
    _Atomic int failure;
} tracing;

/* An eye path on its way. */
typedef struct walk {
    const tracing *t;
    harvest *to;
    pm__eye eye;
    pm__footprint footprint; /* unless importance is of the screen alone */
    double share;            /* of the path's pixels */
    bool full;               /* out of memory */
} walk;

static bool has_footprint(const walk *w)
{
    return w->t->config->measure != PM__OF_SCREEN;
}

/* ---- Storing ----------------------------------------------------------------------------------- */

static bool make_room(harvest *to, pm__map_kind kind)
{
    pm__importons *const set = &to->sets[kind];
    const size_t wanted = set->count + 1;
    return !pm__grow((void **)&set->importons, &to->room[kind], wanted, sizeof *set->importons) &&
           !pm__grow((void **)&set->normals, &to->normal_room[kind], wanted, sizeof *set->normals);
}

/* One over the footprint: 0 where it is 0, infinite or none. */
static float density_of(const walk *w)
{
    const double density = has_footprint(w) ? 1.0 / pm__footprint_area(&w->footprint) : 0.0;
    return density > 0.0 && density < (double)FLT_MAX ? (float)density : 0.0f;
}

static void store(walk *w, pm__map_kind kind)
{
    pm__importons *const set = &w->to->sets[kind];
    const pm__eye *const eye = &w->eye;
    if (!make_room(w->to, kind)) {
        w->full = true;
        return;
    }
    pm_photon *const importon = &set->importons[set->count];
    importon->power[PM__IMPORTON_PIXELS] = (float)(w->share * w->t->pixels * pm__sum(eye->weight) / 3.0);
    importon->power[PM__IMPORTON_DENSITY] = density_of(w);
    importon->power[2] = 0.0f;
    for (int i = 0; i < 3; i++) {
        importon->position[i] = (float)eye->hit.position[i];
        importon->direction[i] = (float)eye->direction[i];
        set->normals[set->count][i] = (float)eye->facing[i];
    }
    set->count++;
}

/* ---- Paths ------------------------------------------------------------------------------------- */

/* The index of refraction that the path was bent by: where that differs by band, of the one that is left. */
static double index_of(const pm__eye *eye)
{
    int band = 0;
    for (int b = 1; b < 3; b++)
        band = eye->weight[b] > eye->weight[band] ? b : band;
    return eye->hit.material->ior[band];
}

static pm__eye_met step(walk *w)
{
    const double in[3] = {w->eye.direction[0], w->eye.direction[1], w->eye.direction[2]};
    const pm__eye_met met = pm__eye_step(&w->eye);
    if (met == PM__EYE_ENDS || !has_footprint(w))
        return met;
    pm__footprint_arrive(&w->footprint, in, &w->eye.hit);
    if (met == PM__EYE_PASSES)
        pm__footprint_pass(&w->footprint, w->t->config->scene, &w->eye.hit, in, w->eye.direction, index_of(&w->eye));
    return met;
}

static bool follow(walk *w)
{
    pm__eye_met met;
    do
        met = step(w);
    while (met == PM__EYE_PASSES);
    return met == PM__EYE_STANDS;
}

static bool bounce(walk *w)
{
    const pm__eye before = w->eye;
    if (!pm__eye_bounce(&w->eye))
        return false;
    if (has_footprint(w))
        pm__footprint_bounce(&w->footprint, w->t->config->scene, &before.hit, before.direction, w->eye.direction,
                             before.weight);
    return true;
}

/* One ray of final gathering and, from where it ends too near, those that follow from it. */
static void gather(walk *w)
{
    while (!w->full && bounce(w) && follow(w)) {
        const bool is_far = w->eye.travelled >= w->t->config->near;
        store(w, is_far ? PM__GLOBAL_MAP : PM__CAUSTIC_MAP);
        if (is_far)
            return;
    }
}

/* Points of a (0, 2)-sequence, scrambled: even over the image for any number of them, and the first of them are so as
 * well. */
static void place(const tracing *t, uint64_t path, double at[2])
{
    const double size[2] = {(double)t->config->width, (double)t->config->height};
    for (int d = 0; d < 2; d++)
        at[d] = size[d] * (double)pm__owen_scramble(pm__sobol((uint32_t)path, d), t->keys[d]) * 0x1p-32;
}

static bool trace_path(const tracing *t, uint64_t path, harvest *to)
{
    const pm__importance_config *const config = t->config;
    const pm__eye_numbers numbers = {.seed = t->seed, .number = path};
    walk first = {.t = t, .to = to, .share = 1.0};
    double at[2];
    place(t, path, at);
    pm__eye_through(&first.eye, config->scene, config->camera, &numbers, at[0], at[1]);
    first.eye.sees_lights = first.eye.sees_caustics = false; /* they need not be looked for */
    if (has_footprint(&first))
        pm__footprint_begin(&first.footprint, config->camera, at[0], at[1]);
    if (!follow(&first))
        return true;
    store(&first, PM__CAUSTIC_MAP);
    for (size_t i = 0; i < config->bounces && !first.full; i++) {
        walk ray = first;
        ray.share = 1.0 / (double)config->bounces;
        gather(&ray);
        first.eye.numbers = ray.eye.numbers;
        first.full = ray.full;
    }
    return !first.full;
}

static void trace_block(void *argument, size_t block)
{
    tracing *const t = argument;
    const pm__importance_config *const config = t->config;
    const uint64_t first = (uint64_t)block * BLOCK, end = first + BLOCK < config->paths ? first + BLOCK : config->paths;
    if (config->canceled && config->canceled(config->context)) {
        atomic_store(&t->failure, (int)PM_ECANCELED);
        return;
    }
    for (uint64_t path = first; path < end; path++)
        if (!trace_path(t, path, &t->blocks[block])) {
            atomic_store(&t->failure, (int)PM_ENOMEM);
            return;
        }
}

/* ---- All together ------------------------------------------------------------------------------ */

static pm_status join(const harvest *blocks, size_t count, pm__map_kind kind, pm__importons *joined, pm_error *error)
{
    size_t all = 0;
    for (size_t i = 0; i < count; i++)
        all += blocks[i].sets[kind].count;
    if (all > PM_MAX_PHOTONS)
        return pm__fail(error, PM_EINVAL, "%zu %s importons: a map holds %zu", all, pm__map_names[kind],
                        PM_MAX_PHOTONS);
    joined->importons = pm__alloc(all, sizeof *joined->importons);
    joined->normals = pm__alloc(all, sizeof *joined->normals);
    if (!joined->importons || !joined->normals)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu importons", all);
    for (size_t i = 0; i < count; i++) {
        const pm__importons *const set = &blocks[i].sets[kind];
        if (!set->count)
            continue;
        memcpy(joined->importons + joined->count, set->importons, set->count * sizeof *set->importons);
        memcpy(joined->normals + joined->count, set->normals, set->count * sizeof *set->normals);
        joined->count += set->count;
    }
    return PM_OK;
}

void pm__importons_free(pm__importons sets[PM__MAP_KINDS])
{
    for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
        free(sets[kind].importons);
        free(sets[kind].normals);
        sets[kind] = (pm__importons){0};
    }
}

static void prepare(const pm__importance_config *config, tracing *t)
{
    uint32_t words[4];
    pm__random_words(config->seed, PM__FOR_IMPORTONS, 0, 0, 0, words);
    *t = (tracing){.config = config,
                   .pixels = (double)config->width * (double)config->height / (double)config->paths,
                   .seed = (uint64_t)words[1] << 32 | words[0]};
    for (uint32_t d = 0; d < 2; d++)
        pm__random_words(config->seed, PM__FOR_IMPORTONS, 0, 1, d, t->keys[d]);
}

pm_status pm__importons_trace(const pm__importance_config *config, pm__importons sets[PM__MAP_KINDS], pm_error *error)
{
    tracing t;
    const size_t count = (config->paths + BLOCK - 1) / BLOCK;
    memset(sets, 0, PM__MAP_KINDS * sizeof *sets);
    prepare(config, &t);
    t.blocks = pm__alloc_zero(count, sizeof *t.blocks);
    if (!t.blocks)
        return pm__fail(error, PM_ENOMEM, "out of memory for importons");
    pm__for(config->parallel, count, trace_block, &t);
    pm_status status = (pm_status)atomic_load(&t.failure);
    if (status != PM_OK)
        status = pm__fail(error, status, "importons: %s", pm_status_text(status));
    for (int kind = 0; kind < PM__MAP_KINDS && status == PM_OK; kind++)
        status = join(t.blocks, count, (pm__map_kind)kind, &sets[kind], error);
    for (size_t i = 0; i < count; i++)
        pm__importons_free(t.blocks[i].sets);
    free(t.blocks);
    if (status != PM_OK)
        pm__importons_free(sets);
    return status;
}
