/* The recursive search of [C02] Fig. 2.10, with its two errors mended: the right child is visited only where it
 * exists and no node is left out (errata 14), and the radius shrinks only once k photons are held (errata 15). */
#include "result.h"

typedef struct walk {
    const pm_map *map;
    const pm__node *nodes;
    const pm__query *query;
    pm__result *result;
} walk;

static void visit(const walk *w, size_t i)
{
    const size_t count = w->map->count;
    const pm__node *const node = &w->nodes[i];
    if (2 * i <= count) {
        const unsigned axis = pm__node_axis(node);
        const float to_plane = w->query->position[axis] - node->position[axis];
        const size_t near = 2 * i + (to_plane > 0.0f), far = near ^ 1;
        if (near <= count)
            visit(w, near);
        if (far <= count && pm__reaches(w->query, w->result, to_plane * to_plane))
            visit(w, far);
    }
    pm__offer_node(w->map, w->query, w->result, node);
}

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    const walk w = {map, pm__tree(map), query, result};
    if (map->count)
        visit(&w, 1);
}

const pm_search pm__search_recursive = {
    .entry = {.name = "recursive", .summary = "recursive descent of the left-balanced kd-tree, nearer side first",
              .citation = "course 43, Fig. 2.10 and 5.3.1"},
    .structure = PM__KD_TREE,
    .find = find,
};
