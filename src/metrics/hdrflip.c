/* HDR-FLIP: of each pixel the largest FLIP (flip_map.h) over exposures, so that neither lights nor shadows are lost
 * (Andersson, Nilsson, Shirley, Akenine-Moller: Visualizing errors in rendered high dynamic range images, Eurographics
 * 2021).
 *
 *     map = max over i of FLIP(tone(2^e_i A), tone(2^e_i B)),   e_i from start to stop in equal steps
 *     start = log2(x / the largest luminance of B),  stop = log2(x / its median),  max(2, ceil(stop - start)) of them
 *
 * tone is Narkowicz's fit of ACES without its own exposure, cut to 0 ... 1; x is where it is 0.85: the brightest pixel
 * is then not yet washed out at start, and the median is bright at stop. One exposure where start is stop, and of a
 * black reference e = 0. Where half of the reference is black its median has no exposure: the median of the other half
 * is taken. What is below 0 counts as 0. Exposures follow from B alone, so images that share a reference compare. */
#include "../base/memory.h"
#include "flip_map.h"
#include "metric.h"

#include <math.h>
#include <stdlib.h>

enum { PPD };
static const double reached = 0.85;

static const pm__param params[] = {
    {"ppd", PM__REAL, 67.0, 1.0, 1000.0, "1/degree", NULL, "pixels to the degree, as the viewer sees the image"},
};

/* (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5): Narkowicz 2016, whose x was to be multiplied by 0.6 before. */
static const double k0 = 0.36 * 2.51, k1 = 0.6 * 0.03, k3 = 0.36 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;

static double tone(double x)
{
    return fmin(1.0, (k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5));
}

/* The x > 0 whose tone is t: (k0 - t k3) x^2 + (k1 - t k4) x - t k5 = 0. */
static double tone_inverse(double t)
{
    const double a = k0 - t * k3, half = 0.5 * (k1 - t * k4) / a;
    return -half + sqrt(half * half + t * k5 / a);
}

typedef struct shown_image {
    const pm__image *image;
    const double *factor; /* of the exposure in hand */
} shown_image;

static void show(const void *context, size_t p, double rgb[3])
{
    const shown_image *const shown = context;
    for (int c = 0; c < 3; c++)
        rgb[c] = tone(fmax(0.0, *shown->factor * (double)shown->image->values[3 * p + (size_t)c]));
}

static pm_status choose_exposures(const pm__image *reference, pm__shown *at, pm_error *error)
{
    double most, median;
    const pm_status status = pm__luminance_range(reference, &most, &median, error);
    *at = (pm__shown){1, 0.0, 0.0};
    if (status != PM_OK || !(most > 0.0))
        return status;
    at->start = log2(tone_inverse(reached) / most);
    at->stop = log2(tone_inverse(reached) / median);
    if (at->stop > at->start)
        at->count = (size_t)fmax(2.0, ceil(at->stop - at->start));
    return PM_OK;
}

static pm_status measure_all(const pm__metric_job *job, const pm__shown *at, const pm__flip_filters *filters,
                             double *map, pm_error *error)
{
    const pm__plane plane = {job->reference->width, job->reference->height};
    const size_t pixels = pm__pixels_of(job);
    const double step = at->count > 1 ? (at->stop - at->start) / (double)(at->count - 1) : 0.0;
    double factor;
    const shown_image tested = {job->tested, &factor}, reference = {job->reference, &factor};
    double *const one = pm__alloc(pixels, sizeof *one);
    pm_status status = one ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory for %zu pixels", pixels);
    for (size_t p = 0; p < pixels; p++)
        map[p] = 0.0;
    for (size_t i = 0; i < at->count && status == PM_OK; i++) {
        factor = exp2(at->start + (double)i * step);
        status = pm__flip_map(&plane, show, &tested, &reference, filters, one, error);
        for (size_t p = 0; p < pixels && status == PM_OK; p++)
            map[p] = fmax(map[p], one[p]);
    }
    free(one);
    return status;
}

static pm_status measure(const pm__metric_job *job, double *map, pm__shown *at, pm_error *error)
{
    pm__flip_filters filters = {0};
    pm_status status = choose_exposures(job->reference, at, error);
    if (status == PM_OK)
        status = pm__flip_filters_create(job->values[PPD], &filters, error);
    if (status == PM_OK)
        status = measure_all(job, at, &filters, map, error);
    pm__flip_filters_free(&filters);
    return status;
}

const pm__metric pm__metric_hdrflip = {
    .entry = {.name = "hdrflip",
              .summary = "the largest flip over exposures from the reference's lights to its shadows; 0 to 1",
              .citation = "Andersson et al. 2021",
              .params = params,
              .param_count = 1},
    .within_1 = true,
    .unit = "",
    .measure = measure,
};
