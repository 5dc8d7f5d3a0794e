/* A wide round floor in the sun, and above its middle a small glass ball; the camera sees the ball and its caustic, and
 * of the floor no more than a few metres. All else of the light is lost on the floor's rest.
 *
 * The ball hangs as far above the floor as its focus lies behind it, so that the caustic is narrow and not below the
 * ball. The sun is wide enough for paths from the camera to find it through the ball. Its window stands `away` from the
 * floor's middle, beyond where its rim would reach the floor, and is as large as leaves no point of the floor without
 * any part of the sun. The window's power follows from the irradiance across the light, which parameters do not
 * change. */
#include "room.h"

enum { RADIUS, IOR, SUN };

static const double pi = 3.14159265358979323846;

static const double ball = 0.4, at[3] = {0, 0, 0.6};                      /* m */
static const double down[3] = {4.0 / 13.0, -3.0 / 13.0, -12.0 / 13.0};    /* unit */
static const double irradiance = 6.0;                                    /* W/m2 */

static const pm__param params[] = {
    {.name = "radius", .type = PM__REAL, .value = 20.0, .min = 5.0, .max = 200.0, .unit = "m",
     .help = "of the floor; the ball's is 0.4 m"},
    {.name = "ior", .type = PM__REAL, .value = 1.5, .min = 1.0, .max = 3.0, .unit = "",
     .help = "index of refraction of the ball"},
    {.name = "sun", .type = PM__REAL, .value = 10.0, .min = 0.1, .max = 20.0, .unit = "deg",
     .help = "apparent diameter of the sun; irradiance stays as it is"},
};

static pm_status add_floor(const double *values, pm__scene *scene, pm_error *error)
{
    static const double grey[3] = {0.55, 0.5, 0.45}, centre[3] = {0, 0, 0}, up[3] = {0, 0, 1};
    uint32_t material;
    const pm_status status = pm__diffuse_material(scene, grey, &material, error);
    return status ? status : pm__scene_disc(scene, material, centre, up, values[RADIUS], error);
}

static pm_status add_ball(const double *values, pm__scene *scene, pm_error *error)
{
    uint32_t glass;
    const pm_status status = pm__glass_material(scene, values[IOR], &glass, error);
    return status ? status : pm__scene_sphere(scene, glass, at, ball, false, error);
}

/* The rim's lowest point is at away * 12/13 - radius * 5/13: with the widest sun still above the ball. */
static pm_status add_sun(const double *values, pm__scene *scene, pm_error *error)
{
    const double away = 0.75 * values[RADIUS];
    pm__light sun = {.kind = PM__SUN, .angle = 0.5 * values[SUN] * pi / 180.0};
    sun.radius = values[RADIUS] + 2.0 * away * tan(sun.angle);
    for (int i = 0; i < 3; i++) {
        sun.power[i] = irradiance * pi * sun.radius * sun.radius;
        sun.direction[i] = down[i];
        sun.position[i] = -away * down[i];
    }
    return pm__scene_light(scene, &sun, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    pm_status status = add_floor(values, scene, error);
    if (!status)
        status = add_ball(values, scene, error);
    return status ? status : add_sun(values, scene, error);
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0.1, -2.8, 2.1}, .at = {0.1, 0, 0.25}, .up = {0, 0, 1}, .angle = 0.6};
}

const pm__case pm__case_scene_wide_floor = {
    .entry = {.name = "scene:wide-floor",
              .summary = "wide floor in the sun, with the caustic of a small glass ball",
              .citation = "after course 43, 5.7",
              .params = params,
              .param_count = 3},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
