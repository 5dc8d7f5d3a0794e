/* storage: what storage policies cost, and what they are worth in the rendered view. */
#include "commands.h"
#include "interrupt.h"
#include "option_values.h"
#include "parallel.h"
#include "progress.h"
#include "render_options.h"
#include "storage_options.h"
#include "storage_task.h"

#include "../base/clock.h"

#include <stdlib.h>
#include <string.h>

enum { QUICK_TRIALS = 8, FULL_TRIALS = 32, K = 50, PATHS = 100000, GATHER = 4 };
enum { QUICK_LOOKS = 1 << 16, FULL_LOOKS = 1 << 18 }; /* eye paths of an image, by which maps are looked at */
/* Photons of large maps: at most; and for each of the largest number that is asked for. */
enum { QUICK_LARGE = 500000, FULL_LARGE = 2000000, LARGER = 5 };
static const double default_share = 0.25;
static const char default_scenes[] = "egg,office,maze,wide-floor";

/* A task and all that it points at. */
typedef struct work {
    pm__storage_task task;
    pm_parallel parallel;
    size_t scene; /* in hand */
    pm__progress progress;
} work;

/* ---- What is asked for ------------------------------------------------------------------------- */

/* Every policy: `all` is the name of one. */
static pm_status default_policies(pm__specs *policies, pm_error *error)
{
    if (policies->count)
        return PM_OK;
    policies->items = calloc(pm__policies.count, sizeof *policies->items);
    if (!policies->items)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    for (; policies->count < pm__policies.count; policies->count++)
        pm__spec_default(pm__policies.entries[policies->count], &policies->items[policies->count]);
    return PM_OK;
}

static pm_status fill_defaults(pm__settings *s, pm_error *error)
{
    pm__storage_options *const o = &s->storage;
    pm_status status = default_policies(&o->policies, error);
    if (status == PM_OK && !s->photons.count && !o->stored.count)
        status = pm__parse_counts(s->full ? "50000,200000,800000,3200000" : "50000,200000,800000", 1, PM_MAX_PHOTONS,
                                  &s->photons, error);
    if (!o->maps[PM__CAUSTIC_MAP] && !o->maps[PM__GLOBAL_MAP])
        o->maps[PM__CAUSTIC_MAP] = o->maps[PM__GLOBAL_MAP] = true;
    if (!s->trials)
        s->trials = s->full ? FULL_TRIALS : QUICK_TRIALS;
    if (!o->paths)
        o->paths = PATHS;
    if (!o->importance) {
        o->importance = "both";
        o->measure = PM__OF_BOTH;
    }
    if (!(o->share > 0.0))
        o->share = default_share;
    return status;
}

static int ascending(const void *a, const void *b)
{
    const size_t x = *(const size_t *)a, y = *(const size_t *)b;
    return x < y ? -1 : x > y;
}

static void show_progress(void *context, double fraction, const char *what)
{
    work *const w = context;
    char label[80];
    (void)snprintf(label, sizeof label, "%s, %s", strchr(w->task.scenes[w->scene].scene->entry->name, ':') + 1, what);
    pm__progress_update(&w->progress, ((double)w->scene + fraction) / (double)w->task.count, label);
}

static bool is_canceled(void *context)
{
    (void)context;
    return pm__interrupted();
}

static size_t large_of(const pm__settings *s)
{
    const pm__counts *const lists[] = {&s->photons, &s->storage.stored};
    const size_t most = s->full ? FULL_LARGE : QUICK_LARGE;
    size_t large = 0;
    for (int i = 0; i < 2; i++)
        for (size_t j = 0; j < lists[i]->count; j++)
            large = lists[i]->items[j] > large ? lists[i]->items[j] : large;
    return large < most / LARGER ? LARGER * large : most;
}

static void configure(work *w)
{
    pm__settings *const s = (pm__settings *)(uintptr_t)w->task.settings;
    const pm__storage_options *const o = &s->storage;
    if (s->photons.count)
        qsort(s->photons.items, s->photons.count, sizeof *s->photons.items, ascending);
    if (o->stored.count)
        qsort(o->stored.items, o->stored.count, sizeof *o->stored.items, ascending);
    w->task.wish = (pm__storage_wish){.policies = o->policies.items,
                                      .photons = s->photons.items,
                                      .stored = o->stored.items,
                                      .policy_count = o->policies.count,
                                      .photon_count = s->photons.count,
                                      .stored_count = o->stored.count,
                                      .maps = {o->maps[0], o->maps[1]},
                                      .width = s->render.width,
                                      .height = s->render.height,
                                      .spp = s->render.spp,
                                      .looks = s->full ? FULL_LOOKS : QUICK_LOOKS,
                                      .gather = GATHER,
                                      .large = large_of(s),
                                      .k = s->ks.count ? s->ks.items[0] : K,
                                      .paths = o->paths,
                                      .measure = (pm__measure)o->measure,
                                      .share = o->share,
                                      .trials = s->trials,
                                      .seconds = s->seconds,
                                      .seed = s->seed,
                                      .images = s->output,
                                      .parallel = &w->parallel,
                                      .progress = show_progress,
                                      .canceled = is_canceled,
                                      .context = w};
}

/* ---- The run ----------------------------------------------------------------------------------- */

static pm_status make_scenes(work *w, pm_error *error)
{
    const pm__settings *const s = w->task.settings;
    w->task.scenes = calloc(s->cases.count, sizeof *w->task.scenes);
    if (!w->task.scenes)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    for (; w->task.count < s->cases.count; w->task.count++)
        w->task.scenes[w->task.count].scene = &s->cases.items[w->task.count];
    return PM_OK;
}

static pm__storage_wish wish_of(const work *w, size_t scene)
{
    pm__storage_wish wish = w->task.wish;
    wish.scene = w->task.scenes[scene].scene;
    return wish;
}

/* What does not fit is refused before it is begun. */
static pm_status check_memory(const work *w, pm_error *error)
{
    const double memory = pm__free_memory();
    for (size_t i = 0; i < w->task.count; i++) {
        const pm__storage_wish wish = wish_of(w, i);
        const double wanted = pm__storage_bytes(&wish);
        if (memory > 0.0 && wanted > memory)
            return pm__fail(error, PM_ENOMEM, "%s takes %.3g GB of memory; %.3g GB are free",
                            wish.scene->entry->name, 1e-9 * wanted, 1e-9 * memory);
    }
    return PM_OK;
}

static pm_status refuse(pm__storage_scene *scene, const pm_error *reason)
{
    scene->status = "unsupported";
    (void)snprintf(scene->detail, sizeof scene->detail, "%.*s", (int)sizeof scene->detail - 1, reason->text);
    return PM_OK;
}

/* One scene. What cannot be measured is a row that says why; ECANCELED: it has the rows that there were. */
static pm_status measure(work *w, pm_error *error)
{
    pm__storage_scene *const scene = &w->task.scenes[w->scene];
    const pm__storage_wish wish = wish_of(w, w->scene);
    pm_status status = pm__storage_measure(&wish, &scene->result, error);
    if (status == PM_EINVAL)
        return refuse(scene, error);
    if (status != PM_OK)
        return status;
    const bool cut = scene->result.interrupted;
    scene->status = cut ? "interrupted" : "ok";
    if (cut)
        (void)snprintf(scene->detail, sizeof scene->detail, "interrupted: %zu of %zu trials", scene->result.trials,
                       wish.trials);
    if (w->task.settings->output)
        status = pm__storage_files_write(&w->task, scene, error);
    return status == PM_OK && cut ? PM_ECANCELED : status;
}

/* EINVAL, with the first one's reason: none of them could be measured. */
static pm_status measure_all(work *w, pm_error *error)
{
    pm_status status = PM_OK;
    size_t refused = 0;
    pm__progress_start(&w->progress, w->task.settings->quiet);
    for (; status == PM_OK && w->scene < w->task.count; w->scene++) {
        pm_error reason = {""};
        status = pm__interrupted() ? PM_ECANCELED : measure(w, &reason);
        if (!*error->text || (status != PM_OK && status != PM_ECANCELED))
            *error = reason;
        refused += status == PM_OK && strcmp(w->task.scenes[w->scene].status, "unsupported") == 0;
    }
    pm__progress_end(&w->progress);
    return refused == w->task.count ? PM_EINVAL : status;
}

/* What no scene can do is told before the work. */
static pm_status check(const work *w, pm_error *error)
{
    size_t refused = 0;
    for (size_t i = 0; i < w->task.count; i++) {
        const pm__storage_wish wish = wish_of(w, i);
        pm_error reason = {""};
        const pm_status status = pm__storage_check(&wish, &reason);
        refused += status != PM_OK;
        if (!*error->text || (status != PM_OK && status != PM_EINVAL))
            *error = reason;
        if (status != PM_OK && status != PM_EINVAL) /* no memory is no reason to go on without the scene */
            return status;
    }
    return refused == w->task.count ? PM_EINVAL : check_memory(w, error);
}

/* -o names images here. */
static pm_status open_sinks(const pm__settings *s, pm__sinks *sinks, pm_error *error)
{
    pm__settings rows = *s;
    rows.output = NULL;
    return pm__sinks_open(&rows, !s->quiet, sinks, error);
}

static pm_status do_job(work *w, pm_error *error)
{
    pm__sinks sinks;
    const double start = pm__seconds();
    pm_status status = make_scenes(w, error);
    if (status == PM_OK)
        status = check(w, error);
    if (status == PM_OK)
        status = pm__storage_files_check(&w->task, error);
    if (status == PM_OK)
        status = open_sinks(w->task.settings, &sinks, error);
    pm__interrupt_watch(); /* from here on there is something to save */
    if (status != PM_OK)
        return status;
    status = measure_all(w, error);
    if (status != PM_OK && status != PM_ECANCELED) {
        pm__sinks_discard(&sinks);
        return status;
    }
    if (pm__sinks_screen(&sinks))
        pm__storage_print(pm__sinks_screen(&sinks), &w->task);
    const pm_status written = pm__storage_write(&w->task, pm__seconds() - start, status == PM_ECANCELED, &sinks, error);
    return written ? written : status;
}

static void free_work(work *w)
{
    for (size_t i = 0; i < w->task.count; i++)
        pm__storage_free(&w->task.scenes[i].result);
    free(w->task.scenes);
}

static int run(pm__settings *settings)
{
    pm_error error = {""};
    work w = {.task.settings = settings};
    if (!settings->operand_count)
        settings->operands[settings->operand_count++] = default_scenes;
    pm_status status = pm__render_take_scenes(settings, &error);
    if (status == PM_OK)
        status = fill_defaults(settings, &error);
    if (status == PM_OK) {
        w.parallel = pm__parallel_for(&settings->threads);
        configure(&w);
        status = do_job(&w, &error);
    }
    free_work(&w);
    return pm__conclude("storage", status, settings->quiet,
                        "rows are of the trials that were complete, where there are two", NULL, &error);
}

static const pm__option *const options_taken[] = {
    &pm__storage_option_policy, &pm__storage_option_photons,    &pm__storage_option_stored,
    &pm__storage_option_map,    &pm__storage_option_k,          &pm__storage_option_trials,
    &pm__storage_option_paths,  &pm__storage_option_importance, &pm__storage_option_share,
    &pm__storage_option_size,   &pm__storage_option_spp,        &pm__storage_option_seconds,
    &pm__option_profile,        &pm__option_seed,               &pm__option_threads,
    &pm__option_json,           &pm__option_csv,                &pm__option_markdown,
    &pm__storage_option_output, &pm__option_quiet};

const pm__command pm__command_storage = {
    .name = "storage",
    .operands = "[SCENE...]",
    .max_operands = PM__MAX_OPERANDS,
    .job = "photons stored and time against the image's error, by storage policy",
    .text = "A scene or policy is NAME[:key=value[,key=value...]]; 'photonbench list' shows them. Scenes are egg,\n"
            "office, maze and wide-floor unless named; those with a stored reference will do. A row is one policy,\n"
            "map and number of photons: independent maps are looked at by the same eye paths, and the images are\n"
            "compared with the reference. Below stands how much more `all` needs at equal error: photons stored,\n"
            "time. Intervals are 95 %, over trials. -o NAME writes NAME.SCENE.MAP[.POLICY].KIND.exr and .png:\n"
            "required and actual density, and for caustics where they have converged. Ctrl-C shows what there is\n"
            "(status 130); a second one ends at once.\n\n"
            "Examples:\n"
            "  photonbench storage\n"
            "  photonbench storage egg,office,maze --policy all,percentage,probability,density,emission\n"
            "  photonbench storage egg --map caustic --photons 100000,400000 --trials 16 --json egg.json\n"
            "  photonbench storage maze --policy all,density --stored 20000,80000 --importance pixels\n"
            "  photonbench storage egg --policy density --photons 1000000 --trials 2 -o density\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
