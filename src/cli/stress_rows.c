#include "stress_rows.h"

#include "../search/search.h"
#include "../search/wide.h"
#include "progress.h"
#include "wrap.h"

#include <math.h>
#include <string.h>

enum { FAILURES_SHOWN = 20, SUBJECT = 40 };

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define FIELDS(X)                                           \
    X(test, pm__text_cell(row->test))                       \
    X(subject, pm__text_cell(row->subject))                 \
    X(status, pm__text_cell(row->passed ? "pass" : "fail")) \
    X(measured, pm__number_cell(row->measured))             \
    X(bound, pm__number_cell(row->bound))                   \
    X(unit, pm__text_cell(row->unit))                       \
    X(detail, pm__text_cell(*row->detail ? row->detail : NULL))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    const pm__stress_results *const all = context;
    const pm__stress_row *const row = &all->rows[index];
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

/* ---- As data ----------------------------------------------------------------------------------- */

static json_t *test_names(const pm__stress_config *config)
{
    json_t *const list = json_array();
    for (size_t t = 0; t < pm__stress_test_count(); t++)
        if (!config->tests || config->tests[t])
            (void)json_array_append_new(list, json_string(pm__stress_test_name(t)));
    return list;
}

static json_t *search_names(const pm__stress_config *config)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < config->search_count; i++)
        (void)json_array_append_new(list, json_string(config->searches[i]->entry.name));
    return list;
}

static json_t *width_names(const pm_simd *widths, size_t count)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < count; i++)
        (void)json_array_append_new(list, json_string(pm__simd_name(widths[i])));
    return list;
}

static json_t *options_of(const pm__stress_results *r)
{
    json_t *const options = json_object();
    (void)json_object_set_new(options, "test", test_names(r->config));
    (void)json_object_set_new(options, "estimator",
                              pm__spec_names(r->config->estimators, r->config->estimator_count));
    (void)json_object_set_new(options, "search", search_names(r->config));
    (void)json_object_set_new(options, "profile", json_string(r->config->full ? "full" : "quick"));
    (void)json_object_set_new(options, "simd", width_names(r->widths->width, r->widths->count));
    (void)json_object_set_new(options, "simd_skipped", width_names(r->widths->missing, r->widths->missing_count));
    (void)json_object_set_new(options, "bound_factor", json_real(r->config->bound_factor));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)r->settings->threads));
    return options;
}

pm_status pm__stress_write(const pm__stress_results *r, pm__sinks *sinks, pm_error *error)
{
    pm__stress_results copy = *r;
    json_t *const options = options_of(r);
    const pm__results results = {.command = "stress",
                                 .options = options,
                                 .settings = r->settings,
                                 .seeded = true,
                                 .wall_s = r->wall_s,
                                 .interrupted = r->interrupted,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = FIELD_COUNT,
                                 .row_count = r->count,
                                 .row = fill_row,
                                 .context = &copy};
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    return status;
}

/* ---- On the screen ----------------------------------------------------------------------------- */

/* How near a row comes to its bound; a row without a number is beyond any. */
static double nearness(const pm__stress_row *row)
{
    if (!isfinite(row->measured) || !(row->measured > 0.0))
        return isfinite(row->measured) ? 0.0 : INFINITY;
    return row->bound > 0.0 ? row->measured / row->bound : INFINITY;
}

/* "measured of bound unit" */
static void print_number(const pm__stress_row *row, char *text, size_t size)
{
    if (isfinite(row->measured))
        (void)snprintf(text, size, "%.3g of %.3g %s", row->measured, row->bound, row->unit);
    else
        (void)snprintf(text, size, "not as due");
}

/* The name without its parameters where they would not fit. */
static void print_subject(FILE *file, const char *subject)
{
    const char *const colon = strchr(subject, ':'), *const blank = strchr(subject, ' ');
    const bool shorten = strlen(subject) > SUBJECT && colon && blank && colon < blank;
    if (shorten)
        (void)fprintf(file, "%.*s", (int)(colon - subject), subject);
    (void)fprintf(file, "%.*s\n", SUBJECT, shorten ? blank : subject);
}

static void print_summary(FILE *file, const pm__stress_row *rows, size_t count, size_t failed, bool colourful)
{
    const pm__stress_row *worst = rows;
    char number[48];
    for (size_t i = 1; i < count; i++)
        if (nearness(&rows[i]) > nearness(worst))
            worst = &rows[i];
    print_number(worst, number, sizeof number);
    (void)fprintf(file, "%-11s %4zu ", rows->test, count);
    (void)fprintf(file, "%s%4zu %s%s  ", colourful ? failed ? "\033[1;31m" : "\033[1;32m" : "",
                  failed ? failed : count, failed ? "FAIL" : "pass", colourful ? "\033[0m" : "");
    (void)fprintf(file, "%-30s ", number);
    print_subject(file, worst->subject);
}

static void print_failure(FILE *file, const pm__stress_row *row)
{
    char number[48], text[PM__STRESS_SUBJECT + PM__STRESS_DETAIL + 80];
    print_number(row, number, sizeof number);
    (void)snprintf(text, sizeof text, "%s: %s; %s", row->subject, number, row->detail);
    (void)fputs("    ", file);
    pm__wrap(file, text, 4, 8);
}

static void print_test(FILE *file, const pm__stress_row *rows, size_t count, bool colourful)
{
    size_t failed = 0;
    for (size_t i = 0; i < count; i++)
        failed += rows[i].passed ? 0 : 1;
    print_summary(file, rows, count, failed, colourful);
    size_t shown = 0;
    for (size_t i = 0; i < count && shown < FAILURES_SHOWN; i++)
        if (!rows[i].passed) {
            print_failure(file, &rows[i]);
            shown++;
        }
    if (shown < failed)
        (void)fprintf(file, "    and %zu more: --json, --csv and --markdown have them\n", failed - shown);
}

void pm__stress_print(FILE *file, const pm__stress_results *r)
{
    size_t failed = 0;
    const bool colourful = pm__colourful(file);
    (void)fprintf(file, "%-11s %4s %9s  %-30s %s\n", "test", "rows", "", "nearest to its bound", "of");
    for (size_t i = 0, next; i < r->count; i = next) {
        for (next = i; next < r->count && strcmp(r->rows[next].test, r->rows[i].test) == 0; next++)
            failed += r->rows[next].passed ? 0 : 1;
        print_test(file, &r->rows[i], next - i, colourful);
    }
    (void)fprintf(file, "%zu rows, %zu failed; SIMD", r->count, failed);
    for (size_t w = 0; w < r->widths->count; w++)
        (void)fprintf(file, "%s %s", w ? "," : "", pm__simd_name(r->widths->width[w]));
    (void)fputc('\n', file);
}
