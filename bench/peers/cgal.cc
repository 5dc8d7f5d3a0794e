// CGAL: Kd_tree of its dD Spatial Searching, extended nodes, sliding midpoint, points cached in leaf order.
#include "collect.h"

#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>

#include <boost/iterator/counting_iterator.hpp>
#include <boost/iterator/function_output_iterator.hpp>

namespace {
using namespace pm_peers;

using kernel = CGAL::Simple_cartesian<float>;
using point_type = kernel::Point_3;
static_assert(sizeof(point_type) == 3 * sizeof(float), "the caller's points are read as they are");

// Items are numbers; this gives their points.
struct point_map {
    using key_type = uint32_t;
    using value_type = point_type;
    using reference = const point_type &;
    using category = boost::lvalue_property_map_tag;
    const point_type *points;
    reference operator[](key_type id) const { return points[id]; }
    friend reference get(const point_map &map, key_type id) { return map.points[id]; }
};

using traits_type = CGAL::Search_traits_adapter<uint32_t, point_map, CGAL::Search_traits_3<kernel>>;
using distance_type =
    CGAL::Distance_adapter<uint32_t, point_map, CGAL::Euclidean_distance<CGAL::Search_traits_3<kernel>>>;
using splitter = CGAL::Sliding_midpoint<traits_type>;
using tree_type = CGAL::Kd_tree<traits_type, splitter, CGAL::Tag_true, CGAL::Tag_true>;
using search_type = CGAL::Orthogonal_k_neighbor_search<traits_type, distance_type, splitter, tree_type>;
using node_handle = tree_type::Node_const_handle;

constexpr unsigned bucket_size = 16;

struct index_type {
    point_map map;
    size_t count;
    tree_type tree;
    selector best;
    size_t heap_bytes = 0;
    index_type(const float (*points)[3], size_t n, bool threads)
        : map{reinterpret_cast<const point_type *>(points)}, count(n),
          tree(boost::counting_iterator<uint32_t>(0), boost::counting_iterator<uint32_t>(uint32_t(n)),
               splitter(bucket_size), traits_type(map))
    {
#ifdef CGAL_LINKED_WITH_TBB
        if (threads) {
            tree.build<CGAL::Parallel_tag>();
            return;
        }
#endif
        (void)threads;
        tree.build();
    }
};

index_type *of(void *index) { return static_cast<index_type *>(index); }

void *build(const float (*points)[3], size_t count, size_t threads)
{
    return measured_build([=] { return new index_type(points, count, threads > 1); });
}

void destroy(void *index) { delete of(index); }

size_t nearest(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    index_type *const it = of(index);
    const search_type search(it->tree, point_type(point[0], point[1], point[2]), unsigned(k), 0.0f, true,
                             distance_type(it->map), false);
    size_t count = 0;
    for (const auto &found : search) {
        ids[count] = found.first;
        distances2[count++] = found.second;
    }
    return count;
}

// Its descent (Arya and Mount's incremental distances), with the library's nodes and a result set of our choice, which
// its own class does not take.
struct descent {
    const index_type &it;
    const float *point;
    selector &best;
    float offsets[3];

    void scan(const tree_type::Leaf_node &leaf)
    {
        const float *c = &*it.tree.cache_begin() + 3 * (leaf.begin() - it.tree.begin());
        for (auto item = leaf.begin(); item != leaf.end(); ++item, c += 3) {
            const float x = c[0] - point[0], y = c[1] - point[1], z = c[2] - point[2];
            best.offer(x * x + y * y + z * z, *item);
        }
    }
    void visit(node_handle node, float to_node)
    {
        if (node->is_leaf()) {
            scan(*static_cast<tree_type::Leaf_node_const_handle>(node));
            return;
        }
        const auto inner = static_cast<tree_type::Internal_node_const_handle>(node);
        const int axis = inner->cutting_dimension();
        const float q = point[axis], to_low = q - inner->upper_low_value(), to_high = q - inner->lower_high_value();
        const bool low_first = to_low + to_high < 0.0f;
        const float old = offsets[axis];
        const float beyond = low_first ? std::min(0.0f, to_high) : std::max(0.0f, to_low);
        visit(low_first ? inner->lower() : inner->upper(), to_node);
        const float to_far = to_node - old * old + beyond * beyond;
        if (to_far <= best.bound) {
            offsets[axis] = beyond;
            visit(low_first ? inner->upper() : inner->lower(), to_far);
            offsets[axis] = old;
        }
    }
};

size_t nearest_select(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2)
{
    index_type *const it = of(index);
    const auto &box = it->tree.bounding_box();
    descent d = {*it, point, it->best, {0.0f, 0.0f, 0.0f}};
    float to_root = 0.0f;
    for (int a = 0; a < 3; a++) {
        d.offsets[a] = std::max(box.min_coord(a) - point[a], std::max(0.0f, point[a] - box.max_coord(a)));
        to_root += d.offsets[a] * d.offsets[a];
    }
    it->best.start(k);
    d.visit(it->tree.root(), to_root);
    return it->best.finish(ids, distances2);
}

struct adder { // assignable, as its search wants iterators
    plain_list *list;
    void operator()(uint32_t id) const { list->add(id); }
};

size_t within(void *index, const float point[3], float radius, size_t capacity, uint32_t *ids)
{
    index_type *const it = of(index);
    plain_list list = {ids, capacity, 0};
    const CGAL::Fuzzy_sphere<traits_type> sphere(point_type(point[0], point[1], point[2]), radius, 0.0f,
                                                 it->tree.traits());
    it->tree.search(boost::make_function_output_iterator(adder{&list}), sphere);
    return list.count;
}

// The caller's points are read while building only: queries read the cache.
size_t bytes(const void *index) { return static_cast<const index_type *>(index)->heap_bytes; }

#ifdef CGAL_LINKED_WITH_TBB
constexpr bool threaded = true;
#else
constexpr bool threaded = false;
#endif
} // namespace

extern "C" const pm__peer pm__peer_cgal = {
    "cgal", "CGAL's Kd_tree, buckets of 16, points cached",
    threaded, build, destroy, nearest, within, bytes};
extern "C" const pm__peer pm__peer_cgal_select = {
    "cgal-select", "CGAL's Kd_tree with a result set that selects",
    threaded, build, destroy, nearest_select, nullptr, bytes};
