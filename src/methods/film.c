#include "film.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Over trials, and of the samples of one where no maps set them apart. */
static bool wants_moments(const pm__render_config *config)
{
    return config->aov && config->trials > 1;
}

static bool wants_square(const pm__render_config *config, bool maps)
{
    return config->aov && config->trials == 1 && !maps;
}

double pm__film_bytes(const pm__render_config *config, bool maps)
{
    const pm__film *const film = NULL; /* for its types alone */
    enum { COLOUR = 3 * sizeof(float), GREY = sizeof(float) };
    size_t bytes = sizeof *film->sum + sizeof *film->first + sizeof *film->radius + sizeof *film->count + COLOUR;
    if (config->aov && maps)
        bytes += 2 * GREY;
    if (wants_moments(config))
        bytes += sizeof *film->mean + sizeof *film->m2 + COLOUR;
    if (wants_square(config, maps))
        bytes += sizeof *film->square + COLOUR;
    return (double)bytes;
}

pm_status pm__film_create(const pm__render_job *job, bool maps, pm__film *film, pm_error *error)
{
    const bool moments = wants_moments(job->config), square = wants_square(job->config, maps);
    const size_t width = job->config->width, height = job->config->height, pixels = width * height;
    const size_t across = (width + PM__TILE - 1) / PM__TILE, down = (height + PM__TILE - 1) / PM__TILE;
    const size_t all = pixels * job->images;
    *film = (pm__film){.width = width, .height = height, .images = job->images, .pixels = pixels,
                       .tiles = across * down, .tiles_across = across, .estimates = maps};
    film->sum = pm__alloc_zero(all, sizeof *film->sum);
    film->first = pm__alloc_zero(all, sizeof *film->first);
    film->radius = pm__alloc_zero(all, sizeof *film->radius);
    film->count = pm__alloc_zero(all, sizeof *film->count);
    film->taken = pm__alloc_zero(film->tiles, sizeof *film->taken);
    film->truth = job->truth ? pm__alloc_zero(pixels, sizeof *film->truth) : NULL;
    film->mean = moments ? pm__alloc_zero(all, sizeof *film->mean) : NULL;
    film->m2 = moments ? pm__alloc_zero(all, sizeof *film->m2) : NULL;
    film->square = square ? pm__alloc_zero(all, sizeof *film->square) : NULL;
    if (film->sum && film->first && film->radius && film->count && film->taken && (film->truth || !job->truth) &&
        ((film->mean && film->m2) || !moments) && (film->square || !square))
        return PM_OK;
    pm__film_destroy(film);
    return pm__fail(error, PM_ENOMEM, "out of memory for an image of %zu x %zu pixels", width, height);
}

void pm__film_destroy(pm__film *film)
{
    free(film->sum);
    free(film->first);
    free(film->radius);
    free(film->count);
    free(film->taken);
    free(film->truth);
    free(film->mean);
    free(film->m2);
    free(film->square);
    *film = (pm__film){0};
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

pm__tile pm__film_tile(const pm__film *film, size_t index, uint32_t pass, uint32_t trial)
{
    const size_t x = index % film->tiles_across * PM__TILE, y = index / film->tiles_across * PM__TILE;
    return (pm__tile){x, y, smaller(x + PM__TILE, film->width), smaller(y + PM__TILE, film->height), pass, trial};
}

void pm__film_add(pm__film *film, size_t index, const pm__sample *samples, const double (*truth)[3])
{
    const pm__tile tile = pm__film_tile(film, index, 0, 0);
    const size_t across = tile.x1 - tile.x0, own = pm__tile_pixels(&tile);
    const bool first = film->trials == 0;
    for (size_t p = 0; p < own; p++) {
        const size_t pixel = (tile.y0 + p / across) * film->width + tile.x0 + p % across;
        for (size_t i = 0; i < film->images; i++) {
            const pm__sample *const sample = &samples[i * own + p];
            const size_t at = i * film->pixels + pixel;
            for (int b = 0; b < 3; b++)
                film->sum[at][b] += sample->radiance[b];
            for (int b = 0; b < 3 && film->square; b++)
                film->square[at][b] += sample->radiance[b] * sample->radiance[b];
            film->radius[at] += first ? (double)sample->radius : 0.0;
            film->count[at] += first ? (double)sample->count : 0.0;
        }
        for (int b = 0; b < 3 && first && film->truth; b++)
            film->truth[pixel][b] += truth[p][b];
    }
    film->taken[index]++;
}

/* What each sample of a pixel counts for in its mean. */
static double share_of(const pm__film *film, size_t pixel)
{
    const size_t x = pixel % film->width / PM__TILE, y = pixel / film->width / PM__TILE;
    const uint32_t taken = film->taken[y * film->tiles_across + x];
    return taken ? 1.0 / taken : 0.0;
}

void pm__film_end_trial(pm__film *film)
{
    const bool first = film->trials++ == 0;
    for (size_t at = 0; at < film->pixels * film->images; at++) {
        const size_t pixel = at % film->pixels;
        const double share = share_of(film, pixel);
        for (int b = 0; b < 3; b++) {
            const double value = film->sum[at][b] * share;
            if (first)
                film->first[at][b] = value;
            if (film->square) /* as of independent samples: stratified ones are no worse */
                film->square[at][b] = share < 1.0 ? fmax(0.0, film->square[at][b] * share - value * value) * share /
                                                        (1.0 - share) : 0.0;
            if (film->mean) { /* Welford 1962 */
                const double off = value - film->mean[at][b];
                film->mean[at][b] += off / (double)film->trials;
                film->m2[at][b] += off * (value - film->mean[at][b]);
            }
        }
        if (first) {
            film->radius[at] *= share;
            film->count[at] *= share;
        }
        for (int b = 0; b < 3 && first && film->truth && at < film->pixels; b++)
            film->truth[pixel][b] *= share;
    }
    memset(film->sum, 0, film->pixels * film->images * sizeof *film->sum);
    memset(film->taken, 0, film->tiles * sizeof *film->taken);
}
