/* Adaptive progressive photon mapping: passes and answer are those of pppm, but each radius comes from what photons
 * have told so far of the irradiance and of how it curves.
 *
 * The paper (Kaplanyan and Dachsbacher 2013). The radius is chosen by the asymptotic mean squared error of a kernel
 * estimate, from running estimates of variance and Laplacian; the Laplacian has a lookup of its own, whose radius
 * shrinks as i^-1/10 with pass i while that of the estimate shrinks as i^-1/6; before the Laplacian is known, and as
 * bounds, radii follow a schedule. The rest is derived here.
 *
 * Radius. Kernel w with c = integral w ds, infl = integral w^2 ds / c^2, m2 = integral s w ds / c over s = (d/r)^2 from
 * 0 to 1 (docs/errata.md, section 3). An estimate of radius h has the bias b h^2 with b = m2/4 lapl, and the variance
 * a / h^2 with a = infl S / pi, where S is the sum of squared powers per area (power times irradiance for equal
 * photons). A single estimate of all i passes is best at h^6 = a / (2 b^2 i), and that is the paper's radius of pass i.
 * But the answer is the mean of passes whose radii fall as i^-1/6, h_i = g i^-1/6, and so has after n of them
 *     bias  b g^2 (1/n) sum i^-1/3  ->  3/2 b g^2 n^-1/3,   variance  a / g^2 n^-2 sum i^1/3  ->  3/4 a / g^2 n^-2/3.
 * Bias squared and variance add up to the least for g^6 = a / (6 b^2): a radius lower by 3^-1/6 = 0.83, and 13 % less
 * error squared. It is ours here: h_i^6 = a / (6 b^2 i).
 *
 * Laplacian. It is that of the irradiance smoothed by the triweight kernel (curvature.h), of the variance 97.8 S / r^6
 * and with a bias of its own as r^2. With n passes bias^2 and variance fall alike for r ~ n^-1/10. Ours is r_i = REACH
 * h_i i^(1/15), the same rate where h is at its optimum, so that it follows h wherever that goes. Pass i weighs i, so
 * that early lookups with a bad radius are forgotten as n^-2. The sum of squared terms is an estimate v of the variance
 * without any assumption on powers.
 *
 * When it is known. If |lapl| is above twice its standard error, lapl^2 - v stands for its square. Else the radius is
 * that of pppm's schedule, or, where it is larger, the optimum for |lapl| + 2 sqrt v: no smaller one can be right. At
 * twice the standard error of one pass the optimum for a disc is 0.453 r_i, 1.13 h_i: chance alone does not pull the
 * radius down.
 *
 * Bounds. With u = (1 + alpha)/2 and l = alpha/2 the squared radius stays between h_1^2/1024 i^(l-1) and
 * 4 h_1^2 i^(u-1). So, whatever the Laplacian is believed to be, bias falls at least as i^(u-1) and variance at least
 * as i^-l: the method is consistent. A radius depends on the passes before it alone, so even light has no bias.
 *
 * Bands are added up, weighted as they are seen. State of fixed size; a lookup reaches REACH times as far as that of
 * pppm, which is what this method costs more. */
#include "curvature.h"
#include "means.h"
#include "progressive.h"

#include <math.h>

#define REACH 2.5

static const double pi = 3.14159265358979323846;
static const double highest = 4.0, lowest = 1.0 / 1024.0; /* squared radius over that of the first pass, in pass 1 */

enum {
    FIRST2 = PM__MEAN_FIELDS,    /* squared radius of pass 1, m2 */
    RADIUS2,   /* of the coming one */
    GAIN,      /* of the kernel: h^6 = GAIN S / (lapl^2 i) */
    WEIGHT,    /* sums over passes i of: i, */
    LAPLACIAN, /* i times its estimate, W/(m4 sr), */
    NOISE,     /* i^2 times that one's variance, */
    POWER2,    /* i times squared powers per area, (W/sr)^2/m2 */
    FIELDS
};

/* ---- Radii ------------------------------------------------------------------------------------- */

/* infl / (6 pi (m2/4)^2). */
static double gain_of(const pm_estimator *estimator)
{
    const pm__blur blur = pm__blur_of(estimator);
    const double quarter = 0.25 * blur.moment;
    return blur.square / (6.0 * pi * quarter * quarter);
}

static void begin(const pm__run *run, size_t point, double *state)
{
    const double radius = (double)run->of->radius[point];
    state[FIRST2] = state[RADIUS2] = radius * radius;
    state[GAIN] = gain_of(run->of->config->estimator);
}

/* Squared radius that is best in pass i where the square of the Laplacian is `lapl2`. */
static double best(const double *state, double i, double lapl2)
{
    return cbrt(state[GAIN] * state[POWER2] / (state[WEIGHT] * lapl2 * i));
}

/* Squared radius of pass i, from the passes before it. */
static double choose(const double *state, double alpha, double i)
{
    const double scheduled = state[RADIUS2] * (i - 1.0 + alpha) / i;
    const double weight = state[WEIGHT], top = highest * state[FIRST2] * pow(i, 0.5 * (alpha - 1.0));
    double chosen = scheduled;
    if (weight > 0.0 && state[NOISE] > 0.0) {
        const double lapl = fabs(state[LAPLACIAN]) / weight, error = sqrt(state[NOISE]) / weight;
        const double surely = lapl + 2.0 * error;
        chosen = lapl > 2.0 * error ? best(state, i, lapl * lapl - error * error)
                                    : fmax(scheduled, best(state, i, surely * surely));
    }
    return fmax(fmin(chosen, top), lowest * state[FIRST2] * pow(i, 0.5 * alpha - 1.0));
}

static void ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius)
{
    (void)point;
    *k = 0;
    *radius = REACH * pow(run->passes + 1.0, 1.0 / 15.0) * sqrt(state[RADIUS2]);
}

/* ---- What is found ----------------------------------------------------------------------------- */

/* The kernel's estimate, from the photons within the radius: the lookup has gone further. */
static void add_estimate(const pm__run *run, const pm__found *found, double *state)
{
    const pm_estimator *const kernel = run->of->config->estimator;
    const pm__estimator *const of = pm__estimator_of(&kernel->spec);
    const pm__neighbors *const set = found->neighbors;
    const double scale = found->unit * found->unit / state[RADIUS2];
    double sum[3] = {0.0, 0.0, 0.0};
    for (size_t j = 0; j < set->count; j++) {
        const double t2 = (double)set->distance2[j] * scale;
        if (t2 > 1.0)
            continue;
        const double w = of->weight(kernel->spec.values, t2);
        for (int b = 0; b < 3; b++)
            sum[b] += w * (double)set->flux[j][b];
        state[PM__FOUND] += 1.0;
    }
    const double divisor = of->norm(kernel->spec.values, 2) * pi * state[RADIUS2];
    for (int b = 0; b < 3; b++)
        state[PM__SUM + b] += found->share[b] * sum[b] / divisor;
}

static void add_curvature(const pm__found *found, double i, double *state)
{
    const pm__neighbors *const set = found->neighbors;
    const double r2 = set->radius2 * found->unit * found->unit;
    double lapl = 0.0, noise = 0.0, square = 0.0;
    for (size_t j = 0; j < set->count; j++) {
        const double s = (double)set->distance2[j] / set->radius2;
        double power = 0.0;
        for (int b = 0; b < 3; b++)
            power += found->share[b] * (double)set->flux[j][b];
        const double term = power * pm__curving(s, r2);
        lapl += term;
        noise += term * term;
        square += power * power;
    }
    state[WEIGHT] += i;
    state[LAPLACIAN] += i * lapl;
    state[NOISE] += i * i * noise;
    state[POWER2] += i * square / (pi * r2);
}

static void take(const pm__run *run, const pm__found *found, double *state)
{
    const double i = run->passes + 1.0;
    if (found->neighbors && found->area > 0.0) {
        add_estimate(run, found, state);
        add_curvature(found, i, state);
    }
    for (int b = 0; b < 3; b++)
        state[PM__SEEN + b] += found->emitted[b];
    state[RADIUS2] = choose(state, run->of->config->alpha, i + 1.0);
}

/* ---- Answers ----------------------------------------------------------------------------------- */

static pm__point_view view(const pm__run *run, size_t point, const double *state)
{
    (void)run;
    (void)point;
    return (pm__point_view){sqrt(state[RADIUS2]), state[PM__FOUND]};
}

const pm__progressive pm__progressive_appm = {
    .entry = {.name = "appm",
              .summary = "adaptive progressive photon mapping: radii by the least error that photons let expect",
              .citation = "Kaplanyan and Dachsbacher 2013"},
    .uses_photons = true,
    .redraws = true,
    .shrinks = true,
    .fields = FIELDS,
    .begin = begin,
    .ask = ask,
    .take = take,
    .answer = pm__mean_answer,
    .averages = pm__always_averages,
    .view = view,
};
