/* A Cornell box with two Cornell boxes in it where its blocks would stand, each with two in it, and so on; in the
 * smallest stand a mirror and a glass sphere. One box and one pair of spheres are placed as often as they are wanted.
 * The smaller boxes have no lamps: light falls in through a hole in the ceiling, where the lamp would be, and by the
 * open front. All stand on the one floor; walls are thin and of one colour on both sides. */
#include "room.h"

enum { DEPTH };

static const double pi = 3.14159265358979323846;

static const pm__param params[] = {
    {.name = "depth", .type = PM__INTEGER, .value = 3.0, .min = 0.0, .max = 4.0, .unit = "",
     .help = "boxes within boxes; 0: the plain box with its spheres"},
};

/* Turned about z, scaled, moved on the floor. */
typedef struct place {
    double turn, scale, x, y;
} place;

/* Within the box that they stand in; its unit is 1 m. The turned squares of 0.4 m stay clear of each other and of the
 * walls. */
static const place children[2] = {{17.0, 0.4, -0.22, 0.17}, {-17.0, 0.4, 0.22, -0.17}};

static place within(const place *outer, const place *inner)
{
    const double c = outer->scale * cos(outer->turn), s = outer->scale * sin(outer->turn);
    return (place){.turn = outer->turn + inner->turn * pi / 180.0,
                   .scale = outer->scale * inner->scale,
                   .x = outer->x + c * inner->x - s * inner->y,
                   .y = outer->y + s * inner->x + c * inner->y};
}

static pm_status put(pm__scene *scene, pm__scene *part, const place *at, pm_error *error)
{
    const double c = cos(at->turn), s = sin(at->turn);
    const pm__placement placement = {
        .rotation = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}}, .scale = at->scale, .offset = {at->x, at->y, 0}};
    return pm__scene_place(scene, part, &placement, error);
}

/* What stands in the box at `at`, with `depth` sizes of boxes to come. */
static pm_status fill(pm__scene *scene, pm__scene *box, pm__scene *spheres, const place *at, int depth, pm_error *error)
{
    if (depth == 0)
        return put(scene, spheres, at, error);
    pm_status status = PM_OK;
    for (int i = 0; i < 2 && !status; i++) {
        const place inner = within(at, &children[i]);
        status = put(scene, box, &inner, error);
        if (!status)
            status = fill(scene, box, spheres, &inner, depth - 1, error);
    }
    return status;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__room outer = pm__cornell_room(0.75);
    const place all = {.scale = 1.0};
    pm__room inner = outer;
    pm__scene *box, *spheres;
    inner.skylight = 0.25;
    inner.no_floor = true;
    pm_status status = pm__room_walls(scene, &outer, error);
    if (!status)
        status = pm__scene_part(scene, &box, error);
    if (!status)
        status = pm__room_walls(box, &inner, error);
    if (!status)
        status = pm__scene_part(scene, &spheres, error);
    if (!status)
        status = pm__cornell_spheres(spheres, 1.5, 0.0, error);
    if (!status)
        status = fill(scene, box, spheres, &all, (int)values[DEPTH], error);
    return status ? status : pm__cornell_lamp(scene, 0.15, 12.0, error);
}

const pm__case pm__case_scene_fractal_cornell = {
    .entry = {.name = "scene:fractal-cornell",
              .summary = "Cornell boxes within a Cornell box, by instances",
              .citation = "after course 43, Fig. 2.24",
              .params = params,
              .param_count = 1},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = pm__cornell_view,
};
