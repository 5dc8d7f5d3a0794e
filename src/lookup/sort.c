/* Neighbours in order. Around a point of a surface d^2 is nearly uniform, so a few hundred neighbours fall into as many
 * buckets about one by one, and no comparison of the sort mispredicts; what crowds in a bucket, and long lists, go to a
 * quicksort, with a heap where the input defeats its pivots. */
#include "lookup.h"

#include "../search/result.h"

#include <string.h>

enum { SHORT_RUN = 16 };

static void insertion_sort(const uint32_t *ids, pm_neighbor *n, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        const pm_neighbor item = n[i];
        size_t j = i;
        for (; j > 0 && pm__farther(ids, n[j - 1], item); j--)
            n[j] = n[j - 1];
        n[j] = item;
    }
}

static void heap_sort(const uint32_t *ids, pm_neighbor *n, size_t count)
{
    pm__result heap = {.list = n, .count = count, .capacity = count, .ids = ids};
    for (size_t i = count / 2; i-- > 0;)
        pm__sift_down(&heap, i, n[i]);
    while (heap.count > 1) {
        const pm_neighbor farthest = n[0], item = n[--heap.count];
        pm__sift_down(&heap, 0, item);
        n[heap.count] = farthest;
    }
}

static pm_neighbor median(const uint32_t *ids, pm_neighbor a, pm_neighbor b, pm_neighbor c)
{
    if (pm__farther(ids, b, a))
        return pm__farther(ids, c, b) ? b : pm__farther(ids, c, a) ? c : a;
    return pm__farther(ids, c, a) ? a : pm__farther(ids, c, b) ? c : b;
}

static void quick_sort(const uint32_t *ids, pm_neighbor *n, size_t count, unsigned budget)
{
    while (count > SHORT_RUN) {
        if (!budget--) {
            heap_sort(ids, n, count);
            return;
        }
        const pm_neighbor pivot = median(ids, n[0], n[count / 2], n[count - 1]);
        size_t i = 0, j = count - 1;
        for (;; i++, j--) {
            while (pm__farther(ids, pivot, n[i]))
                i++;
            while (pm__farther(ids, n[j], pivot))
                j--;
            if (i >= j)
                break;
            const pm_neighbor t = n[i];
            n[i] = n[j];
            n[j] = t;
        }
        /* [0, i) is not farther than the pivot, [i, count) not nearer; neither part is empty. */
        quick_sort(ids, n, i, budget);
        n += i;
        count -= i;
    }
    insertion_sort(ids, n, count);
}

enum { BUCKETS = 512 };

/* Two passes: count, then place. Buckets are ranges of distance2, so only order within them is left. */
static void bucket_sort(const uint32_t *ids, pm_neighbor *n, size_t count, float farthest)
{
    pm_neighbor placed[BUCKETS];
    uint16_t start[BUCKETS + 1] = {0}, bucket[BUCKETS];
    const float scale = (float)(count - 1) / farthest;
    for (size_t i = 0; i < count; i++) {
        bucket[i] = (uint16_t)(n[i].distance2 * scale);
        start[bucket[i]]++;
    }
    uint16_t before = 0;
    for (size_t b = 0; b <= count; b++) {
        const uint16_t here = start[b];
        start[b] = before;
        before = (uint16_t)(before + here);
    }
    for (size_t i = 0; i < count; i++)
        placed[start[bucket[i]]++] = n[i];
    for (size_t b = 0, from = 0; b < count; b++) { /* start[b] is now where the bucket ends */
        if (start[b] - from > 1)
            quick_sort(ids, placed + from, start[b] - from, 64);
        from = start[b];
    }
    memcpy(n, placed, count * sizeof *n);
}

void pm__sort_neighbors(const pm_map *map, pm_neighbor *neighbors, size_t count)
{
    float farthest = 0.0f;
    for (size_t i = 0; i < count; i++)
        farthest = neighbors[i].distance2 > farthest ? neighbors[i].distance2 : farthest;
    /* (count-1)/farthest must be finite, and no product may reach count */
    if (count > SHORT_RUN && count <= BUCKETS && farthest > 1e-30f)
        bucket_sort(map->ids, neighbors, count, farthest);
    else
        quick_sort(map->ids, neighbors, count, 64);
}
