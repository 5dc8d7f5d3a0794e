/* accuracy: bias, noise, error and time of estimators on cases with exact truth. */
#include "accuracy_rows.h"
#include "commands.h"
#include "interrupt.h"
#include "option_values.h"
#include "parallel.h"
#include "progress.h"
#include "table.h"

#include "../search/search.h"

#include "../base/clock.h"

#include <stdlib.h>
#include <string.h>

enum { QUICK_TRIALS = 32, FULL_TRIALS = 400, PHOTONS = 40000, PROBES = 2048, REGION_PROBES = 512 };

static const size_t quick_ks[] = {15, 50, 200};
static const size_t full_ks[] = {5, 10, 15, 25, 50, 100, 200, 500};

static pm_status default_counts(const size_t *values, size_t count, pm__counts *list, pm_error *error)
{
    if (list->count)
        return PM_OK;
    size_t *const items = realloc(list->items, count * sizeof *items);
    if (!items)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    memcpy(items, values, count * sizeof *items);
    *list = (pm__counts){items, count};
    return PM_OK;
}

/* What was not given gets its default. A radius alone asks for every photon within it, so then there is no k. */
static pm_status fill_defaults(pm__settings *s, pm_error *error)
{
    static const size_t photons[] = {PHOTONS};
    pm_status status = pm__default_specs(&pm__cases, "all", &s->cases, error);
    if (status == PM_OK)
        status = pm__default_specs(&pm__estimators, "all", &s->estimators, error);
    if (status == PM_OK)
        status = pm__default_specs(&pm__samplers, "poisson", &s->samplers, error);
    if (status == PM_OK)
        status = default_counts(photons, 1, &s->photons, error);
    if (status == PM_OK && !(s->radius > 0.0))
        status = s->full ? default_counts(full_ks, sizeof full_ks / sizeof *full_ks, &s->ks, error)
                         : default_counts(quick_ks, sizeof quick_ks / sizeof *quick_ks, &s->ks, error);
    if (!s->trials)
        s->trials = s->full ? FULL_TRIALS : QUICK_TRIALS;
    if (!s->probes)
        s->probes = PROBES;
    if (!s->search)
        s->search = pm__searches.entries[0]->name;
    return status;
}

/* An estimate of more photons than there are is a mistake here: all its numbers would be about something else. */
static pm_status check(const pm__settings *s, bool ks_given, pm_error *error)
{
    for (size_t i = 0; i < s->photons.count; i++)
        for (size_t j = 0; j < s->ks.count; j++)
            if (s->ks.items[j] > s->photons.items[i])
                return pm__fail(error, PM_EINVAL, "--k %zu%s is more than --photons %zu%s", s->ks.items[j],
                                ks_given ? "" : " (the default)", s->photons.items[i], ks_given ? "" : ": give --k");
    return PM_OK;
}

static void configure(const pm__settings *s, const pm_parallel *parallel, pm__accuracy_config *config)
{
    *config = (pm__accuracy_config){
        .cases = s->cases.items,
        .case_count = s->cases.count,
        .estimators = s->estimators.items,
        .estimator_count = s->estimators.count,
        .ks = s->ks.items,
        .k_count = s->ks.count,
        .radius = s->radius,
        .auto_threshold = s->auto_threshold,
        .photons = s->photons.items,
        .photon_count = s->photons.count,
        .samplers = s->samplers.items,
        .sampler_count = s->samplers.count,
        .trials = s->trials,
        .probes_all = s->probes,
        .probes_region = s->probes < REGION_PROBES ? s->probes : REGION_PROBES,
        .search = s->search,
        .lookup = s->lookup,
        .seed = s->seed,
        .timing = true,
        .parallel = parallel,
        .threads = s->threads,
        .memory = pm__free_memory(),
    };
}

static void show_progress(void *context, double fraction, const char *what)
{
    pm__progress_update(context, fraction, what);
}

static bool is_canceled(void *context)
{
    (void)context;
    return pm__interrupted();
}

static void print_screen(FILE *file, const pm__accuracy_config *config, const pm__accuracy_row *rows, size_t count)
{
    const pm__table table = {file, rows, count, config, pm__colourful(file)};
    pm__table_print(&table);
    pm__table_summary(&table);
}

/* Runs and writes what came out. Interrupted: the cases that were complete. */
static pm_status measure(const pm__settings *s, pm__accuracy_config *config, pm__sinks *sinks, pm_error *error)
{
    pm__accuracy_row *rows = NULL;
    size_t count = 0;
    pm__progress progress;
    const double start = pm__seconds();
    pm__progress_start(&progress, s->quiet);
    config->progress = show_progress;
    config->canceled = is_canceled;
    config->context = &progress;
    const pm_status status = pm__accuracy_run(config, &rows, &count, error);
    pm__progress_end(&progress);
    if (status != PM_OK && status != PM_ECANCELED) {
        pm__sinks_discard(sinks);
        free(rows);
        return status;
    }
    if (pm__sinks_screen(sinks))
        print_screen(pm__sinks_screen(sinks), config, rows, count);
    const pm_status written =
        pm__accuracy_write(s, config, rows, count, pm__seconds() - start, status == PM_ECANCELED, sinks, error);
    free(rows);
    return written ? written : status;
}

static int run(pm__settings *settings)
{
    pm_error error = {""};
    pm__sinks sinks;
    pm__accuracy_config config;
    const bool ks_given = settings->ks.count != 0;
    const pm_parallel parallel = pm__parallel_for(&settings->threads);
    pm_status status = fill_defaults(settings, &error);
    if (status == PM_OK)
        status = check(settings, ks_given, &error);
    pm__interrupt_watch();
    if (status == PM_OK)
        status = pm__sinks_open(settings, true, &sinks, &error);
    if (status == PM_OK) {
        configure(settings, &parallel, &config);
        status = measure(settings, &config, &sinks, &error);
    }
    return pm__conclude("accuracy", status, settings->quiet, "only the cases that were complete are there", NULL,
                        &error);
}

static const pm__option *const options_taken[] = {
    &pm__option_case,    &pm__option_estimator, &pm__option_k,       &pm__option_radius, &pm__option_photons,
    &pm__option_sampler, &pm__option_trials,    &pm__option_probes,  &pm__option_search, &pm__option_lookup,
    &pm__option_front,   &pm__option_profile,   &pm__option_seed,    &pm__option_threads, &pm__option_json,
    &pm__option_csv,     &pm__option_markdown,  &pm__option_output,  &pm__option_quiet};

const pm__command pm__command_accuracy = {
    .name = "accuracy",
    .operands = "",
    .job = "bias, noise, error and time of estimators on cases whose truth is known exactly",
    .text = "An estimator, case or sampler is NAME[:key=value[,key=value...]]; 'photonbench list' shows them.\n"
            "Lists may be given with commas or by repeating the option. Photons are drawn from the known\n"
            "irradiance, a map of its own for each trial; intervals are 95 %, over trials. Numbers are relative\n"
            "to the mean truth of region all.\n\n"
            "Examples:\n"
            "  photonbench accuracy\n"
            "  photonbench accuracy --case square --estimator disc,disc:last=none,hull:boundary=0 --k 10,25,50\n"
            "  photonbench accuracy --case corner,wall --estimator disc --radius 0.05 --front off --json -\n"
            "  photonbench accuracy --profile full --threads 2 --quiet --json full.json --csv full.csv\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
