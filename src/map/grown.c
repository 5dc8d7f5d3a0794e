/* The tree of grown.h: descent, and subtrees built anew. */
#include "grown.h"
#include "structure.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Nodes with but one child on the way to a new leaf. In random order a node of n photons below is one with probability
 * 2/n, so only the lowest few are; more of them mean an order that leaves one side of its planes empty. */
enum { MOST_LONE = 8 };

/* While a tree grows a photon's number is the caller's index, and so the tie-breaker. */
static bool before(const pm__grown *tree, uint32_t a, uint32_t b, unsigned axis)
{
    const float x = tree->nodes[a].position[axis], y = tree->nodes[b].position[axis];
    return x < y || (x == y && a < b);
}

static unsigned widest(const float low[3], const float high[3])
{
    unsigned axis = 0;
    for (unsigned a = 1; a < 3; a++)
        if (high[a] - low[a] > high[axis] - low[axis])
            axis = a;
    return axis;
}

static void set_child(pm__grown_node *node, unsigned right, uint32_t child)
{
    if (right)
        node->right = child;
    else
        node->left_axis = child << 2 | pm__grown_axis(node);
}

static unsigned height_limit(size_t count)
{
    unsigned levels = 0;
    while (count >>= 1)
        levels++;
    return 4 * levels + 8;
}

/* Appends the subtree's photons; a plain recursion, for no tree is deep. */
static size_t collect(const pm__grown *tree, uint32_t root, pm__item *items, size_t count)
{
    while (root != PM__NO_CHILD) {
        const pm__grown_node *const node = &tree->nodes[root];
        if (items) {
            memcpy(items[count].position, node->position, sizeof node->position);
            items[count].id = root;
        }
        count = collect(tree, pm__grown_child(node, 0), items, count + 1);
        root = node->right;
    }
    return count;
}

static uint32_t build_balanced(pm__grown *tree, pm__item *items, size_t count)
{
    if (!count)
        return PM__NO_CHILD;
    float low[3], high[3];
    memcpy(low, items[0].position, sizeof low);
    memcpy(high, items[0].position, sizeof high);
    for (size_t i = 1; i < count; i++)
        for (int a = 0; a < 3; a++) {
            low[a] = fminf(low[a], items[i].position[a]);
            high[a] = fmaxf(high[a], items[i].position[a]);
        }
    const unsigned axis = widest(low, high);
    const size_t half = count / 2;
    pm__select_rank(items, count, half, axis);
    const uint32_t root = items[half].id;
    const uint32_t left = build_balanced(tree, items, half);
    tree->nodes[root].left_axis = left << 2 | axis;
    tree->nodes[root].right = build_balanced(tree, items + half + 1, count - half - 1);
    return root;
}

/* Builds the subtree of path[level] anew. Out of memory: the tree stays as it is, valid but deep. */
static pm_status rebuild(pm__grown *tree, const uint32_t *path, unsigned level, size_t count)
{
    pm__item *const items = pm__alloc(count, sizeof *items);
    if (!items)
        return PM_ENOMEM;
    (void)collect(tree, path[level], items, 0);
    const uint32_t root = build_balanced(tree, items, count);
    free(items);
    if (level == 0) {
        tree->root = root;
    } else {
        pm__grown_node *const parent = &tree->nodes[path[level - 1]];
        set_child(parent, parent->right == path[level], root);
    }
    return PM_OK;
}

/* The scapegoat of a path of `depth` links that is too long: the lowest node on it with n photons below it and more
 * than 4 log2 n links to the path's end (the root is one). One link further down there was none, so the scapegoat has a
 * child with more than 2^(-1/4) of its photons: balanced, it stays fit for a number of additions of the order of n.
 * A path with too many lone nodes: the lowest that has so many below it. Balanced it is lone no more, and each photon
 * was below so few lone nodes, that all such rebuilding costs O(log N) a photon. */
static pm_status level_out(pm__grown *tree, const uint32_t *path, unsigned depth, bool too_long)
{
    size_t below = 1;
    unsigned lone = 0;
    for (unsigned level = depth; level-- > 0;) {
        const pm__grown_node *const node = &tree->nodes[path[level]];
        const uint32_t other = pm__grown_child(node, node->right != path[level + 1]);
        below = collect(tree, other, NULL, below + 1);
        lone += other == PM__NO_CHILD;
        if (too_long ? (double)(depth - level) > 4.0 * log2((double)below) : lone > MOST_LONE)
            return rebuild(tree, path, level, below);
    }
    return PM_OK;
}

/* The axis that a node splits. A leaf takes, when a photon comes after it, the first axis after its parent's along
 * which the two differ: axes take turns ([Bentley 1975]), but where photons lie in a plane or on a line no level is
 * wasted on parting what is not apart. No bounding box is asked: that of photons so far says little of those to
 * come. */
static unsigned axis_at(pm__grown_node *node, const float position[3], unsigned above)
{
    if (node->right == PM__NO_CHILD && pm__grown_child(node, 0) == PM__NO_CHILD) {
        unsigned axis = (above + 1) % 3;
        for (int tried = 1; tried < 3 && position[axis] == node->position[axis]; tried++)
            axis = (axis + 1) % 3;
        node->left_axis = PM__NO_CHILD << 2 | axis;
    }
    return pm__grown_axis(node);
}

/* Hangs node `number`, whose position is set, into a tree of `count` others. On error it is not there. */
static pm_status insert(pm__grown *tree, uint32_t number, size_t count)
{
    pm__grown_node *const added = &tree->nodes[number];
    uint32_t path[PM__GROWN_HEIGHT + 1];
    unsigned depth = 0, right = 0, axis = 2, lone = 0;
    for (uint32_t at = tree->root; at != PM__NO_CHILD; at = pm__grown_child(&tree->nodes[at], right)) {
        axis = axis_at(&tree->nodes[at], added->position, axis);
        right = before(tree, at, number, axis);
        lone += pm__grown_child(&tree->nodes[at], !right) == PM__NO_CHILD;
        path[depth++] = at;
    }
    path[depth] = number;
    added->left_axis = PM__NO_CHILD << 2;
    added->right = PM__NO_CHILD;
    if (!depth)
        tree->root = number;
    else
        set_child(&tree->nodes[path[depth - 1]], right, number);
    const bool too_long = depth > height_limit(count + 1);
    if (!too_long && lone <= MOST_LONE)
        return PM_OK;
    const pm_status status = level_out(tree, path, depth, too_long);
    if (status != PM_OK) /* one link too many would let the next path outgrow its bound */
        set_child(&tree->nodes[path[depth - 1]], right, PM__NO_CHILD);
    return status;
}

static void destroy(void *index)
{
    pm__grown *const tree = index;
    if (!tree)
        return;
    free(tree->nodes);
    free(tree);
}

/* The map's order becomes the caller's, in which the tree grows. */
static pm_status sort_by_id(pm__item *items, size_t count)
{
    pm__item *const copy = pm__alloc(count, sizeof *copy);
    if (!copy)
        return PM_ENOMEM;
    memcpy(copy, items, count * sizeof *copy);
    for (size_t i = 0; i < count; i++)
        items[copy[i].id] = copy[i];
    free(copy);
    return PM_OK;
}

static pm_status arrange(pm__item *items, size_t count, const pm_map_options *options, void **index)
{
    (void)options;
    pm__grown *const tree = calloc(1, sizeof *tree);
    if (!tree)
        return PM_ENOMEM;
    *tree = (pm__grown){.nodes = pm__alloc(count, sizeof *tree->nodes), .capacity = count, .root = PM__NO_CHILD};
    pm_status status = tree->nodes ? sort_by_id(items, count) : PM_ENOMEM;
    for (size_t i = 0; i < count && status == PM_OK; i++) {
        memcpy(tree->nodes[i].position, items[i].position, sizeof items[i].position);
        status = insert(tree, (uint32_t)i, i);
    }
    if (status != PM_OK)
        destroy(tree);
    else
        *index = tree;
    return status;
}

static uint32_t renumber(uint32_t child, const uint32_t *numbers)
{
    return child == PM__NO_CHILD ? child : numbers[child];
}

/* In a map of another order the nodes are moved to where their photons' numbers say: no table is needed, and neighbours
 * in that order share cache lines. */
static pm_status place(const pm_map *map, void *index, const uint32_t *numbers, const pm_parallel *parallel)
{
    (void)parallel;
    pm__grown *const tree = index;
    if (!numbers)
        return PM_OK;
    pm__grown_node *const moved = pm__alloc(map->count, sizeof *moved);
    if (!moved)
        return PM_ENOMEM;
    for (size_t i = 0; i < map->count; i++) {
        const pm__grown_node *const node = &tree->nodes[i];
        pm__grown_node *const to = &moved[numbers[i]];
        *to = *node;
        to->left_axis = renumber(pm__grown_child(node, 0), numbers) << 2 | pm__grown_axis(node);
        to->right = renumber(node->right, numbers);
    }
    free(tree->nodes);
    tree->nodes = moved;
    tree->root = renumber(tree->root, numbers);
    return PM_OK;
}

static size_t bytes(const pm_map *map, const void *index)
{
    (void)map;
    return ((const pm__grown *)index)->capacity * sizeof(pm__grown_node);
}

const pm__structure pm__structure_grown = {PM__GROWN, arrange, place, destroy, bytes, false, 20.0, 16.0, 0.0};

/* ---- maps that grow ----------------------------------------------------------------------------- */

pm_status pm__growing_create(double extent, const pm_map_options *options, pm_map **map, pm_error *error)
{
    *map = NULL;
    if (!(extent > 0.0 && isfinite(extent)))
        return pm__fail(error, PM_EINVAL, "a growing map's extent is %g m: it is positive", extent);
    const pm_status status = pm__map_build(NULL, 0, PM__GROWN, options, map, error);
    if (status != PM_OK)
        return status;
    int exponent = 0;
    (void)frexp(extent, &exponent);
    (*map)->unit = ldexp(1.0, exponent);
    (*map)->inverse_unit = 1.0 / (*map)->unit;
    return PM_OK;
}

static bool enlarge(void **array, size_t size, size_t from, size_t to)
{
    void *const larger = pm__alloc(to, size);
    if (!larger)
        return false;
    if (from)
        memcpy(larger, *array, from * size);
    free(*array);
    *array = larger;
    return true;
}

/* Arrays that were enlarged before one was refused stay so: nobody sees it. */
static pm_status reserve(pm_map *map, pm__grown *tree)
{
    if (map->count < tree->capacity)
        return PM_OK;
    const size_t n = map->count, room = n < 32 ? 64 : n < PM_MAX_PHOTONS / 2 ? 2 * n : PM_MAX_PHOTONS;
    const size_t size = map->carried_size * sizeof *map->carried;
    void *blocks = map->blocks, *ids = map->ids, *carried = map->carried, *nodes = tree->nodes;
    const bool done = enlarge(&blocks, sizeof *map->blocks, map->block_count, (room + PM__LANES - 1) / PM__LANES) &&
                      enlarge(&ids, sizeof *map->ids, n, room) && enlarge(&carried, size, n, room) &&
                      enlarge(&nodes, sizeof *tree->nodes, n, room);
    map->blocks = blocks;
    map->ids = ids;
    map->carried = carried;
    tree->nodes = nodes;
    if (done)
        tree->capacity = room;
    return done ? PM_OK : PM_ENOMEM;
}

static bool finite3(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static pm_status check_addition(const pm_map *map, const pm_photon *photon, pm_error *error)
{
    for (int id = 0; id < PM__STRUCTURES; id++)
        if ((map->index[id] != NULL) != (id == PM__GROWN))
            return pm__fail(error, PM_EINVAL, "only a map of the grown tree alone can grow");
    if (map->count >= PM_MAX_PHOTONS)
        return pm__fail(error, PM_EINVAL, "a map holds at most %zu photons", PM_MAX_PHOTONS);
    if (!finite3(photon->position) || !finite3(photon->direction) || !finite3(photon->power))
        return pm__fail(error, PM_ENONFINITE, "photon %zu: a value is not finite", map->count);
    for (int a = 0; a < 3; a++)
        if (!(fabs(((double)photon->position[a] - map->centre[a]) * map->inverse_unit) <= 1e18))
            return pm__fail(error, PM_EINVAL, "photon %zu lies too far away for the map's unit of %g m", map->count,
                            map->unit);
    return PM_OK;
}

static void append(pm_map *map, const pm_photon *photon, const float position[3])
{
    const size_t n = map->count, lane = n % PM__LANES;
    pm__block *const block = &map->blocks[n / PM__LANES];
    if (!lane)
        for (size_t i = 0; i < PM__LANES; i++)
            block->x[i] = block->y[i] = block->z[i] = INFINITY;
    block->x[lane] = position[0];
    block->y[lane] = position[1];
    block->z[lane] = position[2];
    map->ids[n] = (uint32_t)n;
    pm__carry(map, n, photon);
    for (int c = 0; c < 3; c++)
        map->max_power = fmax(map->max_power, (double)photon->power[c]);
    map->count = n + 1;
    map->block_count = n / PM__LANES + 1;
}

pm_status pm__growing_add(pm_map *map, const pm_photon *photon, pm_error *error)
{
    pm_status status = check_addition(map, photon, error);
    if (status != PM_OK)
        return status;
    pm__grown *const tree = map->index[PM__GROWN];
    status = reserve(map, tree);
    if (status == PM_OK) {
        float *const position = tree->nodes[map->count].position;
        for (int a = 0; a < 3; a++)
            position[a] = (float)(((double)photon->position[a] - map->centre[a]) * map->inverse_unit);
        status = insert(tree, (uint32_t)map->count, map->count);
    }
    if (status != PM_OK)
        return pm__fail(error, status, "photon %zu: %s", map->count, pm_status_text(status));
    append(map, photon, tree->nodes[map->count].position);
    return PM_OK;
}

/* ---- the checker -------------------------------------------------------------------------------- */

static bool in_order(const pm_map *map, uint32_t a, uint32_t b, unsigned axis)
{
    const pm__grown_node *const nodes = pm__grown_of(map)->nodes;
    const float x = nodes[a].position[axis], y = nodes[b].position[axis];
    return x < y || (x == y && map->ids[a] < map->ids[b]);
}

/* Looks every photon up by its place in the order; found at its own node, on a path that is short enough, each of them
 * stands in the tree once and on the right side of every plane above it. */
pm_status pm__grown_check(const pm_map *map, pm_error *error)
{
    const pm__grown *const tree = pm__grown_of(map);
    for (size_t i = 0; i < map->count; i++) {
        const pm__grown_node *const node = &tree->nodes[i];
        float position[3];
        pm__position(map, i, position);
        if (memcmp(position, node->position, sizeof position) != 0 || pm__grown_axis(node) > 2)
            return pm__fail(error, PM_EBROKEN, "node %zu: its position is not its photon's, or it splits no axis", i);
        uint32_t at = tree->root;
        for (unsigned depth = 0; at != i; depth++) {
            if (at >= map->count || depth > PM__GROWN_HEIGHT)
                return pm__fail(error, PM_EBROKEN, "photon %zu is not where the tree's planes say", i);
            const pm__grown_node *const above = &tree->nodes[at];
            at = pm__grown_child(above, in_order(map, at, (uint32_t)i, pm__grown_axis(above)));
        }
    }
    return PM_OK;
}
