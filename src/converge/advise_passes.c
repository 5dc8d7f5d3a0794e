/* Advice on progressive methods: pilots of some passes, extended by the law's slopes. */
#include "advising.h"

#include "../base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 32, PILOT_PASSES = 32, FEWEST_PASSES = 4, PILOT_TRIALS = 4, TIMED_PASSES = 2, CHECK_TRIALS = 4 };
enum { NEAR = 2, ROUNDS = 2 };
const double pm__advise_alpha = 0.667;

typedef struct progress_stage {
    const pm__advise_config *config;
} progress_stage;

static bool is_canceled(void *context)
{
    const progress_stage *const s = context;
    return s->config->canceled && s->config->canceled(s->config->context);
}

static void report(void *context, double fraction, const char *what)
{
    const progress_stage *const s = context;
    if (s->config->progress)
        s->config->progress(s->config->context, fraction, what);
}

typedef struct series_order {
    const pm__advise_config *config;
    const pm__spec *method;
    const pm_estimator *kernel;
    uint64_t seed;
    size_t width, height;
} series_order;

static const pm__progressive *method_of(const series_order *o)
{
    return (const pm__progressive *)(const void *)o->method->entry;
}

static pm__progressive_config progressive_of(const series_order *o, progress_stage *stage, bool parallel)
{
    return (pm__progressive_config){.scene = o->config->subject,
                                    .width = o->width,
                                    .height = o->height,
                                    .method = o->method,
                                    .estimator = o->kernel,
                                    .alpha = pm__advise_alpha,
                                    .k = PM__ADVISE_K,
                                    .photons = PM__ADVISE_PASS,
                                    .front_only = true,
                                    .seed = o->seed,
                                    .parallel = parallel ? o->config->parallel : NULL,
                                    .canceled = is_canceled,
                                    .context = stage};
}

static pm_status run_series(const series_order *o, size_t trials, uint32_t passes, pm__converge_series *series,
                            pm_error *error)
{
    progress_stage stage = {o->config};
    const pm__converge_config config = {
        .progressive = progressive_of(o, &stage, true), .trials = trials, .passes = passes, .progress = report};
    const pm_status status = pm__converge(&config, series, error);
    return status == PM_OK && series->interrupted ? PM_ECANCELED : status;
}

/* Seconds of so many passes on one thread. */
static pm_status time_passes(const series_order *o, uint32_t passes, double *seconds, pm_error *error)
{
    progress_stage stage = {o->config};
    const pm__progressive_config config = progressive_of(o, &stage, false);
    pm__progression progression;
    pm__run run;
    pm_status status = pm__progression_open(&config, &progression, error);
    if (status != PM_OK)
        return status;
    const double start = pm__seconds();
    status = pm__run_begin(&progression, 0, &run, error);
    if (status == PM_OK) {
        for (uint32_t i = 0; i < passes && status == PM_OK; i++)
            status = is_canceled(&stage) ? PM_ECANCELED : pm__run_pass(&run, error);
        pm__run_end(&run);
    }
    *seconds = pm__seconds() - start;
    pm__progression_close(&progression);
    return status;
}

/* Slopes of variance and squared bias against passes, as they fall: those of the law that the method follows. One whose
 * law is not known is taken to shrink; means of biased maps keep their bias. */
static void slopes_of(const series_order *o, double *variance, double *bias2)
{
    const pm__progressive *const method = method_of(o);
    const bool mean = method->law == PM__LAW_MEAN || method->law == PM__LAW_POOLED || method->law == PM__LAW_UNBIASED;
    const double kept = method->law == PM__LAW_GROWING ? pm__spec_value(o->method, "beta", pm__advise_alpha)
                                                       : pm__advise_alpha;
    *variance = mean ? 1.0 : kept;
    *bias2 = mean ? 0.0 : 2.0 * (1.0 - kept);
}

/* A bias that does not stand clear of the noise is none. */
static double bias_of(const pm__converge_row *row)
{
    if (isfinite(row->predicted_rms_bias))
        return row->predicted_rms_bias;
    return row->rms_bias_ci95.low > 0.0 ? row->rms_bias : 0.0;
}

static pm__pass_law fit(const series_order *o, const pm__converge_series *series)
{
    pm__pass_sample samples[PM__MOST_RECORDS];
    double variance_slope, bias2_slope;
    for (size_t r = 0; r < series->row_count; r++) {
        const pm__converge_row *const row = &series->rows[r];
        const double bias = bias_of(row);
        const double noise = isfinite(row->predicted_rel_noise) ? row->predicted_rel_noise : row->rel_noise;
        samples[r] = (pm__pass_sample){(double)row->pass, noise * noise, bias * bias};
    }
    slopes_of(o, &variance_slope, &bias2_slope);
    return pm__pass_law_fit(samples, series->row_count, variance_slope, bias2_slope);
}

/* Photons are the limit of methods that emit them. */
static double passes_allowed(const series_order *o)
{
    const double photons = method_of(o)->uses_photons ? (double)o->config->most_photons : 0.0;
    return photons > 0.0 ? floor(fmin(PM__ADVISE_MOST_PASSES, photons / PM__ADVISE_PASS)) : PM__ADVISE_MOST_PASSES;
}

/* Why the error is out of reach. */
static void say_why(const series_order *o, const pm__pass_law *law, pm__advice *a)
{
    const double left = 100.0 * a->predicted_rel_rmse, stays = pm__pass_floor(law);
    const bool bounded = passes_allowed(o) < PM__ADVISE_MOST_PASSES;
    if (stays > o->config->error && !(law->variance_1 > 0.0))
        (void)snprintf(a->detail, sizeof a->detail, "every pass gives the same answer: %.3g %% is left however many "
                       "there are", left);
    else if (stays > o->config->error)
        (void)snprintf(a->detail, sizeof a->detail, "more passes do not help: a bias of %.3g %% is left however many "
                       "there are", 100.0 * stays);
    else
        (void)snprintf(a->detail, sizeof a->detail, "after %u pass%s, the most that %s, %.3g %% is left", a->passes,
                       a->passes == 1 ? "" : "es", bounded ? "so few photons allow" : "are considered", left);
}

static void write_advice(const series_order *o, const pm__pass_law *law, double pass_seconds, pm__advice *a)
{
    const double most = passes_allowed(o), wanted = pm__pass_solve(law, o->config->error, most);
    const double passes = wanted > 0.0 ? wanted : pm__pass_nearest(law, most);
    a->k = pm__progressive_looks_up(method_of(o)) ? PM__ADVISE_K : 0;
    a->photons = method_of(o)->uses_photons ? PM__ADVISE_PASS : 0;
    a->passes = (uint32_t)passes;
    a->trials = CHECK_TRIALS;
    a->width = o->width;
    a->height = o->height;
    a->predicted_rel_noise = sqrt(law->variance_1 * pow(passes, -law->variance_slope));
    a->predicted_rel_bias = sqrt(law->bias2_1 * pow(passes, -law->bias2_slope));
    a->predicted_rel_rmse = pm__pass_error(law, passes);
    a->predicted_seconds = passes * pass_seconds;
    a->status = wanted > 0.0 ? "ok" : "unreachable";
    *a->detail = '\0';
    if (!(wanted > 0.0))
        say_why(o, law, a);
}

/* Passes of the next pilot: as many as the answer's, or as the time left allows; 0: what there is is near enough. */
static uint32_t next_passes(const pm__advising *a, const pm__advice *advice, uint32_t done, double pass_seconds)
{
    const double threads = a->config->threads ? (double)a->config->threads : 1.0;
    const double fit_in = pm__advise_time_left(a) * threads / (PILOT_TRIALS * pass_seconds);
    const double next = fmin(advice->passes, fit_in);
    return advice->passes <= NEAR * done || next < 2.0 * done ? 0 : (uint32_t)next;
}

/* Of the first pilot: few enough for the time left, but as many as a slope takes. */
static uint32_t first_passes(const pm__advising *a, const series_order *o, double pass_seconds)
{
    const double threads = a->config->threads ? (double)a->config->threads : 1.0;
    const double fit_in = pm__advise_time_left(a) * threads / (PILOT_TRIALS * pass_seconds);
    const double passes = fmin(fmax(fit_in, FEWEST_PASSES), PILOT_PASSES);
    return (uint32_t)fmin(passes, passes_allowed(o));
}

static pm_status study(pm__advising *a, const series_order *o, pm__advice *advice, pm_error *error)
{
    double seconds = 0.0;
    if (passes_allowed(o) < 1.0)
        return pm__fail(error, PM_EINVAL, "a pass emits %d photons, and %zu is the most that there may be",
                        PM__ADVISE_PASS, o->config->most_photons);
    pm_status status = time_passes(o, TIMED_PASSES, &seconds, error);
    uint32_t passes = first_passes(a, o, seconds / TIMED_PASSES);
    for (int round = 0; round < ROUNDS && passes && status == PM_OK; round++) {
        pm__converge_series series;
        status = run_series(o, PILOT_TRIALS, passes, &series, error);
        if (status == PM_OK) {
            const pm__pass_law law = fit(o, &series);
            write_advice(o, &law, seconds / TIMED_PASSES, advice);
            passes = next_passes(a, advice, passes, seconds / TIMED_PASSES);
        }
        pm__converge_free(&series);
    }
    return status;
}

/* Any, where it does not matter. */
static pm_status make_kernel(const pm__spec *estimator, pm_estimator **kernel, pm_error *error)
{
    char name[PM__MAX_SPEC] = "disc";
    if (estimator->entry)
        pm__spec_format(estimator, name, sizeof name);
    return pm_estimator_create(name, kernel, error);
}

/* Of what the advice is about. The kernel: pm_estimator_destroy. */
static pm_status make_order(const pm__advise_config *config, const pm__advice *advice, uint64_t seed,
                            pm_estimator **kernel, series_order *o, pm_error *error)
{
    const pm_status status = make_kernel(&advice->estimator, kernel, error);
    *o = (series_order){config, &advice->method, *kernel, seed, SIDE, SIDE};
    (void)pm__converge_reference_size(config->subject, &o->width, &o->height);
    return status;
}

pm_status pm__advise_passes(pm__advising *a, const pm__spec *method, const pm__spec *estimator, pm_error *error)
{
    pm__advice *const advice = &a->advice[a->count++];
    pm_estimator *kernel = NULL;
    series_order o;
    *advice = (pm__advice){.method = *method, .status = "ok"};
    if (estimator)
        advice->estimator = *estimator;
    pm_status status = make_order(a->config, advice, pm__advise_pilot_seed(a->config), &kernel, &o, error);
    if (status == PM_OK)
        status = study(a, &o, advice, error);
    pm_estimator_destroy(kernel);
    if (status == PM_EINVAL) {
        pm__advise_unsupported(advice, error->text);
        status = PM_OK;
    }
    return status;
}

static pm_status run_and_time(const series_order *o, pm__advice *advice, pm_error *error)
{
    pm__converge_series series;
    pm_status status = run_series(o, advice->trials, advice->passes, &series, error);
    if (status == PM_OK) {
        const pm__converge_row *const last = &series.rows[series.row_count - 1];
        advice->reached_rel_rmse = last->rel_rmse;
        advice->reached_rel_rmse_ci95 = last->rel_rmse_ci95;
        status = time_passes(o, advice->passes, &advice->reached_seconds, error);
    }
    pm__converge_free(&series);
    return status;
}

pm_status pm__advise_verify_passes(const pm__advise_config *config, pm__advice *advice, pm_error *error)
{
    pm_estimator *kernel = NULL;
    series_order o;
    pm_status status = make_order(config, advice, config->seed, &kernel, &o, error);
    if (status == PM_OK)
        status = run_and_time(&o, advice, error);
    pm_estimator_destroy(kernel);
    return status;
}
