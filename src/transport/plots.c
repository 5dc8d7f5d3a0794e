#include "plots.h"

#include "../base/memory.h"
#include "cone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A key: level, class, importance, then the cell: along the two axes across, and along the class. */
enum { LEVEL_BITS = 4, CONE_BITS = 6, ACROSS_BITS = 17, ALONG_BITS = 19 };

/* Cells on each axis, so that numbers never overlap. */
enum { MOST_CELLS = 1 << (ACROSS_BITS - 1), ALONG_HALF = 1 << (ALONG_BITS - 1) };

_Static_assert(ACROSS_BITS + ACROSS_BITS + ALONG_BITS == PM__PLOT_IMPORTANT_AT, "the key's bits");

enum { FIRST_SIZE = 512 };

/* Levels above the usual one that can share a shard: a square of the last holds some 40 photons. */
enum { MOST_COMMON = 1 };

/* In the middle of a level: required densities there are another's only by more than this factor. */
static const float middle = 1.2f;

/* Of the photons wanted: what is rounded shall not ask for one more. */
static const float less = 1.0f - 1e-5f;

/* ---- Places ------------------------------------------------------------------------------------- */

static pm_status create_shards(pm__plots *plots)
{
    for (int i = 0; i < PM__PLOT_SHARDS; i++) {
        pm__plot_shard *const shard = &plots->shards[i];
        shard->plots = pm__alloc_zero(FIRST_SIZE, sizeof *shard->plots);
        shard->light = plots->lit ? pm__alloc_zero(FIRST_SIZE, sizeof *shard->light) : NULL;
        shard->size = FIRST_SIZE;
        if (!shard->plots || (plots->lit && !shard->light))
            return PM_ENOMEM;
    }
    return PM_OK;
}

/* From half of the usual density up to twice it the usual level, then one for each factor of four. fill: how much of
 * the density in the middle of the level it is, in [1/2, 2) for levels that there are. */
static inline int level_of(const pm__plots *plots, float required, float *fill)
{
    const float ratio = required / plots->usual;
    uint32_t bits;
    memcpy(&bits, &ratio, sizeof bits);
    const int above = ((int)(bits >> 23) - 126) >> 1, level = PM__PLOT_USUAL - above;
    bits -= (uint32_t)(2 * above) << 23;
    memcpy(fill, &bits, sizeof *fill);
    return level < plots->least ? plots->least : level > plots->most ? plots->most : level;
}

/* The level of the usual density is that in the middle; other levels only while cells can be told apart, and are no
 * larger than the scene. A third of a square is off the lines of all levels, as of those through the corner. */
pm_status pm__plots_init(pm__plots *plots, double neighbors, double usual, double least, const double low[3],
                         double across, bool lit)
{
    const double finest = across / MOST_CELLS;
    const double edge = fmax(finest, fmin(sqrt(0.5 * neighbors / usual), across));
    float fill;
    *plots = (pm__plots){.usual = (float)usual, .lit = lit};
    plots->least = plots->most = PM__PLOT_USUAL;
    for (int a = 0; a < 3; a++)
        plots->low[a] = (float)low[a];
    for (int level = 0; level < PM__PLOT_LEVELS; level++) {
        const double own = ldexp(edge, level - PM__PLOT_USUAL);
        plots->per_edge[level] = (float)(1.0 / own);
        plots->area[level] = (float)(own * own);
        plots->least -= level < PM__PLOT_USUAL && own >= finest;
        plots->most += level > PM__PLOT_USUAL && own <= 2.0 * across;
    }
    plots->common = level_of(plots, (float)least, &fill);
    if (plots->common > PM__PLOT_USUAL + MOST_COMMON)
        plots->common = PM__PLOT_USUAL + MOST_COMMON;
    plots->offset = (float)(ldexp(edge, plots->common - PM__PLOT_USUAL) / 3.0);
    return create_shards(plots);
}

/* In [0, most]. */
static inline float bounded(float x, float most)
{
    return x > 0.0f ? x < most ? x : most : 0.0f;
}

static inline __attribute__((always_inline)) pm__plot_place place_at(const pm__plots *plots, const float position[3],
                                                                     const pm__cone *cone, int level, bool important)
{
    static const float slope[PM__CONE_STEPS] = {-2.0f / PM__CONE_STEPS, 0.0f, 2.0f / PM__CONE_STEPS};
    static const float most = 2.0f * MOST_CELLS - 1.0f;
    const int u = (cone->axis + 1) % 3, v = (cone->axis + 2) % 3;
    const float scale = plots->per_edge[level], offset = plots->offset * scale;
    const float w = (position[cone->axis] - plots->low[cone->axis]) * scale;
    const float x = (position[u] - plots->low[u]) * scale, y = (position[v] - plots->low[v]) * scale;
    const float along = (cone->face & 1 ? -w : w) + slope[cone->u] * x + slope[cone->v] * y;
    const float in[2] = {bounded(x + offset, most), bounded(y + offset, most)};
    const uint64_t cells[2] = {(uint64_t)(int64_t)in[0], (uint64_t)(int64_t)in[1]};
    pm__plot_place place = {.area = plots->area[level]};
    place.key = (uint64_t)level << CONE_BITS | (pm__cone_number(cone) + 1);
    place.key = place.key << 1 | important;
    for (int i = 0; i < 2; i++) {
        place.key = place.key << ACROSS_BITS | cells[i];
        place.at[i] = (uint8_t)(int)((in[i] - (float)cells[i]) * 256.0f);
    }
    place.key = place.key << ALONG_BITS |
                (uint64_t)(int64_t)bounded(along + offset + (float)ALONG_HALF, 2.0f * ALONG_HALF - 1.0f);
    return place;
}

/* By the square of the common level that it lies in, or its own if that is larger. */
size_t pm__plot_shard_of(const pm__plots *plots, uint64_t key)
{
    const uint64_t across = ((uint64_t)1 << ACROSS_BITS) - 1;
    const int level = (int)(key >> (64 - LEVEL_BITS)), up = level < plots->common ? plots->common - level : 0;
    const uint64_t x = (key >> (ACROSS_BITS + ALONG_BITS) & across) >> up, y = (key >> ALONG_BITS & across) >> up;
    return (size_t)(pm__plot_hash(x << 32 | y << 8 | (key >> PM__PLOT_IMPORTANT_AT & 0x7e)) >>
                    (64 - PM__PLOT_SHARD_BITS));
}

void pm__plots_place(const pm__plots *plots, const pm_photon *photons, const float (*normals)[3],
                     const float *required, const unsigned char *important, size_t count, pm__plot_place *places)
{
    for (size_t i = 0; i < count; i++) {
        const pm__cone cone = pm__cone_at(normals[i]);
        float fill;
        const int level = level_of(plots, required[i], &fill);
        places[i] = place_at(plots, photons[i].position, &cone, level, important[i]);
        places[i].area /= fabsf(normals[i][cone.axis]);
        places[i].wanted = required[i] * places[i].area * less;
    }
}

/* Only in one of the same shard. */
uint64_t pm__plot_beside(const pm__plots *plots, const float position[3], const float normal[3], float required,
                         bool important)
{
    float fill;
    const int level = level_of(plots, required, &fill), beside = fill > 1.0f ? level - 1 : level + 1;
    if (beside < plots->least || beside > plots->common || level > plots->common ||
        (fill < middle && fill * middle > 1.0f))
        return 0;
    const pm__cone cone = pm__cone_at(normal);
    return place_at(plots, position, &cone, beside, important).key;
}

bool pm__plot_faces(uint64_t key, const float direction[3])
{
    static const float slope[PM__CONE_STEPS] = {-2.0f / PM__CONE_STEPS, 0.0f, 2.0f / PM__CONE_STEPS};
    const uint32_t cone = (uint32_t)(key >> (PM__PLOT_IMPORTANT_AT + 1) & ((1 << CONE_BITS) - 1)) - 1;
    const uint32_t face = cone / (PM__CONE_STEPS * PM__CONE_STEPS), axis = face / 2;
    const float along = face & 1 ? -direction[axis] : direction[axis];
    return along + slope[cone / PM__CONE_STEPS % PM__CONE_STEPS] * direction[(axis + 1) % 3] +
               slope[cone % PM__CONE_STEPS] * direction[(axis + 2) % 3] < 0.0f;
}

/* ---- Tables ------------------------------------------------------------------------------------- */

static pm_status enlarge(pm__plot_shard *shard)
{
    pm__plot_shard larger = {.size = 2 * shard->size, .count = shard->count};
    larger.plots = pm__alloc_zero(larger.size, sizeof *larger.plots);
    larger.light = shard->light ? pm__alloc_zero(larger.size, sizeof *larger.light) : NULL;
    if (!larger.plots || (shard->light && !larger.light)) {
        pm__plot_shard_free(&larger);
        return PM_ENOMEM;
    }
    for (size_t i = 0; i < shard->size; i++) {
        if (!shard->plots[i].key)
            continue;
        pm__plot *const to = pm__plot_find(&larger, shard->plots[i].key);
        memcpy(to, &shard->plots[i], sizeof *to);
        if (larger.light)
            larger.light[to - larger.plots] = shard->light[i];
    }
    pm__plot_shard_free(shard);
    *shard = larger;
    return PM_OK;
}

pm__plot *pm__plot_add(pm__plots *plots, size_t number, uint64_t key)
{
    pm__plot_shard *const shard = &plots->shards[number];
    if (2 * (shard->count + 1) > shard->size && enlarge(shard))
        return NULL;
    pm__plot *const plot = pm__plot_find(shard, key);
    if (!plot->key) {
        shard->count++;
        *plot = (pm__plot){.key = key, .box = {UINT8_MAX, 0, UINT8_MAX, 0}};
    }
    return plot;
}

pm_status pm__plot_shard_copy(const pm__plot_shard *shard, pm__plot_shard *to)
{
    pm__plot_shard copy = *shard;
    copy.plots = pm__alloc(shard->size, sizeof *copy.plots);
    copy.light = shard->light ? pm__alloc(shard->size, sizeof *copy.light) : NULL;
    *to = copy;
    if (!copy.plots || (shard->light && !copy.light))
        return PM_ENOMEM;
    memcpy(copy.plots, shard->plots, shard->size * sizeof *copy.plots);
    if (copy.light)
        memcpy(copy.light, shard->light, shard->size * sizeof *copy.light);
    return PM_OK;
}

void pm__plot_shard_free(pm__plot_shard *shard)
{
    free(shard->plots);
    free(shard->light);
    *shard = (pm__plot_shard){0};
}

void pm__plots_free(pm__plots *plots)
{
    for (int i = 0; i < PM__PLOT_SHARDS; i++)
        pm__plot_shard_free(&plots->shards[i]);
}
