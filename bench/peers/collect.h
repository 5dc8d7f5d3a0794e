// What the adapters share: result sets that the libraries fill, and the heap as malloc sees it.
#ifndef PM_BENCH_PEERS_COLLECT_H
#define PM_BENCH_PEERS_COLLECT_H

#include "../peer.h"

#include <algorithm>
#include <limits>
#include <malloc.h>
#include <vector>

namespace pm_peers {

struct candidate {
    float distance2;
    uint32_t id;
    bool operator<(const candidate &other) const { return distance2 < other.distance2; }
};

// Keeps the k nearest by collecting up to twice as many and selecting now and then: O(1) an offer on average, where an
// insertion-sorted list costs O(k).
class selector {
public:
    void start(size_t k)
    {
        k_ = k;
        limit_ = k; // select once as soon as there is a bound to be had
        bound = std::numeric_limits<float>::infinity();
        if (list_.size() < 2 * k + slack)
            list_.resize(2 * k + slack);
        count_ = 0;
    }
    void offer(float distance2, uint32_t id)
    {
        if (!(distance2 < bound))
            return;
        list_[count_++] = {distance2, id};
        if (count_ == limit_)
            tighten();
    }
    size_t finish(uint32_t *ids, float *distances2)
    {
        if (count_ > k_)
            tighten();
        for (size_t i = 0; i < count_; i++) {
            ids[i] = list_[i].id;
            distances2[i] = list_[i].distance2;
        }
        return count_;
    }
    bool full() const { return count_ >= k_; }
    float bound; // nothing as far as this is wanted

private:
    static constexpr size_t slack = 32;
    void tighten()
    {
        const auto first = list_.begin();
        std::nth_element(first, first + long(k_ - 1), first + long(count_));
        count_ = k_;
        bound = list_[k_ - 1].distance2;
        limit_ = 2 * k_ + slack;
    }
    std::vector<candidate> list_;
    size_t k_ = 0, count_ = 0, limit_ = 0;
};

// The k nearest in a max-heap.
class heap {
public:
    void start(size_t k)
    {
        k_ = k;
        bound = std::numeric_limits<float>::infinity();
        list_.clear();
        list_.reserve(k);
    }
    void offer(float distance2, uint32_t id)
    {
        if (!(distance2 < bound))
            return;
        if (list_.size() == k_) {
            std::pop_heap(list_.begin(), list_.end());
            list_.back() = {distance2, id};
            std::push_heap(list_.begin(), list_.end());
        } else {
            list_.push_back({distance2, id});
            if (list_.size() < k_)
                return;
            std::make_heap(list_.begin(), list_.end());
        }
        bound = list_.front().distance2;
    }
    size_t finish(uint32_t *ids, float *distances2) const
    {
        for (size_t i = 0; i < list_.size(); i++) {
            ids[i] = list_[i].id;
            distances2[i] = list_[i].distance2;
        }
        return list_.size();
    }
    float bound;

private:
    std::vector<candidate> list_;
    size_t k_ = 0;
};

// All within a bound; counts on where there is no room.
struct plain_list {
    uint32_t *ids;
    size_t capacity, count;
    void add(uint32_t id)
    {
        if (count < capacity)
            ids[count] = id;
        count++;
    }
};

// Bytes in use by malloc, over all its arenas.
inline size_t heap_in_use()
{
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

// Runs make(), which returns a pointer to an index with a member heap_bytes, and measures what it keeps. NULL where it
// throws.
template <class Make> void *measured_build(Make make)
{
    const size_t before = heap_in_use();
    try {
        auto *const index = make();
        const size_t after = heap_in_use();
        index->heap_bytes = after > before ? after - before : 0;
        return index;
    } catch (...) {
        return nullptr;
    }
}

} // namespace pm_peers
#endif
