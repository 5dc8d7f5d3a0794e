/* Synthetic neighbourhoods for the estimators' tests: photons around a query point without a map or a search.
 *
 * Photons have density 1 a unit area (volume) and flux 1 unless a test says otherwise, so the truth is 1. */
#ifndef PM_TESTS_NEIGHBORHOOD_H
#define PM_TESTS_NEIGHBORHOOD_H

#include "../estimators/estimator.h"
#include "../src/base/random.h"
#include "test.h"

#include <string.h>

/* ---- Random numbers: the same in every run -------- */

typedef struct stream {
    uint32_t trial;
    uint64_t number;
    double spare;
} stream;

static inline double uniform(stream *s)
{
    double u[2];
    if (s->number++ & 1)
        return s->spare;
    pm__random_uniform(7, PM__FOR_TESTS, s->trial, s->number, u, 2);
    s->spare = u[1];
    return u[0];
}

static inline size_t below(stream *s, size_t n)
{
    return (size_t)(uniform(s) * (double)n);
}

/* ---- Neighbourhoods -------- */

enum { HOOD_MAX = 1200, HOOD_SCRATCH = 40 * HOOD_MAX };

/* The lookup points into the hood itself: do not copy. */
typedef struct hood {
    pm__neighbors set;
    pm__lookup lookup;
    float distance2[HOOD_MAX], flux[HOOD_MAX][3], offset[HOOD_MAX][3];
    size_t scratch[HOOD_SCRATCH / sizeof(size_t)];
} hood;

static inline void hood_init(hood *h, int dimensions)
{
    h->set = (pm__neighbors){
        .distance2 = h->distance2, .flux = (const float(*)[3])h->flux, .offset = (const float(*)[3])h->offset};
    h->lookup = (pm__lookup){.sets = &h->set,
                             .set_count = 1,
                             .dimensions = dimensions,
                             .normal = {0.0f, 0.0f, 1.0f},
                             .unit = 1.0,
                             .scratch = h->scratch,
                             .scratch_size = sizeof h->scratch};
}

/* The next photon out, in the plane: call with ascending distances. */
static inline void hood_add(hood *h, double x, double y)
{
    if (h->set.count == HOOD_MAX)
        ck_abort_msg("too many photons");
    const size_t i = h->set.count++;
    h->distance2[i] = (float)(x * x + y * y);
    h->offset[i][0] = (float)x;
    h->offset[i][1] = (float)y;
    h->offset[i][2] = 0.0f;
    for (int c = 0; c < 3; c++)
        h->flux[i][c] = 1.0f;
    h->set.radius2 = (double)h->distance2[i];
}

/* The n nearest of Poisson photons: their measures pi r^2 (4/3 pi r^3) are sums of exponentials. Distances only. */
static inline void hood_poisson(hood *h, stream *s, size_t n)
{
    const double pi = 3.14159265358979323846;
    double measure = 0.0;
    h->set.count = 0;
    while (h->set.count < n) {
        measure -= log(1.0 - uniform(s));
        const double r = h->lookup.dimensions == 3 ? cbrt(0.75 / pi * measure) : sqrt(measure / pi);
        hood_add(h, r, 0.0);
    }
}

/* The same in the plane with directions, in the domain x > -left, y > -below only. */
static inline void hood_poisson_in(hood *h, stream *s, size_t n, double left, double below_)
{
    const double pi = 3.14159265358979323846;
    double measure = 0.0;
    h->set.count = 0;
    while (h->set.count < n) {
        measure -= log(1.0 - uniform(s));
        const double r = sqrt(measure / pi), angle = 2.0 * pi * uniform(s);
        const double x = r * cos(angle), y = r * sin(angle);
        if (x > -left && y > -below_)
            hood_add(h, x, y);
    }
}

/* ---- Estimators -------- */

typedef struct subject {
    pm__spec spec;
    const pm__estimator *estimator;
} subject;

static inline subject subject_of(const char *text)
{
    subject s;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__estimators, text, &s.spec, &error), error);
    s.estimator = (const pm__estimator *)(const void *)s.spec.entry;
    return s;
}

static inline double estimate_of(const subject *s, const pm__lookup *lookup)
{
    double result[3] = {NAN, NAN, NAN};
    const pm_status status = s->estimator->estimate(s->spec.values, lookup, result);
    if (status != PM_OK) /* ck_assert costs more than an estimate */
        ck_abort_msg("%s: %s", s->spec.entry->name, pm_status_text(status));
    return result[0];
}

/* ---- Means over independent runs -------- */

/* Sums of powers of (value - 1). */
typedef struct moments {
    double n, sum[4];
} moments;

static inline void moments_add(moments *m, double value)
{
    double power = 1.0;
    m->n += 1.0;
    for (int i = 0; i < 4; i++)
        m->sum[i] += power *= value - 1.0;
}

static inline double moments_mean(const moments *m)
{
    return 1.0 + m->sum[0] / m->n;
}

static inline double moments_variance(const moments *m)
{
    const double mean = m->sum[0] / m->n;
    return (m->sum[1] / m->n - mean * mean) * m->n / (m->n - 1.0);
}

static inline double moments_error(const moments *m)
{
    return sqrt(moments_variance(m) / m->n);
}

/* Standard error of the variance, from the fourth central moment. */
static inline double moments_variance_error(const moments *m)
{
    const double a = m->sum[0] / m->n, b = m->sum[1] / m->n, c = m->sum[2] / m->n, d = m->sum[3] / m->n;
    const double fourth = d - 4.0 * a * c + 6.0 * a * a * b - 3.0 * a * a * a * a, variance = b - a * a;
    return sqrt((fourth - variance * variance) / m->n);
}

/* 5.5 standard errors: a false alarm in 4e-8 of comparisons, so one in 1e5 runs of a few hundred of them. */
#define SIGMAS 5.5

#define CHECK_MEAN(m, want) PM_CHECK_NEAR(moments_mean(&(m)), want, SIGMAS *moments_error(&(m)))
#define CHECK_VARIANCE(m, want) PM_CHECK_NEAR(moments_variance(&(m)), want, SIGMAS *moments_variance_error(&(m)))
/* For references that were simulated themselves: `slack` covers their own error. */
#define CHECK_MEAN_WITHIN(m, want, slack) \
    PM_CHECK_NEAR(moments_mean(&(m)), want, (slack) + SIGMAS * moments_error(&(m)))
/* The printed form is beyond chance away from the truth 1. */
#define CHECK_BIASED(m)                                                                                           \
    ck_assert_msg(fabs(moments_mean(&(m)) - 1.0) > SIGMAS * moments_error(&(m)), "%s: mean %g does not miss 1", #m, \
                  moments_mean(&(m)))

#endif
