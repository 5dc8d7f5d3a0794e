/* Image metrics, asked by name: a mean and a map. The first image is the tested one, the second the reference. */
#ifndef PM_METRICS_METRICS_H
#define PM_METRICS_METRICS_H

#include "../base/param.h"
#include "../image/image.h"

typedef struct pm__metric pm__metric;
extern const pm__catalogue pm__metrics; /* "metric": entries are those of pm__metric */

/* Exposures at which images were looked at, in stops: 1 W/(m2 sr) times 2^stop is the display's 1. */
typedef struct pm__shown {
    size_t count; /* 0: the metric reads radiance */
    double start, stop;
} pm__shown;

/* What came out. Of the map's w * h values "better" is smaller, or larger if larger_is_better. */
typedef struct pm__measured {
    size_t width, height;
    double *map;       /* row by row from the top; owned */
    double mean, median;
    double p95;        /* 95 % of the pixels are as good or better */
    double worst;
    size_t worst_x, worst_y; /* the first pixel with it, from the top left */
    pm__shown shown;
    bool larger_is_better;
    bool within_1;     /* equal and as wrong as can be are 1 apart, or nearly */
    const char *unit;  /* "": none */
} pm__measured;

/* Can metrics be asked of the image? EINVAL: it has no pixels, or no R G B. EFORMAT: values that are not finite; the
 * error says how many and where the first is. name: what messages call it. */
pm_status pm__metric_check(const pm__image *image, const char *name, pm_error *error);

/* metric: of pm__metrics. EINVAL: images of different sizes, or as pm__metric_check; or the metric has no value for
 * them (undefined is then true). ENOMEM. *measured: free always. Values of any finite size are allowed; nothing in a
 * map is infinite or NAN. Cost: flip and hdrflip about 2 us a pixel and exposure, the others less. */
pm_status pm__metric_measure(const pm__spec *metric, const pm__image *tested, const pm__image *reference,
                             pm__measured *measured, bool *undefined, pm_error *error);
void pm__measured_free(pm__measured *measured);

/* Bytes that measuring takes for so many pixels, beside the images; an upper bound. */
double pm__metric_bytes(size_t pixels);

/* The map as an image of one channel; what a float does not hold becomes the largest it does. ENOMEM. */
pm_status pm__measured_image(const pm__measured *measured, pm__image *image, pm_error *error);

#endif
