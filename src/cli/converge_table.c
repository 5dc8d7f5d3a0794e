/* What `converge` shows on the screen, 100 columns. */
#include "converge_task.h"
#include "progress.h"
#include "table.h"
#include "wrap.h"

#include <math.h>
#include <string.h>

enum { LONGEST_HEADING = 3 * PM__MAX_SPEC + 200 };

/* The sign of what an interval does not tell from 0. */
static char sign_of(pm__interval interval)
{
    return interval.low > 0.0 || interval.high < 0.0 ? '+' : '~';
}

static void print_heading(FILE *file, const pm__converge_item *item, bool colourful)
{
    const pm__converge_series *const series = &item->series;
    char scene[PM__MAX_SPEC], method[PM__MAX_SPEC], estimator[PM__MAX_SPEC], alpha[32], text[LONGEST_HEADING];
    size_t used = 0;
    pm__spec_format(item->scene, scene, sizeof scene);
    pm__spec_format_short(item->method, method, sizeof method);
    used += (size_t)snprintf(text, sizeof text, "%s", method);
    if (item->estimator) {
        pm__spec_format_short(item->estimator, estimator, sizeof estimator);
        used += (size_t)snprintf(text + used, sizeof text - used, " by %s", estimator);
    }
    if (isfinite(item->alpha)) {
        pm__format_double(item->alpha, alpha);
        used += (size_t)snprintf(text + used, sizeof text - used, ", alpha %s", alpha);
    }
    if (series->row_count && strcmp(series->truth, "exact") == 0)
        used += (size_t)snprintf(text + used, sizeof text - used, "; %zu of %zu points, exact truth", series->points,
                                 series->all_points);
    else if (series->row_count)
        used += (size_t)snprintf(text + used, sizeof text - used, "; %zu blocks of pixels, stored reference",
                                 series->points);
    if (series->row_count)
        (void)snprintf(text + used, sizeof text - used, ", mean %.6g W/(m2 sr); paths %s; %zu trials",
                       series->truth_mean, series->paths, series->trials);
    (void)fprintf(file, "%s%s%s: ", colourful ? "\033[1m" : "", scene, colourful ? "\033[0m" : "");
    pm__wrap(file, text, (int)strlen(scene) + 2, 4);
}

static void print_photons(FILE *file, uint64_t photons)
{
    if (!photons) /* the method emits none */
        (void)fprintf(file, " %9s", "-");
    else if (photons < 1000000000)
        (void)fprintf(file, " %9llu", (unsigned long long)photons);
    else
        (void)fprintf(file, " %9.3e", (double)photons);
}

static void print_row(FILE *file, const pm__converge_row *row)
{
    (void)fprintf(file, "%7lu", (unsigned long)row->pass);
    print_photons(file, row->photons);
    pm__table_number(file, 8, row->seconds, 0);
    pm__table_number(file, 8, 100.0 * row->rel_bias, sign_of(row->rel_bias_ci95));
    pm__table_interval(file, row->rel_bias_ci95, '+');
    pm__table_number(file, 10, 100.0 * row->predicted_rel_bias, '+');
    pm__table_number(file, 6, 100.0 * row->rel_noise, 0);
    pm__table_number(file, 10, 100.0 * row->predicted_rel_noise, 0);
    pm__table_number(file, 7, 100.0 * row->rel_rmse, 0);
    pm__table_interval(file, row->rel_rmse_ci95, 0);
    (void)fputc('\n', file);
}

static void print_slope(FILE *file, double slope)
{
    if (isfinite(slope))
        (void)fprintf(file, " %+10.3f", slope);
    else
        (void)fprintf(file, " %10s", "-");
}

static void print_fit(FILE *file, const pm__converge_fit *fit)
{
    (void)fprintf(file, "  %-8s", pm__converge_quantity_names[fit->quantity]);
    if (!fit->fits) {
        char text[PM__CONVERGE_DETAIL + 16];
        (void)snprintf(text, sizeof text, "no fit%s%s", *fit->detail ? ": " : "", fit->detail);
        (void)fputs("   ", file);
        pm__wrap(file, text, 13, 13);
        return;
    }
    (void)fprintf(file, " %+9.3f", fit->slope);
    if (isfinite(fit->slope_ci95.low))
        (void)fprintf(file, " [%+.3f, %+.3f]", fit->slope_ci95.low, fit->slope_ci95.high);
    else
        (void)fprintf(file, " %16s", "-");
    print_slope(file, fit->predicted);
    print_slope(file, fit->asymptote);
    (void)fprintf(file, "   %lu to %lu\n", (unsigned long)fit->first_pass, (unsigned long)fit->last_pass);
    if (*fit->detail) {
        (void)fputs("             ", file);
        pm__wrap(file, fit->detail, 13, 13);
    }
}

static void print_fits(FILE *file, const pm__converge_item *item, bool colourful)
{
    (void)fprintf(file, "  %sslopes       fit    95 %% interval  predicted  asymptote   passes%s\n",
                  colourful ? "\033[1m" : "", colourful ? "\033[0m" : "");
    for (int q = 0; q < PM__QUANTITIES; q++)
        print_fit(file, &item->series.fits[q]);
}

/* What runs say of their own error, beside the error itself. */
static void print_estimates(FILE *file, const pm__converge_series *series, double wanted, bool colourful)
{
    (void)fprintf(file, "  %sthe error as runs estimate it themselves, without the truth%s\n"
                        "   pass  first run  mean of runs   rmse  right points\n",
                  colourful ? "\033[1m" : "", colourful ? "\033[0m" : "");
    for (size_t r = 0; r < series->row_count; r++) {
        const pm__converge_row *const row = &series->rows[r];
        (void)fprintf(file, "%7lu ", (unsigned long)row->pass);
        pm__table_number(file, 10, 100.0 * row->estimated_rel_rmse, 0);
        pm__table_number(file, 14, 100.0 * row->estimated_rel_rmse_mean, 0);
        pm__table_number(file, 7, 100.0 * row->rel_rmse, 0);
        pm__table_number(file, 14, 100.0 * row->estimate_right, 0);
        (void)fputc('\n', file);
    }
    (void)fprintf(file, "  %g %% %s\n", 100.0 * wanted,
                  series->reached ? "ended the first run" : "was not reached: passes, photons or time ended it");
}

static void print_triple(FILE *file, const double v[3])
{
    for (int b = 0; b < 3; b++)
        if (isfinite(v[b]))
            (void)fprintf(file, " %9.4g", v[b]);
        else
            (void)fprintf(file, " %9s", "-");
}

static void print_point(FILE *file, const pm__converge_series *series, size_t number)
{
    const size_t point = series->watched[number].point;
    (void)fprintf(file, "  at %zu,%zu\n", point % series->width, point / series->width);
    (void)fputs("   pass      radius     photons   radiance (R, G, B), first run     truth\n", file);
    for (size_t r = 0; r < series->row_count; r++) {
        const pm__converge_point *const p = &series->watched[r * series->watched_count + number];
        (void)fprintf(file, "%7lu ", (unsigned long)p->pass);
        if (p->radius > 0.0)
            (void)fprintf(file, " %11.4g", p->radius);
        else
            (void)fprintf(file, " %11s", "-");
        (void)fprintf(file, " %11.5g ", p->count);
        print_triple(file, p->radiance);
        (void)fputc(' ', file);
        print_triple(file, p->truth);
        (void)fputc('\n', file);
    }
}

static void print_item(FILE *file, const pm__converge_item *item, double wanted, bool colourful)
{
    const pm__converge_series *const series = &item->series;
    (void)fputc('\n', file);
    print_heading(file, item, colourful);
    if (strcmp(item->status, "ok") != 0) {
        const bool refused = !series->row_count && strcmp(item->status, "unsupported") == 0;
        (void)fprintf(file, "  %s", refused ? "unsupported: " : "");
        pm__wrap(file, item->detail, refused ? 15 : 2, 4);
    }
    if (!series->row_count)
        return;
    (void)fputs("   pass   photons seconds    bias    95 % interval predicted noise predicted   rmse    95 % interval",
                file);
    (void)fputc('\n', file);
    for (size_t r = 0; r < series->row_count; r++)
        print_row(file, &series->rows[r]);
    if (wanted > 0.0)
        print_estimates(file, series, wanted, colourful);
    print_fits(file, item, colourful);
    for (size_t i = 0; i < series->watched_count; i++)
        print_point(file, series, i);
}

static void print_legend(FILE *file, bool estimated)
{
    (void)fputc('\n', file);
    if (estimated)
        pm__wrap(file,
                 "First run, mean of runs: the relative rms error as these estimate it. Right points: those, in % over "
                 "points and runs, whose error lies within the bound that the run gives it with a confidence of 90 %.",
                 0, 0);
    pm__wrap(file,
             "bias, noise, rmse: in % of the mean truth, over trials and points. ~ in place of the sign: the 95 % "
             "interval of the bias (over trials) holds 0. photons, seconds: of one run. Slopes: of straight lines "
             "through the logarithms of variance, bias and rmse over that of the pass; predicted: the same line "
             "through the law's values; asymptote: what it tends to. -: does not exist.",
             0, 0);
}

void pm__converge_print(FILE *file, const pm__converge_task *task)
{
    const bool colourful = pm__colourful(file);
    bool any = false;
    for (size_t i = 0; i < task->count; i++) {
        const pm__converge_item *const item = &task->items[i];
        if (!item->status)
            continue;
        print_item(file, item, task->config.error, colourful);
        any |= item->series.row_count != 0;
    }
    if (any)
        print_legend(file, task->config.error > 0.0);
}
