/* The recursive search on a tree grown photon by photon: what balancing is worth shows by comparison with `recursive`,
 * from which it differs in the tree alone. */
#include "../map/grown.h"
#include "result.h"

typedef struct walk {
    const pm_map *map;
    const pm__grown_node *nodes;
    const pm__query *query;
    pm__result *result;
} walk;

static void visit(const walk *w, uint32_t number)
{
    const pm__grown_node *const node = &w->nodes[number];
    const unsigned axis = pm__grown_axis(node);
    const float to_plane = w->query->position[axis] - node->position[axis];
    /* On the plane itself: to the right, where all equal ones went that came later. Else walls of a box, on which
     * queries and planes coincide, would be searched from the empty side. */
    const unsigned side = to_plane >= 0.0f;
    const uint32_t near = pm__grown_child(node, side), far = pm__grown_child(node, !side);
    if (near != PM__NO_CHILD)
        visit(w, near);
    if (far != PM__NO_CHILD && pm__reaches(w->query, w->result, to_plane * to_plane))
        visit(w, far);
    pm__offer(w->map, w->query, w->result, node->position, number);
}

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    const pm__grown *const tree = pm__grown_of(map);
    const walk w = {map, tree->nodes, query, result};
    if (tree->root != PM__NO_CHILD)
        visit(&w, tree->root);
}

const pm_search pm__search_unbalanced = {
    .entry = {.name = "unbalanced", .summary = "recursive descent of a kd-tree grown photon by photon, not balanced",
              .citation = "Suykens and Jensen 1995; Jensen 1996"},
    .structure = PM__GROWN,
    .find = find,
};
