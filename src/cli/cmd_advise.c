/* advise: what reaches an error at least cost. */
#include "advise_rows.h"
#include "commands.h"
#include "interrupt.h"
#include "option_values.h"
#include "parallel.h"
#include "progress.h"

#include "../../estimators/estimator.h"
#include "../base/clock.h"

#include <stdlib.h>
#include <string.h>

enum { PROBES = 2048, MOST_CASES = 64 };
static const double default_seconds = 20.0;

/* ---- Options ----------------------------------------------------------------------------------- */

/* "2%" or 0.02. */
static pm_status set_error(pm__settings *s, const char *text, pm_error *error)
{
    char digits[64];
    const size_t length = strlen(text), percent = length && text[length - 1] == '%';
    double value = 0.0;
    (void)snprintf(digits, sizeof digits, "%.*s", (int)(length - percent < 63 ? length - percent : 63), text);
    if (pm__parse_double(digits, &value) || !(value > 0.0) || !(value < (percent ? 100.0 : 1.0)))
        return pm__fail(error, PM_EINVAL, "'%.60s' is no error above 0 and below 1, such as 2%% or 0.02", text);
    s->advise.error = percent ? value / 100.0 : value;
    return PM_OK;
}

static pm_status set_verify(pm__settings *s, const char *text, pm_error *error)
{
    (void)text;
    (void)error;
    s->advise.verify = true;
    return PM_OK;
}

static pm_status set_method(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__advise_methods, text, &s->advise.methods, error);
}

static pm_status set_estimator(pm__settings *s, const char *text, pm_error *error)
{
    return pm__option_estimator.set(s, text, error);
}

static pm_status set_probes(pm__settings *s, const char *text, pm_error *error)
{
    return pm__option_probes.set(s, text, error);
}

static pm_status set_photons(pm__settings *s, const char *text, pm_error *error)
{
    s->photons.count = 0;
    return pm__parse_counts(text, 1, PM_MAX_PHOTONS, &s->photons, error);
}

static pm_status set_seconds(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->seconds, error);
}

static const pm__option option_error = {
    "error", 0, "E", "relative root-mean-square error to be reached, 2% or 0.02 (needed)", set_error};
static const pm__option option_verify = {
    "verify", 0, NULL, "run what is advised and say how close it came", set_verify};
static const pm__option option_method = {
    "method", 0, "METHOD,...", "map where there is an exact answer, or methods of scenes (map, pppm)", set_method};
static const pm__option option_estimator = {
    "estimator", 0, "EST,...", "estimators, or all (five that suit random photons; pppm: disc)", set_estimator};
static const pm__option option_photons = {
    "photons", 0, "N", "photons that a map, or a run, may have at most (what memory holds)", set_photons};
static const pm__option option_probes = {
    "probes", 0, "Q", "points that are asked, and that the cost of a map counts (2048)", set_probes};
static const pm__option option_seconds = {"seconds", 0, "S", "time for pilots, more or less (20)", set_seconds};

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

/* A name that is neither a case's nor a scene's, "scene:" left out or not. */
static pm_status refuse_name(const char *name, pm_error *error)
{
    const char *names[2 * MOST_CASES];
    size_t count = 0;
    for (size_t i = 0; i < pm__all_cases.count && i < MOST_CASES; i++) {
        names[count++] = pm__all_cases.entries[i]->name;
        if (strncmp(names[count - 1], "scene:", 6) == 0) {
            names[count] = names[count - 1] + 6;
            count++;
        }
    }
    const char *const nearest = pm__nearest_name(name, names, count);
    if (nearest)
        return pm__fail(error, PM_EINVAL, "unknown case or scene '%.80s'; did you mean '%s'?", name, nearest);
    return pm__fail(error, PM_EINVAL, "unknown case or scene '%.80s': 'photonbench list cases' and 'photonbench list "
                                      "scenes' show them", name);
}

/* A case by its name; of a scene "scene:" may be left out where no case has that name. */
static pm_status take_subject(pm__settings *s, pm_error *error)
{
    char full[PM__MAX_SPEC + 8], name[PM__MAX_SPEC];
    if (!s->operand_count)
        return pm__fail(error, PM_EINVAL, "a case or a scene is needed: 'photonbench list cases' and 'photonbench list "
                                          "scenes' show them");
    const char *const text = s->operands[0];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(text, ":"), text);
    (void)snprintf(full, sizeof full, "scene:%s", name);
    const bool scene = !pm__find(&pm__all_cases, name) && pm__find(&pm__all_cases, full);
    if (*name && !scene && !strchr(name, ',') && strcmp(name, "all") != 0 && !pm__find(&pm__all_cases, name) &&
        strcmp(name, "scene") != 0)
        return refuse_name(name, error);
    (void)snprintf(full, sizeof full, "%s%.380s", scene ? "scene:" : "", text);
    const pm_status status = pm__parse_specs(&pm__all_cases, full, &s->cases, error);
    if (status == PM_OK && s->cases.count != 1)
        return pm__fail(error, PM_EINVAL, "one case or scene at a time, not '%.80s'", text);
    return status;
}

static pm_status check(const pm__settings *s, pm_error *error)
{
    return s->advise.error > 0.0 ? PM_OK : pm__fail(error, PM_EINVAL, "--error is needed: --error 2%%, say");
}

static pm__advise_config config_of(const pm__settings *s, const pm_parallel *parallel, pm__progress *progress)
{
    return (pm__advise_config){.subject = s->cases.items,
                               .error = s->advise.error,
                               .estimators = s->estimators.items,
                               .estimator_count = s->estimators.count,
                               .methods = s->advise.methods.items,
                               .method_count = s->advise.methods.count,
                               .probes = s->probes ? s->probes : PROBES,
                               .most_photons = s->photons.count ? s->photons.items[0] : 0,
                               .seconds = s->seconds > 0.0 ? s->seconds : default_seconds,
                               .seed = s->seed,
                               .parallel = parallel,
                               .threads = s->threads,
                               .memory = pm__free_memory(),
                               .progress = show_progress,
                               .canceled = is_canceled,
                               .context = progress};
}

static pm_status advise(const pm__advise_config *config, bool verify, pm__progress *progress, bool quiet,
                        pm__advice **advice, size_t *count, pm_error *error)
{
    pm__progress_start(progress, quiet);
    pm_status status = pm__advise(config, advice, count, error);
    if (status == PM_OK && verify && (*advice)[0].advised)
        status = pm__advise_verify(config, &(*advice)[0], error);
    pm__progress_end(progress);
    return status;
}

/* What there is to say of the advised row. */
typedef struct outcome {
    bool any;     /* there is advice */
    bool held;    /* within reach, and as good as that where it was verified */
    double ratio; /* reached over asked for; NAN: it was not verified */
} outcome;

static pm_status measure(const pm__settings *s, const pm__advise_config *config, pm__progress *progress,
                         pm__sinks *sinks, outcome *found, pm_error *error)
{
    pm__advice *advice = NULL;
    size_t count = 0;
    const double start = pm__seconds();
    pm_status status = advise(config, s->advise.verify, progress, s->quiet, &advice, &count, error);
    if (status == PM_OK || (status == PM_ECANCELED && advice)) {
        const pm__advise_task task = {s, config, advice, count, pm__seconds() - start, status == PM_ECANCELED};
        found->any = true;
        found->ratio = advice[0].ratio;
        found->held = advice[0].advised && strcmp(advice[0].status, "ok") == 0;
        if (pm__sinks_screen(sinks))
            pm__advise_print(pm__sinks_screen(sinks), &task);
        const pm_status written = pm__advise_write(&task, sinks, error);
        status = written ? written : status;
    } else {
        pm__sinks_discard(sinks);
    }
    free(advice);
    return status;
}

static int finish(const pm__settings *s, pm_status status, const outcome *found, const pm_error *error)
{
    char missed[80] = "that error is out of reach: see what comes nearest";
    if (isfinite(found->ratio))
        (void)snprintf(missed, sizeof missed, "the error reached is %.3g times the one asked for, not within 25 %%",
                       found->ratio);
    return pm__conclude("advise", status, s->quiet,
                        found->any ? "the advice is not verified" : "there is no advice yet",
                        found->held ? NULL : missed, error);
}

static int run(pm__settings *s)
{
    pm_error error = {""};
    pm__sinks sinks;
    pm__progress progress = {.shown = false};
    outcome found = {.any = false, .held = true, .ratio = (double)NAN};
    pm_status status = check(s, &error);
    if (status == PM_OK)
        status = take_subject(s, &error);
    const pm_parallel parallel = pm__parallel_for(&s->threads);
    pm__interrupt_watch();
    if (status == PM_OK)
        status = pm__sinks_open(s, true, &sinks, &error);
    if (status == PM_OK) {
        const pm__advise_config config = config_of(s, &parallel, &progress);
        status = measure(s, &config, &progress, &sinks, &found, &error);
    }
    return finish(s, status, &found, &error);
}

static const pm__option *const options_taken[] = {
    &option_error,       &option_verify,     &option_method,   &option_estimator,    &option_photons,
    &option_probes,      &option_seconds,    &pm__option_seed, &pm__option_threads,  &pm__option_json,
    &pm__option_csv,     &pm__option_markdown, &pm__option_output, &pm__option_quiet};

const pm__command pm__command_advise = {
    .name = "advise",
    .operands = "CASE|SCENE --error E",
    .max_operands = 1,
    .job = "how many photons, and which k, estimator and method reach an error at least cost",
    .text = "Pilots measure noise and bias; laws fitted to them give, for each method and estimator, the cheapest\n"
            "k and number of photons (or passes) whose relative root-mean-square error is E, and its time.\n"
            "Exit status 1: E is out of reach, or with --verify the error comes out more than 25 % larger or\n"
            "smaller. Ctrl-C while that runs leaves the advice, unverified (status 130).\n\n"
            "Examples:\n"
            "  photonbench advise square --error 2%\n"
            "  photonbench advise scene:glass-sphere --error 2% --verify\n"
            "  photonbench advise plate --error 0.05 --method map,ppm,sppm,pppm --seconds 60 --json advice.json\n"
            "  photonbench advise edge --error 1% --photons 1000000 --estimator disc,epanechnikov\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
