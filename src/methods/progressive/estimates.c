/* A run's own estimate of its error, without the truth: noise and bias at each point, from sums over passes (Hachisuka,
 * Jarosz and Jensen 2010, whose formulas are for statistics that shrink; here the answer is taken as what it is, the
 * mean of the estimates x_j of i passes, and the rest is derived from that).
 *
 * Noise. Passes have photons of their own; radii depend on passes before, so that x_j - mu_j, where mu_j is what is
 * expected of pass j given its radius, are uncorrelated, each with a variance v_j of its own (it grows as the radius
 * shrinks). That of the mean is V = sum v_j / i^2. With m the mean of the x_j
 *     E sum (x_j - m)^2 = sum v_j (1 - 1/i) + sum (mu_j - mu)^2,
 * so sum (x_j - m)^2 / (i (i - 1)) has the mean V + sum (mu_j - mu)^2 / (i (i - 1)): whatever the v_j are, it is
 * unbiased but for the last term, which is the spread of the passes' biases over i - 1, small beside the bias of the
 * mean squared. (Points that are drawn anew are stratified over the pixel, which lowers the variance of the mean; this
 * is not seen here, and V is too large by it.) Late passes vary more, so the sum has fewer degrees of freedom than
 * i - 1: (sum v_j)^2 / sum v_j^2, for v_j ~ j^(1-alpha) (3 - 2 alpha) / (2 - alpha)^2 = 0.94 of them at alpha = 2/3.
 *
 * Bias. A lookup of radius R blurs: E x_j - x = (m2/4) R_j^2 L, with m2 of the kernel and L the Laplacian of the
 * radiance that the point would send (curvature.h). Each pass has an estimate of L from its own photons and so one of
 * its bias, b_j = (m2/4) R_j^2 L_j; that of the answer is B = sum b_j / i, with the variance
 * sum (b_j - B)^2 / (i (i - 1)) as above. A disc's x_j has the variance S / (pi R^2), and L_j one of 97.8 S / r^6 by
 * photons within r, so b_j has (97.8 pi / 64) (R/r)^6 = 4.8 (R/r)^6 times that of x_j: looking no further than R makes
 * the bias twice as uncertain as the answer is. With r = REACH R = 2 R its standard error is 0.27 of the noise. What is
 * paid is a second lookup with four times the photons. (The Laplacian is then that of light blurred over 2 R. Where
 * light has detail as fine as that, at folds and edges, B is wrong.)
 *
 * One point. |error| <= t sqrt(V) + |B| with Student's t of i - 1 degrees. Over bands: the root of the mean square of
 * error is at most that of its noise and that of its bias together, and the noise's is above t sqrt(mean V) no more
 * often than a single normal variable where t^2 > 1.54, whatever the bands' variances and however they are correlated
 * (Szekely and Bakirov 2003: among normal forms of the same trace a single square has the heaviest tail there).
 *
 * All points. The mean of V + B^2 - var B over points, where that of B^2 - var B is not below 0: B^2 is too large by
 * var B on average, at a single point or over all. The floor is put under the mean and not at each point: there, noise
 * alone would add 0.48 var B. The estimate is as uncertain as a mean over points that share photons.
 *
 * Passes' estimates are not kept but the answer is: x_j = j answer_j - (j - 1) answer_{j-1}, to rounding of some j
 * units in the last place of double. */
#include "progressive.h"

#include "../../base/parallel.h"
#include "../../stats/stats.h"
#include "curvature.h"

#include <math.h>

#define REACH 2.0

/* Sums over passes: of estimates and of their squares, mean over bands; of biases likewise. */
enum { SUM, SQUARES = SUM + 3, BIAS, BIAS_SQUARES = BIAS + 3, FIELDS };
_Static_assert((int)FIELDS == (int)PM__OWN_FIELDS, "what the state has room for");

enum { POINTS = 1024 }; /* of one task */

static double *sums_of(const pm__run *run, size_t point)
{
    return run->state + run->of->points * pm__progressive_of(run)->fields + point * FIELDS;
}

/* ---- Passes ------------------------------------------------------------------------------------ */

static void add(double *sums, const double value[3])
{
    for (int b = 0; b < 3; b++) {
        sums[b] += value[b];
        sums[3] += value[b] * value[b] / 3.0;
    }
}

double pm__own_reach(double radius)
{
    return REACH * radius;
}

void pm__run_own_bias(pm__run *run, size_t point, const pm__found *found, double radius)
{
    const pm__neighbors *const set = found->neighbors;
    const double r2 = set->radius2 * found->unit * found->unit, blur = 0.25 * run->of->moment * radius * radius;
    double bias[3] = {0.0, 0.0, 0.0};
    for (size_t j = 0; j < set->count; j++) {
        const double curving = blur * pm__curving((double)set->distance2[j] / set->radius2, r2);
        for (int b = 0; b < 3; b++)
            bias[b] += found->share[b] * (double)set->flux[j][b] * curving;
    }
    add(sums_of(run, point) + BIAS, bias);
}

static void take(pm__run *run, size_t point)
{
    const pm__progressive *const method = pm__progressive_of(run);
    double *const sums = sums_of(run, point) + SUM;
    double value[3];
    method->answer(run, run->state + point * method->fields, value);
    for (int b = 0; b < 3; b++)
        value[b] = value[b] * (double)run->passes - sums[b];
    add(sums, value);
}

static void take_block(void *argument, size_t block)
{
    pm__run *const run = argument;
    for (size_t i = block * POINTS; i < (block + 1) * POINTS && i < run->of->points; i++)
        take(run, i);
}

void pm__run_own_take(pm__run *run)
{
    pm__for(run->of->config->parallel, (run->of->points + POINTS - 1) / POINTS, take_block, run);
}

/* ---- What they say ----------------------------------------------------------------------------- */

/* Of the mean of `passes` values in each band, mean over bands. NAN before the second. */
static double variance_of(const double *sums, double passes)
{
    double squares = sums[3];
    if (passes < 2.0)
        return NAN;
    for (int b = 0; b < 3; b++)
        squares -= sums[b] * sums[b] / (3.0 * passes);
    return fmax(0.0, squares) / (passes * (passes - 1.0));
}

pm__own_error pm__run_own_error(const pm__run *run, size_t point)
{
    const double *const sums = sums_of(run, point), passes = (double)run->passes;
    pm__own_error own = {.variance = variance_of(sums + SUM, passes),
                         .bias_variance = variance_of(sums + BIAS, passes)};
    for (int b = 0; b < 3; b++)
        own.bias[b] = passes < 2.0 ? (double)NAN : sums[BIAS + b] / passes;
    return own;
}

static double square_of(const double v[3])
{
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 3.0;
}

double pm__run_own_bound(const pm__run *run, size_t point, double confidence)
{
    const pm__own_error own = pm__run_own_error(run, point);
    if (run->passes < 2)
        return NAN;
    const double t = pm__student_quantile(0.5 + 0.5 * confidence, (double)run->passes - 1.0);
    return t * sqrt(own.variance) + sqrt(square_of(own.bias));
}

/* The answer, mean over bands. */
static double answer_of(const pm__run *run, size_t point)
{
    const double *const sums = sums_of(run, point) + SUM, *const emitted = run->of->fixed[point].emitted;
    double answer = 0.0;
    for (int b = 0; b < 3; b++)
        answer += sums[b] / (3.0 * run->passes) + (pm__progressive_of(run)->redraws ? 0.0 : emitted[b] / 3.0);
    return answer;
}

double pm__run_own_rel_rmse(const pm__run *run, const size_t *points, size_t count)
{
    double variance = 0.0, bias = 0.0, answer = 0.0;
    if (run->passes < 2)
        return NAN;
    if (!points)
        count = run->of->points;
    for (size_t i = 0; i < count; i++) {
        const size_t point = points ? points[i] : i;
        const pm__own_error own = pm__run_own_error(run, point);
        variance += own.variance;
        bias += square_of(own.bias) - own.bias_variance;
        answer += answer_of(run, point);
    }
    return answer > 0.0 ? sqrt((variance + fmax(0.0, bias)) * (double)count) / answer : (double)NAN;
}
