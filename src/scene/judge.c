/* What is proposed to a ray, judged in double. */
#include "query.h"

#include "../base/vec3.h"

#include <float.h>
#include <math.h>

/* Of the largest coordinate: as near to a triangle's plane counts as on it; and for positions kept in float. */
static const double ON_PLANE = 64.0 * DBL_EPSILON, FLOAT_PLANE = 0x1p-22;

/* Differences and products of floats are exact in double but for far exponents: corners in line give 0 or rounding. */
bool pm__triangle_plane(const float (*vertices)[3], const uint32_t triangle[3], pm__plane *plane)
{
    double edge[2][3];
    for (int axis = 0; axis < 3; axis++) {
        plane->corner[axis] = (double)vertices[triangle[0]][axis];
        for (int i = 0; i < 2; i++)
            edge[i][axis] = (double)vertices[triangle[i + 1]][axis] - plane->corner[axis];
    }
    const double *const u = edge[0], *const v = edge[1];
    pm__cross(u, v, plane->normal);
    const double longest = sqrt(fmax(pm__dot(u, u), pm__dot(v, v)));
    return pm__normalize(plane->normal) > 1e-14 * longest * longest;
}

static double above_plane(const pm__plane *plane, const double position[3])
{
    const double *const n = plane->normal, *const c = plane->corner;
    return n[0] * (position[0] - c[0]) + n[1] * (position[1] - c[1]) + n[2] * (position[2] - c[2]);
}

/* Is the triangle a neighbour, in the same plane, of the shape `end` that an end of the ray lies `above` that plane on?
 * Embree in float may take the one for the other. Positions may have been kept in float: within one mesh the normals
 * decide, which spares the walls of a corner. */
static bool is_neighbour(const pm__query *q, const pm__geometry *mesh, uint32_t end, const double normal[3],
                         double above)
{
    const double rounding = q->scene->rounding;
    if (end == PM__NO_SHAPE || fabs(above) > FLOAT_PLANE * rounding)
        return false;
    if (fabs(above) <= ON_PLANE * rounding)
        return true;
    if (end < mesh->first || end - mesh->first >= mesh->count)
        return false;
    return fabs(pm__dot(normal, mesh->planes[end - mesh->first].normal)) > 1.0 - 1e-9;
}

/* Next to an edge Embree in float may let a ray cross both of its triangles, one behind the other within rounding. From
 * front to back, or from back to front, a surface is crossed but once: the second is refused. In a corner that the ray
 * is on its way into the signs differ, and across a sharp edge too. */
static bool is_crossed(const pm__query *q, const pm__geometry *mesh, const pm__plane *plane, double distance)
{
    if (q->from == PM__NO_SHAPE || q->from < mesh->first || q->from - mesh->first >= mesh->count ||
        distance > 4.0 * FLOAT_PLANE * q->scene->rounding)
        return false;
    const double *const d = q->ray.direction;
    return pm__dot(mesh->planes[q->from - mesh->first].normal, d) * pm__dot(plane->normal, d) > 0.0;
}

/* Where the ray meets the plane of a triangle that Embree has found it to pass through. */
static bool meet_triangle(const pm__query *q, const pm__geometry *mesh, uint32_t number, double *distance)
{
    if (number == q->from || number == q->to)
        return false;
    const pm__plane *const plane = &mesh->planes[number - mesh->first];
    const double above = above_plane(plane, q->ray.origin);
    if (is_neighbour(q, mesh, q->from, plane->normal, above) ||
        (q->to != PM__NO_SHAPE && is_neighbour(q, mesh, q->to, plane->normal, above_plane(plane, q->end))))
        return false;
    *distance = -above / pm__dot(plane->normal, q->ray.direction);
    return *distance > 0.0 && *distance <= q->ray.reach && !is_crossed(q, mesh, plane, *distance);
}

bool pm__query_meet(pm__query *q, const pm__geometry *geometry, uint32_t number, double *distance)
{
    if (geometry->planes)
        return meet_triangle(q, geometry, number, distance);
    q->ray.leaves = number == q->from;
    q->ray.arrives = number == q->to;
    return pm__shape_meet(&geometry->shape, &q->ray, distance);
}

bool pm__query_take(pm__query *q, const pm__geometry *geometry, uint32_t number)
{
    double distance;
    if (!pm__query_meet(q, geometry, number, &distance) || !pm__query_shorten(q, distance, number))
        return false;
    q->met = geometry;
    q->place = NULL;
    return true;
}

static void take_flats(pm__query *q)
{
    const pm__flats *const flats = q->scene->flats;
    double distance;
    const size_t place = pm__flats_meet(flats, &q->ray, q->from, q->to, &distance);
    if (place < flats->count && pm__query_shorten(q, distance, q->scene->flat[place]->first)) {
        q->met = q->scene->flat[place];
        q->place = NULL;
    }
}

void pm__query_take_few(pm__query *q)
{
    if (q->scene->flats)
        take_flats(q);
    for (size_t i = 0; i < q->scene->single_count; i++)
        (void)pm__query_take(q, q->scene->single[i], q->scene->single[i]->first);
}

bool pm__query_meets_few(pm__query *q)
{
    const pm__scene *const scene = q->scene;
    double distance;
    if (scene->flats && pm__flats_meet(scene->flats, &q->ray, q->from, q->to, &distance) < scene->flats->count)
        return true;
    for (size_t i = 0; i < scene->single_count; i++)
        if (pm__query_meet(q, scene->single[i], scene->single[i]->first, &distance))
            return true;
    return false;
}

void pm__query_settle(const pm__query *q, double position[3], double normal[3])
{
    const pm__geometry *const met = q->met;
    for (int axis = 0; axis < 3; axis++)
        position[axis] = q->ray.origin[axis] + q->ray.reach * q->ray.direction[axis];
    if (!met->planes) {
        pm__shape_settle(&met->shape, position, normal);
        return;
    }
    const pm__plane *const plane = &met->planes[q->shape - met->first];
    const double off = above_plane(plane, position);
    for (int axis = 0; axis < 3; axis++) {
        normal[axis] = plane->normal[axis];
        position[axis] -= off * normal[axis];
    }
}
