/* Differential checking, [C02] 2.3.2 and 5.5.3: photons are added by distance until the estimate shows a trend.
 *
 * The estimate after n photons, E_n, is taken at stages n_0 < n_1 < ... < k; the first stage that shows the trend is
 * returned. Two rules (errata, section 6):
 *   monotone      every n from `start`; a trend is `trend` successive changes of E of one sign. The paper's; on
 *                 even light each step darkens with probability 1/e only, so runs come by chance and it stops
 *                 too often.
 *   significance  n_i = start, then 2^(1/4) times as many each; the last `trend` changes must be of one sign, and
 *                 ln E must differ from some earlier ln E_j by more than z standard deviations of that difference.
 * The stage that stops is itself returned. Stopping depends on ratios of distances alone, which are independent of
 * the distance where it stops; so with last=none even light has no bias (theorem T3), whereas an earlier stage would
 * have. The noise of E_i/E_j is counted by photons, as if they were of equal power. */
#include "kernel.h"

enum { RULE, Z, START, TREND, LAST, NOISE };
enum { MONOTONE, SIGNIFICANCE };
enum { POISSON, STRATIFIED };

static const pm__param params[] = {
    {"rule", PM__CHOICE, MONOTONE, 0, 0, "", "monotone|significance",
     "monotone: the paper's, stops on chance runs; significance: only on changes beyond noise"},
    {"z", PM__REAL, 2.5, 0, 100, "", NULL, "significance: standard deviations that a change must exceed"},
    {"start", PM__INTEGER, 20, 2, 1e9, "", NULL, "photons in the first estimate"},
    {"trend", PM__INTEGER, 0, 0, 1e9, "", NULL,
     "changes of one sign that make a trend; 0: 10 (monotone, by photons) or 3 (significance, by stages)"},
    PM__PARAM_LAST,
    {"noise", PM__CHOICE, POISSON, 0, 0, "", "poisson|stratified", "significance: how evenly the photons lie"}};

/* Stages grow by 2^(1/4) at least, so 2^31 photons take 4 * 31 of them. */
enum { MAX_STAGES = 128 };

typedef struct stage {
    double photons;
    double brightness; /* sum of bands, on which decisions are taken */
} stage;

typedef struct walk {
    const pm__lookup *lookup;
    const pm__neighbors *set;
    double last;
    size_t summed;  /* photons in `sum` */
    double sum[3];
    double flux[3]; /* E_n = flux / measure */
    double measure;
} walk;

/* Goes on to E_n; n never falls from call to call. The last stage of a cut set is the whole sphere. */
static stage estimate_first(walk *w, size_t n)
{
    const pm__neighbors *set = w->set;
    const bool whole = set->cut && n == set->count;
    const size_t inner = whole ? n : n - 1;
    for (; w->summed < inner; w->summed++)
        for (int c = 0; c < 3; c++)
            w->sum[c] += (double)set->flux[w->summed][c];
    for (int c = 0; c < 3; c++)
        w->flux[c] = whole ? w->sum[c] : w->sum[c] + w->last * (double)set->flux[n - 1][c];
    w->measure = pm__measure_of(w->lookup, whole ? set->radius2 : (double)set->distance2[n - 1]);
    return (stage){(double)n, (w->flux[0] + w->flux[1] + w->flux[2]) / w->measure};
}

/* The first stage: at least `start` photons, and a region that is more than a point. */
static size_t first_stage(const pm__neighbors *set, double start)
{
    size_t n = start < (double)set->count ? (size_t)start : set->count;
    while (n < set->count && !(set->distance2[n - 1] > 0.0f))
        n++;
    return n;
}

static size_t next_stage(const double *values, size_t n, size_t count)
{
    if (values[RULE] == MONOTONE)
        return n + 1;
    const double next = ceil((double)n * 1.189207115002721); /* 2^(1/4) */
    return next < (double)count ? (size_t)next : count;
}

/* Does the present stage differ from an earlier one by more than noise? */
static bool is_significant(const double *values, const stage *earlier, size_t count, stage now)
{
    for (size_t j = 0; j < count; j++) {
        const double n = earlier[j].photons;
        const double variance = values[NOISE] == STRATIFIED ? 0.59 / (n * sqrt(n)) : 1.0 / n - 1.0 / now.photons;
        if (fabs(log(now.brightness / earlier[j].brightness)) > values[Z] * sqrt(variance))
            return true;
    }
    return false;
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    const pm__neighbors *set = &lookup->sets[0];
    if (!(pm__measure_of(lookup, set->radius2) > 0.0))
        return PM_EDEGENERATE;
    walk w = {.lookup = lookup, .set = set, .last = pm__last_share(values[LAST])};
    stage history[MAX_STAGES];
    size_t stages = 0, n = first_stage(set, values[START]);
    stage now = estimate_first(&w, n);
    int direction = 0;
    double run = 0.0;
    while (n < set->count) {
        if (values[RULE] == SIGNIFICANCE && stages < MAX_STAGES)
            history[stages++] = now;
        const double before = now.brightness;
        n = next_stage(values, n, set->count);
        now = estimate_first(&w, n);
        const int change = (now.brightness > before) - (now.brightness < before);
        run = change == 0 ? 0.0 : change == direction ? run + 1.0 : 1.0;
        direction = change;
        if (run >= values[TREND] && (values[RULE] == MONOTONE || is_significant(values, history, stages, now)))
            break;
    }
    for (int c = 0; c < 3; c++)
        result[c] = w.flux[c] / w.measure;
    return PM_OK;
}

static pm_status resolve(double *values, pm_error *error)
{
    (void)error;
    if (values[TREND] == 0.0)
        values[TREND] = values[RULE] == MONOTONE ? 10.0 : 3.0;
    return PM_OK;
}

/* Theorem T3. Otherwise known only where there is but one stage. */
static double uniform_mean(const double *values, size_t k, int dimensions)
{
    (void)dimensions;
    const double last = pm__last_share(values[LAST]);
    if (k < 2)
        return NAN;
    if (last == 0.0)
        return 1.0;
    return (double)k <= values[START] ? 1.0 + last / ((double)k - 1.0) : NAN;
}

const pm__estimator pm__estimator_differential = {
    .entry = {.name = "differential",
              .summary = "photons added until the estimate shows a trend; rule=significance stops less by chance",
              .citation = "Jensen 1995; course 43, 2.3.2 and 5.5.3",
              .params = params,
              .param_count = 6,
              .resolve = resolve},
    .needs = PM__SORTED,
    .dimensions = 4 | 8,
    .min_k = 1,
    .estimate = estimate,
    .uniform_mean = uniform_mean,
};
