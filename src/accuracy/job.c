/* The plan of a job: probes, variants, what they need, and room for their errors. */
#include "bench.h"

#include "../base/memory.h"
#include "../map/structure.h"
#include "../search/search.h"
#include "../transport/deal.h"

#include <stdlib.h>
#include <string.h>

/* Probes that are near each other follow each other: 10 bits an axis, interleaved. */
static uint32_t morton_code(const double position[3], const double low[3], const double high[3])
{
    uint32_t code = 0;
    for (int a = 0; a < 3; a++) {
        const double extent = high[a] - low[a];
        const uint32_t cell = extent > 0.0 ? (uint32_t)((position[a] - low[a]) / extent * 1023.0) : 0;
        for (unsigned bit = 0; bit < 10; bit++)
            code |= (cell >> bit & 1U) << (3 * bit + (unsigned)a);
    }
    return code;
}

typedef struct keyed_probe {
    uint32_t code, index;
    pm__probe probe;
} keyed_probe;

static int by_code(const void *a, const void *b)
{
    const keyed_probe *const x = a, *const y = b;
    if (x->code != y->code)
        return x->code < y->code ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

/* Where probes lie does not depend on the seed: a mean over probes is then the same quantity in every run, and runs of
 * different seeds differ by their photons alone, which is what the intervals speak of. */
enum { PROBE_KEY = 1 };

static void draw_region(const pm__job *job, size_t region, keyed_probe *keyed, size_t count)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t q = 0; q < count; q++) {
        double u[3];
        pm__random_uniform(PROBE_KEY, PM__FOR_PROBES, (uint32_t)region, q, u, 3);
        job->subject->probe(job->values, region, u, &keyed[q].probe);
        for (int a = 0; a < 3; a++) {
            const double x = (double)(float)keyed[q].probe.position[a]; /* as a query will have it */
            keyed[q].probe.position[a] = x;
            low[a] = fmin(low[a], x);
            high[a] = fmax(high[a], x);
        }
        keyed[q].index = (uint32_t)q;
    }
    for (size_t q = 0; q < count; q++)
        keyed[q].code = morton_code(keyed[q].probe.position, low, high);
    qsort(keyed, count, sizeof *keyed, by_code);
}

static pm_status plan_probes(pm__job *job)
{
    const pm__accuracy_config *const c = job->config;
    const size_t regions = job->subject->region_count;
    size_t total = c->probes_all + (regions - 1) * c->probes_region;
    const size_t largest = c->probes_all > c->probes_region ? c->probes_all : c->probes_region;
    keyed_probe *const keyed = pm__alloc(largest, sizeof *keyed);
    job->probes = pm__alloc(total, sizeof *job->probes);
    job->truth = pm__alloc(total, sizeof *job->truth);
    if (!keyed || !job->probes || !job->truth) {
        free(keyed);
        return PM_ENOMEM;
    }
    for (size_t r = 0; r < regions; r++) {
        const size_t count = r ? c->probes_region : c->probes_all;
        job->first[r] = job->probe_count;
        draw_region(job, r, keyed, count);
        for (size_t q = 0; q < count; q++) {
            job->probes[job->probe_count] = keyed[q].probe;
            job->truth[job->probe_count++] = job->subject->truth(job->values, &keyed[q].probe);
        }
    }
    job->first[regions] = job->probe_count;
    free(keyed);
    for (size_t q = 0; q < c->probes_all; q++)
        job->truth_mean += fabs(job->truth[q]);
    job->truth_mean /= (double)c->probes_all;
    return PM_OK;
}

static double limit_radius(const pm__job *job, size_t k)
{
    const pm__accuracy_config *const c = job->config;
    if (c->auto_threshold > 0.0 && k) {
        const double power = job->subject->power(job->values) / (double)job->photons;
        return job->subject->dimensions == 3 ? pm_max_radius_volume(k, power, 1.0, c->auto_threshold)
                                             : pm_max_radius_surface(k, power, c->auto_threshold);
    }
    if (c->radius > 0.0)
        return c->radius;
    const double reach = job->subject->reach ? job->subject->reach(job->values) : 0.0;
    return reach > 0.0 ? reach : INFINITY;
}

static bool same_deal(const pm__deal_kind *a, const pm__deal_kind *b)
{
    return a->maps == b->maps && a->how == b->how;
}

static pm__deal_kind deal_of(const pm__spec *spec)
{
    return (pm__deal_kind){pm__map_count_of(spec), pm__spec_value(spec, "deal", 0.0)};
}

static size_t variety_of_deal(pm__job *job, const pm__spec *spec)
{
    const pm__deal_kind deal = deal_of(spec);
    size_t i = 0;
    while (i < job->deal_count && !same_deal(&job->deals[i], &deal))
        i++;
    if (i == job->deal_count && i < PM__MAX_VARIETIES)
        job->deals[job->deal_count++] = deal;
    return i;
}

static size_t variety_of_fraction(pm__job *job, const pm__spec *spec)
{
    const double fraction = pm__spec_value(spec, "fraction", 1.0);
    size_t i = 0;
    while (i < job->fraction_count && job->fractions[i] != fraction)
        i++;
    if (i == job->fraction_count && i < PM__MAX_VARIETIES)
        job->fractions[job->fraction_count++] = fraction;
    return i;
}

static size_t variety_of_oracle(pm__job *job, const pm__spec *spec)
{
    size_t i = 0;
    while (i < job->oracle_count && job->oracles[i] != spec)
        i++;
    if (i == job->oracle_count && i < PM__MAX_VARIETIES)
        job->oracles[job->oracle_count++] = spec;
    return i;
}

static bool too_few(const pm__variant *v)
{
    return v->k && v->k / pm__map_count_of(v->spec) < v->estimator->min_k;
}

/* Why the variant has no estimate in this job, or NULL. */
static const char *reason_against(const pm__job *job, const pm__variant *v)
{
    if (!(v->estimator->dimensions & 1U << job->subject->dimensions))
        return job->subject->dimensions == 3 ? "it has no form in a volume" : "it has no form on a surface";
    if (job->subject->brdf && (v->estimator->needs & PM__AT_PHOTON))
        return "it stores irradiance, and radiance is asked for";
    if ((v->estimator->needs & PM__TRUTH) && !v->k)
        return "it chooses a k, and a fixed radius has none";
    return too_few(v) ? "k is too few for it" : NULL;
}

/* Maps that are drawn separately have a sample of their own each, which the sampler rounds on its own. */
static pm_status check_shares(const pm__job *job, const pm__variant *v, pm_error *error)
{
    const size_t maps = pm__map_count_of(v->spec);
    for (size_t m = 0; m < maps; m++) {
        const size_t drawn = pm__drawn_count(job, pm__share(job->photons, maps, m)), k = pm__share(v->k, maps, m);
        char name[PM__MAX_SPEC];
        pm__spec_format_short(v->spec, name, sizeof name);
        if (k > drawn)
            return pm__fail(error, PM_EINVAL,
                            "--k %zu asks each map of --estimator %s for %zu photons; it has the %zu that --sampler %s "
                            "draws for its part of --photons %zu in case %s",
                            v->k, name, k, drawn, job->sampler_spec->entry->name, job->asked_photons,
                            job->case_spec->entry->name);
    }
    return PM_OK;
}

static pm_status check_k(const pm__job *job, const pm__variant *v, pm_error *error)
{
    if (v->k > job->photons)
        return pm__fail(error, PM_EINVAL,
                        "--k %zu is more than the %zu photons that --sampler %s draws for --photons %zu in case %s",
                        v->k, job->photons, job->sampler_spec->entry->name, job->asked_photons,
                        job->case_spec->entry->name);
    const pm__deal_kind deal = deal_of(v->spec);
    return deal.maps > 1 && pm__is_separate(&deal) ? check_shares(job, v, error) : PM_OK;
}

static pm_status plan_variant(pm__job *job, const pm__spec *spec, size_t k, pm_error *error)
{
    const pm__estimator *const estimator = pm__estimator_of(spec);
    pm__variant *const v = &job->variants[job->variant_count++];
    *v = (pm__variant){.spec = spec, .estimator = estimator, .k = k, .radius = (double)(float)limit_radius(job, k)};
    v->unsupported = reason_against(job, v);
    if (v->unsupported)
        return PM_OK;
    const pm_status status = check_k(job, v, error);
    if (status != PM_OK)
        return status;
    if (!k && isinf(v->radius))
        return pm__fail(error, PM_EINVAL, "neither a k nor a radius is given");
    if (estimator->needs & PM__MAPS)
        v->variety = variety_of_deal(job, spec);
    if (estimator->needs & PM__AT_PHOTON)
        v->variety = variety_of_fraction(job, spec);
    if (estimator->needs & PM__TRUTH)
        v->variety = variety_of_oracle(job, spec);
    if (v->variety == PM__MAX_VARIETIES)
        return pm__fail(error, PM_EINVAL, "more than %d different deals, fractions or oracles in one run",
                        PM__MAX_VARIETIES);
    job->offsets |= (estimator->needs & PM__OFFSETS) != 0;
    job->max_k = k > job->max_k ? k : job->max_k;
    job->max_radius = fmax(job->max_radius, v->radius);
    return PM_OK;
}

/* An estimator for which every k is too few was asked for in vain: that is an error, not a table of gaps. */
static pm_status check_variants(const pm__job *job, const pm__spec *spec, pm_error *error)
{
    const pm__variant *last = NULL;
    for (size_t v = 0; v < job->variant_count; v++)
        if (job->variants[v].spec == spec) {
            last = &job->variants[v];
            if (!too_few(last))
                return PM_OK;
        }
    char name[PM__MAX_SPEC];
    pm__spec_format_short(spec, name, sizeof name);
    return pm__fail(error, PM_EINVAL, "--k %zu is too few for --estimator %s: at least %zu are needed", last->k, name,
                    pm__map_count_of(spec) * last->estimator->min_k);
}

static pm_status plan_variants(pm__job *job, pm_error *error)
{
    const pm__accuracy_config *const c = job->config;
    const size_t ks = c->k_count ? c->k_count : 1;
    job->variants = pm__alloc(c->estimator_count * ks, sizeof *job->variants);
    if (!job->variants)
        return PM_ENOMEM;
    for (size_t e = 0; e < c->estimator_count; e++)
        for (size_t i = 0; i < ks; i++) {
            const pm_status status = plan_variant(job, &c->estimators[e], c->k_count ? c->ks[i] : 0, error);
            if (status != PM_OK)
                return status;
        }
    for (size_t e = 0; e < c->estimator_count; e++) {
        const pm_status status = check_variants(job, &c->estimators[e], error);
        if (status != PM_OK)
            return status;
    }
    return PM_OK;
}

/* The oracles choose among k in steps of about a quarter, and the k of the rows themselves. */
static pm_status plan_candidates(pm__job *job)
{
    if (!job->oracle_count)
        return PM_OK;
    job->candidates = pm__alloc(job->max_k + 1, sizeof *job->candidates);
    if (!job->candidates)
        return PM_ENOMEM;
    for (size_t k = 3, next = 3; k <= job->max_k; k++) {
        bool wanted = k == next;
        for (size_t i = 0; i < job->config->k_count; i++)
            wanted |= job->config->ks[i] == k;
        if (wanted)
            job->candidates[job->candidate_count++] = k;
        if (k == next)
            next = k + (k + 3) / 4;
    }
    if (!job->candidate_count)
        job->candidates[job->candidate_count++] = job->max_k;
    return PM_OK;
}

static pm__structure_id structure_of(const pm__job *job)
{
    return job->config->search ? pm_search_find(job->config->search)->structure : PM__WIDE;
}

/* Bytes of one trial's maps at their fullest. */
static double trial_bytes(const pm__job *job)
{
    enum { NUMBER = sizeof(uint32_t), NORMAL = sizeof(float[3]) };
    const double photon = sizeof(pm_photon), deals = (double)job->deal_count;
    const double map = pm__bytes_when_built(structure_of(job), true);
    const double building = pm__bytes_to_build(structure_of(job), true) - map;
    double held = photon + map + deals * map, passing = building + (job->deal_count ? PM__BYTES_TO_DEAL : 0.0);
    for (size_t f = 0; f < job->fraction_count; f++) {
        held += job->fractions[f] * (map + NUMBER + NORMAL);
        passing = fmax(passing, NUMBER + job->fractions[f] * (photon + building));
    }
    if (job->fraction_count)
        held += NORMAL;
    return (double)job->photons * (held + passing);
}

static double probe_count_of(const pm__job *job)
{
    const pm__accuracy_config *const c = job->config;
    return (double)c->probes_all + (double)(job->subject->region_count - 1) * (double)c->probes_region;
}

static double result_bytes(const pm__job *job)
{
    const double variants = (double)job->variant_count, trials = (double)job->config->trials;
    const double choices = (double)(job->oracle_count * job->candidate_count);
    const double errors = (variants + choices) * trials * sizeof(float),
                 theory = (2.0 * variants + choices) * sizeof(double);
    return probe_count_of(job) * (errors + theory + sizeof(pm__probe) + sizeof(double) + sizeof(keyed_probe));
}

/* A system that promises more memory than it has kills who takes it at its word: so ask first. */
static pm_status check_memory(const pm__job *job, pm_error *error)
{
    const pm__accuracy_config *const c = job->config;
    const size_t threads = c->threads ? c->threads : 1, at_once = threads < c->trials ? threads : c->trials;
    /* Times are taken with the maps of a trial at hand, building them anew one by one. */
    const double again = (double)job->photons * pm__bytes_to_build(structure_of(job), true), trial = trial_bytes(job);
    const double needed = result_bytes(job) + fmax((double)at_once * trial, trial + (c->timing ? again : 0.0));
    if (!(c->memory > 0.0) || needed <= c->memory)
        return PM_OK;
    return pm__fail(error, PM_ENOMEM,
                    "case %s: %zu photons a map with %zu at once, %zu trials and %.0f probes take %.3g GB of memory; "
                    "%.3g GB are free",
                    job->case_spec->entry->name, job->photons, at_once, c->trials, probe_count_of(job), 1e-9 * needed,
                    1e-9 * c->memory);
}

static pm_status allocate_results(pm__job *job)
{
    const size_t trials = job->config->trials, plane = trials * job->probe_count;
    const size_t variants = job->variant_count;
    job->errors = pm__alloc_zero(variants * plane, sizeof *job->errors);
    job->degenerate = pm__alloc_zero(variants * trials, sizeof *job->degenerate);
    job->trial_status = pm__alloc_zero(trials, sizeof *job->trial_status);
    job->predicted_mean = pm__alloc(variants * job->probe_count, sizeof *job->predicted_mean);
    job->predicted_variance = pm__alloc(variants * job->probe_count, sizeof *job->predicted_variance);
    const size_t choices = job->oracle_count * job->candidate_count;
    job->oracle_errors = pm__alloc_zero(choices * plane, sizeof *job->oracle_errors);
    job->expected_square = pm__alloc(choices * job->probe_count, sizeof *job->expected_square);
    return job->errors && job->degenerate && job->trial_status && job->predicted_mean && job->predicted_variance &&
                   job->oracle_errors && job->expected_square
               ? PM_OK
               : PM_ENOMEM;
}

static pm_status check_truth(const pm__job *job, pm_error *error)
{
    static const char prefix[] = "scene:";
    const char *const name = job->case_spec->entry->name;
    if (job->subject->truth)
        return PM_OK;
    const size_t skip = strncmp(name, prefix, sizeof prefix - 1) ? 0 : sizeof prefix - 1;
    return pm__fail(error, PM_EINVAL, "%s has no exact answer: see it with `photonbench render %s`", name, name + skip);
}

/* All that can be refused, before anything is drawn. */
static pm_status plan_estimates(pm__job *job, const pm__accuracy_config *config, const pm__spec *case_spec,
                                const pm__spec *sampler_spec, size_t photons, pm_error *error)
{
    memset(job, 0, sizeof *job);
    job->config = config;
    job->subject = (const pm__case *)(const void *)case_spec->entry;
    job->values = case_spec->values;
    job->case_spec = case_spec;
    job->sampler_spec = sampler_spec;
    job->asked_photons = photons;
    pm_status status = check_truth(job, error);
    if (status != PM_OK)
        return status;
    job->photons = pm__drawn_count(job, photons);
    status = plan_variants(job, error);
    if (status == PM_OK)
        status = plan_candidates(job);
    return status == PM_OK ? check_memory(job, error) : status;
}

pm_status pm__job_check(const pm__accuracy_config *config, const pm__spec *case_spec, const pm__spec *sampler_spec,
                        size_t photons, pm_error *error)
{
    pm__job job;
    const pm_status status = plan_estimates(&job, config, case_spec, sampler_spec, photons, error);
    pm__job_free(&job);
    return status;
}

pm_status pm__job_plan(pm__job *job, const pm__accuracy_config *config, const pm__spec *case_spec,
                       const pm__spec *sampler_spec, size_t photons, pm_error *error)
{
    pm_status status = plan_estimates(job, config, case_spec, sampler_spec, photons, error);
    if (status == PM_OK)
        status = pm__job_scene(job, error);
    if (status == PM_OK) {
        status = plan_probes(job);
        if (status == PM_OK)
            status = allocate_results(job);
        if (status != PM_OK)
            (void)pm__fail(error, status, "out of memory for %zu variants of %zu trials with %.0f probes",
                           job->variant_count, config->trials, probe_count_of(job));
    }
    if (status != PM_OK)
        pm__job_free(job);
    return status;
}

void pm__job_free(pm__job *job)
{
    pm__scene_destroy(job->scene);
    pm__paths_destroy(job->paths);
    free(job->probes);
    free(job->truth);
    free(job->variants);
    free(job->candidates);
    free(job->errors);
    free(job->oracle_errors);
    free(job->expected_square);
    free(job->degenerate);
    free(job->trial_status);
    free(job->predicted_mean);
    free(job->predicted_variance);
    memset(job, 0, sizeof *job);
}
