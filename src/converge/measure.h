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

/* exact: at the points themselves, or for methods that draw them anew the mean over PM__PIXEL_SAMPLES of a pixel; else
 * the stored reference. lawful: NULL, or which points alone are measured. EINVAL: there is no truth, or it is 0
 * everywhere, so that nothing is relative to it. ENOMEM. */
enum { PM__PIXEL_SAMPLES = 64 };
pm_status pm__yardstick_create(const pm__progression *progression, const bool *lawful, pm__yardstick *yardstick,
                               pm_error *error);
void pm__yardstick_destroy(pm__yardstick *yardstick);
/* radiance[points] to e[3 * values]: the answer less the truth. */
void pm__yardstick_measure(const pm__yardstick *yardstick, size_t width, const double (*radiance)[3], float *e);

/* The exact radiance of a point: what it sends, weighted, and lights seen on the way. */
void pm__point_truth(const pm__progression *progression, const pm__hit_point *point, double radiance[3]);

/* What is expected at each point, all bands alike: radiance, W/(m2 sr). */
typedef struct pm__expectation {
    bool *lawful;          /* [points]: there is a law; NULL: nowhere */
    size_t lawful_count;
    double *bias;          /* [record * points]: expected answer less truth; NAN where there is no law */
    double *variance;      /* [record * points] */
} pm__expectation;

/* After passes[0 .. records - 1], ascending, of which the last ends the run. Empty where the scene or the method has no
 * law that is known: photons that differ, light that a formula does not cover. ENOMEM; ECANCELED: then it is empty.
 * Cost: some hundred lookups of the case's `mass` a point. */
pm_status pm__expectation_create(const pm__progression *progression, const uint32_t *passes, size_t records,
                                 pm__expectation *expectation, pm_error *error);
void pm__expectation_destroy(pm__expectation *expectation);

/* Errors of all trials after some passes: errors[(trial * records + record) * 3 values + 3 value + band]. */
typedef struct pm__record_set {
    const float *errors;
    const uint32_t *passes; /* [records] */
    size_t records, trials, values; /* values: of all bands */
    const double *profile;  /* [record * values]: the expected bias of each value; NULL: not known */
    double scale;           /* 1 / truth_mean */
} pm__record_set;

static inline const float *pm__record_errors(const pm__record_set *set, size_t record)
{
    return set->errors + record * set->values;
}

/* Bias along its expected profile: b . p / p . p of the mean of trials, its standard error, and of each trial left
 * out in without[trials]. Without a profile: rel_bias. */
typedef struct pm__along {
    double value, error;
} pm__along;
pm__along pm__bias_along(const pm__record_set *set, size_t record, double *without);

/* Fits of all quantities. law[quantity][record]: their predicted values, NAN where there is none. ENOMEM. */
pm_status pm__fit_all(const pm__record_set *set, const double law[PM__QUANTITIES][PM__MOST_RECORDS],
                      pm__converge_fit fits[PM__QUANTITIES], pm_error *error);

/* The slope of y over x by least squares. count >= 2. */
double pm__slope(const double *x, const double *y, size_t count);

#endif
