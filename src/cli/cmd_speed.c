/* speed: what the tracing and rendering promise, measured. */
#include "commands.h"
#include "interrupt.h"
#include "option_values.h"
#include "parallel.h"
#include "progress.h"
#include "render_options.h"
#include "speed_rows.h"

#include "../base/clock.h"

#include <stdlib.h>
#include <string.h>

enum { PHOTONS = 200000, PASS_PHOTONS = 1 << 18, K = 100, SIDE = 512, NAME = 32 };
static const double default_seconds = 60.0;

/* ---- Options ----------------------------------------------------------------------------------- */

static pm_status refuse_quantity(const char *name, pm_error *error)
{
    const char *const nearest = pm__nearest_name(name, pm__quantity_names, PM__QUANTITIES);
    if (nearest)
        return pm__fail(error, PM_ENAME, "no quantity '%s'; did you mean '%s'?", name, nearest);
    return pm__fail(error, PM_ENAME, "no quantity '%s'; there are: trace, trace-threads, visualize, skip, pass, "
                                     "pass-threads, pass-rays, all", name);
}

static pm_status take_quantity(pm__settings *s, const char *name, pm_error *error)
{
    const bool all = strcmp(name, "all") == 0;
    bool known = false;
    for (int q = 0; q < PM__QUANTITIES; q++)
        if (all || strcmp(name, pm__quantity_names[q]) == 0) {
            s->quantities |= 1U << q;
            known = true;
        }
    return known ? PM_OK : refuse_quantity(name, error);
}

static pm_status set_quantity(pm__settings *s, const char *text, pm_error *error)
{
    pm_status status = PM_OK;
    for (const char *at = text; status == PM_OK; at++) {
        char name[NAME];
        const size_t length = strcspn(at, ",");
        (void)snprintf(name, sizeof name, "%.*s", (int)(length < NAME - 1 ? length : NAME - 1), at);
        status = take_quantity(s, name, error);
        at += length;
        if (!*at)
            break;
    }
    return status;
}

static pm_status set_photons(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_photons.set(s, text, error);
}

static pm_status set_k(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_k.set(s, text, error);
}

static pm_status set_size(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_size.set(s, text, error);
}

static pm_status set_seconds(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->seconds, error);
}

static const pm__option option_quantity = {
    "quantity", 0, "Q,...", "trace, trace-threads, visualize, skip, pass, pass-threads, pass-rays, or all (all)",
    set_quantity};
static const pm__option option_photons = {
    "photons", 0, "N", "photons; of trace at most 20000, of skip 4000 (200000, of a pass 262144)", set_photons};
static const pm__option option_k = {"k", 0, "K", "photons in an estimate (100)", set_k};
static const pm__option option_size = {
    "size", 0, "WxH", "pixels; of skip at most 48 a side (512x512)", set_size};
static const pm__option option_seconds = {"seconds", 0, "S", "time for it all, more or less (60)", set_seconds};

/* ---- The run ----------------------------------------------------------------------------------- */

static void show_progress(void *context, double fraction, const char *what)
{
    pm__progress_update(context, fraction, what);
}

static bool is_canceled(void *context)
{
    (void)context;
    return pm__interrupted();
}

static pm__speed_config config_of(const pm__settings *s, const pm_parallel *parallel, pm__progress *progress)
{
    return (pm__speed_config){.scenes = s->cases.items,
                              .scene_count = s->cases.count,
                              .quantities = s->quantities,
                              .photons = s->photons.count ? s->photons.items[0] : PHOTONS,
                              .pass_photons = s->photons.count ? s->photons.items[0] : PASS_PHOTONS,
                              .k = s->ks.count ? s->ks.items[0] : K,
                              .width = s->render.width ? s->render.width : SIDE,
                              .height = s->render.height ? s->render.height : SIDE,
                              .threads = s->threads,
                              .seconds = s->seconds > 0.0 ? s->seconds : default_seconds,
                              .seed = s->seed,
                              .parallel = parallel,
                              .progress = show_progress,
                              .canceled = is_canceled,
                              .context = progress};
}

/* Images that differ and rows that could not be measured fail; a promise that is not kept is shown. */
static bool all_held(const pm__speed_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(rows[i].status, "differs") == 0 || strcmp(rows[i].status, "failed") == 0)
            return false;
    return true;
}

static void say_why_empty(const pm__settings *s, size_t count)
{
    if (!count && !s->quiet)
        pm__complain("speed", "no rows: trace-threads and pass-threads need --threads 2 or more");
}

static pm_status measure(const pm__settings *s, const pm__speed_config *config, pm__progress *progress,
                         pm__sinks *sinks, bool *held, pm_error *error)
{
    pm__speed_row *rows = NULL;
    size_t count = 0;
    const double start = pm__seconds();
    pm__progress_start(progress, s->quiet);
    pm_status status = pm__speed_run(config, &rows, &count, error);
    pm__progress_end(progress);
    if (status == PM_OK || status == PM_ECANCELED) {
        *held = all_held(rows, count);
        if (pm__sinks_screen(sinks))
            pm__speed_print(pm__sinks_screen(sinks), rows, count);
        const pm_status written = pm__speed_write(s, config, rows, count, pm__seconds() - start, status == PM_ECANCELED,
                                                  sinks, error);
        if (status == PM_OK)
            say_why_empty(s, count);
        status = written ? written : status;
    } else {
        pm__sinks_discard(sinks);
    }
    free(rows);
    return status;
}

static int finish(const pm__settings *s, pm_status status, bool held, const pm_error *error)
{
    return pm__conclude("speed", status, s->quiet, "only the rows that were complete are there",
                        held ? NULL : "images differ, or a row could not be measured: see status and detail", error);
}

static int run(pm__settings *s)
{
    pm_error error = {""};
    pm__sinks sinks;
    pm__progress progress = {.shown = false};
    bool held = true;
    pm_status status = s->operand_count ? pm__render_take_scenes(s, &error) : PM_OK;
    const pm_parallel parallel = pm__parallel_for(&s->threads);
    const pm__speed_config config = config_of(s, &parallel, &progress);
    if (status == PM_OK && config.k > config.photons)
        status = pm__fail(&error, PM_EINVAL, "--k %zu is more than --photons %zu", config.k, config.photons);
    if (status == PM_OK)
        status = pm__sinks_open(s, true, &sinks, &error);
    pm__interrupt_watch(); /* from here on there is something to save */
    if (status == PM_OK)
        status = measure(s, &config, &progress, &sinks, &held, &error);
    return finish(s, status, held, &error);
}

static const pm__option *const options_taken[] = {
    &option_quantity,     &option_photons,  &option_k,           &option_size,       &option_seconds,
    &pm__option_threads,  &pm__option_seed, &pm__option_json,    &pm__option_csv,    &pm__option_markdown,
    &pm__option_output,   &pm__option_quiet};

const pm__command pm__command_speed = {
    .name = "speed",
    .operands = "[SCENE...]",
    .max_operands = PM__MAX_OPERANDS,
    .job = "how fast photons are traced and images made, beside what is promised",
    .text = "Each quantity is a ratio of times of two kinds of work that take turns, with its 95 % interval:\n"
            "  trace          photons traced, to Embree alone on the same rays      at least 0.6 of its rate\n"
            "  trace-threads  photons shot on all threads, to one                   at least 1.8 times its rate\n"
            "  visualize      a photon map's image, to its rays and bare search     at most 1.5 times their time\n"
            "  skip           a render of what is needed, to one of everything      the same image\n"
            "  pass           a pass of ppm, to its tracing and bare searches       at most 1.3 times their time\n"
            "  pass-threads   such a pass on all threads, to one                    at least 1.8 times its rate\n"
            "  pass-rays      processors' time of such a pass, to Embree's random rays    at most 2 million\n"
            "Without a SCENE: trace and trace-threads of cornell, glass-sphere, integrating-sphere and\n"
            "fractal-cornell, visualize and passes of cornell, skip of every scene. A promise that is missed\n"
            "is shown and is no error. Exit status 1: images of skip differ, or a row could not be measured.\n\n"
            "Examples:\n"
            "  photonbench speed\n"
            "  photonbench speed --quantity trace,trace-threads --threads 2 --json speed.json\n"
            "  photonbench speed cornell glass-sphere:ior=1.33 --quantity visualize --k 50 --threads 1\n"
            "  photonbench speed pool prism --quantity skip --seconds 20\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
