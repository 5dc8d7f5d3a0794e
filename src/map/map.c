/* Creation and reading of maps. */
#include "map.h"
#include "structure.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const pm__structure *pm__structure_of(pm__structure_id id)
{
    switch (id) {
    case PM__KD_TREE:
        return &pm__structure_tree;
    case PM__WIDE:
        return &pm__structure_wide;
    case PM__GRID:
        return &pm__structure_grid;
    case PM__GROWN:
        return &pm__structure_grown;
    case PM__NO_STRUCTURE:
    case PM__STRUCTURES:
        break;
    }
    return NULL;
}

static double size_carried(bool directions)
{
    return (double)sizeof(float) * (directions ? PM__POWER_AND_DIRECTION : PM__POWER);
}

double pm__bytes_when_built(pm__structure_id id, bool directions)
{
    const pm__structure *const structure = pm__structure_of(id);
    const double held = structure ? structure->held - (directions ? 0.0 : structure->sides) : 0.0;
    return PM__PLACE_BYTES + size_carried(directions) + held;
}

double pm__bytes_to_build(pm__structure_id id, bool directions)
{
    const pm__structure *const structure = pm__structure_of(id);
    const double items = fmax(0.0, (double)sizeof(pm__item) - size_carried(directions)); /* see room_for_items */
    return pm__bytes_when_built(id, directions) + items + (structure ? structure->building : 0.0);
}

static pm_status check_photons(const pm_photon *photons, size_t count, pm_error *error)
{
    if (count > PM_MAX_PHOTONS)
        return pm__fail(error, PM_EINVAL, "%zu photons: a map holds at most %zu", count, PM_MAX_PHOTONS);
    if (count && !photons)
        return pm__fail(error, PM_EINVAL, "no photons given");
    return PM_OK;
}

/* Names the first value that is not finite. */
static pm_status find_infinite(const pm_photon *photons, size_t count, pm_error *error)
{
    static const char *const parts[] = {"position", "direction", "power"};
    for (size_t i = 0; i < count; i++) {
        const float *const values[] = {photons[i].position, photons[i].direction, photons[i].power};
        for (int part = 0; part < 3; part++)
            for (int a = 0; a < 3; a++)
                if (!isfinite(values[part][a]))
                    return pm__fail(error, PM_ENONFINITE, "photon %zu: its %s is not finite", i, parts[part]);
    }
    return PM_EBROKEN; /* never comes here */
}

/* An offset is taken out of an axis only where every coordinate lies within a factor 2 of the centre: then the
 * difference of two floats is exact (Sterbenz), so recentring never rounds. Elsewhere the extent is at least a
 * third of the largest coordinate and an offset would gain nothing. */
static double exact_centre(double low, double high)
{
    const double centre = (double)(float)(0.5 * (low + high));
    const double near = fmin(fabs(low), fabs(high)), far = fmax(fabs(low), fabs(high));
    return low * high > 0.0 && far <= 2.0 * near ? centre : 0.0;
}

static void choose_frame(pm_map *map, const float low[3], const float high[3])
{
    double largest = 0.0;
    for (int a = 0; a < 3; a++) {
        const double from = (double)low[a], to = (double)high[a];
        map->centre[a] = map->count ? exact_centre(from, to) : 0.0;
        if (map->count)
            largest = fmax(largest, fmax(fabs(from - map->centre[a]), fabs(to - map->centre[a])));
    }
    int exponent = 0;
    (void)frexp(largest, &exponent);
    map->unit = largest > 0.0 ? ldexp(1.0, exponent) : 1.0;
    map->inverse_unit = 1.0 / map->unit;
}

enum { AHEAD = 24, CHUNK = 1 << 15 };

typedef struct survey {
    float low[3], high[3];
    bool finite;
} survey;

/* Loops over all photons, cut into chunks for the caller's threads. */
typedef struct filling {
    pm_map *map;
    const pm_photon *photons;
    pm__item *items;
    double max_power[PM_MAX_PHOTONS / CHUNK + 1];
    survey surveys[PM_MAX_PHOTONS / CHUNK + 1];
} filling;

static size_t chunk_end(const pm_map *map, size_t chunk)
{
    return (chunk + 1) * CHUNK < map->count ? (chunk + 1) * CHUNK : map->count;
}

/* One pass without branches. A value times 0 is 0, but for NaN and infinity, which stay in the sum. */
static void survey_task(void *argument, size_t chunk)
{
    filling *const f = argument;
    survey s = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, true};
    float zero[9] = {0.0f};
    for (size_t i = chunk * CHUNK; i < chunk_end(f->map, chunk); i++) {
        const pm_photon *const p = &f->photons[i];
        for (int a = 0; a < 3; a++) {
            const float x = p->position[a];
            s.low[a] = x < s.low[a] ? x : s.low[a];
            s.high[a] = x > s.high[a] ? x : s.high[a];
            zero[a] += x * 0.0f;
            zero[3 + a] += p->direction[a] * 0.0f;
            zero[6 + a] += p->power[a] * 0.0f;
        }
    }
    for (int v = 0; v < 9; v++)
        s.finite = s.finite && !isnan(zero[v]);
    f->surveys[chunk] = s;
}

/* The extents of all photons; false where one of their values is not finite. */
static bool survey_all(filling *f, const pm_parallel *parallel, float low[3], float high[3])
{
    const size_t chunks = (f->map->count + CHUNK - 1) / CHUNK;
    bool finite = true;
    pm__for(parallel, chunks, survey_task, f);
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (size_t i = 0; i < chunks; i++) {
            low[a] = fminf(low[a], f->surveys[i].low[a]);
            high[a] = fmaxf(high[a], f->surveys[i].high[a]);
        }
    }
    for (size_t i = 0; i < chunks; i++)
        finite = finite && f->surveys[i].finite;
    return finite;
}

static void items_task(void *argument, size_t chunk)
{
    const filling *const f = argument;
    const pm_map *const map = f->map;
    for (size_t i = chunk * CHUNK; i < chunk_end(map, chunk); i++) {
        for (int a = 0; a < 3; a++)
            f->items[i].position[a] =
                (float)(((double)f->photons[i].position[a] - map->centre[a]) * map->inverse_unit) + 0.0f; /* -0 is 0 */
        f->items[i].id = (uint32_t)i;
    }
}

/* Blocks and ids in the map's order. */
static void blocks_task(void *argument, size_t chunk)
{
    const filling *const f = argument;
    pm_map *const map = f->map;
    for (size_t i = chunk * CHUNK; i < chunk_end(map, chunk); i++) {
        pm__block *const block = &map->blocks[i / PM__LANES];
        block->x[i % PM__LANES] = f->items[i].position[0];
        block->y[i % PM__LANES] = f->items[i].position[1];
        block->z[i % PM__LANES] = f->items[i].position[2];
        map->ids[i] = f->items[i].id;
    }
}

static void carried_task(void *argument, size_t chunk)
{
    filling *const f = argument;
    pm_map *const map = f->map;
    double most = 0.0;
    for (size_t i = chunk * CHUNK; i < chunk_end(map, chunk); i++) {
        if (i + AHEAD < map->count) { /* the caller's order is any, so every photon is a cache miss, or two */
            __builtin_prefetch(f->photons[map->ids[i + AHEAD]].direction);
            __builtin_prefetch(&f->photons[map->ids[i + AHEAD]].power[2]);
        }
        const pm_photon *const p = &f->photons[map->ids[i]];
        pm__carry(map, i, p);
        for (int c = 0; c < 3; c++)
            most = (double)p->power[c] > most ? (double)p->power[c] : most;
    }
    f->max_power[chunk] = most;
}

static void fill_photons(filling *f, const pm_parallel *parallel)
{
    pm_map *const map = f->map;
    const size_t chunks = (map->count + CHUNK - 1) / CHUNK;
    pm__for(parallel, chunks, blocks_task, f);
    pm__for(parallel, chunks, carried_task, f); /* where the items were */
    for (size_t i = 0; i < chunks; i++)
        map->max_power = f->max_power[i] > map->max_power ? f->max_power[i] : map->max_power;
    for (size_t i = map->count; i < map->block_count * PM__LANES; i++) {
        pm__block *const block = &map->blocks[i / PM__LANES];
        block->x[i % PM__LANES] = block->y[i % PM__LANES] = block->z[i % PM__LANES] = INFINITY;
    }
}

/* The items lie where what photons carry comes later, so that takes their room while the map is built. */
static size_t room_for_items(const pm_map *map)
{
    const size_t carried = map->carried_size * sizeof *map->carried;
    return carried > sizeof(pm__item) ? carried : sizeof(pm__item);
}

static void give_back(pm_map *map)
{
    const size_t carried = map->carried_size * sizeof *map->carried;
    if (!map->count || room_for_items(map) == carried)
        return;
    float *const fitted = realloc(map->carried, map->count * carried);
    map->carried = fitted ? fitted : map->carried;
}

static pm_status allocate(pm_map *map)
{
    map->block_count = (map->count + PM__LANES - 1) / PM__LANES;
    map->blocks = pm__alloc(map->block_count, sizeof *map->blocks);
    map->ids = pm__alloc(map->count, sizeof *map->ids);
    map->carried = pm__alloc(map->count, room_for_items(map));
    return map->blocks && map->ids && map->carried ? PM_OK : PM_ENOMEM;
}

static pm_status arrange(filling *f, const pm__structure *primary, const pm_map_options *options)
{
    pm_map *const map = f->map;
    float low[3], high[3];
    if (!survey_all(f, options->parallel, low, high))
        return PM_ENONFINITE;
    choose_frame(map, low, high);
    pm__for(options->parallel, (map->count + CHUNK - 1) / CHUNK, items_task, f);
    pm_status status = PM_OK;
    if (primary)
        status = primary->arrange(f->items, map->count, options, &map->index[primary->id]);
    if (status != PM_OK)
        return status;
    fill_photons(f, options->parallel);
    return primary && primary->place ? primary->place(map, map->index[primary->id], NULL, options->parallel)
                                     : PM_OK;
}

static pm_status build(pm_map *map, const pm_photon *photons, const pm__structure *primary,
                       const pm_map_options *options)
{
    filling *const f = malloc(sizeof *f);
    pm_status status = f ? allocate(map) : PM_ENOMEM;
    if (f) {
        f->map = map;
        f->photons = photons;
        f->items = (void *)map->carried; /* filled when the items are done with */
        if (status == PM_OK)
            status = arrange(f, primary, options);
        if (status == PM_OK)
            give_back(map);
    }
    free(f);
    return status;
}

pm_status pm__map_build(const pm_photon *photons, size_t count, pm__structure_id primary, const pm_map_options *options,
                        pm_map **map, pm_error *error)
{
    pm_status status = check_photons(photons, count, error);
    if (status != PM_OK)
        return status;
    pm_map *const created = calloc(1, sizeof *created);
    if (!created)
        return pm__fail(error, PM_ENOMEM, "out of memory for a map");
    created->count = count;
    created->simd = options->simd;
    created->search = options->search;
    created->split = options->split;
    created->carried_size = options->no_directions ? PM__POWER : PM__POWER_AND_DIRECTION;
    status = build(created, photons, pm__structure_of(primary), options);
    if (status != PM_OK) {
        pm_map_destroy(created);
        if (status == PM_ENONFINITE)
            return find_infinite(photons, count, error);
        return pm__fail(error, status, "a map of %zu photons: %s", count, pm_status_text(status));
    }
    *map = created;
    return PM_OK;
}

/* Items in arranged order know the caller's indices; the map knows numbers by them. */
static pm_status place_later(pm_map *map, const pm__structure *structure, const pm__item *items, void *index)
{
    uint32_t *const number_of_id = pm__alloc(map->count, sizeof *number_of_id);
    uint32_t *const numbers = pm__alloc(map->count, sizeof *numbers);
    pm_status status = PM_ENOMEM;
    if (number_of_id && numbers) {
        for (size_t i = 0; i < map->count; i++)
            number_of_id[map->ids[i]] = (uint32_t)i;
        for (size_t i = 0; i < map->count; i++)
            numbers[i] = number_of_id[items[i].id];
        status = structure->place ? structure->place(map, index, numbers, NULL) : PM_OK;
    }
    free(number_of_id);
    free(numbers);
    return status;
}

pm_status pm__map_add(pm_map *map, pm__structure_id id, const pm_parallel *parallel, pm_error *error)
{
    const pm__structure *const structure = pm__structure_of(id);
    if (!structure || map->index[id])
        return PM_OK;
    if (structure->first_only)
        return pm__fail(error, PM_EINVAL, "this search's structure gives a map its order: create the map for it");
    const pm_map_options options = {.split = map->split, .parallel = parallel};
    pm__item *const items = pm__alloc(map->count, sizeof *items);
    void *index = NULL;
    pm_status status = items ? PM_OK : PM_ENOMEM;
    for (size_t i = 0; i < map->count && items; i++) {
        pm__position(map, i, items[i].position);
        items[i].id = map->ids[i];
    }
    if (status == PM_OK)
        status = structure->arrange(items, map->count, &options, &index);
    if (status == PM_OK)
        status = place_later(map, structure, items, index);
    free(items);
    if (status != PM_OK) {
        structure->destroy(index);
        return pm__fail(error, status, "a structure of %zu photons: %s", map->count, pm_status_text(status));
    }
    map->index[id] = index;
    return PM_OK;
}

void pm_map_destroy(pm_map *map)
{
    if (!map)
        return;
    for (int id = 0; id < PM__STRUCTURES; id++)
        if (map->index[id])
            pm__structure_of((pm__structure_id)id)->destroy(map->index[id]);
    free(map->blocks);
    free(map->ids);
    free(map->carried);
    free(map);
}

size_t pm_map_count(const pm_map *map)
{
    return map->count;
}

pm_photon pm_map_photon(const pm_map *map, uint32_t number)
{
    pm_photon photon = {.direction = {0.0f, 0.0f, 0.0f}};
    float position[3];
    pm__position(map, number, position);
    for (int a = 0; a < 3; a++) {
        photon.position[a] = (float)((double)position[a] * map->unit + map->centre[a]);
        photon.power[a] = pm__power(map, number)[a];
    }
    if (pm__has_directions(map))
        memcpy(photon.direction, pm__direction(map, number), sizeof photon.direction);
    return photon;
}

uint32_t pm_map_source(const pm_map *map, uint32_t number)
{
    return map->ids[number];
}

double pm_map_unit(const pm_map *map)
{
    return map->unit;
}

double pm_map_max_power(const pm_map *map)
{
    return map->max_power;
}
