/* Estimates by their formulas; docs/errata.md has the forms that depart from print. */
#include "judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const long double pi = 3.14159265358979323846264338327950288L;
static const long double alpha = 0.918L, beta = 1.953L; /* [C02] 2.12 */
static const long double float_ulp = 0x1p-24L;

enum { GAUSS_PRINTED, GAUSS_PAVICIC, GAUSS_NORMALISED };

static bool is(const pm__judge_request *request, const char *name)
{
    return strcmp(request->spec->entry->name, name) == 0;
}

static double value_of(const pm__judge_request *request, const char *parameter)
{
    return pm__spec_value(request->spec, parameter, 0);
}

/* `last=full|half|none`. */
static long double last_of(const pm__judge_request *request)
{
    return 1 - (long double)value_of(request, "last") / 2;
}

static long double measure(const pm__judge_request *request, long double r2)
{
    return request->dimensions == 3 ? 4 * pi * r2 * sqrtl(r2) / 3 : pi * r2;
}

/* ---- Kernels ----------------------------------------------------------------------------------- */

static long double gauss_exponent(const pm__judge_request *request)
{
    return value_of(request, "form") == GAUSS_PAVICIC ? beta : beta / 2;
}

/* w at t2 = d2/r2, and the magnitude of its terms. */
static long double weigh(const pm__judge_request *request, long double t2, long double *magnitude)
{
    *magnitude = 1;
    if (is(request, "cone")) {
        const long double part = sqrtl(t2) / (long double)value_of(request, "k");
        *magnitude = 1 + part;
        return part < 1 ? 1 - part : 0;
    }
    if (is(request, "epanechnikov") || is(request, "biweight")) {
        const bool squared = is(request, "biweight");
        *magnitude = squared ? (1 + t2) * (1 + t2) : 1 + t2;
        return squared ? (1 - t2) * (1 - t2) : 1 - t2;
    }
    if (is(request, "gaussian")) {
        const long double fall = expl(-gauss_exponent(request) * t2), whole = 1 - expl(-beta);
        *magnitude = alpha * (1 + (1 + fall) / whole);
        return alpha * (1 - (1 - fall) / whole);
    }
    return 1;
}

/* d times the integral of t^(d-1) exp(-c t^2) from 0 to 1, by its series: the sum of d (-c)^n / (n! (2 n + d)). */
static long double gauss_integral(long double c, int dimensions)
{
    long double term = 1, sum = 0;
    for (int n = 0; n < 60; n++) {
        sum += term * dimensions / (2 * n + dimensions);
        term *= -c / (n + 1);
    }
    return sum;
}

static long double gauss_norm(const pm__judge_request *request)
{
    const int d = request->dimensions;
    if (value_of(request, "form") == GAUSS_PRINTED)
        return 1;
    if (value_of(request, "form") == GAUSS_PAVICIC && d == 2)
        return 1 / pi; /* over r^2 alone */
    return alpha * (1 - (1 - gauss_integral(gauss_exponent(request), d)) / (1 - expl(-beta)));
}

/* d times the integral of t^(d-1) w over [0, 1], which the sum is divided by; errata, section 3. */
static long double norm_of(const pm__judge_request *request)
{
    const long double d = request->dimensions;
    if (is(request, "cone")) {
        const long double k = (long double)value_of(request, "k");
        return k < 1 ? powl(k, d) / (d + 1) : 1 - d / ((d + 1) * k);
    }
    if (is(request, "epanechnikov"))
        return d == 3 ? 0.4L : 0.5L;
    if (is(request, "biweight"))
        return d == 3 ? 8.0L / 35 : 1.0L / 3;
    return is(request, "gaussian") ? gauss_norm(request) : 1;
}

/* sum of w flux / (norm measure) over a set; the k-th photon `last` times, unless the set is cut. */
static pm_status kernel(const pm__judge_request *request, const pm__nears *set, size_t count, bool cut, long double r2,
                        long double last, pm__judged *judged)
{
    const long double divisor = norm_of(request) * measure(request, r2);
    if (!(divisor > 0))
        return PM_EDEGENERATE;
    for (size_t i = 0; i < count; i++) {
        long double magnitude;
        const long double share = !cut && i + 1 == count ? last : 1;
        const long double w = share * weigh(request, set->near[i].d2 / r2, &magnitude);
        for (int c = 0; c < 3; c++) {
            const long double flux = (long double)request->photons[set->near[i].index].power[c];
            judged->value[c] += w * flux / divisor;
            judged->magnitude[c] += share * magnitude * fabsl(flux) / divisor;
        }
    }
    return PM_OK;
}

static pm_status oracle(const pm__judge_request *request, const pm__nears *set, pm__judged *judged)
{
    const bool fewer = request->oracle_k && request->oracle_k < set->count;
    const size_t count = fewer ? request->oracle_k : set->count;
    const long double r2 = fewer ? set->near[count - 1].d2 : set->r2;
    return kernel(request, set, count, set->cut && !fewer, r2, last_of(request), judged);
}

/* ---- Differential checking --------------------------------------------------------------------- */

typedef struct stage {
    size_t photons;
    long double value[3], magnitude[3], bright, whole; /* sums over the bands, of values and magnitudes */
} stage;

static stage stage_of(const pm__judge_request *request, const pm__nears *set, size_t n)
{
    const bool whole = set->cut && n == set->count;
    stage s = {.photons = n};
    const long double area = measure(request, whole ? set->r2 : set->near[n - 1].d2);
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) {
            const long double flux = (long double)request->photons[set->near[i].index].power[c];
            const long double share = i + 1 == n && !whole ? last_of(request) : 1;
            s.value[c] += share * flux;
            s.magnitude[c] += share * fabsl(flux);
        }
    for (int c = 0; c < 3; c++) {
        s.value[c] /= area;
        s.magnitude[c] /= area;
        s.bright += s.value[c];
        s.whole += s.magnitude[c];
    }
    return s;
}

/* Is E 0 but for rounding, so that it has no sign to take a logarithm of? Exactly 0 is clear. */
static bool is_nearly_zero(const stage *s, long double blur)
{
    return s->bright != 0 && fabsl(s->bright) <= blur * s->whole;
}

/* Does ln E differ from some earlier one by more than z standard deviations? */
static bool is_significant(const pm__judge_request *request, const stage *s, size_t now, long double blur, bool *clear)
{
    bool significant = false, doubt = false;
    for (size_t j = 0; j < now; j++) {
        const long double n = (long double)s[j].photons, m = (long double)s[now].photons;
        const long double variance = value_of(request, "noise") == 1.0 ? 0.59L / (n * sqrtl(n)) : 1 / n - 1 / m;
        const long double change = fabsl(logl(s[now].bright / s[j].bright));
        const long double bound = (long double)value_of(request, "z") * sqrtl(variance);
        significant |= change > bound;
        doubt |= is_nearly_zero(&s[j], blur) || is_nearly_zero(&s[now], blur);
        doubt |= fabsl(change - bound) <= blur * (1 + bound);
    }
    *clear &= !doubt;
    return significant;
}

/* Stages until the trend shows ([C02] 2.3.2, 5.5.3; errata, section 6). stages: room for all. */
static size_t walk(const pm__judge_request *request, const pm__nears *set, stage *stages, bool *clear)
{
    const bool monotone = value_of(request, "rule") == 0.0;
    const size_t start = (size_t)value_of(request, "start"), trend = (size_t)value_of(request, "trend");
    const long double blur = request->rounds ? 1e-5L : 1e-12L;
    size_t n = start < set->count ? start : set->count, now = 0, up = 0, down = 0;
    while (n < set->count && !(set->near[n - 1].d2 > 0))
        n++;
    stages[0] = stage_of(request, set, n);
    while (n < set->count) {
        const size_t grown = (size_t)ceill((long double)n * powl(2, 0.25L));
        n = monotone ? n + 1 : grown < set->count ? grown : set->count;
        stages[++now] = stage_of(request, set, n);
        const long double change = stages[now].bright - stages[now - 1].bright;
        up = change > 0 ? up + 1 : 0;
        down = change < 0 ? down + 1 : 0;
        *clear &= !(fabsl(change) <= blur * (stages[now].whole + stages[now - 1].whole) && stages[now].whole > 0);
        if ((up >= trend || down >= trend) && (monotone || is_significant(request, stages, now, blur, clear)))
            break;
    }
    return now;
}

static pm_status differential(const pm__judge_request *request, const pm__nears *set, pm__judged *judged)
{
    if (!(set->r2 > 0))
        return PM_EDEGENERATE;
    stage *const stages = calloc(set->count + 1, sizeof *stages);
    if (!stages)
        return PM_ENOMEM;
    const size_t last = walk(request, set, stages, &judged->clear);
    memcpy(judged->value, stages[last].value, sizeof judged->value);
    memcpy(judged->magnitude, stages[last].magnitude, sizeof judged->magnitude);
    free(stages);
    return PM_OK;
}

/* ---- Several maps: [C02] 5.6, errata 10, 11 ---------------------------------------------------- */

static pm_status combined_mean(const pm__judge_request *request, const pm__nears *sets, size_t maps, pm__judged *judged)
{
    for (size_t m = 0; m < maps; m++) {
        if (!sets[m].cut && !sets[m].count)
            continue;
        const pm_status status =
            kernel(request, &sets[m], sets[m].count, sets[m].cut, sets[m].r2, last_of(request), judged);
        if (status != PM_OK)
            return status;
    }
    return PM_OK;
}

static pm_status combined_pooled(const pm__judge_request *request, const pm__nears *sets, size_t maps,
                                 pm__judged *judged)
{
    long double area = 0, regions = 0, open = 0;
    for (size_t m = 0; m < maps; m++) {
        regions += sets[m].cut || sets[m].count ? 1 : 0;
        area += sets[m].cut || sets[m].count ? measure(request, sets[m].r2) : 0;
        open += sets[m].cut ? 0 : (long double)sets[m].count;
    }
    if (!(area > 0))
        return PM_EDEGENERATE;
    for (size_t m = 0; m < maps; m++)
        for (size_t i = 0; i < sets[m].count; i++)
            for (int c = 0; c < 3; c++) {
                const long double flux = (long double)request->photons[sets[m].near[i].index].power[c];
                const long double share = sets[m].cut ? 1 : (open - 1 + last_of(request)) / open;
                judged->value[c] += regions * share * flux / area;
                judged->magnitude[c] += regions * share * fabsl(flux) / area;
            }
    return PM_OK;
}

/* ---- Stored at photons: [C02] 5.4, errata 13 --------------------------------------------------- */

static pm_status at_photon(const pm__judge_request *request, const pm__nears *set, pm__judged *judged)
{
    const bool unbiased = value_of(request, "form") == 1.0;
    const long double area = measure(request, set->r2);
    if (!(area > 0))
        return PM_EDEGENERATE;
    for (size_t i = 0; i < set->count; i++) {
        if (unbiased && (i == 0 || (i + 1 == set->count && !set->cut)))
            continue; /* the photon itself (the first where several coincide), and the farthest */
        for (int c = 0; c < 3; c++) {
            const long double flux = (long double)request->photons[set->near[i].index].power[c];
            judged->value[c] += flux / area;
            judged->magnitude[c] += fabsl(flux) / area;
        }
    }
    return PM_OK;
}

/* The nearest of the photons that carry one: ceil(fraction N) of them, i N / that many for each i. SIZE_MAX: none. */
static size_t nearest_carrier(const pm__judge_request *request, pm__judged *judged)
{
    const size_t all = request->count, some = (size_t)ceil(value_of(request, "fraction") * (double)all);
    pm_photon *const carriers = calloc(some + 1, sizeof *carriers);
    pm__nears nears = {.near = calloc(some + 1, sizeof *nears.near)};
    size_t found = SIZE_MAX;
    if (!carriers || !nears.near)
        judged->status = PM_ENOMEM;
    if (carriers && nears.near) {
        for (size_t i = 0; i < some; i++)
            carriers[i] = request->photons[i * all / some];
        pm__judge_find(carriers, some, request->query, 1, 0, 1, &nears);
        found = nears.count ? nears.near[0].index * all / some : SIZE_MAX;
        judged->clear &= !request->rounds || nears.gap > 64 * float_ulp;
    }
    free(carriers);
    free(nears.near);
    return found;
}

/* ---- All --------------------------------------------------------------------------------------- */

static pm_status judge_sets(const pm__judge_request *request, const pm__nears *sets, size_t maps, pm__judged *judged)
{
    if (is(request, "combined"))
        return value_of(request, "rule") == 0.0 ? combined_mean(request, sets, maps, judged)
                                                : combined_pooled(request, sets, maps, judged);
    if (is(request, "differential"))
        return differential(request, sets, judged);
    if (is(request, "precomputed"))
        return at_photon(request, sets, judged);
    if (is(request, "oracle"))
        return oracle(request, sets, judged);
    return kernel(request, sets, sets->count, sets->cut, sets->r2, last_of(request), judged);
}

/* From neighbours to the answer. */
static void judge_found(const pm__judge_request *request, const pm__nears *sets, pm__judged *judged)
{
    long double sum = 0, regions = 0;
    for (size_t m = 0; m < judged->maps; m++) {
        judged->count += sets[m].count;
        judged->clear &= !request->rounds || sets[m].gap > 64 * float_ulp;
        regions += sets[m].cut || sets[m].count ? 1 : 0;
        sum += sets[m].cut || sets[m].count ? sets[m].r2 : 0;
    }
    judged->radius = regions > 0 ? sqrtl(sum / regions) : 0;
    if (!judged->count)
        return;
    if (is(request, "hull"))
        pm__judge_hull(request, sets, judged);
    else
        judged->status = judge_sets(request, sets, judged->maps, judged);
    if (judged->status != PM_OK)
        for (int c = 0; c < 3; c++)
            judged->value[c] = judged->magnitude[c] = 0;
}

static void judge_query(const pm__judge_request *request, pm__judged *judged)
{
    pm__nears sets[64];
    size_t room = 0;
    pm__near *const near = calloc(request->count + 1, sizeof *near);
    if (!near)
        judged->status = PM_ENOMEM;
    for (size_t m = 0; m < judged->maps && near; m++) {
        sets[m].near = near + room;
        pm__judge_find(request->photons, request->count, request->query,
                       pm__judge_share(request->query->k, judged->maps, m), m, judged->maps, &sets[m]);
        room += sets[m].count;
    }
    if (near)
        judge_found(request, sets, judged);
    free(near);
}

/* Photons that a lookup must ask of each map, by what each estimator is. */
static size_t least_k(const pm__judge_request *request)
{
    if (is(request, "hull") || is(request, "combined") || is(request, "precomputed"))
        return 3;
    return is(request, "epanechnikov") || is(request, "biweight") ? 2 : 1;
}

void pm__judge(const pm__judge_request *request, pm__judged *judged)
{
    *judged = (pm__judged){.status = PM_OK, .clear = true};
    judged->maps = is(request, "combined") ? (size_t)value_of(request, "maps") : 1;
    if (request->query->k && request->query->k / judged->maps < least_k(request)) {
        judged->status = PM_EINVAL;
        return;
    }
    if (!is(request, "precomputed")) {
        judge_query(request, judged);
        return;
    }
    const size_t carrier = nearest_carrier(request, judged);
    if (carrier == SIZE_MAX)
        return;
    pm_query query = *request->query;
    memcpy(query.position, request->photons[carrier].position, sizeof query.position);
    query.shape = PM_LOOKUP_SPHERE; /* no normal is known there */
    query.front_only = false;
    pm__judge_request at = *request;
    at.query = &query;
    judge_query(&at, judged);
}

/* ---- Bounds: stress.h -------------------------------------------------------------------------- */

static double weight_bound(const pm__judge_request *request)
{
    const bool rounds = request->rounds;
    if (is(request, "cone")) {
        const double slope = 5.0 / value_of(request, "k");
        return !rounds ? 5.0 : slope > 1.0 ? slope : 1.0;
    }
    if (is(request, "epanechnikov"))
        return rounds ? 10.0 : 3.0;
    if (is(request, "biweight"))
        return rounds ? 20.0 : 7.0;
    if (is(request, "gaussian"))
        return rounds ? 11.0 : 512.0;
    return 0.0;
}

double pm__judge_bound(const pm__judge_request *request, const pm__judged *judged)
{
    const double n = (double)judged->count, maps = (double)(judged->maps - 1);
    const bool hull = is(request, "hull");
    if (request->rounds)
        return hull ? 10.0 : weight_bound(request) + (request->dimensions == 3 ? 7.5 : 5.0) + 2.0;
    return (hull ? 5.0 * n : n) + weight_bound(request) + 8.0 * maps + 16.0;
}
