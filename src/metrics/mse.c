/* MSE: the mean square error.
 *
 *     map = 1/3 sum over c of (A_c - B_c)^2
 *
 * Unit: radiance squared. From 0 (equal) without bound; symmetric; A and B times s give s^2 times as much. */
#include "metric.h"

static pm_status measure(const pm__metric_job *job, double *map, pm__shown *shown, pm_error *error)
{
    (void)shown;
    (void)error;
    for (size_t p = 0; p < pm__pixels_of(job); p++) {
        const float *const a = &job->tested->values[3 * p], *const b = &job->reference->values[3 * p];
        double sum = 0.0;
        for (int c = 0; c < 3; c++) {
            const double d = (double)a[c] - (double)b[c];
            sum += d * d;
        }
        map[p] = sum / 3.0;
    }
    return PM_OK;
}

const pm__metric pm__metric_mse = {
    .entry = {.name = "mse", .summary = "mean square error: (A - B)^2", .citation = ""},
    .unit = "(W/(m2 sr))^2",
    .measure = measure,
};
