/* The Gaussian filter, [C02] 2.12: alpha [1 - (1 - exp(-c t2)) / (1 - exp(-beta))], in three readings (errata 3, 4).
 *
 * printed     c = beta/2, as in 2.12, and put into 2.8: the result is over pi r^2, 46.9 % too dark.
 * pavicic     c = beta over r^2 alone, for which alpha = 0.918 makes the weight integrate to 0.99999.
 * normalised  c = beta/2 over pi r^2 times the weight's own integral: the form to use.
 */
#include "kernel.h"

enum { FORM, LAST };
enum { PRINTED, PAVICIC, NORMALISED };

static const pm__param params[] = {
    {"form", PM__CHOICE, PRINTED, 0, 0, "", "printed|pavicic|normalised",
     "printed is eq. 2.12 in 2.8, 46.9 % dark: use normalised; pavicic is exp(-beta d2/r2) over r2"},
    PM__PARAM_LAST};

static const double pi = 3.14159265358979323846;
static const double alpha = 0.918, beta = 1.953;

/* alpha / (1 - exp(-beta)): the factor of the exponential. The rest of the weight is alpha less this. */
static double scale(void)
{
    return alpha / (1.0 - exp(-beta));
}

/* exp(-beta/2 t2) for t2 in [0, 1]: its Chebyshev series there,
 *     exp(-h) (I_0(h) + 2 sum_n (-1)^n I_n(h) T_n(2 t2 - 1)),  h = beta/4,
 * cut after n = 10 and written in powers of t2. The first term left out, 2 I_11(h), bounds the relative error by
 * 1.5e-14; half the time of exp. */
static inline double falloff(double t2)
{
    double p = 1.3405024137765826e-07;
    p = p * t2 - 2.0437569502113382e-06;
    p = p * t2 + 2.027247690864561e-05;
    p = p * t2 - 0.00016779821973586626;
    p = p * t2 + 0.0012041073749800245;
    p = p * t2 - 0.0073990849884390895;
    p = p * t2 + 0.037885905080775314;
    p = p * t2 - 0.15519062780052817;
    p = p * t2 + 0.47677612494347155;
    p = p * t2 - 0.9764999999985935;
    return p * t2 + 0.9999999999999942;
}

/* scales: {alpha - scale, scale}. */
static inline double wide(const double *scales, double t2)
{
    return scales[0] + scales[1] * falloff(t2);
}

static inline double narrow(const double *scales, double t2)
{
    const double f = falloff(t2);
    return scales[0] + scales[1] * (f * f);
}

static double weight(const double *values, double t2)
{
    const double scales[2] = {alpha - scale(), scale()};
    return values[FORM] == PAVICIC ? narrow(scales, t2) : wide(scales, t2);
}

static double weight_slope(const double *values, double t)
{
    const double c = values[FORM] == PAVICIC ? beta : 0.5 * beta;
    return -2.0 * c * t * scale() * exp(-c * t * t);
}

/* d times the integral of t^(d-1) w over [0, 1]; for d = 2 the c of errata, section 3. */
static double integral(double c, int dimensions)
{
    const double e = exp(-c);
    const double part = dimensions == 3 ? 1.5 * (sqrt(pi / c) * erf(sqrt(c)) / (2.0 * c) - e / c) : (1.0 - e) / c;
    return alpha - scale() + scale() * part;
}

static double norm(const double *values, int dimensions)
{
    if (values[FORM] == PRINTED)
        return 1.0;
    if (values[FORM] == NORMALISED)
        return integral(0.5 * beta, dimensions);
    /* Pavicic's filter is planar: in a volume the exact normaliser stands in. */
    return dimensions == 3 ? integral(beta, 3) : 1.0 / pi;
}

static double last(const double *values)
{
    return pm__last_share(values[LAST]);
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    const double scales[2] = {alpha - scale(), scale()};
    const double divisor = norm(values, lookup->dimensions);
    if (values[FORM] == PAVICIC)
        return pm__kernel_estimate(lookup, scales, narrow, divisor, last(values), result);
    return pm__kernel_estimate(lookup, scales, wide, divisor, last(values), result);
}

const pm__estimator pm__estimator_gaussian = {
    .entry = {.name = "gaussian",
              .summary = "Gaussian weight; as printed 46.9 % dark: use form=normalised",
              .citation = "Jensen 1996; Pavicic 1990; course 43, eq. 2.12 and 2.13",
              .params = params,
              .param_count = 2},
    .dimensions = 4 | 8,
    .min_k = 1,
    .estimate = estimate,
    .weight = weight,
    .weight_slope = weight_slope,
    .norm = norm,
    .last = last,
};
