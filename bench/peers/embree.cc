// Embree: rtcPointQuery over user geometry, one primitive a point.
#include "collect.h"

#include <embree3/rtcore.h>

#include <atomic>
#include <cmath>
#include <string>

namespace {
using namespace pm_peers;

struct index_type {
    const float (*points)[3];
    size_t count;
    std::atomic<long> bytes{0};
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    heap heaped;
    selector selecting;
    ~index_type()
    {
        if (scene)
            rtcReleaseScene(scene);
        if (device)
            rtcReleaseDevice(device);
    }
};

index_type *of(void *index) { return static_cast<index_type *>(index); }

bool watch_memory(void *user, ssize_t bytes, bool)
{
    of(user)->bytes += long(bytes);
    return true;
}

void bounds(const RTCBoundsFunctionArguments *arguments)
{
    const float *const p = static_cast<const index_type *>(arguments->geometryUserPtr)->points[arguments->primID];
    *arguments->bounds_o = {p[0], p[1], p[2], 0.0f, p[0], p[1], p[2], 0.0f};
}

bool make_scene(index_type *it, size_t threads)
{
    it->device = rtcNewDevice(("threads=" + std::to_string(threads) + ",set_affinity=0").c_str());
    if (!it->device)
        return false;
    rtcSetDeviceMemoryMonitorFunction(it->device, watch_memory, it);
    it->scene = rtcNewScene(it->device);
    const RTCGeometry geometry = rtcNewGeometry(it->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, unsigned(it->count));
    rtcSetGeometryUserData(geometry, it);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(it->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(it->scene);
    return rtcGetDeviceError(it->device) == RTC_ERROR_NONE;
}

void *build(const float (*points)[3], size_t count, size_t threads)
{
    index_type *const it = new (std::nothrow) index_type;
    if (!it)
        return nullptr;
    it->points = points;
    it->count = count;
    if (make_scene(it, threads ? threads : 1))
        return it;
    delete it;
    return nullptr;
}

void destroy(void *index) { delete of(index); }

// What the callback needs.
template <class Set> struct visit {
    const float (*points)[3];
    Set *set;
};

float distance2(const float *p, const RTCPointQuery *q)
{
    const float x = p[0] - q->x, y = p[1] - q->y, z = p[2] - q->z;
    return x * x + y * y + z * z;
}

// A radius whose square is not below `square`, also where Embree rounds otherwise.
float radius_of(float square) { return std::sqrt(square) * (1.0f + 4.0e-7f); }

template <class Set> bool meet(RTCPointQueryFunctionArguments *arguments)
{
    visit<Set> *const v = static_cast<visit<Set> *>(arguments->userPtr);
    const float before = v->set->bound;
    v->set->offer(distance2(v->points[arguments->primID], arguments->query), arguments->primID);
    if (v->set->bound == before)
        return false;
    arguments->query->radius = radius_of(v->set->bound);
    return true;
}

void run(index_type *it, const float point[3], float radius, RTCPointQueryFunction meet_point, void *user)
{
    RTCPointQuery query = {};
    query.x = point[0];
    query.y = point[1];
    query.z = point[2];
    query.radius = radius;
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(it->scene, &query, &context, meet_point, user);
}

template <class Set>
size_t nearest_into(Set &set, index_type *it, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    visit<Set> v = {it->points, &set};
    set.start(k);
    run(it, point, std::numeric_limits<float>::infinity(), meet<Set>, &v);
    return set.finish(ids, distances2);
}

size_t nearest(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    return nearest_into(of(index)->heaped, of(index), point, k, ids, distances2);
}

size_t nearest_select(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    return nearest_into(of(index)->selecting, of(index), point, k, ids, distances2);
}

struct radius_visit {
    const float (*points)[3];
    plain_list list;
    float radius2;
};

bool meet_within(RTCPointQueryFunctionArguments *arguments)
{
    radius_visit *const v = static_cast<radius_visit *>(arguments->userPtr);
    if (distance2(v->points[arguments->primID], arguments->query) <= v->radius2)
        v->list.add(arguments->primID);
    return false;
}

size_t within(void *index, const float point[3], float radius, size_t capacity, uint32_t *ids)
{
    radius_visit v = {of(index)->points, {ids, capacity, 0}, radius * radius};
    run(of(index), point, radius_of(v.radius2), meet_within, &v);
    return v.list.count;
}

size_t bytes(const void *index)
{
    const index_type *const it = static_cast<const index_type *>(index);
    const long watched = it->bytes;
    return (watched > 0 ? size_t(watched) : 0) + it->count * sizeof *it->points;
}
} // namespace

extern "C" const pm__peer pm__peer_embree_pointquery = {
    "embree-pointquery", "Embree's rtcPointQuery, a user primitive a point, max-heap",
    true, build, destroy, nearest, within, bytes};
extern "C" const pm__peer pm__peer_embree_pointquery_select = {
    "embree-pointquery-select", "Embree's rtcPointQuery with a list that selects",
    true, build, destroy, nearest_select, nullptr, bytes};
