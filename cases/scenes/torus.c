/* A diffuse torus within a solid cube of glass that stands on a diffuse floor, in the sun: the torus gets no light but
 * through glass and is seen through glass alone, by paths that shadow rays do not find and of which tracing from the
 * camera finds few, since the sun is small.
 *
 * The sun's window stands `away` from the floor's middle and is as large as leaves no point of the floor, and of what
 * stands on it, without any part of the sun: radius of the floor and what the cone gains on the way. The window's
 * power follows from the irradiance across the light, which the parameters leave as it is. */
#include "room.h"

#include "../../src/scene/revolve.h"

enum { IOR, SUN };

enum { TURNS = 192, FACETS = 96 };

static const double pi = 3.14159265358979323846;

static const double half = 0.5, above_floor = 1e-4;                  /* m: of the cube */
static const double ring = 0.28, tube = 0.1, lean = 0.9, turn = 0.5; /* m: of the torus; radian */
static const double middle[3] = {0, 0.75, 0}, floor_half[2] = {1.75, 1.75}, floor_radius = 2.5; /* m */
static const double down[3] = {0.48, 0.36, -0.8}, away = 4.0, irradiance = 6.0;                 /* unit; m; W/m2 */

static const pm__param params[] = {
    {.name = "ior", .type = PM__REAL, .value = 1.5, .min = 1.0, .max = 3.0, .unit = "",
     .help = "index of refraction of the cube"},
    {.name = "sun", .type = PM__REAL, .value = 5.0, .min = 0.1, .max = 20.0, .unit = "deg",
     .help = "apparent diameter of the sun; irradiance stays as it is"},
};

/* Leans to the back, then is turned about the upright. */
static void place(float vertex[3])
{
    const double x = (double)vertex[0], y = (double)vertex[1], z = (double)vertex[2];
    const double back = cos(lean) * y - sin(lean) * z;
    vertex[0] = (float)(cos(turn) * x - sin(turn) * back);
    vertex[1] = (float)(sin(turn) * x + cos(turn) * back);
    vertex[2] = (float)(half + above_floor + sin(lean) * y + cos(lean) * z);
}

/* The profile goes once around the tube, outward where it climbs; its two ends are the same ring. */
static pm_status make_torus(pm__mesh *mesh, pm_error *error)
{
    double profile[FACETS + 1][2];
    for (int i = 0; i <= FACETS; i++) {
        const double angle = 2.0 * pi * (i % FACETS) / FACETS;
        profile[i][0] = ring + tube * cos(angle);
        profile[i][1] = tube * sin(angle);
    }
    const pm_status status = pm__revolve((const double(*)[2])profile, FACETS + 1, TURNS, mesh, error);
    for (size_t i = 0; i < mesh->vertex_count; i++)
        place(mesh->vertices[i]);
    return status;
}

static pm_status add_torus(pm__scene *scene, pm_error *error)
{
    static const double ochre[3] = {0.75, 0.55, 0.2};
    uint32_t material;
    pm__mesh mesh;
    pm_status status = pm__diffuse_material(scene, ochre, &material, error);
    if (!status)
        status = make_torus(&mesh, error);
    if (status)
        return status;
    status = pm__scene_mesh(scene, material, (const float(*)[3])mesh.vertices, mesh.vertex_count,
                            (const uint32_t(*)[3])mesh.triangles, mesh.triangle_count, error);
    pm__mesh_free(&mesh);
    return status;
}

/* Its faces, by axis and side. */
static pm_status add_cube(const double *values, pm__scene *scene, pm_error *error)
{
    uint32_t glass;
    pm_status status = pm__glass_material(scene, values[IOR], &glass, error);
    for (int face = 0; face < 6 && !status; face++) {
        const int axis = face / 2, first = (axis + 1 + face % 2) % 3, second = 3 - axis - first;
        double corner[3] = {-half, -half, above_floor}, u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
        corner[axis] += face % 2 ? 0.0 : 2.0 * half;
        u[first] = v[second] = 2.0 * half; /* u x v outward: along the axis on its far side, else against it */
        status = pm__scene_rectangle(scene, glass, corner, u, v, error);
    }
    return status;
}

static pm_status add_floor(pm__scene *scene, pm_error *error)
{
    static const double grey[3] = {0.5, 0.5, 0.5};
    const double corner[3] = {middle[0] - floor_half[0], middle[1] - floor_half[1], 0};
    const double u[3] = {2.0 * floor_half[0], 0, 0}, v[3] = {0, 2.0 * floor_half[1], 0};
    uint32_t material;
    const pm_status status = pm__diffuse_material(scene, grey, &material, error);
    return status ? status : pm__scene_rectangle(scene, material, corner, u, v, error);
}

static pm_status add_sun(const double *values, pm__scene *scene, pm_error *error)
{
    pm__light sun = {.kind = PM__SUN, .angle = 0.5 * values[SUN] * pi / 180.0};
    sun.radius = floor_radius + 2.0 * away * tan(sun.angle);
    for (int i = 0; i < 3; i++) {
        sun.power[i] = irradiance * pi * sun.radius * sun.radius;
        sun.direction[i] = down[i];
        sun.position[i] = middle[i] - away * down[i];
    }
    return pm__scene_light(scene, &sun, error);
}

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    pm_status status = add_floor(scene, error);
    if (!status)
        status = add_cube(values, scene, error);
    if (!status)
        status = add_torus(scene, error);
    return status ? status : add_sun(values, scene, error);
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0, -2.4, 3}, .at = {0, 0.05, 0.4}, .up = {0, 0, 1}, .angle = 0.5};
}

const pm__case pm__case_scene_torus = {
    .entry = {.name = "scene:torus",
              .summary = "diffuse torus in a glass cube on a floor, in the sun",
              .citation = "Hachisuka, Ogaki and Jensen 2008",
              .params = params,
              .param_count = 2},
    .dimensions = 2,
    .sample_dimensions = 4,
    .strata_dimensions = 2,
    .build = build,
    .view = view,
};
