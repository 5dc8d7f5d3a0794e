/* converge: how fast progressive methods converge, beside what theory says. */
#include "commands.h"
#include "converge_keep.h"
#include "converge_options.h"
#include "converge_task.h"
#include "interrupt.h"
#include "option_values.h"
#include "parallel.h"
#include "progress.h"
#include "render_options.h"
#include "same_file.h"

#include "../../estimators/estimator.h"
#include "../base/clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PHOTONS = 20000, K = 50, SIDE = 32, LONGEST_LABEL = 64 };
enum { QUICK_TRIALS = 8, FULL_TRIALS = 32, QUICK_PASSES = 256, FULL_PASSES = 1024 };
static const double default_alpha = 0.667, default_checkpoint_seconds = 60.0;

/* A task and all that it points at. */
typedef struct work {
    pm__converge_task task;
    pm_estimator **kernels;
    size_t watched[PM__MAX_WATCHED];
    pm_parallel parallel;
    size_t item; /* in hand */
    pm__progress progress;
    pm__keep keep;
    bool resumed; /* the series in hand: what it reports first was done before */
} work;

static const pm__progressive *method_of(const pm__spec *spec)
{
    return (const pm__progressive *)(const void *)spec->entry;
}

/* ---- What is asked for ------------------------------------------------------------------------- */

/* --photons cannot end what emits none; that it were passes that nobody asked for would be no answer. */
static pm_status check_end(const pm__settings *s, pm_error *error)
{
    const pm__converge_options *const c = &s->converge;
    if (!c->photons || c->passes || s->seconds > 0.0 || c->error > 0.0)
        return PM_OK;
    for (size_t i = 0; i < c->methods.count; i++)
        if (!method_of(&c->methods.items[i])->uses_photons)
            return pm__fail(error, PM_EINVAL, "--photons does not end %s, which emits none: it needs --passes, "
                                              "--seconds or --error too", c->methods.items[i].entry->name);
    return PM_OK;
}

static pm_status fill_defaults(pm__settings *s, pm_error *error)
{
    pm__converge_options *const c = &s->converge;
    pm_status status = check_end(s, error);
    if (status == PM_OK)
        status = pm__default_specs(&pm__progressives, "ppm", &c->methods, error);
    if (status == PM_OK)
        status = pm__default_specs(&pm__estimators, "disc", &s->estimators, error);
    if (status == PM_OK)
        status = pm__default_specs(&pm__samplers, "poisson", &s->samplers, error);
    if (c->checkpoint_seconds > 0.0 && !c->checkpoint && !c->resume)
        return pm__fail(error, PM_EINVAL, "--checkpoint-seconds needs --checkpoint or --resume");
    if (c->checkpoint_seconds <= 0.0)
        c->checkpoint_seconds = default_checkpoint_seconds;
    if (!c->alpha_count)
        c->alphas[c->alpha_count++] = default_alpha;
    if (!s->trials)
        s->trials = s->full ? FULL_TRIALS : QUICK_TRIALS;
    if (!c->passes)
        c->passes = s->full ? FULL_PASSES : QUICK_PASSES;
    if (!c->photons_per_pass)
        c->photons_per_pass = PHOTONS;
    return status;
}

static size_t k_of(const pm__settings *s)
{
    return s->ks.count ? s->ks.items[0] : K;
}

/* Does a series look for its k nearest photons? */
static bool wants_k(const pm__settings *s)
{
    for (size_t i = 0; i < s->converge.methods.count; i++) {
        const pm__progressive *const method = method_of(&s->converge.methods.items[i]);
        if (pm__progressive_looks_up(method) && !(method->shrinks && s->radius > 0.0))
            return true;
    }
    return false;
}

/* A checkpoint is no place for rows too. */
static pm_status check_files(const pm__settings *s, pm_error *error)
{
    const char *const others[] = {s->json, s->csv, s->markdown, s->output};
    const char *const ours[] = {s->converge.checkpoint, s->converge.resume};
    for (size_t i = 0; i < 8; i++)
        if (others[i / 2] && ours[i % 2] && pm__same_file(others[i / 2], ours[i % 2]))
            return pm__fail(error, PM_EINVAL, "--%s and an output of rows are both '%.200s'",
                            i % 2 ? "resume" : "checkpoint", ours[i % 2]);
    return PM_OK;
}

static pm_status check(const pm__settings *s, pm_error *error)
{
    const pm__converge_options *const c = &s->converge;
    if (k_of(s) > c->photons_per_pass && wants_k(s))
        return pm__fail(error, PM_EINVAL, "--k %zu%s is more than --photons-per-pass %zu", k_of(s),
                        s->ks.count ? "" : " (the default)", c->photons_per_pass);
    return check_files(s, error);
}

/* Without --size as many points as there are blocks of a stored reference, where one is needed. */
static pm_status size_of(const pm__settings *s, const pm__spec *scene, size_t *width, size_t *height, pm_error *error)
{
    const pm__converge_options *const c = &s->converge;
    *width = s->render.width;
    *height = s->render.height;
    if (!*width && !pm__converge_reference_size(scene, width, height))
        *width = *height = SIDE;
    for (size_t i = 0; i < c->at_count; i++)
        if (c->at[i][0] >= *width || c->at[i][1] >= *height)
            return pm__fail(error, PM_EINVAL, "--at %zu,%zu lies outside the image of %zux%zu pixels", c->at[i][0],
                            c->at[i][1], *width, *height);
    return PM_OK;
}

static pm_status check_sizes(const pm__settings *s, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0, width, height; i < s->cases.count && status == PM_OK; i++)
        status = size_of(s, &s->cases.items[i], &width, &height, error);
    return status;
}

/* ---- Series ------------------------------------------------------------------------------------ */

/* The series of a scene and a method: `items` NULL only counts them. */
static size_t list_series(const pm__settings *s, const pm__spec *scene, const pm__spec *method,
                          pm__converge_item *items)
{
    const pm__progressive *const m = method_of(method);
    const size_t kernels = pm__progressive_looks_up(m) ? s->estimators.count : 1;
    const size_t alphas = m->shrinks ? s->converge.alpha_count : 1;
    for (size_t i = 0; items && i < kernels * alphas; i++) {
        const size_t kernel = i / alphas;
        items[i] = (pm__converge_item){.scene = scene,
                                       .method = method,
                                       .estimator = pm__progressive_looks_up(m) ? &s->estimators.items[kernel] : NULL,
                                       .kernel = kernel,
                                       .alpha = m->shrinks ? s->converge.alphas[i % alphas] : (double)NAN};
    }
    return kernels * alphas;
}

static size_t list_all(const pm__settings *s, pm__converge_item *items)
{
    size_t count = 0;
    for (size_t i = 0; i < s->cases.count; i++)
        for (size_t j = 0; j < s->converge.methods.count; j++)
            count += list_series(s, &s->cases.items[i], &s->converge.methods.items[j], items ? items + count : NULL);
    return count;
}

static pm_status make_series(work *w, pm_error *error)
{
    const pm__settings *const s = w->task.settings;
    char name[PM__MAX_SPEC];
    const size_t count = list_all(s, NULL);
    w->kernels = calloc(s->estimators.count, sizeof *w->kernels);
    w->task.items = calloc(count, sizeof *w->task.items);
    if (!w->kernels || !w->task.items)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    w->task.count = list_all(s, w->task.items);
    pm_status status = PM_OK;
    for (size_t i = 0; status == PM_OK && i < s->estimators.count; i++) {
        pm__spec_format(&s->estimators.items[i], name, sizeof name);
        status = pm_estimator_create(name, &w->kernels[i], error);
    }
    return status;
}

static void free_work(work *w)
{
    for (size_t i = 0; w->kernels && i < w->task.settings->estimators.count; i++)
        pm_estimator_destroy(w->kernels[i]);
    for (size_t i = 0; i < w->task.count; i++)
        pm__converge_free(&w->task.items[i].series);
    free(w->kernels);
    free(w->task.items);
    pm__keep_close(&w->keep);
}

/* ---- The run ----------------------------------------------------------------------------------- */

static void show_progress(void *context, double fraction, const char *what)
{
    work *const w = context;
    const pm__converge_item *const item = &w->task.items[w->item];
    char label[LONGEST_LABEL];
    (void)what;
    (void)snprintf(label, sizeof label, "%s, %s", strchr(item->scene->entry->name, ':') + 1, item->method->entry->name);
    const double done = ((double)w->item + fraction) / (double)w->task.count;
    if (w->resumed)
        pm__progress_resume(&w->progress, done);
    w->resumed = false;
    pm__progress_update(&w->progress, done, label);
}

static pm_status save(void *context, const pm__saved *saved, pm_error *error)
{
    work *const w = context;
    return pm__keep_take(&w->keep, w->item, saved, error);
}

static bool is_canceled(void *context)
{
    (void)context;
    return pm__interrupted();
}

static const pm__sampler *sampler_of(const pm__spec *spec)
{
    const pm__sampler *const sampler = (const pm__sampler *)(const void *)spec->entry;
    return sampler->independent ? NULL : sampler;
}

static void configure(work *w)
{
    const pm__settings *const s = w->task.settings;
    const pm__converge_options *const c = &s->converge;
    w->task.search = s->search ? s->search : "auto";
    w->task.config = (pm__converge_config){
        .progressive = {.width = s->render.width, /* 0: as the scene has it */
                        .height = s->render.height,
                        .radius = s->radius,
                        .k = k_of(s),
                        .photons = c->photons_per_pass,
                        .front_only = s->lookup.front_only,
                        .search = s->search ? pm_search_find(s->search) : NULL,
                        .sampler = sampler_of(&s->samplers.items[0]),
                        .seed = s->seed,
                        .parallel = &w->parallel,
                        .canceled = is_canceled,
                        .context = w},
        .trials = s->trials,
        .passes = (uint32_t)c->passes,
        .photons = c->photons,
        .seconds = s->seconds,
        .error = c->error,
        .watched = w->watched,
        .watched_count = c->at_count,
        .progress = show_progress,
        .save = c->checkpoint || c->resume ? save : NULL,
        .save_seconds = c->checkpoint_seconds,
    };
}

/* One series. What cannot be measured is a row that says why; ECANCELED: it has the rows of its whole trials. */
static pm_status measure(work *w, pm_error *error)
{
    pm__converge_item *const item = &w->task.items[w->item];
    pm__converge_config config = w->task.config;
    config.progressive.scene = item->scene;
    config.progressive.method = item->method;
    config.progressive.estimator = w->kernels[item->kernel];
    config.progressive.alpha = item->alpha;
    config.from = pm__keep_from(&w->keep, w->item);
    w->resumed = config.from != NULL;
    pm_status status = size_of(w->task.settings, item->scene, &config.progressive.width, &config.progressive.height,
                               error);
    for (size_t i = 0; i < config.watched_count; i++)
        w->watched[i] = w->task.settings->converge.at[i][1] * config.progressive.width +
                        w->task.settings->converge.at[i][0];
    if (status == PM_OK)
        status = pm__converge(&config, &item->series, error);
    if (status == PM_EFORMAT && config.from)
        return pm__keep_refuse(&w->keep, w->item, error);
    if (status == PM_EINVAL) {
        item->status = "unsupported";
        (void)snprintf(item->detail, sizeof item->detail, "%.*s", (int)sizeof item->detail - 1, error->text);
        return PM_OK;
    }
    item->status = item->series.interrupted ? "interrupted" : "ok";
    if (item->series.interrupted)
        (void)snprintf(item->detail, sizeof item->detail, "interrupted: %zu of %zu trials", item->series.trials,
                       config.trials);
    return status == PM_OK && item->series.interrupted ? PM_ECANCELED : status;
}

/* EINVAL, with the first one's reason: none of them could be measured. */
static pm_status measure_all(work *w, pm_error *error)
{
    pm_status status = PM_OK;
    size_t refused = 0;
    pm__progress_start(&w->progress, w->task.settings->quiet);
    for (; status == PM_OK && w->item < w->task.count; w->item++) {
        pm_error reason = {""};
        status = pm__interrupted() ? PM_ECANCELED : measure(w, &reason);
        if (!*error->text || (status != PM_OK && status != PM_ECANCELED))
            *error = reason;
        refused += status == PM_OK && strcmp(w->task.items[w->item].status, "unsupported") == 0;
        if (status == PM_OK)
            pm__keep_done(&w->keep, w->item);
    }
    pm__progress_end(&w->progress);
    return refused == w->task.count ? PM_EINVAL : status;
}

/* Whatever ended the work: all that was done is in the checkpoint. */
static pm_status keep_state(work *w, pm_status status, pm_error *error)
{
    if (status == PM_EINVAL || w->keep.unreadable)
        return status;
    const bool fine = status == PM_OK || status == PM_ECANCELED;
    const pm_status kept = pm__keep_flush(&w->keep, fine ? error : NULL);
    return fine && kept != PM_OK ? kept : status;
}

static pm_status do_job(work *w, pm_error *error)
{
    pm__sinks sinks;
    const double start = pm__seconds();
    pm_status status = make_series(w, error);
    if (status == PM_OK)
        status = pm__keep_open(&w->task, &w->keep, error);
    if (status == PM_OK)
        status = pm__sinks_open(w->task.settings, true, &sinks, error);
    pm__interrupt_watch(); /* from here on there is something to save */
    if (status != PM_OK)
        return status;
    pm__keep_greet(&w->keep, w->task.count);
    status = measure_all(w, error);
    status = keep_state(w, status, error);
    if (status != PM_OK && status != PM_ECANCELED) {
        pm__sinks_discard(&sinks);
        return status;
    }
    if (pm__sinks_screen(&sinks))
        pm__converge_print(pm__sinks_screen(&sinks), &w->task);
    const pm_status written =
        pm__converge_write(&w->task, pm__seconds() - start, status == PM_ECANCELED, &sinks, error);
    return written ? written : status;
}

static int run(pm__settings *settings)
{
    pm_error error = {""};
    work w = {.task.settings = settings};
    pm_status status = pm__render_take_scenes(settings, &error);
    if (status == PM_OK)
        status = fill_defaults(settings, &error);
    if (status == PM_OK)
        status = check(settings, &error);
    if (status == PM_OK)
        status = check_sizes(settings, &error);
    if (status == PM_OK) {
        w.parallel = pm__parallel_for(&settings->threads);
        configure(&w);
        status = do_job(&w, &error);
    }
    int end = pm__conclude("converge", status, settings->quiet,
                           "rows are of the trials that were complete, where there are two", NULL, &error);
    if (status == PM_ECANCELED && !settings->quiet)
        pm__keep_part(&w.keep);
    if (w.keep.unreadable)
        end = pm__exit_status_of_input(status);
    free_work(&w);
    return end;
}

static const pm__option *const options_taken[] = {
    &pm__converge_option_method,  &pm__converge_option_estimator, &pm__converge_option_alpha,
    &pm__converge_option_trials,  &pm__converge_option_passes,    &pm__converge_option_photons_per_pass,
    &pm__converge_option_photons, &pm__converge_option_radius,    &pm__converge_option_k,
    &pm__converge_option_size,    &pm__converge_option_seconds,   &pm__converge_option_at,
    &pm__converge_option_sampler, &pm__converge_option_error,     &pm__converge_option_checkpoint,
    &pm__converge_option_checkpoint_seconds, &pm__converge_option_resume, &pm__converge_option_search,
    &pm__option_front,            &pm__option_profile,            &pm__option_seed,
    &pm__option_threads,          &pm__option_json,               &pm__option_csv,
    &pm__option_markdown,         &pm__option_output,             &pm__option_quiet};

const pm__command pm__command_converge = {
    .name = "converge",
    .operands = "SCENE...",
    .max_operands = PM__MAX_OPERANDS,
    .job = "error against passes, photons and time of progressive methods, and the slopes",
    .text = "A scene, method or estimator is NAME[:key=value[,key=value...]]; 'photonbench list' shows them. Each\n"
            "scene, method, estimator and alpha is a series: independent runs, whose answers are compared with\n"
            "the truth after 1, 2, 4, ... passes and the last. Slopes are fitted to the logarithms of variance,\n"
            "bias and error against that of the pass, and stand beside those of the law. Intervals are 95 %,\n"
            "over runs. With --error runs estimate their own error, without the truth, and end by it; how often\n"
            "they were right stands beside it. Ctrl-C shows what the runs that were complete say, if there are\n"
            "two; a second one ends at once.\n\n"
            "With --checkpoint the state is saved at an interval, at the end, and when SIGINT or SIGTERM comes\n"
            "(status 130). --resume goes on from there, with the same options (but for --threads and where rows\n"
            "go), to the same rows to the last bit but for seconds. A file that is damaged is refused (status 3),\n"
            "and so is one of other options (status 2).\n\n"
            "Examples:\n"
            "  photonbench converge plate\n"
            "  photonbench converge plate water --method ppm,sppm,pppm --alpha 0.5,0.667,0.8 --trials 16\n"
            "  photonbench converge glass-sphere --passes 64 --at 16,16 --at 4,28 --json converge.json\n"
            "  photonbench converge furnace --method pppm --estimator disc,epanechnikov --seconds 60 --csv -\n"
            "  photonbench converge cornell --profile full --checkpoint state --json cornell.json\n"
            "  photonbench converge cornell --profile full --resume state --json cornell.json\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
