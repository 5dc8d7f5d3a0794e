/* An office of many desks under many lamps, of which the camera sees the top of one: a glossy pad, photos on stands
 * behind it, mirrored in the pad, and the wall. Desks, chairs and what lies on the other desks are parts, placed as
 * often as they are wanted; boxes all of them, apart by a gap that light hardly finds. A desk's place is the middle of
 * its footprint; who sits at it looks along y. */
#include "room.h"

enum { DESKS, ALBEDO };

static const double pitch[2] = {2.4, 2.2}, margin = 0.4, height = 2.7;        /* m */
static const double gap = 1e-4, desk_half[2] = {0.7, 0.35}, desk_top = 0.735; /* m */

static const pm__param params[] = {
    {.name = "desks", .type = PM__INTEGER, .value = 4.0, .min = 1.0, .max = 16.0, .unit = "",
     .help = "so many rows of so many desks"},
    {.name = "albedo", .type = PM__REAL, .value = 0.6, .min = 0.0, .max = 0.99, .unit = "", .help = "of the walls"},
};

/* ---- Where things are ------------------------------------------------------------------------- */

static double half_width(int desks, int axis)
{
    return 0.5 * desks * pitch[axis] + margin;
}

/* Row 0 stands by the back wall. */
static void desk_at(int desks, int column, int row, double at[2])
{
    at[0] = pitch[0] * (column - 0.5 * (desks - 1));
    at[1] = half_width(desks, 1) - desk_half[1] - 0.1 - row * pitch[1];
}

static void seen_desk(int desks, double at[2])
{
    desk_at(desks, desks / 2, 0, at);
}

/* ---- Parts ------------------------------------------------------------------------------------ */

static pm_status add_boxes(pm__scene *scene, const double albedo[3], const pm__brick *bricks, size_t count,
                           pm_error *error)
{
    uint32_t material;
    const pm_status status = pm__diffuse_material(scene, albedo, &material, error);
    return status ? status : pm__room_bricks(scene, material, bricks, count, error);
}

/* A top, four legs, drawers. */
static pm_status fill_desk(pm__scene *part, pm_error *error)
{
    static const double wood[3] = {0.55, 0.4, 0.25}, thick = 0.015, leg = 0.025;
    const double under = desk_top - 2.0 * thick, long_half = 0.5 * under - gap;
    pm__brick bricks[6] = {
        {.centre = {0, 0, desk_top - thick}, .half = {desk_half[0], desk_half[1], thick}},
        {.centre = {0.42, 0, under - 0.26}, .half = {0.19, 0.3, 0.25}},
    };
    for (int i = 0; i < 4; i++)
        bricks[2 + i] = (pm__brick){.centre = {(i & 1 ? 1 : -1) * (desk_half[0] - 0.05),
                                               (i & 2 ? 1 : -1) * (desk_half[1] - 0.05), 0.5 * under},
                                    .half = {leg, leg, long_half}};
    return add_boxes(part, wood, bricks, 6, error);
}

/* A seat, four legs, a back on two posts. */
static pm_status fill_chair(pm__scene *part, pm_error *error)
{
    static const double cloth[3] = {0.15, 0.25, 0.4};
    pm__brick bricks[8] = {
        {.centre = {0, 0, 0.45}, .half = {0.22, 0.22, 0.025}},
        {.centre = {0, -0.19, 0.8}, .half = {0.22, 0.02, 0.2}},
    };
    for (int i = 0; i < 4; i++)
        bricks[2 + i] = (pm__brick){.centre = {i & 1 ? 0.19 : -0.19, i & 2 ? 0.19 : -0.19, 0.2125},
                                    .half = {0.02, 0.02, 0.2125 - gap}};
    for (int i = 0; i < 2; i++)
        bricks[6 + i] = (pm__brick){.centre = {i ? 0.15 : -0.15, -0.19, 0.5375},
                                    .half = {0.015, 0.015, 0.0625 - gap}};
    return add_boxes(part, cloth, bricks, 8, error);
}

/* A screen and its keys, two books. */
static pm_status fill_things(pm__scene *part, pm_error *error)
{
    static const double grey[3] = {0.3, 0.3, 0.32};
    const double z = desk_top + gap;
    const pm__brick bricks[] = {
        {.centre = {-0.15, 0.18, z + 0.2}, .half = {0.27, 0.03, 0.2}, .turn = 0.1},
        {.centre = {-0.12, -0.12, z + 0.012}, .half = {0.22, 0.08, 0.012}, .turn = 0.05},
        {.centre = {0.45, 0.05, z + 0.02}, .half = {0.1, 0.14, 0.02}, .turn = -0.2},
        {.centre = {0.45, 0.05, z + 0.06 + gap}, .half = {0.09, 0.13, 0.02}, .turn = 0.25},
    };
    return add_boxes(part, grey, bricks, sizeof bricks / sizeof *bricks, error);
}

static pm_status put(pm__scene *scene, pm__scene *part, const double at[2], double forward, double turn,
                     pm_error *error)
{
    const double c = cos(turn), s = sin(turn);
    const pm__placement placement = {
        .rotation = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}}, .scale = 1.0, .offset = {at[0], at[1] + forward, 0}};
    return pm__scene_place(scene, part, &placement, error);
}

/* Chairs are turned this way and that; the seen desk has other things on it. */
static pm_status add_desks(int desks, pm__scene *const parts[3], pm__scene *scene, pm_error *error)
{
    pm_status status = PM_OK;
    for (int i = 0; i < desks * desks && !status; i++) {
        double at[2];
        const bool seen = i == desks / 2;
        desk_at(desks, i % desks, i / desks, at);
        status = put(scene, parts[0], at, 0.0, 0.0, error);
        if (!status)
            status = put(scene, parts[1], at, -0.62, 0.4 * sin(2.4 * i), error);
        if (!status && !seen)
            status = put(scene, parts[2], at, 0.0, 0.0, error);
    }
    return status;
}

static pm_status add_furniture(int desks, pm__scene *scene, pm_error *error)
{
    static pm_status (*const fill[3])(pm__scene *part, pm_error *error) = {fill_desk, fill_chair, fill_things};
    const int kinds = desks > 1 ? 3 : 2; /* the only desk is the seen one: nothing would be placed of the third */
    pm__scene *parts[3];
    pm_status status = PM_OK;
    for (int i = 0; i < kinds && !status; i++) {
        status = pm__scene_part(scene, &parts[i], error);
        if (!status)
            status = fill[i](parts[i], error);
    }
    return status ? status : add_desks(desks, parts, scene, error);
}

/* ---- The seen desk ---------------------------------------------------------------------------- */

static pm_status add_pad(const double at[2], pm__scene *scene, pm_error *error)
{
    const double thick = 0.003;
    const pm__material glossy = {.kind = PM__GLOSSY, .diffuse = {0.05, 0.08, 0.12}, .specular = {0.7, 0.7, 0.7},
                                 .roughness = 0.005};
    const pm__brick pad = {.centre = {at[0], at[1] - 0.08, desk_top + gap + thick}, .half = {0.34, 0.22, thick}};
    uint32_t material;
    const pm_status status = pm__scene_material(scene, &glossy, &material, error);
    return status ? status : pm__room_bricks(scene, material, &pad, 1, error);
}

/* A frame that leans back, and before it its picture. */
static pm_status add_photo(const double at[3], double turn, const double colour[3], pm__scene *scene, pm_error *error)
{
    static const double dark[3] = {0.2, 0.13, 0.08};
    const double lean = 0.3, frame[3] = {0.1, 0.008, 0.13}, picture[3] = {0.082, 0.001, 0.112};
    const double z = at[2] + frame[2] * cos(lean) + frame[1] * sin(lean), before = frame[1] + picture[1] + gap;
    const double back = before * cos(lean), up = before * sin(lean);
    const pm__brick bricks[2] = {
        {.centre = {at[0], at[1], z}, .half = {frame[0], frame[1], frame[2]}, .lean = lean, .turn = turn},
        {.centre = {at[0] + back * sin(turn), at[1] - back * cos(turn), z + up},
         .half = {picture[0], picture[1], picture[2]}, .lean = lean, .turn = turn},
    };
    const pm_status status = add_boxes(scene, dark, &bricks[0], 1, error);
    return status ? status : add_boxes(scene, colour, &bricks[1], 1, error);
}

static pm_status add_photos(const double desk[2], pm__scene *scene, pm_error *error)
{
    static const struct {
        double x, y, turn, colour[3];
    } photos[] = {
        {-0.27, 0.2, 0.35, {0.7, 0.3, 0.2}},
        {0.0, 0.25, 0.0, {0.75, 0.7, 0.5}},
        {0.27, 0.2, -0.35, {0.2, 0.4, 0.7}},
    };
    pm_status status = PM_OK;
    for (size_t i = 0; i < sizeof photos / sizeof *photos && !status; i++) {
        const double at[3] = {desk[0] + photos[i].x, desk[1] + photos[i].y, desk_top + gap};
        status = add_photo(at, photos[i].turn, photos[i].colour, scene, error);
    }
    return status;
}

/* ---- The scene -------------------------------------------------------------------------------- */

/* Above each column of desks, one to two rows. */
static pm_status add_lamps(int desks, pm__scene *scene, pm_error *error)
{
    static const double watts[3] = {100, 95, 85};
    const int rows = (desks + 1) / 2;
    pm_status status = PM_OK;
    for (int i = 0; i < desks * rows && !status; i++) {
        double at[2];
        desk_at(desks, i % desks, 0, at);
        const double y = half_width(desks, 1) * ((2.0 * (i / desks) + 1.0) / rows - 1.0);
        const double centre[3] = {at[0], y, height - 1e-3};
        status = pm__room_lamp(scene, centre, 0.3, watts, error);
    }
    return status;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const int desks = (int)values[DESKS];
    const double a = values[ALBEDO];
    const pm__room room = {.half = {half_width(desks, 0), half_width(desks, 1)}, .height = height,
                           .white = {a, a, a}, .left = {a, 0.8 * a, 0.6 * a}, .right = {0.6 * a, 0.8 * a, a}};
    double desk[2];
    seen_desk(desks, desk);
    pm_status status = pm__room_walls(scene, &room, error);
    if (!status)
        status = add_furniture(desks, scene, error);
    if (!status)
        status = add_pad(desk, scene, error);
    if (!status)
        status = add_photos(desk, scene, error);
    return status ? status : add_lamps(desks, scene, error);
}

static void view(const double *values, pm__view *from)
{
    double desk[2];
    seen_desk((int)values[DESKS], desk);
    *from = (pm__view){.eye = {desk[0] + 0.12, desk[1] - 0.72, 1.25}, .at = {desk[0], desk[1] + 0.12, 0.8},
                       .up = {0, 0, 1}, .angle = 0.85};
}

const pm__case pm__case_scene_office = {
    .entry = {.name = "scene:office",
              .summary = "office of many desks, of which one is seen: a glossy pad and photos on stands",
              .citation = "course 43, Fig. 3.10",
              .params = params,
              .param_count = 2},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
