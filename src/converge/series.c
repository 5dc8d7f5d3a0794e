#include "measuring.h"

#include "../base/clock.h"
#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEWEST = 8 }; /* passes before a run's estimate of its error is believed */

static const pm__progressive *method_of(const pm__converge_config *config)
{
    return (const pm__progressive *)(const void *)config->progressive.method->entry;
}

static bool is_canceled(const pm__converge_config *config)
{
    return config->progressive.canceled && config->progressive.canceled(config->progressive.context);
}

static void report(const pm__measuring *m, size_t trial, uint32_t pass)
{
    const pm__converge_config *const config = m->config;
    const double last = (double)m->passes[m->records - 1], trials = (double)config->trials;
    double part = ((double)trial + pass / last) / trials;
    if (config->seconds > 0.0)
        part = fmax(part, fmin((pm__seconds() - m->start) / config->seconds, 1.0));
    if (config->progress)
        config->progress(config->progressive.context, part, config->progressive.scene->entry->name);
}

/* ---- What is read when ------------------------------------------------------------------------- */

/* After 1, 2, 4, ... passes and the last. */
static void set_records(pm__measuring *m, uint32_t last)
{
    m->records = 0;
    for (uint64_t pass = 1; pass < last && m->records < PM__MOST_RECORDS - 1; pass *= 2)
        m->passes[m->records++] = (uint32_t)pass;
    m->passes[m->records++] = last;
}

static uint32_t most_passes(const pm__converge_config *config)
{
    const uint64_t each = config->progressive.photons ? config->progressive.photons : 1;
    const bool limited = config->photons && method_of(config)->uses_photons; /* none that are not emitted end it */
    const uint64_t by_photons = limited ? (config->photons + each - 1) / each : UINT32_MAX;
    return by_photons < config->passes ? (uint32_t)by_photons : config->passes;
}

/* ---- Trials ------------------------------------------------------------------------------------ */

static void watch(const pm__measuring *m, const pm__run *run, size_t record)
{
    const pm__converge_config *const config = m->config;
    for (size_t i = 0; i < config->watched_count; i++) {
        const size_t point = config->watched[i];
        const pm__point_view view = pm__run_view(run, point);
        pm__converge_point *const to = &m->series->watched[record * config->watched_count + i];
        *to = (pm__converge_point){
            .point = point, .pass = run->passes, .radius = view.radius, .count = view.count, .truth = {NAN, NAN, NAN}};
        memcpy(to->radiance, m->radiance[point], sizeof to->radiance);
        for (size_t v = 0; v < m->yardstick.values && m->yardstick.block == 1; v++)
            if (m->yardstick.point[v] == point)
                memcpy(to->truth, &m->yardstick.truth[3 * v], sizeof to->truth);
    }
}

static pm_status record(pm__measuring *m, pm_error *error)
{
    const size_t values = 3 * m->yardstick.values, trial = m->series->trials, index = m->record;
    pm__run *const run = &m->run;
    pm__converge_row *const row = &m->series->rows[index];
    const pm_status status = pm__run_read(run, m->radiance, error);
    if (status != PM_OK)
        return status;
    float *const e = m->errors + (trial * m->room + index) * values;
    pm__yardstick_measure(&m->yardstick, m->progression.config->width, (const double(*)[3])m->radiance, e);
    pm__measuring_own_record(m, e);
    if (trial == 0) {
        *row = (pm__converge_row){.pass = run->passes,
                                  .photons = run->emitted,
                                  .seconds = pm__seconds() - m->start,
                                  .predicted_rel_bias = NAN,
                                  .predicted_rms_bias = NAN,
                                  .predicted_rel_noise = NAN};
        watch(m, run, index);
    }
    m->record++;
    return PM_OK;
}

/* Is the first run's time up? Later runs do the same passes. */
static bool is_time_up(const pm__measuring *m)
{
    const pm__converge_config *const config = m->config;
    return m->series->trials == 0 && config->seconds > 0.0 &&
           pm__seconds() - m->start >= config->seconds / (double)config->trials;
}

/* Does the first run say that it is good enough? */
static bool is_good_enough(const pm__measuring *m)
{
    return m->series->trials == 0 && m->estimated && m->run.passes >= FEWEST &&
           pm__measuring_own_error(m) <= m->config->error;
}

static pm_status save(pm__measuring *m, pm_error *error)
{
    const pm__converge_config *const config = m->config;
    pm__saved saved;
    if (!config->save)
        return PM_OK;
    pm_status status = pm__measuring_save(m, &saved, error);
    if (status == PM_OK)
        status = config->save(config->progressive.context, &saved, error);
    free(saved.bytes);
    m->saved = pm__seconds();
    return status;
}

static pm_status run_pass(pm__measuring *m, pm_error *error)
{
    const pm__converge_config *const config = m->config;
    if (is_canceled(config))
        return PM_ECANCELED;
    pm_status status = pm__run_pass(&m->run, error);
    report(m, m->series->trials, m->run.passes);
    const bool good = status == PM_OK && is_good_enough(m);
    if (status == PM_OK && (good || is_time_up(m))) {
        m->series->reached = good;
        set_records(m, m->run.passes);
        m->record = m->records - 1;
    }
    if (status == PM_OK && config->save_seconds > 0.0 && pm__seconds() - m->saved >= config->save_seconds)
        status = save(m, error);
    return status;
}

/* The trial in hand to its end. */
static pm_status run_trial(pm__measuring *m, pm_error *error)
{
    pm_status status = PM_OK;
    while (m->record < m->records && status == PM_OK) {
        while (m->run.passes < m->passes[m->record] && status == PM_OK)
            status = run_pass(m, error);
        if (status == PM_OK)
            status = record(m, error);
    }
    return status;
}

static pm_status run_trials(pm__measuring *m, pm_error *error)
{
    pm_status status = PM_OK;
    while (m->series->trials < m->config->trials && status == PM_OK) {
        if (!m->run.of)
            status = pm__run_begin(&m->progression, (uint32_t)m->series->trials, &m->run, error);
        if (status == PM_OK)
            status = run_trial(m, error);
        if (status != PM_OK)
            break;
        pm__run_end(&m->run);
        m->series->trials++;
        m->record = 0;
    }
    m->series->interrupted = status == PM_ECANCELED;
    return status == PM_OK || m->series->interrupted ? save(m, error) : status;
}

/* ---- Rows -------------------------------------------------------------------------------------- */

/* The expected bias of each measured value after each record, and the law's moments. NULL: there is no law. */
static pm_status expect(const pm__measuring *m, double **profile, double law[PM__QUANTITIES][PM__MOST_RECORDS],
                        pm_error *error)
{
    const size_t values = m->yardstick.values, points = m->progression.points;
    for (int q = 0; q < PM__QUANTITIES; q++)
        for (size_t r = 0; r < PM__MOST_RECORDS; r++)
            law[q][r] = NAN;
    *profile = NULL;
    if (!m->expectation.lawful)
        return PM_OK;
    *profile = pm__alloc(3 * values * m->records, sizeof **profile);
    if (!*profile)
        return pm__fail(error, PM_ENOMEM, "out of memory for what is expected");
    for (size_t r = 0; r < m->records; r++) {
        double sum = 0.0, squares = 0.0, variance = 0.0;
        for (size_t v = 0; v < values; v++) {
            const size_t at = r * points + m->yardstick.point[v];
            const double bias = m->expectation.bias[at];
            for (size_t b = 0; b < 3; b++)
                (*profile)[(r * values + v) * 3 + b] = bias;
            sum += bias / (double)values;
            squares += bias * bias / (double)values;
            variance += m->expectation.variance[at] / (double)values;
        }
        const double scale = 1.0 / m->yardstick.truth_mean;
        m->series->rows[r].predicted_rel_bias = sum * scale;
        m->series->rows[r].predicted_rms_bias = law[PM__BIAS][r] = sqrt(squares) * scale;
        m->series->rows[r].predicted_rel_noise = sqrt(variance) * scale;
        law[PM__VARIANCE][r] = variance * scale * scale;
        law[PM__RMSE][r] = sqrt(squares + variance) * scale;
    }
    return PM_OK;
}

static pm_status summarize(const pm__measuring *m, const pm__record_set *set, pm_error *error)
{
    double *const scratch = pm__alloc(set->values + 3 * set->trials, sizeof *scratch);
    if (!scratch)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu values", set->values);
    const double scale = set->scale;
    for (size_t r = 0; r < set->records; r++) {
        pm__converge_row *const row = &m->series->rows[r];
        const pm__trial_errors errors = {pm__record_errors(set, r), set->trials, set->values,
                                         set->records * set->values};
        pm__error_summary s;
        pm__summarize_errors(&errors, scratch, &s);
        row->rel_bias = s.bias * scale;
        row->rms_bias = s.rms_bias * scale;
        row->rel_noise = s.noise * scale;
        row->rel_rmse = s.rmse * scale;
        row->rel_bias_ci95 = (pm__interval){s.bias_ci95.low * scale, s.bias_ci95.high * scale};
        row->rms_bias_ci95 = (pm__interval){s.rms_bias_ci95.low * scale, s.rms_bias_ci95.high * scale};
        row->rel_noise_ci95 = (pm__interval){s.noise_ci95.low * scale, s.noise_ci95.high * scale};
        row->rel_rmse_ci95 = (pm__interval){s.rmse_ci95.low * scale, s.rmse_ci95.high * scale};
        const pm__along along = pm__bias_along(set, r, scratch);
        row->along = set->profile ? along.value : NAN;
        row->along_error = set->profile ? along.error : NAN;
    }
    free(scratch);
    return PM_OK;
}

/* What slopes tend to: variance i^-alpha, bias i^(alpha - 1), the error what falls more slowly. */
static void set_asymptotes(const pm__progressive_config *config, pm__converge_fit fits[PM__QUANTITIES])
{
    const pm__progressive *const method = (const pm__progressive *)(const void *)config->method->entry;
    const double alpha = config->alpha;
    const bool independent = method->law == PM__LAW_MEAN || method->law == PM__LAW_POOLED;
    if (method->law == PM__LAW_SHRINKING) {
        fits[PM__VARIANCE].asymptote = -alpha;
        fits[PM__BIAS].asymptote = alpha - 1.0;
        fits[PM__RMSE].asymptote = fmax(-0.5 * alpha, alpha - 1.0);
    } else if (independent) {
        fits[PM__VARIANCE].asymptote = -1.0;
        fits[PM__BIAS].asymptote = fits[PM__RMSE].asymptote = 0.0;
    } else if (method->law == PM__LAW_UNBIASED) {
        fits[PM__VARIANCE].asymptote = fits[PM__VARIANCE].predicted = -1.0;
        fits[PM__RMSE].asymptote = fits[PM__RMSE].predicted = -0.5;
    }
}

/* Errors of records side by side: set_records may have made fewer than there was room for. */
static void close_up(pm__measuring *m)
{
    const size_t row = m->records * 3 * m->yardstick.values, room = m->room * 3 * m->yardstick.values;
    for (size_t t = 1; t < m->series->trials; t++)
        memmove(m->errors + t * row, m->errors + t * room, row * sizeof *m->errors);
}

/* Of the passes that were done, where time cut them short. Canceled, rows go without. */
static pm_status expect_again(pm__measuring *m, pm_error *error)
{
    if (!m->expectation.lawful || m->passes[m->records - 1] == most_passes(m->config))
        return PM_OK;
    pm__expectation_destroy(&m->expectation);
    const pm_status status = pm__expectation_create(&m->progression, m->passes, m->records, &m->expectation, error);
    return status == PM_ECANCELED ? PM_OK : status;
}

static pm_status finish(pm__measuring *m, pm_error *error)
{
    pm__converge_series *const series = m->series;
    double law[PM__QUANTITIES][PM__MOST_RECORDS], *profile = NULL;
    if (series->trials < 2)
        return PM_OK;
    close_up(m);
    series->row_count = m->records;
    pm_status status = expect_again(m, error);
    if (status == PM_OK)
        status = expect(m, &profile, law, error);
    const pm__record_set set = {.errors = m->errors, .passes = m->passes, .records = m->records,
                                .trials = series->trials, .values = 3 * m->yardstick.values, .profile = profile,
                                .scale = 1.0 / m->yardstick.truth_mean};
    if (status == PM_OK)
        status = summarize(m, &set, error);
    if (status == PM_OK)
        status = pm__fit_all(&set, (const double(*)[PM__MOST_RECORDS])law, series->fits, error);
    pm__measuring_own_average(m);
    if (status == PM_OK)
        set_asymptotes(&m->config->progressive, series->fits);
    free(profile);
    return status;
}

/* ---- A series ---------------------------------------------------------------------------------- */

static pm_status check(const pm__converge_config *config, pm_error *error)
{
    if (config->trials < 2)
        return pm__fail(error, PM_EINVAL, "noise takes 2 trials or more, not %zu", config->trials);
    if (!config->passes)
        return pm__fail(error, PM_EINVAL, "no passes");
    if (!(config->error >= 0.0 && config->error < INFINITY))
        return pm__fail(error, PM_EINVAL, "an error of %g cannot be asked for", config->error);
    for (size_t i = 0; i < config->watched_count; i++)
        if (config->watched[i] >= config->progressive.width * config->progressive.height)
            return pm__fail(error, PM_EINVAL, "there is no point %zu", config->watched[i]);
    return PM_OK;
}

static pm_status set_up(pm__measuring *m, pm_error *error)
{
    const pm__converge_config *const config = m->config;
    pm__converge_series *const series = m->series;
    m->progressive = config->progressive;
    m->progressive.estimates = config->error > 0.0;
    pm_status status = pm__progression_open(&m->progressive, &m->progression, error);
    if (status != PM_OK)
        return status;
    set_records(m, most_passes(config));
    m->room = m->records;
    status = pm__expectation_create(&m->progression, m->passes, m->records, &m->expectation, error);
    if (status == PM_OK)
        status = pm__yardstick_create(&m->progression, m->expectation.lawful, &m->yardstick, error);
    if (status != PM_OK)
        return status;
    *series = (pm__converge_series){.paths = m->progression.stage.subject->truth ? m->progression.stage.subject->paths
                                                                                 : "L.*D",
                                    .truth = m->yardstick.name,
                                    .width = config->progressive.width,
                                    .height = config->progressive.height,
                                    .points = m->yardstick.values,
                                    .all_points = m->progression.points,
                                    .truth_mean = m->yardstick.truth_mean,
                                    .watched_count = config->watched_count};
    if (config->error > 0.0) {
        m->estimated = pm__alloc(config->trials * m->room, sizeof *m->estimated);
        m->right = pm__alloc(config->trials * m->room, sizeof *m->right);
    }
    /* all of it at once: memory that passes come to write to bit by bit looks as if it grew with them */
    m->errors = pm__alloc_zero(config->trials * m->room, 3 * m->yardstick.values * sizeof *m->errors);
    m->radiance = pm__alloc(m->progression.points, sizeof *m->radiance);
    series->watched = pm__alloc_zero(m->room * config->watched_count + 1, sizeof *series->watched);
    return m->errors && m->radiance && series->watched && (config->error > 0.0 ? m->estimated && m->right : true)
               ? PM_OK
               : pm__fail(error, PM_ENOMEM, "out of memory for %zu trials of %zu points", config->trials,
                          series->points);
}

pm_status pm__converge(const pm__converge_config *config, pm__converge_series *series, pm_error *error)
{
    pm__measuring m = {.config = config, .series = series};
    *series = (pm__converge_series){.row_count = 0};
    pm_status status = check(config, error);
    if (status == PM_OK)
        status = set_up(&m, error);
    m.start = m.saved = pm__seconds();
    if (status == PM_OK && config->from)
        status = pm__measuring_restore(&m, config->from, error);
    if (status == PM_OK && config->from)
        report(&m, series->trials, m.run.passes);
    if (status == PM_OK)
        status = run_trials(&m, error);
    if (status == PM_OK)
        status = finish(&m, error);
    if (status == PM_ECANCELED) { /* before the first trial */
        series->interrupted = true;
        status = PM_OK;
    }
    pm__run_end(&m.run);
    free(m.errors);
    free(m.estimated);
    free(m.right);
    free(m.radiance);
    pm__yardstick_destroy(&m.yardstick);
    pm__expectation_destroy(&m.expectation);
    if (m.progression.config)
        pm__progression_close(&m.progression);
    return status;
}

void pm__converge_free(pm__converge_series *series)
{
    free(series->watched);
    *series = (pm__converge_series){.row_count = 0};
}
