/* render: images of scenes, by a method and estimators. */
#include "commands.h"
#include "interrupt.h"
#include "option_values.h"
#include "parallel.h"
#include "progress.h"
#include "render_task.h"
#include "render_options.h"

#include "../../estimators/estimator.h"
#include "../base/clock.h"
#include "../base/status.h"
#include "../methods/method.h"
#include "../search/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PHOTONS = 200000, K = 100, SIDE = 256, SAMPLES = 16, AOV_TRIALS = 8 };
/* Of scenes that have no view of their own. */
static const double default_angle = 40.0 / 180.0 * 3.14159265358979323846;

/* A task and all that it points at. */
typedef struct work {
    pm__render_task task;
    pm_estimator **estimators;
    pm_parallel parallel;
    pm__render_files files;
    pm__render_row *rows;
    size_t row_count, scene; /* scene: in hand */
    pm__progress progress;
} work;

static bool makes_estimates(const pm__spec *method)
{
    return ((const pm__method *)(const void *)method->entry)->estimates;
}

static pm_status fill_defaults(pm__settings *s, pm_error *error)
{
    pm__render_options *const r = &s->render;
    pm_status status = pm__default_specs(&pm__estimators, "disc", &s->estimators, error);
    if (status == PM_OK)
        status = pm__default_specs(&pm__samplers, "poisson", &s->samplers, error);
    if (status == PM_OK && !r->method.entry)
        status = pm__spec_parse(&pm__methods, "visualize", &r->method, error);
    if (!r->width) {
        r->width = SIDE;
        r->height = SIDE;
    }
    if (!r->spp && !(s->seconds > 0.0))
        r->spp = SAMPLES;
    if (!s->trials)
        s->trials = r->aov ? AOV_TRIALS : 1;
    if (!s->search)
        s->search = pm__searches.entries[0]->name;
    return status;
}

static void show_progress(void *context, double fraction, const char *what)
{
    work *const w = context;
    pm__progress_update(&w->progress, ((double)w->scene + fraction) / (double)w->task.scene_count, what);
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

/* A radius alone asks for every photon within it, so then there is no k. */
static size_t k_of(const pm__settings *s)
{
    return s->ks.count ? s->ks.items[0] : s->radius > 0.0 ? 0 : K;
}

static void configure(work *w, const pm__settings *s)
{
    const pm__render_options *const r = &s->render;
    w->task.settings = s;
    w->task.scenes = s->cases.items;
    w->task.scene_count = s->cases.count;
    w->task.estimates = makes_estimates(&r->method);
    w->task.estimators = s->estimators.items;
    w->task.estimator_count = w->task.estimates ? s->estimators.count : 1;
    w->task.search = s->search;
    w->task.config = (pm__render_config){
        .method = &r->method,
        .estimator_count = w->task.estimator_count,
        .k = k_of(s),
        .radius = s->radius > 0.0 ? s->radius : (double)INFINITY,
        .lookup = s->lookup,
        .search = pm_search_find(s->search),
        .sampler = sampler_of(&s->samplers.items[0]),
        .photons = s->photons.count ? s->photons.items[0] : PHOTONS,
        .width = r->width,
        .height = r->height,
        .spp = r->spp,
        .trials = s->trials,
        .seconds = s->seconds,
        .seed = s->seed,
        .aov = r->aov,
        .no_skip = r->no_skip,
        .parallel = &w->parallel,
        .progress = show_progress,
        .canceled = is_canceled,
        .context = w,
    };
}

static pm_status make_estimators(work *w, pm_error *error)
{
    char name[PM__MAX_SPEC];
    const size_t count = w->task.estimator_count;
    w->estimators = calloc(count, sizeof *w->estimators);
    w->rows = calloc(count * w->task.scene_count, sizeof *w->rows);
    pm_status status = w->estimators && w->rows ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory");
    for (size_t i = 0; status == PM_OK && i < count; i++) {
        pm__spec_format(&w->task.estimators[i], name, sizeof name);
        status = pm_estimator_create(name, &w->estimators[i], error);
    }
    w->task.config.estimators = (const pm_estimator *const *)w->estimators;
    return status;
}

static void free_work(work *w)
{
    for (size_t i = 0; w->estimators && i < w->task.estimator_count; i++)
        pm_estimator_destroy(w->estimators[i]);
    free(w->estimators);
    free(w->rows);
    pm__render_files_free(&w->files);
}

/* What does not fit is refused before it is begun. */
static pm_status check_memory(const pm__render_task *task, pm_error *error)
{
    const pm__render_config *const c = &task->config;
    const double memory = pm__free_memory(), wanted = pm__render_bytes(c);
    if (memory > 0.0 && wanted > memory)
        return pm__fail(error, PM_ENOMEM, "%zux%zu pixels and %zu photons take %.3g GB of memory; %.3g GB are free",
                        c->width, c->height, c->photons, 1e-9 * wanted, 1e-9 * memory);
    return PM_OK;
}

/* The scene's own view, but for what was given. *used: NULL for the scene's own. */
static pm_status take_view(const pm__render_task *task, const pm__spec *scene, pm__view *view, const pm__view **used,
                           pm_error *error)
{
    const pm__render_options *const r = &task->settings->render;
    const pm__case *const subject = (const pm__case *)(const void *)scene->entry;
    pm__camera camera;
    pm_error reason = {""};
    *used = NULL;
    if (!r->eye && !r->at && !r->up && !r->angle)
        return PM_OK;
    if (!subject->view && !(r->eye && r->at))
        return pm__fail(error, PM_EINVAL, "%s has no view of its own: give both --eye and --look", scene->entry->name);
    *view = (pm__view){.up = {0.0, 0.0, 1.0}, .angle = default_angle};
    if (subject->view)
        subject->view(scene->values, view);
    if (r->eye)
        memcpy(view->eye, r->view.eye, sizeof view->eye);
    if (r->at)
        memcpy(view->at, r->view.at, sizeof view->at);
    if (r->up)
        memcpy(view->up, r->view.up, sizeof view->up);
    if (r->angle)
        view->angle = r->view.angle;
    *used = view;
    if (pm__camera_init(view, r->width, r->height, &camera, &reason) != PM_OK)
        return pm__fail(error, PM_EINVAL, "--eye, --look, --up, --angle: %.200s", reason.text);
    return PM_OK;
}

/* The configuration for one scene; view: room for it. */
static pm_status config_of(const pm__render_task *task, size_t scene, pm__view *view, pm__render_config *config,
                           pm_error *error)
{
    *config = task->config;
    config->scene = &task->scenes[scene];
    return take_view(task, config->scene, view, &config->view, error);
}

/* A plan of every scene; it also refuses what cannot be done, before anything is. */
static pm_status make_plans(const pm__render_task *task, pm__plan *plans, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; status == PM_OK && i < task->scene_count; i++) {
        pm__render_config config;
        pm__view view;
        status = config_of(task, i, &view, &config, error);
        if (status == PM_OK)
            status = pm__render_plan(&config, &plans[i], error);
    }
    return status;
}

static void say_how_far(const pm__render_config *c, const pm__render_result *result, pm__render_row *row)
{
    char samples[32] = "";
    if (c->spp)
        (void)snprintf(samples, sizeof samples, " of %zu", c->spp);
    (void)snprintf(row->detail, sizeof row->detail, "%s: %zu%s samples of a pixel, %zu of %zu trials", row->status,
                   result->passes, samples, result->trials, c->trials);
}

static pm__render_row row_of(const pm__render_task *task, const pm__render_config *config,
                             const pm__render_result *result, size_t index)
{
    pm__render_row row = {.scene = config->scene,
                          .estimator = task->estimates ? &task->estimators[index] : NULL,
                          .passes = result->passes,
                          .trials = result->trials,
                          .stored = result->stored,
                          .emitted = result->emitted,
                          .truth = result->truth,
                          .misfit = result->misfit,
                          .mean_error = result->images[index].mean_error,
                          .rms_error = result->images[index].rms_error,
                          .trace_s = result->trace_s,
                          .build_s = result->build_s,
                          .image_s = result->image_s,
                          .total_s = result->total_s,
                          .status = result->interrupted && pm__interrupted() ? "interrupted" : "ok"};
    if (*row.status == 'i')
        say_how_far(config, result, &row);
    return row;
}

/* Lines of the screen may share the bar's terminal; it comes back with the next news. */
static void clear_bar(work *w)
{
    const bool shown = w->progress.shown;
    pm__progress_end(&w->progress);
    w->progress.shown = shown;
}

static pm_status save(work *w, const pm__render_config *config, const pm__render_result *result, pm__sinks *sinks,
                      pm_error *error)
{
    pm_status status = PM_OK;
    clear_bar(w);
    for (size_t i = 0; status == PM_OK && i < result->count && i < w->task.estimator_count; i++) {
        pm__render_row *const row = &w->rows[w->row_count];
        *row = row_of(&w->task, config, result, i);
        status = pm__render_files_write(&w->files, &w->task, w->scene * w->task.estimator_count + i,
                                        &result->images[i], row, error);
        w->row_count += status == PM_OK;
        if (status == PM_OK && pm__sinks_screen(sinks))
            pm__render_print(pm__sinks_screen(sinks), &w->task, row);
    }
    return status;
}

/* One scene. ECANCELED: what there was of it is written. */
static pm_status render_scene(work *w, pm__sinks *sinks, pm_error *error)
{
    pm__render_config config;
    pm__view view;
    pm__render_result result = {.count = 0};
    pm_status status = config_of(&w->task, w->scene, &view, &config, error);
    if (status == PM_OK)
        status = pm__render(&config, &result, error);
    const bool cut = status == PM_OK && result.interrupted && pm__interrupted();
    if (status == PM_OK)
        status = save(w, &config, &result, sinks, error);
    pm__render_free(&result);
    return status == PM_OK && cut ? PM_ECANCELED : status;
}

static pm_status render_all(work *w, pm__sinks *sinks, pm_error *error)
{
    const double start = pm__seconds();
    pm_status status = PM_OK;
    pm__progress_start(&w->progress, w->task.settings->quiet);
    for (; status == PM_OK && w->scene < w->task.scene_count; w->scene++)
        status = pm__interrupted() ? PM_ECANCELED : render_scene(w, sinks, error);
    pm__progress_end(&w->progress);
    if (status != PM_OK && status != PM_ECANCELED) {
        pm__sinks_discard(sinks);
        return status;
    }
    const pm_status written = pm__render_write(&w->task, w->rows, w->row_count, pm__seconds() - start,
                                               status == PM_ECANCELED, sinks, error);
    return written ? written : status;
}

/* -o names images here, and rows share standard output with none. */
static pm_status open_sinks(const pm__settings *s, pm__sinks *sinks, pm_error *error)
{
    pm__settings rows = *s;
    const bool taken = !s->render.plan && (s->quiet || pm__render_to_stdout(s));
    rows.output = NULL;
    return pm__sinks_open(&rows, !taken, sinks, error);
}

static pm_status show_plans(const work *w, const pm__plan *plans, double start, pm_error *error)
{
    pm__sinks sinks;
    const pm_status status = open_sinks(w->task.settings, &sinks, error);
    return status ? status : pm__render_write_plans(&w->task, plans, pm__seconds() - start, &sinks, error);
}

static pm_status make_images(work *w, pm_error *error)
{
    pm__sinks sinks;
    pm_status status = check_memory(&w->task, error);
    if (status == PM_OK)
        status = pm__render_files_open(&w->task, &w->files, error);
    if (status == PM_OK)
        status = open_sinks(w->task.settings, &sinks, error);
    pm__interrupt_watch(); /* from here on there is something to save */
    return status ? status : render_all(w, &sinks, error);
}

static pm_status do_job(work *w, pm_error *error)
{
    const double start = pm__seconds();
    pm_status status = make_estimators(w, error);
    pm__plan *const plans = calloc(w->task.scene_count, sizeof *plans);
    if (status == PM_OK && !plans)
        status = pm__fail(error, PM_ENOMEM, "out of memory");
    if (status == PM_OK)
        status = make_plans(&w->task, plans, error);
    if (status == PM_OK)
        status = w->task.settings->render.plan ? show_plans(w, plans, start, error) : make_images(w, error);
    free(plans);
    return status;
}

static int run(pm__settings *settings)
{
    pm_error error = {""};
    work w = {.row_count = 0};
    pm_status status = pm__render_take_scenes(settings, &error);
    if (status == PM_OK)
        status = fill_defaults(settings, &error);
    if (status == PM_OK) {
        w.parallel = pm__parallel_for(&settings->threads);
        configure(&w, settings);
        status = do_job(&w, &error);
    }
    free_work(&w);
    return pm__conclude("render", status, settings->quiet, "images hold the samples that were complete, and say so",
                        NULL, &error);
}

static const pm__option *const options_taken[] = {
    &pm__render_option_method,  &pm__render_option_estimator, &pm__render_option_k,       &pm__render_option_radius,
    &pm__render_option_photons, &pm__render_option_size,      &pm__render_option_spp,     &pm__render_option_seconds,
    &pm__render_option_trials,  &pm__render_option_aov,       &pm__render_option_plan,    &pm__render_option_no_skip,
    &pm__render_option_half,
    &pm__render_option_eye,     &pm__render_option_look,      &pm__render_option_up,      &pm__render_option_angle,
    &pm__render_option_sampler, &pm__option_search,           &pm__option_lookup,         &pm__option_front,
    &pm__option_seed,           &pm__option_threads,          &pm__option_json,           &pm__option_csv,
    &pm__option_markdown,       &pm__render_option_output,    &pm__option_quiet};

const pm__command pm__command_render = {
    .name = "render",
    .operands = "SCENE...",
    .max_operands = PM__MAX_OPERANDS,
    .job = "images of scenes by a method and estimators, as OpenEXR files",
    .text = "A scene, method or estimator is NAME[:key=value[,key=value...]]; 'photonbench list' shows them.\n"
            "One scene and one estimator: the image is the file that -o names. Several: NAME.SCENE.ESTIMATOR.exr\n"
            "each. --aov adds NAME.truth.exr, .error, .bias, .noise, .radius and .count. Ctrl-C ends after the\n"
            "samples in hand; the image is written and says so. A second one ends at once, without a file.\n\n"
            "Examples:\n"
            "  photonbench render cornell -o cornell.exr\n"
            "  photonbench render cornell --estimator disc,cone,hull --k 100 --aov -o build/cornell.exr\n"
            "  photonbench render glass-sphere:ior=1.33 --method full --size 512x512 --seconds 30\n"
            "  photonbench render cornell-diffuse --plan\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
