#include "table.h"

#include "wrap.h"

#include <string.h>

enum { GROUP = 25, LONG_NUMBERS = 70, MIN_LABEL = 14, MAX_LABEL = 50 };

static const char *bold(const pm__table *table)
{
    return table->colourful ? "\033[1m" : "";
}

static const char *dim(const pm__table *table)
{
    return table->colourful ? "\033[2m" : "";
}

static const char *plain(const pm__table *table)
{
    return table->colourful ? "\033[0m" : "";
}

void pm__table_number(FILE *file, int width, double value, char sign)
{
    char text[64] = "-";
    const double size = fabs(value);
    if (isfinite(value)) {
        const int digits = size < 9.9995 ? 3 : size < 99.995 ? 2 : size < 999.95 ? 1 : 0;
        const bool rounds_to_0 = size < 0.0005;
        char *const digits_at = text + (sign && !rounds_to_0);
        text[0] = sign == '+' && value < 0.0 ? '-' : sign;
        (void)snprintf(digits_at, sizeof text - 1, size < 99999.5 ? "%.*f" : "%.*e", size < 99999.5 ? digits : 0, size);
    }
    (void)fprintf(file, "%*s", width, text);
}

void pm__table_interval(FILE *file, pm__interval interval, char sign)
{
    if (!isfinite(interval.low)) {
        (void)fprintf(file, "%17s", "-");
        return;
    }
    (void)fputs(" [", file);
    pm__table_number(file, 6, 100.0 * interval.low, sign);
    (void)fputs(", ", file);
    pm__table_number(file, 6, 100.0 * interval.high, sign);
    (void)fputc(']', file);
}

void pm__table_time(FILE *file, double ns)
{
    const double us = ns / 1000.0;
    if (!isfinite(ns))
        (void)fprintf(file, "%5s", "-");
    else
        (void)fprintf(file, "%5.*f", us < 9.995 ? 2 : us < 99.95 ? 1 : 0, us);
}

void pm__table_lookup(const pm__accuracy_row *row, char *text, size_t size)
{
    char radius[32];
    pm__format_double(row->radius, radius);
    if (row->knn)
        (void)snprintf(text, size, "k=%zu", row->k);
    else
        (void)snprintf(text, size, "R=%s", radius);
}

static bool same_lookup(const pm__accuracy_row *a, const pm__accuracy_row *b)
{
    return a->knn == b->knn && (a->knn ? a->k == b->k : a->radius == b->radius);
}

size_t pm__table_run(const pm__table *table, size_t first, bool same_region)
{
    const pm__accuracy_row *const a = &table->rows[first];
    size_t end = first + 1;
    for (; end < table->row_count; end++) {
        const pm__accuracy_row *const b = &table->rows[end];
        if (a->case_spec != b->case_spec || a->sampler_spec != b->sampler_spec || a->photons != b->photons ||
            (same_region && strcmp(a->region, b->region) != 0))
            break;
    }
    return end;
}

/* An interval that holds 0 leaves the sign open. */
static char bias_sign(const pm__accuracy_row *row)
{
    return row->rel_bias_ci95.low > 0.0 || row->rel_bias_ci95.high < 0.0 ? '+' : '~';
}

static void print_bias(const pm__table *table, const pm__accuracy_row *row, int width)
{
    const char sign = bias_sign(row);
    (void)fputs(sign == '~' ? dim(table) : "", table->file);
    pm__table_number(table->file, width, 100.0 * row->rel_bias, sign);
    (void)fputs(sign == '~' ? plain(table) : "", table->file);
}

static void print_run_header(const pm__table *table, const pm__accuracy_row *row)
{
    const pm__case *const subject = (const pm__case *)(const void *)row->case_spec->entry;
    char name[PM__MAX_SPEC], sampler[PM__MAX_SPEC], mean[32], text[2 * PM__MAX_SPEC + 200];
    pm__spec_format(row->case_spec, name, sizeof name);
    pm__spec_format_short(row->sampler_spec, sampler, sizeof sampler);
    (void)snprintf(mean, sizeof mean, "%.6g", row->truth_mean);
    (void)fprintf(table->file, "\n%s%s%s: ", bold(table), name, plain(table));
    (void)snprintf(text, sizeof text, "%zu photons, %s; %zu trials; mean truth %s %s; search %s", row->photons, sampler,
                   row->trials, mean, subject->dimensions == 3 ? "W/m3" : "W/m2", row->search ? row->search : "-");
    pm__wrap(table->file, text, (int)strlen(name) + 2, 4);
}

/* Reasons why rows have no numbers, each once. */
static void print_notes(const pm__table *table, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++) {
        const pm__accuracy_row *const row = &table->rows[i];
        bool said = strcmp(row->status, "ok") == 0;
        for (size_t j = first; j < i && !said; j++)
            said =
                table->rows[j].estimator_spec == row->estimator_spec && strcmp(table->rows[j].detail, row->detail) == 0;
        if (said)
            continue;
        char label[PM__MAX_SPEC], text[PM__MAX_SPEC + PM__DETAIL_SIZE + 40];
        pm__spec_format_short(row->estimator_spec, label, sizeof label);
        (void)snprintf(text, sizeof text, "%s: %s%s%s", label, row->status, *row->detail ? ": " : "", row->detail);
        (void)fputs("  ", table->file);
        pm__wrap(table->file, text, 2, 4);
    }
}

static int label_width(const pm__table *table)
{
    char label[PM__MAX_SPEC];
    int width = MIN_LABEL;
    for (size_t i = 0; i < table->config->estimator_count; i++) {
        pm__spec_format_short(&table->config->estimators[i], label, sizeof label);
        const int length = (int)strlen(label);
        if (length > width)
            width = length < MAX_LABEL ? length : MAX_LABEL;
    }
    return width;
}

/* A label that is too long has a line of its own. */
static void print_label(const pm__table *table, const pm__accuracy_row *row, int width)
{
    char label[PM__MAX_SPEC];
    pm__spec_format_short(row->estimator_spec, label, sizeof label);
    if ((int)strlen(label) > width)
        (void)fprintf(table->file, "%s\n%*s", label, width, "");
    else
        (void)fprintf(table->file, "%-*s", width, label);
}

/* The columns `from` to `to` of a block: different lookups, in the order of the first estimator's rows. */
typedef struct block {
    size_t first, end;
    size_t columns[64]; /* a row of each lookup */
    size_t column_count;
    int label;
} block;

static void find_columns(const pm__table *table, block *b)
{
    b->column_count = 0;
    for (size_t i = b->first; i < b->end && b->column_count < 64; i++) {
        size_t j = 0;
        while (j < b->column_count && !same_lookup(&table->rows[b->columns[j]], &table->rows[i]))
            j++;
        if (j == b->column_count)
            b->columns[b->column_count++] = i;
    }
}

static void print_group(const pm__table *table, const pm__accuracy_row *row)
{
    print_bias(table, row, 7);
    pm__table_number(table->file, 6, 100.0 * row->rel_noise, 0);
    pm__table_number(table->file, 6, 100.0 * row->rel_rmse, 0);
    (void)fputc(row->pareto ? '*' : ' ', table->file);
    pm__table_time(table->file, row->ns_per_query);
}

static void print_heading(const pm__table *table, const block *b, size_t from, size_t to)
{
    char name[48];
    (void)fprintf(table->file, "%-*s", b->label, "");
    for (size_t c = from; c < to; c++) {
        pm__table_lookup(&table->rows[b->columns[c]], name, sizeof name);
        (void)fprintf(table->file, "   %s%*s%s", bold(table), c + 1 < to ? -(GROUP - 3) : 0, name, plain(table));
    }
    (void)fprintf(table->file, "\n%-*s", b->label, "");
    for (size_t c = from; c < to; c++)
        (void)fputs("   bias noise  rmse    us", table->file);
    (void)fputc('\n', table->file);
}

static void print_packed_lines(const pm__table *table, const block *b, size_t from, size_t to)
{
    for (size_t i = b->first; i < b->end; i++) {
        if (i > b->first && table->rows[i].estimator_spec == table->rows[i - 1].estimator_spec)
            continue;
        print_label(table, &table->rows[i], b->label);
        for (size_t c = from; c < to; c++) {
            size_t j = i;
            while (j < b->end && !(table->rows[j].estimator_spec == table->rows[i].estimator_spec &&
                                   same_lookup(&table->rows[j], &table->rows[b->columns[c]])))
                j++;
            if (j < b->end)
                print_group(table, &table->rows[j]);
            else
                (void)fprintf(table->file, "%*s", GROUP, "");
        }
        (void)fputc('\n', table->file);
    }
}

static void print_packed(const pm__table *table, size_t first, size_t end)
{
    block b = {.first = first, .end = end, .label = label_width(table)};
    find_columns(table, &b);
    /* Long labels get lines of their own; the others share the lookups evenly: 4 where 3 fit make 2 and 2. */
    if (b.label > PM__SCREEN_WIDTH - 3 * GROUP && b.column_count > 2)
        b.label = PM__SCREEN_WIDTH - 3 * GROUP;
    const size_t room = (size_t)((PM__SCREEN_WIDTH - b.label) / GROUP), lines = (b.column_count + room - 1) / room;
    const size_t fit = (b.column_count + lines - 1) / lines;
    for (size_t from = 0; from < b.column_count; from += fit) {
        const size_t to = from + fit < b.column_count ? from + fit : b.column_count;
        print_heading(table, &b, from, to);
        print_packed_lines(table, &b, from, to);
    }
}

static void print_long_line(const pm__table *table, const pm__accuracy_row *row, int label)
{
    char lookup[48];
    pm__table_lookup(row, lookup, sizeof lookup);
    print_label(table, row, label);
    (void)fprintf(table->file, " %7s", lookup);
    print_bias(table, row, 7);
    pm__table_interval(table->file, row->rel_bias_ci95, '+');
    pm__table_number(table->file, 10, 100.0 * row->predicted_rel_bias, '+');
    pm__table_number(table->file, 6, 100.0 * row->rel_noise, 0);
    pm__table_number(table->file, 10, 100.0 * row->predicted_rel_noise, 0);
    pm__table_number(table->file, 6, 100.0 * row->rel_rmse, 0);
    (void)fputc(row->pareto ? '*' : ' ', table->file);
    pm__table_time(table->file, row->ns_per_query);
    (void)fputc('\n', table->file);
}

static void print_long(const pm__table *table, size_t first, size_t end)
{
    int label = label_width(table);
    if (label > PM__SCREEN_WIDTH - LONG_NUMBERS)
        label = PM__SCREEN_WIDTH - LONG_NUMBERS;
    (void)fprintf(table->file, "%*s%s   bias    95 %% interval predicted noise predicted  rmse    us%s\n", label + 8,
                  "", bold(table), plain(table));
    for (size_t i = first; i < end; i++)
        print_long_line(table, &table->rows[i], label);
}

static void print_legend(const pm__table *table)
{
    (void)fputc('\n', table->file);
    pm__wrap(table->file,
             "bias, noise, rmse: in % of the mean truth of region all, over trials and probes. ~ in place of the "
             "sign: the 95 % interval of the bias (over trials) holds 0. us: microseconds to search and estimate one "
             "query, on one thread. *: no other row of the same case, region and sampler is better in both rmse and "
             "cost (photons, map and queries). -: does not exist.",
             0, 0);
}

void pm__table_print(const pm__table *table)
{
    const bool long_form = table->row_count <= PM__LONG_FORM_ROWS;
    for (size_t i = 0; i < table->row_count;) {
        const size_t run_end = pm__table_run(table, i, false);
        print_run_header(table, &table->rows[i]);
        while (i < run_end) {
            const size_t end = pm__table_run(table, i, true);
            (void)fprintf(table->file, "  region %s%s%s, %zu probes\n", bold(table), table->rows[i].region,
                          plain(table), table->rows[i].probes);
            if (long_form)
                print_long(table, i, end);
            else
                print_packed(table, i, end);
            print_notes(table, i, end);
            i = end;
        }
    }
    if (table->row_count)
        print_legend(table);
}
