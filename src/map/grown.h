/* PM__GROWN: a kd-tree grown photon by photon in the caller's order, as in Suykens and Jensen 1995, and maps that grow
 * while they are searched.
 *
 * A new photon descends to an empty place and becomes a leaf there; the first photon that comes after it gives the leaf
 * its axis, the next after its parent's along which the two differ. A tree grown in random order is left as it is: its
 * height is about 3 log2 N (Devroye 1986). Two things tell an order that is not (sorted photons, equal ones): a path of
 * more than 4 log2 N + 8 links, or one of more than 8 nodes with an empty side. Then the lowest subtree to blame is
 * built anew, balanced (a scapegoat tree: Galperin and Rivest 1993). So no walk is deeper than PM__GROWN_HEIGHT, for
 * any order, and adding costs O(log^2 N) amortised. */
#ifndef PM_MAP_GROWN_H
#define PM_MAP_GROWN_H

#include "map.h"

enum { PM__GROWN_HEIGHT = 4 * 30 + 10 };

#define PM__NO_CHILD ((uint32_t)PM_MAX_PHOTONS)

/* Node n holds the photon of number n. 20 bytes, 24 with the photon's index. */
typedef struct pm__grown_node {
    float position[3];
    uint32_t left_axis; /* number of the left child << 2 | split axis */
    uint32_t right;
} pm__grown_node;

/* Invariant: with a = axis of a node, every node of its left subtree comes before it, every node of the right one after
 * it, in the order (position[a], the caller's index). */
typedef struct pm__grown {
    pm__grown_node *nodes;
    size_t capacity;
    uint32_t root; /* PM__NO_CHILD in an empty tree */
} pm__grown;

static inline const pm__grown *pm__grown_of(const pm_map *map)
{
    return map->index[PM__GROWN];
}

static inline unsigned pm__grown_axis(const pm__grown_node *node)
{
    return node->left_axis & 3U;
}

static inline uint32_t pm__grown_child(const pm__grown_node *node, unsigned right)
{
    return right ? node->right : node->left_axis >> 2;
}

/* EBROKEN where a photon is on the wrong side of a plane, missing, or too deep. */
pm_status pm__grown_check(const pm_map *map, pm_error *error);

/* An empty map that can grow. extent: a length of the size of what is to come, m, > 0 and finite; it sets the map's
 * unit, and only needs to be right to within some powers of ten. options->search should walk PM__GROWN. Destroy with
 * pm_map_destroy. */
pm_status pm__growing_create(double extent, const pm_map_options *options, pm_map **map, pm_error *error);

/* Adds a photon: its number and caller's index are the count before. Nobody else may use the map meanwhile; afterwards
 * it is searched like any other. ENONFINITE; EINVAL for a map that has another structure too, is full, or lies 1e18
 * times its unit away; ENOMEM. On error the map is as before. */
pm_status pm__growing_add(pm_map *map, const pm_photon *photon, pm_error *error);

#endif
