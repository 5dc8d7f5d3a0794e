/* What the tracing and rendering promise, measured: each quantity is a ratio of times of work that takes turns, with
 * its interval, beside the least ratio that is promised.
 *
 * trace          photons traced end to end on one thread; baseline: Embree alone on the same rays
 * trace-threads  photons shot on all threads; baseline: on one
 * visualize      the image of a photon map, the map being there; baseline: the same image without estimates, then the
 *                bare search for the same queries
 * skip           a render of little work, maps included; baseline: with all that its plan skips (no_skip). Are the
 *                images the same?
 * pass           the first pass of progressive photon mapping (ppm): its photons, their map, lookups, what points take
 *                from them; baseline: its photons, their map, then the bare search for the same radii
 * pass-threads   the same pass on all threads; baseline: on one
 * pass-rays      the same pass, time of all processors; baseline: as many random rays in the scene's box as it may take
 *                the time of, two million, of which Embree alone answers each */
#ifndef PM_BENCH_SPEED_H
#define PM_BENCH_SPEED_H

#include "../cases/case.h"
#include "harness.h"

#include <stdbool.h>

typedef enum pm__quantity {
    PM__TRACE_SPEED,
    PM__THREADS_SPEED,
    PM__VISUALIZE_SPEED,
    PM__SKIP_SPEED,
    PM__PASS_SPEED,
    PM__PASS_THREADS_SPEED,
    PM__PASS_RAYS_SPEED,
    PM__QUANTITIES
} pm__quantity;

extern const char *const pm__quantity_names[PM__QUANTITIES];

typedef struct pm__speed_config {
    const pm__spec *scenes; /* of pm__scene_cases */
    size_t scene_count;     /* 0: each quantity has its own */
    unsigned quantities;    /* bit q: is asked for; 0: all */
    size_t photons, k, width, height;
    size_t pass_photons;    /* emitted in a pass */
    size_t threads;         /* of `parallel` */
    double seconds;         /* for all, more or less: the fewest rounds are done all the same */
    uint64_t seed;
    const pm_parallel *parallel;
    void (*progress)(void *context, double fraction, const char *what); /* may be NULL */
    bool (*canceled)(void *context);                                    /* may be NULL. Asked by several threads */
    void *context;
} pm__speed_config;

typedef struct pm__speed_row {
    pm__spec scene;
    pm__quantity quantity;
    const char *method;      /* NULL: there is none */
    size_t photons, threads;
    double seconds;          /* median; NAN where there is none */
    const char *baseline;
    double baseline_seconds;
    double ratio;            /* the baseline's time over this one's; NAN where there is none */
    pm__interval ratio_ci95;
    double promise;          /* the least ratio promised; NAN: none is */
    size_t samples;
    bool compared, agree;    /* skip: were images compared, and are they the same but for noise */
    double aa_ratio;         /* the harness's control */
    pm__interval aa_ci95;
    const char *warning;     /* of the harness, or NULL */
    const char *status;      /* "ok"; "unclear": the interval holds the promise, or there is none at 95 %; "missed": it
                                lies below; "differs": images do; "failed": not measured, detail says why */
    char detail[200];
} pm__speed_row;

/* Rows in the order of quantities, then scenes; free by free(). Where there is one thread there is no trace-threads
 * and no pass-threads.
 * ECANCELED: the rows that were complete. ENOMEM. */
pm_status pm__speed_run(const pm__speed_config *config, pm__speed_row **rows, size_t *count, pm_error *error);

/* One row each; `row` comes with scene, quantity and method. Errors other than ENOMEM and ECANCELED are the row's
 * (status "failed"). */
pm_status pm__speed_trace(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error);
pm_status pm__speed_threads(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error);
pm_status pm__speed_visualize(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error);
pm_status pm__speed_skip(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error);
pm_status pm__speed_pass(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error);
pm_status pm__speed_pass_threads(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error);
pm_status pm__speed_pass_rays(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error);

/* Takes over what the harness found: of `result`, whose units take `scale` seconds for each of its nanoseconds, against
 * `baseline`. */
void pm__speed_take(const pm__bench_report *report, size_t result, size_t baseline, double scale, pm__speed_row *row);

/* The verdict on a ratio and its interval from so many rounds: "ok", "unclear" or "missed". */
const char *pm__speed_verdict(double promise, double ratio, pm__interval ci95, size_t rounds);

/* Do two kinds of trials have the same means? a, b: [trial * values + value], trial t of the one paired with trial t of
 * the other. Student's t for each value, Bonferroni over all: of the same distributions one comparison in a million is
 * told to differ. Differences of rounding, 1e-6 of the mean |value|, are none. *worst: the p-value of the value that
 * differs most, times the values, at most 1; may be NULL. trials >= 2. */
bool pm__speed_agree(const double *a, const double *b, size_t trials, size_t values, double *worst);

#endif
