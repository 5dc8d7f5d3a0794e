/* Sizes of images, by which metrics scale. */
#include "../base/memory.h"
#include "metric.h"

#include <math.h>
#include <stdlib.h>

static const double middle_grey = 0.18; /* half as light as white to the eye: L* is 49.5 */

double pm__mean_size(const pm__image *image)
{
    const size_t count = 3 * image->width * image->height;
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += fabs((double)image->values[i]);
    return sum / (double)count;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

pm_status pm__luminance_range(const pm__image *image, double *most, double *median, pm_error *error)
{
    const size_t pixels = image->width * image->height;
    double *const values = pm__alloc(pixels, sizeof *values);
    size_t dark = 0;
    if (!values)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu pixels", pixels);
    for (size_t p = 0; p < pixels; p++)
        values[p] = fmax(0.0, pm__luminance(image, p));
    qsort(values, pixels, sizeof *values, ascending);
    while (dark < pixels && !(values[dark] > 0.0))
        dark++;
    *most = values[pixels - 1];
    *median = 0.5 * (values[(pixels - 1) / 2] + values[pixels / 2]);
    if (!(*median > 0.0) && dark < pixels)
        *median = 0.5 * (values[dark + (pixels - dark - 1) / 2] + values[dark + (pixels - dark) / 2]);
    free(values);
    return PM_OK;
}

pm_status pm__display_factor(const pm__image *reference, double exposure, bool plain, double *factor, pm_error *error)
{
    double most, median = 0.0;
    const pm_status status = plain ? PM_OK : pm__luminance_range(reference, &most, &median, error);
    *factor = exp2(exposure) * (median > 0.0 ? middle_grey / median : 1.0);
    return status;
}
