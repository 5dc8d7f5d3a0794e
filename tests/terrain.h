/* Meshes of random heights over a rectangle, for tests: a cell is two triangles. Seen along any axis, facing along it
 * or against it. */
#ifndef PM_TESTS_TERRAIN_H
#define PM_TESTS_TERRAIN_H

#include "../src/base/random.h"
#include "../src/base/vec3.h"
#include "../src/scene/rays.h"
#include "test.h"

#include <string.h>

enum { SIDE = 7, CELLS = SIDE - 1, MOST_VERTICES = 2 * SIDE * SIDE + 8, MOST_TRIANGLES = 4 * CELLS * CELLS + 8 };

typedef struct terrain {
    float vertices[MOST_VERTICES][3];
    uint32_t triangles[MOST_TRIANGLES][3];
    size_t vertex_count, triangle_count;
    int axis;
    bool faces_back;
} terrain;

static inline void terrain_vertex(terrain *t, double u, double v, double height)
{
    float *const at = t->vertices[t->vertex_count++];
    at[t->axis] = (float)height;
    at[(t->axis + 1) % 3] = (float)u;
    at[(t->axis + 2) % 3] = (float)v;
}

/* Counterclockwise as seen against the axis. */
static inline void terrain_triangle(terrain *t, size_t a, size_t b, size_t c)
{
    const uint32_t way[3] = {(uint32_t)a, (uint32_t)(t->faces_back ? c : b), (uint32_t)(t->faces_back ? b : c)};
    memcpy(t->triangles[t->triangle_count++], way, sizeof way);
}

/* About `level`, on [-1, 1]^2, heights within `rough` either way; inner places moved within their cells. The number
 * decides which. */
static inline terrain terrain_of(int axis, bool faces_back, double level, double rough, uint64_t number)
{
    terrain t = {.axis = axis, .faces_back = faces_back};
    for (size_t j = 0; j < SIDE; j++)
        for (size_t i = 0; i < SIDE; i++) {
            double u[3];
            pm__random_uniform(7, PM__FOR_TESTS, 60, number * SIDE * SIDE + j * SIDE + i, u, 3);
            const bool inner_u = i > 0 && i < CELLS, inner_v = j > 0 && j < CELLS;
            terrain_vertex(&t, (double)i * 2.0 / CELLS - 1.0 + inner_u * 0.12 * (u[0] - 0.5),
                           (double)j * 2.0 / CELLS - 1.0 + inner_v * 0.12 * (u[1] - 0.5),
                           level + rough * (2.0 * u[2] - 1.0));
        }
    for (size_t j = 0; j < CELLS; j++)
        for (size_t i = 0; i < CELLS; i++) {
            const size_t at = j * SIDE + i, turned = (i + j + number) % 2;
            terrain_triangle(&t, at, at + 1, at + SIDE + turned);
            terrain_triangle(&t, at + SIDE + 1, at + SIDE, at + !turned);
        }
    return t;
}

/* The same surface to the last bit, no longer known as one: one corner of a triangle in the middle is a vertex of its
 * own, in the same place. */
static inline terrain terrain_split(const terrain *whole)
{
    terrain t = *whole;
    uint32_t *const corner = &t.triangles[CELLS * CELLS + CELLS][0];
    memcpy(t.vertices[t.vertex_count], t.vertices[*corner], sizeof *t.vertices);
    *corner = (uint32_t)t.vertex_count++;
    return t;
}

static inline void terrain_add(const terrain *t, uint32_t material, pm__scene *scene)
{
    pm_error error;
    PM_CHECK_OK(pm__scene_mesh(scene, material, t->vertices, t->vertex_count, (const uint32_t(*)[3])t->triangles,
                               t->triangle_count, &error), error);
}

#endif
