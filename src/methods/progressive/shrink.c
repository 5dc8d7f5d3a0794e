#include "shrink.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

const pm__param pm__shrink_params[2] = {
    {"flux", PM__CHOICE, PM__CORRECTED, 0, 0, "", "corrected|printed",
     "printed: new photons count for the radius, not for the flux (erratum 27)"},
    {"start", PM__CHOICE, PM__FROM_ZERO, 0, 0, "", "zero|first",
     "zero: no photon counts before the first pass; first: those of the first pass all do, and it keeps its radius"}};

void pm__shrink_begin(const pm__run *run, size_t point, double *state)
{
    const double radius = (double)run->of->radius[point];
    state[PM__RADIUS2] = radius * radius;
}

void pm__shrink_ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius)
{
    (void)run;
    (void)point;
    *k = 0;
    *radius = sqrt(state[PM__RADIUS2]);
}

void pm__shrink_take(const pm__run *run, const pm__found *found, double *state)
{
    const double *const values = pm__progressive_values(run);
    const double n = state[PM__COUNT], m = (double)found->count;
    const bool first = run->passes == 0, keeps = first && values[1] == PM__FROM_FIRST;
    const double kept = keeps ? m : n + run->of->config->alpha * m;
    const double share = n + m > 0.0 ? kept / (n + m) : 1.0; /* erratum 29: without a photon there is nothing to do */
    const bool counts = first || values[0] == PM__CORRECTED;
    for (int b = 0; b < 3; b++) {
        const double flux = found->radiance[b] * pi * state[PM__RADIUS2];
        state[PM__FLUX + b] = (state[PM__FLUX + b] + (counts ? flux : 0.0)) * share;
        state[PM__EMITTED + b] += found->emitted[b];
    }
    state[PM__RADIUS2] *= share;
    state[PM__COUNT] = kept;
}

void pm__shrink_answer(const pm__run *run, const double *state, double radiance[3])
{
    const double passes = (double)run->passes, area = pi * state[PM__RADIUS2];
    for (int b = 0; b < 3; b++)
        radiance[b] = (area > 0.0 ? state[PM__FLUX + b] / (area * passes) : 0.0) + state[PM__EMITTED + b] / passes;
}

pm__point_view pm__shrink_view(const pm__run *run, size_t point, const double *state)
{
    (void)run;
    (void)point;
    return (pm__point_view){sqrt(state[PM__RADIUS2]), state[PM__COUNT]};
}

bool pm__shrink_averages(const double *values)
{
    return values[0] == PM__CORRECTED;
}

/* Even density: where N = i M before the lookup that finds M, the radius shrinks by (i + alpha) / (i + 1), and N is
 * i + 1 times what the next one finds. From zero i is the number of passes done; `first` keeps the radius once and has
 * i = 1 then. */
double pm__shrink_schedule(const double *values, double alpha, double pass)
{
    return pm__shrink_product(values[1] == PM__FROM_FIRST ? 1.0 : 0.0, pass, alpha);
}

/* lgamma writes to a global variable; all here is above 0. */
static double log_gamma(double x)
{
    int sign;
    return lgamma_r(x, &sign);
}

double pm__shrink_product(double first, double x, double alpha)
{
    if (!(x > first))
        return 1.0;
    return exp(log_gamma(x + alpha) - log_gamma(x + 1.0) + log_gamma(first + 1.0) - log_gamma(first + alpha));
}
