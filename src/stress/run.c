/* Rows: tests by subjects, each test's subjects on the caller's threads. */
#include "test.h"

#include "../../estimators/estimator.h"
#include "../base/parallel.h"
#include "../search/search.h"
#include "../search/wide.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Beside the defaults: what else can go wrong. */
static const char other_forms[] =
    "disc:last=half,disc:last=none,cone:k=1,last=none,cone:k=0.5,cone:k=1000,last=half,gaussian:form=pavicic,"
    "gaussian:form=normalised,last=none,epanechnikov:last=none,biweight:last=half,differential:trend=3,start=4,"
    "differential:rule=significance,z=1,start=5,last=none,differential:rule=significance,noise=stratified,z=1,"
    "hull:boundary=0,hull:boundary=1,outside=zero,combined:rule=mean,last=none,combined:maps=3,last=half,"
    "precomputed:form=unbiased,fraction=1,when=demand,precomputed:form=unbiased,oracle:last=none";

enum { MOST_SEARCHES = 16 };

typedef struct plan {
    const pm__stress_config *config;
    const pm_search *searches[MOST_SEARCHES];
    size_t search_count;
    pm__stress_widths widths;
    pm__stress_row *rows;
    size_t row_count;
    /* Of the test under way. */
    const pm__stress_test *test;
    uint32_t number;       /* of the test: which random numbers */
    pm__stress_row *first; /* its rows */
    atomic_int status;
} plan;

static size_t per_estimator(const plan *p)
{
    return p->search_count * p->widths.count;
}

static size_t row_count_of(const plan *p, const pm__stress_test *test)
{
    return test->make ? (1 + p->config->estimator_count) * per_estimator(p) : test->subjects(p->config->full);
}

static bool wanted(const plan *p, size_t test)
{
    return !p->config->tests || p->config->tests[test];
}

static bool canceled(const plan *p)
{
    return p->config->canceled && p->config->canceled(p->config->context);
}

/* ---- Rows of sets ------------------------------------------------------------------------------ */

static void name_subject(const plan *p, size_t estimator, size_t search, size_t width, char *subject)
{
    char name[PM__MAX_SPEC] = "";
    if (estimator)
        pm__spec_format(&p->config->estimators[estimator - 1], name, sizeof name);
    (void)snprintf(subject, PM__STRESS_SUBJECT, "%s%s%s %s", name, estimator ? " " : "",
                   p->searches[search]->entry.name, pm__simd_name(p->widths.width[width]));
}

static void fill_row(const plan *p, const pm__worst *worst, pm__stress_row *row)
{
    const double bound = worst->bound * p->config->bound_factor;
    const bool nothing = worst->lookups == worst->unclear;
    row->unit = worst->unit ? worst->unit : "ulp";
    row->measured = worst->unit && !worst->failed ? worst->measured : NAN;
    row->bound = worst->unit ? bound : NAN;
    row->passed = !worst->failed && !nothing && !(worst->unit && !(worst->measured <= bound));
    if (nothing && !worst->failed)
        (void)snprintf(row->detail, sizeof row->detail, "rounding decided all of %zu lookups: nothing was compared",
                       worst->lookups);
    else if (worst->failed)
        (void)snprintf(row->detail, sizeof row->detail, "%s", worst->detail);
    else
        (void)snprintf(row->detail, sizeof row->detail, "%zu lookups, %zu of them decided by rounding; worst: %.130s",
                       worst->lookups, worst->unclear, worst->detail);
}

static pm_status ask_sets(const plan *p, size_t estimator, pm__hood *hood, pm__worst *worst)
{
    const size_t sets = p->config->full ? p->test->full : p->test->quick;
    pm_status status = PM_OK;
    for (size_t set = 0; set < sets && status == PM_OK; set++) {
        pm__dice dice = {.seed = p->config->seed, .test = p->number, .number = (uint64_t)set << 32};
        const pm__asking asking = {.hood = hood, .spec = estimator ? &p->config->estimators[estimator - 1] : NULL,
                                   .searches = p->searches, .search_count = p->search_count,
                                   .widths = &p->widths, .worst = worst};
        pm__hood_clear(hood);
        p->test->make(hood, set, &dice);
        status = estimator ? pm__stress_ask(&asking) : pm__stress_search(&asking);
        if (canceled(p))
            return PM_ECANCELED;
    }
    return status;
}

static void estimator_task(void *argument, size_t estimator)
{
    plan *const p = argument;
    const size_t count = per_estimator(p);
    pm__worst *const worst = calloc(count, sizeof *worst);
    pm__hood hood = {.photons = calloc(PM__HOOD_MOST, sizeof *hood.photons)};
    pm_status status = worst && hood.photons ? PM_OK : PM_ENOMEM;
    if (status == PM_OK)
        status = ask_sets(p, estimator, &hood, worst);
    for (size_t i = 0; i < count && status == PM_OK; i++) {
        pm__stress_row *const row = &p->first[estimator * count + i];
        row->test = p->test->name;
        name_subject(p, estimator, i / p->widths.count, i % p->widths.count, row->subject);
        fill_row(p, &worst[i], row);
    }
    if (status != PM_OK)
        atomic_store(&p->status, (int)status);
    free(worst);
    free(hood.photons);
}

/* ---- Rows of a test's own ---------------------------------------------------------------------- */

static void subject_task(void *argument, size_t subject)
{
    plan *const p = argument;
    pm__stress_row *const row = &p->first[subject];
    const pm_status status = canceled(p) ? PM_ECANCELED : p->test->measure(subject, p->config, row);
    row->test = p->test->name;
    row->bound *= p->config->bound_factor;
    row->passed = row->measured <= row->bound;
    if (status != PM_OK)
        atomic_store(&p->status, (int)status);
}

static pm_status run_test(plan *p, size_t number)
{
    p->test = pm__stress_tests[number];
    p->number = (uint32_t)number;
    p->first = p->rows + p->row_count;
    atomic_store(&p->status, PM_OK);
    if (p->test->make)
        pm__for(p->config->parallel, 1 + p->config->estimator_count, estimator_task, p);
    else
        pm__for(p->config->parallel, row_count_of(p, p->test), subject_task, p);
    const pm_status status = (pm_status)atomic_load(&p->status);
    if (status == PM_OK)
        p->row_count += row_count_of(p, p->test);
    return status;
}

/* ---- The plan ---------------------------------------------------------------------------------- */

pm_status pm__stress_widths_here(pm__stress_widths *widths, pm_error *error)
{
    pm_simd chosen = PM_SIMD_AUTO;
    const char *const forced = getenv("PHOTONBENCH_SIMD");
    *widths = (pm__stress_widths){.forced = forced && *forced};
    const pm_status status = pm__choose_simd(PM_SIMD_AUTO, &chosen, error);
    for (int w = PM_SIMD_PLAIN; w <= PM_SIMD_AVX512 && status == PM_OK; w++) {
        pm_simd same;
        const bool here = widths->forced ? w == (int)chosen : pm__choose_simd((pm_simd)w, &same, NULL) == PM_OK;
        if (here)
            widths->width[widths->count++] = (pm_simd)w;
        else
            widths->missing[widths->missing_count++] = (pm_simd)w;
    }
    return status;
}

pm_status pm__stress_estimators(bool full, pm__spec **specs, size_t *count)
{
    *specs = NULL;
    *count = 0;
    const pm_status status = pm__spec_parse_list(&pm__estimators, "all", specs, count, NULL);
    return status == PM_OK && full ? pm__spec_parse_list(&pm__estimators, other_forms, specs, count, NULL) : status;
}

static void take_searches(plan *p)
{
    const pm__stress_config *const c = p->config;
    const size_t count = c->searches ? c->search_count : pm__searches.count;
    for (size_t i = 0; i < count && i < MOST_SEARCHES; i++)
        p->searches[p->search_count++] =
            c->searches ? c->searches[i] : (const pm_search *)(const void *)pm__searches.entries[i];
}

static pm_status prepare(plan *p, pm_error *error)
{
    size_t rows = 0;
    pm_status status = pm__stress_widths_here(&p->widths, error);
    if (status != PM_OK)
        return status;
    take_searches(p);
    for (size_t t = 0; t < pm__stress_test_count(); t++)
        rows += wanted(p, t) ? row_count_of(p, pm__stress_tests[t]) : 0;
    p->rows = calloc(rows + 1, sizeof *p->rows);
    return p->rows ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory for %zu rows", rows);
}

pm_status pm__stress_run(const pm__stress_config *config, pm__stress_row **rows, size_t *count, pm_error *error)
{
    plan p = {.config = config};
    *rows = NULL;
    *count = 0;
    pm_status status = prepare(&p, error);
    for (size_t t = 0; t < pm__stress_test_count() && status == PM_OK; t++) {
        if (!wanted(&p, t))
            continue;
        if (config->progress)
            config->progress(config->context, (double)t / (double)pm__stress_test_count(), pm__stress_tests[t]->name);
        status = run_test(&p, t);
        if (status != PM_OK && status != PM_ECANCELED)
            (void)pm__fail(error, status, "%s: %s", pm__stress_tests[t]->name, pm_status_text(status));
    }
    if (status != PM_OK && status != PM_ECANCELED) {
        free(p.rows);
        return status;
    }
    *rows = p.rows;
    *count = p.row_count;
    return status;
}
