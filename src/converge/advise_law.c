/* The error of a photon map and of progressive passes, fitted to what pilots measured.
 *
 * One map of N photons, k of them in a lookup. Of independent photons the estimate at x is a sum over those within r_k,
 * where the share p of all photons that lie within r_k is Beta(k, N - k + 1):
 * - For k << N its relative variance is c / (k - 2) for every kernel, c = 1 for the disc (that of 1 / Gamma(k - 1)).
 *   Averaged over x, relative to the mean truth: A / (k - 2), where A holds the kernel and the mean square of what the
 *   lookup smooths: it depends on the share s = k / N through that smoothing, and on k weakly (the hull). So A is
 *   measured at each pilot's k and s, and taken from the samples nearby, weighted in ln s and, less, in ln k.
 * - The bias depends on the radius alone: on s. What k adds (an estimate that counts its k-th photon is 1 / (k - 1) too
 *   bright) is of the order of 1 / k, the square of the error asked for. Over smooth light |bias| grows as s (by
 *   curvature, r^2), where light ends abruptly its root mean square over points as s^(1/4): the strip that sees it has
 *   the width r. Which of them rules changes with s; B^2(s) is therefore a line through ln B^2 over ln s, fitted about
 *   s with weights that fall with distance (a local power law), to samples that stand clear of their noise. Those that
 *   do not are bounds: B^2 does not exceed the upper limit of one with a larger share. Where none does, B^2 = c s is
 *   fitted to all.
 * Then error^2 = A / (k - 2) + B^2(s). Each s with B(s) below the error E has one k that gives E, which is
 * k = 2 + A / (E^2 - B^2), and N = k / s: candidates form a curve, along which the cheapest is sought. Shares beyond
 * those that were measured are not considered: a map could not be smaller without looking at all its photons.
 *
 * Seconds: photons and queries at times that are powers of N and, queries, of k. The powers are bounded so that with
 * the same k a larger map never is the faster one, whatever a disturbed clock has said of either. */
#include "advise_law.h"

#include <math.h>

bool pm__map_law_add(pm__map_law *law, const pm__map_sample *sample)
{
    if (!(sample->k >= 3.0) || !(sample->variance > 0.0))
        return true;
    if (law->count == PM__MOST_SAMPLES)
        return false;
    law->samples[law->count++] = *sample;
    return true;
}

static double square(double x)
{
    return x * x;
}

static double share_of(const pm__map_sample *s)
{
    return s->k / s->photons;
}

/* Half its height at a distance of ln 2, and heavy in its tails: the nearest always count most. */
static double closeness(double square_of_distance)
{
    static const double reach = 0.7;
    return 1.0 / square(1.0 + square_of_distance / square(reach));
}

double pm__map_variance(const pm__map_law *law, double k, double photons)
{
    double sum = 0.0, weights = 0.0;
    for (size_t i = 0; i < law->count; i++) {
        const pm__map_sample *const s = &law->samples[i];
        const double weight = closeness(square(log(share_of(s) * photons / k)) + 0.1 * square(log(s->k / k)));
        sum += weight * s->variance * (s->k - 2.0);
        weights += weight;
    }
    return sum / weights / (k - 2.0);
}

/* A line through points (x, y) with weights, about `at`: its value there. slope: between low and high; of one point
 * alone, `low`. */
typedef struct line {
    double weight, x, y, xx, xy; /* sums */
} line;

static void line_add(line *sums, double weight, double x, double y)
{
    sums->weight += weight;
    sums->x += weight * x;
    sums->y += weight * y;
    sums->xx += weight * x * x;
    sums->xy += weight * x * y;
}

static double line_at(const line *sums, double at, double low, double high, double alone)
{
    const double x = sums->x / sums->weight, y = sums->y / sums->weight;
    const double spread = sums->xx / sums->weight - x * x;
    const double slope = spread > 1e-9 ? (sums->xy / sums->weight - x * y) / spread : alone;
    return y + fmin(fmax(slope, low), high) * (at - x);
}

static bool is_clear(const pm__map_sample *s)
{
    return s->bias2 > 2.0 * s->bias2_error && s->bias2 > 0.0;
}

/* Where nothing stands clear: B^2 = c s, a power between those of smooth and of abrupt light, c by least squares. */
static double vague_bias2(const pm__map_law *law, double share)
{
    double sum = 0.0, weights = 0.0;
    for (size_t i = 0; i < law->count; i++) {
        const pm__map_sample *const s = &law->samples[i];
        const double weight = 1.0 / (square(s->bias2_error) + 1e-14);
        sum += weight * share_of(s) * s->bias2;
        weights += weight * square(share_of(s));
    }
    return weights > 0.0 ? share * sum / weights : 0.0;
}

double pm__map_bias2(const pm__map_law *law, double share)
{
    line sums = {0.0, 0.0, 0.0, 0.0, 0.0};
    double bound = INFINITY;
    for (size_t i = 0; i < law->count; i++) {
        const pm__map_sample *const s = &law->samples[i];
        if (is_clear(s)) {
            const double scatter = square(0.05) + square(s->bias2_error / s->bias2), away = log(share_of(s) / share);
            line_add(&sums, closeness(square(away)) / scatter, log(share_of(s)), log(s->bias2));
        } else if (share_of(s) >= share) {
            bound = fmin(bound, s->bias2 + 2.0 * s->bias2_error);
        }
    }
    /* B from s^0 to s^1.25; a single value is taken to fall as slowly as abrupt light makes it */
    const double bias2 =
        sums.weight > 0.0 ? exp(line_at(&sums, log(share), 0.0, 2.5, 0.5)) : vague_bias2(law, share);
    return fmin(bias2, bound);
}

/* In the map that a sample was measured in. */
static double query_ns_alike(const pm__map_law *law, double k)
{
    line sums = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < law->count; i++) {
        const pm__map_sample *const s = &law->samples[i];
        if (s->ns_per_query > 0.0)
            line_add(&sums, closeness(square(log(s->k / k))), log(s->k), log(s->ns_per_query));
    }
    return sums.weight > 0.0 ? exp(line_at(&sums, log(k), 0.0, 2.0, 1.0)) : NAN;
}

static double query_ns(const pm__map_law *law, double k, double photons)
{
    line sums = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < law->count; i++) {
        const pm__map_sample *const s = &law->samples[i];
        if (s->ns_per_query > 0.0)
            line_add(&sums, closeness(square(log(s->k / k))), log(s->photons),
                     log(s->ns_per_query / query_ns_alike(law, s->k)));
    }
    const double slower = sums.weight > 0.0 ? exp(line_at(&sums, log(photons), 0.0, 0.5, 0.0)) : 1.0;
    return slower * query_ns_alike(law, k);
}

static double photon_ns(const pm__map_law *law, double photons)
{
    line sums = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < law->count; i++) {
        const pm__map_sample *const s = &law->samples[i];
        if (s->ns_per_photon > 0.0)
            line_add(&sums, 1.0, log(s->photons), log(s->ns_per_photon));
    }
    return sums.weight > 0.0 ? exp(line_at(&sums, log(photons), -0.5, 0.5, 0.0)) : NAN;
}

double pm__map_seconds(const pm__map_law *law, double k, double photons, double queries)
{
    return 1e-9 * (photons * photon_ns(law, photons) + queries * query_ns(law, k, photons));
}

/* ---- Solution ---------------------------------------------------------------------------------- */

/* The shares that are tried go down from the largest measured in steps of a quarter of an octave. */
enum { STEPS_AN_OCTAVE = 4, OCTAVES = 40 };

static double largest_share(const pm__map_law *law)
{
    double largest = 0.0;
    for (size_t i = 0; i < law->count; i++)
        largest = fmax(largest, share_of(&law->samples[i]));
    return largest;
}

static pm__map_choice choice_of(const pm__map_law *law, const pm__map_limits *limits, double k, double photons)
{
    const double bias2 = pm__map_bias2(law, k / photons), variance = pm__map_variance(law, k, photons);
    return (pm__map_choice){.k = k,
                            .photons = photons,
                            .rel_bias = sqrt(bias2),
                            .rel_noise = sqrt(variance),
                            .rel_rmse = sqrt(bias2 + variance),
                            .seconds = pm__map_seconds(law, k, photons, limits->queries)};
}

/* With that share: the whole k that comes nearest to the error. A varies with k, slowly: a few rounds settle it. */
static double solve_k(const pm__map_law *law, double share, double wanted, double least)
{
    double k = fmax(least, 2.0 + 1.0 / wanted);
    for (int i = 0; i < 20; i++)
        k = fmax(least, 2.0 + pm__map_variance(law, k, k / share) * (k - 2.0) / wanted);
    return ceil(k - 0.5);
}

bool pm__map_is_better(const pm__map_choice *a, const pm__map_choice *b)
{
    if (a->reachable != b->reachable)
        return a->reachable;
    return a->reachable ? !(a->seconds >= b->seconds) : a->rel_rmse < b->rel_rmse;
}

/* The largest map that there may be, with that share. */
static pm__map_choice fall_short(const pm__map_law *law, const pm__map_limits *limits, double share)
{
    const double photons = floor(limits->most_photons), k = floor(photons * share);
    if (k < limits->least_k)
        return (pm__map_choice){.rel_rmse = INFINITY};
    return choice_of(law, limits, k, photons);
}

static pm__map_choice with_share(const pm__map_law *law, const pm__map_limits *limits, double share, double error)
{
    const double left = square(error) - pm__map_bias2(law, share);
    if (left > 0.05 * square(error)) {
        const double k = solve_k(law, share, left, limits->least_k), photons = ceil(k / share);
        if (photons <= limits->most_photons) {
            pm__map_choice choice = choice_of(law, limits, k, photons);
            choice.reachable = true;
            return choice;
        }
    }
    return fall_short(law, limits, share);
}

pm__map_choice pm__map_solve(const pm__map_law *law, const pm__map_limits *limits, double error)
{
    pm__map_choice best = {.rel_rmse = INFINITY};
    for (int i = 0; i <= OCTAVES * STEPS_AN_OCTAVE && law->count; i++) {
        const double share = largest_share(law) * exp2(-(double)i / STEPS_AN_OCTAVE);
        const pm__map_choice choice = with_share(law, limits, share, error);
        if (pm__map_is_better(&choice, &best))
            best = choice;
    }
    return best;
}

bool pm__map_is_near(const pm__map_law *law, const pm__map_choice *choice)
{
    for (size_t i = 0; i < law->count; i++) {
        const pm__map_sample *const s = &law->samples[i];
        if (s->photons >= 0.24 * choice->photons && fabs(log2(share_of(s) * choice->photons / choice->k)) <= 1.0)
            return true;
    }
    return false;
}

/* ---- Passes ------------------------------------------------------------------------------------ */

/* The slope of the variance is measured where there are two samples: points that are drawn anew in each pass add noise
 * that falls as 1 / i, so that a pilot sees something between that and the law's slope. The first passes, where sums
 * are not yet integrals, are left out: the last half of the samples counts, each once. */
static double measured_slope(const pm__pass_sample *samples, size_t count, double low, double high)
{
    line sums = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < count; i++)
        if (samples[i].variance > 0.0)
            line_add(&sums, 1.0, log(samples[i].passes), log(samples[i].variance));
    if (!(sums.weight > 0.0))
        return low;
    const double x = sums.x / sums.weight, spread = sums.xx / sums.weight - x * x;
    const double slope = spread > 1e-9 ? (x * sums.y - sums.xy) / sums.weight / spread : low;
    return fmin(fmax(slope, low), high);
}

pm__pass_law pm__pass_law_fit(const pm__pass_sample *samples, size_t count, double variance_slope, double bias2_slope)
{
    const size_t first = count / 2;
    const double slope = measured_slope(samples + first, count - first, variance_slope, fmax(variance_slope, 1.0));
    pm__pass_law law = {0.0, slope, 0.0, bias2_slope};
    for (size_t i = first; i < count; i++) {
        const double share = 1.0 / (double)(count - first);
        law.variance_1 += share * samples[i].variance * pow(samples[i].passes, slope);
        law.bias2_1 += share * samples[i].bias2 * pow(samples[i].passes, bias2_slope);
    }
    return law;
}

double pm__pass_error(const pm__pass_law *law, double passes)
{
    return sqrt(law->variance_1 * pow(passes, -law->variance_slope) + law->bias2_1 * pow(passes, -law->bias2_slope));
}

double pm__pass_solve(const pm__pass_law *law, double error, double most)
{
    double low = 0.0, high = floor(most);
    if (!(high >= 1.0) || !(pm__pass_error(law, high) <= error))
        return 0.0;
    while (high - low > 1.0) {
        const double middle = floor(0.5 * (low + high));
        if (pm__pass_error(law, middle) <= error)
            high = middle;
        else
            low = middle;
    }
    return high;
}

double pm__pass_floor(const pm__pass_law *law)
{
    return law->bias2_slope > 0.0 ? 0.0 : sqrt(law->bias2_1);
}

double pm__pass_nearest(const pm__pass_law *law, double most)
{
    static const double hardly = 1.01;
    return pm__pass_floor(law) > 0.0 ? pm__pass_solve(law, hardly * pm__pass_error(law, most), most) : most;
}
