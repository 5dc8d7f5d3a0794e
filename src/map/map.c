/* Creation and reading of maps. */
#include "map.h"

#include "../base/memory.h"
#include "../base/status.h"

#include <math.h>
#include <stdlib.h>

static pm_status check_photons(const pm_photon *photons, size_t count, pm_error *error)
{
    static const char *const parts[] = {"position", "direction", "power"};
    if (count > PM_MAX_PHOTONS)
        return pm__fail(error, PM_EINVAL, "%zu photons: a map holds at most %zu", count, PM_MAX_PHOTONS);
    if (count && !photons)
        return pm__fail(error, PM_EINVAL, "no photons given");
    for (size_t i = 0; i < count; i++) {
        const float *const values[] = {photons[i].position, photons[i].direction, photons[i].power};
        for (int part = 0; part < 3; part++)
            for (int a = 0; a < 3; a++)
                if (!isfinite(values[part][a]))
                    return pm__fail(error, PM_ENONFINITE, "photon %zu: its %s is not finite", i, parts[part]);
    }
    return PM_OK;
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

static void choose_frame(pm_map *map, const pm_photon *photons)
{
    double largest = 0.0;
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < map->count; i++) {
            const double x = (double)photons[i].position[a];
            low = fmin(low, x);
            high = fmax(high, x);
        }
        map->centre[a] = map->count ? exact_centre(low, high) : 0.0;
        if (map->count)
            largest = fmax(largest, fmax(fabs(low - map->centre[a]), fabs(high - map->centre[a])));
    }
    int exponent = 0;
    (void)frexp(largest, &exponent);
    map->unit = largest > 0.0 ? ldexp(1.0, exponent) : 1.0;
    map->inverse_unit = 1.0 / map->unit;
}

/* Direction and power in the tree's order. */
static void order_attributes(pm_map *map, const pm_photon *photons)
{
    for (size_t i = 0; i < map->count; i++) {
        const pm_photon *const p = &photons[pm__node_id(&map->nodes[i + 1])];
        for (int a = 0; a < 3; a++) {
            map->direction[i][a] = p->direction[a];
            map->power[i][a] = p->power[a];
            map->max_power = fmax(map->max_power, (double)p->power[a]);
        }
    }
}

static pm_status build(pm_map *map, const pm_photon *photons, const pm_map_options *options, pm_error *error)
{
    const pm_map_options defaults = {PM_SPLIT_EXTENT, NULL};
    if (!options)
        options = &defaults;
    map->nodes = pm__alloc(map->count + 1, sizeof *map->nodes);
    map->direction = pm__alloc(map->count, sizeof *map->direction);
    map->power = pm__alloc(map->count, sizeof *map->power);
    pm__node *const work = pm__alloc(map->count, sizeof *work);
    if (!map->nodes || !map->direction || !map->power || !work) {
        free(work);
        return pm__fail(error, PM_ENOMEM, "out of memory for a map of %zu photons", map->count);
    }
    choose_frame(map, photons);
    for (size_t i = 0; i < map->count; i++)
        for (int a = 0; a < 3; a++)
            work[i].position[a] = (float)(((double)photons[i].position[a] - map->centre[a]) * map->inverse_unit);
    map->nodes[0] = (pm__node){{0.0f, 0.0f, 0.0f}, 0};
    pm__balance(work, map->count, options->split, options->parallel, map->nodes);
    free(work);
    order_attributes(map, photons);
    return PM_OK;
}

pm_status pm_map_create(const pm_photon *photons, size_t count, const pm_map_options *options, pm_map **map,
                        pm_error *error)
{
    if (!map)
        return pm__fail(error, PM_EINVAL, "nowhere to put the map");
    *map = NULL;
    pm_status status = check_photons(photons, count, error);
    if (status != PM_OK)
        return status;
    pm_map *const created = calloc(1, sizeof *created);
    if (!created)
        return pm__fail(error, PM_ENOMEM, "out of memory for a map");
    created->count = count;
    status = build(created, photons, options, error);
    if (status != PM_OK) {
        pm_map_destroy(created);
        return status;
    }
    *map = created;
    return PM_OK;
}

void pm_map_destroy(pm_map *map)
{
    if (!map)
        return;
    free(map->nodes);
    free(map->direction);
    free(map->power);
    free(map);
}

size_t pm_map_count(const pm_map *map)
{
    return map->count;
}

pm_photon pm_map_photon(const pm_map *map, uint32_t number)
{
    pm_photon photon;
    for (int a = 0; a < 3; a++) {
        photon.position[a] = (float)((double)map->nodes[number + 1].position[a] * map->unit + map->centre[a]);
        photon.direction[a] = map->direction[number][a];
        photon.power[a] = map->power[number][a];
    }
    return photon;
}

uint32_t pm_map_source(const pm_map *map, uint32_t number)
{
    return pm__node_id(&map->nodes[number + 1]);
}

double pm_map_unit(const pm_map *map)
{
    return map->unit;
}

double pm_map_max_power(const pm_map *map)
{
    return map->max_power;
}
