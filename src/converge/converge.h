/* How fast methods converge: error, bias and noise of their runs against passes, photons and time, and the slopes.
 *
 * One series is one scene, method and alpha. Its runs, T independent trials, are read after passes 1, 2, 4, ... and the
 * last. Values are the radiance of each measured point in each band; with e the answer less the truth:
 *   b(x)     = mean of e over trials
 *   rel_bias = mean of b over values, rms_bias, rel_noise, rel_rmse: as accuracy.h has them, over truth_mean, the mean
 *              of the truth.
 * Measured are the points whose truth is known (where a law is known too, none but those: bands around folds have
 * laws of their own); blocks of pixels where a stored reference is the truth. Intervals are 95 %, over trials. */
#ifndef PM_CONVERGE_CONVERGE_H
#define PM_CONVERGE_CONVERGE_H

#include "../methods/progressive/progressive.h"
#include "../stats/stats.h"

enum { PM__MOST_RECORDS = 64, PM__CONVERGE_DETAIL = 160 };
#define PM__CONFIDENCE 0.9 /* of a point's own bound */

/* A series on its way, as bytes that mean something to this program on this kind of machine alone. */
typedef struct pm__saved {
    unsigned char *bytes;
    size_t count;
} pm__saved;

typedef struct pm__converge_config {
    pm__progressive_config progressive;
    size_t trials;       /* >= 2 */
    uint32_t passes;     /* at most, of each run; >= 1 */
    uint64_t photons;    /* emitted by a run, at most; 0: no limit. A pass is not cut; methods that emit none go on */
    double seconds;      /* for all runs together; 0: no limit. The first run's passes are then those of all */
    double error;        /* no further pass once the first run estimates that its rms error over the mean radiance is no
                            more (progressive.h), but 8 passes or more; they are then those of all. 0: no limit, and
                            nothing is estimated */
    const size_t *watched; /* points whose statistics are wanted after every recorded pass; may be NULL */
    size_t watched_count;
    void (*progress)(void *context, double fraction, const char *what); /* may be NULL */
    /* Checkpoints. from: goes on where this was saved, to the same rows to the last bit (but for seconds); NULL: from
     * the start. save: called between passes where save_seconds have gone by, when canceled, and at the end; the bytes
     * are valid for the call. Not OK ends the series with that status. Both may be NULL. */
    const pm__saved *from;
    pm_status (*save)(void *context, const pm__saved *saved, pm_error *error);
    double save_seconds;
} pm__converge_config;

/* NAN (intervals: low is NAN) stands for a value that does not exist. */
typedef struct pm__converge_row {
    uint32_t pass;
    uint64_t photons;    /* emitted by the run so far */
    double seconds;      /* wall clock of the first run so far, without reading */
    double rel_bias, rms_bias, rel_noise, rel_rmse;
    pm__interval rel_bias_ci95, rms_bias_ci95, rel_noise_ci95, rel_rmse_ci95;
    double predicted_rel_bias, predicted_rms_bias, predicted_rel_noise;
    double estimated_rel_rmse;      /* by the first run itself, without the truth; NAN where it was not asked for. Of
                                       the measured points; beside a stored reference of all */
    double estimated_rel_rmse_mean; /* of all runs' */
    double estimate_right;          /* the share of points and runs whose error lies within the point's own bound, of
                                       PM__CONFIDENCE; NAN beside a stored reference, and where a run has no estimate */
    double along, along_error;  /* b along the predicted bias over its size (1: as predicted) and its standard error */
} pm__converge_row;

typedef enum pm__quantity { PM__VARIANCE, PM__BIAS, PM__RMSE, PM__QUANTITIES } pm__quantity;

/* A straight line through ln quantity over ln pass: rel_noise^2, the bias along its prediction (where there is none
 * rel_bias), rel_rmse. predicted: the same line through the law's values. */
typedef struct pm__converge_fit {
    pm__quantity quantity;
    uint32_t first_pass, last_pass;
    double slope, slope_error; /* jackknife over trials */
    pm__interval slope_ci95;
    double predicted, asymptote;
    bool fits;                 /* else `detail` says why there is no fit */
    char detail[PM__CONVERGE_DETAIL];
} pm__converge_fit;

/* Statistics of a watched point in the first run. */
typedef struct pm__converge_point {
    size_t point;
    uint32_t pass;
    double radius, count;      /* of the next lookup, m; photons that count so far */
    double radiance[3], truth[3];
} pm__converge_point;

typedef struct pm__converge_series {
    const char *paths;         /* light paths that are traced */
    const char *truth;         /* "exact" or "reference" */
    size_t width, height;      /* of the image */
    size_t points;             /* measured, of how many */
    size_t all_points;
    double truth_mean;         /* W/(m2 sr) */
    size_t trials;             /* done */
    pm__converge_row rows[PM__MOST_RECORDS];
    size_t row_count;
    pm__converge_fit fits[PM__QUANTITIES];
    pm__converge_point *watched; /* [row_count * config's watched_count], by row */
    size_t watched_count;
    bool reached;              /* the first run has ended by the error it estimates */
    bool interrupted;          /* canceled: rows are of the trials that were whole, if two or more were, else none */
} pm__converge_series;

/* EINVAL: what is asked for cannot be, or there is no truth; EFORMAT: `from` is of another series, or damaged; ENOMEM.
 * Canceled: PM_OK with `interrupted`. Free the series by pm__converge_free in any case. */
pm_status pm__converge(const pm__converge_config *config, pm__converge_series *series, pm_error *error);
void pm__converge_free(pm__converge_series *series);

/* The size of the stored reference that is a scene's only truth; false: there is none, or it has an exact answer. */
bool pm__converge_reference_size(const pm__spec *scene, size_t *width, size_t *height);

#endif
