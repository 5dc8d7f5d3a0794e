/* What a structure is: something that searches walk, built from positions alone. */
#ifndef PM_MAP_STRUCTURE_H
#define PM_MAP_STRUCTURE_H

#include "map.h"

typedef struct pm__structure {
    pm__structure_id id;
    /* Sorts the items into the structure's own order and builds *index. */
    pm_status (*arrange)(pm__item *items, size_t count, const pm_map_options *options, void **index);
    /* Tells the index the map's numbers of its items in arranged order; numbers NULL: they are 0, 1, 2, ... The map's
     * arrays are complete by then. NULL: nothing to tell; but see first_only. */
    pm_status (*place)(const pm_map *map, void *index, const uint32_t *numbers, const pm_parallel *parallel);
    void (*destroy)(void *index);
    size_t (*bytes)(const pm_map *map, const void *index); /* beside ids and photons */
    bool first_only; /* can only give a map its order, not be added later */
    /* Bytes a photon at most, for those who ask before they build: beside position, id and what a photon carries; while
     * it is built, beside those too; and of those held the ones that tell sides, which need directions. */
    double held, building, sides;
} pm__structure;

extern const pm__structure pm__structure_tree, pm__structure_wide, pm__structure_grid, pm__structure_grown;

/* What every map has: position and id; what its photons carry comes to it. */
enum { PM__PLACE_BYTES = 16 };

/* Bytes a photon while a map whose order is that structure's is built, and of it when it is. directions: does it keep
 * them? */
double pm__bytes_to_build(pm__structure_id id, bool directions);
double pm__bytes_when_built(pm__structure_id id, bool directions);

/* By id; NULL for PM__NO_STRUCTURE. */
const pm__structure *pm__structure_of(pm__structure_id id);

#endif
