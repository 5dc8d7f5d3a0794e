/* Long files of `stress` made short: thousands of rows that pass say one thing, and would be most of the page. */
#include "report.h"

#include <stdlib.h>
#include <string.h>

enum { LONG = 1 << 18 /* bytes */ };

static bool passes(const json_t *row)
{
    const char *const status = json_string_value(json_object_get(row, "status"));
    return status && strcmp(status, "pass") == 0;
}

/* How near to its bound a row came. */
static double share(const json_t *row)
{
    const double measured = json_number_value(json_object_get(row, "measured"));
    const double bound = json_number_value(json_object_get(row, "bound"));
    return bound > 0.0 ? measured / bound : measured;
}

/* The test and the subject's first word: the estimator, or the search where there is none. NULL: no such texts, or
 * *refused is set. */
static char *group_of(const json_t *row, bool *refused)
{
    const char *const test = json_string_value(json_object_get(row, "test"));
    const char *const subject = json_string_value(json_object_get(row, "subject"));
    char *group = NULL;
    if (!test || !subject)
        return NULL;
    if (asprintf(&group, "%s %.*s", test, (int)strcspn(subject, " "), subject) >= 0)
        return group;
    *refused = true;
    return NULL;
}

/* The row of each group that came nearest to its bound, by its place. */
static json_t *find_worst(const json_t *rows, bool *refused)
{
    json_t *const worst = json_object();
    const json_t *row;
    size_t i;
    json_array_foreach(rows, i, row) {
        char *const group = passes(row) ? group_of(row, refused) : NULL;
        const json_t *const before = group ? json_object_get(worst, group) : NULL;
        if (group && (!before || share(row) > share(json_array_get(rows, (size_t)json_integer_value(before)))))
            (void)json_object_set_new(worst, group, json_integer((json_int_t)i));
        free(group);
    }
    return worst;
}

static bool is_worst(const json_t *worst, const json_t *row, size_t index, bool *refused)
{
    char *const group = group_of(row, refused);
    const json_t *const kept = group ? json_object_get(worst, group) : NULL;
    free(group);
    return !kept || (size_t)json_integer_value(kept) == index;
}

static json_t *keep(json_t *rows, bool *refused)
{
    json_t *const worst = find_worst(rows, refused), *const kept = json_array(), *row;
    size_t i;
    json_array_foreach(rows, i, row)
        if (!passes(row) || is_worst(worst, row, i, refused))
            (void)json_array_append(kept, row);
    json_decref(worst);
    return kept;
}

pm_status pm__report_condense(pm__report_result *result, pm_error *error)
{
    if (strcmp(result->command, "stress") != 0 || result->size <= LONG)
        return PM_OK;
    const size_t count = json_array_size(result->rows);
    bool refused = false;
    if (json_object_set_new(result->root, "rows", keep(result->rows, &refused)) != 0 || refused)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    result->rows = json_object_get(result->root, "rows");
    result->left_out = count - json_array_size(result->rows);
    char *const text = json_dumps(result->root, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (!text)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    free(result->text);
    result->text = text;
    result->size = strlen(text);
    return PM_OK;
}
