/* Wald's walk without a stack (2022): in heap order the parent of i is i/2 and its children are known, so where the
 * walk came from tells what is left to do at a node. Nothing is remembered but the node before; a plane is measured
 * anew each time the walk passes. */
#include "result.h"

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    const pm__node *const nodes = pm__tree(map);
    const size_t count = map->count;
    size_t from = 0, i = count ? 1 : 0;
    while (i) {
        size_t next = i / 2;
        if (i <= count) { /* else a child that does not exist: left at once, as if done */
            const pm__node *const node = &nodes[i];
            const unsigned axis = pm__node_axis(node);
            const float to_plane = query->position[axis] - node->position[axis];
            const size_t near = 2 * i + (to_plane > 0.0f), far = near ^ 1;
            if (from == i / 2) {
                pm__offer_node(map, query, result, node);
                if (2 * i <= count)
                    next = near;
            } else if (from == near && far <= count && pm__reaches(query, result, to_plane * to_plane)) {
                next = far;
            }
        }
        from = i;
        i = next;
    }
}

const pm_search pm__search_stackfree = {
    .entry = {.name = "stackfree", .summary = "the same walk with no memory of its way: the parent is half the index",
              .citation = "Wald 2022, arXiv:2210.12859"},
    .structure = PM__KD_TREE,
    .find = find,
};
