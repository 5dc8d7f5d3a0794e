/* The timing harness: how variants of the same work compare, with intervals, on a machine that is shared.
 *
 * All variants are run interleaved in random order, in rounds; a round gives each variant one sample: the time of
 * enough repetitions for the clock. Ratios are taken within rounds, so drift and other users cancel. The ratio's
 * interval is the distribution-free one of the median of paired log-ratios (the inversion of the sign test), at a level
 * corrected for the number of comparisons (Bonferroni); a variant's own time has the median's 95 % interval from order
 * statistics. Outliers are counted and reported, never dropped. Each run holds an A/A control: the baseline twice, as
 * two variants; it must come out as "not distinguishable" but for the stated false-alarm rate.
 *
 * Within a round all variants start at the same unit, drawn at random, and do as many units as the budget allows them
 * of the number that the fastest needs, so that ratios are of the same work as far as can be. Only the second baseline
 * starts elsewhere, or one of the two would find the other's memory in the cache and seem faster than it is to
 * everyone else; in the next round the two change places, and their ratio is taken over both rounds. */
#ifndef PM_BENCH_HARNESS_H
#define PM_BENCH_HARNESS_H

#include "../src/photonmap.h"
#include "../src/stats/stats.h"

/* Where time comes from, so that tests can plant it. */
typedef struct pm__clock {
    double (*now)(void *context); /* seconds, monotonic */
    void *context;
} pm__clock;

pm__clock pm__monotonic_clock(void);

/* One variant of the work. run does `repetitions` units of it (one query each, say), starting at unit `first` of an
 * endless cycle; it must do the same work for the same numbers. */
typedef struct pm__bench_variant {
    const char *name;
    void (*run)(void *context, size_t first, size_t repetitions);
    void *context;
} pm__bench_variant;

typedef struct pm__bench_config {
    pm__clock clock;
    double sample_seconds;  /* a sample lasts at least this: 2 ms if 0 */
    double seconds;         /* budget for all; at least min_rounds are run all the same */
    size_t min_rounds, max_rounds; /* 12 and 400 if 0 */
    size_t baseline;        /* index of the variant that the others are compared with */
    uint64_t seed;          /* of the order */
    bool counters; /* cycles and instructions of the calling thread in user mode, where the kernel gives them */
    bool (*canceled)(void *context);
    void (*progress)(void *context, double fraction);
    void *context;
} pm__bench_config;

typedef struct pm__bench_result {
    double ns;              /* per unit: median over rounds */
    pm__interval ns_ci95;
    double ns_min;
    size_t samples, outliers; /* samples beyond 3 interquartile ranges of the quartiles */
    double ratio;           /* baseline's time over this one's: above 1 is faster; median of paired ratios */
    pm__interval ratio_ci95; /* family-wise over the variants compared */
    bool distinguishable;   /* the interval excludes 1 */
    double cycles, instructions; /* per unit; NAN where unknown */
    double *ratio_samples;  /* [samples]: per round, the caller's (free by pm__bench_free) */
    double *ns_samples;     /* [samples] */
} pm__bench_result;

typedef struct pm__bench_report {
    pm__bench_result *results; /* [count], in the order of the variants */
    size_t count;
    double aa_ratio;        /* of the A/A control */
    pm__interval aa_ci95;
    bool aa_alarm;          /* its interval excludes 1: the machine or the harness is not to be trusted */
    double false_alarm_rate; /* of that: exact, at most 0.05; 0 where there are too few rounds for an alarm */
    double noise;           /* median absolute deviation of the baseline's samples over their median */
    double aa_noise;        /* the same of the A/A control's ratios: here what differs between units cancels */
    const char *warning;    /* NULL, or what is wrong and its remedy */
} pm__bench_report;

/* ECANCELED: the rounds that were complete are in the report; free it then too. EINVAL: no variants, or no such
 * baseline; ENOMEM. Runs on the calling thread. */
pm_status pm__bench_run(const pm__bench_config *config, const pm__bench_variant *variants, size_t count,
                        pm__bench_report *report, pm_error *error);
void pm__bench_free(pm__bench_report *report);

/* Median of n values and the interval for the median that covers with `level` (0.95, or more after correction) at
 * least: the sign test's. values are sorted in place. The range where n is too small for the level. */
double pm__sign_interval(double *values, size_t n, double level, pm__interval *interval);

/* The rank r of that interval, [x_r, x_(n+1-r)] counted from 1, and the probability that it misses the median; 0 and 0
 * where n is too small for the level. */
size_t pm__sign_rank(size_t n, double level, double *missed);

#endif
