/* A closed room lit by one small ball within a bulb of glass: whatever is lit is lit through glass, so shadow rays find
 * nothing, and what is seen in the mirror on the back wall is lit through glass and seen by the mirror. The bulb hangs
 * above what is seen, in the mirror too: a shining ball in the image would outweigh all the rest of it.
 *
 * The bulb is one glass between two spheres about the same middle; the inner one's normals point inward, out of the
 * glass. */
#include "room.h"

enum { ALBEDO, IOR, GLASS };

static const double half[2] = {0.8, 0.9}, height = 1.4, gap = 1e-3;         /* m */
static const double at[3] = {-0.1, 0, 1.15}, bulb = 0.15, ball = 0.06;      /* m; radii */
static const double watts[3] = {36, 31, 24};

static const pm__param params[] = {
    {.name = "albedo", .type = PM__REAL, .value = 0.6, .min = 0.0, .max = 0.99, .unit = "",
     .help = "of the walls and the block"},
    {.name = "ior", .type = PM__REAL, .value = 1.5, .min = 1.0, .max = 3.0, .unit = "",
     .help = "index of refraction of the bulb"},
    {.name = "glass", .type = PM__REAL, .value = 0.03, .min = 0.001, .max = 0.08, .unit = "m",
     .help = "thickness of the bulb's glass; the bulb is 0.3 m wide, the ball in it 0.12 m"},
};

static pm_status add_block(const pm__room *room, pm__scene *scene, pm_error *error)
{
    const double centre[2] = {-0.38, 0.4};
    uint32_t white;
    const pm_status status = pm__diffuse_material(scene, room->white, &white, error);
    return status ? status : pm__room_block(scene, white, centre, 0.15, 0.5, 0.4, error);
}

static pm_status add_mirror(pm__scene *scene, pm_error *error)
{
    const double corner[3] = {-0.1, half[1] - gap, 0.2}, u[3] = {0.75, 0, 0}, v[3] = {0, 0, 0.55};
    uint32_t mirror;
    const pm_status status = pm__mirror_material(scene, &mirror, error);
    return status ? status : pm__scene_rectangle(scene, mirror, corner, u, v, error);
}

static pm_status add_bulb(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__light light = {.kind = PM__BALL, .power = {watts[0], watts[1], watts[2]},
                             .position = {at[0], at[1], at[2]}, .radius = ball};
    uint32_t glass;
    pm_status status = pm__glass_material(scene, values[IOR], &glass, error);
    if (!status)
        status = pm__scene_sphere(scene, glass, at, bulb, false, error);
    if (!status)
        status = pm__scene_sphere(scene, glass, at, bulb - values[GLASS], true, error);
    return status ? status : pm__scene_light(scene, &light, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double a = values[ALBEDO];
    const pm__room room = {.half = {half[0], half[1]}, .height = height, .white = {a, a, a},
                           .left = {a, 0.4 * a, 0.3 * a}, .right = {0.3 * a, 0.5 * a, a}};
    pm_status status = pm__room_walls(scene, &room, error);
    if (!status)
        status = add_block(&room, scene, error);
    if (!status)
        status = add_mirror(scene, error);
    return status ? status : add_bulb(values, scene, error);
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0.1, -0.85, 0.55}, .at = {0, 0.9, 0.4}, .up = {0, 0, 1}, .angle = 0.9};
}

const pm__case pm__case_scene_lamp = {
    .entry = {.name = "scene:lamp",
              .summary = "closed room with a mirror, lit by a ball within a glass bulb",
              .citation = "Hachisuka, Ogaki and Jensen 2008",
              .params = params,
              .param_count = 3},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
