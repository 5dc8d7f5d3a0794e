/* Square rooms in a square grid, each lit by a lamp of its own; the camera stands in one in the middle and sees a part
 * of the next through a door. Between neighbours is a wall, with a doorway in it or none: every room has one to the
 * east or to the north, by a hash of its place (those at the far ends the one that is possible), so all are connected;
 * a few more are opened by the hash, and the one that the camera looks at.
 *
 * Walls are as thick as lies between the faces of their two sides. All faces are cut at the doors' width and height,
 * doors or not, so that they meet at whole edges; measures are sums of powers of two, so that these agree to the last
 * bit. Floor, ceiling and the outside of all are one room around it. Lengths in m. */
#include "room.h"

#include "../../src/scene/revolve.h"

#include <string.h>

enum { ROOMS, ALBEDO };

enum { MOST_ROOMS = 16, TINTS = 3, SIDES = 4, CUTS = 4 };

static const double pitch = 3.0, inside = 1.4375, height = 2.5;  /* room to room; half a room; of the ceiling */
static const double door[2] = {0.4375, 2.0}, below_ceiling = 1e-3; /* half width, height */

static const pm__param params[] = {
    {.name = "rooms", .type = PM__INTEGER, .value = 16.0, .min = 2.0, .max = MOST_ROOMS, .unit = "",
     .help = "so many rows of so many rooms"},
    {.name = "albedo", .type = PM__REAL, .value = 0.6, .min = 0.0, .max = 0.99, .unit = "",
     .help = "of the walls"},
};

typedef struct maze {
    int rooms, seen; /* the camera's room is (seen, seen) */
    double albedo;
} maze;

static maze maze_of(const double *values)
{
    const int rooms = (int)values[ROOMS];
    return (maze){.rooms = rooms, .seen = (rooms - 1) / 2, .albedo = values[ALBEDO]};
}

/* Any mixing would do. */
static uint32_t hash(int x, int y, uint32_t purpose)
{
    uint32_t h = (uint32_t)x * 0x9e3779b1u + (uint32_t)y * 0x85ebca6bu + purpose * 0xc2b2ae35u + 1u;
    for (int i = 0; i < 2; i++) {
        h ^= h >> 15;
        h *= 0x2c1b3c6du;
        h ^= h >> 13;
    }
    return h;
}

static double middle(const maze *m, int place)
{
    return pitch * (place - 0.5 * (m->rooms - 1));
}

/* ---- Doors ----------------------------------------------------------------------------------- */

/* From (x, y) to the north, or else to the east. */
static bool leads(const maze *m, int x, int y, bool north)
{
    const int last = m->rooms - 1;
    if (north ? y == last : x == last)
        return false;
    const bool chosen = y == last ? false : x == last ? true : hash(x, y, 0) & 1;
    return chosen == north || hash(x, y, 1 + north) % 8 == 0 || (north && x == m->seen && y == m->seen);
}

/* Sides: east, north, west, south. */
static bool has_door(const maze *m, int x, int y, int side)
{
    switch (side) {
    case 0: return leads(m, x, y, false);
    case 1: return leads(m, x, y, true);
    case 2: return x > 0 && leads(m, x - 1, y, false);
    default: return y > 0 && leads(m, x, y - 1, true);
    }
}

/* ---- Walls ----------------------------------------------------------------------------------- */

/* The wall at one side of a room. out, along: across it and along it, counterclockwise about the room. */
typedef struct wall {
    double centre[2];
    int out[2], along[2];
} wall;

/* NULL for mesh: only counts. */
typedef struct sheet {
    pm__mesh *mesh;
    size_t quads;
} sheet;

static wall wall_of(const maze *m, int x, int y, int side)
{
    static const int turn[SIDES + 1] = {1, 0, -1, 0, 1};
    const int c = turn[side], s = turn[(side + 3) % SIDES];
    return (wall){.centre = {middle(m, x), middle(m, y)}, .out = {c, s}, .along = {-s, c}};
}

/* Corners: out of the room's middle, along the wall, up; counterclockwise from the side that the normal points to. */
static void add_quad(sheet *s, const wall *w, const double corners[4][3])
{
    static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    const size_t quad = s->quads++;
    if (!s->mesh)
        return;
    for (size_t c = 0; c < 4; c++) {
        for (int a = 0; a < 2; a++)
            s->mesh->vertices[4 * quad + c][a] =
                (float)(w->centre[a] + w->out[a] * corners[c][0] + w->along[a] * corners[c][1]);
        s->mesh->vertices[4 * quad + c][2] = (float)corners[c][2];
    }
    for (size_t half = 0; half < 2; half++)
        for (size_t c = 0; c < 3; c++)
            s->mesh->triangles[2 * quad + half][c] = (uint32_t)(4 * quad) + halves[half][c];
}

static void add_face(sheet *s, const wall *w, bool open)
{
    const double along[CUTS] = {-inside, -door[0], door[0], inside}, up[3] = {0, door[1], height};
    for (int i = 0; i < CUTS - 1; i++)
        for (int j = 0; j < 2; j++) {
            const double quad[4][3] = {{inside, along[i], up[j]}, {inside, along[i], up[j + 1]},
                                       {inside, along[i + 1], up[j + 1]}, {inside, along[i + 1], up[j]}};
            if (!(open && i == 1 && j == 0))
                add_quad(s, w, quad);
        }
}

/* Through the wall: left, right, above. */
static void add_doorway(sheet *s, const wall *w)
{
    const double near = inside, far = pitch - inside, side = door[0], top = door[1];
    const double quads[3][4][3] = {
        {{near, -side, 0}, {near, -side, top}, {far, -side, top}, {far, -side, 0}},
        {{near, side, 0}, {far, side, 0}, {far, side, top}, {near, side, top}},
        {{near, -side, top}, {near, side, top}, {far, side, top}, {far, -side, top}},
    };
    for (int i = 0; i < 3; i++)
        add_quad(s, w, quads[i]);
}

/* The walls of all rooms of one tint, with the doorways to the east and the north. */
static void add_rooms(sheet *s, const maze *m, uint32_t tint)
{
    for (int y = 0; y < m->rooms; y++)
        for (int x = 0; x < m->rooms; x++)
            for (int side = 0; side < SIDES && hash(x, y, 3) % TINTS == tint; side++) {
                const wall w = wall_of(m, x, y, side);
                const bool open = has_door(m, x, y, side);
                add_face(s, &w, open);
                if (open && side < 2)
                    add_doorway(s, &w);
            }
}

static pm_status add_walls(const maze *m, uint32_t tint, pm__scene *scene, pm_error *error)
{
    static const double tints[TINTS][3] = {{1, 1, 1}, {1, 0.75, 0.5}, {0.6, 0.8, 1}};
    double albedo[3];
    uint32_t material;
    pm__mesh mesh;
    sheet count = {.mesh = NULL}, made = {.mesh = &mesh};
    for (int b = 0; b < 3; b++)
        albedo[b] = m->albedo * tints[tint][b];
    add_rooms(&count, m, tint);
    if (count.quads == 0)
        return PM_OK;
    pm_status status = pm__diffuse_material(scene, albedo, &material, error);
    if (!status)
        status = pm__mesh_create(4 * count.quads, 2 * count.quads, &mesh, error);
    if (status)
        return status;
    add_rooms(&made, m, tint);
    status = pm__scene_mesh(scene, material, (const float(*)[3])mesh.vertices, mesh.vertex_count,
                            (const uint32_t(*)[3])mesh.triangles, mesh.triangle_count, error);
    pm__mesh_free(&mesh);
    return status;
}

/* ---- What is in the rooms -------------------------------------------------------------------- */

/* A block in a corner of each room, off the ways between doors; in the camera's not where that is. */
static pm_status add_blocks(const maze *m, uint32_t material, pm__scene *scene, pm_error *error)
{
    const double off = 0.85, half = 0.24, above_floor = 1e-4;
    pm__brick bricks[MOST_ROOMS * MOST_ROOMS];
    size_t count = 0;
    for (int y = 0; y < m->rooms; y++)
        for (int x = 0; x < m->rooms; x++) {
            const uint32_t h = x == m->seen && y == m->seen ? 3 : hash(x, y, 4);
            const double tall = 0.3 + 0.05 * (h >> 2 & 7);
            bricks[count++] = (pm__brick){.centre = {middle(m, x) + (h & 1 ? off : -off),
                                                     middle(m, y) + (h & 2 ? off : -off), tall + above_floor},
                                          .half = {half, half, tall},
                                          .turn = 0.2 + 0.15 * (h >> 5 & 7)};
        }
    return pm__room_bricks(scene, material, bricks, count, error);
}

static pm_status add_lamps(const maze *m, pm__scene *scene, pm_error *error)
{
    static const double warm[3] = {100, 85, 65}, cold[3] = {70, 85, 100}; /* W */
    pm_status status = PM_OK;
    for (int i = 0; i < m->rooms * m->rooms && !status; i++) {
        const int x = i % m->rooms, y = i / m->rooms;
        const double centre[3] = {middle(m, x), middle(m, y), height - below_ceiling};
        status = pm__room_lamp(scene, centre, 0.25, hash(x, y, 5) & 1 ? warm : cold, error);
    }
    return status;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const maze m = maze_of(values);
    const double a = m.albedo, half = 0.5 * pitch * m.rooms + (0.5 * pitch - inside);
    const pm__room around = {.half = {half, half}, .height = height, .white = {a, a, a}, .left = {a, a, a},
                             .right = {a, a, a}};
    uint32_t material;
    pm_status status = pm__room_walls(scene, &around, error);
    for (uint32_t tint = 0; tint < TINTS && !status; tint++)
        status = add_walls(&m, tint, scene, error);
    if (!status)
        status = pm__diffuse_material(scene, around.white, &material, error);
    if (!status)
        status = add_blocks(&m, material, scene, error);
    return status ? status : add_lamps(&m, scene, error);
}

static void view(const double *values, pm__view *from)
{
    const maze m = maze_of(values);
    const double x = middle(&m, m.seen), y = middle(&m, m.seen);
    *from = (pm__view){.eye = {x - 1.0, y - 1.25, 1.5}, .at = {x + 0.2, y + 1.4, 0.95}, .up = {0, 0, 1}, .angle = 0.95};
}

const pm__case pm__case_scene_maze = {
    .entry = {.name = "scene:maze",
              .summary = "maze of rooms, each with its lamp, of which one is seen",
              .citation = "after course 43, 3.7.2 and 5.7",
              .params = params,
              .param_count = 2},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
