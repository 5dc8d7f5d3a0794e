/* Meshes that are the graph of a function over a rectangle, as the surface of water: what leaves one steeply does not
 * come back.
 *
 * Let all triangles face the same way along an axis. Seen along it, their edges cancel in pairs of opposite directions;
 * let those left over lie on the border of the rectangle about them all. How often a point is covered is then the same
 * everywhere within, so it is the sum of the triangles' areas over the rectangle's. Where that is 1 the mesh is a
 * function's graph, whose steepest triangle bounds how steep a way between any two of its points is: along the straight
 * line between them the function is nowhere steeper. */
#include "rays.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Of a normal along the axis: steeper ones are taken for walls. */
static const double LEAST_UPRIGHT = 0.1;

/* ---- Edges -------------------------------------------------------------------------------------- */

/* Directed edges that have not met their opposite, by open addressing: a slot's count is of low to high less the other
 * way. */
typedef struct edge {
    uint64_t key; /* both ends, the lower first; 0: the slot is free (no edge has two ends 0) */
    int64_t count;
} edge;

typedef struct edges {
    edge *slots;
    size_t mask;
} edges;

static void add_edge(edges *all, uint32_t a, uint32_t b)
{
    const uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    size_t at = (size_t)(key * UINT64_C(0x9e3779b97f4a7c15) >> 20) & all->mask;
    while (all->slots[at].key != key && all->slots[at].key != 0)
        at = (at + 1) & all->mask;
    all->slots[at].key = key;
    all->slots[at].count += a < b ? 1 : -1;
}

/* false: out of memory. */
static bool list_edges(const pm__geometry *mesh, edges *all)
{
    size_t size = 8;
    while (size < (size_t)mesh->count * 6) /* three edges a triangle, half of the slots free */
        size *= 2;
    *all = (edges){.slots = pm__alloc_zero(size, sizeof *all->slots), .mask = size - 1};
    for (size_t i = 0; i < mesh->count && all->slots; i++)
        for (int k = 0; k < 3; k++)
            add_edge(all, mesh->triangles[i][k], mesh->triangles[i][(k + 1) % 3]);
    return all->slots;
}

/* Does the edge lie on one of the four lines? Corners are exact, and so are the sides of the box about them. */
static bool is_border(const pm__geometry *mesh, uint64_t key, const int across[2])
{
    const float *const a = mesh->vertices[key >> 32], *const b = mesh->vertices[key & UINT32_MAX];
    for (int i = 0; i < 2; i++) {
        const double at = (double)a[across[i]], other = (double)b[across[i]];
        if (at == other && (at == mesh->low[across[i]] || at == mesh->high[across[i]]))
            return true;
    }
    return false;
}

static bool is_closed_within(const pm__geometry *mesh, const int across[2])
{
    edges all;
    bool closed = list_edges(mesh, &all);
    for (size_t i = 0; closed && i <= all.mask; i++)
        closed = all.slots[i].count == 0 || is_border(mesh, all.slots[i].key, across);
    free(all.slots);
    return closed;
}

/* ---- Sheets ------------------------------------------------------------------------------------- */

/* Twice the area as seen along the axis, signed. */
static double shadow(const pm__geometry *mesh, const uint32_t triangle[3], const int across[2])
{
    double side[2][2];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            side[i][k] = (double)mesh->vertices[triangle[i + 1]][across[k]] -
                         (double)mesh->vertices[triangle[0]][across[k]];
    return side[0][0] * side[1][1] - side[0][1] * side[1][0];
}

double pm__sheet_steepness(const pm__geometry *mesh, int axis)
{
    const int across[2] = {(axis + 1) % 3, (axis + 2) % 3};
    const double sign = mesh->planes[0].normal[axis] < 0.0 ? -1.0 : 1.0;
    double flattest = 1.0, area = 0.0, rectangle = 2.0;
    for (size_t i = 0; i < mesh->count && flattest > LEAST_UPRIGHT; i++) {
        flattest = fmin(flattest, sign * mesh->planes[i].normal[axis]);
        area += sign * shadow(mesh, mesh->triangles[i], across);
    }
    for (int k = 0; k < 2; k++)
        rectangle *= mesh->high[across[k]] - mesh->low[across[k]];
    /* A whole number but for rounding. */
    if (!(flattest > LEAST_UPRIGHT) || !(fabs(area / rectangle - 1.0) < 0.01) || !is_closed_within(mesh, across))
        return 2.0;
    /* The sine of the steepest way's height; rounding of normals and directions, with much to spare. */
    return sqrt(1.0 - flattest * flattest) + 1e-6;
}
