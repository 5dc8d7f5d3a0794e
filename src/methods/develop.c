/* From a film to images: radiance, and its comparison with a truth. */
#include "film.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

/* What images are compared in: the film's pixels, or blocks of them as large as a reference's pixels. */
typedef struct comparison {
    const pm__film *film;
    size_t width, height, block; /* block: pixels of the film along a pixel's side */
    double (*truth)[3];          /* NAN where it is not known; NULL: nowhere */
    double scale;                /* 1 / mean truth, or mean radiance */
} comparison;

static double block_mean(const comparison *c, double (*values)[3], size_t pixel, int band)
{
    const size_t x = pixel % c->width * c->block, y = pixel / c->width * c->block;
    double sum = 0.0;
    for (size_t j = 0; j < c->block; j++)
        for (size_t i = 0; i < c->block; i++)
            sum += values[(y + j) * c->film->width + x + i][band];
    return sum / (double)(c->block * c->block);
}

/* Without a truth an image's own mean: it must not depend on what else is rendered. */
static void find_scale(comparison *c, size_t image)
{
    double(*const shown)[3] = c->film->first + image * c->film->pixels;
    double sum = 0.0;
    size_t known = 0;
    for (size_t p = 0; p < c->width * c->height; p++)
        for (int b = 0; b < 3; b++) {
            const double value = c->truth ? c->truth[p][b] : block_mean(c, shown, p, b);
            sum += isfinite(value) ? fabs(value) : 0.0;
            known += isfinite(value) ? 1 : 0;
        }
    c->scale = sum > 0.0 ? (double)known / sum : 0.0;
}

pm_status pm__reference_fits(const pm__image *reference, size_t width, size_t height, pm_error *error)
{
    if (width % reference->width == 0 && height % reference->height == 0 &&
        width / reference->width == height / reference->height)
        return PM_OK;
    return pm__fail(error, PM_EINVAL, "the reference has %zu x %zu pixels: it can be compared with images of a whole "
                    "multiple of that", reference->width, reference->height);
}

static pm_status compare_with(comparison *c, const pm__image *reference, pm_error *error)
{
    const pm__film *const film = c->film;
    if (reference && !film->truth) {
        const pm_status status = pm__reference_fits(reference, film->width, film->height, error);
        if (status != PM_OK)
            return status;
        c->width = reference->width;
        c->height = reference->height;
        c->block = film->width / reference->width;
    }
    if (!reference && !film->truth)
        return PM_OK;
    c->truth = pm__alloc(c->width * c->height, sizeof *c->truth);
    if (!c->truth)
        return pm__fail(error, PM_ENOMEM, "out of memory for an image");
    for (size_t p = 0; p < c->width * c->height; p++)
        for (int b = 0; b < 3; b++)
            c->truth[p][b] = film->truth ? film->truth[p][b] : (double)reference->values[3 * p + (size_t)b];
    return PM_OK;
}

static pm_status make_image(const comparison *c, int channels, pm__image *image, pm_error *error)
{
    return pm__image_create(c->width, c->height, channels, image, error);
}

/* Images that show how far from the truth: where it is not known they are 0. */
static pm_status compare(const comparison *c, size_t image, pm__render_images *images, pm_error *error)
{
    const pm__film *const film = c->film;
    const size_t at = image * film->pixels, pixels = c->width * c->height;
    const bool moments = film->mean && film->trials > 1, own = film->square;
    pm_status status = PM_OK;
    if (c->truth)
        status = make_image(c, 3, &images->truth, error);
    if (status == PM_OK && c->truth)
        status = make_image(c, 3, &images->error, error);
    if (status == PM_OK && c->truth && moments)
        status = make_image(c, 3, &images->bias, error);
    if (status == PM_OK && (moments || own))
        status = make_image(c, 3, &images->noise, error);
    for (size_t p = 0; p < pixels && status == PM_OK; p++)
        for (int b = 0; b < 3; b++) {
            const size_t to = 3 * p + (size_t)b;
            const bool known = c->truth && isfinite(c->truth[p][b]);
            const double truth = known ? c->truth[p][b] : 0.0;
            if (c->truth)
                images->truth.values[to] = (float)truth;
            if (known)
                images->error.values[to] = (float)((block_mean(c, film->first + at, p, b) - truth) * c->scale);
            if (known && moments)
                images->bias.values[to] = (float)((block_mean(c, film->mean + at, p, b) - truth) * c->scale);
            if (own)
                images->noise.values[to] = (float)(sqrt(block_mean(c, film->square + at, p, b)) * c->scale);
            if (moments) /* of a block: the mean of its pixels' variances */
                images->noise.values[to] =
                    (float)(sqrt(block_mean(c, film->m2 + at, p, b) / (double)(film->trials - 1)) * c->scale);
        }
    return status;
}

static pm_status show(const pm__film *film, size_t image, bool aov, pm__render_images *images, pm_error *error)
{
    const size_t at = image * film->pixels;
    pm_status status = pm__image_create(film->width, film->height, 3, &images->radiance, error);
    aov = aov && film->estimates;
    if (status == PM_OK && aov)
        status = pm__image_create(film->width, film->height, 1, &images->radius, error);
    if (status == PM_OK && aov)
        status = pm__image_create(film->width, film->height, 1, &images->count, error);
    for (size_t p = 0; p < film->pixels && status == PM_OK; p++) {
        for (int b = 0; b < 3; b++)
            images->radiance.values[3 * p + (size_t)b] = (float)film->first[at + p][b];
        if (aov) {
            images->radius.values[p] = (float)film->radius[at + p];
            images->count.values[p] = (float)film->count[at + p];
        }
    }
    return status;
}

static void summarize(const comparison *c, size_t image, pm__render_images *images)
{
    const size_t at = image * c->film->pixels;
    double sum = 0.0, squares = 0.0;
    size_t known = 0;
    for (size_t p = 0; c->truth && p < c->width * c->height; p++)
        for (int b = 0; b < 3; b++)
            if (isfinite(c->truth[p][b])) {
                const double off = (block_mean(c, c->film->first + at, p, b) - c->truth[p][b]) * c->scale;
                sum += off;
                squares += off * off;
                known++;
            }
    images->mean_error = known ? sum / (double)known : NAN;
    images->rms_error = known ? sqrt(squares / (double)known) : NAN;
}

pm_status pm__film_develop(const pm__film *film, const pm__image *reference, bool aov, pm__render_result *result,
                           pm_error *error)
{
    comparison c = {.film = film, .width = film->width, .height = film->height, .block = 1};
    result->images = pm__alloc_zero(film->images, sizeof *result->images);
    if (!result->images)
        return pm__fail(error, PM_ENOMEM, "out of memory for images");
    result->count = film->images;
    pm_status status = aov ? compare_with(&c, reference, error) : PM_OK;
    for (size_t i = 0; i < film->images && status == PM_OK; i++) {
        find_scale(&c, i);
        status = show(film, i, aov, &result->images[i], error);
        if (status == PM_OK && aov)
            status = compare(&c, i, &result->images[i], error);
        summarize(&c, i, &result->images[i]);
    }
    free(c.truth);
    return status;
}
