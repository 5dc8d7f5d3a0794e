// ANN: Mount and Arya's kd-tree, in double as Debian builds it.
#include "collect.h"

#include <ANN/ANN.h>

#include <memory>

namespace {
using namespace pm_peers;

constexpr int bucket_size = 8;

struct index_type {
    std::vector<double> coordinates; // ANN wants an array of pointers to doubles
    std::vector<ANNpoint> points;
    std::unique_ptr<ANNkd_tree> tree;
    std::vector<int> ids;
    std::vector<double> distances2;
    size_t heap_bytes = 0;
    index_type(const float (*p)[3], size_t count) : coordinates(3 * count), points(count)
    {
        for (size_t i = 0; i < count; i++) {
            points[i] = &coordinates[3 * i];
            for (size_t a = 0; a < 3; a++)
                coordinates[3 * i + a] = double(p[i][a]);
        }
        tree.reset(new ANNkd_tree(points.data(), int(count), 3, bucket_size));
    }
    void reserve(size_t k)
    {
        if (ids.size() < k) {
            ids.resize(k);
            distances2.resize(k);
        }
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
    index_type *const it = of(index);
    double q[3] = {double(point[0]), double(point[1]), double(point[2])};
    k = std::min(k, it->points.size()); // it ends the program where k is more
    it->reserve(k);
    it->tree->annkSearch(q, int(k), it->ids.data(), it->distances2.data());
    for (size_t i = 0; i < k; i++) {
        ids[i] = uint32_t(it->ids[i]);
        distances2[i] = float(it->distances2[i]);
    }
    return k;
}

// Its fixed-radius search gives the nearest k within the radius and the count of all: asked again where k was too few.
size_t within(void *index, const float point[3], float radius, size_t capacity, uint32_t *ids)
{
    index_type *const it = of(index);
    double q[3] = {double(point[0]), double(point[1]), double(point[2])};
    const double radius2 = double(radius) * double(radius);
    it->reserve(64);
    size_t count =
        size_t(it->tree->annkFRSearch(q, radius2, int(it->ids.size()), it->ids.data(), it->distances2.data()));
    if (count > it->ids.size()) {
        it->reserve(count + count / 2);
        it->tree->annkFRSearch(q, radius2, int(count), it->ids.data(), it->distances2.data());
    }
    for (size_t i = 0; i < count && i < capacity; i++)
        ids[i] = uint32_t(it->ids[i]);
    return count;
}

size_t bytes(const void *index) { return static_cast<const index_type *>(index)->heap_bytes; }
} // namespace

extern "C" const pm__peer pm__peer_ann = {
    "ann", "ANN's kd-tree in double, buckets of 8", false, build, destroy, nearest, within, bytes};
