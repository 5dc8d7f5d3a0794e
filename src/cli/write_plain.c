/* CSV (RFC 4180, but lines end in a plain newline) and Markdown. */
#include "results.h"

#include <math.h>
#include <string.h>

static bool is_interval(const char *field)
{
    const size_t length = strlen(field);
    return length > 5 && strcmp(field + length - 5, "_ci95") == 0;
}

static void put_text(FILE *file, const char *text)
{
    if (!text[strcspn(text, ",\"\r\n")]) {
        (void)fputs(text, file);
        return;
    }
    (void)fputc('"', file);
    for (; *text; text++) {
        if (*text == '"')
            (void)fputc('"', file);
        (void)fputc(*text, file);
    }
    (void)fputc('"', file);
}

static void put_number(FILE *file, double value)
{
    char text[32];
    if (!isfinite(value))
        return;
    pm__format_double(value, text);
    (void)fputs(text, file);
}

static void put_markdown_text(FILE *file, const char *text)
{
    for (; *text; text++) {
        if (*text == '|')
            (void)fputc('\\', file);
        (void)fputc(*text == '\n' ? ' ' : *text, file);
    }
}

static void put_cell(FILE *file, const pm__cell *cell, void (*put)(FILE *file, const char *text))
{
    if ((cell->type == PM__TEXT || cell->type == PM__TREE) && cell->text)
        put(file, cell->text);
    else if (cell->type == PM__FLAG)
        (void)fputs(cell->flag ? "true" : "false", file);
    else if (cell->type == PM__COUNT)
        (void)fprintf(file, "%zu", cell->count);
    else if (cell->type == PM__NUMBER || cell->type == PM__INTERVAL_OF)
        put_number(file, cell->number);
}

/* The cells of a row; intervals become two columns. */
static void put_row(FILE *file, const pm__results *results, size_t index, const char *separator,
                    void (*put)(FILE *file, const char *text))
{
    pm__cell cells[PM__MAX_FIELDS] = {{PM__ABSENT, NULL, false, 0, 0.0, 0.0, NULL}};
    results->row(results->context, index, cells);
    for (size_t i = 0; i < results->plain_count; i++) {
        (void)fputs(i ? separator : "", file);
        put_cell(file, &cells[i], put);
        if (is_interval(results->fields[i])) {
            (void)fputs(separator, file);
            if (cells[i].type == PM__INTERVAL_OF)
                put_number(file, cells[i].high);
        }
    }
    for (size_t i = 0; i < results->field_count; i++)
        json_decref(cells[i].tree);
}

static size_t put_names(FILE *file, const pm__results *results, const char *separator)
{
    size_t columns = 0;
    for (size_t i = 0; i < results->plain_count; i++) {
        const char *const name = results->fields[i];
        (void)fputs(i ? separator : "", file);
        if (is_interval(name))
            (void)fprintf(file, "%s_low%s%s_high", name, separator, name);
        else
            (void)fputs(name, file);
        columns += is_interval(name) ? 2 : 1;
    }
    return columns;
}

void pm__write_csv(FILE *file, const pm__results *results)
{
    (void)put_names(file, results, ",");
    (void)fputc('\n', file);
    for (size_t i = 0; i < results->row_count; i++) {
        put_row(file, results, i, ",", put_text);
        (void)fputc('\n', file);
    }
}

void pm__write_markdown(FILE *file, const pm__results *results)
{
    (void)fputs("| ", file);
    const size_t columns = put_names(file, results, " | ");
    (void)fputs(" |\n|", file);
    for (size_t i = 0; i < columns; i++)
        (void)fputs("---|", file);
    (void)fputc('\n', file);
    for (size_t i = 0; i < results->row_count; i++) {
        (void)fputs("| ", file);
        put_row(file, results, i, " | ", put_markdown_text);
        (void)fputs(" |\n", file);
    }
}
