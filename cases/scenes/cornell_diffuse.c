/* The Cornell box with a tall and a short white block, turned as in the original box (Goral et al. 1984; Cohen and
 * Greenberg 1985): nothing specular. Open in front. */
#include "room.h"

enum { ALBEDO };

static const double pi = 3.14159265358979323846;

static const pm__param params[] = {
    {.name = "albedo", .type = PM__REAL, .value = 0.75, .min = 0.0, .max = 0.99, .unit = "",
     .help = "of the blocks and the white walls; the red and the blue one have it in one band, a fifth in the others"},
};

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__room room = pm__cornell_room(values[ALBEDO]);
    const double tall[2] = {-0.17, 0.14}, low[2] = {0.17, -0.2}, turn = 17.0 * pi / 180.0;
    uint32_t white;
    pm_status status = pm__room_walls(scene, &room, error);
    if (!status)
        status = pm__diffuse_material(scene, room.white, &white, error);
    if (!status)
        status = pm__room_block(scene, white, tall, 0.15, 0.6, turn, error);
    if (!status)
        status = pm__room_block(scene, white, low, 0.15, 0.3, -turn, error);
    return status ? status : pm__cornell_lamp(scene, 0.15, 10.0, error);
}

const pm__case pm__case_scene_cornell_diffuse = {
    .entry = {.name = "scene:cornell-diffuse",
              .summary = "Cornell box with two blocks, all Lambertian",
              .citation = "Cohen and Greenberg 1985",
              .params = params,
              .param_count = 1},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = pm__cornell_view,
};
