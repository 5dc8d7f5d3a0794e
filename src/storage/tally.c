#include "tally.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

void pm__tally_free(pm__tally *tally)
{
    free(tally->square);
    free(tally->added);
    free(tally->mean);
    free(tally->sum);
    *tally = (pm__tally){0};
}

/* Means over values of products of each pair of groups; and their mean. */
static double multiply(const float *errors, size_t values, double pairs[PM__GROUP_PAIRS])
{
    double all = 0.0;
    size_t pair = 0;
    for (size_t g = 0; g < PM__GROUPS; g++)
        for (size_t h = 0; h < g; h++, pair++) {
            double sum = 0.0;
            for (size_t i = 0; i < values; i++)
                sum += (double)errors[g * values + i] * (double)errors[h * values + i];
            pairs[pair] = sum / (double)values;
            all += pairs[pair] / PM__GROUP_PAIRS;
        }
    return all;
}

pm_status pm__tally_create(size_t values, size_t room, double own_square, const float *base, pm__tally *tally)
{
    double pairs[PM__GROUP_PAIRS];
    *tally = (pm__tally){.values = values,
                         .room = room,
                         .own_square = own_square,
                         .base_square = multiply(base, values, pairs) - own_square,
                         .square = pm__alloc_zero(room, sizeof *tally->square),
                         .added = pm__alloc_zero(room, sizeof *tally->added),
                         .mean = pm__alloc_zero(room, sizeof *tally->mean),
                         .sum = pm__alloc_zero(PM__GROUPS * values, sizeof *tally->sum)};
    if (tally->square && tally->added && tally->mean && tally->sum)
        return PM_OK;
    pm__tally_free(tally);
    return PM_ENOMEM;
}

void pm__tally_add(pm__tally *tally, const float *errors)
{
    double pairs[PM__GROUP_PAIRS];
    tally->square[tally->trials] = multiply(errors, tally->values, pairs) - tally->own_square;
    tally->added[tally->trials] = tally->square[tally->trials] - tally->base_square;
    for (size_t p = 0; p < PM__GROUP_PAIRS; p++)
        tally->pairs[p] += pairs[p] - tally->own_square;
    tally->mean[tally->trials] = 0.0;
    for (size_t g = 0; g < PM__GROUPS; g++) {
        double sum = 0.0;
        for (size_t i = 0; i < tally->values; i++) {
            const float e = errors[g * tally->values + i];
            tally->sum[g * tally->values + i] += e;
            sum += (double)e;
        }
        tally->group_mean[g] += sum / (double)tally->values;
        tally->mean[tally->trials] += sum / (double)(tally->values * PM__GROUPS);
    }
    tally->trials++;
}

/* ---- Estimates --------------------------------------------------------------------------------- */

static double mean_of(const double *x, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += x[i];
    return sum / (double)count;
}

/* Half the 95 % interval of a mean: its jackknife is the textbook's. */
static double half_of_mean(const double *x, size_t count)
{
    const double mean = mean_of(x, count);
    double square = 0.0;
    for (size_t i = 0; i < count; i++)
        square += (x[i] - mean) * (x[i] - mean);
    const double n = (double)count;
    return count > 1 ? pm__student_quantile(0.975, n - 1.0) * sqrt(square / (n * (n - 1.0))) : (double)NAN;
}

double pm__jackknife_half(const double *without, size_t trials)
{
    const double n = (double)trials, mean = mean_of(without, trials);
    double square = 0.0;
    for (size_t t = 0; t < trials; t++)
        square += (without[t] - mean) * (without[t] - mean);
    return trials > 1 && isfinite(square) ? pm__student_quantile(0.975, n - 1.0) * sqrt((n - 1.0) / n * square)
                                          : (double)NAN;
}

/* What the square would be without each group in turn. */
static double half_over_groups(const pm__tally *tally)
{
    double without[PM__GROUPS];
    for (size_t left = 0; left < PM__GROUPS; left++) {
        size_t pair = 0;
        double sum = 0.0;
        for (size_t g = 0; g < PM__GROUPS; g++)
            for (size_t h = 0; h < g; h++, pair++)
                sum += g == left || h == left ? 0.0 : tally->pairs[pair];
        without[left] = sum / ((double)tally->trials * (PM__GROUP_PAIRS - PM__GROUPS + 1));
    }
    return pm__jackknife_half(without, PM__GROUPS);
}

static double root(double square)
{
    return sqrt(fmax(0.0, square));
}

static void fill_spread(const pm__tally *tally, double square, pm__view_error *error)
{
    double pairs[PM__GROUP_PAIRS];
    const double n = (double)tally->trials;
    const double all = multiply(tally->sum, tally->values, pairs) - n * n * tally->own_square;
    const double cross = (all - n * square) / (n * (n - 1.0));
    error->rms_bias = root(cross);
    error->noise = root(square - cross);
}

pm__view_error pm__tally_error(const pm__tally *tally)
{
    const pm__interval none = {(double)NAN, (double)NAN};
    pm__view_error error = {(double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, none, none, none};
    const size_t trials = tally->trials;
    if (!trials)
        return error;
    double groups[PM__GROUPS];
    for (size_t g = 0; g < PM__GROUPS; g++)
        groups[g] = tally->group_mean[g] / (double)trials;
    const double square = mean_of(tally->square, trials);
    error.bias = mean_of(tally->mean, trials);
    error.rmse = root(square);
    error.added = root(square - tally->base_square);
    if (trials < 2)
        return error;
    fill_spread(tally, square, &error);
    const double bias = hypot(half_of_mean(tally->mean, trials), half_of_mean(groups, PM__GROUPS));
    const double wide = hypot(half_of_mean(tally->square, trials), half_over_groups(tally));
    error.bias_ci95 = (pm__interval){error.bias - bias, error.bias + bias};
    const double added = square - tally->base_square, apart = half_of_mean(tally->added, trials);
    error.added_ci95 = (pm__interval){root(added - apart), root(added + apart)};
    error.rmse_ci95 = (pm__interval){root(square - wide), root(square + wide)};
    return error;
}
