/* The oracle: at each probe the k of least expected squared error. Where theory knows that expectation it chooses; else
 * the mean over the other trials does, so that the error it is judged by is never the one it was chosen by. (With few
 * trials that choice is itself noisy.) */
#include "bench.h"

#include "../base/memory.h"

#include <stdlib.h>

typedef struct choice {
    const pm__job *job;
    const float *errors; /* [candidate][trial][probe] of one oracle */
    double *sums;        /* [candidate]: squared errors of all trials at the probe in hand */
    size_t candidates;   /* those up to the row's k */
} choice;

static float error_at(const choice *c, size_t candidate, size_t trial, size_t probe)
{
    return c->errors[(candidate * c->job->config->trials + trial) * c->job->probe_count + probe];
}

static void sum_squares(const choice *c, size_t probe)
{
    for (size_t i = 0; i < c->candidates; i++) {
        c->sums[i] = 0.0;
        for (size_t t = 0; t < c->job->config->trials; t++) {
            const double e = (double)error_at(c, i, t, probe);
            c->sums[i] += e * e;
        }
    }
}

static float best_error(const choice *c, size_t trial, size_t probe)
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < c->candidates; i++) {
        const double e = (double)error_at(c, i, trial, probe), others = c->sums[i] - e * e;
        if (others < least) {
            least = others;
            best = i;
        }
    }
    return error_at(c, best, trial, probe);
}

/* The candidate that theory prefers, or `candidates` where it does not know them all. */
static size_t best_expected(const choice *c, const double *expected, size_t probe)
{
    size_t best = 0;
    for (size_t i = 0; i < c->candidates; i++) {
        const double square = expected[i * c->job->probe_count + probe];
        if (isnan(square))
            return c->candidates;
        if (square < expected[best * c->job->probe_count + probe])
            best = i;
    }
    return best;
}

static size_t candidates_up_to(const pm__job *job, size_t k)
{
    size_t count = 0;
    while (count < job->candidate_count && job->candidates[count] <= k)
        count++;
    return count ? count : 1;
}

pm_status pm__apply_oracles(pm__job *job)
{
    const size_t trials = job->config->trials, plane = trials * job->probe_count;
    double *const sums = pm__alloc(job->candidate_count, sizeof *sums);
    if (!sums)
        return PM_ENOMEM;
    for (size_t v = 0; v < job->variant_count; v++) {
        const pm__variant *const variant = &job->variants[v];
        if (variant->unsupported || !(variant->estimator->needs & PM__TRUTH))
            continue;
        const choice c = {job, job->oracle_errors + variant->variety * job->candidate_count * plane, sums,
                          candidates_up_to(job, variant->k)};
        const double *const expected =
            job->expected_square + variant->variety * job->candidate_count * job->probe_count;
        for (size_t q = 0; q < job->probe_count; q++) {
            const size_t best = best_expected(&c, expected, q);
            if (best == c.candidates)
                sum_squares(&c, q);
            for (size_t t = 0; t < trials; t++)
                job->errors[v * plane + t * job->probe_count + q] =
                    best < c.candidates ? error_at(&c, best, t, q) : best_error(&c, t, q);
        }
    }
    free(sums);
    return PM_OK;
}
