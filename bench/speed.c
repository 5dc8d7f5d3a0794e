/* The rows of a run, one after the other, each with its share of the time. */
#include "speed.h"

#include "../cases/scenes/list.h"
#include "../src/base/clock.h"
#include "../src/base/memory.h"
#include "../src/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const pm__quantity_names[PM__QUANTITIES] = {"trace", "trace-threads", "visualize", "skip",
                                                        "pass", "pass-threads", "pass-rays"};

/* What a row of the quantity takes of the time, beside others. */
static const double weights[PM__QUANTITIES] = {3.0, 2.0, 10.0, 1.0, 10.0, 10.0, 10.0};

static const char *const traced_scenes[] = {"scene:cornell", "scene:glass-sphere", "scene:integrating-sphere",
                                            "scene:fractal-cornell"};
static const char *const seen_scenes[] = {"scene:cornell"};
static const char *const skip_methods[] = {"visualize", "full"};
enum {
    TRACED_SCENES = sizeof traced_scenes / sizeof *traced_scenes,
    SKIP_METHODS = sizeof skip_methods / sizeof *skip_methods
};

/* ---- Verdicts ---------------------------------------------------------------------------------- */

const char *pm__speed_verdict(double promise, double ratio, pm__interval ci95, size_t rounds)
{
    double missed;
    if (!isfinite(ratio) || isnan(promise))
        return "ok";
    if (!pm__sign_rank(rounds, 0.95, &missed))
        return "unclear";
    return ci95.high < promise ? "missed" : ci95.low >= promise ? "ok" : "unclear";
}

void pm__speed_take(const pm__bench_report *report, size_t result, size_t baseline, double scale, pm__speed_row *row)
{
    const pm__bench_result *const mine = &report->results[result];
    row->seconds = scale * mine->ns;
    row->baseline_seconds = scale * report->results[baseline].ns;
    row->ratio = mine->ratio;
    row->ratio_ci95 = mine->ratio_ci95;
    row->samples = mine->samples;
    row->aa_ratio = report->aa_ratio;
    row->aa_ci95 = report->aa_ci95;
    row->warning = report->warning;
}

/* ---- The list of rows -------------------------------------------------------------------------- */

typedef struct list {
    pm__speed_row *rows;
    size_t count, capacity;
} list;

static pm_status add_row(list *l, const pm__spec *scene, pm__quantity quantity, const char *method)
{
    void *rows = l->rows;
    if (pm__grow(&rows, &l->capacity, l->count + 1, sizeof *l->rows))
        return PM_ENOMEM;
    l->rows = rows;
    const double none = (double)NAN;
    const pm__interval nowhere = {none, none};
    l->rows[l->count++] = (pm__speed_row){.scene = *scene, .quantity = quantity, .method = method, .seconds = none,
                                          .baseline_seconds = none, .ratio = none, .ratio_ci95 = nowhere,
                                          .promise = none, .aa_ratio = none, .aa_ci95 = nowhere, .status = "ok"};
    return PM_OK;
}

static bool is_pass(pm__quantity quantity)
{
    return quantity == PM__PASS_SPEED || quantity == PM__PASS_THREADS_SPEED || quantity == PM__PASS_RAYS_SPEED;
}

static bool needs_threads(pm__quantity quantity)
{
    return quantity == PM__THREADS_SPEED || quantity == PM__PASS_THREADS_SPEED;
}

static pm_status add_rows(list *l, const pm__spec *scene, pm__quantity quantity)
{
    pm_status status = PM_OK;
    if (quantity != PM__SKIP_SPEED)
        return add_row(l, scene, quantity, is_pass(quantity)                  ? "ppm"
                                           : quantity == PM__VISUALIZE_SPEED ? "visualize"
                                                                              : NULL);
    for (int m = 0; m < SKIP_METHODS && status == PM_OK; m++)
        status = add_row(l, scene, quantity, skip_methods[m]);
    return status;
}

static pm_status add_own_scenes(list *l, pm__quantity quantity)
{
    const bool all = quantity == PM__SKIP_SPEED, seen = quantity == PM__VISUALIZE_SPEED || is_pass(quantity);
    const char *const *const names = seen ? seen_scenes : traced_scenes;
    const size_t count = all ? pm__scene_cases.count : seen ? 1 : TRACED_SCENES;
    pm_status status = PM_OK;
    for (size_t i = 0; i < count && status == PM_OK; i++) {
        pm__spec scene;
        pm__spec_default(all ? pm__scene_cases.entries[i] : pm__find(&pm__scene_cases, names[i]), &scene);
        status = add_rows(l, &scene, quantity);
    }
    return status;
}

static pm_status make_list(const pm__speed_config *config, list *l)
{
    const unsigned asked = config->quantities ? config->quantities : (1U << PM__QUANTITIES) - 1;
    pm_status status = PM_OK;
    for (int q = 0; q < PM__QUANTITIES && status == PM_OK; q++) {
        if (!(asked & 1U << q) || (needs_threads((pm__quantity)q) && config->threads < 2))
            continue;
        if (!config->scene_count)
            status = add_own_scenes(l, (pm__quantity)q);
        for (size_t i = 0; i < config->scene_count && status == PM_OK; i++)
            status = add_rows(l, &config->scenes[i], (pm__quantity)q);
    }
    return status;
}

/* ---- Running it -------------------------------------------------------------------------------- */

static pm_status measure(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    static pm_status (*const how[PM__QUANTITIES])(const pm__speed_config *, double, pm__speed_row *, pm_error *) = {
        pm__speed_trace, pm__speed_threads,      pm__speed_visualize, pm__speed_skip,
        pm__speed_pass,  pm__speed_pass_threads, pm__speed_pass_rays};
    pm_error why = {""};
    const pm_status status = how[row->quantity](config, seconds, row, &why);
    if (status == PM_OK) {
        row->status = row->compared && !row->agree
                          ? "differs"
                          : pm__speed_verdict(row->promise, row->ratio, row->ratio_ci95, row->samples);
        return PM_OK;
    }
    if (status == PM_ENOMEM || status == PM_ECANCELED)
        return pm__fail(error, status, "%s", *why.text ? why.text : pm_status_text(status));
    row->status = "failed";
    (void)snprintf(row->detail, sizeof row->detail, "%.190s", *why.text ? why.text : pm_status_text(status));
    return PM_OK;
}

static double weight_from(const list *l, size_t first)
{
    double sum = 0.0;
    for (size_t i = first; i < l->count; i++)
        sum += weights[l->rows[i].quantity];
    return sum;
}

static bool is_canceled(const pm__speed_config *config)
{
    return config->canceled && config->canceled(config->context);
}

/* What is left of the time is shared anew before each row, since rows may need more or less than theirs. */
static pm_status measure_all(const pm__speed_config *config, const list *l, size_t *done, pm_error *error)
{
    const double start = pm__seconds();
    pm_status status = PM_OK;
    for (*done = 0; *done < l->count && status == PM_OK;) {
        pm__speed_row *const row = &l->rows[*done];
        const double left = fmax(config->seconds - (pm__seconds() - start), 0.0), all = weight_from(l, *done);
        if (config->progress)
            config->progress(config->context, 1.0 - all / weight_from(l, 0), pm__quantity_names[row->quantity]);
        status = is_canceled(config) ? pm__fail(error, PM_ECANCELED, "canceled")
                                     : measure(config, left * weights[row->quantity] / all, row, error);
        *done += status == PM_OK;
    }
    return status;
}

pm_status pm__speed_run(const pm__speed_config *config, pm__speed_row **rows, size_t *count, pm_error *error)
{
    list l = {.rows = NULL};
    pm_status status = make_list(config, &l);
    *count = 0;
    if (status == PM_OK)
        status = measure_all(config, &l, count, error);
    else
        status = pm__fail(error, status, "out of memory for the rows");
    *rows = l.rows;
    if (status != PM_OK && status != PM_ECANCELED) {
        free(l.rows);
        *rows = NULL;
        *count = 0;
    }
    return status;
}
