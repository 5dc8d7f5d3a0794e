/* A glass of cognac: a surface of revolution of the size of a real glass, on a rough, glossy floor. A ball lamp behind
 * it throws the caustic toward the camera; a large dim square above keeps the shadow from being black. The ball is as
 * large as still gives a caustic, so that paths from the camera find it through the glass.
 *
 * Three surfaces without a gap, of one polygon turned about the axis, bound the glass (index 1.5) and the cognac:
 *     glass and air       foot, stem, the bowl's outside, its rim and its inside down to the cognac,
 *     glass and cognac    the rest of the inside; its normal points into the cognac, and its index is relative,
 *     cognac and air      a disc.
 * The profile is a uniform cubic B-spline (continuous curvature: facets alone are seen in the caustic, no seams). */
#include "room.h"

#include "../../src/scene/revolve.h"

#include <string.h>

enum { DEPTH, STRENGTH, TURNS };

static const double of_glass = 1.5, of_cognac = 1.36;                   /* indices of refraction */
static const double glass_absorbs[3] = {3, 1, 2}, cognac_absorbs[3] = {6, 30, 110}; /* 1/m */

static const pm__param params[] = {
    {.name = "depth", .type = PM__REAL, .value = 0.036, .min = 0.01, .max = 0.06, .unit = "m",
     .help = "of the cognac; the bowl is 0.085 m deep"},
    {.name = "strength", .type = PM__REAL, .value = 1.0, .min = 0.0, .max = 5.0, .unit = "",
     .help = "factor on the cognac's absorption; 0: clear"},
    {.name = "turns", .type = PM__INTEGER, .value = 160.0, .min = 16.0, .max = 1024.0, .unit = "",
     .help = "vertices around the glass; 160 make about 46000 triangles"},
};

/* r, z in mm. The ends lie on the axis, each next to a point of its height: the surface is flat there. */
static const double control[][2] = {
    {0, 0.5}, {8, 0.5}, {20, 0.5}, {31, 0.5}, {34, 0.8}, {34.5, 1.8}, {32, 2.8},
    {20, 4.2}, {9, 6.5}, {5, 11}, {4, 18}, {3.8, 28}, {4.2, 38}, {6, 45},
    {12, 49}, {24, 54}, {35, 63}, {41.5, 76}, {42.5, 90}, {39, 106}, {33.5, 120},
    {30, 131}, {29, 134.5}, {28.4, 135.8}, {27.6, 135.8}, {27, 134.5}, {28, 131}, {31.5, 120},
    {37, 106}, {40.5, 90}, {39.6, 76.6}, {33.4, 64.5}, {22.8, 56.2}, {11.5, 51.9}, {5, 50.6},
    {0, 50.6},
};

enum { CONTROLS = sizeof control / sizeof *control, FIRST_INSIDE = 26, STEPS = 4,
       POINTS = (CONTROLS - 1) * STEPS + 1, INSIDE = FIRST_INSIDE * STEPS };

/* The polygon, in m. Where the cognac stands, `level` is a point of its own. */
typedef struct outline {
    double points[POINTS + 1][2];
    size_t count, level;
} outline;

/* Beyond an end the control points go on straight, so the curve ends in the last. */
static double control_at(int i, int axis)
{
    if (i < 0)
        return 2.0 * control[0][axis] - control[1][axis];
    if (i >= CONTROLS)
        return 2.0 * control[CONTROLS - 1][axis] - control[CONTROLS - 2][axis];
    return control[i][axis];
}

static void spline(int i, double t, double point[2])
{
    const double s = 1.0 - t;
    const double weights[4] = {s * s * s, 3.0 * t * t * t - 6.0 * t * t + 4.0,
                               3.0 * s * s * s - 6.0 * s * s + 4.0, t * t * t};
    for (int axis = 0; axis < 2; axis++) {
        point[axis] = 0.0;
        for (int j = 0; j < 4; j++)
            point[axis] += 1e-3 / 6.0 * weights[j] * control_at(i - 1 + j, axis);
    }
}

/* Puts the level in: on the chord of the inside that it cuts, unless a point is as near as to make slivers. */
static void cut(outline *glass, double height)
{
    const double nearest = 1e-6;
    size_t i = INSIDE; /* falling from here on */
    while (glass->points[i + 1][1] > height)
        i++;
    const double *const above = glass->points[i], *const below = glass->points[i + 1];
    const double part = (above[1] - height) / (above[1] - below[1]);
    glass->level = above[1] - height < nearest ? i : i + 1;
    if (above[1] - height < nearest || height - below[1] < nearest)
        return;
    const double at[2] = {above[0] + part * (below[0] - above[0]), height};
    memmove(glass->points[i + 2], glass->points[i + 1], (glass->count - i - 1) * sizeof *glass->points);
    memcpy(glass->points[i + 1], at, sizeof at);
    glass->count++;
}

static void draw(const double *values, outline *glass)
{
    for (int i = 0; i + 1 < CONTROLS; i++)
        for (int j = 0; j < STEPS; j++)
            spline(i, (double)j / STEPS, glass->points[i * STEPS + j]);
    spline(CONTROLS - 2, 1.0, glass->points[POINTS - 1]);
    glass->points[0][0] = glass->points[POINTS - 1][0] = 0.0; /* not by rounding alone */
    glass->count = POINTS;
    cut(glass, glass->points[POINTS - 1][1] + values[DEPTH]);
}

/* ---- Building ---- */

static void copy(const double from[3], double to[3])
{
    memcpy(to, from, 3 * sizeof *to);
}

static pm_status add_surface(const double (*points)[2], size_t count, size_t turns, const pm__material *material,
                             pm__scene *scene, pm_error *error)
{
    uint32_t index;
    pm__mesh mesh;
    pm_status status = pm__scene_material(scene, material, &index, error);
    if (!status)
        status = pm__revolve(points, count, turns, &mesh, error);
    if (status)
        return status;
    status = pm__scene_mesh(scene, index, (const float(*)[3])mesh.vertices, mesh.vertex_count,
                            (const uint32_t(*)[3])mesh.triangles, mesh.triangle_count, error);
    pm__mesh_free(&mesh);
    return status;
}

static pm_status add_glass(const double *values, pm__scene *scene, pm_error *error)
{
    const double relative = of_glass / of_cognac, s = values[STRENGTH];
    const double liquid[3] = {s * cognac_absorbs[0], s * cognac_absorbs[1], s * cognac_absorbs[2]};
    const size_t turns = (size_t)values[TURNS];
    pm__material wall = {.kind = PM__GLASS, .ior = {of_glass, of_glass, of_glass}}, wet = wall, top = wall;
    for (int b = 0; b < 3; b++) {
        wet.ior[b] = relative;
        top.ior[b] = of_cognac;
    }
    copy(glass_absorbs, wall.absorption);
    copy(glass_absorbs, wet.absorption);
    copy(liquid, wet.outside);
    copy(liquid, top.absorption);
    outline glass;
    draw(values, &glass);
    const double(*const points)[2] = (const double(*)[2])glass.points, (*const level)[2] = points + glass.level;
    const double disc[2][2] = {{(*level)[0], (*level)[1]}, {0.0, (*level)[1]}};
    pm_status status = add_surface(points, glass.level + 1, turns, &wall, scene, error);
    if (!status)
        status = add_surface(level, glass.count - glass.level, turns, &wet, scene, error);
    return status ? status : add_surface(disc, 2, turns, &top, scene, error);
}

/* Schlick's factor of 0.6 as the papers have it for sand ([J96a]). */
static pm_status add_floor(pm__scene *scene, pm_error *error)
{
    const pm__material sand = {.kind = PM__GLOSSY, .diffuse = {0.55, 0.5, 0.42}, .specular = {0.2, 0.2, 0.2},
                               .roughness = 0.6};
    const double corner[3] = {-2, -2, 0}, u[3] = {4, 0, 0}, v[3] = {0, 4, 0};
    uint32_t material;
    const pm_status status = pm__scene_material(scene, &sand, &material, error);
    return status ? status : pm__scene_rectangle(scene, material, corner, u, v, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    const pm__light ball = {.kind = PM__BALL, .power = {16, 15, 14}, .position = {-0.2, 0.24, 0.34}, .radius = 0.025};
    const double above[3] = {0, 0, 1.5}, dim[3] = {4, 4.4, 5};
    pm_status status = add_floor(scene, error);
    if (!status)
        status = add_glass(values, scene, error);
    if (!status)
        status = pm__scene_light(scene, &ball, error);
    return status ? status : pm__room_lamp(scene, above, 0.5, dim, error);
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0.05, -0.42, 0.24}, .at = {0.02, -0.01, 0.055}, .up = {0, 0, 1}, .angle = 0.5};
}

const pm__case pm__case_scene_cognac = {
    .entry = {.name = "scene:cognac",
              .summary = "glass of cognac, a surface of revolution, on a rough floor",
              .citation = "course 43, Fig. 2.27; Jensen 1996",
              .params = params,
              .param_count = 3},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
