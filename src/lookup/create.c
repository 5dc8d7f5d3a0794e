/* Maps as the public interface creates them: for a search, with a width of SIMD. */
#include "../map/structure.h"
#include "../search/search.h"
#include "../search/wide.h"

#include <stdlib.h>

static const pm_search *default_search(void)
{
    return (const pm_search *)(const void *)pm__searches.entries[0];
}

pm_status pm_map_create(const pm_photon *photons, size_t count, const pm_map_options *options, pm_map **map,
                        pm_error *error)
{
    if (!map)
        return pm__fail(error, PM_EINVAL, "nowhere to put the map");
    *map = NULL;
    pm_map_options chosen = {.split = PM_SPLIT_EXTENT};
    if (options)
        chosen = *options;
    if (chosen.split != PM_SPLIT_EXTENT && chosen.split != PM_SPLIT_VARIANCE)
        return pm__fail(error, PM_EINVAL, "split rule %d is none", (int)chosen.split);
    if (!chosen.search)
        chosen.search = default_search();
    pm_status status = pm__choose_simd(chosen.simd, &chosen.simd, error);
    if (status != PM_OK)
        return status;
    status = pm__map_build(photons, count, chosen.search->structure, &chosen, map, error);
    if (status != PM_OK || !chosen.search->finish)
        return status;
    status = chosen.search->finish(*map, chosen.parallel);
    if (status != PM_OK) {
        pm_map_destroy(*map);
        *map = NULL;
        return pm__fail(error, status, "a map of %zu photons: %s", count, pm_status_text(status));
    }
    return PM_OK;
}

pm_status pm_map_prepare(pm_map *map, const pm_search *search, const pm_parallel *parallel, pm_error *error)
{
    if (!map || !search)
        return pm__fail(error, PM_EINVAL, "a map and a search are needed");
    return pm__map_add(map, search->structure, parallel, error);
}

size_t pm_map_bytes(const pm_map *map)
{
    size_t bytes = map->count * sizeof *map->ids;
    bool own_positions = false;
    for (int id = 0; id < PM__STRUCTURES; id++)
        if (map->index[id]) {
            const pm__structure *const structure = pm__structure_of((pm__structure_id)id);
            bytes += structure->bytes(map, map->index[id]);
            own_positions = true;
        }
    return own_positions ? bytes : bytes + map->block_count * sizeof *map->blocks;
}

const char *pm_map_simd(const pm_map *map)
{
    return pm__simd_name(map->simd);
}
