/* Result files, which anyone may have written. Their text goes into the page as it is, so that numbers keep their
 * digits; it is parsed to be checked, and for the figures. */
#include "report.h"

#include "../base/memory.h"

#include <stdlib.h>
#include <string.h>

static const char *type_name(const json_t *value)
{
    static const char *const names[] = {"an object", "an array", "text",  "a number",
                                        "a number",  "true",     "false", "null"};
    return value ? names[json_typeof(value)] : "nothing";
}

static pm_status expected(const char *name, const char *place, const char *what, const json_t *found, pm_error *error)
{
    return pm__fail(error, PM_EFORMAT, "%s: %s: expected %s, not %s", name, place, what, type_name(found));
}

static pm_status check_schema(const char *name, const json_t *schema, pm_error *error)
{
    char found[PM__QUOTE_SIZE];
    if (!json_is_string(schema))
        return expected(name, "schema", "\"photonbench/1\"", schema, error);
    if (strcmp(json_string_value(schema), "photonbench/1") == 0)
        return PM_OK;
    pm__quote(json_string_value(schema), json_string_length(schema), found);
    return pm__fail(error, PM_EFORMAT, "%s: schema: expected \"photonbench/1\", not \"%s\"", name, found);
}

/* The page reads the lists of rows: each row is an object. */
static pm_status check_list(const char *name, const json_t *root, const char *list, bool required, pm_error *error)
{
    char place[PM__QUOTE_SIZE];
    const json_t *const rows = json_object_get(root, list), *row;
    size_t i;
    if (!rows && !required)
        return PM_OK;
    if (!json_is_array(rows))
        return expected(name, list, "an array", rows, error);
    json_array_foreach(rows, i, row) {
        (void)snprintf(place, sizeof place, "%s[%zu]", list, i);
        if (!json_is_object(row))
            return expected(name, place, "an object", row, error);
    }
    return PM_OK;
}

static pm_status check(const char *name, pm__report_result *result, pm_error *error)
{
    static const char *const beside[] = {"fits", "points", "fronts"};
    const json_t *const command = json_object_get(result->root, "command");
    pm_status status = check_schema(name, json_object_get(result->root, "schema"), error);
    if (status == PM_OK && !json_is_string(command))
        status = expected(name, "command", "text", command, error);
    if (status == PM_OK)
        status = check_list(name, result->root, "rows", true, error);
    for (size_t i = 0; status == PM_OK && i < sizeof beside / sizeof *beside; i++)
        status = check_list(name, result->root, beside[i], false, error);
    if (status == PM_OK) {
        result->command = json_string_value(command);
        result->rows = json_object_get(result->root, "rows");
    }
    return status;
}

static pm_status parse(const char *name, pm__report_result *result, pm_error *error)
{
    json_error_t reason;
    result->root = json_loadb(result->text, result->size, JSON_REJECT_DUPLICATES, &reason);
    if (result->root)
        return PM_OK;
    if (json_error_code(&reason) == json_error_out_of_memory)
        return pm__fail(error, PM_ENOMEM, "%s: no memory to read it", name);
    for (char *at = reason.text; *at; at++)
        if (*at < ' ' || *at > '~')
            *at = '?';
    return pm__fail(error, PM_EFORMAT, "%s: line %d, byte %d: expected JSON: %.120s", name, reason.line,
                    reason.position, reason.text);
}

pm_status pm__report_add_result(pm__report *report, const char *path, char *bytes, size_t size, pm_error *error)
{
    const char *const slash = strrchr(path, '/');
    pm__report_result result = {.text = bytes, .size = size};
    char name[PM__NAME_SIZE];
    pm__quote_path(path, name);
    pm__quote_path(slash ? slash + 1 : path, result.name);
    pm_status status = parse(name, &result, error);
    if (status == PM_OK)
        status = check(name, &result, error);
    if (status == PM_OK)
        status = pm__report_condense(&result, error);
    void *results = report->results;
    if (status == PM_OK && pm__grow(&results, &report->result_capacity, report->result_count + 1, sizeof result) != 0)
        status = pm__fail(error, PM_ENOMEM, "out of memory");
    report->results = results;
    if (status == PM_OK) {
        report->results[report->result_count++] = result;
        return PM_OK;
    }
    json_decref(result.root);
    free(result.text);
    return status;
}
