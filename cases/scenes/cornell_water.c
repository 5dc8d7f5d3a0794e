/* The Cornell box with water in it. The water's surface is a mesh of 20000 triangles, waves along two directions; its
 * rim lies in the walls' very planes, so that light comes in by the surface alone. In front, where the box is open, the
 * water ends in an upright face: corners of the same coordinates, so no gap between them. Elsewhere the walls bound it:
 * they are met from within the water, without a boundary. */
#include "room.h"

#include "../../src/scene/revolve.h"

#include <string.h>

enum { LEVEL, WAVES, ABSORPTION, CELLS = 100, SIDE = CELLS + 1 };

static const double pi = 3.14159265358979323846, ior = 1.33;

static const pm__param params[] = {
    {.name = "level", .type = PM__REAL, .value = 0.35, .min = 0.1, .max = 0.85, .unit = "m",
     .help = "mean height of the water's surface; the box is 1 m high"},
    {.name = "waves", .type = PM__REAL, .value = 0.01, .min = 0.0, .max = 0.02, .unit = "m",
     .help = "amplitude of each of two waves across one another"},
    {.name = "absorption", .type = PM__REAL, .value = 0.2, .min = 0.0, .max = 10.0, .unit = "1/m",
     .help = "of blue light in the water; red is absorbed four times, green twice as much"},
};

/* Both waves stand off the walls at an angle, as if the water had been stirred. */
static double surface(const double *values, double x, double y)
{
    return values[LEVEL] + values[WAVES] * (cos(2.0 * pi * (2.6 * x + 1.1 * y) + 0.4) +
                                            cos(2.0 * pi * (-1.3 * x + 2.9 * y) + 1.3));
}

static void set_vertex(pm__mesh *mesh, size_t vertex, double x, double y, double z)
{
    const float at[3] = {(float)x, (float)y, (float)z};
    memcpy(mesh->vertices[vertex], at, sizeof at);
}

/* a, b, c, d counterclockwise from the side that the normal points to. */
static void add_cell(pm__mesh *mesh, size_t *next, size_t a, size_t b, size_t c, size_t d)
{
    const uint32_t both[2][3] = {{(uint32_t)a, (uint32_t)b, (uint32_t)c}, {(uint32_t)a, (uint32_t)c, (uint32_t)d}};
    memcpy(mesh->triangles[*next], both, sizeof both);
    *next += 2;
}

/* Across the box, from -PM__CORNELL_HALF to PM__CORNELL_HALF. */
static double across(size_t i)
{
    return ((double)i / CELLS - 0.5) * 2.0 * PM__CORNELL_HALF;
}

static void set_surface(const double *values, pm__mesh *mesh)
{
    size_t next = 0;
    for (size_t j = 0; j < SIDE; j++)
        for (size_t i = 0; i < SIDE; i++)
            set_vertex(mesh, j * SIDE + i, across(i), across(j), surface(values, across(i), across(j)));
    for (size_t j = 0; j < CELLS; j++)
        for (size_t i = 0; i < CELLS; i++) {
            const size_t at = j * SIDE + i;
            add_cell(mesh, &next, at, at + 1, at + SIDE + 1, at + SIDE);
        }
}

static void set_face(const double *values, pm__mesh *mesh)
{
    size_t next = 0;
    for (size_t i = 0; i < SIDE; i++) {
        set_vertex(mesh, i, across(i), across(0), surface(values, across(i), across(0)));
        set_vertex(mesh, SIDE + i, across(i), across(0), 0.0);
    }
    for (size_t i = 0; i < CELLS; i++)
        add_cell(mesh, &next, SIDE + i, SIDE + i + 1, i + 1, i);
}

static pm_status add_mesh(const double *values, void (*set)(const double *values, pm__mesh *mesh), size_t vertices,
                          size_t triangles, uint32_t material, pm__scene *scene, pm_error *error)
{
    pm__mesh mesh;
    pm_status status = pm__mesh_create(vertices, triangles, &mesh, error);
    if (status)
        return status;
    set(values, &mesh);
    status = pm__scene_mesh(scene, material, (const float(*)[3])mesh.vertices, mesh.vertex_count,
                            (const uint32_t(*)[3])mesh.triangles, mesh.triangle_count, error);
    pm__mesh_free(&mesh);
    return status;
}

static pm_status add_water(const double *values, pm__scene *scene, pm_error *error)
{
    const double a = values[ABSORPTION];
    const pm__material water = {.kind = PM__GLASS, .ior = {ior, ior, ior}, .absorption = {4.0 * a, 2.0 * a, a}};
    uint32_t material;
    pm_status status = pm__scene_material(scene, &water, &material, error);
    if (!status)
        status = add_mesh(values, set_surface, SIDE * SIDE, 2 * CELLS * CELLS, material, scene, error);
    return status ? status : add_mesh(values, set_face, 2 * SIDE, 2 * CELLS, material, scene, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__room room = pm__cornell_room(0.75);
    pm_status status = pm__room_walls(scene, &room, error);
    if (!status)
        status = add_water(values, scene, error);
    return status ? status : pm__cornell_lamp(scene, 0.2, 12.0, error);
}

const pm__case pm__case_scene_cornell_water = {
    .entry = {.name = "scene:cornell-water",
              .summary = "Cornell box half full of water with waves",
              .citation = "course 43, Fig. 2.23",
              .params = params,
              .param_count = 3},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = pm__cornell_view,
};
