/* The harness: calibration, rounds, and what comes out of them. */
#include "harness.h"

#include "../src/base/clock.h"
#include "../src/base/memory.h"
#include "../src/base/random.h"
#include "../src/base/status.h"
#include "counters.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MIN_ROUNDS = 12, MAX_ROUNDS = 400, GOOD_ROUNDS = 30, RECALIBRATIONS = 2 };
enum { ORDER_STREAM, BLOCK_STREAM };
static const size_t most_units = (size_t)1 << 30; /* in a sample, whatever the clock says */
static const double usual_sample = 2e-3, least_time = 1e-12;
static const double family_error = 0.05, loud = 0.05;

static double monotonic_now(void *context)
{
    (void)context;
    return pm__seconds();
}

pm__clock pm__monotonic_clock(void)
{
    return (pm__clock){monotonic_now, NULL};
}

/* A variant and its samples, one a round. */
typedef struct series {
    const pm__bench_variant *variant;
    size_t units;       /* in a sample */
    double unit_seconds; /* as calibrated */
    double *ns, *cycles, *instructions; /* per unit */
} series;

typedef struct session {
    pm__bench_config config; /* defaults filled in */
    series *all;             /* variants, then the baseline again */
    size_t count;            /* of all */
    size_t *order;           /* [count] */
    double *samples;         /* what `all` points into */
    double *scratch;         /* [max_rounds] */
    size_t rounds;           /* complete */
    double start;
    pm__counters counters;
} session;

static double now(const session *s)
{
    return s->config.clock.now(s->config.clock.context);
}

static bool is_canceled(const session *s)
{
    return s->config.canceled && s->config.canceled(s->config.context);
}

static void fill_defaults(pm__bench_config *config)
{
    if (!config->clock.now)
        config->clock = pm__monotonic_clock();
    if (!(config->sample_seconds > 0.0))
        config->sample_seconds = usual_sample;
    if (!config->min_rounds)
        config->min_rounds = MIN_ROUNDS;
    if (!config->max_rounds)
        config->max_rounds = MAX_ROUNDS;
    if (config->max_rounds < config->min_rounds)
        config->max_rounds = config->min_rounds;
}

static void session_free(session *s)
{
    free(s->all);
    free(s->order);
    free(s->samples);
    free(s->scratch);
}

static int session_init(session *s, const pm__bench_config *config, const pm__bench_variant *variants, size_t count)
{
    memset(s, 0, sizeof *s);
    s->config = *config;
    fill_defaults(&s->config);
    const size_t rounds = s->config.max_rounds;
    s->count = count + 1;
    s->all = pm__alloc_zero(s->count, sizeof *s->all);
    s->order = pm__alloc(s->count, sizeof *s->order);
    s->samples = rounds <= SIZE_MAX / 24 ? pm__alloc(s->count, 3 * rounds * sizeof *s->samples) : NULL;
    s->scratch = pm__alloc(rounds, sizeof *s->scratch);
    if (!s->all || !s->order || !s->samples || !s->scratch)
        return -1;
    for (size_t i = 0; i < s->count; i++) {
        double *const mine = s->samples + 3 * rounds * i;
        s->all[i] = (series){.variant = &variants[i < count ? i : config->baseline],
                             .ns = mine, .cycles = mine + rounds, .instructions = mine + 2 * rounds};
    }
    return 0;
}

/* Seconds that the units took; a clock that stood still counts as hardly anything. */
static double run_units(const session *s, const series *e, size_t first, size_t units)
{
    const double start = now(s);
    e->variant->run(e->variant->context, first, units);
    return fmax(now(s) - start, least_time);
}

/* Runs more and more units until they last long enough; this warms up, too. */
static double calibrate(const session *s, const series *e)
{
    const double enough = s->config.sample_seconds;
    size_t units = 1;
    double seconds = run_units(s, e, 0, units);
    while (seconds < enough && units < most_units && !is_canceled(s)) {
        const double wanted = 1.1 * (double)units * enough / seconds;
        const double low = 2.0 * (double)units, high = 100.0 * (double)units;
        units = (size_t)fmin(fmax(low, fmin(wanted, high)), (double)most_units);
        seconds = run_units(s, e, 0, units);
    }
    /* A moment's disturbance must not make all samples too short: the least time counts. */
    for (int i = 0; i < RECALIBRATIONS && units > 1 && !is_canceled(s); i++)
        seconds = fmin(seconds, run_units(s, e, 0, units));
    return seconds / (double)units;
}

/* Every variant gets the units that the fastest needs for a sample, or, where it is too slow for that, as many as its
 * share of the budget has time for; but always enough for the clock. */
static void choose_units(session *s)
{
    const double share = s->config.seconds / (GOOD_ROUNDS * (double)s->count);
    double least = (double)INFINITY;
    for (size_t i = 0; i + 1 < s->count; i++) {
        s->all[i].unit_seconds = calibrate(s, &s->all[i]);
        least = fmin(least, s->all[i].unit_seconds);
    }
    for (size_t i = 0; i + 1 < s->count; i++) {
        const double mine = s->all[i].unit_seconds, limit = (double)most_units;
        const double common = fmin(ceil(1.1 * s->config.sample_seconds / least), limit);
        const double needed = fmin(ceil(1.1 * s->config.sample_seconds / mine), limit);
        s->all[i].units = (size_t)fmax(1.0, fmin(common, fmax(needed, floor(share / mine))));
    }
    s->all[s->count - 1].units = s->all[s->config.baseline].units;
}

/* Fisher and Yates. */
static void shuffle(session *s, size_t round)
{
    for (size_t i = 0; i < s->count; i++)
        s->order[i] = i;
    for (size_t i = s->count - 1; i > 0; i--) {
        uint32_t words[4];
        pm__random_words(s->config.seed, PM__FOR_TIMING, ORDER_STREAM, round, (uint32_t)i, words);
        const size_t j = (size_t)(((uint64_t)words[0] << 32 | words[1]) % (i + 1));
        const size_t kept = s->order[i];
        s->order[i] = s->order[j];
        s->order[j] = kept;
    }
}

/* Where the units of a round start. */
static size_t block_of(const session *s, size_t round)
{
    uint32_t words[4];
    pm__random_words(s->config.seed, PM__FOR_TIMING, BLOCK_STREAM, round, 0, words);
    return (size_t)words[0];
}

static void sample(session *s, size_t index)
{
    const series *const e = &s->all[index];
    const bool twin = index == s->count - 1;
    const size_t round = s->rounds;
    const double units = (double)e->units;
    pm__counters_start(&s->counters);
    e->ns[round] = 1e9 * run_units(s, e, block_of(s, twin ? round ^ 1 : round), e->units) / units;
    pm__counters_stop(&s->counters, &e->cycles[round], &e->instructions[round]);
    e->cycles[round] /= units;
    e->instructions[round] /= units;
}

static void show_progress(const session *s)
{
    if (!s->config.progress)
        return;
    const double rounds = (double)s->rounds, spent = now(s) - s->start;
    const double by_time = s->config.seconds > 0.0 ? spent / s->config.seconds : 1.0;
    const double needed = fmin(by_time, rounds / (double)s->config.min_rounds);
    s->config.progress(s->config.context, fmin(1.0, fmax(needed, rounds / (double)s->config.max_rounds)));
}

/* Is there time for one more, as long as those so far? */
static bool wants_round(const session *s, double first_round)
{
    if (s->rounds < s->config.min_rounds)
        return true;
    const double spent = now(s), mean = (spent - first_round) / (double)s->rounds;
    return s->rounds < s->config.max_rounds && spent - s->start + mean <= s->config.seconds;
}

static pm_status run_rounds(session *s)
{
    const double first_round = now(s);
    while (wants_round(s, first_round)) {
        shuffle(s, s->rounds);
        for (size_t i = 0; i < s->count; i++) {
            if (is_canceled(s))
                return PM_ECANCELED;
            sample(s, s->order[i]);
        }
        s->rounds++;
        show_progress(s);
    }
    return is_canceled(s) ? PM_ECANCELED : PM_OK;
}

static double median_of(session *s, const double *values, pm__interval *interval)
{
    memcpy(s->scratch, values, s->rounds * sizeof *values);
    return pm__median_interval(s->scratch, s->rounds, interval);
}

/* Of counters; NAN if any sample lacks it. */
static double median_count(session *s, const double *values)
{
    pm__interval unused;
    for (size_t i = 0; i < s->rounds; i++)
        if (isnan(values[i]))
            return (double)NAN;
    return median_of(s, values, &unused);
}

/* Median of absolute deviations from `middle`; scratch holds the values. */
static double deviation(session *s, size_t n, double middle)
{
    pm__interval unused;
    for (size_t i = 0; i < n; i++)
        s->scratch[i] = fabs(s->scratch[i] - middle);
    return pm__median_interval(s->scratch, n, &unused);
}

/* scratch holds n values in order. */
static size_t count_outliers(const session *s, size_t n)
{
    size_t outliers = 0;
    if (!n)
        return 0;
    const double q1 = s->scratch[(n - 1) / 4], q3 = s->scratch[n - 1 - (n - 1) / 4];
    for (size_t i = 0; i < n; i++)
        outliers += s->scratch[i] < q1 - 3.0 * (q3 - q1) || s->scratch[i] > q3 + 3.0 * (q3 - q1);
    return outliers;
}

static int fill_result(session *s, size_t index, double level, pm__bench_result *result)
{
    const series *const e = &s->all[index], *const base = &s->all[s->config.baseline];
    pm__interval logs;
    double missed;
    const size_t n = s->rounds;
    result->samples = n;
    result->ns = median_of(s, e->ns, &result->ns_ci95);
    result->ns_min = n ? s->scratch[0] : (double)NAN;
    result->outliers = count_outliers(s, n);
    result->cycles = median_count(s, e->cycles);
    result->instructions = median_count(s, e->instructions);
    result->ns_samples = pm__alloc(n, sizeof *result->ns_samples);
    result->ratio_samples = pm__alloc(n, sizeof *result->ratio_samples);
    if (!result->ns_samples || !result->ratio_samples)
        return -1;
    memcpy(result->ns_samples, e->ns, n * sizeof *e->ns);
    for (size_t i = 0; i < n; i++) {
        result->ratio_samples[i] = base->ns[i] / e->ns[i];
        s->scratch[i] = log(result->ratio_samples[i]);
    }
    result->ratio = exp(pm__sign_interval(s->scratch, n, level, &logs));
    result->ratio_ci95 = (pm__interval){exp(logs.low), exp(logs.high)};
    result->distinguishable = pm__sign_rank(n, level, &missed) && (logs.low > 0.0 || logs.high < 0.0);
    return 0;
}

/* From the control, not the samples: units of the workload may well differ, and do so in the samples, but cancel
 * here. */
static const char *warning_for(const pm__bench_report *report, size_t pairs, size_t outliers)
{
    if (report->aa_noise > loud)
        return "the same work, timed twice, differs by more than 5 % as a rule: close other programs, "
               "set the frequency "
               "governor to performance, pin the program to one core (taskset -c 1), or give it more time";
    if (10 * outliers > pairs)
        return "more than one round in ten is an outlier: something else runs now and then; close it, or pin the "
               "program to a core of its own (taskset -c 1)";
    if (report->aa_alarm)
        return "the control, the same code timed as two variants, came out different, which chance alone does at the "
               "stated rate: run again, and if it stays so do not trust differences of its size";
    return NULL;
}

/* The baseline against itself. Rounds 2j and 2j+1 make a pair, in which the two do the same units, the other way
 * round. */
static void fill_control(session *s, pm__bench_report *report)
{
    const series *const a = &s->all[s->config.baseline], *const b = &s->all[s->count - 1];
    const size_t pairs = s->rounds / 2;
    pm__interval logs, unused;
    for (size_t j = 0; j < pairs; j++)
        s->scratch[j] = 0.5 * (log(a->ns[2 * j] / b->ns[2 * j]) + log(a->ns[2 * j + 1] / b->ns[2 * j + 1]));
    const double middle = pm__sign_interval(s->scratch, pairs, 1.0 - family_error, &logs);
    const size_t rank = pm__sign_rank(pairs, 1.0 - family_error, &report->false_alarm_rate);
    const size_t outliers = count_outliers(s, pairs);
    report->aa_ratio = exp(middle);
    report->aa_ci95 = (pm__interval){exp(logs.low), exp(logs.high)};
    report->aa_alarm = rank && (logs.low > 0.0 || logs.high < 0.0);
    report->aa_noise = deviation(s, pairs, middle);
    report->warning = warning_for(report, pairs, outliers);
    const double median = median_of(s, a->ns, &unused);
    report->noise = deviation(s, s->rounds, median) / median;
}

static pm_status summarize(session *s, pm__bench_report *report)
{
    const size_t compared = report->count > 1 ? report->count - 1 : 1;
    const double level = 1.0 - family_error / (double)compared;
    for (size_t i = 0; i < report->count; i++)
        if (fill_result(s, i, level, &report->results[i]))
            return PM_ENOMEM;
    fill_control(s, report);
    return PM_OK;
}

/* What was measured is summarized even where it was cut short. */
static pm_status measure(session *s, pm__bench_report *report)
{
    s->start = now(s);
    pm__counters_open(s->config.counters, &s->counters);
    choose_units(s);
    const pm_status status = run_rounds(s);
    pm__counters_close(&s->counters);
    const pm_status summarized = summarize(s, report);
    return summarized ? summarized : status;
}

pm_status pm__bench_run(const pm__bench_config *config, const pm__bench_variant *variants, size_t count,
                        pm__bench_report *report, pm_error *error)
{
    session s;
    memset(report, 0, sizeof *report);
    if (config->baseline >= count)
        return pm__fail(error, PM_EINVAL, "variant %zu is the baseline, but there are %zu", config->baseline, count);
    report->results = pm__alloc_zero(count, sizeof *report->results);
    report->count = count;
    pm_status status = PM_ENOMEM;
    if (session_init(&s, config, variants, count) == 0 && report->results)
        status = measure(&s, report);
    session_free(&s);
    if (status == PM_ENOMEM) {
        pm__bench_free(report);
        return pm__fail(error, status, "out of memory for the samples");
    }
    return status == PM_ECANCELED ? pm__fail(error, status, "canceled after %zu rounds", s.rounds) : PM_OK;
}

void pm__bench_free(pm__bench_report *report)
{
    for (size_t i = 0; report->results && i < report->count; i++) {
        free(report->results[i].ratio_samples);
        free(report->results[i].ns_samples);
    }
    free(report->results);
    memset(report, 0, sizeof *report);
}
