/* The rows of `accuracy` as data. */
#ifndef PM_CLI_ACCURACY_ROWS_H
#define PM_CLI_ACCURACY_ROWS_H

#include "../accuracy/accuracy.h"
#include "results.h"

/* Writes the rows to all sinks and closes them. */
pm_status pm__accuracy_write(const pm__settings *settings, const pm__accuracy_config *config,
                             const pm__accuracy_row *rows, size_t count, double wall_s, bool interrupted,
                             pm__sinks *sinks, pm_error *error);

#endif
