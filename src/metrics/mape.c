/* MAPE: the mean absolute error, relative ("percentage", though it is given as a fraction).
 *
 *     map = 1/3 sum over c of |A_c - B_c| / (|B_c| + epsilon u)
 *
 * epsilon 0.01 as common (Vogels et al. 2018, section 6, has it in SMAPE); u as in relmse.c: the mean of |B|, so that
 * scale does not matter, or 1 W/(m2 sr). It grows with the error's size, not its square: single bright dots count less
 * than in relmse. No unit; from 0 without bound; not symmetric: B is the truth. A term whose divisor is 0 is 0 where
 * A_c = B_c; where it is not, there is no MAPE. */
#include "metric.h"

#include <math.h>

static const pm__param params[] = {PM__EPSILON_PARAMS};

static pm_status measure(const pm__metric_job *job, double *map, pm__shown *shown, pm_error *error)
{
    const double unit = job->values[PM__UNIT] > 0.0 ? 1.0 : pm__mean_size(job->reference);
    (void)shown;
    for (size_t p = 0; p < pm__pixels_of(job); p++) {
        const float *const a = &job->tested->values[3 * p], *const b = &job->reference->values[3 * p];
        double sum = 0.0;
        for (int c = 0; c < 3; c++) {
            const double d = fabs((double)a[c] - (double)b[c]);
            const double divisor = fabs((double)b[c]) + job->values[PM__EPSILON] * unit;
            if (d > 0.0 && !(divisor > 0.0))
                return pm__fail(error, PM_EINVAL, "an error relative to 0: the reference is black in pixel (%zu, %zu)",
                                p % job->reference->width, p / job->reference->width);
            sum += d > 0.0 ? d / divisor : 0.0;
        }
        map[p] = sum / 3.0;
    }
    return PM_OK;
}

const pm__metric pm__metric_mape = {
    .entry = {.name = "mape",
              .summary = "mean absolute relative error: |A - B| / (|B| + epsilon unit)",
              .citation = "",
              .params = params,
              .param_count = 2},
    .unit = "",
    .measure = measure,
};
