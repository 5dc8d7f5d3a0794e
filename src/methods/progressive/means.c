#include "means.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

void pm__mean_answer(const pm__run *run, const double *state, double radiance[3])
{
    for (int b = 0; b < 3; b++)
        radiance[b] = (state[PM__SUM + b] + state[PM__SEEN + b]) / (double)run->passes;
}

void pm__nearest_ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius)
{
    (void)point;
    (void)state;
    *k = run->of->config->k;
    *radius = INFINITY;
}

pm__point_view pm__nearest_view(const pm__run *run, size_t point, const double *state)
{
    (void)point;
    return (pm__point_view){run->passes ? sqrt(state[PM__NEAREST_AREA] / (pi * run->passes)) : 0.0,
                            state[PM__NEAREST_COUNT]};
}
