/* Named things with parameters: estimators, searches, cases, samplers, methods, policies.
 *
 * Each such thing starts with a pm__entry. On the command line and in the library it is written
 * NAME[:key=value[,key=value...]], and in a list a piece `key=value` that names no entry belongs to the
 * entry before it. */
#ifndef PM_BASE_PARAM_H
#define PM_BASE_PARAM_H

#include "status.h"

enum { PM__MAX_PARAMS = 16, PM__MAX_SPEC = 400 };

typedef enum pm__param_type { PM__REAL, PM__INTEGER, PM__CHOICE } pm__param_type;

typedef struct pm__param {
    const char *name;
    pm__param_type type;
    double value;        /* default; for a choice its index */
    double min, max;     /* inclusive; unused for a choice */
    const char *unit;    /* "m", "W/m2", "" */
    const char *choices; /* "full|half|none" for a choice, else NULL */
    const char *help;    /* half a line */
} pm__param;

typedef struct pm__entry {
    const char *name;
    const char *summary;  /* one line */
    const char *citation; /* "[C02] 2.8" */
    const pm__param *params;
    size_t param_count;
    /* Optional: refuses combinations, fills in values that depend on others. */
    pm_status (*resolve)(double *values, pm_error *error);
} pm__entry;

typedef struct pm__spec {
    const pm__entry *entry;
    double values[PM__MAX_PARAMS];
} pm__spec;

/* One kind of thing: all its entries. */
typedef struct pm__catalogue {
    const char *kind; /* "estimator", for messages */
    const pm__entry *const *entries;
    size_t count;
} pm__catalogue;

/* NULL if there is none. */
const pm__entry *pm__find(const pm__catalogue *catalogue, const char *name);

/* The entry with its defaults, resolved. */
void pm__spec_default(const pm__entry *entry, pm__spec *spec);

/* The value of a parameter by name; `absent` where the entry has none of that name. */
double pm__spec_value(const pm__spec *spec, const char *name, double absent);

/* One NAME[:...]. ENAME (with the nearest known name) or EINVAL. */
pm_status pm__spec_parse(const pm__catalogue *catalogue, const char *text, pm__spec *spec, pm_error *error);

/* A comma list, appended to *specs (malloc'ed, grown; *count follows); `all` stands for every entry, unless one
 * of them has that name. */
pm_status pm__spec_parse_list(const pm__catalogue *catalogue, const char *text, pm__spec **specs, size_t *count,
                              pm_error *error);

/* Canonical form, every parameter spelt in the entry's order; short form: only those that do not follow from the
 * others and the defaults. Truncated to size with NUL. */
void pm__spec_format(const pm__spec *spec, char *text, size_t size);
void pm__spec_format_short(const pm__spec *spec, char *text, size_t size);

/* The shortest decimal that reads back as value. */
void pm__format_double(double value, char text[32]);

/* The double that is nearest to the shortest decimal that reads back as value: 0.04 for 0.04f. */
double pm__decimal_of_float(float value);

/* A whole finite number from all of text: 0, or -1. */
int pm__parse_double(const char *text, double *value);

/* The candidate nearest to `name` in edit distance, if near enough to be a slip; else NULL. */
const char *pm__nearest_name(const char *name, const char *const *candidates, size_t count);

#endif
