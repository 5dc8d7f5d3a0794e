/* The harness on synthetic clocks whose answers are known, and a little on the real one. Statistical bounds are 5.5
 * sigma of the binomial: a false alarm in 4e-8 each. */
#include "../../bench/harness.h"

#include "../../bench/counters.h"
#include "../../src/base/random.h"
#include "../test.h"

#include <gsl/gsl_cdf.h>
#include <string.h>

enum { MOST = 4, LOG = 4096 };

/* A machine whose time only moves when a variant runs. */
typedef struct machine {
    double time, noise;     /* s; sigma of a sample's logarithm */
    double drift;           /* relative, per second */
    double wave, period;    /* relative height and length (s) of a periodic disturbance */
    double spike;           /* probability that a sample takes 20 times as long */
    double hard_units;      /* units differ: every 4096th block of 1024 units costs this many times more */
    double tick;            /* the clock's resolution; 0: none */
    uint64_t seed, draws;
    size_t samples, cancel_after;
    int log[LOG];           /* which variant ran */
    size_t first[LOG], units[LOG];
} machine;

typedef struct work {
    machine *on;
    double seconds; /* a unit */
    int number;
} work;

static double machine_now(void *context)
{
    const machine *const m = context;
    return m->tick > 0.0 ? floor(m->time / m->tick) * m->tick : m->time;
}

static double slowness(machine *m, size_t first)
{
    double u[3];
    pm__random_uniform(m->seed, PM__FOR_TESTS, 7, m->draws++, u, 3);
    const double normal = sqrt(-2.0 * log1p(-u[0])) * cos(6.283185307179586 * u[1]);
    double factor = exp(m->noise * normal) * (1.0 + m->drift * m->time);
    if (m->wave > 0.0)
        factor *= 1.0 + m->wave * (fmod(m->time, m->period) < 0.3 * m->period);
    if (m->hard_units > 0.0 && (first / 1024) % 4 == 0)
        factor *= m->hard_units;
    return u[2] < m->spike ? 20.0 * factor : factor;
}

static void do_work(void *context, size_t first, size_t units)
{
    const work *const w = context;
    machine *const m = w->on;
    if (m->samples < LOG) {
        m->log[m->samples] = w->number;
        m->first[m->samples] = first;
        m->units[m->samples] = units;
    }
    m->samples++;
    m->time += (double)units * w->seconds * slowness(m, first);
}

static bool is_canceled(void *context)
{
    const machine *const m = context;
    return m->cancel_after && m->samples >= m->cancel_after;
}

/* Runs variants that take `relative` times a microsecond; the first is the baseline. */
static pm_status run(machine *m, const double *relative, size_t count, size_t rounds, pm__bench_report *report)
{
    work works[MOST];
    pm__bench_variant variants[MOST];
    for (size_t i = 0; i < count; i++) {
        works[i] = (work){m, 1e-6 * relative[i], (int)i};
        variants[i] = (pm__bench_variant){"work", do_work, &works[i]};
    }
    const pm__bench_config config = {.clock = {machine_now, m},
                                     .sample_seconds = 1e-3,
                                     .seconds = 0.0,
                                     .min_rounds = rounds,
                                     .max_rounds = rounds,
                                     .seed = m->seed,
                                     .canceled = is_canceled,
                                     .context = m};
    return pm__bench_run(&config, variants, count, report, NULL);
}

/* Noise alone; drift (10 % a second, hundreds of samples long); a wave whose period is near a round's length, near a
 * sample's, and far longer; one sample in twenty 20 times as long; units of different cost; all at once. */
static const machine machines[] = {
    {.noise = 0.02},
    {.noise = 0.01, .drift = 0.1},
    {.noise = 0.01, .drift = -0.2},
    {.noise = 0.01, .wave = 0.3, .period = 0.0042},
    {.noise = 0.01, .wave = 0.3, .period = 0.0011},
    {.noise = 0.01, .wave = 0.3, .period = 0.05},
    {.noise = 0.01, .spike = 0.05},
    {.noise = 0.01, .hard_units = 1.5},
    {.noise = 0.01, .drift = 0.05, .wave = 0.1, .period = 0.0035, .spike = 0.02, .hard_units = 1.1},
};
enum { MACHINES = sizeof machines / sizeof *machines };

static void check_rate(const char *what, size_t machine_number, size_t count, size_t runs, double rate, bool exact)
{
    const double mean = rate * (double)runs, sigma = sqrt(mean * (1.0 - rate));
    ck_assert_msg((double)count <= mean + 5.5 * sigma + 1.0, "%s on machine %zu: %zu of %zu, rate %g", what,
                  machine_number, count, runs, rate);
    if (exact)
        ck_assert_msg((double)count >= mean - 5.5 * sigma - 1.0, "%s on machine %zu: only %zu of %zu, rate %g", what,
                      machine_number, count, runs, rate);
}

/* Three variants of the same work. The order within a round is random, so under any disturbance the sign of a log-ratio
 * is a fair coin and the sign test exact: a pair of them alarms at its stated rate, no more and (without ties) no
 * less. */
START_TEST(identical_work_is_not_distinguishable)
{
    enum { RUNS = 1500, ROUNDS = 40 };
    static const double same[] = {1.0, 1.0, 1.0};
    double pair_rate;
    ck_assert(pm__sign_rank(ROUNDS, 1.0 - 0.05 / 2.0, &pair_rate) > 0);
    for (size_t k = 0; k < MACHINES; k++) {
        size_t control = 0, first = 0, any = 0;
        double control_rate = 0.0;
        for (uint64_t seed = 1; seed <= RUNS; seed++) {
            machine m = machines[k];
            pm__bench_report report;
            m.seed = seed;
            ck_assert_int_eq(run(&m, same, 3, ROUNDS, &report), PM_OK);
            control += report.aa_alarm;
            control_rate = report.false_alarm_rate;
            first += report.results[1].distinguishable;
            any += report.results[1].distinguishable || report.results[2].distinguishable;
            ck_assert(!report.results[0].distinguishable);
            pm__bench_free(&report);
        }
        ck_assert(control_rate > 0.01 && control_rate <= 0.05);
        check_rate("control", k, control, RUNS, control_rate, true);
        check_rate("one pair", k, first, RUNS, pair_rate, true);
        check_rate("family", k, any, RUNS, 0.05, false);
    }
}
END_TEST

/* The third variant is 3 % slower: found in all runs but a few, with the right sign, on every machine. */
START_TEST(a_planted_slow_down_is_found)
{
    enum { RUNS = 60, ROUNDS = 200 };
    static const double slower[] = {1.0, 1.0, 1.03};
    for (size_t k = 0; k < MACHINES; k++) {
        size_t found = 0;
        for (uint64_t seed = 1; seed <= RUNS; seed++) {
            machine m = machines[k];
            pm__bench_report report;
            m.seed = 1000 + seed;
            ck_assert_int_eq(run(&m, slower, 3, ROUNDS, &report), PM_OK);
            found += report.results[2].distinguishable && report.results[2].ratio < 1.0;
            pm__bench_free(&report);
        }
        ck_assert_msg(found + 1 >= RUNS, "machine %zu: found in %zu of %d runs", k, found, RUNS);
    }
}
END_TEST

/* Intervals that miss the truth are counted, for the ratio and for the time itself. */
START_TEST(intervals_cover)
{
    enum { RUNS = 4000, ROUNDS = 25 };
    static const double slower[] = {1.0, 1.03};
    size_t ratio_missed = 0, time_missed = 0;
    double rate;
    (void)pm__sign_rank(ROUNDS, 0.95, &rate);
    for (uint64_t seed = 1; seed <= RUNS; seed++) {
        machine m = {.noise = 0.03, .seed = 90000 + seed};
        pm__bench_report report;
        ck_assert_int_eq(run(&m, slower, 2, ROUNDS, &report), PM_OK);
        const pm__bench_result *const r = &report.results[1];
        ratio_missed += !(r->ratio_ci95.low <= 1.0 / 1.03 && 1.0 / 1.03 <= r->ratio_ci95.high);
        time_missed += !(r->ns_ci95.low <= 1030.0 && 1030.0 <= r->ns_ci95.high);
        ck_assert(r->ratio_ci95.low <= r->ratio && r->ratio <= r->ratio_ci95.high && r->ns_min <= r->ns_ci95.low);
        pm__bench_free(&report);
    }
    check_rate("ratio", 0, ratio_missed, RUNS, rate, true);
    check_rate("time", 0, time_missed, RUNS, rate, true);
}
END_TEST

START_TEST(ranks_are_those_of_the_binomial)
{
    static const double levels[] = {0.5, 0.9, 0.95, 0.99, 0.9375, 1.0 - 0.05 / 300.0};
    for (size_t l = 0; l < sizeof levels / sizeof *levels; l++)
        for (unsigned n = 1; n < 3000; n = n < 80 ? n + 1 : n * 2) {
            double missed;
            const double allowed = (1.0 - levels[l]) * (1.0 + 1e-8);
            const unsigned r = (unsigned)pm__sign_rank(n, levels[l], &missed);
            if (r)
                PM_CHECK_NEAR(missed, 2.0 * gsl_cdf_binomial_P(r - 1, 0.5, n), 1e-10);
            ck_assert(missed <= allowed);
            ck_assert(r >= n / 2 || 2.0 * gsl_cdf_binomial_P(r, 0.5, n) > allowed);
        }
    double values[] = {5, 1, 4, 2, 3, 6}; /* 2/2^6 = 0.031 */
    pm__interval interval;
    PM_CHECK_NEAR(pm__sign_interval(values, 6, 0.95, &interval), 3.5, 0.0);
    ck_assert(interval.low == 1.0 && interval.high == 6.0);
    PM_CHECK_NEAR(pm__sign_interval(values, 6, 0.75, &interval), 3.5, 0.0); /* 2 (1 + 6) / 2^6 = 0.22 */
    ck_assert(interval.low == 2.0 && interval.high == 5.0);
    ck_assert(isnan(pm__sign_interval(values, 0, 0.95, &interval)) && isnan(interval.low));
}
END_TEST

/* Five rounds cannot tell anything at 95 %, however different the variants are. */
START_TEST(few_rounds_say_nothing)
{
    static const double different[] = {1.0, 5.0};
    machine m = {.noise = 0.01, .seed = 3};
    pm__bench_report report;
    ck_assert_int_eq(run(&m, different, 2, 5, &report), PM_OK);
    ck_assert(!report.results[1].distinguishable && report.results[1].ratio_ci95.high < 0.3);
    ck_assert(!report.aa_alarm && report.false_alarm_rate == 0.0);
    pm__bench_free(&report);
    ck_assert_int_eq(run(&m, different, 2, 6, &report), PM_OK);
    ck_assert(report.results[1].distinguishable);
    pm__bench_free(&report);
}
END_TEST

/* Samples last long enough, start together, and do as much of the same work as the budget allows. */
START_TEST(samples_are_long_and_fair)
{
    static const double relative[] = {1.0, 20.0, 0.1};
    machine m = {.seed = 5, .noise = 0.001};
    pm__bench_report report;
    ck_assert_int_eq(run(&m, relative, 3, 12, &report), PM_OK);
    const size_t from = m.samples - 12 * 4;
    for (size_t round = 0; round < 12; round++) {
        size_t starts[4], seen = 0, twins = 0;
        for (size_t i = 0; i < 4; i++) {
            const size_t at = from + 4 * round + i;
            const int who = m.log[at];
            ck_assert((double)m.units[at] * 1e-6 * relative[who] >= 0.99e-3);
            twins += who == 0;
            starts[seen++] = m.first[at];
        }
        ck_assert_uint_eq(twins, 2);
        size_t most = 0;
        for (size_t i = 0; i < 4; i++) {
            size_t same = 0;
            for (size_t j = 0; j < 4; j++)
                same += starts[i] == starts[j];
            most = same > most ? same : most;
        }
        ck_assert_uint_eq(most, 3); /* all but the second baseline */
    }
    PM_CHECK_NEAR(report.results[1].ratio, 1.0 / 20.0, 0.001);
    PM_CHECK_NEAR(report.results[2].ns, 100.0, 1.0);
    pm__bench_free(&report);

    /* With time enough, all do the number of units that the fastest needs. */
    work works[] = {{&m, 1e-6, 0}, {&m, 5e-6, 1}};
    const pm__bench_variant variants[] = {{"a", do_work, &works[0]}, {"b", do_work, &works[1]}};
    const pm__bench_config config = {
        .clock = {machine_now, &m}, .sample_seconds = 1e-3, .seconds = 10.0, .max_rounds = 20};
    m.samples = 0;
    ck_assert_int_eq(pm__bench_run(&config, variants, 2, &report, NULL), PM_OK);
    for (size_t i = m.samples - 60; i < m.samples; i++)
        ck_assert_uint_eq(m.units[i], m.units[m.samples - 1]);
    ck_assert_uint_eq(report.results[0].samples, 20);
    pm__bench_free(&report);
}
END_TEST

/* A coarse clock only makes samples longer; one that never moves ends all the same. */
START_TEST(coarse_and_stopped_clocks)
{
    static const double relative[] = {1.0, 2.0};
    machine m = {.seed = 5, .tick = 1e-3};
    pm__bench_report report;
    ck_assert_int_eq(run(&m, relative, 2, 15, &report), PM_OK);
    for (size_t i = m.samples - 45; i < m.samples; i++)
        ck_assert((double)m.units[i] * 1e-6 * (m.log[i] ? 2.0 : 1.0) > 0.9e-3);
    pm__bench_free(&report);
    m = (machine){.seed = 5, .tick = 1e9};
    ck_assert_int_eq(run(&m, relative, 2, 12, &report), PM_OK);
    ck_assert(!report.results[1].distinguishable && isfinite(report.results[1].ratio));
    pm__bench_free(&report);
}
END_TEST

START_TEST(order_is_random_and_follows_the_seed)
{
    static const double relative[] = {1.0, 1.0, 1.0};
    enum { ROUNDS = 600 };
    static machine m[3];
    for (size_t i = 0; i < 3; i++) {
        pm__bench_report report;
        m[i] = (machine){.seed = i < 2 ? 11 : 12};
        ck_assert_int_eq(run(&m[i], relative, 3, ROUNDS, &report), PM_OK);
        pm__bench_free(&report);
    }
    ck_assert_uint_eq(m[0].samples, m[1].samples);
    ck_assert_int_eq(memcmp(m[0].log, m[1].log, sizeof m[0].log), 0);
    ck_assert_int_eq(memcmp(m[0].first, m[1].first, sizeof m[0].first), 0);
    ck_assert_int_ne(memcmp(m[0].log, m[2].log, sizeof m[0].log), 0);
    /* Every variant comes equally often at every place: variant 1 in a quarter of the rounds. */
    const size_t from = m[0].samples - 4 * ROUNDS;
    for (size_t place = 0; place < 4; place++) {
        size_t count = 0;
        for (size_t round = 0; round < ROUNDS; round++)
            count += m[0].log[from + 4 * round + place] == 1;
        PM_CHECK_NEAR((double)count, ROUNDS / 4.0, 5.5 * sqrt(ROUNDS * 0.25 * 0.75));
    }
}
END_TEST

START_TEST(cancellation_keeps_complete_rounds)
{
    static const double relative[] = {1.0, 1.0};
    machine m = {.seed = 1, .noise = 0.01};
    pm__bench_report report;
    ck_assert_int_eq(run(&m, relative, 2, 12, &report), PM_OK);
    const size_t before = m.samples - 36; /* the calibration */
    pm__bench_free(&report);
    m = (machine){.seed = 1, .noise = 0.01, .cancel_after = before + 10};
    ck_assert_int_eq(run(&m, relative, 2, 12, &report), PM_ECANCELED);
    ck_assert_uint_eq(report.results[0].samples, 3);
    ck_assert(isfinite(report.results[1].ratio) && !report.results[1].distinguishable);
    ck_assert_uint_eq(m.samples, before + 10);
    pm__bench_free(&report);
    m = (machine){.seed = 1, .cancel_after = 1};
    ck_assert_int_eq(run(&m, relative, 2, 12, &report), PM_ECANCELED);
    ck_assert_uint_eq(report.results[0].samples, 0);
    ck_assert(isnan(report.results[0].ns) && isnan(report.results[1].ratio) && isnan(report.aa_ratio));
    ck_assert(!report.results[1].distinguishable && !report.aa_alarm);
    pm__bench_free(&report);
}
END_TEST

static double last_fraction;

static void show(void *context, double fraction)
{
    (void)context;
    ck_assert(fraction >= last_fraction && fraction <= 1.0);
    last_fraction = fraction;
}

START_TEST(budget_is_kept)
{
    static const double budgets[] = {0.3, 1.0, 3.0};
    for (size_t i = 0; i < 3; i++)
        for (int slow = 0; slow < 2; slow++) {
            machine m = {.seed = 1, .noise = 0.02};
            work works[] = {{&m, 1e-6, 0}, {&m, slow ? 1e-3 : 3e-6, 1}};
            const pm__bench_variant variants[] = {{"a", do_work, &works[0]}, {"b", do_work, &works[1]}};
            const pm__bench_config config = {.clock = {machine_now, &m}, .seconds = budgets[i], .max_rounds = 1000000,
                                             .progress = show};
            pm__bench_report report;
            last_fraction = 0.0;
            ck_assert_int_eq(pm__bench_run(&config, variants, 2, &report, NULL), PM_OK);
            ck_assert_msg(m.time <= 1.02 * budgets[i] && m.time >= 0.85 * budgets[i], "%g s of %g", m.time, budgets[i]);
            ck_assert_uint_ge(report.results[0].samples, 12);
            PM_CHECK_NEAR(last_fraction, 1.0, 0.15);
            pm__bench_free(&report);
        }
    /* The least number of rounds is kept where the budget is too small. */
    machine m = {.seed = 1};
    static const double slow[] = {1e6, 1e6};
    pm__bench_report report;
    ck_assert_int_eq(run(&m, slow, 2, 7, &report), PM_OK);
    ck_assert_uint_eq(report.results[0].samples, 7);
    ck_assert_uint_eq(m.samples, 2 + 21);
    pm__bench_free(&report);
}
END_TEST

START_TEST(noise_outliers_and_warnings)
{
    static const double same[] = {1.0, 1.0};
    const struct {
        machine on;
        const char *warning;
    } rows[] = {{{.noise = 0.01, .seed = 4}, NULL},
                {{.noise = 0.5, .seed = 4}, "governor"},
                {{.noise = 0.01, .spike = 0.05, .seed = 4}, "outlier"},
                {{.noise = 0.01, .hard_units = 1.5, .seed = 6}, NULL}}; /* the work's own variety is no noise */
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        machine m = rows[i].on;
        pm__bench_report report;
        ck_assert_int_eq(run(&m, same, 2, 300, &report), PM_OK);
        ck_assert_msg(rows[i].warning ? report.warning && strstr(report.warning, rows[i].warning) : !report.warning,
                      "row %zu: %s", i, report.warning ? report.warning : "no warning");
        pm__bench_free(&report);
    }
    /* The median absolute deviation of a normal law is 0.6745 sigma; its standard error 1.17 / sqrt(n) of it. */
    machine m = {.noise = 0.01, .seed = 8};
    pm__bench_report report;
    ck_assert_int_eq(run(&m, same, 2, 2000, &report), PM_OK);
    PM_CHECK_NEAR(report.noise, 0.006745, 5.5 * 1.17 / sqrt(2000.0) * 0.006745);
    PM_CHECK_NEAR(report.aa_noise, 0.006745, 5.5 * 1.17 / sqrt(1000.0) * 0.006745);
    ck_assert_uint_le(report.results[0].outliers, 3); /* 4.7 sigma */
    pm__bench_free(&report);
    m = (machine){.noise = 0.01, .spike = 0.05, .seed = 8};
    ck_assert_int_eq(run(&m, same, 2, 2000, &report), PM_OK);
    PM_CHECK_NEAR((double)report.results[1].outliers, 100.0, 5.5 * sqrt(95.0));
    ck_assert_uint_eq(report.results[1].samples, 2000);
    double most = 0.0;
    for (size_t i = 0; i < 2000; i++) {
        most = fmax(most, report.results[1].ns_samples[i]);
        PM_CHECK_NEAR(report.results[1].ratio_samples[i],
                      report.results[0].ns_samples[i] / report.results[1].ns_samples[i], 1e-12);
    }
    ck_assert(most > 15000.0); /* never dropped */
    pm__bench_free(&report);
}
END_TEST

START_TEST(bad_configurations)
{
    pm__bench_report report;
    pm_error error;
    const pm__bench_config config = {.baseline = 1};
    const pm__bench_variant one = {"one", do_work, NULL};
    ck_assert_int_eq(pm__bench_run(&config, &one, 1, &report, &error), PM_EINVAL);
    ck_assert_int_eq(pm__bench_run(&config, &one, 0, &report, &error), PM_EINVAL);
    const pm__bench_config huge = {.max_rounds = SIZE_MAX / 2};
    ck_assert_int_eq(pm__bench_run(&huge, &one, 1, &report, &error), PM_ENOMEM);
    pm__bench_free(&report);
}
END_TEST

static void spin(void *context, size_t first, size_t units)
{
    volatile uint64_t *const sum = context;
    for (size_t i = 0; i < 64 * units; i++)
        *sum += first + i;
}

static void spin_twice(void *context, size_t first, size_t units)
{
    spin(context, first, 2 * units);
}

/* The real clock, and counters where there are any: twice the work takes about twice as long and as many
 * instructions. */
START_TEST(real_clock)
{
    uint64_t sum = 0;
    const pm__bench_variant variants[] = {{"once", spin, &sum}, {"twice", spin_twice, &sum}};
    const pm__bench_config config = {.sample_seconds = 2e-4, .seconds = 0.3, .counters = true};
    pm__bench_report report;
    ck_assert_int_eq(pm__bench_run(&config, variants, 2, &report, NULL), PM_OK);
    const pm__bench_result *const r = report.results;
    ck_assert_msg(r[1].ratio > 0.3 && r[1].ratio < 0.8, "ratio %g", r[1].ratio);
    ck_assert(isnan(r[0].instructions) || fabs(r[1].instructions / r[0].instructions - 2.0) < 0.1);
    pm__bench_free(&report);
    pm__counters none;
    double cycles, instructions;
    pm__counters_open(false, &none);
    pm__counters_start(&none);
    pm__counters_stop(&none, &cycles, &instructions);
    ck_assert(isnan(cycles) && isnan(instructions));
    pm__counters_close(&none);
}
END_TEST

PM_TEST_MAIN("harness", identical_work_is_not_distinguishable, a_planted_slow_down_is_found, intervals_cover,
             ranks_are_those_of_the_binomial, few_rounds_say_nothing, samples_are_long_and_fair,
             coarse_and_stopped_clocks, order_is_random_and_follows_the_seed, cancellation_keeps_complete_rounds,
             budget_is_kept, noise_outliers_and_warnings, bad_configurations, real_clock)
