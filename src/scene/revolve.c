#include "revolve.h"

#include "../base/memory.h"
#include "shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static const size_t MOST_TRIANGLES = (size_t)1 << 31;

pm_status pm__mesh_create(size_t vertex_count, size_t triangle_count, pm__mesh *mesh, pm_error *error)
{
    *mesh = (pm__mesh){.vertices = pm__alloc_zero(vertex_count, sizeof *mesh->vertices),
                       .triangles = pm__alloc_zero(triangle_count, sizeof *mesh->triangles),
                       .vertex_count = vertex_count,
                       .triangle_count = triangle_count};
    if (mesh->vertices && mesh->triangles)
        return PM_OK;
    pm__mesh_free(mesh);
    return pm__fail(error, PM_ENOMEM, "out of memory for a mesh of %zu triangles", triangle_count);
}

void pm__mesh_free(pm__mesh *mesh)
{
    free(mesh->vertices);
    free(mesh->triangles);
    *mesh = (pm__mesh){0};
}

static bool is_pole(const double point[2])
{
    return point[0] == 0.0;
}

static pm_status check_point(const double (*profile)[2], size_t i, pm_error *error)
{
    const double r = profile[i][0], z = profile[i][1];
    if (!(r >= 0.0 && r <= PM__LARGEST_LENGTH && fabs(z) <= PM__LARGEST_LENGTH))
        return pm__fail(error, PM_EINVAL, "surface of revolution: point %zu (%g, %g) is not finite, beyond %g m or of "
                        "negative radius", i, r, z, PM__LARGEST_LENGTH);
    if (i > 0 && profile[i - 1][0] == r && profile[i - 1][1] == z)
        return pm__fail(error, PM_EINVAL, "surface of revolution: point %zu (%g, %g) is as the one before it", i, r, z);
    if (i > 0 && is_pole(profile[i - 1]) && is_pole(profile[i]))
        return pm__fail(error, PM_EINVAL, "surface of revolution: points %zu and %zu both lie on the axis", i - 1, i);
    return PM_OK;
}

static pm_status check(const double (*profile)[2], size_t count, size_t turns, pm_error *error)
{
    if (count < 2 || count > PM__MOST_PROFILE)
        return pm__fail(error, PM_EINVAL, "surface of revolution: %zu points, not 2 to %d", count, PM__MOST_PROFILE);
    if (turns < 3 || turns > PM__MOST_TURNS)
        return pm__fail(error, PM_EINVAL, "surface of revolution: %zu turns, not 3 to %d", turns, PM__MOST_TURNS);
    if (2 * turns * count > MOST_TRIANGLES)
        return pm__fail(error, PM_EINVAL, "surface of revolution: %zu points of %zu turns are too many", count, turns);
    pm_status status = PM_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = check_point(profile, i, error);
    return status;
}

/* A ring's vertices depend on its own point alone, so that rings of different meshes agree. */
static size_t add_ring(pm__mesh *mesh, size_t first, const double point[2], size_t turns)
{
    const size_t count = is_pole(point) ? 1 : turns;
    for (size_t i = 0; i < count; i++) {
        const double angle = 2.0 * pi * (double)i / (double)turns;
        mesh->vertices[first + i][0] = (float)(point[0] * cos(angle));
        mesh->vertices[first + i][1] = (float)(point[0] * sin(angle));
        mesh->vertices[first + i][2] = (float)point[1];
    }
    return first + count;
}

static void add_triangle(pm__mesh *mesh, size_t *next, size_t a, size_t b, size_t c)
{
    uint32_t *const triangle = mesh->triangles[(*next)++];
    triangle[0] = (uint32_t)a;
    triangle[1] = (uint32_t)b;
    triangle[2] = (uint32_t)c;
}

/* Between the rings that begin at `low` and `high`. Four corners lie in one plane, so either diagonal does. */
static void add_belt(pm__mesh *mesh, size_t *next, size_t low, bool low_pole, size_t high, bool high_pole, size_t turns)
{
    for (size_t i = 0; i < turns; i++) {
        const size_t j = (i + 1) % turns;
        const size_t a = low_pole ? low : low + i, b = low_pole ? low : low + j;
        const size_t c = high_pole ? high : high + i, d = high_pole ? high : high + j;
        if (!low_pole)
            add_triangle(mesh, next, a, b, d);
        if (!high_pole)
            add_triangle(mesh, next, a, d, c);
    }
}

pm_status pm__revolve(const double (*profile)[2], size_t count, size_t turns, pm__mesh *mesh, pm_error *error)
{
    *mesh = (pm__mesh){0};
    pm_status status = check(profile, count, turns, error);
    if (status)
        return status;
    size_t vertices = 0, triangles = 0, ring = 0, next = 0;
    for (size_t i = 0; i < count; i++) {
        vertices += is_pole(profile[i]) ? 1 : turns;
        if (i > 0)
            triangles += turns * (2 - (size_t)is_pole(profile[i - 1]) - (size_t)is_pole(profile[i]));
    }
    status = pm__mesh_create(vertices, triangles, mesh, error);
    for (size_t i = 0; i < count && !status; i++) {
        const size_t before = ring, size = i > 0 && !is_pole(profile[i - 1]) ? turns : 1;
        ring = add_ring(mesh, ring, profile[i], turns);
        if (i > 0)
            add_belt(mesh, &next, before - size, is_pole(profile[i - 1]), before, is_pole(profile[i]), turns);
    }
    return status;
}
