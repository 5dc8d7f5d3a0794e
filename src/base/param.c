/* Specs: NAME[:key=value[,key=value...]] read and written. */
#include "param.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_CANDIDATES = 64, MAX_NAME = 64, MAX_QUOTED = 60 };

/* A stretch of the text that is parsed. */
typedef struct piece {
    const char *text;
    size_t length;
} piece;

/* The stretch from `text` up to the first of `ends`. */
static piece piece_until(const char *text, const char *ends)
{
    const piece p = {text, strcspn(text, ends)};
    return p;
}

/* A printable copy that fits a message. */
static const char *quoted(piece p, char buffer[MAX_QUOTED + 4])
{
    const size_t length = p.length < MAX_QUOTED ? p.length : MAX_QUOTED;
    for (size_t i = 0; i < length; i++)
        buffer[i] = p.text[i] >= ' ' && p.text[i] <= '~' ? p.text[i] : '?';
    memcpy(buffer + length, p.length > length ? "..." : "", p.length > length ? 4 : 1);
    return buffer;
}

static bool is_text(piece p, const char *text)
{
    return strlen(text) == p.length && memcmp(p.text, text, p.length) == 0;
}

static const pm__entry *find_piece(const pm__catalogue *catalogue, piece name)
{
    for (size_t i = 0; i < catalogue->count; i++)
        if (is_text(name, catalogue->entries[i]->name))
            return catalogue->entries[i];
    return NULL;
}

const pm__entry *pm__find(const pm__catalogue *catalogue, const char *name)
{
    return find_piece(catalogue, (piece){name, strlen(name)});
}

/* The name that an entry's text starts with: up to the first colon or comma, or beyond the colon where entries are
 * called so: scene:plate. */
static piece name_of(const pm__catalogue *catalogue, piece text)
{
    piece name = piece_until(text.text, ":,");
    if (name.length >= text.length)
        return text;
    if (text.text[name.length] != ':')
        return name;
    for (size_t i = 0; i < catalogue->count; i++)
        if (!strncmp(catalogue->entries[i]->name, name.text, name.length + 1)) {
            name.length += 1 + strcspn(text.text + name.length + 1, ":,");
            return name.length < text.length ? name : text;
        }
    return name;
}

/* Appends "; did you mean 'x'?" or else what there is. */
static pm_status unknown(pm_error *error, const char *what, piece name, const char *const *candidates, size_t count)
{
    char shown[MAX_QUOTED + 4], list[200] = "";
    const char *const nearest = pm__nearest_name(quoted(name, shown), candidates, count);
    if (nearest)
        return pm__fail(error, PM_ENAME, "%s '%s'; did you mean '%s'?", what, shown, nearest);
    size_t used = 0;
    for (size_t i = 0; i < count && used < sizeof list; i++)
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", candidates[i]);
    return pm__fail(error, PM_ENAME, "%s '%s'%s%s", what, shown, count ? "; there are: " : "; there are none", list);
}

static pm_status unknown_entry(const pm__catalogue *catalogue, piece name, pm_error *error)
{
    const char *candidates[MAX_CANDIDATES];
    char what[MAX_NAME];
    size_t count = 0;
    for (; count < catalogue->count && count < MAX_CANDIDATES; count++)
        candidates[count] = catalogue->entries[count]->name;
    (void)snprintf(what, sizeof what, "unknown %s", catalogue->kind);
    return unknown(error, what, name, candidates, count);
}

static pm_status unknown_param(const pm__catalogue *catalogue, const pm__entry *entry, piece name, pm_error *error)
{
    const char *candidates[PM__MAX_PARAMS];
    char what[2 * MAX_NAME];
    for (size_t i = 0; i < entry->param_count; i++)
        candidates[i] = entry->params[i].name;
    (void)snprintf(what, sizeof what, "%s '%s' has no parameter", catalogue->kind, entry->name);
    return unknown(error, what, name, candidates, entry->param_count);
}

static pm_status parse_choice(const pm__param *param, piece text, double *value)
{
    int index = 0;
    for (const char *p = param->choices;; index++) {
        const piece choice = piece_until(p, "|");
        if (choice.length == text.length && memcmp(choice.text, text.text, text.length) == 0) {
            *value = index;
            return PM_OK;
        }
        p += choice.length;
        if (!*p++)
            return PM_EINVAL;
    }
}

static pm_status parse_number(const pm__param *param, piece text, double *value)
{
    char copy[64];
    double number;
    if (text.length >= sizeof copy)
        return PM_EINVAL;
    memcpy(copy, text.text, text.length);
    copy[text.length] = '\0';
    if (pm__parse_double(copy, &number))
        return PM_EINVAL;
    if (param->type == PM__INTEGER && number != floor(number))
        return PM_EINVAL;
    if (!(number >= param->min && number <= param->max))
        return PM_EINVAL;
    *value = number == 0.0 ? 0.0 : number; /* -0 is 0 to the canonical form */
    return PM_OK;
}

static pm_status parse_value(const pm__entry *entry, const pm__param *param, piece text, double *value, pm_error *error)
{
    char shown[MAX_QUOTED + 4], low[32], high[32];
    (void)quoted(text, shown);
    if (param->type == PM__CHOICE) {
        if (parse_choice(param, text, value))
            return pm__fail(error, PM_EINVAL, "%s: %s=%s: expected one of %s", entry->name, param->name, shown,
                            param->choices);
        return PM_OK;
    }
    if (parse_number(param, text, value) == PM_OK)
        return PM_OK;
    pm__format_double(param->min, low);
    pm__format_double(param->max, high);
    return pm__fail(error, PM_EINVAL, "%s: %s=%s: expected %s from %s to %s", entry->name, param->name, shown,
                    param->type == PM__INTEGER ? "an integer" : "a number", low, high);
}

/* One key=value. given: which parameters have had a value. */
static pm_status parse_param(const pm__catalogue *catalogue, pm__spec *spec, piece text, bool *given, pm_error *error)
{
    const pm__entry *const entry = spec->entry;
    char shown[MAX_QUOTED + 4];
    const char *const equals = memchr(text.text, '=', text.length);
    if (!equals)
        return pm__fail(error, PM_EINVAL, "%s: expected key=value, not '%s'", entry->name, quoted(text, shown));
    const piece key = {text.text, (size_t)(equals - text.text)};
    const piece value = {equals + 1, text.length - key.length - 1};
    for (size_t i = 0; i < entry->param_count; i++) {
        if (!is_text(key, entry->params[i].name))
            continue;
        if (given[i])
            return pm__fail(error, PM_EINVAL, "%s: %s is given twice", entry->name, entry->params[i].name);
        given[i] = true;
        return parse_value(entry, &entry->params[i], value, &spec->values[i], error);
    }
    return unknown_param(catalogue, entry, key, error);
}

static void set_defaults(const pm__entry *entry, pm__spec *spec)
{
    memset(spec, 0, sizeof *spec);
    spec->entry = entry;
    for (size_t i = 0; i < entry->param_count; i++)
        spec->values[i] = entry->params[i].value;
}

double pm__spec_value(const pm__spec *spec, const char *name, double absent)
{
    for (size_t i = 0; i < spec->entry->param_count; i++)
        if (!strcmp(spec->entry->params[i].name, name))
            return spec->values[i];
    return absent;
}

void pm__spec_default(const pm__entry *entry, pm__spec *spec)
{
    set_defaults(entry, spec);
    if (entry->resolve)
        (void)entry->resolve(spec->values, NULL);
}

/* NAME, NAME:params or (in a list) NAME,params. */
static pm_status parse_piece(const pm__catalogue *catalogue, piece text, pm__spec *spec, pm_error *error)
{
    const piece name = name_of(catalogue, text);
    const pm__entry *const entry = find_piece(catalogue, name);
    if (!entry)
        return unknown_entry(catalogue, name, error);
    set_defaults(entry, spec);
    bool given[PM__MAX_PARAMS] = {false};
    for (size_t at = name.length; at < text.length;) {
        piece param = piece_until(text.text + ++at, ",");
        if (param.length > text.length - at)
            param.length = text.length - at;
        const pm_status status = parse_param(catalogue, spec, param, given, error);
        if (status)
            return status;
        at += param.length;
    }
    return entry->resolve ? entry->resolve(spec->values, error) : PM_OK;
}

pm_status pm__spec_parse(const pm__catalogue *catalogue, const char *text, pm__spec *spec, pm_error *error)
{
    return parse_piece(catalogue, (piece){text, strlen(text)}, spec, error);
}

static pm_status append(pm__spec **specs, size_t *count, const pm__spec *spec, pm_error *error)
{
    pm__spec *const grown = realloc(*specs, (*count + 1) * sizeof **specs);
    if (!grown)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    grown[*count] = *spec;
    *specs = grown;
    ++*count;
    return PM_OK;
}

static pm_status append_all(const pm__catalogue *catalogue, pm__spec **specs, size_t *count, pm_error *error)
{
    for (size_t i = 0; i < catalogue->count; i++) {
        pm__spec spec;
        pm__spec_default(catalogue->entries[i], &spec);
        const pm_status status = append(specs, count, &spec, error);
        if (status)
            return status;
    }
    return PM_OK;
}

/* Is the piece that starts here a key=value, so that it belongs to the entry before it? */
static bool continues(const char *text)
{
    return text[strcspn(text, ",:=")] == '=';
}

/* The entry that starts here, with all the pieces that belong to it. */
static piece whole_entry(const char *text)
{
    piece whole = piece_until(text, ",");
    while (text[whole.length] && continues(text + whole.length + 1))
        whole.length += 1 + strcspn(text + whole.length + 1, ",");
    return whole;
}

static pm_status parse_entry(const pm__catalogue *catalogue, piece whole, pm__spec **specs, size_t *count,
                             pm_error *error)
{
    const piece name = name_of(catalogue, whole);
    char shown[MAX_QUOTED + 4];
    pm__spec spec;
    if (!whole.length)
        return pm__fail(error, PM_EINVAL, "an empty name in the list of %ss", catalogue->kind);
    if (continues(whole.text))
        return pm__fail(error, PM_EINVAL, "'%s' follows no %s that it could belong to", quoted(whole, shown),
                        catalogue->kind);
    if (is_text(whole, "all") && !find_piece(catalogue, whole))
        return append_all(catalogue, specs, count, error);
    if (is_text(name, "all") && !find_piece(catalogue, name))
        return pm__fail(error, PM_EINVAL, "'all' takes no parameters");
    const pm_status status = parse_piece(catalogue, whole, &spec, error);
    return status ? status : append(specs, count, &spec, error);
}

pm_status pm__spec_parse_list(const pm__catalogue *catalogue, const char *text, pm__spec **specs, size_t *count,
                              pm_error *error)
{
    for (;;) {
        const piece whole = whole_entry(text);
        const pm_status status = parse_entry(catalogue, whole, specs, count, error);
        if (status)
            return status;
        text += whole.length;
        if (!*text++)
            return PM_OK;
    }
}

static void format_value(const pm__param *param, double value, char *text, size_t size)
{
    char number[32];
    if (param->type != PM__CHOICE) {
        pm__format_double(value, number);
        (void)snprintf(text, size, "%s", number);
        return;
    }
    const char *p = param->choices;
    for (int skip = (int)value; skip > 0 && strchr(p, '|'); skip--)
        p = strchr(p, '|') + 1;
    (void)snprintf(text, size, "%.*s", (int)strcspn(p, "|"), p);
}

/* shown: which parameters; NULL: all. */
static void format(const pm__spec *spec, const bool *shown, char *text, size_t size)
{
    size_t used = (size_t)snprintf(text, size, "%s", spec->entry->name);
    const char *separator = ":";
    for (size_t i = 0; i < spec->entry->param_count && used < size; i++) {
        char value[MAX_NAME];
        if (shown && !shown[i])
            continue;
        format_value(&spec->entry->params[i], spec->values[i], value, sizeof value);
        used += (size_t)snprintf(text + used, size - used, "%s%s=%s", separator, spec->entry->params[i].name, value);
        separator = ",";
    }
}

void pm__spec_format(const pm__spec *spec, char *text, size_t size)
{
    format(spec, NULL, text, size);
}

/* Do these parameters alone give the spec? The others get their defaults, or what follows from these. */
static bool suffice(const pm__spec *spec, const bool *shown)
{
    pm__spec other;
    set_defaults(spec->entry, &other);
    for (size_t i = 0; i < spec->entry->param_count; i++)
        if (shown[i])
            other.values[i] = spec->values[i];
    if (spec->entry->resolve && spec->entry->resolve(other.values, NULL) != PM_OK)
        return false;
    for (size_t i = 0; i < spec->entry->param_count; i++)
        if (other.values[i] != spec->values[i])
            return false;
    return true;
}

void pm__spec_format_short(const pm__spec *spec, char *text, size_t size)
{
    bool shown[PM__MAX_PARAMS];
    for (size_t i = 0; i < PM__MAX_PARAMS; i++)
        shown[i] = true;
    /* From the last: what follows from others tends to stand behind them. */
    for (size_t i = spec->entry->param_count; i-- > 0;) {
        shown[i] = false;
        shown[i] = !suffice(spec, shown);
    }
    format(spec, shown, text, size);
}
