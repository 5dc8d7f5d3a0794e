/* How the values of options are read, for the rows that take them. */
#ifndef PM_CLI_OPTION_VALUES_H
#define PM_CLI_OPTION_VALUES_H

#include "options.h"

/* EINVAL, ENAME or ENOMEM with a message that names the value. */
pm_status pm__parse_count(const char *text, size_t min, size_t max, size_t *value, pm_error *error);
pm_status pm__parse_positive(const char *text, double *value, pm_error *error);
pm_status pm__parse_path(const char *text, const char **path, pm_error *error);

/* Comma lists, appended; what is there already is not repeated. */
pm_status pm__parse_counts(const char *text, size_t min, size_t max, pm__counts *list, pm_error *error);
pm_status pm__parse_specs(const pm__catalogue *catalogue, const char *text, pm__specs *list, pm_error *error);

/* Appends `text` to a list that is still empty. */
pm_status pm__default_specs(const pm__catalogue *catalogue, const char *text, pm__specs *list, pm_error *error);

/* sphere, ellipsoid:S or disc:H; *shape keeps its front_only. */
pm_status pm__parse_lookup(const char *text, pm__shape *shape, pm_error *error);

#endif
