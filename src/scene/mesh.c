/* Meshes: checked, and handed to Embree. */
#include "rays.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static pm_status no_memory(pm_error *error)
{
    return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
}

/* ---- Checks ------------------------------------------------------------------------------------- */

/* Fills in the triangles' planes. */
static pm_status check_mesh(uint32_t first, const float (*vertices)[3], size_t vertex_count,
                            const uint32_t (*triangles)[3], size_t triangle_count, pm__plane *planes, pm_error *error)
{
    for (size_t i = 0; i < vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            if (!(fabs((double)vertices[i][axis]) <= PM__LARGEST_LENGTH))
                return pm__fail(error, PM_EINVAL,
                                "shape %u (mesh): vertex %zu (%g, %g, %g) is not finite or beyond %g m", first, i,
                                (double)vertices[i][0], (double)vertices[i][1], (double)vertices[i][2],
                                PM__LARGEST_LENGTH);
    for (size_t i = 0; i < triangle_count; i++) {
        const uint32_t *const t = triangles[i];
        if (t[0] >= vertex_count || t[1] >= vertex_count || t[2] >= vertex_count)
            return pm__fail(error, PM_EINVAL, "shape %u (mesh): triangle %zu (%u, %u, %u) names a vertex beyond %zu",
                            first, i, t[0], t[1], t[2], vertex_count);
        if (!pm__triangle_plane(vertices, t, &planes[i]))
            return pm__fail(error, PM_EINVAL, "shape %u (mesh): triangle %zu (%u, %u, %u) spans no area", first, i,
                            t[0], t[1], t[2]);
    }
    return PM_OK;
}

static void box_of(pm__geometry *made, const float (*vertices)[3], size_t count)
{
    pm__box_empty(made->low, made->high);
    for (size_t i = 0; i < count; i++) {
        const double corner[3] = {(double)vertices[i][0], (double)vertices[i][1], (double)vertices[i][2]};
        pm__box_enclose(made->low, made->high, corner);
    }
}

/* ---- Meshes ------------------------------------------------------------------------------------- */

/* Checks, and copies into buffers of Embree's. */
static pm_status fill(pm__geometry *made, const float (*vertices)[3], const uint32_t (*triangles)[3],
                      RTCGeometry embree, pm_error *error)
{
    const size_t count = made->count;
    made->planes = pm__alloc(count, sizeof *made->planes);
    pm_status status = made->planes ? check_mesh(made->first, vertices, made->vertex_count, triangles, count,
                                                 made->planes, error)
                                    : no_memory(error);
    if (status != PM_OK)
        return status;
    float(*const v)[3] = rtcSetNewGeometryBuffer(embree, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof *v,
                                                 made->vertex_count);
    uint32_t(*const t)[3] = rtcSetNewGeometryBuffer(embree, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof *t,
                                                    count);
    if (!v || !t) {
        status = pm__scene_embree_status(made->scene, error);
        return status == PM_OK ? no_memory(error) : status;
    }
    memcpy(v, vertices, made->vertex_count * sizeof *v);
    memcpy(t, triangles, count * sizeof *t);
    made->vertices = (const float(*)[3])v;
    made->triangles = (const uint32_t(*)[3])t;
    return PM_OK;
}

pm_status pm__scene_mesh(pm__scene *scene, uint32_t material, const float (*vertices)[3], size_t vertex_count,
                         const uint32_t (*triangles)[3], size_t triangle_count, pm_error *error)
{
    if (vertex_count == 0 || triangle_count == 0)
        return pm__fail(error, PM_EINVAL, "shape %u (mesh): %zu vertices and %zu triangles", scene->shape_count,
                        vertex_count, triangle_count);
    pm__geometry *made = NULL;
    pm_status status = pm__geometry_of(scene, material, triangle_count, &made, error);
    if (status != PM_OK)
        return status;
    made->vertex_count = vertex_count;
    const RTCGeometry embree = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    status = fill(made, vertices, triangles, embree, error);
    if (status != PM_OK) {
        rtcReleaseGeometry(embree);
        pm__geometry_destroy(made);
        return status;
    }
    pm__rays_triangles(embree);
    box_of(made, vertices, vertex_count);
    pm__geometry_attach(scene, made, embree);
    return PM_OK;
}
