/* A closed room with a large glass egg on its floor, lit by two balls high up behind it: their light comes through the
 * egg to two caustics before it, which the camera sees. The balls are as wide as leaves the caustics narrow, and lets
 * paths from the camera find the light; they are out of the picture.
 *
 * The egg is a mesh of 65000 triangles about an upright axis: radius and height over the angle t from the bottom,
 *     r = a sin t (1 + k cos t),   z = -b cos t,
 * an ellipse that k makes wider below. Light that falls at 50 degrees has its focus about where it meets the floor. */
#include "room.h"

#include "../../src/scene/revolve.h"

enum { ALBEDO, IOR, BALL };

enum { TURNS = 256, FACETS = 128 };

static const double pi = 3.14159265358979323846;

static const double half[2] = {1.8, 1.8}, height = 2.7, above_floor = 1e-4;      /* m */
static const double wide = 0.32, high = 0.42, blunt = 0.12, middle[2] = {0, 0.15}; /* a, b, m; k; m: of the egg */

static const struct {
    double at[3], watts[3]; /* m; W */
} balls[] = {
    {{-1.25, 1.0, 2.2}, {84, 70, 52}},
    {{1.3, 0.8, 2.3}, {44, 54, 68}},
};

static const pm__param params[] = {
    {.name = "albedo", .type = PM__REAL, .value = 0.6, .min = 0.0, .max = 0.99, .unit = "", .help = "of the walls"},
    {.name = "ior", .type = PM__REAL, .value = 1.5, .min = 1.0, .max = 3.0, .unit = "",
     .help = "index of refraction of the egg"},
    {.name = "ball", .type = PM__REAL, .value = 0.12, .min = 0.01, .max = 0.3, .unit = "m",
     .help = "radius of the two lights; their power stays as it is"},
};

static pm_status make_egg(pm__mesh *mesh, pm_error *error)
{
    double profile[FACETS + 1][2];
    for (int i = 0; i <= FACETS; i++) {
        const double angle = pi * i / FACETS;
        profile[i][0] = i % FACETS ? wide * sin(angle) * (1.0 + blunt * cos(angle)) : 0.0;
        profile[i][1] = above_floor + high * (1.0 - cos(angle));
    }
    const pm_status status = pm__revolve((const double(*)[2])profile, FACETS + 1, TURNS, mesh, error);
    for (size_t i = 0; i < mesh->vertex_count; i++)
        for (int a = 0; a < 2; a++)
            mesh->vertices[i][a] += (float)middle[a];
    return status;
}

static pm_status add_egg(const double *values, pm__scene *scene, pm_error *error)
{
    uint32_t glass;
    pm__mesh mesh;
    pm_status status = pm__glass_material(scene, values[IOR], &glass, error);
    if (!status)
        status = make_egg(&mesh, error);
    if (status)
        return status;
    status = pm__scene_mesh(scene, glass, (const float(*)[3])mesh.vertices, mesh.vertex_count,
                            (const uint32_t(*)[3])mesh.triangles, mesh.triangle_count, error);
    pm__mesh_free(&mesh);
    return status;
}

static pm_status add_balls(const double *values, pm__scene *scene, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; i < sizeof balls / sizeof *balls && !status; i++) {
        const double *const at = balls[i].at, *const watts = balls[i].watts;
        const pm__light light = {.kind = PM__BALL, .power = {watts[0], watts[1], watts[2]},
                                 .position = {at[0], at[1], at[2]}, .radius = values[BALL]};
        status = pm__scene_light(scene, &light, error);
    }
    return status;
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const double a = values[ALBEDO];
    const pm__room room = {.half = {half[0], half[1]}, .height = height, .white = {a, a, a},
                           .left = {a, 0.6 * a, 0.4 * a}, .right = {0.4 * a, 0.6 * a, a}};
    pm_status status = pm__room_walls(scene, &room, error);
    if (!status)
        status = add_egg(values, scene, error);
    return status ? status : add_balls(values, scene, error);
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0, -1.75, 1.35}, .at = {0, 0, 0.25}, .up = {0, 0, 1}, .angle = 0.75};
}

const pm__case pm__case_scene_egg = {
    .entry = {.name = "scene:egg",
              .summary = "closed room with a large glass egg, lit by two balls",
              .citation = "course 43, Fig. 3.6",
              .params = params,
              .param_count = 3},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
