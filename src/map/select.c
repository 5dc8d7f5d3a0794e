/* Selection by rank in the total order (coordinate, id). */
#include "map.h"

#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { SMALL = 24 /* ranges up to this are sorted by insertion */ };

static inline bool before(const pm__item *a, const pm__item *b, unsigned axis)
{
    const float x = a->position[axis], y = b->position[axis];
    return x < y || (x == y && a->id < b->id);
}

static inline void swap(pm__item *a, pm__item *b)
{
    const pm__item t = *a;
    *a = *b;
    *b = t;
}

static void insertion_sort(pm__item *nodes, size_t count, unsigned axis)
{
    for (size_t i = 1; i < count; i++) {
        const pm__item item = nodes[i];
        size_t j = i;
        for (; j > 0 && before(&item, &nodes[j - 1], axis); j--)
            nodes[j] = nodes[j - 1];
        nodes[j] = item;
    }
}

static void heap_sink(pm__item *nodes, size_t i, size_t count, unsigned axis)
{
    for (size_t child = 2 * i + 1; child < count; i = child, child = 2 * i + 1) {
        if (child + 1 < count && before(&nodes[child], &nodes[child + 1], axis))
            child++;
        if (!before(&nodes[i], &nodes[child], axis))
            return;
        swap(&nodes[i], &nodes[child]);
    }
}

static void heap_sort(pm__item *nodes, size_t count, unsigned axis)
{
    for (size_t i = count / 2; i-- > 0;)
        heap_sink(nodes, i, count, axis);
    for (size_t end = count; end-- > 1;) {
        swap(&nodes[0], &nodes[end]);
        heap_sink(nodes, 0, end, axis);
    }
}

static const pm__item *median_of_three(const pm__item *a, const pm__item *b, const pm__item *c, unsigned axis)
{
    if (before(a, b, axis))
        return before(b, c, axis) ? b : before(a, c, axis) ? c : a;
    return before(a, c, axis) ? a : before(b, c, axis) ? c : b;
}

/* A pivot a little beyond the wanted rank, on the side where more lies: from a sorted sample, at the rank's own place
 * in it less or more one standard deviation. One pass then cuts off the far side, a second all but a few (Floyd &
 * Rivest 1975 in spirit). */
static pm__item sampled_pivot(const pm__item *items, size_t count, size_t rank, unsigned axis)
{
    enum { SAMPLE = 96 };
    pm__item sample[SAMPLE];
    uint64_t state = 0x9e3779b97f4a7c15u;
    for (size_t i = 0; i < SAMPLE; i++) { /* one in each stratum, at a place that no pattern of the input knows */
        state = state * 6364136223846793005u + 1442695040888963407u;
        const size_t from = i * count / SAMPLE, width = (i + 1) * count / SAMPLE - from;
        sample[i] = items[from + (size_t)(state >> 33) % width];
    }
    insertion_sort(sample, SAMPLE, axis);
    const size_t place = rank * SAMPLE / count;
    const size_t lower = place < SAMPLE - place ? place : SAMPLE - place;
    const size_t step = 2 + (lower > 24 ? 6 : lower > 8 ? 4 : 2);
    if (2 * rank > count)
        return sample[place > step ? place - step : 0];
    return sample[place + step < SAMPLE ? place + step : SAMPLE - 1];
}

static pm__item pick_pivot(const pm__item *items, size_t count, size_t rank, unsigned axis)
{
    if (count > 1024)
        return sampled_pivot(items, count, rank, axis);
    return *median_of_three(&items[0], &items[count / 2], &items[count - 1], axis);
}

/* (coordinate, id) as one integer in the same order: a float's bits are, but for the sign. No coordinate is -0. */
static inline int64_t key_of(const pm__item *item, unsigned axis)
{
    int32_t bits;
    memcpy(&bits, &item->position[axis], sizeof bits);
    bits ^= bits >> 31 & 0x7fffffff;
    return (int64_t)((uint64_t)(uint32_t)bits << 32 | item->id);
}

/* In one piece: a load that spans smaller stores just made would wait for them. */
static inline void swap_whole(pm__item *a, pm__item *b)
{
#ifdef __SSE2__
    const __m128i x = _mm_loadu_si128((const __m128i *)(const void *)a);
    const __m128i y = _mm_loadu_si128((const __m128i *)(const void *)b);
    _mm_storeu_si128((__m128i *)(void *)a, y);
    _mm_storeu_si128((__m128i *)(void *)b, x);
#else
    swap(a, b);
#endif
}

/* Items not after the pivot to the front; returns how many. Without branches on the data, whose outcome no processor
 * can guess: Lomuto's scheme, every item swapped, the border moved by the comparison. */
static size_t partition(pm__item *items, size_t count, pm__item pivot, unsigned axis)
{
    const int64_t last = key_of(&pivot, axis);
    size_t border = 0;
    for (size_t i = 0; i < count; i++) {
        const bool left = key_of(&items[i], axis) <= last;
        swap_whole(&items[i], &items[border]);
        border += left;
    }
    return border;
}

/* Quickselect; input that defeats the pivots is sorted by a heap instead, so the cost stays O(n log n) for any
 * input. */
void pm__select_rank(pm__item *items, size_t count, size_t rank, unsigned axis)
{
    for (unsigned budget = 64; count > SMALL; budget--) {
        if (!budget) {
            heap_sort(items, count, axis);
            return;
        }
        const size_t left = partition(items, count, pick_pivot(items, count, rank, axis), axis);
        if (left == count) { /* the pivot is the last of all: set it apart, so that every pass gets somewhere */
            size_t last = 0;
            for (size_t i = 1; i < count; i++)
                if (before(&items[last], &items[i], axis))
                    last = i;
            swap(&items[last], &items[count - 1]);
            if (rank == count - 1)
                return;
            count--;
        } else if (rank < left) {
            count = left;
        } else {
            items += left;
            count -= left;
            rank -= left;
        }
    }
    insertion_sort(items, count, axis);
}
