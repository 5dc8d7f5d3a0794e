/* Candidates, and the best of them. */
#include "advising.h"

#include "../base/clock.h"
#include "../methods/progressive/list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const pm__entry pm__advise_map = {.name = "map", .summary = "a single photon map", .citation = "Jensen 1996"};

#define X(name) &pm__progressive_##name.entry,
static const pm__entry *const method_entries[] = {&pm__advise_map, PM_PROGRESSIVE_LIST(X)};
#undef X
const pm__catalogue pm__advise_methods = {"method", method_entries, sizeof method_entries / sizeof *method_entries};

/* Those that need no correction for independent photons, cheap and noiseless, smooth and noisy, and one for edges. */
static const char good_estimators[] = "disc:last=none,cone:last=none,epanechnikov,biweight,hull:boundary=0";
static const double tolerance = 0.25;

uint64_t pm__advise_pilot_seed(const pm__advise_config *config)
{
    return config->seed ^ 0x70696c6f74ull;
}

double pm__advise_time_left(const pm__advising *a)
{
    return a->config->seconds - (pm__seconds() - a->start);
}

void pm__advise_unsupported(pm__advice *advice, const char *why)
{
    char kept[PM__DETAIL_SIZE]; /* why may be the advice's own */
    (void)snprintf(kept, sizeof kept, "%s", why);
    memcpy(advice->detail, kept, sizeof kept);
    advice->status = "unsupported";
    advice->predicted_rel_bias = advice->predicted_rel_noise = NAN;
    advice->predicted_rel_rmse = advice->predicted_seconds = NAN;
}

/* ---- What was not given ------------------------------------------------------------------------ */

typedef struct defaults {
    pm__spec *estimators, methods[2], disc;
    size_t estimator_count;
} defaults;

static bool is_map(const pm__spec *method)
{
    return method->entry == &pm__advise_map;
}

/* A map is judged by an exact answer; of a scene without one there is at best a stored reference. */
static void fill_methods(pm__advise_config *config, defaults *d)
{
    const pm__case *const subject = (const pm__case *)(const void *)config->subject->entry;
    const bool passes = pm__is_traced(subject), maps = !passes || subject->truth;
    pm__spec_default(&pm__advise_map, &d->methods[0]);
    pm__spec_default(&pm__progressive_pppm.entry, &d->methods[1]);
    config->methods = maps ? d->methods : d->methods + 1;
    config->method_count = maps && passes ? 2 : 1;
}

static pm_status fill(const pm__advise_config *given, pm__advise_config *config, defaults *d, pm_error *error)
{
    *config = *given;
    *d = (defaults){.estimators = NULL};
    pm_status status = pm__spec_parse(&pm__estimators, "disc", &d->disc, error);
    if (status == PM_OK && !config->estimator_count)
        status = pm__spec_parse_list(&pm__estimators, good_estimators, &d->estimators, &d->estimator_count, error);
    if (status == PM_OK && !config->estimator_count) {
        config->estimators = d->estimators;
        config->estimator_count = d->estimator_count;
    }
    if (!config->method_count)
        fill_methods(config, d);
    return status;
}

static pm_status check(const pm__advise_config *config, pm_error *error)
{
    if (!(config->error > 0.0) || !(config->error < 1.0))
        return pm__fail(error, PM_EINVAL, "an error of %g: between 0 and 1 is meant", config->error);
    if (!config->probes)
        return pm__fail(error, PM_EINVAL, "no probes");
    const pm__case *const subject = (const pm__case *)(const void *)config->subject->entry;
    for (size_t i = 0; i < config->method_count; i++)
        if (!is_map(&config->methods[i]) && !pm__is_traced(subject))
            return pm__fail(error, PM_EINVAL, "%s takes a scene, in which photons are traced; %s is none: method map",
                            config->methods[i].entry->name, subject->entry.name);
    return PM_OK;
}

/* ---- The best ---------------------------------------------------------------------------------- */

static int rank_of(const pm__advice *a)
{
    return strcmp(a->status, "ok") == 0 ? 0 : strcmp(a->status, "unreachable") == 0 ? 1 : 2;
}

/* Those that reach the error by time, then those that do not by what they do reach. */
static int compare(const void *left, const void *right)
{
    const pm__advice *const a = left, *const b = right;
    if (rank_of(a) != rank_of(b))
        return rank_of(a) - rank_of(b);
    const double x = rank_of(a) ? a->predicted_rel_rmse : a->predicted_seconds;
    const double y = rank_of(a) ? b->predicted_rel_rmse : b->predicted_seconds;
    return (x > y) - (x < y);
}

static pm_status study(pm__advising *a, const defaults *d, const pm__spec *original, size_t original_count,
                       pm_error *error)
{
    const pm__advise_config *const config = a->config;
    pm_status status = PM_OK;
    for (size_t i = 0; i < config->method_count && status == PM_OK; i++) {
        if (is_map(&config->methods[i])) {
            status = pm__advise_maps(a, &config->methods[i], error);
            continue;
        }
        const pm__progressive *const method = (const pm__progressive *)(const void *)config->methods[i].entry;
        const bool looks_up = pm__progressive_looks_up(method);
        const size_t kernels = looks_up && original_count ? original_count : 1;
        for (size_t e = 0; e < kernels && status == PM_OK; e++) {
            const pm__spec *const kernel = original_count ? &original[e] : &d->disc;
            status = pm__advise_passes(a, &config->methods[i], looks_up ? kernel : NULL, error);
        }
    }
    return status;
}

static void forget_reached(pm__advice *a)
{
    a->reached_rel_rmse = a->reached_seconds = a->ratio = NAN;
    a->reached_rel_rmse_ci95 = (pm__interval){NAN, NAN};
}

static pm_status rank(pm__advising *a, pm_error *error)
{
    qsort(a->advice, a->count, sizeof *a->advice, compare);
    if (rank_of(&a->advice[0]) == 2)
        return pm__fail(error, PM_EINVAL, "%s", a->advice[0].detail);
    a->advice[0].advised = rank_of(&a->advice[0]) == 0;
    for (size_t i = 0; i < a->count; i++)
        forget_reached(&a->advice[i]);
    return PM_OK;
}

pm_status pm__advise(const pm__advise_config *given, pm__advice **advice, size_t *count, pm_error *error)
{
    pm__advise_config config;
    defaults d;
    *advice = NULL;
    *count = 0;
    pm_status status = fill(given, &config, &d, error);
    if (status == PM_OK)
        status = check(&config, error);
    pm__advising a = {.config = &config, .start = pm__seconds()};
    if (status == PM_OK) {
        a.advice = calloc(config.method_count * config.estimator_count, sizeof *a.advice);
        status = a.advice ? study(&a, &d, given->estimators, given->estimator_count, error)
                          : pm__fail(error, PM_ENOMEM, "out of memory");
    }
    if (status == PM_OK)
        status = rank(&a, error);
    if (status == PM_OK) {
        *advice = a.advice;
        *count = a.count;
    } else {
        free(a.advice);
    }
    free(d.estimators);
    return status;
}

/* Before what there is to know of the prediction already. */
static void add_detail(pm__advice *advice, const char *what)
{
    char before[PM__DETAIL_SIZE];
    memcpy(before, advice->detail, sizeof before);
    (void)snprintf(advice->detail, sizeof advice->detail, "%.80s%s%.70s", what, *before ? "; " : "", before);
}

static void judge(const pm__advise_config *config, pm__advice *advice)
{
    char text[80];
    advice->ratio = advice->reached_rel_rmse / config->error;
    const bool least = advice->predicted_rel_rmse < (1.0 - tolerance) * config->error; /* there is nothing smaller */
    const bool worse = advice->ratio > 1.0 + tolerance, better = advice->ratio < 1.0 - tolerance;
    if (better && least) {
        add_detail(advice, "better than what was asked for: the least there is");
    } else if (better || worse) {
        advice->status = "missed";
        (void)snprintf(text, sizeof text, "%s than what was asked for by more than 25 %%", better ? "better" : "worse");
        add_detail(advice, text);
    }
}

pm_status pm__advise_verify(const pm__advise_config *config, pm__advice *advice, pm_error *error)
{
    const pm_status status = advice->passes ? pm__advise_verify_passes(config, advice, error)
                                            : pm__advise_verify_map(config, advice, error);
    if (status == PM_OK)
        judge(config, advice);
    else
        forget_reached(advice);
    if (status == PM_ECANCELED) {
        advice->status = "interrupted";
        add_detail(advice, "its verification was interrupted");
    }
    return status;
}
