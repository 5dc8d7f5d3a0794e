/* JSON, one row a line: photonbench/1. */
#include "results.h"
#include "version.h"

#include <math.h>
#include <string.h>

enum { FLAGS = JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(17) };

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

static void write_row(FILE *file, const pm__results *results, size_t index)
{
    pm__cell cells[PM__MAX_FIELDS] = {{PM__ABSENT, NULL, false, 0, 0.0, 0.0, NULL}};
    results->row(results->context, index, cells);
    json_t *const row = json_object();
    for (size_t i = 0; i < results->field_count; i++)
        (void)json_object_set_new(row, results->fields[i], value_of(&cells[i]));
    (void)json_dumpf(row, file, FLAGS);
    json_decref(row);
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
        (void)json_dumpf(value, file, FLAGS);
        (void)fputs(",\n", file);
    }
    json_decref(head);
    (void)fputs("  \"rows\": [", file);
    for (size_t i = 0; i < results->row_count; i++) {
        (void)fputs(i ? ",\n    " : "\n    ", file);
        write_row(file, results, i);
    }
    (void)fputs(results->row_count ? "\n  ]\n}\n" : "]\n}\n", file);
}
