/* Christensen's iterative search, [C02] 5.3.2, with the last non-leaf at floor(N/2) (errata 16). Where N is even
 * the path may step onto the missing node N+1: it is left at once. */
#include "result.h"

enum { LEVELS = 32 }; /* floor(log2 N) are needed (errata 17) */

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    float plane_distance2[LEVELS];
    size_t chosen[LEVELS];
    const pm__node *const nodes = pm__tree(map);
    const size_t count = map->count;
    size_t i = 1, level = 0;
    if (!count)
        return;
    for (;;) {
        while (2 * i <= count) {
            const pm__node *const node = &nodes[i];
            const unsigned axis = pm__node_axis(node);
            const float to_plane = query->position[axis] - node->position[axis];
            plane_distance2[level] = to_plane * to_plane;
            i = 2 * i + (to_plane > 0.0f);
            chosen[level++] = i;
        }
        if (i <= count)
            pm__offer_node(map, query, result, &nodes[i]);
        for (;;) { /* up, to a node whose other side is still to be seen */
            if (i == 1)
                return;
            const size_t from = i;
            i /= 2;
            level--;
            if (from == chosen[level]) {
                pm__offer_node(map, query, result, &nodes[i]);
                if (pm__reaches(query, result, plane_distance2[level]))
                    break;
            }
        }
        i = chosen[level++] ^ 1;
    }
}

const pm_search pm__search_iterative = {
    .entry = {.name = "iterative", .summary = "the same walk without recursion",
              .citation = "course 43, 5.3.2 (Christensen)"},
    .structure = PM__KD_TREE,
    .find = find,
};
