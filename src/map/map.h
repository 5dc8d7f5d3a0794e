/* Inside a pm_map. */
#ifndef PM_MAP_MAP_H
#define PM_MAP_MAP_H

#include "../photonmap.h"

/* A photon as the searches see it. 16 bytes, so four share a cache line. */
typedef struct pm__node {
    float position[3];  /* map units, relative to the map's centre */
    uint32_t id_axis;   /* caller's index << 2 | split axis */
} pm__node;

/* Invariants: nodes[1..count] is a left-balanced kd-tree in heap order: the children of i are 2i and 2i+1,
 * those beyond count do not exist. With a = axis of i, every node of the left subtree comes before i, every
 * node of the right one after it, in the order (position[a], id). ids are a permutation of 0..count-1.
 * Photon `number` of the public interface is node number+1; direction and power are stored in that order. */
struct pm_map {
    size_t count;
    pm__node *nodes;       /* count + 1; nodes[0] is unused */
    float (*direction)[3]; /* count */
    float (*power)[3];     /* count, W */
    double centre[3];      /* m */
    double unit;           /* m in a map unit: a power of two */
    double inverse_unit;
    double max_power;
};

static inline uint32_t pm__node_id(const pm__node *node)
{
    return node->id_axis >> 2;
}

static inline unsigned pm__node_axis(const pm__node *node)
{
    return node->id_axis & 3U;
}

/* Sorts nodes[0..count) of ids and positions into out[1..count] in heap order. Deterministic: the order is
 * total (coordinate, then id), so neither ties nor threads can change the tree. */
void pm__balance(pm__node *work, size_t count, pm_split split, const pm_parallel *parallel, pm__node *out);

/* Number of nodes in the left subtree of a left-balanced tree of `count` nodes (errata 18). */
size_t pm__left_size(size_t count);

#endif
