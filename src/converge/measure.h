/* Inside converge: the truth, the law and the records of a series. */
#ifndef PM_CONVERGE_MEASURE_H
#define PM_CONVERGE_MEASURE_H

#include "../image/reference.h"
#include "converge.h"

/* Values that are measured: [3 * value + band]. A value is a point, or a block of pixels. */
typedef struct pm__yardstick {
    const char *name;      /* "exact", "reference" */
    size_t values;         /* measured */
    double *truth;         /* [3 * values] */
    double truth_mean;
    size_t *point;         /* [values]: the point, or the first pixel of the block */
    size_t block;          /* pixels along a block's side; 1: points */
} pm__yardstick;

/* exact: at the points themselves, or for methods that draw them anew the mean over `PM__PIXEL_SAMPLES` of a pixel; or
 * the stored reference. EINVAL: there is neither. with_law: only points for which pm__law_create finds a law. */
enum { PM__PIXEL_SAMPLES = 64 };
pm_status pm__yardstick_create(const pm__progression *progression, const bool *lawful, pm__yardstick *yardstick,
                               pm_error *error);
void pm__yardstick_destroy(pm__yardstick *yardstick);
/* radiance[points] to e[3 * values]: the answer less the truth. */
void pm__yardstick_measure(const pm__yardstick *yardstick, size_t width, const double (*radiance)[3], float *e);

/* What is expected at each point: by band alike. NULL where nothing is known. */
typedef struct pm__expectation {
    bool *lawful;          /* [points]: there is a law */
    size_t lawful_count;
    size_t records;
    double *bias;          /* [record * points]: expected radiance less truth, W/(m2 sr); of all bands alike */
    double *variance;      /* [record * points] */
} pm__expectation;

/* After passes[0 .. records - 1], ascending. Empty (lawful NULL) where the scene or the method has no law. ENOMEM. */
pm_status pm__expectation_create(const pm__progression *progression, const uint32_t *passes, size_t records,
                                 pm__expectation *expectation, pm_error *error);
void pm__expectation_destroy(pm__expectation *expectation);

/* A straight line y over x by least squares. */
double pm__slope(const double *x, const double *y, size_t count);

#endif
