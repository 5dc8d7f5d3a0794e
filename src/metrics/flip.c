/* FLIP of what a display shows: flip_map.h has the formula. Of each image R G B, with the `grey` shown as 0.18
 * (metric.h) and times 2^exposure, cut to 0 ... 1; both are shown alike, by the reference. `ppd`: pixels to the degree
 * of the viewer's eye; 67 are a display of 3840 pixels and 0.7 m, seen from 0.7 m, the publication's default. */
#include "flip_map.h"
#include "metric.h"

#include <math.h>

enum { PPD, EXPOSURE, GREY };

static const pm__param params[] = {
    {"ppd", PM__REAL, 67.0, 1.0, 1000.0, "1/degree", NULL, "pixels to the degree, as the viewer sees the image"},
    PM__DISPLAY_PARAMS,
};

typedef struct shown_image {
    const pm__image *image;
    double factor;
} shown_image;

static void show(const void *context, size_t p, double rgb[3])
{
    const shown_image *const shown = context;
    for (int c = 0; c < 3; c++)
        rgb[c] = fmin(1.0, fmax(0.0, shown->factor * (double)shown->image->values[3 * p + (size_t)c]));
}

static pm_status measure(const pm__metric_job *job, double *map, pm__shown *at, pm_error *error)
{
    const pm__plane plane = {job->reference->width, job->reference->height};
    double factor;
    pm__flip_filters filters;
    pm_status status = pm__display_factor(job->reference, job->values[EXPOSURE], job->values[GREY] > 0.0, &factor,
                                          error);
    if (status != PM_OK)
        return status;
    const shown_image tested = {job->tested, factor}, reference = {job->reference, factor};
    status = pm__flip_filters_create(job->values[PPD], &filters, error);
    if (status == PM_OK)
        status = pm__flip_map(&plane, show, &tested, &reference, &filters, map, error);
    pm__flip_filters_free(&filters);
    *at = (pm__shown){1, log2(factor), log2(factor)};
    return status;
}

const pm__metric pm__metric_flip = {
    .entry = {.name = "flip",
              .summary = "what a viewer sees who flips between them on a display; 0 to 1",
              .citation = "Andersson et al. 2020",
              .params = params,
              .param_count = 3},
    .within_1 = true,
    .unit = "",
    .measure = measure,
};
