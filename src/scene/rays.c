/* Rays through a scene: Embree proposes, exact arithmetic in double disposes. */
#include "rays.h"

#include "../base/vec3.h"

#include <float.h>
#include <math.h>

/* Embree culls in float: with coordinates to `extent`, origin, direction and box are each off by a few 2^-24 of it.
 * Its boxes are padded, its rays lengthened at both ends by more than that, and what it then proposes is judged in
 * double. */
static const double PADDING = 0x1p-20, SHIFT = 0x1p-18;

/* Of the largest coordinate: as near to a triangle's plane counts as on it; and for positions kept in float. */
static const double ON_PLANE = 64.0 * DBL_EPSILON, FLOAT_PLANE = 0x1p-22;

/* A ray as Embree hands it through to the callbacks. */
typedef struct query {
    struct RTCIntersectContext context; /* first: Embree passes its address on */
    const pm__scene *scene;
    double origin[3], direction[3];
    double end[3];              /* where a way ends that may be blocked */
    double start;               /* m from the origin: where Embree's ray starts */
    double nearest;             /* m: the first hit so far, or the reach */
    uint32_t from, to;          /* PM__NO_SHAPE: neither end lies on one; PM__ELSEWHERE: on one of another part */
    uint32_t shape;             /* of the first hit */
    const pm__geometry *met;
    const pm__geometry *place;  /* of the part that this is in; NULL: it is in none */
} query;

/* ---- Judging in double ------------------------------------------------------------------------- */

static void triangle_corner(const float vertex[3], double corner[3])
{
    for (int axis = 0; axis < 3; axis++)
        corner[axis] = (double)vertex[axis];
}

/* Differences and products of floats are exact in double but for far exponents: corners in line give 0 or rounding. */
bool pm__triangle_plane(const float (*vertices)[3], const uint32_t triangle[3], double corner[3], double normal[3])
{
    double edge[2][3], at[3];
    triangle_corner(vertices[triangle[0]], corner);
    for (int i = 0; i < 2; i++) {
        triangle_corner(vertices[triangle[i + 1]], at);
        for (int axis = 0; axis < 3; axis++)
            edge[i][axis] = at[axis] - corner[axis];
    }
    const double *const u = edge[0], *const v = edge[1];
    for (int a = 0, b = 1, c = 2; a < 3; b = c, c = a, a++)
        normal[a] = u[b] * v[c] - u[c] * v[b];
    const double longest = sqrt(fmax(pm__dot(u, u), pm__dot(v, v)));
    return pm__normalize(normal) > 1e-14 * longest * longest;
}


static double plane_distance(const double normal[3], const double corner[3], const double position[3])
{
    double distance = 0.0;
    for (int axis = 0; axis < 3; axis++)
        distance += normal[axis] * (position[axis] - corner[axis]);
    return distance;
}

/* Is the triangle a neighbour, in the same plane, of the shape `end` that an end of the ray lies `above` that plane on?
 * Embree in float may take the one for the other. Positions may have been kept in float: within one mesh the normals
 * decide, which spares the walls of a corner. */
static bool is_neighbour(const query *q, const pm__geometry *mesh, uint32_t end, const double normal[3], double above)
{
    const double rounding = q->scene->rounding;
    if (end == PM__NO_SHAPE || fabs(above) > FLOAT_PLANE * rounding)
        return false;
    if (fabs(above) <= ON_PLANE * rounding)
        return true;
    if (end < mesh->first || end - mesh->first >= mesh->count)
        return false;
    double corner[3], other[3];
    (void)pm__triangle_plane(mesh->vertices, mesh->triangles[end - mesh->first], corner, other);
    return fabs(pm__dot(normal, other)) > 1.0 - 1e-9;
}

/* Where the ray meets the plane of a triangle that Embree has found it to pass through. */
static bool meet_triangle(const query *q, const pm__geometry *mesh, uint32_t number, double *distance)
{
    if (number == q->from || number == q->to)
        return false;
    double corner[3], normal[3];
    (void)pm__triangle_plane(mesh->vertices, mesh->triangles[number - mesh->first], corner, normal);
    const double above = plane_distance(normal, corner, q->origin);
    if (is_neighbour(q, mesh, q->from, normal, above) ||
        is_neighbour(q, mesh, q->to, normal, plane_distance(normal, corner, q->end)))
        return false;
    *distance = -above / pm__dot(normal, q->direction);
    return *distance > 0.0 && *distance <= q->nearest;
}

static bool meet(const query *q, const pm__geometry *geometry, uint32_t number, double *distance)
{
    if (geometry->vertices)
        return meet_triangle(q, geometry, number, distance);
    const pm__ray ray = {.origin = {q->origin[0], q->origin[1], q->origin[2]},
                         .direction = {q->direction[0], q->direction[1], q->direction[2]},
                         .reach = q->nearest,
                         .leaves = number == q->from,
                         .arrives = number == q->to};
    return pm__shape_meet(&geometry->shape, &ray, distance);
}

/* How far Embree must look, in its own ray's terms, so as to miss nothing that is nearer than `distance`. */
static float embree_reach(const query *q, double distance)
{
    return (float)(distance - q->start + SHIFT * q->scene->extent);
}

/* Equal distances go to the lower number, whatever Embree's order. */
static bool first_so_far(query *q, double distance, uint32_t number)
{
    if (!(distance <= q->nearest) || (distance == q->nearest && number > q->shape))
        return false;
    q->nearest = distance;
    q->shape = number;
    return true;
}

/* Takes a proposed hit if it is the first so far. */
static bool take(query *q, const pm__geometry *geometry, unsigned primitive)
{
    const uint32_t number = geometry->first + primitive;
    double distance;
    if (!meet(q, geometry, number, &distance) || !first_so_far(q, distance, number))
        return false;
    q->met = geometry;
    q->place = NULL;
    return true;
}

/* ---- What Embree calls ------------------------------------------------------------------------- */

/* All rays are single ones (rtcIntersect1, rtcOccluded1): N is 1, and the structures for N are then those for one. */

static void bound(const struct RTCBoundsFunctionArguments *arguments)
{
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    const double padding = PADDING * geometry->scene->extent;
    const double *const low = geometry->low, *const high = geometry->high;
    struct RTCBounds *const bounds = arguments->bounds_o;
    bounds->lower_x = (float)(low[0] - padding);
    bounds->lower_y = (float)(low[1] - padding);
    bounds->lower_z = (float)(low[2] - padding);
    bounds->upper_x = (float)(high[0] + padding);
    bounds->upper_y = (float)(high[1] + padding);
    bounds->upper_z = (float)(high[2] + padding);
}

static void intersect_shape(const struct RTCIntersectFunctionNArguments *arguments)
{
    query *const q = (query *)arguments->context;
    struct RTCRayHit *const found = (struct RTCRayHit *)arguments->rayhit;
    if (arguments->valid[0] && take(q, arguments->geometryUserPtr, arguments->primID))
        found->ray.tfar = fminf(found->ray.tfar, embree_reach(q, q->nearest));
}

static void occlude_shape(const struct RTCOccludedFunctionNArguments *arguments)
{
    query *const q = (query *)arguments->context;
    double distance;
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    if (arguments->valid[0] && meet(q, geometry, geometry->first, &distance))
        ((struct RTCRay *)arguments->ray)->tfar = -INFINITY;
}

/* Embree sets tfar to the distance in float before it asks, and puts the former one back when refused. Accepted, the
 * ray is left a little longer than the hit: a triangle that float puts behind and double before it is still asked. */
static void filter_hit(const struct RTCFilterFunctionNArguments *arguments)
{
    query *const q = (query *)arguments->context;
    const struct RTCHit *const hit = (const struct RTCHit *)arguments->hit;
    if (!arguments->valid[0])
        return;
    if (take(q, arguments->geometryUserPtr, hit->primID))
        ((struct RTCRay *)arguments->ray)->tfar = embree_reach(q, q->nearest);
    else
        arguments->valid[0] = 0;
}

static void filter_blocker(const struct RTCFilterFunctionNArguments *arguments)
{
    const query *const q = (const query *)arguments->context;
    const struct RTCHit *const hit = (const struct RTCHit *)arguments->hit;
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    double distance;
    if (arguments->valid[0] && !meet(q, geometry, geometry->first + hit->primID, &distance))
        arguments->valid[0] = 0;
}

/* ---- Parts ------------------------------------------------------------------------------------- */

/* Gives Embree the part of the ray within the scene's box, so that its float origin is never coarser than the scene;
 * false: the ray passes by. A ray that is not finite passes by too. */
static bool start_ray(query *q, struct RTCRay *ray)
{
    const pm__scene *const scene = q->scene;
    const double padding = PADDING * scene->extent;
    double enter = 0.0, leave = q->nearest;
    for (int axis = 0; axis < 3; axis++) {
        if (!isfinite(q->origin[axis]) || !isfinite(q->direction[axis]))
            return false;
        /* A quotient 0/0 is on the padded box and parallel to it: fmin and fmax pass it over. */
        const double a = (scene->low[axis] - padding - q->origin[axis]) / q->direction[axis];
        const double b = (scene->high[axis] + padding - q->origin[axis]) / q->direction[axis];
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    if (!(enter <= leave))
        return false;
    q->start = enter - SHIFT * scene->extent;
    *ray = (struct RTCRay){.org_x = (float)(q->origin[0] + q->start * q->direction[0]),
                           .org_y = (float)(q->origin[1] + q->start * q->direction[1]),
                           .org_z = (float)(q->origin[2] + q->start * q->direction[2]),
                           .dir_x = (float)q->direction[0],
                           .dir_y = (float)q->direction[1],
                           .dir_z = (float)q->direction[2],
                           .tfar = embree_reach(q, leave),
                           .mask = 0xffffffff};
    rtcInitIntersectContext(&q->context);
    return true;
}

static uint32_t carry_end(const pm__geometry *placed, uint32_t end)
{
    if (end == PM__NO_SHAPE)
        return end;
    return end >= placed->first && end - placed->first < placed->count ? end - placed->first : PM__ELSEWHERE;
}

/* The ray as the part sees it. Its reach is a little longer: what rounding puts there is judged again outside. */
static query carry(const query *q, const pm__geometry *placed)
{
    const pm__placement *const placement = &placed->placement;
    query inner = {.scene = placed->part,
                   .nearest = q->nearest / placement->scale * (1.0 + ON_PLANE),
                   .from = carry_end(placed, q->from),
                   .to = carry_end(placed, q->to),
                   .shape = PM__NO_SHAPE};
    pm__part_point(placement, q->origin, inner.origin);
    pm__part_direction(placement, q->direction, inner.direction);
    return inner;
}

static void intersect_part(const struct RTCIntersectFunctionNArguments *arguments)
{
    query *const q = (query *)arguments->context;
    const pm__geometry *const placed = arguments->geometryUserPtr;
    struct RTCRayHit *const found = (struct RTCRayHit *)arguments->rayhit;
    struct RTCRayHit embree = {.hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
    query inner = carry(q, placed);
    if (!arguments->valid[0] || !start_ray(&inner, &embree.ray))
        return;
    rtcIntersect1(placed->part->rays, &inner.context, &embree);
    if (inner.met && first_so_far(q, inner.nearest * placed->placement.scale, placed->first + inner.shape)) {
        q->met = inner.met;
        q->place = placed;
        found->ray.tfar = fminf(found->ray.tfar, embree_reach(q, q->nearest));
    }
}

static void occlude_part(const struct RTCOccludedFunctionNArguments *arguments)
{
    const query *const q = (const query *)arguments->context;
    const pm__geometry *const placed = arguments->geometryUserPtr;
    struct RTCRay embree;
    query inner = carry(q, placed);
    inner.nearest = q->nearest / placed->placement.scale;
    pm__part_point(&placed->placement, q->end, inner.end);
    if (!arguments->valid[0] || !start_ray(&inner, &embree))
        return;
    rtcOccluded1(placed->part->rays, &inner.context, &embree);
    if (embree.tfar < 0.0f)
        ((struct RTCRay *)arguments->ray)->tfar = -INFINITY;
}

/* ---- Rays -------------------------------------------------------------------------------------- */

void pm__rays_triangles(RTCGeometry embree)
{
    rtcSetGeometryIntersectFilterFunction(embree, filter_hit);
    rtcSetGeometryOccludedFilterFunction(embree, filter_blocker);
}

void pm__rays_shape(RTCGeometry embree)
{
    rtcSetGeometryUserPrimitiveCount(embree, 1);
    rtcSetGeometryBoundsFunction(embree, bound, NULL);
    rtcSetGeometryIntersectFunction(embree, intersect_shape);
    rtcSetGeometryOccludedFunction(embree, occlude_shape);
}

void pm__rays_part(RTCGeometry embree)
{
    rtcSetGeometryUserPrimitiveCount(embree, 1);
    rtcSetGeometryBoundsFunction(embree, bound, NULL);
    rtcSetGeometryIntersectFunction(embree, intersect_part);
    rtcSetGeometryOccludedFunction(embree, occlude_part);
}

/* Where the first hit is, on the shape to rounding, and the normal there. */
static void settle(const query *q, double position[3], double normal[3])
{
    const pm__geometry *const met = q->met;
    for (int axis = 0; axis < 3; axis++)
        position[axis] = q->origin[axis] + q->nearest * q->direction[axis];
    if (!met->vertices) {
        pm__shape_settle(&met->shape, position, normal);
        return;
    }
    double corner[3];
    (void)pm__triangle_plane(met->vertices, met->triangles[q->shape - met->first], corner, normal);
    const double off = plane_distance(normal, corner, position);
    for (int axis = 0; axis < 3; axis++)
        position[axis] -= off * normal[axis];
}

static void settle_placed(const query *q, pm__hit *hit)
{
    const pm__placement *const placement = &q->place->placement;
    double position[3], normal[3];
    query inner = carry(q, q->place);
    inner.nearest = q->nearest / placement->scale;
    inner.met = q->met;
    inner.shape = q->shape - q->place->first;
    settle(&inner, position, normal);
    pm__placed_point(placement, position, hit->position);
    pm__placed_direction(placement, normal, hit->normal);
}

bool pm__scene_intersect(const pm__scene *scene, const double origin[3], const double direction[3], double reach,
                         uint32_t from, pm__hit *hit)
{
    query q = {.scene = scene, .nearest = reach, .from = from, .to = PM__NO_SHAPE, .shape = PM__NO_SHAPE};
    for (int axis = 0; axis < 3; axis++) {
        q.origin[axis] = origin[axis];
        q.direction[axis] = direction[axis];
    }
    struct RTCRayHit embree = {.hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
    if (!start_ray(&q, &embree.ray))
        return false;
    rtcIntersect1(scene->rays, &q.context, &embree);
    if (!q.met)
        return false;
    hit->distance = q.nearest;
    hit->shape = q.shape;
    hit->material = &q.met->scene->materials[q.met->material];
    if (q.place)
        settle_placed(&q, hit);
    else
        settle(&q, hit->position, hit->normal);
    return true;
}

bool pm__scene_blocked(const pm__scene *scene, const double a[3], uint32_t from, const double b[3], uint32_t to)
{
    query q = {.scene = scene, .from = from, .to = to, .shape = PM__NO_SHAPE};
    for (int axis = 0; axis < 3; axis++) {
        q.origin[axis] = a[axis];
        q.end[axis] = b[axis];
        q.direction[axis] = b[axis] - a[axis];
    }
    q.nearest = pm__normalize(q.direction);
    struct RTCRay ray;
    if (!(q.nearest > 0.0) || !start_ray(&q, &ray))
        return false;
    rtcOccluded1(scene->rays, &q.context, &ray);
    return ray.tfar < 0.0f;
}
