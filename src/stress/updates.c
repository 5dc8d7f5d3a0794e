/* A million progressive updates of a point: squared radius and answer against the same recursion in long double.
 *
 * Update i finds M photons beside N and keeps the share s = (N + a M) / (N + M) (shrink.h). In units of u = 2^-53, N
 * errs by 2 i after i updates. Since d ln s / d ln N = (1 - a) N M / ((N + a M) (N + M)), about (1 - a) / (a i) where
 * passes find alike, that adds 2 (1 - a) / a <= 2 an update to s, whose own five operations add 5, and its product with
 * R^2 one: R^2 errs by 8 i. The flux takes up terms with three roundings and the error of R^2, and is multiplied by s
 * too, so that it errs by 12 i; the answer divides it by R^2: 20 i. The schedule of pppm is the closed product, by
 * logarithms of gamma functions of 1e6, about 1.3e7 each, of which two differ by what counts: their last place is 16.6
 * million u, and four of them are within two of it each: 1.4e8. */
#include "test.h"

#include "../methods/progressive/shrink.h"

#include <stdio.h>
#include <string.h>

enum { UPDATES = 1000000, PATTERNS = 5, ALPHAS = 3 };

static const double alphas[ALPHAS] = {0.5, 2.0 / 3.0, 0.8};
static const char *const patterns[PATTERNS] = {"steady", "rare", "from 1e-15 m", "from 1e15 m, 1e9 photons",
                                               "a flood and then drops"};
static const long double pi = 3.14159265358979323846264338327950288L;

static size_t count_of(size_t pattern, size_t pass, pm__dice *dice)
{
    switch (pattern) {
    case 1:
        return pass % 97 ? 0 : 1;
    case 3:
        return 1000000000;
    case 4:
        return pass < 3 ? 100000000 : (size_t)pm__roll_between(dice, 0, 2);
    default:
        return (size_t)pm__roll_between(dice, 0, 60);
    }
}

static double first_radius(size_t pattern)
{
    return pattern == 2 ? 1e-15 : pattern == 3 ? 1e15 : 0.1;
}

typedef struct exact {
    long double r2, n, flux;
} exact;

static void take_exactly(exact *e, const pm__found *found, long double alpha, bool keeps)
{
    const long double m = (long double)found->count, kept = keeps ? m : e->n + alpha * m;
    const long double share = e->n + m > 0 ? kept / (e->n + m) : 1;
    e->flux = (e->flux + (long double)found->radiance[0] * pi * e->r2) * share;
    e->r2 *= share;
    e->n = kept;
}

/* The state and the answer after some of the updates. */
static void compare(const pm__run *run, const double *state, const exact *e, pm__worst *worst)
{
    double radiance[3];
    char what[60];
    pm__shrink_answer(run, state, radiance);
    const long double answer = e->flux / (pi * e->r2 * (long double)run->passes);
    (void)snprintf(what, sizeof what, "after %u updates, ", (unsigned)run->passes);
    const size_t end = strlen(what);
    (void)snprintf(what + end, sizeof what - end, "squared radius");
    pm__worst_take(worst, pm__ulps(state[PM__RADIUS2], e->r2, e->r2, 53), 8.0 * run->passes + 1.0, "ulp", what);
    (void)snprintf(what + end, sizeof what - end, "answer");
    pm__worst_take(worst, pm__ulps(radiance[0], answer, answer, 53), 20.0 * run->passes + 4.0, "ulp", what);
}

/* What is shown is what all updates come to, unless the bound was passed on the way. */
static void update_all(pm__run *run, size_t pattern, bool first, double *state, pm__worst *worst)
{
    const double alpha = run->of->config->alpha, radius = first_radius(pattern);
    pm__dice dice = {.seed = run->seed, .test = 1000 + (uint32_t)pattern};
    exact e = {.r2 = (long double)(radius * radius)};
    size_t next = 1;
    state[PM__RADIUS2] = radius * radius;
    while (run->passes < UPDATES) {
        const double light = 0.5 + pm__roll(&dice);
        const pm__found found = {.radiance = {light, 1.0, 0.0}, .count = count_of(pattern, run->passes, &dice)};
        pm__shrink_take(run, &found, state);
        take_exactly(&e, &found, (long double)alpha, first && run->passes == 0);
        if (++run->passes < next)
            continue;
        if (run->passes == UPDATES && !(worst->ratio > 1.0))
            *worst = (pm__worst){.lookups = 0};
        compare(run, state, &e, worst);
        next *= 10;
    }
}

/* The schedule at 10, 100, ..., 1e6. */
static void follow_schedule(double alpha, pm__worst *worst)
{
    static const double values[2] = {PM__CORRECTED, PM__FROM_ZERO};
    long double product = 1;
    for (size_t i = 0, next = 10; i < UPDATES;) {
        product *= ((long double)i + (long double)alpha) / ((long double)i + 1);
        if (++i < next)
            continue;
        char what[60];
        (void)snprintf(what, sizeof what, "at pass %zu", i);
        pm__worst_take(worst, pm__ulps(pm__shrink_schedule(values, alpha, (double)i), product, product, 53), 1.4e8,
                       "ulp", what);
        next *= 10;
    }
}

static size_t subjects(bool full)
{
    return ALPHAS * (1 + PATTERNS * (full ? 2 : 1));
}

static pm_status measure(size_t subject, const pm__stress_config *config, pm__stress_row *row)
{
    const double alpha = alphas[subject % ALPHAS];
    const size_t rest = subject / ALPHAS, pattern = (rest - 1) % PATTERNS;
    const bool first = rest > PATTERNS;
    pm__worst worst = {.lookups = 0};
    double state[PM__SHRINK_FIELDS] = {0.0};
    const pm__spec method = {.values = {PM__CORRECTED, first ? PM__FROM_FIRST : PM__FROM_ZERO}};
    const pm__progressive_config progressive = {.method = &method, .alpha = alpha};
    const pm__progression progression = {.config = &progressive};
    pm__run run = {.of = &progression, .seed = config->seed};
    if (rest)
        update_all(&run, pattern, first, state, &worst);
    else
        follow_schedule(alpha, &worst);
    (void)snprintf(row->subject, sizeof row->subject, "%s:alpha=%.3g%s%s%s", rest ? "shrink" : "schedule", alpha,
                   first ? ",start=first" : rest ? ",start=zero" : "", rest ? " " : "", rest ? patterns[pattern] : "");
    row->measured = worst.measured;
    row->bound = worst.bound;
    row->unit = worst.unit;
    (void)snprintf(row->detail, sizeof row->detail, "%s", worst.detail);
    return PM_OK;
}

const pm__stress_test pm__stress_test_updates = {
    .name = "updates", .summary = "a million progressive updates of a point", .subjects = subjects,
    .measure = measure};
