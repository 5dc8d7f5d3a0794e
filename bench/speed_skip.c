/* What a plan's skipping saves, and that it does not change the image. */
#include "speed.h"

#include "../src/base/memory.h"
#include "../src/methods/render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Renders are small, since there are many. Trials: images that are compared, and units of the timing. */
enum { MOST_SIDE = 48, MOST_PHOTONS = 4000, TRIALS = 16, BLOCKS = 4 };
/* Two estimators, since one has no map to share. */
enum { IMAGES = 2, VALUES = 3 * BLOCKS * BLOCKS };
static const double false_alarms = 1e-6, rounding = 1e-6;

/* ---- Do images agree? -------------------------------------------------------------------------- */

/* The p-value of a value's differences, not corrected. */
static double p_of_value(const double *a, const double *b, size_t trials, size_t stride, double scale)
{
    const double n = (double)trials;
    double mean = 0.0, squares = 0.0;
    for (size_t t = 0; t < trials; t++)
        mean += (a[t * stride] - b[t * stride]) / n;
    for (size_t t = 0; t < trials; t++) {
        const double off = a[t * stride] - b[t * stride] - mean;
        squares += off * off;
    }
    const double error = sqrt(squares / (n - 1.0) / n);
    if (!isfinite(mean))
        return 0.0;
    if (fabs(mean) <= rounding * scale)
        return 1.0;
    return error > 0.0 ? pm__student_p(mean / error, n - 1.0) : 0.0;
}

bool pm__speed_agree(const double *a, const double *b, size_t trials, size_t values, double *worst)
{
    double scale = 0.0, least = 1.0;
    for (size_t i = 0; i < trials * values; i++)
        scale += 0.5 * (fabs(a[i]) + fabs(b[i])) / (double)(trials * values);
    for (size_t v = 0; v < values; v++)
        least = fmin(least, p_of_value(a + v, b + v, trials, values, scale));
    const double p = fmin(least * (double)values, 1.0);
    if (worst)
        *worst = p;
    return p >= false_alarms;
}

/* ---- Renders: a unit is a whole one, by its trial ---------------------------------------------- */

typedef struct renders {
    pm__render_config config;
    uint64_t seed;
    double blocks[TRIALS][IMAGES][VALUES]; /* means of the images' blocks by band */
    bool done[TRIALS];
    pm_status status;
    pm_error error;
} renders;

static void average_blocks(const pm__image *image, double *values)
{
    size_t pixels[BLOCKS * BLOCKS] = {0};
    for (size_t i = 0; i < VALUES; i++)
        values[i] = 0.0;
    for (size_t p = 0; p < image->width * image->height; p++) {
        const size_t x = p % image->width * BLOCKS / image->width, y = p / image->width * BLOCKS / image->height;
        pixels[y * BLOCKS + x]++;
        for (size_t b = 0; b < 3; b++)
            values[3 * (y * BLOCKS + x) + b] += (double)image->values[3 * p + b];
    }
    for (size_t i = 0; i < VALUES; i++)
        values[i] /= fmax((double)pixels[i / 3], 1.0);
}

static void render_trial(renders *r, size_t trial)
{
    pm__render_result result = {.count = 0};
    if (r->status != PM_OK)
        return;
    r->config.seed = r->seed + trial;
    r->status = pm__render(&r->config, &result, &r->error);
    if (r->status == PM_OK && result.interrupted)
        r->status = PM_ECANCELED;
    for (size_t i = 0; i < IMAGES && r->status == PM_OK && !r->done[trial]; i++)
        average_blocks(&result.images[i < result.count ? i : 0].radiance, r->blocks[trial][i]); /* path: one for all */
    r->done[trial] = true;
    pm__render_free(&result);
}

static void run(void *context, size_t first, size_t repetitions)
{
    for (size_t i = 0; i < repetitions; i++)
        render_trial(context, (first + i) % TRIALS);
}

/* The trials that the timing passed by. */
static void finish(renders *r)
{
    for (size_t t = 0; t < TRIALS; t++)
        if (!r->done[t])
            render_trial(r, t);
}

/* ---- A run ------------------------------------------------------------------------------------- */

static pm_status fail(const renders *r, pm_error *error)
{
    return pm__fail(error, r->status, "%s", *r->error.text ? r->error.text : pm_status_text(r->status));
}

static void judge(const renders *all, const renders *planned, pm__speed_row *row)
{
    double worst;
    row->compared = true;
    row->agree = pm__speed_agree(&planned->blocks[0][0][0], &all->blocks[0][0][0], TRIALS, IMAGES * VALUES, &worst);
    (void)snprintf(row->detail, sizeof row->detail, "%zu x %zu, k = %zu; %d images of each, %d blocks: p = %.2g",
                   planned->config.width, planned->config.height, planned->config.k, (int)TRIALS,
                   (int)(BLOCKS * BLOCKS), worst);
}

static pm_status compare(const pm__speed_config *config, renders *all, renders *planned, double seconds,
                         pm__speed_row *row, pm_error *error)
{
    enum { ALL, PLANNED };
    const pm__bench_variant variants[] = {{"no-skip", run, all}, {"plan", run, planned}};
    const pm__bench_config bench = {.sample_seconds = 1e-9, /* one render */
                                    .seconds = seconds, .baseline = ALL, .seed = config->seed,
                                    .canceled = config->canceled, .context = config->context};
    pm__bench_report report;
    pm_status status = pm__bench_run(&bench, variants, 2, &report, error);
    finish(all);
    finish(planned);
    if (status == PM_OK)
        status = all->status ? fail(all, error) : planned->status ? fail(planned, error) : PM_OK;
    if (status == PM_OK) {
        pm__speed_take(&report, PLANNED, ALL, 1e-9, row);
        judge(all, planned, row);
    }
    pm__bench_free(&report);
    return status;
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

pm_status pm__speed_skip(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    pm__spec method;
    pm_estimator *own[IMAGES] = {NULL};
    row->photons = smaller(config->photons, MOST_PHOTONS);
    row->threads = config->threads;
    row->baseline = "no-skip";
    pm_status status = pm__spec_parse(&pm__methods, row->method, &method, error);
    static const char *const names[IMAGES] = {"disc", "cone"};
    for (int i = 0; i < IMAGES && status == PM_OK; i++)
        status = pm_estimator_create(names[i], &own[i], error);
    const pm_estimator *const estimators[IMAGES] = {own[0], own[1]};
    renders both[2] = {{.seed = config->seed}, {.seed = config->seed}};
    for (int i = 0; i < 2; i++)
        both[i].config = (pm__render_config){
            .scene = &row->scene, .method = &method, .estimators = estimators, .estimator_count = IMAGES,
            .k = config->k, .radius = (double)INFINITY, .lookup = {PM_LOOKUP_SPHERE, 0.0, true},
            .photons = row->photons,
            .width = smaller(config->width, MOST_SIDE), .height = smaller(config->height, MOST_SIDE), .spp = 1,
            .trials = 1, .no_skip = i == 0, .parallel = config->parallel, .canceled = config->canceled,
            .context = config->context};
    if (status == PM_OK)
        status = compare(config, &both[0], &both[1], seconds, row, error);
    for (int i = 0; i < IMAGES; i++)
        pm_estimator_destroy(own[i]);
    return status;
}
