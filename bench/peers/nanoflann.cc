// nanoflann: a header-only kd-tree. It leaves the points where the caller has them.
#include "collect.h"

#include <nanoflann.hpp>

namespace {
using namespace pm_peers;

struct cloud {
    const float (*points)[3];
    size_t count;
    size_t kdtree_get_point_count() const { return count; }
    float kdtree_get_pt(size_t i, size_t axis) const { return points[i][axis]; }
    template <class Box> bool kdtree_get_bbox(Box &) const { return false; }
};

using tree_type = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, cloud>, cloud, 3, uint32_t>;

constexpr size_t leaf_size = 16;

// The interface of its result sets.
struct select_set {
    using DistanceType = float;
    selector best;
    bool full() const { return best.full(); }
    bool addPoint(float distance2, uint32_t id)
    {
        best.offer(distance2, id);
        return true;
    }
    float worstDist() const { return best.bound; }
};

struct radius_set {
    using DistanceType = float;
    plain_list list;
    float radius2;
    bool full() const { return true; }
    bool addPoint(float distance2, uint32_t id)
    {
        if (distance2 <= radius2)
            list.add(id);
        return true;
    }
    float worstDist() const { return std::nextafter(radius2, std::numeric_limits<float>::infinity()); }
};

struct index_type {
    cloud points;
    tree_type tree;
    select_set selecting;
    size_t heap_bytes = 0;
    index_type(const float (*p)[3], size_t count)
        : points{p, count}, tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(leaf_size))
    {
        tree.buildIndex();
    }
};

index_type *of(void *index) { return static_cast<index_type *>(index); }

void *build(const float (*points)[3], size_t count, size_t)
{
    return measured_build([=] { return new index_type(points, count); });
}

void destroy(void *index) { delete of(index); }

size_t nearest(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    nanoflann::KNNResultSet<float, uint32_t> set(k);
    set.init(ids, distances2);
    of(index)->tree.findNeighbors(set, point, nanoflann::SearchParams(32, 0.0f, false));
    return set.size();
}

size_t nearest_select(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    select_set &set = of(index)->selecting;
    set.best.start(k);
    of(index)->tree.findNeighbors(set, point, nanoflann::SearchParams(32, 0.0f, false));
    return set.best.finish(ids, distances2);
}

size_t within(void *index, const float point[3], float radius, size_t capacity, uint32_t *ids)
{
    radius_set set = {{ids, capacity, 0}, radius * radius};
    of(index)->tree.findNeighbors(set, point, nanoflann::SearchParams(32, 0.0f, false));
    return set.list.count;
}

size_t bytes(const void *index)
{
    const index_type *const it = static_cast<const index_type *>(index);
    return it->heap_bytes + it->points.count * sizeof *it->points.points;
}
} // namespace

extern "C" const pm__peer pm__peer_nanoflann = {
    "nanoflann", "nanoflann's kd-tree, leaves of 16, its own sorted list",
    false, build, destroy, nearest, within, bytes};
extern "C" const pm__peer pm__peer_nanoflann_select = {
    "nanoflann-select", "nanoflann's kd-tree with a result set that selects",
    false, build, destroy, nearest_select, nullptr, bytes};
