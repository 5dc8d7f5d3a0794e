/* Reading result files, which anyone may have written. */
#include "compare.h"
#include "refused.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_TEXT = 400 };

/* What tells the rows of a command apart, in the order that labels show. */
typedef struct key {
    const char *name;
    bool text, required;
} key;

static const key search_keys[] = {{"search", true, true},   {"case", true, true},    {"photons", false, true},
                                  {"kind", true, false},    {"k", false, false},     {"radius", false, false},
                                  {"batch", false, false},  {"order", true, false},  {"threads", false, false},
                                  {"baseline", true, false}, {"lookup", true, false}, {"front", true, false}};
static const key accuracy_keys[] = {{"case", true, true},     {"region", true, true},  {"estimator", true, true},
                                    {"kind", true, false},    {"k", false, false},     {"radius", false, false},
                                    {"lookup", true, false},  {"front", true, false},  {"photons", false, true},
                                    {"sampler", true, false}, {"probes", false, false}};

/* Photons sent, or stored (wanted): one of them is there. Images of more eye paths hold less of their noise. */
static const key storage_keys[] = {{"scene", true, true},    {"policy", true, false},  {"map", true, false},
                                   {"photons", false, false}, {"wanted", false, false}, {"spp", false, false}};

typedef struct subject {
    const char *command;
    const key *keys;
    size_t key_count;
} subject;

static const subject subjects[] = {
    {"search", search_keys, sizeof search_keys / sizeof *search_keys},
    {"accuracy", accuracy_keys, sizeof accuracy_keys / sizeof *accuracy_keys},
    {"storage", storage_keys, sizeof storage_keys / sizeof *storage_keys},
};

static void make_printable(char *text)
{
    for (; *text; text++)
        if (*text < ' ' || *text > '~')
            *text = '?';
}

static const char *type_name(const json_t *value)
{
    if (!value)
        return "nothing";
    static const char *const names[] = {"an object", "an array", "text",  "a number",
                                        "a number",  "true",     "false", "null"};
    return names[json_typeof(value)];
}

static pm_status wrong_field(const pm__result_file *file, size_t index, const char *field, const char *expected,
                             const json_t *value, pm_error *error)
{
    return pm__fail(error, PM_EFORMAT, "%s: rows[%zu].%s: expected %s, not %s", file->name, index, field, expected,
                    type_name(value));
}

static bool is_missing(const json_t *value)
{
    return !value || json_is_null(value);
}

pm_status pm__result_number(const pm__result_file *file, size_t index, const char *field, double *value, bool *there,
                            pm_error *error)
{
    const json_t *const found = json_object_get(json_array_get(file->rows, index), field);
    *there = !is_missing(found);
    if (*there && !json_is_number(found))
        return wrong_field(file, index, field, "a number or null", found, error);
    *value = *there ? json_number_value(found) : (double)NAN;
    return PM_OK;
}

pm_status pm__result_interval(const pm__result_file *file, size_t index, const char *field, pm__interval *value,
                              bool *there, pm_error *error)
{
    const json_t *const found = json_object_get(json_array_get(file->rows, index), field);
    const json_t *const low = json_array_get(found, 0), *const high = json_array_get(found, 1);
    *there = !is_missing(found);
    *value = (pm__interval){(double)NAN, (double)NAN};
    if (!*there)
        return PM_OK;
    if (json_array_size(found) != 2 || !json_is_number(low) || !json_is_number(high))
        return wrong_field(file, index, field, "[low, high] or null", found, error);
    *value = (pm__interval){json_number_value(low), json_number_value(high)};
    if (value->low > value->high)
        return pm__fail(error, PM_EFORMAT, "%s: rows[%zu].%s: expected [low, high], but low is above high", file->name,
                        index, field);
    return PM_OK;
}

pm_status pm__result_logs(const pm__result_file *file, size_t index, const char *field, double **values, size_t *count,
                          pm_error *error)
{
    const json_t *const found = json_object_get(json_array_get(file->rows, index), field);
    *values = NULL;
    *count = 0;
    if (is_missing(found))
        return PM_OK;
    if (!json_is_array(found))
        return wrong_field(file, index, field, "an array of numbers or null", found, error);
    const size_t n = json_array_size(found);
    double *const logs = n ? malloc(n * sizeof *logs) : NULL;
    if (n && !logs)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    for (size_t i = 0; i < n; i++) {
        const json_t *const item = json_array_get(found, i);
        if (!json_is_number(item) || !(json_number_value(item) > 0.0)) {
            free(logs);
            return pm__fail(error, PM_EFORMAT, "%s: rows[%zu].%s[%zu]: expected a number above 0, not %s", file->name,
                            index, field, i, json_is_number(item) ? "one that is not" : type_name(item));
        }
        logs[i] = log(json_number_value(item));
    }
    *values = logs;
    *count = n;
    return PM_OK;
}

/* Appends "wide" or "k=50" to the label. */
static pm_status add_key(const pm__result_file *file, size_t index, const key *k, FILE *label, pm_error *error)
{
    const json_t *const value = json_object_get(json_array_get(file->rows, index), k->name);
    if (is_missing(value) && !k->required)
        return PM_OK;
    if (k->text ? !json_is_string(value) : !json_is_number(value))
        return wrong_field(file, index, k->name, k->text ? "text" : "a number", value, error);
    if (k->text && json_string_length(value) > LONGEST_TEXT)
        return pm__fail(error, PM_EFORMAT, "%s: rows[%zu].%s: expected text of at most %d bytes, not %zu", file->name,
                        index, k->name, LONGEST_TEXT, json_string_length(value));
    const char *const gap = ftell(label) > 0 ? " " : "";
    if (!k->text)
        (void)fprintf(label, "%s%s=%.15g", gap, k->name, json_number_value(value));
    else if (strcmp(k->name, "baseline") == 0)
        (void)fprintf(label, "%sover %s", gap, json_string_value(value));
    else
        (void)fprintf(label, "%s%s%s", gap, strcmp(k->name, "front") == 0 ? "front=" : "", json_string_value(value));
    return PM_OK;
}

static pm_status add_label(pm__result_file *file, size_t index, const subject *s, pm_error *error)
{
    size_t size;
    if (!json_is_object(json_array_get(file->rows, index)))
        return pm__fail(error, PM_EFORMAT, "%s: rows[%zu]: expected an object, not %s", file->name, index,
                        type_name(json_array_get(file->rows, index)));
    FILE *const label = open_memstream(&file->labels[index], &size);
    if (!label)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    pm_status status = PM_OK;
    for (size_t i = 0; i < s->key_count && status == PM_OK; i++)
        status = add_key(file, index, &s->keys[i], label, error);
    if ((ferror(label) | fclose(label)) && status == PM_OK)
        status = pm__fail(error, PM_ENOMEM, "out of memory");
    if (file->labels[index])
        make_printable(file->labels[index]);
    return status;
}

static pm_status add_labels(pm__result_file *file, pm_error *error)
{
    const subject *s = NULL;
    char name[PM__QUOTE_SIZE];
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++)
        if (strcmp(file->command, subjects[i].command) == 0)
            s = &subjects[i];
    pm__quote(file->command, strlen(file->command), name);
    if (!s)
        return pm__fail(error, PM_EINVAL, "%s: results of '%s' cannot be compared, only those of search, accuracy and "
                        "storage", file->name, name);
    file->labels = calloc(file->count + 1, sizeof *file->labels);
    pm_status status = file->labels ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory");
    for (size_t i = 0; i < file->count && status == PM_OK; i++)
        status = add_label(file, i, s, error);
    return status;
}

static pm_status check_head(pm__result_file *file, pm_error *error)
{
    const json_t *const schema = json_object_get(file->root, "schema");
    const json_t *const command = json_object_get(file->root, "command");
    char found[PM__QUOTE_SIZE];
    if (!json_is_object(file->root))
        return pm__fail(error, PM_EFORMAT, "%s: expected an object with schema photonbench/1, not %s", file->name,
                        type_name(file->root));
    if (!json_is_string(schema))
        return pm__fail(error, PM_EFORMAT, "%s: schema: expected \"photonbench/1\", not %s", file->name,
                        type_name(schema));
    pm__quote(json_string_value(schema), json_string_length(schema), found);
    if (strcmp(json_string_value(schema), "photonbench/1") != 0)
        return pm__fail(error, PM_EFORMAT, "%s: schema: expected \"photonbench/1\", not \"%s\"", file->name, found);
    if (!json_is_string(command))
        return pm__fail(error, PM_EFORMAT, "%s: command: expected text, not %s", file->name, type_name(command));
    file->command = json_string_value(command);
    file->rows = json_object_get(file->root, "rows");
    if (!json_is_array(file->rows))
        return pm__fail(error, PM_EFORMAT, "%s: rows: expected an array, not %s", file->name, type_name(file->rows));
    file->count = json_array_size(file->rows);
    return PM_OK;
}

/* No JSON starts with the first byte of an OpenEXR file, so one byte tells; pipes can take one back. */
static pm_status parse(FILE *stream, pm__result_file *file, pm_error *error)
{
    json_error_t reason;
    const int first = getc(stream);
    if (ferror(stream))
        return pm__fail(error, PM_EIO, "%s: cannot be read: %s", file->name, strerror(errno));
    if (first == 0x76 && getc(stream) == 0x2f && getc(stream) == 0x31 && getc(stream) == 0x01)
        return pm__fail(error, PM_EINVAL, "%s: an OpenEXR image; of images two regular files can be compared",
                        file->name);
    (void)ungetc(first, stream);
    file->root = json_loadf(stream, JSON_REJECT_DUPLICATES, &reason);
    if (file->root)
        return PM_OK;
    make_printable(reason.text);
    if (json_error_code(&reason) == json_error_out_of_memory || pm__refused_status(NULL) != PM_OK)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    return pm__fail(error, PM_EFORMAT, "%s: line %d, byte %d: expected JSON: %.120s", file->name, reason.line,
                    reason.position, reason.text);
}

pm_status pm__result_file_load(const char *path, pm__result_file *file, pm_error *error)
{
    memset(file, 0, sizeof *file);
    pm__quote_path(path, file->name);
    FILE *const stream = fopen(path, "rb");
    if (!stream)
        return pm__fail(error, errno == ENOMEM ? PM_ENOMEM : PM_EIO, "%s: cannot be opened: %s", file->name,
                        strerror(errno));
    pm_status status = parse(stream, file, error);
    (void)fclose(stream);
    if (status == PM_OK)
        status = check_head(file, error);
    return status == PM_OK ? add_labels(file, error) : status;
}

void pm__result_file_free(pm__result_file *file)
{
    for (size_t i = 0; file->labels && i < file->count; i++)
        free(file->labels[i]);
    free(file->labels);
    json_decref(file->root);
    memset(file, 0, sizeof *file);
}
