#include "plain_scene.h"

#include "../src/base/memory.h"
#include "../src/scene/rays.h"

#include <stdlib.h>
#include <string.h>

enum { STRIPS = 64 };

/* ---- Shapes as strips of quadrangles, two triangles each ---------------------------------------- */

typedef struct strips {
    float vertices[2 * (STRIPS + 1)][3];
    uint32_t count; /* of quadrangles */
} strips;

/* The next two corners. */
static void add_rung(strips *s, uint32_t index, const double a[3], const double b[3])
{
    for (int axis = 0; axis < 3; axis++) {
        s->vertices[2 * index][axis] = (float)a[axis];
        s->vertices[2 * index + 1][axis] = (float)b[axis];
    }
}

static void flat_strip(const double corner[3], const double u[3], const double v[3], strips *s)
{
    s->count = 1;
    for (uint32_t i = 0; i < 2; i++) {
        double a[3], b[3];
        for (int axis = 0; axis < 3; axis++) {
            a[axis] = corner[axis] + (i ? v[axis] : 0.0);
            b[axis] = a[axis] + u[axis];
        }
        add_rung(s, i, a, b);
    }
}

static void disc_strip(const pm__shape *shape, strips *s)
{
    double u[3], v[3], corner[3];
    pm__basis(shape->normal, u, v);
    for (int axis = 0; axis < 3; axis++) {
        corner[axis] = shape->centre[axis] - shape->radius * (u[axis] + v[axis]);
        u[axis] *= 2.0 * shape->radius;
        v[axis] *= 2.0 * shape->radius;
    }
    flat_strip(corner, u, v, s);
}

static void cylinder_strips(const pm__shape *shape, strips *s)
{
    const double half = acos(shape->from);
    s->count = STRIPS;
    for (uint32_t i = 0; i <= STRIPS; i++) {
        const double turn = half * (2.0 * i / STRIPS - 1.0);
        const double x = shape->centre[0] + shape->radius * cos(turn), y = shape->centre[1] + shape->radius * sin(turn);
        add_rung(s, i, (double[3]){x, y, shape->low}, (double[3]){x, y, shape->high});
    }
}

static void wave_strips(const pm__shape *shape, strips *s)
{
    s->count = STRIPS;
    for (uint32_t i = 0; i <= STRIPS; i++) {
        const double x = shape->extent[0] * (2.0 * i / STRIPS - 1.0);
        const double z = shape->centre[2] + shape->amplitude * cos(shape->wavenumber * x);
        add_rung(s, i, (double[3]){x, -shape->extent[1], z}, (double[3]){x, shape->extent[1], z});
    }
}

static void shape_strips(const pm__shape *shape, strips *s)
{
    if (shape->kind == PM__SHAPE_RECTANGLE)
        flat_strip(shape->centre, shape->edge[0], shape->edge[1], s);
    else if (shape->kind == PM__SHAPE_DISC)
        disc_strip(shape, s);
    else if (shape->kind == PM__SHAPE_CYLINDER)
        cylinder_strips(shape, s);
    else
        wave_strips(shape, s);
}

/* ---- Embree's geometries ------------------------------------------------------------------------ */

static void attach(RTCScene scene, RTCGeometry geometry)
{
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

static bool fill(RTCGeometry geometry, enum RTCBufferType type, enum RTCFormat format, const void *data, size_t size,
                 size_t count)
{
    void *const buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, size, count);
    if (buffer)
        memcpy(buffer, data, size * count);
    return buffer;
}

static bool add_triangles(RTCDevice device, RTCScene scene, const float (*vertices)[3], size_t vertex_count,
                          const uint32_t (*triangles)[3], size_t triangle_count)
{
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const bool filled =
        fill(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, vertices, sizeof *vertices, vertex_count) &&
        fill(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangles, sizeof *triangles, triangle_count);
    attach(scene, geometry);
    return filled;
}

static bool add_sphere(RTCDevice device, RTCScene scene, const pm__shape *shape)
{
    const float sphere[4] = {(float)shape->centre[0], (float)shape->centre[1], (float)shape->centre[2],
                             (float)shape->radius};
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    const bool filled = fill(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sphere, sizeof sphere, 1);
    attach(scene, geometry);
    return filled;
}

static bool add_shape(RTCDevice device, RTCScene scene, const pm__shape *shape)
{
    if (shape->kind == PM__SHAPE_SPHERE)
        return add_sphere(device, scene, shape);
    strips s;
    uint32_t triangles[2 * STRIPS][3];
    shape_strips(shape, &s);
    for (uint32_t i = 0; i < s.count; i++)
        for (uint32_t j = 0; j < 3; j++) {
            triangles[2 * i][j] = 2 * i + j;
            triangles[2 * i + 1][j] = 2 * i + 3 - j;
        }
    return add_triangles(device, scene, (const float(*)[3])s.vertices, 2 * (s.count + 1),
                         (const uint32_t(*)[3])triangles, 2 * (size_t)s.count);
}

/* Columns, as Embree wants them. */
static void add_instance(RTCDevice device, RTCScene scene, RTCScene part, const pm__placement *placement)
{
    float matrix[12];
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++)
            matrix[3 * column + row] = (float)(placement->scale * placement->rotation[row][column]);
        matrix[9 + row] = (float)placement->offset[row];
    }
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, part);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
    attach(scene, geometry);
}

/* ---- Scenes ------------------------------------------------------------------------------------- */

static const RTCScene *find_part(const pm__plain_scene *plain, const pm__scene *whole, const pm__scene *part)
{
    for (size_t i = 0; i < plain->part_count; i++)
        if (whole->parts[i] == part)
            return &plain->parts[i];
    return NULL;
}

static bool fill_scene(const pm__plain_scene *plain, const pm__scene *whole, const pm__scene *from, RTCScene to)
{
    bool filled = true;
    rtcSetSceneFlags(to, plain->robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    for (size_t i = 0; i < from->geometry_count && filled; i++) {
        const pm__geometry *const g = from->geometries[i];
        const RTCScene *const part = g->part ? find_part(plain, whole, g->part) : NULL;
        if (part)
            add_instance(plain->device, to, *part, &g->placement);
        else if (g->planes)
            filled = add_triangles(plain->device, to, g->vertices, g->vertex_count, g->triangles, g->count);
        else
            filled = add_shape(plain->device, to, &g->shape);
    }
    rtcCommitScene(to);
    return filled;
}

pm_status pm__plain_scene_create(const pm__scene *scene, bool robust, pm__plain_scene *plain, pm_error *error)
{
    *plain = (pm__plain_scene){.device = rtcNewDevice("threads=1,verbose=0"), .robust = robust};
    plain->scene = plain->device ? rtcNewScene(plain->device) : NULL;
    plain->parts = pm__alloc_zero(scene->part_count, sizeof *plain->parts);
    bool filled = plain->scene && plain->parts;
    for (size_t i = 0; i < scene->part_count && filled; i++) {
        plain->parts[i] = rtcNewScene(plain->device);
        plain->part_count = i + 1;
        filled = fill_scene(plain, scene, scene->parts[i], plain->parts[i]);
    }
    if (filled)
        filled = fill_scene(plain, scene, scene, plain->scene);
    return filled ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory for Embree's own scene");
}

void pm__plain_scene_destroy(pm__plain_scene *plain)
{
    for (size_t i = 0; i < plain->part_count; i++)
        rtcReleaseScene(plain->parts[i]);
    free(plain->parts);
    if (plain->scene)
        rtcReleaseScene(plain->scene);
    if (plain->device)
        rtcReleaseDevice(plain->device);
}
