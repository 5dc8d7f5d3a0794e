#include "flip_map.h"

#include "../base/memory.h"
#include "colour.h"

#include <math.h>
#include <stdlib.h>

/* Table 1 of the paper: a1, b1, a2, b2 of the three channels. Terms of 0 are left out. */
static const struct {
    double a, b;
} csf_terms[PM__CSF_TERMS] = {{1.0, 0.0047}, {1.0, 0.0053}, {34.1, 0.04}, {13.5, 0.025}};
static const double widest = 0.04; /* the largest b: all channels have its radius */
static const double pi = 3.14159265358979323846;
static const double colour_power = 0.7, feature_power = 0.5, knee = 0.4, knee_value = 0.95, feature_width = 0.082;

/* ---- Filters ----------------------------------------------------------------------------------- */

/* First and second derivatives of the Gaussian, but for factors. */
static double edge_shape(double x, double width)
{
    return -x * pm__gaussian(x, width);
}

static double point_shape(double x, double width)
{
    return (x * x / (width * width) - 1.0) * pm__gaussian(x, width);
}

static double sum_of(const pm__kernel *kernel)
{
    double sum = 0.0;
    for (size_t i = 0; i <= 2 * kernel->radius; i++)
        sum += kernel->weights[i];
    return sum;
}

/* A term a e^(-b f^2) is a sqrt(pi / b) e^(-pi^2 x^2 / b) of x degrees: a Gaussian of width sqrt(b / 2) / pi. The two
 * of blue-yellow share the channel by what they sum to over the square. */
static void share_out(pm__flip_filters *f)
{
    for (int i = 0; i < PM__CSF_TERMS; i++) {
        const double sum = sum_of(&f->csf[i]);
        f->share[i] = csf_terms[i].a * sqrt(pi / csf_terms[i].b) * sum * sum;
        pm__kernel_normalize(&f->csf[i]);
    }
    f->share[0] = f->share[1] = 1.0;
    const double both = f->share[2] + f->share[3];
    f->share[2] /= both;
    f->share[3] /= both;
}

pm_status pm__flip_filters_create(double ppd, pm__flip_filters *f, pm_error *error)
{
    const size_t radius = (size_t)ceil(3.0 * sqrt(0.5 * widest) / pi * ppd);
    const double width = 0.5 * feature_width * ppd;
    const size_t feature_radius = (size_t)ceil(3.0 * width);
    int refused = 0;
    *f = (pm__flip_filters){0};
    for (int i = 0; i < PM__CSF_TERMS; i++)
        refused |= pm__kernel_create(radius, pm__gaussian, sqrt(0.5 * csf_terms[i].b) / pi * ppd, &f->csf[i]);
    refused |= pm__kernel_create(feature_radius, pm__gaussian, width, &f->smooth);
    refused |= pm__kernel_create(feature_radius, edge_shape, width, &f->edge);
    refused |= pm__kernel_create(feature_radius, point_shape, width, &f->point);
    if (refused)
        return pm__fail(error, PM_ENOMEM, "out of memory for filters");
    share_out(f);
    pm__kernel_normalize(&f->smooth);
    pm__kernel_normalize(&f->edge);
    pm__kernel_normalize(&f->point);
    return PM_OK;
}

void pm__flip_filters_free(pm__flip_filters *f)
{
    for (int i = 0; i < PM__CSF_TERMS; i++)
        pm__kernel_free(&f->csf[i]);
    pm__kernel_free(&f->smooth);
    pm__kernel_free(&f->edge);
    pm__kernel_free(&f->point);
}

/* ---- One picture ------------------------------------------------------------------------------- */

enum { LAB_L, LAB_A, LAB_B, EDGE, POINT, SEEN_PLANES };
enum { CHANNEL = 0, SCRATCH = 3, FILTERED, WORK_PLANES };

typedef struct looking {
    const pm__plane *plane;
    const pm__flip_filters *filters;
    size_t pixels;
    double *work[WORK_PLANES]; /* YCxCz, and for filtering */
} looking;

/* The length of the two answers, to the filter along rows and to that along columns. */
static void find_features(looking *l, const pm__kernel *kernel, double *out)
{
    const double *const luminance = l->work[CHANNEL];
    pm__filter(l->plane, luminance, kernel, &l->filters->smooth, l->work[SCRATCH], out);
    pm__filter(l->plane, luminance, &l->filters->smooth, kernel, l->work[SCRATCH], l->work[FILTERED]);
    for (size_t p = 0; p < l->pixels; p++)
        out[p] = hypot(out[p], l->work[FILTERED][p]) / 116.0; /* luminance is 116 Y - 16, and constants answer 0 */
}

/* to = the sum of the channel's terms. */
static void filter_channel(looking *l, int channel, double *to)
{
    const pm__flip_filters *const f = l->filters;
    pm__filter(l->plane, l->work[channel], &f->csf[channel], &f->csf[channel], l->work[SCRATCH], to);
    if (channel != 2)
        return;
    pm__filter(l->plane, l->work[channel], &f->csf[3], &f->csf[3], l->work[SCRATCH], l->work[FILTERED]);
    for (size_t p = 0; p < l->pixels; p++)
        to[p] = f->share[2] * to[p] + f->share[3] * l->work[FILTERED][p];
}

/* seen: what of the picture FLIP compares. */
static void look(looking *l, pm__picture_of *picture, const void *context, double *const *seen)
{
    for (size_t p = 0; p < l->pixels; p++) {
        double rgb[3], opponent[3];
        picture(context, p, rgb);
        pm__rgb_to_ycxcz(rgb, opponent);
        for (int c = 0; c < 3; c++)
            l->work[CHANNEL + c][p] = opponent[c];
    }
    find_features(l, &l->filters->edge, seen[EDGE]);
    find_features(l, &l->filters->point, seen[POINT]);
    for (int c = 0; c < 3; c++)
        filter_channel(l, c, seen[LAB_L + c]);
    for (size_t p = 0; p < l->pixels; p++) {
        double rgb[3], lab[3];
        pm__ycxcz_to_rgb((const double[]){seen[LAB_L][p], seen[LAB_A][p], seen[LAB_B][p]}, rgb);
        for (int c = 0; c < 3; c++)
            rgb[c] = fmin(1.0, fmax(0.0, rgb[c]));
        pm__rgb_to_hunt_lab(rgb, lab);
        for (int c = 0; c < 3; c++)
            seen[LAB_L + c][p] = lab[c];
    }
}

/* ---- Two --------------------------------------------------------------------------------------- */

/* The largest distance, from green to blue, to the power. */
static double largest_distance(void)
{
    double green[3], blue[3];
    pm__rgb_to_hunt_lab((const double[]){0.0, 1.0, 0.0}, green);
    pm__rgb_to_hunt_lab((const double[]){0.0, 0.0, 1.0}, blue);
    return pow(pm__hyab(green, blue), colour_power);
}

static double spread(double distance, double largest)
{
    const double at = knee * largest;
    return distance < at ? knee_value * distance / at
                         : knee_value + (1.0 - knee_value) * (distance - at) / (largest - at);
}

static void compare(double *const *a, double *const *b, size_t pixels, double *map)
{
    const double largest = largest_distance();
    for (size_t p = 0; p < pixels; p++) {
        const double lab_a[] = {a[LAB_L][p], a[LAB_A][p], a[LAB_B][p]};
        const double lab_b[] = {b[LAB_L][p], b[LAB_A][p], b[LAB_B][p]};
        const double colour = spread(pow(pm__hyab(lab_a, lab_b), colour_power), largest);
        const double feature = fmax(fabs(a[EDGE][p] - b[EDGE][p]), fabs(a[POINT][p] - b[POINT][p]));
        map[p] = fmin(1.0, pow(colour, 1.0 - fmin(1.0, pow(sqrt(0.5) * feature, feature_power))));
    }
}

pm_status pm__flip_map(const pm__plane *plane, pm__picture_of *picture, const void *tested, const void *reference,
                       const pm__flip_filters *filters, double *map, pm_error *error)
{
    looking l = {.plane = plane, .filters = filters, .pixels = plane->width * plane->height};
    double *a[SEEN_PLANES], *b[SEEN_PLANES];
    double *const room = pm__alloc(l.pixels, (2 * SEEN_PLANES + WORK_PLANES) * sizeof *room);
    if (!room)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu pixels", l.pixels);
    for (size_t i = 0; i < WORK_PLANES; i++)
        l.work[i] = room + i * l.pixels;
    for (size_t i = 0; i < SEEN_PLANES; i++) {
        a[i] = room + (WORK_PLANES + i) * l.pixels;
        b[i] = room + (WORK_PLANES + SEEN_PLANES + i) * l.pixels;
    }
    look(&l, picture, tested, a);
    look(&l, picture, reference, b);
    compare(a, b, l.pixels, map);
    free(room);
    return PM_OK;
}
