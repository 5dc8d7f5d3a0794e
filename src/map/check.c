/* The checker of a map's invariants (stated in map.h). */
#include "map.h"

#include "../base/memory.h"
#include "../base/status.h"

#include <math.h>
#include <stdlib.h>

/* Does a come before b along the axis, in the order of the build? */
static bool in_order(const pm__node *a, const pm__node *b, unsigned axis)
{
    const float x = a->position[axis], y = b->position[axis];
    return x < y || (x == y && pm__node_id(a) < pm__node_id(b));
}

static pm_status check_ids(const pm_map *map, pm_error *error)
{
    unsigned char *const seen = pm__alloc_zero(map->count, 1);
    if (!seen)
        return pm__fail(error, PM_ENOMEM, "out of memory for the check");
    pm_status status = PM_OK;
    for (size_t i = 1; i <= map->count && status == PM_OK; i++) {
        const uint32_t id = pm__node_id(&map->nodes[i]);
        if (id >= map->count || seen[id])
            status = pm__fail(error, PM_EBROKEN, "node %zu: id %u is out of range or stands twice", i, id);
        else
            seen[id] = 1;
    }
    free(seen);
    return status;
}

/* Each node against each of its ancestors: O(N log N), and no more room than the path. */
static pm_status check_planes(const pm_map *map, pm_error *error)
{
    for (size_t i = 1; i <= map->count; i++) {
        const pm__node *const node = &map->nodes[i];
        if (pm__node_axis(node) > 2)
            return pm__fail(error, PM_EBROKEN, "node %zu: split axis %u", i, pm__node_axis(node));
        for (size_t child = i; child > 1; child /= 2) {
            const pm__node *const ancestor = &map->nodes[child / 2];
            const unsigned axis = pm__node_axis(ancestor);
            if (child % 2 ? !in_order(ancestor, node, axis) : !in_order(node, ancestor, axis))
                return pm__fail(error, PM_EBROKEN, "node %zu is on the wrong side of node %zu", i, child / 2);
        }
    }
    return PM_OK;
}

pm_status pm_map_check(const pm_map *map, pm_error *error)
{
    for (size_t i = 1; i <= map->count; i++)
        for (int a = 0; a < 3; a++)
            if (!isfinite(map->nodes[i].position[a]) || !isfinite(map->direction[i - 1][a]) ||
                !isfinite(map->power[i - 1][a]))
                return pm__fail(error, PM_EBROKEN, "node %zu: a value is not finite", i);
    const pm_status status = check_ids(map, error);
    return status == PM_OK ? check_planes(map, error) : status;
}
