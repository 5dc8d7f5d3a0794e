/* The accuracy bench: bias, noise, error and time of estimators on cases with exact truth.
 *
 * A trial is one independent photon map. With T trials and Q probes, e the estimate less the truth:
 *   b(x)     = mean of e over trials
 *   rel_bias = mean of b over probes                         / truth_mean
 *   rms_bias = sqrt(mean of b^2 - variance of b, floored at 0) / truth_mean
 *   rel_noise = sqrt(mean over probes of the trial variance)  / truth_mean
 *   rel_rmse = sqrt(mean of e^2 over trials and probes)       / truth_mean
 * Intervals are 95 %, over trials (jackknife), never over probes. Results do not depend on the threads. */
#ifndef PM_ACCURACY_ACCURACY_H
#define PM_ACCURACY_ACCURACY_H

#include "../../cases/case.h"
#include "../../estimators/estimator.h"
#include "../base/sampler.h"
#include "../stats/stats.h"

typedef struct pm__accuracy_config {
    const pm__spec *cases;
    size_t case_count;
    const pm__spec *estimators;
    size_t estimator_count;
    const size_t *ks; /* photons in an estimate; none: every photon within `radius` */
    size_t k_count;
    double radius;       /* m: the maximum radius with ks, the radius without; 0: none */
    double auto_threshold; /* > 0: the automatic maximum radius of [C02] 5.2 for this radiance, W/(m2 sr), instead */
    const size_t *photons; /* a map */
    size_t photon_count;
    const pm__spec *samplers;
    size_t sampler_count;
    size_t trials;        /* >= 2 */
    size_t probes_all;    /* >= 1 */
    size_t probes_region;
    const char *search;   /* name; NULL: the fastest */
    pm__shape lookup;
    uint64_t seed;        /* of photons and how they are dealt; probes are the same for all seeds */
    bool timing;          /* measure ns_per_query and cost_s, on one thread; off: they are NAN */
    const pm_parallel *parallel; /* NULL: serial */
    size_t threads;       /* how many trials `parallel` runs at once, each with maps of its own; 0 counts as 1 */
    double memory;        /* bytes that a case may take; 0: as many as it wants */

    /* Optional. progress: work done so far as a fraction, and the case in hand; may be called from any thread,
     * one at a time. canceled: asked now and then, from any thread; true stops at the end of the case before. */
    void (*progress)(void *context, double fraction, const char *what);
    bool (*canceled)(void *context);
    void *context;
} pm__accuracy_config;

enum { PM__DETAIL_SIZE = 160 };

/* NAN (intervals: low is NAN) stands for a value that does not exist. */

typedef struct pm__accuracy_row {
    const pm__spec *case_spec, *estimator_spec, *sampler_spec; /* into the config */
    const char *region;
    const char *paths;
    bool knn;              /* else fixed radius */
    size_t k;              /* 0 where there is none */
    double radius;         /* m; NAN: no limit */
    size_t photons;        /* actual */
    const char *search;
    size_t trials, probes;
    double truth_mean;     /* W/m2 */
    double rel_bias, rms_bias, rel_noise, rel_rmse;
    pm__interval rel_bias_ci95, rms_bias_ci95, rel_noise_ci95, rel_rmse_ci95;
    double predicted_rel_bias, predicted_rel_noise;
    double ns_per_query;
    pm__interval ns_per_query_ci95;
    double cost_s, efficiency;
    bool pareto;           /* no other row of this case, region and sampler is better in both cost_s and rel_rmse */
    const char *status;    /* "ok", "unsupported", "degenerate" */
    char detail[PM__DETAIL_SIZE];
} pm__accuracy_row;

/* Rows by case, sampler, photons, region, estimator, k. *rows is malloc'ed and the caller's (free). ECANCELED: the
 * rows of the cases that were complete are there all the same. ENOMEM, too where a case would need more than `memory`:
 * found out before it starts. EINVAL names the combination: k above the number
 * of photons (or below what an estimator needs a map), no k and no radius. A combination that an estimator cannot
 * do at all (the hull in a volume) has a row with status "unsupported". */
pm_status pm__accuracy_run(const pm__accuracy_config *config, pm__accuracy_row **rows, size_t *row_count,
                           pm_error *error);

#endif
