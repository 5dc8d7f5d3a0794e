/* The comparison behind `photonbench search`: searches and peers on the same photons and queries, in one run.
 *
 * For each point set and number of photons every contender's index is built several times, interleaved, timed, and kept
 * once; then, for each k or radius and each order of queries, all are checked against brute force and timed against
 * each other by the harness. Where the indices do not fit in memory together, each is paired with the baseline
 * alone. */
#ifndef PM_BENCH_SEARCH_BENCH_H
#define PM_BENCH_SEARCH_BENCH_H

#include "../cases/case.h"
#include "contender.h"
#include "harness.h"
#include "workloads.h"

/* Bytes a photon that any index may take while it is built, peers' included. */
enum { PM__INDEX_BYTES = 130 };

typedef struct pm__search_config {
    const pm__spec *cases; /* of pm__workloads */
    size_t case_count;
    const size_t *photons;
    size_t photon_count;

    const char *given_name; /* photons of a file instead of cases; NULL: none */
    const pm_photon *given;
    const float (*given_normals)[3]; /* NULL: unknown */
    size_t given_count;

    const size_t *ks;
    size_t k_count;
    double radius;      /* m; 0: none */
    size_t radius_hits; /* the radius that finds so many in the median; 0: none */
    bool coherent, random;
    const pm__shape *filters; /* each is asked of all that can */
    size_t filter_count;

    const pm__contender *contenders;
    size_t contender_count;
    size_t brute_limit; /* brute force is left out above so many photons */

    size_t samples; /* rounds of the harness; 0: as many as the time allows */
    double seconds; /* for all, more or less: builds and the fewest rounds are done all the same */
    double memory;  /* bytes that it may take; 0: as many as it wants */
    size_t threads; /* of builds; queries run on one */
    uint64_t seed;
    const pm_parallel *parallel;
    void (*progress)(void *context, double fraction, const char *what);
    bool (*canceled)(void *context);
    void *context;
} pm__search_config;

typedef struct pm__search_row {
    size_t run; /* rows of the same number were timed against each other, round by round */
    pm__contender contender;
    const char *case_name;
    size_t photons;
    size_t k;      /* 0: fixed radius */
    double radius; /* m; NAN for the k nearest */
    pm__shape filter;
    size_t batch;
    bool coherent;
    size_t threads;
    double build_ms;
    pm__interval build_ms_ci95;
    double ns, ns_min;
    pm__interval ns_ci95;
    size_t samples, outliers;
    const char *baseline;
    double ratio; /* the baseline's time over this one's */
    pm__interval ratio_ci95;
    double *ratio_samples; /* [samples] */
    double cycles, instructions; /* per query; NAN where unknown */
    double aa_ratio;             /* of the run's A/A control */
    pm__interval aa_ci95;
    double aa_false_alarm_rate, noise;
    const char *warning; /* of the harness, or NULL */
    double bytes_per_photon;
    double count; /* photons found, mean */
    bool exact;
    const char *status; /* "ok", "inexact", "failed" */
    char detail[160];
} pm__search_row;

/* Rows in the order of the run; free by pm__search_free, also after an error. ECANCELED: the runs that were complete.
 * ENOMEM, too where a set and two indices of it would not fit into the free memory: found out before any run. Rows
 * refer to the config's names. */
pm_status pm__search_run(const pm__search_config *config, pm__search_row **rows, size_t *count, pm_error *error);
void pm__search_free(pm__search_row *rows, size_t count);

#endif
