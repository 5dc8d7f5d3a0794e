/* Inside the comparison of searches. */
#ifndef PM_BENCH_SEARCH_INSIDE_H
#define PM_BENCH_SEARCH_INSIDE_H

#include "search_bench.h"

/* An index with the times of its builds. */
typedef struct pm__built {
    pm__bench_index index; /* no index: could not be built */
    double ms;
    pm__interval ms_ci95;
    char problem[160];
} pm__built;

/* One point set, and which contenders are compared on it together. */
typedef struct pm__search_group {
    const pm__search_config *config;
    const char *case_name;
    pm__bench_photons photons;
    const pm_surface_point *queries[2]; /* random, coherent; query_count of each, NULL: not asked for */
    size_t query_count;
    pm__built *built;
    size_t built_count, baseline;
    size_t weight;      /* of its runs in the sharing of time */
    bool hide_baseline; /* its rows come from another group */
} pm__search_group;

/* Results so far, and where the run stands. */
typedef struct pm__search_progress {
    pm__search_row *rows;
    size_t count, capacity;
    size_t weight, weight_done, runs_done;
    double start; /* s */
} pm__search_progress;

double pm__search_clock(void); /* s */

/* search_build.c: fills in built[i] for the contenders set there. What cannot be built has a problem. ECANCELED. */
pm_status pm__search_build(pm__search_group *group);

/* search_compare.c: one run. k = 0: fixed radius, from the config. */
pm_status pm__search_compare(const pm__search_group *group, size_t k, bool coherent, pm__search_progress *progress,
                             pm_error *error);

#endif
