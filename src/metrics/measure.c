/* Asking a metric: checks before, sums after. */
#include "../base/memory.h"
#include "metric.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { PLANES = 20 }; /* of doubles, at most: of flip_map.c, the map, and what is sorted */

double pm__metric_bytes(size_t pixels)
{
    return PLANES * sizeof(double) * (double)pixels;
}

pm_status pm__metric_check(const pm__image *image, const char *name, pm_error *error)
{
    if (!image || !image->values || !image->width || !image->height)
        return pm__fail(error, PM_EINVAL, "%s: no pixels", name);
    if (image->channels != 3)
        return pm__fail(error, PM_EINVAL, "%s: has no R G B, which metrics compare", name);
    const size_t count = 3 * image->width * image->height;
    size_t bad = 0, first = 0;
    for (size_t i = count; i-- > 0;)
        if (!isfinite(image->values[i])) {
            bad++;
            first = i;
        }
    if (!bad)
        return PM_OK;
    const size_t x = first / 3 % image->width, y = first / 3 / image->width;
    return pm__fail(error, PM_EFORMAT, "%s: %zu of %zu values are not finite, the first %c of pixel (%zu, %zu)", name,
                    bad, count, "RGB"[first % 3], x, y);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static pm_status summarize(pm__measured *m, pm_error *error)
{
    const size_t pixels = m->width * m->height;
    double *const sorted = pm__alloc(pixels, sizeof *sorted);
    double sum = 0.0;
    size_t worst = 0;
    if (!sorted)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu pixels", pixels);
    for (size_t p = 0; p < pixels; p++) {
        sum += sorted[p] = m->map[p];
        if (m->larger_is_better ? m->map[p] < m->map[worst] : m->map[p] > m->map[worst])
            worst = p;
    }
    qsort(sorted, pixels, sizeof *sorted, ascending);
    const size_t rank = (size_t)ceil(0.95 * (double)pixels) - 1;
    m->mean = sum / (double)pixels;
    m->median = 0.5 * (sorted[(pixels - 1) / 2] + sorted[pixels / 2]);
    m->p95 = sorted[m->larger_is_better ? pixels - 1 - rank : rank];
    m->worst = m->map[worst];
    m->worst_x = worst % m->width;
    m->worst_y = worst / m->width;
    free(sorted);
    return PM_OK;
}

static pm_status check(const pm__image *tested, const pm__image *reference, pm_error *error)
{
    pm_status status = pm__metric_check(tested, "the tested image", error);
    if (status == PM_OK)
        status = pm__metric_check(reference, "the reference", error);
    if (status == PM_OK && (tested->width != reference->width || tested->height != reference->height))
        status = pm__fail(error, PM_EINVAL, "images of different sizes: %zu x %zu, the reference %zu x %zu",
                          tested->width, tested->height, reference->width, reference->height);
    return status;
}

pm_status pm__metric_measure(const pm__spec *metric, const pm__image *tested, const pm__image *reference,
                             pm__measured *measured, bool *undefined, pm_error *error)
{
    const pm__metric *const m = (const pm__metric *)(const void *)metric->entry;
    *measured = (pm__measured){0};
    *undefined = false;
    pm_status status = check(tested, reference, error);
    if (status != PM_OK)
        return status;
    *measured = (pm__measured){.width = reference->width, .height = reference->height,
                               .larger_is_better = m->larger_is_better, .within_1 = m->within_1, .unit = m->unit};
    measured->map = pm__alloc(reference->width * reference->height, sizeof *measured->map);
    if (!measured->map)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu x %zu pixels", reference->width, reference->height);
    const pm__metric_job job = {tested, reference, metric->values};
    status = m->measure(&job, measured->map, &measured->shown, error);
    *undefined = status == PM_EINVAL;
    return status == PM_OK ? summarize(measured, error) : status;
}

void pm__measured_free(pm__measured *measured)
{
    free(measured->map);
    *measured = (pm__measured){0};
}

pm_status pm__measured_image(const pm__measured *measured, pm__image *image, pm_error *error)
{
    const pm_status status = pm__image_create(measured->width, measured->height, 1, image, error);
    for (size_t p = 0; p < measured->width * measured->height && status == PM_OK; p++)
        image->values[p] = (float)fmin((double)FLT_MAX, fmax(-(double)FLT_MAX, measured->map[p]));
    return status;
}
