/* A finished job as rows. */
#include "bench.h"

#include "../base/memory.h"

#include <stdio.h>
#include <stdlib.h>

static pm__interval scaled(pm__interval interval, double factor)
{
    return (pm__interval){interval.low * factor, interval.high * factor};
}

/* Bias and noise that theory expects over a region: NAN unless it knows every probe. */
static void fill_prediction(const pm__job *job, size_t v, size_t region, pm__accuracy_row *row)
{
    double bias = 0.0, variance = 0.0;
    const size_t first = job->first[region], end = job->first[region + 1];
    for (size_t q = first; q < end; q++) {
        bias += job->predicted_mean[v * job->probe_count + q] - job->truth[q];
        variance += job->predicted_variance[v * job->probe_count + q];
    }
    const double count = (double)(end - first);
    row->predicted_rel_bias = bias / count / job->truth_mean;
    row->predicted_rel_noise = sqrt(variance / count) / job->truth_mean;
}

static void fill_errors(const pm__job *job, size_t v, size_t region, double *scratch, pm__accuracy_row *row)
{
    const size_t first = job->first[region];
    const pm__trial_errors errors = {job->errors + v * job->config->trials * job->probe_count + first,
                                     job->config->trials, job->first[region + 1] - first, job->probe_count};
    pm__error_summary s;
    pm__summarize_errors(&errors, scratch, &s);
    const double f = 1.0 / job->truth_mean;
    row->rel_bias = s.bias * f;
    row->rms_bias = s.rms_bias * f;
    row->rel_noise = s.noise * f;
    row->rel_rmse = s.rmse * f;
    row->rel_bias_ci95 = scaled(s.bias_ci95, f);
    row->rms_bias_ci95 = scaled(s.rms_bias_ci95, f);
    row->rel_noise_ci95 = scaled(s.noise_ci95, f);
    row->rel_rmse_ci95 = scaled(s.rmse_ci95, f);
}

static void set_status(const pm__job *job, size_t v, pm__accuracy_row *row)
{
    size_t degenerate = 0;
    for (size_t t = 0; t < job->config->trials; t++)
        degenerate += job->degenerate[t * job->variant_count + v];
    row->status = "ok";
    if (degenerate) {
        row->status = "degenerate";
        (void)snprintf(row->detail, sizeof row->detail,
                       "%zu of %zu neighbourhoods of all regions span no area; their estimate counts as 0", degenerate,
                       job->config->trials * job->probe_count);
    } else if (job->variants[v].estimator->needs & PM__TRUTH) {
        (void)snprintf(row->detail, sizeof row->detail, "chosen by the truth, so no one can run it: no time");
    } else if (pm__is_about(job)) {
        (void)snprintf(row->detail, sizeof row->detail,
                       "about %zu photons in a map: how many are stored differs by trial", job->photons);
    }
}

static pm__accuracy_row empty_row(const pm__job *job, size_t v, size_t region)
{
    const pm__interval none = {NAN, NAN};
    const pm__variant *const variant = &job->variants[v];
    return (pm__accuracy_row){
        .case_spec = job->case_spec,
        .estimator_spec = variant->spec,
        .sampler_spec = job->sampler_spec,
        .region = job->subject->regions[region].name,
        .paths = job->subject->paths,
        .knn = variant->k > 0,
        .k = variant->k,
        .radius = isinf(variant->radius) ? NAN : pm__decimal_of_float((float)variant->radius),
        .photons = job->photons,
        .search = job->config->search ? job->config->search : pm__searches.entries[0]->name,
        .trials = job->config->trials,
        .probes = job->first[region + 1] - job->first[region],
        .truth_mean = job->truth_mean,
        .rel_bias = NAN, .rms_bias = NAN, .rel_noise = NAN, .rel_rmse = NAN,
        .rel_bias_ci95 = none, .rms_bias_ci95 = none, .rel_noise_ci95 = none, .rel_rmse_ci95 = none,
        .predicted_rel_bias = NAN, .predicted_rel_noise = NAN,
        .ns_per_query = NAN, .ns_per_query_ci95 = none, .cost_s = NAN, .efficiency = NAN,
    };
}

static void fill_row(const pm__job *job, const pm__timing *timings, size_t v, size_t region, double *scratch,
                     pm__accuracy_row *row)
{
    *row = empty_row(job, v, region);
    if (job->variants[v].unsupported) {
        row->status = "unsupported";
        (void)snprintf(row->detail, sizeof row->detail, "%s", job->variants[v].unsupported);
        return;
    }
    fill_errors(job, v, region, scratch, row);
    fill_prediction(job, v, region, row);
    set_status(job, v, row);
    if (!timings)
        return;
    row->ns_per_query = timings[v].ns_per_query;
    row->ns_per_query_ci95 = timings[v].ns_per_query_ci95;
    row->cost_s = timings[v].cost_s;
    if (row->rel_rmse > 0.0)
        row->efficiency = 1.0 / (row->rel_rmse * row->rel_rmse * row->cost_s);
}

pm_status pm__append_rows(const pm__job *job, const pm__timing *timings, pm__accuracy_row **rows, size_t *count)
{
    const size_t more = job->variant_count * job->subject->region_count;
    double *const scratch = pm__alloc(job->probe_count + 3 * job->config->trials, sizeof *scratch);
    pm__accuracy_row *const grown = realloc(*rows, (*count + more) * sizeof *grown);
    if (grown)
        *rows = grown;
    if (!scratch || !grown) {
        free(scratch);
        return PM_ENOMEM;
    }
    for (size_t r = 0; r < job->subject->region_count; r++)
        for (size_t v = 0; v < job->variant_count; v++)
            fill_row(job, timings, v, r, scratch, &grown[(*count)++]);
    free(scratch);
    return PM_OK;
}
