/* Image metrics: how far a tested image is from a reference, pixel by pixel and as a whole.
 *
 * A metric is one file and one row of list.h; each file's head states its formula, and metrics.h how to ask. Notation:
 * A the tested image, B the reference (the truth where a formula is not symmetric), c one of R G B. Sums run in double,
 * in the order of pixels. */
#ifndef PM_METRICS_METRIC_H
#define PM_METRICS_METRIC_H

#include "metrics.h"

/* What a metric is given: images that were checked (pm__metric_check), of one size. */
typedef struct pm__metric_job {
    const pm__image *tested, *reference;
    const double *values; /* of the entry's parameters */
} pm__metric_job;

struct pm__metric {
    pm__entry entry;
    bool larger_is_better; /* 1 is perfect; else 0 is */
    bool within_1;         /* from 0 to 1, at least nearly */
    const char *unit;      /* of the map and its mean; "": none */
    /* Fills in map[w * h], and *shown where the metric looks at images as a display shows them. ENOMEM; EINVAL: there
     * is no such number for these images, the error says why. */
    pm_status (*measure)(const pm__metric_job *job, double *map, pm__shown *shown, pm_error *error);
};

/* ---- What several metrics share ---------------------------------------------------------------- */

static inline size_t pm__pixels_of(const pm__metric_job *job)
{
    return job->reference->width * job->reference->height;
}

/* The mean of |value| over all pixels and channels. image_means.c */
double pm__mean_size(const pm__image *image);

/* Rec. 709 luminance of pixel p, of linear R G B. */
static inline double pm__luminance(const pm__image *image, size_t p)
{
    const float *const c = &image->values[3 * p];
    return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
}

/* The largest luminance and the median; where that is 0, the median of those above 0. Both 0 where
 * all are. ENOMEM. image_means.c */
pm_status pm__luminance_range(const pm__image *image, double *most, double *median, pm_error *error);

/* The parameters of metrics that look at images as a display shows them: the factor from radiance to the display's 0 to
 * 1. grey `auto`: the reference's median luminance (as above) is shown as 0.18, a middle grey, whatever the lamps are;
 * `none`, or a black reference: 1 W/(m2 sr) is shown as 1. exposure: stops above that. image_means.c */
#define PM__DISPLAY_PARAMS                                                                                   \
    {"exposure", PM__REAL, 0.0, -60.0, 60.0, "stops", NULL, "brighter than by `grey`"},                      \
    {"grey", PM__CHOICE, 0.0, 0.0, 0.0, "", "auto|none",                                                     \
     "auto: the reference's median luminance is shown as middle grey, 0.18; none: 1 W/(m2 sr) as white, 1"}
pm_status pm__display_factor(const pm__image *reference, double exposure, bool plain, double *factor, pm_error *error);

/* What relmse, mape and smape add to divisors; see there. */
#define PM__EPSILON_PARAMS                                                                                            \
    {"epsilon", PM__REAL, 0.01, 0.0, 1e6, "", NULL, "what keeps dark pixels from counting without bound, in `unit`"}, \
    {"unit", PM__CHOICE, 0.0, 0.0, 0.0, "", "mean|one",                                                               \
     "mean: of epsilon, the image's mean, so that scale does not matter; one: 1 W/(m2 sr), as papers have it"}
enum { PM__EPSILON, PM__UNIT };

#endif
