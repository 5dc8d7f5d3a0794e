/* Rays through a scene: Embree proposes, exact arithmetic in double disposes. A few exact shapes are asked without it:
 * that costs less than to have Embree ask. */
#include "query.h"
#include "slab.h"

#include "../base/vec3.h"

#include <float.h>
#include <math.h>

/* ---- What Embree is asked ---------------------------------------------------------------------- */

/* How far Embree must look, in its own ray's terms, so as to miss nothing that is nearer than `distance`. */
static float embree_reach(const pm__query *q, double distance)
{
    return (float)(distance - q->start + PM__SHIFT * q->scene->extent);
}

/* Where the ray enters the box, padded, and leaves it; false: it passes by, within its reach. */
static bool enter_box(const pm__query *q, const double low[3], const double high[3], double *enter, double *leave)
{
    const double padding = PM__PADDING * q->scene->extent;
    *enter = 0.0;
    *leave = q->ray.reach;
    for (int axis = 0; axis < 3; axis++)
        pm__slab_cut(q->ray.origin[axis], 1.0 / q->ray.direction[axis], low[axis] - padding, high[axis] + padding,
                     enter, leave);
    return *enter <= *leave;
}

static bool is_within(const pm__scene *scene, const double position[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (!(position[axis] >= scene->low[axis] && position[axis] <= scene->high[axis]))
            return false;
    return true;
}

/* Can the ray meet it, by its box, and by how steeply it leaves or comes? */
static bool may_meet(const pm__query *q, const pm__held *held)
{
    double enter, leave;
    const bool is_on = (q->from >= held->first && q->from < held->end) || (q->to >= held->first && q->to < held->end);
    return !(is_on && fabs(q->ray.direction[held->axis]) > held->steep) &&
           enter_box(q, held->low, held->high, &enter, &leave);
}

/* Can Embree know of a hit? *enter, *leave: the box of all shapes, so that what Embree answers does not depend on which
 * of them it holds. */
static bool is_embrees(const pm__query *q, double *enter, double *leave)
{
    const pm__scene *const scene = q->scene;
    bool may = false;
    for (size_t i = 0; i < scene->held_count; i++)
        may = may || may_meet(q, &scene->held[i]);
    if (!may)
        return false;
    if (!is_within(scene, q->ray.origin))
        return enter_box(q, scene->low, scene->high, enter, leave);
    *enter = 0.0;
    *leave = q->ray.reach;
    return true;
}

/* Gives Embree the part of the ray within the scene's box, so that its float origin is never coarser than the scene. */
static void start_ray(pm__query *q, double enter, double leave, struct RTCRay *ray)
{
    const double *const o = q->ray.origin, *const d = q->ray.direction;
    q->start = enter - PM__SHIFT * q->scene->extent;
    *ray = (struct RTCRay){.org_x = (float)(o[0] + q->start * d[0]),
                           .org_y = (float)(o[1] + q->start * d[1]),
                           .org_z = (float)(o[2] + q->start * d[2]),
                           .dir_x = (float)d[0],
                           .dir_y = (float)d[1],
                           .dir_z = (float)d[2],
                           .tfar = embree_reach(q, leave),
                           .mask = 0xffffffff};
    rtcInitIntersectContext(&q->context);
}

bool pm__query_ask_embree(pm__query *q, double enter, double leave)
{
    struct RTCRayHit embree;
    const uint32_t before = q->shape;
    start_ray(q, enter, leave, &embree.ray);
    embree.hit = (struct RTCHit){.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}};
    rtcIntersect1(q->scene->rays, &q->context, &embree);
    return q->shape != before;
}

/* The first hit of the ray, if any, becomes the query's. */
static void find_first(pm__query *q)
{
    double enter, leave;
    pm__query_take_few(q);
    if (is_embrees(q, &enter, &leave))
        (void)pm__query_ask_embree(q, enter, leave);
}

static bool find_any(pm__query *q)
{
    struct RTCRay embree;
    double enter, leave;
    if (pm__query_meets_few(q))
        return true;
    if (!is_embrees(q, &enter, &leave))
        return false;
    start_ray(q, enter, leave, &embree);
    rtcOccluded1(q->scene->rays, &q->context, &embree);
    return embree.tfar < 0.0f;
}

/* ---- Parts ------------------------------------------------------------------------------------- */

static uint32_t carry_end(const pm__geometry *placed, uint32_t end)
{
    if (end == PM__NO_SHAPE)
        return end;
    return end >= placed->first && end - placed->first < placed->count ? end - placed->first : PM__ELSEWHERE;
}

/* The ray as the part sees it, to `reach` in the whole's terms. */
static void carry(const pm__query *q, const pm__geometry *placed, double reach, pm__query *inner)
{
    const pm__placement *const placement = &placed->placement;
    inner->scene = placed->part;
    inner->ray.reach = reach / placement->scale;
    inner->from = carry_end(placed, q->from);
    inner->to = carry_end(placed, q->to);
    inner->shape = PM__NO_SHAPE;
    inner->met = inner->place = NULL;
    pm__part_point(placement, q->ray.origin, inner->ray.origin);
    pm__part_direction(placement, q->ray.direction, inner->ray.direction);
}

/* The part is asked a little farther than the reach: what rounding puts there is judged again outside. */
static bool take_part(pm__query *q, const pm__geometry *placed)
{
    pm__query inner;
    carry(q, placed, q->ray.reach * (1.0 + 64.0 * DBL_EPSILON), &inner);
    find_first(&inner);
    if (!inner.met || !pm__query_shorten(q, inner.ray.reach * placed->placement.scale, placed->first + inner.shape))
        return false;
    q->met = inner.met;
    q->place = placed;
    return true;
}

static bool part_blocks(const pm__query *q, const pm__geometry *placed)
{
    pm__query inner;
    carry(q, placed, q->ray.reach, &inner);
    if (q->to != PM__NO_SHAPE)
        pm__part_point(&placed->placement, q->end, inner.end);
    return find_any(&inner);
}

static void settle_placed(const pm__query *q, double position[3], double normal[3])
{
    const pm__placement *const placement = &q->place->placement;
    double at[3], up[3];
    pm__query inner;
    carry(q, q->place, q->ray.reach, &inner);
    inner.met = q->met;
    inner.shape = q->shape - q->place->first;
    pm__query_settle(&inner, at, up);
    pm__placed_point(placement, at, position);
    pm__placed_direction(placement, up, normal);
}

/* ---- What Embree calls ------------------------------------------------------------------------- */

/* All rays are single ones (rtcIntersect1, rtcOccluded1): N is 1, and the structures for N are then those for one. */

static void bound(const struct RTCBoundsFunctionArguments *arguments)
{
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    const double padding = PM__PADDING * geometry->scene->extent;
    const double *const low = geometry->low, *const high = geometry->high;
    struct RTCBounds *const bounds = arguments->bounds_o;
    bounds->lower_x = (float)(low[0] - padding);
    bounds->lower_y = (float)(low[1] - padding);
    bounds->lower_z = (float)(low[2] - padding);
    bounds->upper_x = (float)(high[0] + padding);
    bounds->upper_y = (float)(high[1] + padding);
    bounds->upper_z = (float)(high[2] + padding);
}

static void intersect(const struct RTCIntersectFunctionNArguments *arguments)
{
    pm__query *const q = (pm__query *)arguments->context;
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    if (!arguments->valid[0] ||
        !(geometry->part ? take_part(q, geometry) : pm__query_take(q, geometry, geometry->first)))
        return;
    struct RTCRay *const ray = &((struct RTCRayHit *)arguments->rayhit)->ray;
    const float reach = embree_reach(q, q->ray.reach);
    ray->tfar = reach < ray->tfar ? reach : ray->tfar;
}

static void occlude(const struct RTCOccludedFunctionNArguments *arguments)
{
    pm__query *const q = (pm__query *)arguments->context;
    double distance;
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    if (arguments->valid[0] && (geometry->part ? part_blocks(q, geometry)
                                               : pm__query_meet(q, geometry, geometry->first, &distance)))
        ((struct RTCRay *)arguments->ray)->tfar = -INFINITY;
}

/* Embree sets tfar to the distance in float before it asks, and puts the former one back when refused. Accepted, the
 * ray is left a little longer than the hit: a triangle that float puts behind and double before it is still asked. */
static void filter_hit(const struct RTCFilterFunctionNArguments *arguments)
{
    pm__query *const q = (pm__query *)arguments->context;
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    const struct RTCHit *const hit = (const struct RTCHit *)arguments->hit;
    if (!arguments->valid[0])
        return;
    if (pm__query_take(q, geometry, geometry->first + hit->primID))
        ((struct RTCRay *)arguments->ray)->tfar = embree_reach(q, q->ray.reach);
    else
        arguments->valid[0] = 0;
}

static void filter_blocker(const struct RTCFilterFunctionNArguments *arguments)
{
    pm__query *const q = (pm__query *)arguments->context;
    const struct RTCHit *const hit = (const struct RTCHit *)arguments->hit;
    const pm__geometry *const geometry = arguments->geometryUserPtr;
    double distance;
    if (arguments->valid[0] && !pm__query_meet(q, geometry, geometry->first + hit->primID, &distance))
        arguments->valid[0] = 0;
}

void pm__rays_triangles(RTCGeometry embree)
{
    rtcSetGeometryIntersectFilterFunction(embree, filter_hit);
    rtcSetGeometryOccludedFilterFunction(embree, filter_blocker);
}

void pm__rays_shape(RTCGeometry embree)
{
    rtcSetGeometryUserPrimitiveCount(embree, 1);
    rtcSetGeometryBoundsFunction(embree, bound, NULL);
    rtcSetGeometryIntersectFunction(embree, intersect);
    rtcSetGeometryOccludedFunction(embree, occlude);
}

/* ---- Rays -------------------------------------------------------------------------------------- */

/* false: it is not finite, and meets nothing. */
static bool begin(pm__query *q, const pm__scene *scene, const double origin[3], uint32_t from, uint32_t to)
{
    double sum = 0.0;
    q->scene = scene;
    q->from = from;
    q->to = to;
    q->shape = PM__NO_SHAPE;
    q->met = q->place = NULL;
    for (int axis = 0; axis < 3; axis++) {
        q->ray.origin[axis] = origin[axis];
        sum += origin[axis] - origin[axis] + q->ray.direction[axis];
    }
    return isfinite(sum);
}

void pm__query_hit(const pm__query *q, pm__hit *hit)
{
    hit->distance = q->ray.reach;
    hit->shape = q->shape;
    hit->material = &q->met->scene->materials[q->met->material];
    if (q->place)
        settle_placed(q, hit->position, hit->normal);
    else
        pm__query_settle(q, hit->position, hit->normal);
}

bool pm__scene_intersect(const pm__scene *scene, const double origin[3], const double direction[3], double reach,
                         uint32_t from, pm__hit *hit)
{
    pm__query q;
    for (int axis = 0; axis < 3; axis++)
        q.ray.direction[axis] = direction[axis];
    q.ray.reach = reach;
    if (!begin(&q, scene, origin, from, PM__NO_SHAPE))
        return false;
    find_first(&q);
    if (q.met)
        pm__query_hit(&q, hit);
    return q.met;
}

bool pm__scene_blocked(const pm__scene *scene, const double a[3], uint32_t from, const double b[3], uint32_t to)
{
    pm__query q;
    for (int axis = 0; axis < 3; axis++) {
        q.end[axis] = b[axis];
        q.ray.direction[axis] = b[axis] - a[axis];
    }
    q.ray.reach = pm__normalize(q.ray.direction);
    return q.ray.reach > 0.0 && begin(&q, scene, a, from, to) && find_any(&q);
}
