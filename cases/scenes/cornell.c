/* The Cornell box of the course: a mirror sphere on the left and a glass sphere on the right, a square lamp in the
 * ceiling. Open in front, where the camera stands; what goes out there is lost. The lamp is large enough for paths that
 * start at the camera to find it through the glass. */
#include "room.h"

enum { ALBEDO, IOR, MOVED };

static const pm__param params[] = {
    {.name = "albedo", .type = PM__REAL, .value = 0.75, .min = 0.0, .max = 0.99, .unit = "",
     .help = "of the white walls; the red and the blue one have it in one band, a fifth of it in the others"},
    {.name = "ior", .type = PM__REAL, .value = 1.5, .min = 1.0, .max = 3.0, .unit = "",
     .help = "index of refraction of the glass sphere"},
    {.name = "moved", .type = PM__REAL, .value = 0.0, .min = -0.15, .max = 0.3, .unit = "m",
     .help = "the glass sphere is moved so far toward the back"},
};

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__room room = pm__cornell_room(values[ALBEDO]);
    pm_status status = pm__room_walls(scene, &room, error);
    if (!status)
        status = pm__cornell_spheres(scene, values[IOR], values[MOVED], error);
    return status ? status : pm__cornell_lamp(scene, 0.15, 10.0, error);
}

const pm__case pm__case_scene_cornell = {
    .entry = {.name = "scene:cornell",
              .summary = "Cornell box with a mirror and a glass sphere",
              .citation = "course 43, Fig. 2.16 to 2.22",
              .params = params,
              .param_count = 3},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = pm__cornell_view,
};
