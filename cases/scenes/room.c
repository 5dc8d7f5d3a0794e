#include "room.h"

#include "../../src/scene/revolve.h"

#include <string.h>

/* A flat wall from its corner. cross(u, v) points inward. */
typedef struct wall {
    double corner[3], u[3], v[3];
} wall;

static pm_status add_wall(pm__scene *scene, uint32_t material, const wall *w, pm_error *error)
{
    return pm__scene_rectangle(scene, material, w->corner, w->u, w->v, error);
}

pm__room pm__cornell_room(double albedo)
{
    const double dim = 0.2 * albedo;
    return (pm__room){.half = {PM__CORNELL_HALF, PM__CORNELL_HALF},
                      .height = PM__CORNELL_HEIGHT,
                      .white = {albedo, albedo, albedo},
                      .left = {albedo, dim, dim},
                      .right = {dim, dim, albedo},
                      .open = true};
}

void pm__cornell_view(const double *values, pm__view *view)
{
    (void)values;
    const double away = 1.44;
    *view = (pm__view){.eye = {0, -PM__CORNELL_HALF - away, PM__CORNELL_HALF},
                       .at = {0, 0, PM__CORNELL_HALF},
                       .up = {0, 0, 1},
                       .angle = 2.0 * atan(PM__CORNELL_HALF / away)};
}

/* A lamp in the very plane of the ceiling would leave it to rounding which of the two a ray meets. */
static const double below_ceiling = 1e-3;

pm_status pm__cornell_lamp(pm__scene *scene, double half, double watts, pm_error *error)
{
    const double centre[3] = {0, 0, PM__CORNELL_HEIGHT - below_ceiling}, power[3] = {watts, watts, watts};
    return pm__room_lamp(scene, centre, half, power, error);
}

pm_status pm__diffuse_material(pm__scene *scene, const double albedo[3], uint32_t *index, pm_error *error)
{
    pm__material material = {.kind = PM__DIFFUSE};
    memcpy(material.diffuse, albedo, sizeof material.diffuse);
    return pm__scene_material(scene, &material, index, error);
}

pm_status pm__mirror_material(pm__scene *scene, uint32_t *index, pm_error *error)
{
    const pm__material material = {.kind = PM__MIRROR, .specular = {1, 1, 1}};
    return pm__scene_material(scene, &material, index, error);
}

pm_status pm__glass_material(pm__scene *scene, double ior, uint32_t *index, pm_error *error)
{
    const pm__material material = {.kind = PM__GLASS, .ior = {ior, ior, ior}};
    return pm__scene_material(scene, &material, index, error);
}

pm_status pm__cornell_spheres(pm__scene *scene, double ior, double moved, pm_error *error)
{
    /* m; were they to touch the floor, rounding would decide what is met first */
    const double radius = 0.18, above_floor = 1e-4;
    const double left[3] = {-0.24, 0.2, radius + above_floor}, right[3] = {0.24, -0.16 + moved, radius + above_floor};
    uint32_t mirror, glass;
    pm_status status = pm__mirror_material(scene, &mirror, error);
    if (!status)
        status = pm__glass_material(scene, ior, &glass, error);
    if (!status)
        status = pm__scene_sphere(scene, mirror, left, radius, false, error);
    return status ? status : pm__scene_sphere(scene, glass, right, radius, false, error);
}

/* The ceiling as four strips around its hole, or whole. */
static pm_status add_ceiling(pm__scene *scene, uint32_t material, const pm__room *room, pm_error *error)
{
    const double a = room->half[0], b = room->half[1], h = room->height, s = room->skylight;
    const wall whole = {{-a, -b, h}, {0, 2 * b, 0}, {2 * a, 0, 0}};
    const wall strips[] = {{{-a, -b, h}, {0, 2 * b, 0}, {a - s, 0, 0}}, {{s, -b, h}, {0, 2 * b, 0}, {a - s, 0, 0}},
                           {{-s, -b, h}, {0, b - s, 0}, {2 * s, 0, 0}}, {{-s, s, h}, {0, b - s, 0}, {2 * s, 0, 0}}};
    if (!(s > 0.0))
        return add_wall(scene, material, &whole, error);
    pm_status status = PM_OK;
    for (int i = 0; i < 4 && !status; i++)
        status = add_wall(scene, material, &strips[i], error);
    return status;
}

pm_status pm__room_walls(pm__scene *scene, const pm__room *room, pm_error *error)
{
    const double a = room->half[0], b = room->half[1], h = room->height;
    const wall ground = {{-a, -b, 0}, {2 * a, 0, 0}, {0, 2 * b, 0}}, back = {{-a, b, 0}, {2 * a, 0, 0}, {0, 0, h}};
    const wall front = {{-a, -b, 0}, {0, 0, h}, {2 * a, 0, 0}}, left = {{-a, -b, 0}, {0, 2 * b, 0}, {0, 0, h}};
    const wall right = {{a, -b, 0}, {0, 0, h}, {0, 2 * b, 0}};
    uint32_t white, on_left, on_right;
    pm_status status = pm__diffuse_material(scene, room->white, &white, error);
    if (!status)
        status = pm__diffuse_material(scene, room->left, &on_left, error);
    if (!status)
        status = pm__diffuse_material(scene, room->right, &on_right, error);
    if (!status && !room->no_floor)
        status = add_wall(scene, white, &ground, error);
    if (!status)
        status = add_ceiling(scene, white, room, error);
    if (!status)
        status = add_wall(scene, white, &back, error);
    if (!status && !room->open)
        status = add_wall(scene, white, &front, error);
    if (!status)
        status = add_wall(scene, on_left, &left, error);
    return status ? status : add_wall(scene, on_right, &right, error);
}

pm_status pm__room_block(pm__scene *scene, uint32_t material, const double centre[2], double half, double height,
                         double turn, pm_error *error)
{
    const double x = half * cos(turn), y = half * sin(turn);
    const double ring[4][2] = {{x + y, y - x}, {x - y, y + x}, {-x - y, x - y}, {y - x, -x - y}};
    /* m; closed below, so that whoever stands in it sees walls all around, but not in the floor: rounding would decide
     * which of the two is met */
    const double above_floor = 1e-6;
    const wall top = {{centre[0] + ring[3][0], centre[1] + ring[3][1], height}, {2 * x, 2 * y, 0}, {-2 * y, 2 * x, 0}};
    const wall bottom = {{top.corner[0], top.corner[1], above_floor}, {-2 * y, 2 * x, 0}, {2 * x, 2 * y, 0}};
    pm_status status = add_wall(scene, material, &top, error);
    if (!status)
        status = add_wall(scene, material, &bottom, error);
    for (int i = 0; i < 4 && !status; i++) { /* counterclockwise from above, so cross(along, up) points outward */
        const double *const p = ring[i], *const q = ring[(i + 1) % 4];
        const wall side = {{centre[0] + p[0], centre[1] + p[1], 0}, {q[0] - p[0], q[1] - p[1], 0}, {0, 0, height}};
        status = add_wall(scene, material, &side, error);
    }
    return status;
}

/* Corner c lies to the high side of each axis whose bit it has. */
static void set_corner(const pm__brick *brick, size_t corner, float vertex[3])
{
    const double x = corner & 1 ? brick->half[0] : -brick->half[0];
    const double y = corner & 2 ? brick->half[1] : -brick->half[1];
    const double z = corner & 4 ? brick->half[2] : -brick->half[2];
    const double back = cos(brick->lean) * y + sin(brick->lean) * z;
    vertex[0] = (float)(brick->centre[0] + cos(brick->turn) * x - sin(brick->turn) * back);
    vertex[1] = (float)(brick->centre[1] + sin(brick->turn) * x + cos(brick->turn) * back);
    vertex[2] = (float)(brick->centre[2] - sin(brick->lean) * y + cos(brick->lean) * z);
}

static void set_brick(const pm__brick *brick, size_t number, pm__mesh *mesh)
{
    /* counterclockwise from outside */
    static const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const uint32_t first = (uint32_t)(8 * number);
    for (size_t c = 0; c < 8; c++)
        set_corner(brick, c, mesh->vertices[first + c]);
    for (size_t f = 0; f < 6; f++)
        for (size_t half = 0; half < 2; half++) {
            uint32_t *const triangle = mesh->triangles[12 * number + 2 * f + half];
            triangle[0] = first + faces[f][0];
            triangle[1] = first + faces[f][1 + half];
            triangle[2] = first + faces[f][2 + half];
        }
}

pm_status pm__room_bricks(pm__scene *scene, uint32_t material, const pm__brick *bricks, size_t count, pm_error *error)
{
    pm__mesh mesh;
    pm_status status = pm__mesh_create(8 * count, 12 * count, &mesh, error);
    if (status)
        return status;
    for (size_t i = 0; i < count; i++)
        set_brick(&bricks[i], i, &mesh);
    status = pm__scene_mesh(scene, material, (const float(*)[3])mesh.vertices, mesh.vertex_count,
                            (const uint32_t(*)[3])mesh.triangles, mesh.triangle_count, error);
    pm__mesh_free(&mesh);
    return status;
}

pm_status pm__room_lamp(pm__scene *scene, const double centre[3], double half, const double power[3], pm_error *error)
{
    const pm__light light = {.kind = PM__RECTANGLE,
                             .power = {power[0], power[1], power[2]},
                             .position = {centre[0] - half, centre[1] - half, centre[2]},
                             .edge = {{0, 2 * half, 0}, {2 * half, 0, 0}}};
    return pm__scene_light(scene, &light, error);
}
