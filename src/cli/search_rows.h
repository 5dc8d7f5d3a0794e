/* The rows of `search` as data and on the screen. */
#ifndef PM_CLI_SEARCH_ROWS_H
#define PM_CLI_SEARCH_ROWS_H

#include "../../bench/search_bench.h"
#include "results.h"

/* Writes the rows to all sinks and closes them. search_rows.c */
pm_status pm__search_write(const pm__settings *settings, const pm__search_config *config, const pm__search_row *rows,
                           size_t count, double wall_s, bool interrupted, pm__sinks *sinks, pm_error *error);

/* Table, then for each run how much faster the fastest is than the others: 100 columns. search_table.c */
void pm__search_print(FILE *file, const pm__search_row *rows, size_t count);

#endif
