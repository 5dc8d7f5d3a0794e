/* A closed room under four square lamps of different colour and power, the camera inside: many lights, some of which a
 * surface hardly sees; and nothing that is lost but to the walls. */
#include "room.h"

enum { ALBEDO };

static const double half[2] = {1.0, 1.25}, height = 1.25, above_floor = 1e-4; /* m */

static const pm__param params[] = {
    {.name = "albedo", .type = PM__REAL, .value = 0.6, .min = 0.0, .max = 0.99, .unit = "",
     .help = "of the walls and the block"},
};

/* The brightest sends eleven times what the dimmest does. */
static const struct {
    double x, y, half, power[3]; /* m; W */
} lamps[] = {
    {-0.5, -0.4, 0.1, {32, 16, 8}},
    {0.5, -0.4, 0.1, {4, 8, 16}},
    {-0.5, 0.6, 0.15, {2, 8, 4}},
    {0.5, 0.6, 0.05, {2, 1, 2}},
};

static pm_status add_lamps(pm__scene *scene, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps && !status; i++) {
        const double centre[3] = {lamps[i].x, lamps[i].y, height - 0.01};
        status = pm__room_lamp(scene, centre, lamps[i].half, lamps[i].power, error);
    }
    return status;
}

static pm_status add_things(const pm__room *room, pm__scene *scene, pm_error *error)
{
    const double block[2] = {-0.45, 0.55}, mirror[3] = {0.35, 0.5, 0.25 + above_floor};
    const double glass[3] = {0.1, -0.15, 0.2 + above_floor};
    uint32_t material;
    pm_status status = pm__diffuse_material(scene, room->white, &material, error);
    if (!status)
        status = pm__room_block(scene, material, block, 0.2, 0.55, 0.4, error);
    if (!status)
        status = pm__mirror_material(scene, &material, error);
    if (!status)
        status = pm__scene_sphere(scene, material, mirror, 0.25, false, error);
    if (!status)
        status = pm__glass_material(scene, 1.5, &material, error);
    return status ? status : pm__scene_sphere(scene, material, glass, 0.2, false, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double a = values[ALBEDO];
    const pm__room room = {.half = {half[0], half[1]}, .height = height, .white = {a, a, a}, .left = {a, a, a},
                           .right = {a, a, a}};
    pm_status status = pm__room_walls(scene, &room, error);
    if (!status)
        status = add_things(&room, scene, error);
    return status ? status : add_lamps(scene, error);
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0, -1.2, 0.8}, .at = {0, 0.3, 0.35}, .up = {0, 0, 1}, .angle = 1.0};
}

const pm__case pm__case_scene_four_lights = {
    .entry = {.name = "scene:four-lights",
              .summary = "closed room under four square lamps of different colour and power",
              .citation = "course 43, Fig. 2.25",
              .params = params,
              .param_count = 1},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
