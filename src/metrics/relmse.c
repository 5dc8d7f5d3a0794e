/* relMSE: the relative mean square error.
 *
 *     map = 1/3 sum over c of (A_c - B_c)^2 / (B_c^2 + epsilon u^2)
 *
 * Rousselle, Knaus, Zwicker 2011, section 5, where u is 1 and images are of a brightness near 1; papers since take
 * epsilon 0.001 to 0.01 (0.01 with u = 1: Rousselle, Manzi, Zwicker 2013). Without it a black pixel of the reference
 * would count without bound. A radiance of 1 W/(m2 sr) means nothing in itself, so `unit` `mean` takes for u the mean
 * of |B| over pixels and channels: the number is then the same for A and B times any s. No unit; from 0 without bound;
 * not symmetric: B is the truth. A term whose divisor is 0 is 0 where A_c = B_c; where it is not, there is no relMSE.
 */
#include "metric.h"

static const pm__param params[] = {PM__EPSILON_PARAMS};

static pm_status measure(const pm__metric_job *job, double *map, pm__shown *shown, pm_error *error)
{
    const double unit = job->values[PM__UNIT] > 0.0 ? 1.0 : pm__mean_size(job->reference);
    const double floor = job->values[PM__EPSILON] * unit * unit;
    (void)shown;
    for (size_t p = 0; p < pm__pixels_of(job); p++) {
        const float *const a = &job->tested->values[3 * p], *const b = &job->reference->values[3 * p];
        double sum = 0.0;
        for (int c = 0; c < 3; c++) {
            const double d = (double)a[c] - (double)b[c], divisor = (double)b[c] * (double)b[c] + floor;
            if (d != 0.0 && !(divisor > 0.0))
                return pm__fail(error, PM_EINVAL, "an error relative to 0: the reference is black in pixel (%zu, %zu)",
                                p % job->reference->width, p / job->reference->width);
            sum += d != 0.0 ? d * d / divisor : 0.0;
        }
        map[p] = sum / 3.0;
    }
    return PM_OK;
}

const pm__metric pm__metric_relmse = {
    .entry = {.name = "relmse",
              .summary = "relative mean square error: (A - B)^2 / (B^2 + epsilon unit^2)",
              .citation = "Rousselle, Knaus, Zwicker 2011",
              .params = params,
              .param_count = 2},
    .unit = "",
    .measure = measure,
};
