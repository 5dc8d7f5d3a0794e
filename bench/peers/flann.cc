// FLANN: its exact kd-tree for low dimensions (KDTreeSingleIndex), points copied in leaf order.
#include "collect.h"

#include <flann/flann.hpp>

namespace {
using namespace pm_peers;

using metric = flann::L2_Simple<float>;
constexpr int leaf_size = 16;
constexpr size_t heap_threshold = 250; // FLANN's own choice between its two result sets (KNN_HEAP_THRESHOLD)

class select_set : public flann::ResultSet<float> {
public:
    selector best;
    bool full() const override { return best.full(); }
    void addPoint(float distance2, size_t id) override { best.offer(distance2, uint32_t(id)); }
    float worstDist() const override { return best.bound; }
};

class radius_set : public flann::ResultSet<float> {
public:
    plain_list list;
    float radius2;
    radius_set(const plain_list &l, float r2) : list(l), radius2(r2) {}
    bool full() const override { return true; }
    void addPoint(float distance2, size_t id) override
    {
        if (distance2 <= radius2)
            list.add(uint32_t(id));
    }
    float worstDist() const override { return std::nextafter(radius2, std::numeric_limits<float>::infinity()); }
};

struct index_type {
    flann::KDTreeSingleIndex<metric> tree;
    flann::SearchParams params{flann::FLANN_CHECKS_UNLIMITED, 0.0f, false};
    select_set selecting;
    std::vector<size_t> ids;
    size_t heap_bytes = 0;
    index_type(const float (*points)[3], size_t count)
        : tree(flann::Matrix<float>(const_cast<float *>(points[0]), count, 3),
               flann::KDTreeSingleIndexParams(leaf_size, true))
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

template <class Set> size_t search(index_type *it, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    Set set(k);
    it->tree.findNeighbors(set, point, it->params);
    const size_t count = std::min(set.size(), k);
    if (it->ids.size() < k)
        it->ids.resize(k);
    set.copy(it->ids.data(), distances2, count, false);
    std::copy_n(it->ids.begin(), count, ids);
    return count;
}

size_t nearest(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    k = std::min(k, of(index)->tree.size()); // its sets hold garbage where they are not full
    return k > heap_threshold ? search<flann::KNNResultSet2<float>>(of(index), point, k, ids, distances2)
                              : search<flann::KNNSimpleResultSet<float>>(of(index), point, k, ids, distances2);
}

size_t nearest_select(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    select_set &set = of(index)->selecting;
    set.best.start(k);
    of(index)->tree.findNeighbors(set, point, of(index)->params);
    return set.best.finish(ids, distances2);
}

size_t within(void *index, const float point[3], float radius, size_t capacity, uint32_t *ids)
{
    radius_set set({ids, capacity, 0}, radius * radius);
    of(index)->tree.findNeighbors(set, point, of(index)->params);
    return set.list.count;
}

size_t bytes(const void *index) { return static_cast<const index_type *>(index)->heap_bytes; }
} // namespace

extern "C" const pm__peer pm__peer_flann = {
    "flann", "FLANN's KDTreeSingleIndex, leaves of 16, reordered, its own result sets",
    false, build, destroy, nearest, within, bytes};
extern "C" const pm__peer pm__peer_flann_select = {
    "flann-select", "FLANN's KDTreeSingleIndex with a result set that selects",
    false, build, destroy, nearest_select, nullptr, bytes};
