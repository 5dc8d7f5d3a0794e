/* What a command printed with --json, field by field. */
#ifndef PM_TESTS_ROWS_H
#define PM_TESTS_ROWS_H

#include "test.h"

#include <jansson.h>
#include <stdbool.h>

static inline json_t *pm__rows_of(json_t *root)
{
    json_t *const rows = json_object_get(root, "rows");
    ck_assert(json_is_array(rows));
    return rows;
}

/* Of a list of objects, such as "rows". */
static inline json_t *pm__item(json_t *root, const char *list, size_t index)
{
    json_t *const found = json_array_get(json_object_get(root, list), index);
    ck_assert_msg(json_is_object(found), "no %s[%zu]", list, index);
    return found;
}

static inline size_t pm__items(json_t *root, const char *list)
{
    ck_assert(json_is_array(json_object_get(root, list)));
    return json_array_size(json_object_get(root, list));
}

/* "" where it is no text. */
static inline const char *pm__text_of(const json_t *row, const char *field)
{
    const char *const text = json_string_value(json_object_get(row, field));
    return text ? text : "";
}

static inline double pm__number_of(const json_t *row, const char *field)
{
    const json_t *const value = json_object_get(row, field);
    ck_assert_msg(json_is_number(value), "%s is no number", field);
    return json_number_value(value);
}

static inline bool pm__is_null(const json_t *row, const char *field)
{
    return json_is_null(json_object_get(row, field));
}

#endif
