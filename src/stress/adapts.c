/* A million updates of appm's radius, which grows and shrinks, against the same recursion in long double.
 *
 * In units of u = 2^-53, sums over i passes err by i each, and the squared radius is the cube root of sums of powers
 * over the Laplacian's square and the sum of weights: its own error is at most (1 + 2 + 1) i / 3, and the last digits
 * of what the passes add. What a pass adds to the powers goes as r^-2, to the Laplacian as r^-4, so that an error d of
 * r^2 comes back as (-1 + 4) d / 3 = d, of the mean over passes weighted with their numbers: errors that grow as A i
 * have a mean of 2/3 A i, so A = 2/3 A + 4/3, A = 4; with the subtraction of the Laplacian's own variance, at most a
 * quarter of its square, a third more. Twice that is the bound, and 32 for the constants. */
#include "test.h"

#include "../methods/progressive/list.h"

#include <stdio.h>
#include <string.h>

enum { UPDATES = 1000000, PATTERNS = 4, ALPHAS = 2, MOST = 24 };

static const double alphas[ALPHAS] = {0.5, 2.0 / 3.0};
static const char *const patterns[PATTERNS] = {"even light: grows", "a peak: shrinks", "a bowl: settles",
                                               "1e-12 m, 1e12 W: grows"};
static const long double pi = 3.14159265358979323846264338327950288L;

/* What a pass finds: where, over the squared radius of its lookup, and what powers. */
typedef struct finding {
    size_t count;
    float distance2[MOST], flux[MOST][3];
} finding;

static double first_radius(size_t pattern)
{
    return pattern == 3 ? 1e-12 : 0.1;
}

/* Even light: what curves one way and the other, (1 - s)(3 s - 1) over s = 0 and three times 2/3, adds up to nothing.
 * A peak: all near the middle. A bowl: even places, with the powers of an irradiance that rises as its square. */
static void find(size_t pattern, double radius2, finding *f)
{
    f->count = pattern == 0 || pattern == 3 ? 4 : MOST;
    for (size_t j = 0; j < f->count; j++) {
        const double even = ((double)j + 0.5) / MOST, middle = 0.01 * (double)j, balanced = j ? 2.0 / 3.0 : 0.0;
        const double s = f->count == 4 ? balanced : pattern == 1 ? middle : even;
        const double power = pattern == 2 ? radius2 * (1.0 + 500.0 * radius2 * s) : pattern == 3 ? 1e12 : 1.0;
        f->distance2[j] = (float)(s * radius2);
        for (int b = 0; b < 3; b++)
            f->flux[j][b] = (float)power;
    }
}

typedef struct exact {
    long double first2, r2, weight, laplacian, noise, power2;
} exact;

static long double best(const exact *e, long double i, long double lapl2)
{
    return cbrtl(32.0L / (3.0L * pi) * e->power2 / (e->weight * lapl2 * i));
}

/* The radius of pass i. */
static void choose(exact *e, long double alpha, long double i)
{
    const long double lapl = fabsl(e->laplacian) / e->weight, error = sqrtl(e->noise) / e->weight;
    const long double surely = lapl + 2.0L * error, scheduled = e->r2 * (i - 1.0L + alpha) / i;
    const long double chosen = lapl > 2.0L * error ? best(e, i, lapl * lapl - error * error)
                                                   : fmaxl(scheduled, best(e, i, surely * surely));
    const long double top = 4.0L * e->first2 * powl(i, 0.5L * (alpha - 1.0L));
    const long double bottom = e->first2 / 1024.0L * powl(i, 0.5L * alpha - 1.0L);
    e->r2 = fmaxl(fminl(chosen, top), bottom);
}

/* radius2: of the lookup as it was made, by which places are told. */
static void take_exactly(exact *e, const finding *f, double radius2, long double i, long double alpha)
{
    const long double r2 = 6.25L * powl(i, 2.0L / 15.0L) * e->r2;
    long double lapl = 0.0L, noise = 0.0L, square = 0.0L;
    for (size_t j = 0; j < f->count; j++) {
        const long double s = (long double)f->distance2[j] / (long double)radius2;
        const long double power = (long double)f->flux[j][0] + (long double)f->flux[j][1] + (long double)f->flux[j][2];
        const long double term = power * 48.0L / pi * (1.0L - s) * (3.0L * s - 1.0L) / (r2 * r2);
        lapl += term;
        noise += term * term;
        square += power * power;
    }
    e->weight += i;
    e->laplacian += i * lapl;
    e->noise += i * i * noise;
    e->power2 += i * square / (pi * r2);
    choose(e, alpha, i + 1.0L);
}

static void compare(const pm__run *run, const double *state, const exact *e, pm__worst *worst)
{
    char what[60];
    const double radius = pm__progressive_appm.view(run, 0, state).radius;
    (void)snprintf(what, sizeof what, "after %u updates: %.3g of the first radius", (unsigned)run->passes,
                   radius / sqrt((double)e->first2));
    pm__worst_take(worst, pm__ulps(radius, sqrtl(e->r2), sqrtl(e->r2), 53), 11.0 * run->passes + 32.0, "ulp", what);
}

static void update_all(pm__run *run, size_t pattern, double *state, pm__worst *worst)
{
    const long double first = (long double)(float)first_radius(pattern);
    exact e = {.first2 = first * first};
    e.r2 = e.first2;
    for (size_t next = 1; run->passes < UPDATES;) {
        size_t k;
        double radius;
        finding f;
        pm__progressive_appm.ask(run, 0, state, &k, &radius);
        find(pattern, radius * radius, &f);
        const pm__neighbors set = {.count = f.count, .cut = true, .distance2 = f.distance2,
                                   .flux = (const float(*)[3])f.flux, .radius2 = radius * radius};
        const pm__found found = {.area = 1.0, .count = f.count, .neighbors = &set, .unit = 1.0,
                                 .share = {1.0, 1.0, 1.0}};
        pm__progressive_appm.take(run, &found, state);
        take_exactly(&e, &f, radius * radius, (long double)run->passes + 1.0L,
                     (long double)run->of->config->alpha);
        if (++run->passes < next)
            continue;
        if (run->passes == UPDATES && !(worst->ratio > 1.0))
            *worst = (pm__worst){.lookups = 0};
        compare(run, state, &e, worst);
        next *= 10;
    }
}

static size_t subjects(bool full)
{
    (void)full;
    return PATTERNS * ALPHAS;
}

static pm_status measure(size_t subject, const pm__stress_config *config, pm__stress_row *row)
{
    enum { FIELDS = 64 };
    const size_t pattern = subject / ALPHAS;
    const float first = (float)first_radius(pattern);
    double state[FIELDS] = {0.0};
    pm__worst worst = {.lookups = 0};
    pm_estimator *kernel = NULL;
    const pm_status status = pm_estimator_create("disc", &kernel, NULL);
    if (status != PM_OK)
        return status;
    const pm__progressive_config progressive = {.alpha = alphas[subject % ALPHAS], .estimator = kernel};
    const pm__progression progression = {.config = &progressive, .radius = (float *)(uintptr_t)&first};
    pm__run run = {.of = &progression, .seed = config->seed};
    pm__progressive_appm.begin(&run, 0, state);
    update_all(&run, pattern, state, &worst);
    pm_estimator_destroy(kernel);
    (void)snprintf(row->subject, sizeof row->subject, "appm:alpha=%.3g %s", progressive.alpha, patterns[pattern]);
    row->measured = worst.measured;
    row->bound = worst.bound;
    row->unit = worst.unit;
    (void)snprintf(row->detail, sizeof row->detail, "%s", worst.detail);
    return PM_OK;
}

const pm__stress_test pm__stress_test_adapts = {
    .name = "adapts", .summary = "a million updates of a radius that adapts", .subjects = subjects, .measure = measure};
