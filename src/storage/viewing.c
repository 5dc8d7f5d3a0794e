#include "viewing.h"

#include "lights.h"
#include "points.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../transport/shoot.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Paths and photons of the viewing alone: importons, and the trials' photons, have numbers of their own. */
#define VIEWING_SEED 0x76696577ull
#define LAMP_SEED 0x6c616d70ull
enum { LARGE_TRIAL = 0x7f000000, MOST_SENT = 16 };
enum { LAMP_PATHS = 1024 }; /* of a pixel with a lamp's edge, that see nothing but lamps */

/* One row of cells in one group. */
typedef struct strip {
    pm__points_list points[PM__MAP_KINDS]; /* that each trial looks up */
} strip;

struct pm__viewing {
    pm__viewing_config config;
    size_t across, down, block; /* cells; pixels along a cell's side */
    size_t values;              /* of a group: 3 a cell */
    double scale;               /* 1 / mean of the reference */
    strip *strips;              /* [group * down + row] */
    float *base;                /* [group * values + value]: relative errors with large maps */
    float *fixed[PM__MAP_KINDS]; /* likewise, without the large map's light of `samples` paths */
    pm__lights lights;
    bool *edges;                /* [pixel]: a lamp's edge is in it */
    bool has[PM__MAP_KINDS];
    pm_map *global;             /* large, of the first group */
};

/* ---- Eye paths --------------------------------------------------------------------------------- */

/* Where a strip's paths put what they find. */
typedef struct walking {
    const pm__viewing *viewing;
    const pm_map *const *large;             /* [kind] */
    size_t group, row;
    double *light;                          /* [3 * across]: direct and seen, sums over paths */
    double *large_light[PM__MAP_KINDS];     /* sums over paths that have been looked up */
    pm__points_list points[PM__MAP_KINDS];  /* of the paths in hand */
    pm_status status;
} walking;

static void keep(walking *w, pm_status status)
{
    if (w->status == PM_OK)
        w->status = status;
}

/* A place that no map of global light stands for. */
static void stand_here(walking *w, pm__eye *eye, uint32_t cell, double share)
{
    double direct[3] = {0.0, 0.0, 0.0};
    pm__lights_add(&w->viewing->lights, eye, direct);
    for (size_t b = 0; b < 3; b++)
        w->light[3 * (size_t)cell + b] += share * direct[b];
    if (w->large[PM__CAUSTIC_MAP])
        keep(w, pm__points_add(&w->points[PM__CAUSTIC_MAP], eye, cell, share));
}

static void gather(walking *w, pm__eye *eye, uint32_t cell, double share)
{
    while (w->status == PM_OK && pm__eye_bounce(eye) && pm__eye_follow(eye)) {
        if (eye->travelled >= w->viewing->config.near) {
            keep(w, pm__points_add(&w->points[PM__GLOBAL_MAP], eye, cell, share));
            return;
        }
        stand_here(w, eye, cell, share);
    }
}

static void follow_path(walking *w, size_t x, size_t y, uint32_t sample)
{
    const pm__viewing_config *const c = &w->viewing->config;
    const uint64_t seed = c->seed ^ VIEWING_SEED, pixel = y * c->width + x;
    const uint32_t cell = (uint32_t)(x / w->viewing->block);
    const pm__eye_numbers numbers = pm__eye_numbers_of(seed, (uint32_t)w->group, sample, pixel);
    double at[2];
    pm__eye eye;
    /* Groups are to be independent: each is scrambled by numbers of its own. */
    pm__place_in_pixel(seed + ((uint64_t)w->group << 32), pixel, sample, at);
    pm__eye_through(&eye, c->scene, c->camera, &numbers, (double)x + at[0], (double)y + at[1]);
    const bool reached = pm__eye_follow(&eye);
    for (size_t b = 0; b < 3 && !w->viewing->edges[pixel]; b++)
        w->light[3 * (size_t)cell + b] += eye.emitted[b];
    if (!reached)
        return;
    stand_here(w, &eye, cell, 1.0);
    for (size_t i = 0; i < c->gather && w->large[PM__GLOBAL_MAP] && w->status == PM_OK; i++) {
        pm__eye ray = eye;
        ray.sees_caustics = false; /* the caustic map has them */
        gather(w, &ray, cell, 1.0 / (double)c->gather);
        eye.numbers = ray.numbers;
    }
}

/* ---- Lamps in the picture ---------------------------------------------------------------------- */

/* Where on a fixed grid, which no path depends on: what paths see must not decide how it is counted. */
static void find_edges(void *argument, size_t y)
{
    pm__viewing *const v = argument;
    const pm__viewing_config *const c = &v->config;
    for (size_t x = 0; x < c->width && !(c->canceled && c->canceled(c->context)); x++)
        v->edges[y * c->width + x] = pm__lamps_edge(c->scene, c->camera, x, y);
}

/* A lamp is so much brighter than all else that the few pixels with its edges would make most of the noise of the whole
 * image: there it is looked at by many paths that see nothing else. */
static void see_lamps(walking *w)
{
    const pm__viewing_config *const c = &w->viewing->config;
    const uint64_t seed = c->seed ^ LAMP_SEED;
    const size_t block = w->viewing->block;
    for (size_t i = 0; i < block * c->width; i++) {
        const size_t pixel[2] = {i % c->width, w->row * block + i / c->width};
        const size_t number = pixel[1] * c->width + pixel[0], cell = pixel[0] / block;
        for (uint32_t s = 0; s < LAMP_PATHS && w->viewing->edges[number]; s++) {
            double at[2], seen[3];
            pm__place_in_pixel(seed + ((uint64_t)w->group << 32), number, s, at);
            pm__lamps_seen(c->scene, c->camera, (double)pixel[0] + at[0], (double)pixel[1] + at[1], seen);
            for (size_t b = 0; b < 3; b++)
                w->light[3 * cell + b] += seen[b] * (double)c->deep / LAMP_PATHS;
        }
    }
}

/* ---- A strip ----------------------------------------------------------------------------------- */

static void follow_paths(walking *w, uint32_t sample)
{
    const size_t block = w->viewing->block;
    for (size_t y = w->row * block; y < (w->row + 1) * block && w->status == PM_OK; y++)
        for (size_t x = 0; x < w->viewing->config.width && w->status == PM_OK; x++)
            follow_path(w, x, y, sample);
}

static pm__looking looking_of(const pm__viewing *v)
{
    return (pm__looking){v->config.k, v->config.radius};
}

static void look_at_large(walking *w)
{
    const pm__looking looking = looking_of(w->viewing);
    for (int kind = 0; kind < PM__MAP_KINDS && w->status == PM_OK; kind++)
        if (w->large[kind])
            keep(w, pm__points_look(&w->points[kind], w->large[kind], &looking, w->large_light[kind]));
}

/* What stays: relative, less the reference. kept: the large maps' sums over the paths that each trial looks up. */
static void fix(const walking *w, const double *const kept[PM__MAP_KINDS], const float *reference)
{
    const pm__viewing *const v = w->viewing;
    const size_t at = w->group * v->values + 3 * w->row * v->across;
    const double pixels = (double)(v->block * v->block);
    const double deep = 1.0 / (pixels * (double)v->config.deep), some = 1.0 / (pixels * (double)v->config.samples);
    for (size_t i = 0; i < 3 * v->across; i++) {
        const double all = deep * (w->light[i] + w->large_light[0][i] + w->large_light[1][i]);
        const double off = all - (double)reference[3 * w->row * v->across + i];
        v->base[at + i] = (float)(v->scale * off);
        for (int kind = 0; kind < PM__MAP_KINDS; kind++)
            v->fixed[kind][at + i] = (float)(v->scale * (off - some * kept[kind][i]));
    }
}

typedef struct making {
    pm__viewing *viewing;
    const pm_map *large[PM__MAP_KINDS];
    size_t group;
    _Atomic int failure;
} making;

static void make_paths(walking *w, strip *own, double *kept[PM__MAP_KINDS])
{
    const pm__viewing_config *const c = &w->viewing->config;
    for (uint32_t s = 0; s < c->deep && w->status == PM_OK; s++) {
        follow_paths(w, s);
        if (s + 1 < c->samples)
            continue;
        look_at_large(w);
        for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
            if (s + 1 == c->samples) { /* the trials' own: they keep them */
                memcpy(kept[kind], w->large_light[kind], 3 * w->viewing->across * sizeof *kept[kind]);
                own->points[kind] = w->points[kind];
                w->points[kind] = (pm__points_list){0};
            }
            pm__points_clear(&w->points[kind]);
        }
    }
}

static void make_strip(void *argument, size_t row)
{
    making *const m = argument;
    const pm__viewing *const v = m->viewing;
    const pm__viewing_config *const c = &v->config;
    const size_t values = 3 * v->across;
    double *const sums = pm__alloc_zero(5 * values, sizeof *sums);
    walking w = {.viewing = v, .large = m->large, .group = m->group, .row = row, .light = sums};
    w.status = c->canceled && c->canceled(c->context) ? PM_ECANCELED : sums ? PM_OK : PM_ENOMEM;
    if (w.status == PM_OK) {
        double *kept[PM__MAP_KINDS] = {sums + 3 * values, sums + 4 * values};
        w.large_light[0] = sums + values;
        w.large_light[1] = sums + 2 * values;
        see_lamps(&w);
        make_paths(&w, &v->strips[m->group * v->down + row], kept);
        fix(&w, (const double *const *)kept, c->reference->values);
    }
    if (w.status != PM_OK)
        atomic_store(&m->failure, (int)w.status);
    for (int kind = 0; kind < PM__MAP_KINDS; kind++)
        pm__points_free(&w.points[kind]);
    free(sums);
}

/* ---- Large maps -------------------------------------------------------------------------------- */

/* Light in a map's paths, as many photons stored in all scenes: caustic ones are sent where mirrors and glass are. */
static pm_status make_large(pm__viewing *v, pm__map_kind kind, size_t group, pm_map **map, pm_error *error)
{
    const pm__viewing_config *const c = &v->config;
    pm__paths *paths = NULL;
    pm__projection *projection = NULL;
    pm__photon_set set = {0};
    bool any = true;
    pm_status status = pm__paths_create(pm__map_paths[kind], &paths, error);
    if (status == PM_OK && kind == PM__CAUSTIC_MAP) {
        status = pm__projection_create(c->scene, true, &projection, error);
        any = false;
        for (size_t i = 0; i < pm__scene_light_count(c->scene) && status == PM_OK; i++)
            any = any || pm__projection_share(projection, i) > 0.0;
    }
    const pm__shoot_config shooting = {.scene = c->scene,
                                       .paths = paths,
                                       .seed = c->seed ^ VIEWING_SEED,
                                       .trial = (uint32_t)(LARGE_TRIAL + PM__MAP_KINDS * group + (size_t)kind),
                                       .projection = projection,
                                       .count = c->photons,
                                       .most = MOST_SENT * (uint64_t)c->photons,
                                       .parallel = c->parallel,
                                       .canceled = c->canceled,
                                       .context = c->context};
    const pm_map_options options = {.parallel = c->parallel};
    if (status == PM_OK && any)
        status = pm__shoot(&shooting, &set, error);
    if (status == PM_OK && set.count)
        status = pm_map_create(set.photons, set.count, &options, map, error);
    pm__photon_set_free(&set);
    pm__projection_destroy(projection);
    pm__paths_destroy(paths);
    return status;
}

static void tell(const pm__viewing *v, double groups)
{
    if (v->config.progress)
        v->config.progress(v->config.context, groups / (double)PM__GROUPS);
}

static pm_status make_group(pm__viewing *v, size_t group, pm_error *error)
{
    pm_map *large[PM__MAP_KINDS] = {NULL, NULL};
    pm_status status = PM_OK;
    for (int kind = 0; kind < PM__MAP_KINDS && status == PM_OK; kind++) {
        status = make_large(v, (pm__map_kind)kind, group, &large[kind], error);
        v->has[kind] = v->has[kind] || large[kind];
        tell(v, (double)group + 0.2 * (kind + 1));
    }
    making m = {.viewing = v, .large = {large[0], large[1]}, .group = group};
    if (status == PM_OK) {
        pm__for(v->config.parallel, v->down, make_strip, &m);
        status = (pm_status)atomic_load(&m.failure);
        if (status == PM_ENOMEM)
            status = pm__fail(error, status, "out of memory for the view of the scene");
    }
    if (group == 0) {
        v->global = large[PM__GLOBAL_MAP];
        large[PM__GLOBAL_MAP] = NULL;
    }
    for (int kind = 0; kind < PM__MAP_KINDS; kind++)
        pm_map_destroy(large[kind]);
    tell(v, (double)group + 1.0);
    return status;
}

/* ---- Life -------------------------------------------------------------------------------------- */

static double mean_of(const pm__image *reference)
{
    double sum = 0.0;
    const size_t values = 3 * reference->width * reference->height;
    for (size_t i = 0; i < values; i++)
        sum += (double)reference->values[i];
    return sum / (double)values;
}

static pm_status set_up(const pm__viewing_config *config, pm__viewing *v)
{
    v->config = *config;
    v->across = config->reference->width;
    v->down = config->reference->height;
    v->block = config->width / v->across;
    v->values = 3 * v->across * v->down;
    v->scale = 1.0 / mean_of(config->reference);
    v->strips = pm__alloc_zero(PM__GROUPS * v->down, sizeof *v->strips);
    v->edges = pm__alloc_zero(config->width * config->height, sizeof *v->edges);
    v->base = pm__alloc_zero(PM__GROUPS * v->values, sizeof *v->base);
    bool whole = v->strips && v->edges && v->base;
    for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
        v->fixed[kind] = pm__alloc_zero(PM__GROUPS * v->values, sizeof *v->fixed[kind]);
        whole = whole && v->fixed[kind];
    }
    return whole ? pm__lights_choose(config->scene, config->camera, config->width, config->height,
                                     config->seed ^ LAMP_SEED, &v->lights)
                 : PM_ENOMEM;
}

pm_status pm__viewing_create(const pm__viewing_config *config, pm__viewing **viewing, pm_error *error)
{
    pm__viewing *const v = pm__alloc_zero(1, sizeof *v);
    *viewing = NULL;
    pm_status status = v ? set_up(config, v) : PM_ENOMEM;
    if (status == PM_ENOMEM)
        (void)pm__fail(error, status, "out of memory for the view of the scene");
    if (status == PM_OK)
        pm__for(config->parallel, config->height, find_edges, v);
    for (size_t group = 0; group < PM__GROUPS && status == PM_OK; group++)
        status = make_group(v, group, error);
    if (status == PM_OK)
        *viewing = v;
    else
        pm__viewing_destroy(v);
    return status;
}

void pm__viewing_destroy(pm__viewing *v)
{
    if (!v)
        return;
    for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
        for (size_t i = 0; v->strips && i < PM__GROUPS * v->down; i++)
            pm__points_free(&v->strips[i].points[kind]);
        free(v->fixed[kind]);
    }
    pm__lights_free(&v->lights);
    free(v->strips);
    free(v->base);
    free(v->edges);
    pm_map_destroy(v->global);
    free(v);
}

double pm__viewing_bytes(const pm__viewing_config *config)
{
    const double paths = (double)(config->width * config->height * PM__GROUPS * config->samples);
    const double values = 3.0 * (double)(config->reference->width * config->reference->height * PM__GROUPS);
    const double points = paths * (1.0 + (double)config->gather) * 2.0; /* lists grow by doubling */
    return points * (double)sizeof(pm__point) + values * 3.0 * (double)sizeof(float) +
           (double)config->photons * (2.0 * (double)sizeof(pm_photon) + 60.0);
}

bool pm__viewing_has(const pm__viewing *viewing, pm__map_kind kind)
{
    return viewing->has[kind];
}

const pm_map *pm__viewing_global(const pm__viewing *viewing)
{
    return viewing->global;
}

size_t pm__viewing_points(const pm__viewing *viewing, pm__map_kind kind)
{
    size_t count = 0;
    for (size_t i = 0; i < PM__GROUPS * viewing->down; i++)
        count += viewing->strips[i].points[kind].count;
    return count;
}

const float *pm__viewing_base(const pm__viewing *viewing)
{
    return viewing->base;
}

size_t pm__viewing_values(const pm__viewing *viewing)
{
    return viewing->values;
}

/* ---- Images ------------------------------------------------------------------------------------ */

typedef struct seeing {
    const pm__viewing *viewing;
    pm__map_kind kind;
    const pm_map *map;
    float *errors;
    _Atomic int failure;
} seeing;

static void see_strip(void *argument, size_t index)
{
    seeing *const s = argument;
    const pm__viewing *const v = s->viewing;
    const pm__viewing_config *const c = &v->config;
    const pm__looking looking = looking_of(v);
    const size_t values = 3 * v->across, at = index / v->down * v->values + index % v->down * values;
    double *const light = pm__alloc_zero(values, sizeof *light);
    pm_status status = c->canceled && c->canceled(c->context) ? PM_ECANCELED : light ? PM_OK : PM_ENOMEM;
    if (status == PM_OK)
        status = pm__points_look(&v->strips[index].points[s->kind], s->map, &looking, light);
    const double scale = v->scale / ((double)(v->block * v->block) * (double)c->samples);
    for (size_t i = 0; i < values && status == PM_OK; i++)
        s->errors[at + i] = (float)((double)v->fixed[s->kind][at + i] + scale * light[i]);
    if (status != PM_OK)
        atomic_store(&s->failure, (int)status);
    free(light);
}

pm_status pm__viewing_errors(const pm__viewing *viewing, pm__map_kind kind, const pm_map *map, float *errors)
{
    seeing s = {.viewing = viewing, .kind = kind, .map = map, .errors = errors};
    pm__for(viewing->config.parallel, PM__GROUPS * viewing->down, see_strip, &s);
    return (pm_status)atomic_load(&s.failure);
}
