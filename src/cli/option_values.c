#include "option_values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

pm_status pm__parse_count(const char *text, size_t min, size_t max, size_t *value, pm_error *error)
{
    double number;
    if (pm__parse_double(text, &number) || number != floor(number) || number < (double)min || number > (double)max)
        return pm__fail(error, PM_EINVAL, "'%.60s' is not an integer from %zu to %zu", text, min, max);
    *value = (size_t)number;
    return PM_OK;
}

static bool holds_count(const pm__counts *list, size_t value)
{
    for (size_t i = 0; i < list->count; i++)
        if (list->items[i] == value)
            return true;
    return false;
}

/* A comma list, appended; what is there already is not repeated. */
pm_status pm__parse_counts(const char *text, size_t min, size_t max, pm__counts *list, pm_error *error)
{
    char piece[64];
    for (;; text++) {
        const size_t length = strcspn(text, ",");
        size_t value;
        (void)snprintf(piece, sizeof piece, "%.*s", (int)(length < 63 ? length : 63), text);
        const pm_status status = pm__parse_count(piece, min, max, &value, error);
        if (status)
            return status;
        if (!holds_count(list, value)) {
            size_t *const grown = realloc(list->items, (list->count + 1) * sizeof *grown);
            if (!grown)
                return pm__fail(error, PM_ENOMEM, "out of memory");
            list->items = grown;
            list->items[list->count++] = value;
        }
        text += length;
        if (!*text)
            return PM_OK;
    }
}

pm_status pm__parse_positive(const char *text, double *value, pm_error *error)
{
    double number;
    if (pm__parse_double(text, &number) || !(number > 0.0) || !(number <= 1e30))
        return pm__fail(error, PM_EINVAL, "'%.60s' is not a number above 0 (to 1e30)", text);
    *value = number;
    return PM_OK;
}

static bool same_spec(const pm__spec *a, const pm__spec *b)
{
    return a->entry == b->entry && memcmp(a->values, b->values, sizeof a->values) == 0;
}

pm_status pm__parse_specs(const pm__catalogue *catalogue, const char *text, pm__specs *list, pm_error *error)
{
    size_t kept = list->count;
    const pm_status status = pm__spec_parse_list(catalogue, text, &list->items, &list->count, error);
    for (size_t i = kept; i < list->count; i++) {
        size_t j = 0;
        while (j < kept && !same_spec(&list->items[j], &list->items[i]))
            j++;
        if (j == kept)
            list->items[kept++] = list->items[i];
    }
    list->count = kept;
    return status;
}

pm_status pm__default_specs(const pm__catalogue *catalogue, const char *text, pm__specs *list, pm_error *error)
{
    return list->count ? PM_OK : pm__parse_specs(catalogue, text, list, error);
}

pm_status pm__parse_path(const char *text, const char **path, pm_error *error)
{
    if (!*text)
        return pm__fail(error, PM_EINVAL, "an empty file name");
    *path = text;
    return PM_OK;
}

pm_status pm__parse_lookup(const char *text, pm__shape *shape, pm_error *error)
{
    const char *const colon = strchr(text, ':');
    const size_t length = colon ? (size_t)(colon - text) : strlen(text);
    double parameter = 0.0;
    if (strcmp(text, "sphere") == 0) {
        shape->shape = PM_LOOKUP_SPHERE;
    } else if (colon && length == 9 && strncmp(text, "ellipsoid", 9) == 0) {
        if (pm__parse_double(colon + 1, &parameter) || !(parameter >= 1.0 && parameter <= 1e9))
            return pm__fail(error, PM_EINVAL, "'%.60s': expected ellipsoid:S with S from 1 to 1e9", text);
        shape->shape = PM_LOOKUP_ELLIPSOID;
    } else if (colon && length == 4 && strncmp(text, "disc", 4) == 0) {
        if (pm__parse_positive(colon + 1, &parameter, NULL))
            return pm__fail(error, PM_EINVAL, "'%.60s': expected disc:H with a half height H above 0 (m)", text);
        shape->shape = PM_LOOKUP_DISC;
    } else {
        return pm__fail(error, PM_EINVAL, "'%.60s': expected sphere, ellipsoid:S or disc:H", text);
    }
    shape->parameter = parameter;
    return PM_OK;
}

void pm__lookup_format(const pm__shape *shape, char text[48])
{
    char number[32];
    pm__format_double(shape->parameter, number);
    (void)snprintf(text, 48, "%s%s",
                   shape->shape == PM_LOOKUP_SPHERE      ? "sphere"
                   : shape->shape == PM_LOOKUP_ELLIPSOID ? "ellipsoid:"
                                                         : "disc:",
                   shape->shape == PM_LOOKUP_SPHERE ? "" : number);
}
