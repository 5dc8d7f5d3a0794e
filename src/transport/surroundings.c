#include "surroundings.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 64, LEVELS = PM__SURROUNDING_LEVELS };

/* Photons of a voxel of surface whose side is the radius of 50, pi r^2 of them, and some more. */
enum { ENOUGH = 12 };

enum { SEED = 1, NEAR = 2 };

static size_t side_of(int level)
{
    return (size_t)SIDE >> level;
}

/* Voxels of the levels below. */
static size_t before(int level)
{
    size_t sum = 0;
    for (int l = 0; l < level; l++)
        sum += side_of(l) * side_of(l) * side_of(l);
    return sum;
}

/* Of the finest. false: it lies outside. */
static bool voxel_of(const pm__surroundings *s, const float position[3], size_t voxel[3])
{
    for (int a = 0; a < 3; a++) {
        const float x = (position[a] - s->low[a]) * s->per_edge;
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

pm_status pm__surroundings_create(const float low[3], const float high[3], pm__surroundings *s)
{
    float widest = 0.0f;
    *s = (pm__surroundings){.per_edge = 0.0f};
    for (int a = 0; a < 3; a++)
        widest = fmaxf(widest, high[a] - low[a]);
    const float rim = 0.25f * widest, all = widest + 2.0f * rim;
    for (int a = 0; a < 3; a++)
        s->low[a] = low[a] - rim;
    s->per_edge = all > 0.0f ? (float)SIDE / all : 0.0f;
    s->counts = pm__alloc_zero(before(LEVELS), sizeof *s->counts);
    unsigned char *const marked = pm__alloc_zero(before(LEVELS), 1);
    for (int level = 0; level < LEVELS && marked; level++)
        s->marked[level] = marked + before(level);
    if (s->counts && marked)
        return PM_OK;
    pm__surroundings_free(s);
    return PM_ENOMEM;
}

void pm__surroundings_count(pm__surroundings *s, const float position[3])
{
    size_t voxel[3];
    if (voxel_of(s, position, voxel))
        s->counts[at_level(voxel, 0)]++;
}

void pm__surroundings_gather(pm__surroundings *s)
{
    for (int level = 1; level < LEVELS; level++) {
        const uint32_t *const finer = s->counts + before(level - 1);
        uint32_t *const coarse = s->counts + before(level);
        const size_t side = side_of(level - 1);
        for (size_t z = 0; z < side; z++)
            for (size_t y = 0; y < side; y++)
                for (size_t x = 0; x < side; x++)
                    coarse[((z / 2) * (side / 2) + y / 2) * (side / 2) + x / 2] += finer[(z * side + y) * side + x];
    }
}

void pm__surroundings_mark(pm__surroundings *s, const float position[3])
{
    size_t voxel[3];
    int level = 0;
    if (!voxel_of(s, position, voxel))
        return;
    while (level < LEVELS - 1 && s->counts[before(level) + at_level(voxel, level)] < ENOUGH)
        level++;
    s->marked[level][at_level(voxel, level)] = SEED;
}

static void spread_about(unsigned char *marked, size_t side, size_t x, size_t y, size_t z)
{
    for (size_t k = z > 0 ? z - 1 : 0; k <= z + 1 && k < side; k++)
        for (size_t j = y > 0 ? y - 1 : 0; j <= y + 1 && j < side; j++)
            for (size_t i = x > 0 ? x - 1 : 0; i <= x + 1 && i < side; i++)
                marked[(k * side + j) * side + i] |= NEAR;
}

void pm__surroundings_spread(pm__surroundings *s)
{
    for (int level = 0; level < LEVELS; level++) {
        const size_t side = side_of(level);
        for (size_t z = 0; z < side; z++)
            for (size_t y = 0; y < side; y++)
                for (size_t x = 0; x < side; x++)
                    if (s->marked[level][(z * side + y) * side + x] & SEED)
                        spread_about(s->marked[level], side, x, y, z);
    }
}

bool pm__surroundings_hold(const pm__surroundings *s, const float position[3])
{
    size_t voxel[3];
    bool held = false;
    if (!voxel_of(s, position, voxel))
        return false;
    for (int level = 0; level < LEVELS && !held; level++)
        held = s->marked[level][at_level(voxel, level)];
    return held;
}

void pm__surroundings_free(pm__surroundings *s)
{
    free(s->counts);
    free(s->marked[0]);
    *s = (pm__surroundings){.per_edge = 0.0f};
}
