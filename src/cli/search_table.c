/* The screen form of `search`. It ends as hyperfine does: how many times faster the fastest is than each other. */
#include "search_rows.h"

#include "wrap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LABEL = 96, NAME_COLUMNS = 31 };

/* "wide", "wide x16 front ellipsoid:3" */
static void label(const pm__search_row *row, char text[LABEL])
{
    char lookup[48] = "", batch[24] = "";
    if (row->filter.shape != PM_LOOKUP_SPHERE)
        pm__lookup_format(&row->filter, lookup);
    if (row->batch > 1)
        (void)snprintf(batch, sizeof batch, " x%zu", row->batch);
    (void)snprintf(text, LABEL, "%.26s%s%s%s%.24s", pm__contender_name(&row->contender), batch,
                   row->filter.front_only ? " front" : "", *lookup ? " " : "", lookup);
}

static void time_text(double ns, char text[24])
{
    if (!isfinite(ns))
        (void)snprintf(text, 24, "-");
    else if (ns < 9999.5)
        (void)snprintf(text, 24, "%.*f ns", ns < 99.95 ? 1 : 0, ns);
    else if (ns < 9999500.0)
        (void)snprintf(text, 24, "%.*f us", ns < 99950.0 ? 2 : 1, ns / 1e3);
    else
        (void)snprintf(text, 24, "%.1f ms", ns / 1e6);
}

/* One round has no interval: both ends are then the value itself. */
static bool has_interval(size_t rounds)
{
    return rounds > 1;
}

static void ratio_text(double ratio, pm__interval ci95, size_t rounds, char text[48])
{
    if (!isfinite(ratio)) {
        (void)snprintf(text, 48, "-");
        return;
    }
    const double half = 0.5 * (ci95.high - ci95.low);
    const int digits = ratio < 9.995 ? 2 : 1;
    if (!has_interval(rounds))
        (void)snprintf(text, 48, "%.*f", digits, ratio);
    else if (half > 0.3 * ratio) /* so wide that the interval's two sides differ */
        (void)snprintf(text, 48, "%.*f (%.2g-%.2g)", digits, ratio, ci95.low, ci95.high);
    else
        (void)snprintf(text, 48, "%.*f ± %.*f", digits, ratio, digits, half);
}

static void print_head(FILE *file, const pm__search_row *row)
{
    char radius[32], kind[64];
    pm__format_double(row->radius, radius);
    if (row->k)
        (void)snprintf(kind, sizeof kind, "%zu nearest", row->k);
    else
        (void)snprintf(kind, sizeof kind, "within %.8s m (%.0f photons)", radius, row->count);
    (void)fprintf(file, "%.40s, %zu photons, %s, queries in %s order\n", row->case_name, row->photons, kind,
                  row->coherent ? "coherent" : "random");
    (void)fprintf(file, "  %-*s %10s  %-19s %16s %7s  %s\n", NAME_COLUMNS, "", "build", " a query", "times as fast",
                  "bytes", "");
}

/* ± is two bytes in one column. */
static void put_ratio(FILE *file, const char *text)
{
    (void)fprintf(file, "%*s", strstr(text, "±") ? 17 : 16, text);
}

static void print_row(FILE *file, const pm__search_row *row)
{
    char name[LABEL], ns[24], low[24] = "", ratio[48];
    label(row, name);
    time_text(row->ns, ns);
    if (isfinite(row->ns) && row->ns > 0.0 && has_interval(row->samples))
        (void)snprintf(low, sizeof low, "± %.1f %%", 50.0 * (row->ns_ci95.high - row->ns_ci95.low) / row->ns);
    ratio_text(row->ratio, row->ratio_ci95, row->samples, ratio);
    if (strlen(name) > NAME_COLUMNS) { /* whole, on a line of its own */
        (void)fprintf(file, "  %s\n", name);
        *name = '\0';
    }
    (void)fprintf(file, "  %-*s %7.*f ms  %9s %-*s ", NAME_COLUMNS, name, row->build_ms < 9.95 ? 2 : 0, row->build_ms,
                  ns, *low ? 10 : 9, low);
    put_ratio(file, ratio);
    (void)fprintf(file, " %7.1f  %s\n", row->bytes_per_photon, strcmp(row->status, "ok") == 0 ? "exact" : row->status);
    if (*row->detail)
        (void)fprintf(file, "      %.90s\n", row->detail);
}

/* Faster rows first. */
static int compare_times(const void *a, const void *b)
{
    const double x = (*(const pm__search_row *const *)a)->ns, y = (*(const pm__search_row *const *)b)->ns;
    if (isnan(x) || isnan(y))
        return isnan(x) - isnan(y);
    return (x > y) - (x < y);
}

/* Fewer rounds than this have no interval at the level: they tell nothing apart. */
static bool enough_rounds(size_t rounds, double level)
{
    double missed;
    return pm__sign_rank(rounds, level, &missed) > 0;
}

/* How much faster `best` is than `row`, of the same run: from their rounds in pairs. */
static bool compare_rows(const pm__search_row *best, const pm__search_row *row, double level, double *ratio,
                         pm__interval *ci95)
{
    const size_t count = best->samples < row->samples ? best->samples : row->samples;
    double *const pairs = count ? malloc(count * sizeof *pairs) : NULL;
    size_t used = 0;
    for (size_t i = 0; pairs && i < count; i++) {
        const double pair = best->ratio_samples[i] / row->ratio_samples[i];
        if (isfinite(pair))
            pairs[used++] = pair;
    }
    if (used)
        *ratio = pm__sign_interval(pairs, used, level, ci95);
    free(pairs);
    return used > 0;
}

/* Two long names take a second line. */
static void print_verdict(FILE *file, bool told_apart, const char *one, const char *other, const char *ratio)
{
    char text[3 * LABEL + 64];
    if (told_apart)
        (void)snprintf(text, sizeof text, "%s is %s times faster than %s", one, ratio, other);
    else
        (void)snprintf(text, sizeof text, "%s and %s are not distinguishable (%s)", one, other, ratio);
    (void)fputs("  ", file);
    pm__wrap(file, text, 2, 4);
}

static void print_comparison(FILE *file, const pm__search_row *best, const pm__search_row *row, double level)
{
    char best_name[LABEL], name[LABEL], text[48];
    double ratio;
    pm__interval ci95;
    label(best, best_name);
    label(row, name);
    if (!compare_rows(best, row, level, &ratio, &ci95))
        return;
    ratio_text(ratio, ci95, row->samples < best->samples ? row->samples : best->samples, text);
    print_verdict(file, ci95.low > 1.0 && enough_rounds(row->samples, level), best_name, name, text);
}

/* A row whose baseline is in another run's table. */
static void print_against_baseline(FILE *file, const pm__search_row *row)
{
    char name[LABEL], text[48];
    const bool faster = row->ratio >= 1.0;
    const double ratio = faster ? row->ratio : 1.0 / row->ratio;
    const pm__interval inverse = {1.0 / row->ratio_ci95.high, 1.0 / row->ratio_ci95.low};
    const pm__interval ci95 = faster ? row->ratio_ci95 : inverse;
    label(row, name);
    ratio_text(ratio, ci95, row->samples, text);
    if (!isfinite(ratio))
        return;
    const bool told_apart = ci95.low > 1.0 && enough_rounds(row->samples, 0.95);
    print_verdict(file, told_apart, told_apart && !faster ? row->baseline : name,
                  told_apart && !faster ? name : row->baseline, text);
}

static void print_summary(FILE *file, const pm__search_row **sorted, size_t count)
{
    if (count == 1 && sorted[0]->baseline &&
        strcmp(sorted[0]->baseline, pm__contender_name(&sorted[0]->contender)) != 0)
        print_against_baseline(file, sorted[0]);
    const double level = count > 1 ? 1.0 - 0.05 / (double)(count - 1) : 0.95;
    for (size_t i = 1; i < count; i++)
        if (sorted[0]->ratio_samples && sorted[i]->ratio_samples)
            print_comparison(file, sorted[0], sorted[i], level);
}

static void print_run(FILE *file, const pm__search_row *rows, size_t count)
{
    const pm__search_row **const sorted = malloc(count * sizeof *sorted);
    if (!sorted)
        return;
    for (size_t i = 0; i < count; i++)
        sorted[i] = &rows[i];
    qsort(sorted, count, sizeof *sorted, compare_times);
    print_head(file, rows);
    for (size_t i = 0; i < count; i++)
        print_row(file, sorted[i]);
    (void)fputc('\n', file);
    print_summary(file, sorted, count);
    if (isfinite(rows->aa_ratio)) {
        char text[48];
        ratio_text(rows->aa_ratio, rows->aa_ci95, rows->samples, text);
        (void)fprintf(file, "  control: %s against itself %s (false alarms: at most %.1f %%); %zu rounds\n",
                      rows->baseline, text, 100.0 * rows->aa_false_alarm_rate, rows->samples);
    }
    if (rows->warning) {
        (void)fputs("  warning: ", file);
        pm__wrap(file, rows->warning, 11, 11);
    }
    free(sorted);
}

void pm__search_print(FILE *file, const pm__search_row *rows, size_t count)
{
    for (size_t i = 0; i < count;) {
        size_t end = i + 1;
        while (end < count && rows[end].run == rows[i].run)
            end++;
        (void)fputs(i ? "\n" : "", file);
        print_run(file, &rows[i], end - i);
        i = end;
    }
}
