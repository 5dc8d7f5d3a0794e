/* JSON, one row a line: photonbench/1. */
#include "results.h"
#include "version.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FLAGS = JSON_ENCODE_ANY | JSON_COMPACT, FEWEST_DIGITS = 15, MOST_DIGITS = 17 };

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

/* The digits with which every number of a value reads back exactly: 0.04 needs no 0.040000000000000001. */
static size_t digits_of(json_t *value)
{
    size_t digits = FEWEST_DIGITS;
    const char *key;
    json_t *member;
    size_t i;
    if (json_is_real(value)) {
        char text[32];
        for (; digits < MOST_DIGITS; digits++) {
            (void)snprintf(text, sizeof text, "%.*g", (int)digits, json_real_value(value));
            if (strtod(text, NULL) == json_real_value(value))
                break;
        }
    }
    json_array_foreach(value, i, member)
        digits = larger(digits, digits_of(member));
    json_object_foreach(value, key, member)
        digits = larger(digits, digits_of(member));
    return digits;
}

/* Takes `value` over. */
static void write_member(FILE *file, const char *name, json_t *value)
{
    (void)fprintf(file, "\"%s\":", name);
    (void)json_dumpf(value, file, FLAGS | JSON_REAL_PRECISION(digits_of(value)));
    json_decref(value);
}

/* NaN and infinity have no form in JSON. */
static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *value_of(const pm__cell *cell)
{
    switch (cell->type) {
    case PM__TEXT:
        return json_string(cell->text);
    case PM__FLAG:
        return json_boolean(cell->flag);
    case PM__COUNT:
        return json_integer((json_int_t)cell->count);
    case PM__NUMBER:
        return number(cell->number);
    case PM__INTERVAL_OF:
        return isfinite(cell->number) && isfinite(cell->high)
                   ? json_pack("[f, f]", cell->number, cell->high)
                   : json_null();
    case PM__TREE:
        return cell->tree;
    case PM__ABSENT:
        break;
    }
    return json_null();
}

static void write_row(FILE *file, const pm__side_rows *rows, size_t index)
{
    pm__cell cells[PM__MAX_FIELDS] = {{PM__ABSENT, NULL, false, 0, 0.0, 0.0, NULL}};
    rows->row(rows->context, index, cells);
    for (size_t i = 0; i < rows->field_count; i++) {
        (void)fputc(i ? ',' : '{', file);
        write_member(file, rows->fields[i], value_of(&cells[i]));
    }
    (void)fputc('}', file);
}

static void write_rows(FILE *file, const pm__side_rows *rows)
{
    (void)fprintf(file, "  \"%s\": [", rows->name);
    for (size_t i = 0; i < rows->row_count; i++) {
        (void)fputs(i ? ",\n    " : "\n    ", file);
        write_row(file, rows, i);
    }
    (void)fputs(rows->row_count ? "\n  ]" : "]", file);
}

static json_t *head_of(const pm__results *results)
{
    json_t *const head = json_object();
    (void)json_object_set_new(head, "schema", json_string("photonbench/1"));
    (void)json_object_set_new(head, "command", json_string(results->command));
    (void)json_object_set_new(head, "version", json_string(PM_VERSION));
    (void)json_object_set(head, "options", results->options);
    (void)json_object_set_new(head, "seed",
                              results->seeded ? json_integer((json_int_t)results->settings->seed) : json_null());
    (void)json_object_set_new(head, "machine", pm__machine());
    (void)json_object_set_new(head, "wall_s", number(results->wall_s));
    if (results->interrupted)
        (void)json_object_set_new(head, "interrupted", json_true());
    return head;
}

void pm__write_json(FILE *file, const pm__results *results)
{
    json_t *const head = head_of(results);
    const char *key;
    json_t *value;
    (void)fputs("{\n", file);
    json_object_foreach(head, key, value) {
        (void)fprintf(file, "  \"%s\": ", key);
        (void)json_dumpf(value, file, FLAGS | JSON_REAL_PRECISION(digits_of(value)));
        (void)fputs(",\n", file);
    }
    json_decref(head);
    write_rows(file, &(pm__side_rows){"rows", results->fields, results->field_count, results->row_count, results->row,
                                      results->context});
    for (size_t i = 0; i < results->beside_count; i++) {
        (void)fputs(",\n", file);
        write_rows(file, &results->beside[i]);
    }
    (void)fputs("\n}\n", file);
}

json_t *pm__spec_names(const pm__spec *specs, size_t count)
{
    char name[PM__MAX_SPEC];
    json_t *const list = json_array();
    for (size_t i = 0; i < count; i++) {
        pm__spec_format(&specs[i], name, sizeof name);
        (void)json_array_append_new(list, json_string(name));
    }
    return list;
}

json_t *pm__number_list(const size_t *values, size_t count)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < count; i++)
        (void)json_array_append_new(list, json_integer((json_int_t)values[i]));
    return list;
}
