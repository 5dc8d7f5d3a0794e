#include "surroundings.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = PM__VOXEL_SIDE, LEVELS = PM__VOXEL_LEVELS };

static size_t side_of(int level)
{
    return (size_t)SIDE >> level;
}

/* Voxels, and rows of them, of the levels below. */
static size_t voxels_before(int level)
{
    size_t sum = 0;
    for (int l = 0; l < level; l++)
        sum += side_of(l) * side_of(l) * side_of(l);
    return sum;
}

static size_t rows_before(int level)
{
    size_t sum = 0;
    for (int l = 0; l < level; l++)
        sum += side_of(l) * side_of(l);
    return sum;
}

/* ---- Voxels ------------------------------------------------------------------------------------- */

/* Of the finest. false: it lies outside. */
static bool voxel_of(const pm__voxels *v, const float position[3], size_t voxel[3])
{
    for (int a = 0; a < 3; a++) {
        const float x = (position[a] - v->low[a]) * v->per_edge;
        if (!(x >= 0.0f && x < (float)SIDE))
            return false;
        voxel[a] = (size_t)x;
    }
    return true;
}

static size_t at_level(const size_t voxel[3], int level)
{
    return ((voxel[2] >> level) * side_of(level) + (voxel[1] >> level)) * side_of(level) + (voxel[0] >> level);
}

static uint32_t count_at(const pm__voxels *v, size_t at)
{
    return atomic_load_explicit(&v->counts[at], memory_order_relaxed);
}

pm_status pm__voxels_create(const float low[3], const float high[3], pm__voxels *v)
{
    float widest = 0.0f;
    *v = (pm__voxels){.per_edge = 0.0f};
    for (int a = 0; a < 3; a++)
        widest = fmaxf(widest, high[a] - low[a]);
    const float rim = 0.25f * widest, all = widest + 2.0f * rim;
    for (int a = 0; a < 3; a++)
        v->low[a] = low[a] - rim;
    v->per_edge = all > 0.0f ? (float)SIDE / all : 0.0f;
    v->counts = pm__alloc_zero(voxels_before(LEVELS), sizeof *v->counts);
    v->seeds = pm__alloc_zero(voxels_before(1), sizeof *v->seeds);
    if (v->counts && v->seeds)
        return PM_OK;
    pm__voxels_free(v);
    return PM_ENOMEM;
}

uint32_t pm__voxels_count(pm__voxels *v, const float position[3], bool seed)
{
    size_t voxel[3];
    if (!voxel_of(v, position, voxel))
        return PM__OUTSIDE;
    const size_t at = at_level(voxel, 0);
    atomic_fetch_add_explicit(&v->counts[at], 1, memory_order_relaxed);
    if (seed)
        atomic_store_explicit(&v->seeds[at], 1, memory_order_relaxed);
    return (uint32_t)at;
}

typedef struct gathering {
    pm__voxels *voxels;
    int level;
} gathering;

/* A slice of the level is filled from the one below. */
static void gather_slice(void *argument, size_t z)
{
    const gathering *const g = argument;
    const pm__voxels *const v = g->voxels;
    const size_t side = side_of(g->level), below = voxels_before(g->level - 1), own = voxels_before(g->level);
    for (size_t y = 0; y < side; y++)
        for (size_t x = 0; x < side; x++) {
            uint32_t sum = 0;
            for (size_t part = 0; part < 8; part++) {
                const size_t row = (2 * z + (part >> 2)) * 2 * side + 2 * y + (part >> 1 & 1);
                sum += count_at(v, below + row * 2 * side + 2 * x + (part & 1));
            }
            atomic_store_explicit(&v->counts[own + (z * side + y) * side + x], sum, memory_order_relaxed);
        }
}

void pm__voxels_gather(pm__voxels *v, const pm_parallel *parallel)
{
    for (int level = 1; level < LEVELS; level++) {
        gathering g = {v, level};
        pm__for(level == 1 ? parallel : NULL, side_of(level), gather_slice, &g);
    }
}

void pm__voxels_free(pm__voxels *v)
{
    free((void *)v->counts);
    free((void *)v->seeds);
    *v = (pm__voxels){.per_edge = 0.0f};
}

/* ---- Reach -------------------------------------------------------------------------------------- */

static uint64_t *row_at(pm__reach *reach, int level, size_t y, size_t z)
{
    return &reach->rows[rows_before(level) + z * side_of(level) + y];
}

static void mark_voxel(const pm__voxels *v, const size_t voxel[3], uint32_t enough, pm__reach *reach)
{
    int level = 0;
    while (level < LEVELS - 1 && count_at(v, voxels_before(level) + at_level(voxel, level)) < enough)
        level++;
    *row_at(reach, level, voxel[1] >> level, voxel[2] >> level) |= (uint64_t)1 << (voxel[0] >> level);
}

void pm__reach_mark(const pm__voxels *v, const float position[3], uint32_t enough, pm__reach *reach)
{
    size_t voxel[3];
    if (voxel_of(v, position, voxel))
        mark_voxel(v, voxel, enough, reach);
}

void pm__reach_mark_all(const pm__voxels *v, uint32_t enough, pm__reach *reach)
{
    for (size_t z = 0; z < SIDE; z++)
        for (size_t y = 0; y < SIDE; y++)
            for (size_t x = 0; x < SIDE; x++)
                if (atomic_load_explicit(&v->seeds[(z * SIDE + y) * SIDE + x], memory_order_relaxed))
                    mark_voxel(v, (const size_t[3]){x, y, z}, enough, reach);
}

/* Each row is joined by the two that are next to it, `step` rows off. */
static void join_rows(uint64_t *rows, size_t count, size_t side, size_t step)
{
    uint64_t joined[SIDE * SIDE];
    for (size_t i = 0; i < count; i++) {
        const size_t at = i / step % side;
        joined[i] = rows[i] | (at > 0 ? rows[i - step] : 0) | (at + 1 < side ? rows[i + step] : 0);
    }
    for (size_t i = 0; i < count; i++)
        rows[i] = joined[i];
}

/* Each of 32 bits twice. */
static uint64_t doubled(uint64_t row)
{
    static const uint64_t masks[] = {0x0000ffff0000ffff, 0x00ff00ff00ff00ff, 0x0f0f0f0f0f0f0f0f, 0x3333333333333333,
                                     0x5555555555555555};
    for (int i = 0; i < 5; i++)
        row = (row | row << (16 >> i)) & masks[i];
    return row | row << 1;
}

void pm__reach_spread(pm__reach *reach)
{
    for (int level = LEVELS - 1; level >= 0; level--) {
        const size_t side = side_of(level), count = side * side;
        const uint64_t all = ~(uint64_t)0 >> (64 - side);
        uint64_t *const rows = row_at(reach, level, 0, 0);
        for (size_t i = 0; i < count; i++)
            rows[i] = (rows[i] | rows[i] << 1 | rows[i] >> 1) & all;
        join_rows(rows, count, side, 1);
        join_rows(rows, count, side, side);
    }
    for (int level = LEVELS - 2; level >= 0; level--)
        for (size_t z = 0; z < side_of(level); z++)
            for (size_t y = 0; y < side_of(level); y++)
                *row_at(reach, level, y, z) |= doubled(*row_at(reach, level + 1, y / 2, z / 2));
}
