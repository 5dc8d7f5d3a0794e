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

enum { FIRST_SIZE = 64 };

/* Of an edge: so that planes through the corner, or through multiples of an edge, are not cut by what is rounded. */
static const float offset = 0.37f;

/* Of the photons wanted: what is rounded shall not ask for one more. */
static const float less = 1.0f - 1e-5f;

/* ---- Places ------------------------------------------------------------------------------------- */

/* The level of the usual density is that in the middle; other levels only while cells can be told apart, and are no
 * larger than the scene. */
pm_status pm__plots_init(pm__plots *plots, double neighbors, double usual, const double low[3], double across,
                         bool lit)
{
    const double finest = across / MOST_CELLS;
    const double edge = fmax(finest, fmin(sqrt(0.5 * neighbors / usual), across));
    *plots = (pm__plots){.neighbors = (float)neighbors, .usual = (float)usual, .lit = lit};
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
    for (int i = 0; i < PM__PLOT_SHARDS; i++) {
        pm__plot_shard *const shard = &plots->shards[i];
        shard->plots = pm__alloc_zero(FIRST_SIZE, sizeof *shard->plots);
        shard->light = lit ? pm__alloc_zero(FIRST_SIZE, sizeof *shard->light) : NULL;
        shard->size = FIRST_SIZE;
        if (!shard->plots || (lit && !shard->light))
            return PM_ENOMEM;
    }
    return PM_OK;
}

/* From half of the usual density up to twice it the usual level, then one for each factor of four. */
static int level_of(const pm__plots *plots, float required)
{
    const float ratio = required / plots->usual;
    uint32_t bits;
    memcpy(&bits, &ratio, sizeof bits);
    const int exponent = (int)(bits >> 23) - 127, level = PM__PLOT_USUAL - ((exponent + 1) >> 1);
    return level < plots->least ? plots->least : level > plots->most ? plots->most : level;
}

/* What is rounded is in [0, most]. */
static uint64_t number_of(float x, float most)
{
    return (uint64_t)(int64_t)fmaxf(0.0f, fminf(x, most));
}

pm__plot_place pm__plot_place_of(const pm__plots *plots, const float position[3], const float normal[3],
                                 float required, bool important)
{
    static const float slope[PM__CONE_STEPS] = {-2.0f / PM__CONE_STEPS, 0.0f, 2.0f / PM__CONE_STEPS};
    const pm__cone cone = pm__cone_at(normal);
    const int level = level_of(plots, required), u = (cone.axis + 1) % 3, v = (cone.axis + 2) % 3;
    const float scale = plots->per_edge[level], area = plots->area[level] / fabsf(normal[cone.axis]);
    const float w = (position[cone.axis] - plots->low[cone.axis]) * scale;
    const float x = (position[u] - plots->low[u]) * scale, y = (position[v] - plots->low[v]) * scale;
    const float along = (cone.face & 1 ? -w : w) + slope[cone.u] * x + slope[cone.v] * y;
    uint64_t key = (uint64_t)level << CONE_BITS | (pm__cone_number(&cone) + 1);
    key = key << 1 | important;
    key = key << ACROSS_BITS | number_of(x + offset, 2.0f * MOST_CELLS - 1.0f);
    key = key << ACROSS_BITS | number_of(y + offset, 2.0f * MOST_CELLS - 1.0f);
    key = key << ALONG_BITS | number_of(along + offset + (float)ALONG_HALF, 2.0f * ALONG_HALF - 1.0f);
    return (pm__plot_place){key, required * area * less, area};
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
    shard->count += !plot->key;
    plot->key = key;
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
