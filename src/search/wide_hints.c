/* Hints of where to begin and how wide: map/wide.h says what they are. */
#include "wide.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../map/bulk.h"
#include "../map/wide.h"

#include <stdlib.h>
#include <string.h>

enum {
    MINIMUM = 1 << 16, /* photons: below, the tree is low and a map is often searched less than it would pay for */
    BLOCKS_A_CELL = 2, /* where there are photons */
    MOST_ALONG = 1 << 23, /* cells, of which a float can number all */
    SAMPLE = 1024,
    CHUNK = 256
};

static void middle_photon(const pm_map *map, size_t block, float position[3])
{
    const size_t first = block * PM__LANES, last = map->count - 1, middle = first + PM__LANES / 2;
    pm__position(map, middle < last ? middle : last, position);
}

/* The range of the bulk of the photons along each axis, of a sample: outliers make no cell larger. */
static void frame(const pm_map *map, float low[3], float extent[3])
{
    for (int a = 0; a < 3; a++) {
        float sample[SAMPLE];
        for (size_t i = 0; i < SAMPLE; i++) {
            float position[3];
            middle_photon(map, i * map->block_count / SAMPLE, position);
            sample[i] = position[a];
        }
        float from, to;
        pm__bulk(sample, SAMPLE, &from, &to);
        low[a] = from - 0.01f * (to - from);
        extent[a] = 1.02f * (to - from);
    }
}

/* At most `limit` cubes; none so small that squared distances in it are 0, for searches there would find everything. */
static void choose_cells(pm__hints *hints, const float low[3], const float extent[3], size_t limit)
{
    const float longest = fmaxf(extent[0], fmaxf(extent[1], extent[2]));
    float along = fminf((float)(limit < MOST_ALONG ? limit : MOST_ALONG), longest * 1e18f); /* the longest axis */
    for (int step = 0; step < 200; step++, along *= 0.93f) {
        double count = 1.0;
        for (int a = 0; a < 3; a++) {
            const float cells = longest > 0.0f ? floorf(along * (extent[a] / longest)) + 1.0f : 1.0f;
            hints->low[a] = low[a];
            hints->last[a] = cells - 1.0f;
            hints->stride[a] = (size_t)count;
            count *= (double)cells;
        }
        hints->count = (size_t)count;
        hints->inverse_edge = longest > 0.0f && isfinite(along / longest) ? along / longest : 0.0f;
        if (count <= (double)limit)
            return;
    }
}

/* Each cell gets the last block whose middle photon is there. Returns how many do. */
static size_t name_blocks(const pm_map *map, const pm__hints *hints)
{
    size_t filled = 0;
    for (size_t c = 0; c < hints->count; c++)
        hints->cells[c] = (pm__hint){.block = PM__HINT_NONE};
    for (size_t block = 0; block < map->block_count; block++) {
        float position[3];
        middle_photon(map, block, position);
        pm__hint *const hint = &hints->cells[pm__hint_at(hints, position) - hints->cells];
        filled += hint->block < 0;
        hint->block = (int32_t)block;
    }
    return filled;
}

typedef struct hinting {
    const pm_map *map;
    pm__hints *hints;
} hinting;

/* log2 of the squared radius about a block's middle photon that holds k; -126 for 0. */
static float log_radius2(const pm_map *map, size_t block, size_t k)
{
    pm_neighbor list[PM__HINT_FAR];
    pm__query query = {.k = k, .max_distance2 = 3.4e38f, .prune_scale = 1.0f, .shape = PM_LOOKUP_SPHERE};
    pm__result result = {.list = list, .capacity = k, .bound = query.max_distance2, .ids = map->ids};
    middle_photon(map, block, query.position);
    map->search->find(map, &query, &result);
    float most[4] = {0.0f}; /* four chains of comparisons, since one would take longer than the search */
    for (size_t i = 0; i < result.count; i++)
        most[i % 4] = list[i].distance2 > most[i % 4] ? list[i].distance2 : most[i % 4];
    const float farthest = fmaxf(fmaxf(most[0], most[1]), fmaxf(most[2], most[3]));
    return farthest > 0.0f ? fmaxf(log2f(farthest), -126.0f) : -126.0f;
}

/* Where PM__HINT_NEAR photons are in one place, what is about it decides. */
static void hint_task(void *argument, size_t chunk)
{
    const hinting *const h = argument;
    for (size_t c = chunk * CHUNK; c < h->hints->count && c < (chunk + 1) * CHUNK; c++) {
        pm__hint *const hint = &h->hints->cells[c];
        if (hint->block < 0)
            continue;
        const float far = log_radius2(h->map, (size_t)hint->block, PM__HINT_FAR);
        const float near = fmaxf(log_radius2(h->map, (size_t)hint->block, PM__HINT_NEAR), far - 20.0f);
        hint->log_far = (int16_t)lrintf(far * PM__HINT_STEPS);
        hint->log_near = (int16_t)lrintf(near * PM__HINT_STEPS);
    }
}

/* The cells beside a cell, at most 6. */
static size_t beside(const pm__hints *hints, size_t cell, size_t to[6])
{
    const size_t end[3] = {hints->stride[1], hints->stride[2], hints->count};
    size_t count = 0;
    for (int a = 0; a < 3; a++) {
        const size_t along = cell % end[a], stride = hints->stride[a];
        if (along >= stride)
            to[count++] = cell - stride;
        if (along + stride < end[a])
            to[count++] = cell + stride;
    }
    return count;
}

/* Makes hints the mean of those around, since each is as uncertain as 64 photons are; cells beside one that has a hint
 * get one, since surfaces run along borders and not every cell of a surface has the middle of a block. */
static pm_status smooth(pm__hints *hints)
{
    pm__hint *const before = pm__alloc(hints->count, sizeof *before);
    if (!before)
        return PM_ENOMEM;
    memcpy(before, hints->cells, hints->count * sizeof *before);
    for (size_t c = 0; c < hints->count; c++) {
        pm__hint *const hint = &hints->cells[c];
        size_t cells[6];
        const size_t around = beside(hints, c, cells);
        int weight = hint->block >= 0 ? 2 : 0, near = weight * hint->log_near, far = weight * hint->log_far;
        for (size_t i = 0; i < around; i++) {
            const pm__hint *const other = &before[cells[i]];
            if (other->block < 0)
                continue;
            near += other->log_near;
            far += other->log_far;
            weight++;
            hint->block = hint->block < 0 ? other->block : hint->block;
        }
        if (weight) {
            hint->log_near = (int16_t)(near / weight);
            hint->log_far = (int16_t)(far / weight);
        }
    }
    free(before);
    return PM_OK;
}

pm_status pm__wide_hint(const pm_map *map, const pm_parallel *parallel)
{
    if (map->count < MINIMUM)
        return PM_OK;
    pm__wide *const wide = map->index[PM__WIDE];
    pm__hints hints = {.cells = NULL};
    float low[3], extent[3];
    const size_t most = map->count / 8;
    hints.cells = pm__alloc(most, sizeof *hints.cells);
    if (!hints.cells)
        return PM_ENOMEM;
    frame(map, low, extent);
    for (size_t limit = most; limit; limit /= 2) {
        choose_cells(&hints, low, extent, limit);
        if (name_blocks(map, &hints) * BLOCKS_A_CELL <= map->block_count)
            break;
    }
    pm__hint *const fitting = realloc(hints.cells, hints.count * sizeof *hints.cells);
    hints.cells = fitting ? fitting : hints.cells;
    hinting h = {map, &hints};
    pm__for(parallel, (hints.count + CHUNK - 1) / CHUNK, hint_task, &h);
    const pm_status status = smooth(&hints);
    if (status == PM_OK)
        wide->hints = hints;
    else
        free(hints.cells);
    return status;
}
