/* What theory says of each variant at each probe, where it says anything. */
#include "law.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <stdatomic.h>
#include <stdlib.h>

enum { BLOCK = 64 };

typedef struct prediction {
    pm__job *job;
    pm__law_rule rule;
    pm__kernel_law *laws; /* [variant] */
    bool *has_law;        /* [variant] */
    double power, flux;   /* W, of all photons and of each */
    bool independent;
    atomic_bool refused; /* memory, to any block */
} prediction;

/* p within r: of the job's case around a probe, as the lookup has it. */
static double share_within(const prediction *p, size_t probe, double r0, double r1)
{
    const pm__job *const job = p->job;
    return job->subject->mass(job->values, &job->probes[probe], &job->config->lookup, r0, r1) / p->power;
}

/* A radius within which a share `wanted` lies, not much larger than needed; at most `limit`. */
static double find_reach(const prediction *p, size_t probe, double wanted, double limit)
{
    double high = fmin(limit, 1e-3), low = 0.0;
    while (high < limit && high < 1e6 && share_within(p, probe, 0.0, high) < wanted) {
        low = high;
        high = fmin(2.0 * high, limit);
    }
    for (int i = 0; i < 4; i++) {
        const double middle = 0.5 * (low + high);
        if (share_within(p, probe, 0.0, middle) < wanted)
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* The table behind all variants: as far as the largest k may look. NAN anywhere means that there is no theory here. */
static bool tabulate(const prediction *p, size_t probe, pm__radial *radial)
{
    const pm__job *const job = p->job;
    const size_t k = job->max_k;
    const double wanted = k ? fmin(1.0, exp(pm__largest_log_p(k, job->photons))) : 1.0;
    radial->dimensions = job->subject->dimensions;
    if (isnan(share_within(p, probe, 0.0, 1e-3)))
        return false;
    radial->reach = k ? find_reach(p, probe, wanted, job->max_radius) : job->max_radius;
    double sum = 0.0, before = 0.0;
    for (int i = 1; i <= PM__LAW_CELLS; i++) {
        const double s = radial->reach * i / PM__LAW_CELLS;
        sum += share_within(p, probe, before, s);
        radial->ratio[i] = sum / (radial->dimensions == 3 ? s * s * s : s * s);
        before = s;
    }
    /* The limit at 0 is smooth: a parabola through the first nodes. */
    radial->ratio[0] = fmax(0.0, 3.0 * radial->ratio[1] - 3.0 * radial->ratio[2] + radial->ratio[3]);
    radial->total = sum;
    return !isnan(sum);
}

/* What a photon's power counts at a probe: 1, or where radiance is asked for the BRDF, if light comes from one
 * direction. NAN: photons differ. */
static double worth_at(const pm__job *job, size_t probe)
{
    const pm__case *const subject = job->subject;
    double along[3], value[3];
    if (!subject->brdf)
        return 1.0;
    if (!subject->incoming)
        return NAN;
    subject->incoming(job->values, &job->probes[probe], along);
    subject->brdf(job->values, along, job->probes[probe].outgoing, value);
    return value[0];
}

static void predict_variant(const prediction *p, size_t v, size_t probe, const pm__law_grid *grid)
{
    pm__job *const job = p->job;
    const pm__moments m = pm__kernel_moments(&p->laws[v], grid, p->flux * worth_at(job, probe));
    job->predicted_mean[v * job->probe_count + probe] = m.mean;
    if (p->independent)
        job->predicted_variance[v * job->probe_count + probe] = m.variance;
}

/* Variants come estimator by estimator; those with the same k and radius share a grid. */
static void predict_kernels(const prediction *p, size_t probe, const pm__radial *radial, bool *done)
{
    const pm__job *const job = p->job;
    for (size_t v = 0; v < job->variant_count; v++)
        done[v] = !p->has_law[v] || (job->variants[v].k && !p->independent);
    for (size_t v = 0; v < job->variant_count; v++) {
        if (done[v])
            continue;
        const pm__variant *const first = &job->variants[v];
        pm__law_grid grid;
        const bool known = pm__law_grid_init(&grid, &p->rule, true, radial, first->k, job->photons, first->radius);
        for (size_t w = v; w < job->variant_count; w++)
            if (!done[w] && job->variants[w].k == first->k && job->variants[w].radius == first->radius) {
                done[w] = true;
                if (known)
                    predict_variant(p, w, probe, &grid);
            }
    }
}

/* The expected squared error of the disc with each of the oracles' candidates. */
static void predict_candidates(const prediction *p, size_t probe, const pm__radial *radial)
{
    const pm__job *const job = p->job;
    for (size_t c = 0; c < job->candidate_count && p->independent; c++) {
        pm__law_grid grid;
        if (!pm__law_grid_init(&grid, &p->rule, false, radial, job->candidates[c], job->photons, job->max_radius))
            continue;
        for (size_t o = 0; o < job->oracle_count; o++) {
            const pm__moments m = pm__disc_moments(&grid, p->flux * worth_at(job, probe),
                                                   pm__estimator_of(job->oracles[o])->last(job->oracles[o]->values));
            const double bias = m.mean - job->truth[probe];
            job->expected_square[(o * job->candidate_count + c) * job->probe_count + probe] =
                m.variance + bias * bias;
        }
    }
}

static void predict_probe(const prediction *p, size_t probe, bool *done)
{
    pm__radial radial;
    if (!tabulate(p, probe, &radial))
        return;
    predict_kernels(p, probe, &radial, done);
    predict_candidates(p, probe, &radial);
}

static void predict_block(void *argument, size_t block)
{
    prediction *const p = argument;
    if (pm__is_canceled(p->job->config))
        return;
    bool *const done = pm__alloc(p->job->variant_count, sizeof *done);
    if (!done) {
        atomic_store(&p->refused, true);
        return;
    }
    for (size_t q = block * BLOCK; q < p->job->probe_count && q < (block + 1) * BLOCK; q++)
        predict_probe(p, q, done);
    free(done);
}

/* Laws of constant irradiance that the quadrature does not cover: the hull, combined maps, differential checking. */
static void predict_uniform(const prediction *p, size_t v)
{
    pm__job *const job = p->job;
    const pm__variant *const variant = &job->variants[v];
    const double *const values = variant->spec->values;
    if (!variant->estimator->uniform_mean || !p->independent || !variant->k || variant->unsupported)
        return;
    if (!isinf(variant->radius) || (variant->estimator->needs & PM__AT_PHOTON))
        return;
    const double factor = variant->estimator->uniform_mean(values, variant->k, job->subject->dimensions);
    const bool at_edges = variant->estimator->holds_at_edges && variant->estimator->holds_at_edges(values);
    /* The farthest that a lookup for k reaches, with 50 % to spare; interior regions keep 0.15 m free. */
    const double share = (double)variant->k / (double)job->photons;
    for (size_t r = 0; r < job->subject->region_count; r++) {
        const pm__region *const region = &job->subject->regions[r];
        if (!region->uniform || (!region->interior && !at_edges))
            continue;
        for (size_t q = job->first[r]; q < job->first[r + 1]; q++) {
            const double density = job->truth[q] / worth_at(job, q) / job->subject->power(job->values);
            const double reach = job->subject->dimensions == 3 ? cbrt(share / (4.18879 * density))
                                                               : sqrt(share / (3.14159 * density));
            if (at_edges || 1.5 * reach < 0.15)
                job->predicted_mean[v * job->probe_count + q] = factor * job->truth[q];
        }
    }
}

pm_status pm__predict(pm__job *job)
{
    for (size_t i = 0; i < job->variant_count * job->probe_count; i++)
        job->predicted_mean[i] = job->predicted_variance[i] = NAN;
    for (size_t i = 0; i < job->oracle_count * job->candidate_count * job->probe_count; i++)
        job->expected_square[i] = NAN;
    const pm__sampler *const sampler = (const pm__sampler *)(const void *)job->sampler_spec->entry;
    prediction p = {.job = job,
                    .laws = pm__alloc(job->variant_count, sizeof *p.laws),
                    .has_law = pm__alloc_zero(job->variant_count, sizeof *p.has_law),
                    .power = job->subject->power(job->values),
                    .independent = sampler->independent};
    if (!p.laws || !p.has_law) {
        free(p.laws);
        free(p.has_law);
        return PM_ENOMEM;
    }
    p.flux = p.power / (double)job->photons;
    pm__law_rule_init(&p.rule);
    for (size_t v = 0; v < job->variant_count; v++) {
        const bool plain = !(job->variants[v].estimator->needs & (PM__MAPS | PM__AT_PHOTON | PM__TRUTH));
        if (plain && !job->variants[v].unsupported)
            p.has_law[v] = pm__kernel_law_init(&p.laws[v], &p.rule, &job->variants[v], job->subject->dimensions);
        predict_uniform(&p, v);
    }
    if (job->subject->mass)
        pm__for(job->config->parallel, (job->probe_count + BLOCK - 1) / BLOCK, predict_block, &p);
    free(p.laws);
    free(p.has_law);
    if (atomic_load(&p.refused))
        return PM_ENOMEM;
    return pm__is_canceled(job->config) ? PM_ECANCELED : PM_OK;
}
