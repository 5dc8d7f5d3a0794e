/* The rows of `speed` as data and on the screen. */
#ifndef PM_CLI_SPEED_ROWS_H
#define PM_CLI_SPEED_ROWS_H

#include "../../bench/speed.h"
#include "results.h"

/* Writes the rows to all sinks and closes them. */
pm_status pm__speed_write(const pm__settings *settings, const pm__speed_config *config, const pm__speed_row *rows,
                          size_t count, double wall_s, bool interrupted, pm__sinks *sinks, pm_error *error);

/* A table of 100 columns. */
void pm__speed_print(FILE *file, const pm__speed_row *rows, size_t count);

#endif
