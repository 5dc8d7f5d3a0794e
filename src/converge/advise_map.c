/* Advice on single photon maps: pilots by the accuracy bench, refined about the answer that they suggest. */
#include "advising.h"

#include "../base/clock.h"
#include "../map/structure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A lookup of more than 1/16 of a map's photons smooths whatever there is. */
enum { FIRST_PHOTONS = 32768, LEAST_SHARES = 16, FIRST_KS = 7, LEAST_FIRST_K = 8, PILOT_TRIALS = 8, NEXT_KS = 3 };
enum { LEAST_K = 5, MOST_REFINEMENTS = 3, STEP = 4 };
static const double short_run = 3.0; /* s: a pilot that takes no longer is as large as the answer itself */
enum { LEAST_TRIALS = 8, MOST_TRIALS = 32, FEWEST_TRIALS = 4 };
static const double long_run = 60.0; /* s, of a check: one that would take longer has fewer trials */
static const double memory_share = 0.5; /* of what is free: others take some too */

typedef struct candidate {
    pm__map_law law;
    pm__map_limits limits;
    pm__map_choice choice;
    pm__advice *advice;
    int refinements;
    bool supported;
} candidate;

typedef struct maps {
    pm__advising *of;
    candidate *items; /* [count] */
    size_t count;
} maps;

/* ---- Running the bench ------------------------------------------------------------------------- */

typedef struct stage {
    const pm__advise_config *config;
    double from, to; /* parts of all the work */
} stage;

static void report(void *context, double fraction, const char *what)
{
    const stage *const s = context;
    if (s->config->progress)
        s->config->progress(s->config->context, s->from + (s->to - s->from) * fraction, what);
}

static bool is_canceled(void *context)
{
    const stage *const s = context;
    return s->config->canceled && s->config->canceled(s->config->context);
}

/* Bytes a photon of a trial takes while its map is built and timed. */
static double photon_bytes(void)
{
    return (double)sizeof(pm_photon) + 2.0 * pm__bytes_to_build(PM__WIDE, true);
}

/* As many trials at once as memory holds. */
static size_t trials_at_once(const pm__advise_config *config, size_t photons)
{
    const size_t threads = config->threads ? config->threads : 1;
    const double each = (double)photons * photon_bytes();
    return config->memory > 0.0 && memory_share * config->memory < (double)threads * each ? 1 : threads;
}

typedef struct order {
    const pm__spec *estimators;
    size_t estimator_count;
    const size_t *ks;
    size_t k_count, photons, trials;
    uint64_t seed;
    double from, to;
} order;

static pm_status run_bench(const pm__advise_config *config, const order *o, pm__accuracy_row **rows, size_t *count,
                           pm_error *error)
{
    stage s = {config, o->from, o->to};
    pm__spec sampler;
    const size_t at_once = trials_at_once(config, o->photons);
    pm__spec_default(pm__samplers.entries[0], &sampler);
    const pm__accuracy_config bench = {.cases = config->subject,
                                       .case_count = 1,
                                       .estimators = o->estimators,
                                       .estimator_count = o->estimator_count,
                                       .ks = o->ks,
                                       .k_count = o->k_count,
                                       .photons = &o->photons,
                                       .photon_count = 1,
                                       .samplers = &sampler,
                                       .sampler_count = 1,
                                       .trials = o->trials,
                                       .probes_all = config->probes,
                                       .probes_region = 1,
                                       .lookup = {PM_LOOKUP_SPHERE, 0.0, true},
                                       .seed = o->seed,
                                       .timing = true,
                                       .parallel = at_once > 1 ? config->parallel : NULL,
                                       .threads = at_once,
                                       .memory = config->memory,
                                       .progress = report,
                                       .canceled = is_canceled,
                                       .context = &s};
    const pm_status status = pm__accuracy_run(&bench, rows, count, error);
    return status == PM_OK && is_canceled(&s) ? PM_ECANCELED : status; /* rows of some trials are not what was wanted */
}

/* ---- Pilots ------------------------------------------------------------------------------------ */

static pm__map_sample sample_of(const pm__accuracy_row *row)
{
    const double low = row->rms_bias_ci95.low, high = row->rms_bias_ci95.high;
    const double noise = isnan(row->predicted_rel_noise) ? row->rel_noise : row->predicted_rel_noise;
    const double bias2 = row->rms_bias * row->rms_bias;
    const double queries = 1e-9 * row->ns_per_query * (double)row->probes;
    /* the interval is two-sided, or reaches from 0: its half of 95 % is about 2 standard errors */
    return (pm__map_sample){
        .k = (double)row->k,
        .photons = (double)row->photons,
        .variance = noise * noise,
        .bias2 = bias2,
        .bias2_error = low > 0.0 ? (high * high - low * low) / 4.0 : fmax(high * high - bias2, 0.0) / 2.0,
        .ns_per_query = row->ns_per_query,
        .ns_per_photon = 1e9 * fmax(row->cost_s - queries, 0.0) / (double)row->photons};
}

static void take_row(candidate *c, const pm__accuracy_row *row)
{
    const pm__map_sample sample = sample_of(row);
    if (strcmp(row->status, "unsupported") == 0 || isnan(row->cost_s)) {
        c->supported = false;
        pm__advise_unsupported(c->advice, row->detail);
    } else {
        (void)pm__map_law_add(&c->law, &sample); /* there is room: MOST_REFINEMENTS */
    }
}

static pm_status run_pilot(const maps *m, size_t first, size_t estimators, const order *base, pm_error *error)
{
    const pm__advise_config *const config = m->of->config;
    pm__accuracy_row *rows = NULL;
    pm__spec *const specs = malloc(estimators * sizeof *specs);
    size_t count = 0;
    if (!specs)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    for (size_t e = 0; e < estimators; e++)
        specs[e] = m->items[first + e].advice->estimator;
    order o = *base;
    o.estimators = specs;
    o.estimator_count = estimators;
    o.seed = pm__advise_pilot_seed(config);
    const pm_status status = run_bench(config, &o, &rows, &count, error);
    for (size_t i = 0; i < count && status == PM_OK; i++)
        if (strcmp(rows[i].region, "all") == 0)
            take_row(&m->items[first + (size_t)(rows[i].estimator_spec - specs)], &rows[i]);
    free(rows);
    free(specs);
    return status;
}

static pm_status run_first_pilot(const maps *m, pm_error *error)
{
    size_t ks[FIRST_KS], count = 0;
    const double most = m->items[0].limits.most_photons;
    const size_t photons = most < FIRST_PHOTONS ? (size_t)most : FIRST_PHOTONS;
    for (size_t k = photons / LEAST_SHARES; k >= LEAST_FIRST_K && count < FIRST_KS; k /= 2)
        ks[count++] = k;
    if (!count)
        return pm__fail(error, PM_EINVAL, "%zu photons are too few to learn from: at least %d", photons,
                        LEAST_FIRST_K * LEAST_SHARES);
    const order o = {.ks = ks, .k_count = count, .photons = photons, .trials = PILOT_TRIALS, .from = 0.0, .to = 0.5};
    return run_pilot(m, 0, m->count, &o, error);
}

static size_t trials_for(const pm__advise_config *config, const pm__map_choice *choice)
{
    /* neighbourhoods that are independent of each other: as many as one has shares, and probes */
    const double independent = fmin((double)config->probes, choice->photons / choice->k);
    const double wanted = fmin(fmax(400.0 / independent, LEAST_TRIALS), MOST_TRIALS);
    const double threads = config->threads ? (double)config->threads : 1.0;
    return choice->seconds * wanted / threads > long_run ? FEWEST_TRIALS : (size_t)ceil(wanted);
}

static double seconds_of(const candidate *c, const order *o, size_t threads)
{
    double sum = 0.0;
    for (size_t i = 0; i < o->k_count; i++)
        sum += pm__map_seconds(&c->law, (double)o->ks[i], i ? 0.0 : (double)o->photons, c->limits.queries);
    return sum * (double)o->trials / (double)threads;
}

/* The answer itself on the scale of 1 / scale: the same share, and its neighbours. False where that is no larger than
 * what has been seen. */
static bool plan_refinement(const candidate *c, double scale, size_t ks[NEXT_KS], order *o)
{
    static const double factors[NEXT_KS] = {0.25, 1.0, 4.0};
    const double photons = floor(c->choice.photons / scale);
    o->ks = ks;
    o->k_count = 0;
    o->photons = (size_t)photons;
    for (int i = 0; i < NEXT_KS; i++) {
        const double k = floor(factors[i] * c->choice.k / scale);
        if (k >= fmax(LEAST_FIRST_K, c->limits.least_k) && k <= photons / LEAST_SHARES)
            ks[o->k_count++] = (size_t)k;
    }
    return o->k_count > 0;
}

/* A pilot nearer to the answer, as large as the time left allows. *done: there was none to be run. */
static pm_status refine(maps *m, candidate *c, bool *done, pm_error *error)
{
    size_t ks[NEXT_KS];
    order o = {.trials = trials_for(m->of->config, &c->choice), .from = 0.5, .to = 1.0};
    const double left = pm__advise_time_left(m->of);
    const size_t threads = m->of->config->threads ? m->of->config->threads : 1;
    double scale = 1.0;
    if (plan_refinement(c, scale, ks, &o) && seconds_of(c, &o, threads) > fmin(left, short_run))
        scale = STEP;
    while (plan_refinement(c, scale, ks, &o) && seconds_of(c, &o, threads) > left)
        scale *= 2.0;
    *done = !o.k_count || (scale > 1.0 && o.photons < FIRST_PHOTONS / STEP);
    c->refinements++;
    return *done ? PM_OK : run_pilot(m, (size_t)(c - m->items), 1, &o, error);
}

/* ---- The answer -------------------------------------------------------------------------------- */

static void solve(const maps *m, candidate *c)
{
    c->choice = pm__map_solve(&c->law, &c->limits, m->of->config->error);
}

static candidate *best_of(const maps *m)
{
    candidate *best = NULL;
    for (size_t i = 0; i < m->count; i++) {
        candidate *const c = &m->items[i];
        if (c->supported && (!best || pm__map_is_better(&c->choice, &best->choice)))
            best = c;
    }
    return best;
}

static pm_status settle(maps *m, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; i < m->count; i++)
        solve(m, &m->items[i]);
    for (candidate *c = best_of(m); c && status == PM_OK; c = best_of(m)) {
        bool done = false;
        if (c->refinements == MOST_REFINEMENTS || pm__advise_time_left(m->of) <= 0.0 ||
            (c->refinements && pm__map_is_near(&c->law, &c->choice)))
            break;
        status = refine(m, c, &done, error);
        if (done)
            break;
        solve(m, c);
    }
    return status;
}

static void write_advice(const maps *m, const candidate *c)
{
    pm__advice *const a = c->advice;
    const pm__map_choice *const choice = &c->choice;
    if (!c->supported)
        return;
    if (!isfinite(choice->rel_rmse)) {
        pm__advise_unsupported(a, "its pilots found no noise to fit a law to");
        return;
    }
    a->k = (size_t)choice->k;
    a->photons = (size_t)choice->photons;
    a->trials = trials_for(m->of->config, choice);
    a->predicted_rel_bias = choice->rel_bias;
    a->predicted_rel_noise = choice->rel_noise;
    a->predicted_rel_rmse = choice->rel_rmse;
    a->predicted_seconds = choice->seconds;
    a->status = choice->reachable ? "ok" : "unreachable";
    if (!choice->reachable)
        (void)snprintf(a->detail, sizeof a->detail, "with %.3g photons, the most there can be, %.3g %% is what comes "
                       "nearest", c->limits.most_photons, 100.0 * choice->rel_rmse);
    else if (!pm__map_is_near(&c->law, choice))
        (void)snprintf(a->detail, sizeof a->detail, "extrapolated: no pilot came near it");
}

static double most_photons(const pm__advise_config *config)
{
    double most = config->most_photons ? (double)config->most_photons : (double)PM_MAX_PHOTONS;
    if (config->memory > 0.0)
        most = fmin(most, memory_share * config->memory / photon_bytes());
    return floor(most);
}

static void open_candidate(maps *m, size_t i, const pm__spec *method, const pm__spec *estimator)
{
    const pm__estimator *const e = pm__estimator_of(estimator);
    pm__advice *const advice = &m->of->advice[m->of->count++];
    *advice = (pm__advice){.method = *method, .estimator = *estimator, .status = "ok"};
    const double least = (double)(e->min_k * pm__map_count_of(estimator));
    m->items[i] = (candidate){.advice = advice,
                              .supported = true,
                              .limits = {.queries = (double)m->of->config->probes,
                                         .least_k = fmax(LEAST_K, least),
                                         .most_photons = most_photons(m->of->config)}};
}

/* What the accuracy bench says of it is meant for those who have asked for that. */
static pm_status check_truth(const pm__advise_config *config, pm_error *error)
{
    const pm__case *const subject = (const pm__case *)(const void *)config->subject->entry;
    char name[PM__MAX_SPEC];
    size_t width, height;
    if (subject->truth || !pm__is_traced(subject))
        return PM_OK;
    pm__spec_format_short(config->subject, name, sizeof name);
    return pm__fail(error, PM_EINVAL, "%.50s has no exact answer, which maps are judged by%s", name,
                    pm__converge_reference_size(config->subject, &width, &height)
                        ? "; other methods, such as pppm, are by its stored reference"
                        : "");
}

pm_status pm__advise_maps(pm__advising *a, const pm__spec *method, pm_error *error)
{
    const pm__advise_config *const config = a->config;
    const size_t first = a->count;
    maps m = {a, calloc(config->estimator_count, sizeof *m.items), config->estimator_count};
    if (!m.items)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    for (size_t i = 0; i < m.count; i++)
        open_candidate(&m, i, method, &config->estimators[i]);
    pm_status status = check_truth(config, error);
    if (status == PM_OK)
        status = run_first_pilot(&m, error);
    if (status == PM_OK)
        status = settle(&m, error);
    for (size_t i = 0; i < m.count && status == PM_OK; i++)
        write_advice(&m, &m.items[i]);
    if (status == PM_EINVAL) { /* a scene without an exact answer may have other methods */
        for (size_t i = first; i < a->count; i++)
            pm__advise_unsupported(&a->advice[i], error->text);
        status = PM_OK;
    }
    free(m.items);
    return status;
}

pm_status pm__advise_verify_map(const pm__advise_config *config, pm__advice *advice, pm_error *error)
{
    pm__accuracy_row *rows = NULL;
    size_t count = 0;
    const order o = {.estimators = &advice->estimator, .estimator_count = 1, .ks = &advice->k, .k_count = 1,
                     .photons = advice->photons, .trials = advice->trials, .seed = config->seed,
                     .from = 0.0, .to = 1.0};
    const pm_status status = run_bench(config, &o, &rows, &count, error);
    for (size_t i = 0; i < count && status == PM_OK; i++)
        if (strcmp(rows[i].region, "all") == 0) {
            advice->reached_rel_rmse = rows[i].rel_rmse;
            advice->reached_rel_rmse_ci95 = rows[i].rel_rmse_ci95;
            advice->reached_seconds = rows[i].cost_s;
        }
    free(rows);
    return status;
}
