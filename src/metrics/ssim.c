/* SSIM: the structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004, equation 13).
 *
 *     map = (2 m_a m_b + C1) (2 s_ab + C2) / ((m_a^2 + m_b^2 + C1) (s_a^2 + s_b^2 + C2))
 *
 * with means m, variances s^2 and covariance s_ab under a Gaussian of 1.5 pixels, 11 x 11 of them; C1 = (0.01 L)^2,
 * C2 = (0.03 L)^2, L = 1 the range. It was made for pictures, so it is taken of what a display shows: the luminance
 * (Rec. 709), with the `grey` shown as 0.18 (metric.h) and times 2^exposure, cut to 0 ... 1, encoded as sRGB. Both
 * images are shown alike, by the reference. Beyond the border lies the nearest pixel, so that the map has all pixels
 * (the paper leaves the border out). No unit; -1 to 1, 1 for equal images: larger is better. Symmetric but for `grey`.
 */
#include "../base/memory.h"
#include "filter.h"
#include "metric.h"

#include <math.h>
#include <stdlib.h>

enum { EXPOSURE, GREY, RADIUS = 5, A = 0, B, AA, BB, AB, SOURCE, SCRATCH, PLANES };
static const double width = 1.5, c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;

static const pm__param params[] = {PM__DISPLAY_PARAMS};

/* IEC 61966-2-1; 0 to 1. */
static double srgb_code(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

static double shown(const pm__image *image, size_t p, double factor)
{
    return srgb_code(fmin(1.0, fmax(0.0, factor * pm__luminance(image, p))));
}

/* The five moments of the window at every pixel, into planes A to AB. */
static void take_moments(const pm__metric_job *job, double factor, const pm__kernel *kernel, double **planes)
{
    const pm__plane plane = {job->reference->width, job->reference->height};
    for (int moment = A; moment <= AB; moment++) {
        for (size_t p = 0; p < pm__pixels_of(job); p++) {
            const double a = shown(job->tested, p, factor), b = shown(job->reference, p, factor);
            const double values[] = {a, b, a * a, b * b, a * b};
            planes[SOURCE][p] = values[moment];
        }
        pm__filter(&plane, planes[SOURCE], kernel, kernel, planes[SCRATCH], planes[moment]);
    }
}

static void compare(double *const *planes, size_t pixels, double *map)
{
    for (size_t p = 0; p < pixels; p++) {
        const double a = planes[A][p], b = planes[B][p];
        const double aa = planes[AA][p] - a * a, bb = planes[BB][p] - b * b, ab = planes[AB][p] - a * b;
        map[p] = (2.0 * a * b + c1) * (2.0 * ab + c2) / ((a * a + b * b + c1) * (aa + bb + c2));
    }
}

static pm_status measure(const pm__metric_job *job, double *map, pm__shown *at, pm_error *error)
{
    double factor, *planes[PLANES];
    pm__kernel kernel = {0};
    const size_t pixels = pm__pixels_of(job);
    pm_status status = pm__display_factor(job->reference, job->values[EXPOSURE], job->values[GREY] > 0.0, &factor,
                                          error);
    if (status != PM_OK)
        return status;
    double *const room = pm__alloc(pixels, PLANES * sizeof *room);
    if (!room || pm__kernel_create(RADIUS, pm__gaussian, width, &kernel))
        status = pm__fail(error, PM_ENOMEM, "out of memory for %zu pixels", pixels);
    for (size_t i = 0; i < PLANES && status == PM_OK; i++)
        planes[i] = room + i * pixels;
    if (status == PM_OK) {
        pm__kernel_normalize(&kernel);
        take_moments(job, factor, &kernel, planes);
        compare(planes, pixels, map);
        *at = (pm__shown){1, log2(factor), log2(factor)};
    }
    pm__kernel_free(&kernel);
    free(room);
    return status;
}

const pm__metric pm__metric_ssim = {
    .entry = {.name = "ssim",
              .summary = "structural similarity of what a display shows; 1 is equal",
              .citation = "Wang et al. 2004",
              .params = params,
              .param_count = 2},
    .larger_is_better = true,
    .within_1 = true,
    .unit = "",
    .measure = measure,
};
