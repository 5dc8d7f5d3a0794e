/* Sizes of images, by which metrics scale. */
#include "../base/memory.h"
#include "metric.h"

#include <math.h>
#include <stdlib.h>

static const double white_share = 0.99; /* of pixels are no brighter than the display's 1 */

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

/* Of all pixels, sorted; what is below 0 counts as 0. NULL: out of memory. */
static double *sorted_luminances(const pm__image *image, pm_error *error)
{
    const size_t pixels = image->width * image->height;
    double *const values = pm__alloc(pixels, sizeof *values);
    if (!values) {
        (void)pm__fail(error, PM_ENOMEM, "out of memory for %zu pixels", pixels);
        return NULL;
    }
    for (size_t p = 0; p < pixels; p++)
        values[p] = fmax(0.0, pm__luminance(image, p));
    qsort(values, pixels, sizeof *values, ascending);
    return values;
}

pm_status pm__luminance_range(const pm__image *image, double *most, double *median, pm_error *error)
{
    const size_t pixels = image->width * image->height;
    double *const values = sorted_luminances(image, error);
    if (!values)
        return PM_ENOMEM;
    size_t dark = 0;
    while (dark < pixels && !(values[dark] > 0.0))
        dark++;
    *most = values[pixels - 1];
    *median = 0.5 * (values[(pixels - 1) / 2] + values[pixels / 2]);
    if (!(*median > 0.0) && dark < pixels)
        *median = 0.5 * (values[dark + (pixels - dark - 1) / 2] + values[dark + (pixels - dark) / 2]);
    free(values);
    return PM_OK;
}

pm_status pm__display_factor(const pm__image *reference, double exposure, bool one, double *factor, pm_error *error)
{
    const size_t pixels = reference->width * reference->height;
    double white = 1.0;
    if (!one) {
        double *const values = sorted_luminances(reference, error);
        if (!values)
            return PM_ENOMEM;
        white = values[(size_t)(white_share * (double)(pixels - 1))];
        if (!(white > 0.0))
            white = values[pixels - 1] > 0.0 ? values[pixels - 1] : 1.0;
        free(values);
    }
    *factor = exp2(exposure) / white;
    return PM_OK;
}
