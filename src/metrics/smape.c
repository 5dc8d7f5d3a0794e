/* SMAPE: the symmetric form of mape.
 *
 *     map = 1/3 sum over c of |A_c - B_c| / (|A_c| + |B_c| + epsilon u)
 *
 * Vogels et al. 2018, section 6: epsilon 0.01, u = 1. Here u is by default the mean of |A| and |B| together, so that
 * scale does not matter and A and B may change places. No unit; 0 (equal) to 1 (one of them is 0, epsilon is 0, or they
 * differ in sign); symmetric. Twice as bright and half as bright count alike. A term whose divisor is 0 is 0: then A_c
 * and B_c are. */
#include "metric.h"

#include <math.h>

static const pm__param params[] = {PM__EPSILON_PARAMS};

static pm_status measure(const pm__metric_job *job, double *map, pm__shown *shown, pm_error *error)
{
    const double mean = 0.5 * (pm__mean_size(job->tested) + pm__mean_size(job->reference));
    const double floor = job->values[PM__EPSILON] * (job->values[PM__UNIT] > 0.0 ? 1.0 : mean);
    (void)shown;
    (void)error;
    for (size_t p = 0; p < pm__pixels_of(job); p++) {
        const float *const a = &job->tested->values[3 * p], *const b = &job->reference->values[3 * p];
        double sum = 0.0;
        for (int c = 0; c < 3; c++) {
            const double d = fabs((double)a[c] - (double)b[c]);
            sum += d > 0.0 ? d / (fabs((double)a[c]) + fabs((double)b[c]) + floor) : 0.0;
        }
        map[p] = sum / 3.0;
    }
    return PM_OK;
}

const pm__metric pm__metric_smape = {
    .entry = {.name = "smape",
              .summary = "symmetric absolute relative error: |A - B| / (|A| + |B| + epsilon unit)",
              .citation = "Vogels et al. 2018",
              .params = params,
              .param_count = 2},
    .within_1 = true,
    .unit = "",
    .measure = measure,
};
