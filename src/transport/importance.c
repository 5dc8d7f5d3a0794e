/* An estimate at an importon from its k nearest on this side, itself among them: it is there for certain, and the
 * farthest lies on the rim. Where importons fall independently, those between have on average the share (k - 2) of the
 * density that r encloses (erratum 13), whatever their weights: theirs alone are added up. Where they are spread
 * evenly, as on what the camera sees straight, this is low by up to 1.5 / k. Footprints tell densities each by itself:
 * those of all k are averaged.
 *
 * The average that footprints are held against is that of their logarithms: neither the huge ones at a horizon nor the
 * tiny ones that are to be cut have a say in it beyond their number. */
#include "importance.h"

#include "cells.h"
#include "importons.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../map/map.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 1024, AT_ONCE = 16 };
enum { VALUE, RADIUS }; /* within `power` of an importon that carries an estimate: 1/m2, m */

static const double pi = 3.14159265358979323846;
static const double reach_in_radii = 16.0, reach_in_usual = 8.0, important_share = 0.1;

typedef struct field {
    size_t count;           /* importons traced */
    pm_map *map;            /* of those that carry; NULL: there are none */
    pm__cells *cells;       /* of it */
    double mean;            /* 1/m2 */
} field;

struct pm__importance {
    field fields[PM__MAP_KINDS];
};

/* ---- Estimates --------------------------------------------------------------------------------- */

/* At the first `carriers` importons, which their paths spread as evenly as all of them. */
typedef struct estimating {
    const pm__importance_config *config;
    const pm__importons *set;
    const pm_map *map;     /* of all importons */
    size_t carriers;
    uint32_t *order;       /* the carriers' numbers in the map, ascending: neighbours after each other */
    double *screen;        /* 1/m2, [carriers] */
    double *pixel;         /* the same; 0: no footprint is known there. NULL: by the screen alone */
    float *radius;         /* m */
    _Atomic int failure;
} estimating;

/* Positions are floats: what lies closer together cannot be told apart. */
static double least_radius(const float position[3])
{
    const float largest = fmaxf(fabsf(position[0]), fmaxf(fabsf(position[1]), fabsf(position[2])));
    return fmax((double)largest * 0x1p-23, 1e-18);
}

/* Importons whose footprints are too small are given larger ones. */
static void cut_outliers(const pm__importance_config *config, pm__importons *set)
{
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < set->count; i++)
        if (set->importons[i].power[PM__IMPORTON_DENSITY] > 0.0f) {
            sum += log((double)set->importons[i].power[PM__IMPORTON_DENSITY]);
            count += 1.0;
        }
    const double most = fmin(config->outlier * exp(sum / fmax(1.0, count)), (double)FLT_MAX);
    for (size_t i = 0; i < set->count; i++) {
        float *const density = &set->importons[i].power[PM__IMPORTON_DENSITY];
        *density = fminf(*density, (float)most);
    }
}

static double mean_density(const pm_map *map, const pm_neighbor *near, size_t count)
{
    double sum = 0.0, known = 0.0;
    for (size_t i = 0; i < count; i++) {
        const float density = pm__power(map, near[i].number)[PM__IMPORTON_DENSITY];
        sum += (double)density;
        known += density > 0.0f ? 1.0 : 0.0;
    }
    return sum / fmax(1.0, known);
}

static void estimate(const estimating *e, size_t carrier, const pm_neighbor *near, size_t count)
{
    double sum = 0.0;
    for (size_t i = 1; i + 1 < count; i++)
        sum += (double)pm__power(e->map, near[i].number)[PM__IMPORTON_PIXELS];
    const double farthest = count ? sqrt((double)near[count - 1].distance2) * pm_map_unit(e->map) : 0.0;
    const double radius = fmax(farthest, least_radius(e->set->importons[carrier].position));
    e->screen[carrier] = sum / (pi * radius * radius);
    e->radius[carrier] = (float)radius;
    if (e->pixel)
        e->pixel[carrier] = mean_density(e->map, near, count);
}

static pm_query query_at(const estimating *e, size_t carrier)
{
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, e->set->importons[carrier].position, sizeof query.position);
    memcpy(query.normal, e->set->normals[carrier], sizeof query.normal);
    query.k = e->config->nearest;
    query.max_radius = INFINITY;
    query.front_only = true;
    return query;
}

static pm_status estimate_some(const estimating *e, size_t first, size_t count, pm_neighbor *near, size_t stride)
{
    pm_query queries[AT_ONCE] = {{.k = 0}};
    size_t found[AT_ONCE], which[AT_ONCE];
    for (size_t i = 0; i < count; i++) {
        which[i] = pm_map_source(e->map, e->order[first + i]);
        queries[i] = query_at(e, which[i]);
    }
    const pm_status status = pm_map_search_batch(e->map, queries, count, near, stride, found);
    for (size_t i = 0; i < count && status == PM_OK; i++)
        estimate(e, which[i], near + i * stride, found[i]);
    return status;
}

static void estimate_block(void *argument, size_t block)
{
    estimating *const e = argument;
    const size_t all = pm_map_count(e->map), stride = e->config->nearest < all ? e->config->nearest : all;
    const size_t first = block * BLOCK, end = first + BLOCK < e->carriers ? first + BLOCK : e->carriers;
    const bool canceled = e->config->canceled && e->config->canceled(e->config->context);
    pm_neighbor *const near = canceled ? NULL : pm__alloc(AT_ONCE * stride, sizeof *near);
    pm_status status = canceled ? PM_ECANCELED : near ? PM_OK : PM_ENOMEM;
    for (size_t i = first; i < end && status == PM_OK; i += AT_ONCE)
        status = estimate_some(e, i, end - i < AT_ONCE ? end - i : AT_ONCE, near, stride);
    free(near);
    if (status != PM_OK)
        atomic_store(&e->failure, (int)status);
}

/* ---- What carries them ------------------------------------------------------------------------- */

/* What a pixel's importance counts of the screen's, so that their averages are alike ([C02] 3.4.3). */
static double pixel_scale(const estimating *e)
{
    double screen = 0.0, pixel = 0.0;
    for (size_t i = 0; i < e->carriers && e->pixel; i++)
        if (e->pixel[i] > 0.0) {
            screen += e->screen[i];
            pixel += e->pixel[i];
        }
    return screen > 0.0 ? screen / pixel : 0.0;
}

/* Where no footprint is known the screen's importance stands for the pixel's. */
static double value_of(const estimating *e, double scale, size_t carrier)
{
    const double screen = e->screen[carrier], pixel = e->pixel ? e->pixel[carrier] : 0.0;
    const bool known = pixel > 0.0 && scale > 0.0;
    const double value = e->config->measure == PM__OF_SCREEN ? screen
                         : e->config->measure == PM__OF_BOTH ? 0.5 * (screen + (known ? scale * pixel : screen))
                         : known                             ? pixel
                         : scale > 0.0                       ? screen / scale
                                                             : pixel;
    return fmin(value, (double)FLT_MAX);
}

/* What an importon says of a place near it. */
static float value_at(const void *context, uint32_t importon, double distance)
{
    const field *const f = context;
    const float *const carried = pm__power(f->map, importon);
    const double radius = (double)carried[RADIUS], of_radius = radius / distance;
    if (distance <= radius)
        return carried[VALUE];
    return distance <= reach_in_radii * radius ? carried[VALUE] * (float)(of_radius * of_radius) : 0.0f;
}

static pm_status make_field(const estimating *e, field *made)
{
    double farthest = 0.0, sum = 0.0;
    const double scale = pixel_scale(e);
    pm_photon *const photons = pm__alloc(e->carriers, sizeof *photons);
    if (!photons)
        return PM_ENOMEM;
    made->mean = 0.0;
    for (size_t i = 0; i < e->carriers; i++) {
        const double value = value_of(e, scale, i);
        photons[i] = e->set->importons[i];
        photons[i].power[VALUE] = (float)value;
        photons[i].power[RADIUS] = e->radius[i];
        farthest = fmax(farthest, (double)e->radius[i]);
        sum += log((double)e->radius[i]);
        made->mean += value / (double)e->carriers;
    }
    /* In the disc of a usual radius there are `nearest` importons, of which a share carries. */
    const double usual = exp(sum / (double)e->carriers), in_disc = e->config->share * (double)e->config->nearest;
    const pm_map_options options = {.parallel = e->config->parallel};
    pm_status status = pm_map_create(photons, e->carriers, &options, &made->map, NULL);
    if (status == PM_OK)
        status = pm__cells_create(made->map, fmin(reach_in_radii * farthest, reach_in_usual * usual),
                                  usual * sqrt(pi / in_disc), value_at, made, &made->cells);
    free(photons);
    return status;
}

static void list_carriers(estimating *e)
{
    const size_t all = pm_map_count(e->map);
    size_t listed = 0;
    for (size_t number = 0; number < all; number++)
        if (pm_map_source(e->map, (uint32_t)number) < e->carriers)
            e->order[listed++] = (uint32_t)number;
}

static pm_status run(estimating *e, field *made)
{
    list_carriers(e);
    pm__for(e->config->parallel, (e->carriers + BLOCK - 1) / BLOCK, estimate_block, e);
    const pm_status status = (pm_status)atomic_load(&e->failure);
    return status == PM_OK ? make_field(e, made) : status;
}

static pm_status create_field(const pm__importance_config *config, pm__importons *set, field *made)
{
    const bool has_pixels = config->measure != PM__OF_SCREEN;
    pm_map *map = NULL;
    const size_t some = (size_t)ceil(config->share * (double)set->count);
    estimating e = {.config = config, .set = set, .carriers = some < set->count ? some : set->count};
    made->count = set->count;
    if (!set->count)
        return PM_OK;
    if (has_pixels)
        cut_outliers(config, set);
    const pm_map_options options = {.parallel = config->parallel};
    pm_status status = pm_map_create(set->importons, set->count, &options, &map, NULL);
    e.map = map;
    e.order = pm__alloc(e.carriers, sizeof *e.order);
    e.screen = pm__alloc_zero(e.carriers, sizeof *e.screen);
    e.pixel = has_pixels ? pm__alloc_zero(e.carriers, sizeof *e.pixel) : NULL;
    e.radius = pm__alloc_zero(e.carriers, sizeof *e.radius);
    if (status == PM_OK)
        status = e.order && e.screen && e.radius && (e.pixel || !has_pixels) ? run(&e, made) : PM_ENOMEM;
    free(e.order);
    free(e.screen);
    free(e.pixel);
    free(e.radius);
    pm_map_destroy(map);
    return status;
}

/* ---- Creation ---------------------------------------------------------------------------------- */

static pm_status check(const pm__importance_config *c, pm_error *error)
{
    if (!c->width || !c->height || !c->paths || c->paths > PM_MAX_PHOTONS)
        return pm__fail(error, PM_EINVAL, "importance of %zu x %zu pixels by %zu paths: there must be some, up to %zu",
                        c->width, c->height, c->paths, PM_MAX_PHOTONS);
    if (!c->bounces || !(c->near >= 0.0))
        return pm__fail(error, PM_EINVAL, "importance by %zu rays a bounce, nearness %g m: at least 1, and 0 m",
                        c->bounces, c->near);
    if (c->nearest < 3 || !(c->share > 0.0 && c->share <= 1.0) || !(c->outlier >= 1.0))
        return pm__fail(error, PM_EINVAL,
                        "importance of the nearest %zu, at a share of %g, cut by %g: at least 3, above 0 to 1, at "
                        "least 1",
                        c->nearest, c->share, c->outlier);
    return PM_OK;
}

pm_status pm__importance_create(const pm__importance_config *config, pm__importance **importance, pm_error *error)
{
    pm__importons sets[PM__MAP_KINDS];
    *importance = NULL;
    pm_status status = check(config, error);
    if (status == PM_OK)
        status = pm__importons_trace(config, sets, error);
    if (status != PM_OK)
        return status;
    pm__importance *const made = pm__alloc_zero(1, sizeof *made);
    status = made ? PM_OK : PM_ENOMEM;
    for (int kind = 0; kind < PM__MAP_KINDS && status == PM_OK; kind++)
        status = create_field(config, &sets[kind], &made->fields[kind]);
    pm__importons_free(sets);
    if (status == PM_OK) {
        *importance = made;
        return PM_OK;
    }
    pm__importance_destroy(made);
    return pm__fail(error, status, "importance: %s", pm_status_text(status));
}

void pm__importance_destroy(pm__importance *importance)
{
    if (!importance)
        return;
    for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
        pm__cells_destroy(importance->fields[kind].cells);
        pm_map_destroy(importance->fields[kind].map);
    }
    free(importance);
}

size_t pm__importance_count(const pm__importance *importance, pm__map_kind kind)
{
    return importance->fields[kind].count;
}

double pm__importance_mean(const pm__importance *importance, pm__map_kind kind)
{
    return importance->fields[kind].mean;
}

double pm__importance_threshold(const pm__importance *importance, pm__map_kind kind)
{
    return important_share * importance->fields[kind].mean;
}

void pm__importance_at(const pm__importance *importance, pm__map_kind kind, const float (*positions)[3],
                       const float (*normals)[3], size_t count, float *values)
{
    const field *const f = &importance->fields[kind];
    if (!f->map)
        memset(values, 0, count * sizeof *values);
    for (size_t first = 0; first < count && f->map; first += PM__CELLS_AT_ONCE) {
        const size_t rest = count - first, some = rest < PM__CELLS_AT_ONCE ? rest : PM__CELLS_AT_ONCE;
        pm__cells_find(f->cells, positions + first, normals + first, some, values + first);
    }
}

typedef struct looking {
    const pm__importance *importance;
    pm__map_kind kind;
    const pm_photon *photons;
    const float (*normals)[3];
    size_t count;
    float *values;
} looking;

static void look_block(void *argument, size_t block)
{
    const looking *const l = argument;
    const size_t first = block * BLOCK, rest = l->count - first, count = rest < BLOCK ? rest : BLOCK;
    float positions[BLOCK][3];
    for (size_t i = 0; i < count; i++)
        memcpy(positions[i], l->photons[first + i].position, sizeof positions[i]);
    pm__importance_at(l->importance, l->kind, (const float(*)[3])positions, l->normals + first, count,
                      l->values + first);
}

void pm__importance_of_photons(const pm__importance *importance, pm__map_kind kind, const pm_parallel *parallel,
                               const pm_photon *photons, const float (*normals)[3], size_t count, float *values)
{
    looking all = {importance, kind, photons, normals, count, values};
    pm__for(parallel, (count + BLOCK - 1) / BLOCK, look_block, &all);
}
