#include "plots.h"

#include "../base/memory.h"
#include "cone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells on each axis, so that numbers never overlap. */
enum { MOST_CELLS = 1 << (PM__PLOT_ACROSS_BITS - 1) };

/* Of each shard's table at first: one plot for each photon sent is about what little light makes; where there is much
 * the table grows. */
enum { LEAST_SIZE = 128, MOST_FIRST = 2048 };

/* Levels above the usual one that can share a shard: a square of the last holds some 40 photons. */
enum { MOST_COMMON = 1 };

/* ---- Places ------------------------------------------------------------------------------------- */

static size_t first_size(uint64_t photons)
{
    size_t size = LEAST_SIZE;
    while (size < MOST_FIRST && size < photons / PM__PLOT_SHARDS)
        size *= 2;
    return size;
}

/* From half of the usual density up to twice it the usual level, then one for each factor of four. fill: how much of
 * the density in the middle of the level it is, in [1/2, 2) for levels that there are. */
static int level_of(const pm__plot_frame *f, float required, float *fill)
{
    const float ratio = required / f->usual;
    uint32_t bits;
    memcpy(&bits, &ratio, sizeof bits);
    const int above = ((int)(bits >> 23) - 126) >> 1, level = PM__PLOT_USUAL - above;
    bits -= (uint32_t)(2 * above) << 23;
    memcpy(fill, &bits, sizeof *fill);
    return level < f->least ? f->least : level > f->most ? f->most : level;
}

/* The level of the usual density is that in the middle; other levels only while cells can be told apart, and are no
 * larger than the scene. A third of a square is off the lines of all levels, as of those through the corner. */
void pm__plots_init(pm__plots *plots, double neighbors, double usual, double least, const double low[3], double across,
                    uint64_t photons, bool lit)
{
    const double finest = across / MOST_CELLS;
    const double edge = fmax(finest, fmin(sqrt(0.5 * neighbors / usual), across));
    pm__plot_frame *const f = &plots->frame;
    float fill;
    *plots = (pm__plots){.lanes = pm__lanes_choose(), .lit = lit, .first_size = first_size(photons)};
    *f = (pm__plot_frame){.per_edge = (float)(1.0 / edge), .area = (float)(edge * edge), .usual = (float)usual,
                          .least = PM__PLOT_USUAL, .most = PM__PLOT_USUAL};
    for (int a = 0; a < 3; a++)
        f->low[a] = (float)low[a];
    for (int level = 0; level < PM__PLOT_LEVELS; level++) {
        const double own = ldexp(edge, level - PM__PLOT_USUAL);
        f->least -= level < PM__PLOT_USUAL && own >= finest;
        f->most += level > PM__PLOT_USUAL && own <= 2.0 * across;
    }
    f->common = level_of(f, (float)least, &fill);
    if (f->common > PM__PLOT_USUAL + MOST_COMMON)
        f->common = PM__PLOT_USUAL + MOST_COMMON;
    f->offset = (float)(ldexp(edge, f->common - PM__PLOT_USUAL) / 3.0);
}

static void take_points(const pm_photon *photons, const float (*normals)[3], const float *required,
                        const unsigned char *important, size_t count, pm__plot_points *points)
{
    for (size_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            points->position[a][i] = photons[i].position[a];
            points->normal[a][i] = normals[i][a];
        }
        points->required[i] = required[i];
        points->important[i] = important[i];
    }
    for (size_t i = count; i < PM__LANE_POINTS; i++) {
        for (int a = 0; a < 3; a++)
            points->position[a][i] = points->normal[a][i] = 0.0f;
        points->required[i] = 1.0f;
        points->important[i] = 0;
    }
}

void pm__plots_place(const pm__plots *plots, const pm_photon *photons, const float (*normals)[3],
                     const float *required, const unsigned char *important, size_t count, pm__plot_place *places)
{
    pm__plot_points points;
    for (size_t first = 0; first < count; first += PM__LANE_POINTS) {
        const size_t rest = count - first, some = rest < PM__LANE_POINTS ? rest : PM__LANE_POINTS;
        take_points(photons + first, normals + first, required + first, important + first, some, &points);
        plots->lanes->cut_plots(&plots->frame, &points);
        for (size_t i = 0; i < some; i++)
            places[first + i] = (pm__plot_place){.key = points.key[i],
                                                 .beside = points.beside[i],
                                                 .wanted = points.wanted[i],
                                                 .area = points.area[i],
                                                 .at = {(uint8_t)points.at[0][i], (uint8_t)points.at[1][i]},
                                                 .shard = (uint8_t)points.shard[i]};
    }
}

/* By the square of the common level that it lies in, or its own if that is larger. */
size_t pm__plot_shard_of(const pm__plots *plots, uint64_t key)
{
    const uint64_t across = ((uint64_t)1 << PM__PLOT_ACROSS_BITS) - 1;
    const int level = (int)(key >> (64 - PM__PLOT_LEVEL_BITS)), common = plots->frame.common;
    const int up = level < common ? common - level : 0;
    const uint64_t x = (key >> (PM__PLOT_ACROSS_BITS + PM__PLOT_ALONG_BITS) & across) >> up;
    const uint64_t y = (key >> PM__PLOT_ALONG_BITS & across) >> up;
    return (size_t)(pm__plot_hash(x << 32 | y << 8 | (key >> PM__PLOT_IMPORTANT_AT & 0x7e)) >>
                    (64 - PM__PLOT_SHARD_BITS));
}

/* ---- Tables ------------------------------------------------------------------------------------- */

static pm_status create(size_t size, bool lit, pm__plot_shard *shard)
{
    *shard = (pm__plot_shard){.size = size, .plots = pm__alloc_zero(size, sizeof *shard->plots)};
    shard->light = lit ? pm__alloc_zero(size, sizeof *shard->light) : NULL;
    if (shard->plots && (shard->light || !lit))
        return PM_OK;
    pm__plot_shard_free(shard);
    return PM_ENOMEM;
}

static pm_status enlarge(pm__plot_shard *shard)
{
    pm__plot_shard larger;
    if (create(2 * shard->size, shard->light, &larger))
        return PM_ENOMEM;
    larger.count = shard->count;
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

/* Tables are made by who is about to work on them. */
pm__plot *pm__plot_add(pm__plots *plots, size_t number, uint64_t key)
{
    pm__plot_shard *const shard = &plots->shards[number];
    if (!shard->plots && create(plots->first_size, plots->lit, shard))
        return NULL;
    pm__plot *plot = pm__plot_find(shard, key);
    if (plot->key)
        return plot;
    if (2 * (shard->count + 1) > shard->size) {
        if (enlarge(shard))
            return NULL;
        plot = pm__plot_find(shard, key);
    }
    shard->count++;
    *plot = (pm__plot){.key = key, .box = {UINT8_MAX, 0, UINT8_MAX, 0}};
    return plot;
}

pm_status pm__plot_shard_copy(const pm__plot_shard *shard, pm__plot_shard *to)
{
    pm__plot_shard copy = *shard;
    *to = copy;
    if (!shard->plots)
        return PM_OK;
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
