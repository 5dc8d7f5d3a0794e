/* stress: does the library hold at the edges? */
#include "commands.h"
#include "interrupt.h"
#include "option_values.h"
#include "parallel.h"
#include "progress.h"
#include "stress_rows.h"

#include "../base/clock.h"
#include "../search/search.h"
#include "../search/wide.h"

#include <stdlib.h>
#include <string.h>

enum { NAME = 32, MOST_NAMES = 32 };

/* ---- Options ----------------------------------------------------------------------------------- */

/* A kind of things that have names, a bit each. */
typedef struct named {
    const char *kind;
    const char *names[MOST_NAMES];
    size_t count;
} named;

static named all_tests(void)
{
    named n = {.kind = "test"};
    for (; n.count < pm__stress_test_count() && n.count < MOST_NAMES; n.count++)
        n.names[n.count] = pm__stress_test_name(n.count);
    return n;
}

static named all_searches(void)
{
    named n = {.kind = "search"};
    for (; n.count < pm__searches.count && n.count < MOST_NAMES; n.count++)
        n.names[n.count] = pm__searches.entries[n.count]->name;
    return n;
}

static pm_status refuse(const named *all, const char *name, pm_error *error)
{
    char known[260] = "";
    const char *const nearest = pm__nearest_name(name, all->names, all->count);
    if (nearest)
        return pm__fail(error, PM_ENAME, "no %s '%s'; did you mean '%s'?", all->kind, name, nearest);
    for (size_t i = 0; i < all->count; i++)
        (void)snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", all->names[i]);
    return pm__fail(error, PM_ENAME, "no %s '%s'; there are: %s", all->kind, name, known);
}

static pm_status take_name(const named *all, const char *name, unsigned *bits, pm_error *error)
{
    const bool every = strcmp(name, "all") == 0;
    bool known = false;
    for (size_t i = 0; i < all->count; i++)
        if (every || strcmp(name, all->names[i]) == 0) {
            *bits |= 1U << i;
            known = true;
        }
    return known ? PM_OK : refuse(all, name, error);
}

static pm_status take_names(const named *all, const char *text, unsigned *bits, pm_error *error)
{
    for (;; text++) {
        char name[NAME];
        const size_t length = strcspn(text, ",");
        (void)snprintf(name, sizeof name, "%.*s", (int)(length < NAME - 1 ? length : NAME - 1), text);
        const pm_status status = take_name(all, name, bits, error);
        text += length;
        if (status != PM_OK || !*text)
            return status;
    }
}

static pm_status set_test(pm__settings *s, const char *text, pm_error *error)
{
    const named all = all_tests();
    return take_names(&all, text, &s->stress_tests, error);
}

static pm_status set_search(pm__settings *s, const char *text, pm_error *error)
{
    const named all = all_searches();
    return take_names(&all, text, &s->stress_searches, error);
}

static const pm__option option_test = {"test", 0, "TEST,...", "tests, or all (all)", set_test};
static const pm__option option_search = {"search", 0, "SEARCH,...", "searches, or all (all)", set_search};

/* ---- The run ----------------------------------------------------------------------------------- */

/* What the config points at. */
typedef struct plan {
    pm__stress_config config;
    pm__stress_widths widths;
    bool tests[MOST_NAMES];
    const pm_search *searches[MOST_NAMES];
    pm__spec *specs; /* where the user named none */
    pm__progress progress;
} plan;

static void show_progress(void *context, double fraction, const char *what)
{
    pm__progress_update(&((plan *)context)->progress, fraction, what);
}

static bool is_canceled(void *context)
{
    (void)context;
    return pm__interrupted();
}

/* For tests: with bounds that cannot hold, rows fail and the exit status is 1. */
static double bound_factor(void)
{
    double factor;
    const char *const text = getenv("PHOTONBENCH_STRESS_BOUND");
    return text && pm__parse_double(text, &factor) == 0 ? factor : 1.0;
}

static pm_status configure(plan *p, const pm__settings *s, const pm_parallel *parallel, pm_error *error)
{
    pm__stress_config *const c = &p->config;
    for (size_t t = 0; t < MOST_NAMES; t++)
        p->tests[t] = !s->stress_tests || s->stress_tests >> t & 1U;
    for (size_t i = 0; i < pm__searches.count; i++)
        if (!s->stress_searches || s->stress_searches >> i & 1U)
            p->searches[c->search_count++] = (const pm_search *)(const void *)pm__searches.entries[i];
    c->tests = p->tests;
    c->searches = p->searches;
    c->seed = s->seed;
    c->full = s->full;
    c->bound_factor = bound_factor();
    c->parallel = parallel;
    c->progress = show_progress;
    c->canceled = is_canceled;
    c->context = p;
    c->estimators = s->estimators.items;
    c->estimator_count = s->estimators.count;
    if (c->estimator_count)
        return pm__stress_widths_here(&p->widths, error);
    if (pm__stress_estimators(s->full, &p->specs, &c->estimator_count) != PM_OK)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    c->estimators = p->specs;
    return pm__stress_widths_here(&p->widths, error);
}

/* A width that was not run must not pass for one that was. */
static void say_skips(const plan *p, const pm__settings *s)
{
    for (size_t w = 0; w < p->widths.missing_count && !s->quiet; w++)
        pm__complain("stress", "SKIP: SIMD width %s: %s", pm__simd_name(p->widths.missing[w]),
                     p->widths.forced ? "PHOTONBENCH_SIMD asks for another" : "this processor lacks it");
}

static bool all_passed(const pm__stress_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!rows[i].passed)
            return false;
    return true;
}

static pm_status measure(plan *p, const pm__settings *s, pm__sinks *sinks, bool *held, pm_error *error)
{
    pm__stress_row *rows = NULL;
    size_t count = 0;
    const double start = pm__seconds();
    pm__progress_start(&p->progress, s->quiet);
    pm_status status = pm__stress_run(&p->config, &rows, &count, error);
    pm__progress_end(&p->progress);
    if (status == PM_OK || status == PM_ECANCELED) {
        const pm__stress_results results = {.settings = s, .config = &p->config, .widths = &p->widths, .rows = rows,
                                            .count = count, .wall_s = pm__seconds() - start,
                                            .interrupted = status == PM_ECANCELED};
        *held = all_passed(rows, count);
        if (pm__sinks_screen(sinks))
            pm__stress_print(pm__sinks_screen(sinks), &results);
        const pm_status written = pm__stress_write(&results, sinks, error);
        status = written ? written : status;
    } else {
        pm__sinks_discard(sinks);
    }
    free(rows);
    return status;
}

static int finish(const pm__settings *s, pm_status status, bool held, const pm_error *error)
{
    return pm__conclude("stress", status, s->quiet, "only the tests that were complete are there",
                        held ? NULL : "not every row passes: see status and detail", error);
}

static int run(pm__settings *s)
{
    pm_error error = {""};
    pm__sinks sinks;
    bool held = true;
    plan p = {.specs = NULL};
    const pm_parallel parallel = pm__parallel_for(&s->threads);
    pm_status status = configure(&p, s, &parallel, &error);
    if (status == PM_OK)
        status = pm__sinks_open(s, true, &sinks, &error);
    pm__interrupt_watch();
    if (status == PM_OK) {
        say_skips(&p, s);
        status = measure(&p, s, &sinks, &held, &error);
    }
    free(p.specs);
    return finish(s, status, held, &error);
}

static const pm__option *const options_taken[] = {
    &option_test,         &pm__option_estimator, &option_search,       &pm__option_profile,  &pm__option_seed,
    &pm__option_threads,  &pm__option_json,      &pm__option_csv,      &pm__option_markdown, &pm__option_output,
    &pm__option_quiet};

const pm__command pm__command_stress = {
    .name = "stress",
    .operands = "",
    .job = "numerical stability: every estimator, search and SIMD width at the edges, one verdict a row",
    .text = "Sets of photons that are hard (duplicates, ties, points on a line or a circle, powers of 1e-38 to\n"
            "1e38 W, extents of 1e-30 to 1e30 m, ...) are asked of each estimator, by each search, with each SIMD\n"
            "width, by number and by radius, in the plane and in space. What comes out is held against sums in\n"
            "extended precision, and the error given in units in the last place beside a bound that is derived.\n"
            "The screen has a line a test and the rows that fail; --json has every row. Exit status 1: a row fails.\n\n"
            "Examples:\n"
            "  photonbench stress\n"
            "  photonbench stress --test powers,stray --estimator disc,hull:boundary=0 --search wide,brute\n"
            "  photonbench stress --profile full --json stress.json\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
