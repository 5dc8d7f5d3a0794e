/* The checker of a map's invariants (stated in map.h). */
#include "grid.h"
#include "grown.h"
#include "map.h"
#include "wide.h"

#include "../base/memory.h"
#include "../base/status.h"

#include <math.h>
#include <stdlib.h>

/* Does a come before b along the axis, in the order of the build? */
static bool in_order(const pm_map *map, const pm__node *a, const pm__node *b, unsigned axis)
{
    const float x = a->position[axis], y = b->position[axis];
    return x < y || (x == y && map->ids[pm__node_number(a)] < map->ids[pm__node_number(b)]);
}

static pm_status check_ids(const pm_map *map, pm_error *error)
{
    unsigned char *const seen = pm__alloc_zero(map->count, 1);
    if (!seen)
        return pm__fail(error, PM_ENOMEM, "out of memory for the check");
    pm_status status = PM_OK;
    for (size_t i = 0; i < map->count && status == PM_OK; i++) {
        const uint32_t id = map->ids[i];
        if (id >= map->count || seen[id])
            status = pm__fail(error, PM_EBROKEN, "photon %zu: index %u is out of range or stands twice", i, id);
        else
            seen[id] = 1;
    }
    free(seen);
    return status;
}

/* Each node against each of its ancestors: O(N log N), and no more room than the path. */
static pm_status check_planes(const pm_map *map, const pm__node *nodes, pm_error *error)
{
    for (size_t i = 1; i <= map->count; i++) {
        const pm__node *const node = &nodes[i];
        if (pm__node_axis(node) > 2)
            return pm__fail(error, PM_EBROKEN, "node %zu: split axis %u", i, pm__node_axis(node));
        for (size_t child = i; child > 1; child /= 2) {
            const pm__node *const ancestor = &nodes[child / 2];
            const unsigned axis = pm__node_axis(ancestor);
            if (child % 2 ? !in_order(map, ancestor, node, axis) : !in_order(map, node, ancestor, axis))
                return pm__fail(error, PM_EBROKEN, "node %zu is on the wrong side of node %zu", i, child / 2);
        }
    }
    return PM_OK;
}

/* Every photon stands in the tree once, with its own position. */
static pm_status check_tree(const pm_map *map, pm_error *error)
{
    const pm__node *const nodes = pm__tree(map);
    unsigned char *const seen = pm__alloc_zero(map->count, 1);
    if (!seen)
        return pm__fail(error, PM_ENOMEM, "out of memory for the check");
    pm_status status = PM_OK;
    for (size_t i = 1; i <= map->count && status == PM_OK; i++) {
        const uint32_t number = pm__node_number(&nodes[i]);
        float position[3] = {NAN, NAN, NAN};
        if (number < map->count && !seen[number]) {
            pm__position(map, number, position);
            seen[number] = 1;
        }
        for (int a = 0; a < 3 && status == PM_OK; a++)
            if (position[a] != nodes[i].position[a])
                status = pm__fail(error, PM_EBROKEN, "node %zu: photon %u is not there, or stands twice", i, number);
    }
    free(seen);
    return status == PM_OK ? check_planes(map, nodes, error) : status;
}

static bool all_finite(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

pm_status pm_map_check(const pm_map *map, pm_error *error)
{
    if (!map)
        return pm__fail(error, PM_EINVAL, "no map");
    for (size_t i = 0; i < map->count; i++) {
        float position[3];
        pm__position(map, i, position);
        if (!all_finite(position, 3) || !all_finite(pm__power(map, i), map->carried_size))
            return pm__fail(error, PM_EBROKEN, "photon %zu: a value is not finite", i);
    }
    pm_status status = check_ids(map, error);
    if (status == PM_OK && map->index[PM__KD_TREE])
        status = check_tree(map, error);
    if (status == PM_OK && map->index[PM__WIDE])
        status = pm__wide_check(map, error);
    if (status == PM_OK && map->index[PM__GRID])
        status = pm__grid_check(map, error);
    if (status == PM_OK && map->index[PM__GROWN])
        status = pm__grown_check(map, error);
    return status;
}
