/* The screen table of `accuracy`, 100 columns. */
#ifndef PM_CLI_TABLE_H
#define PM_CLI_TABLE_H

#include "../accuracy/accuracy.h"

#include <stdio.h>

/* Up to this many rows have a line each, with intervals and predictions; more are packed, several k a line. */
enum { PM__LONG_FORM_ROWS = 48 };

typedef struct pm__table {
    FILE *file;
    const pm__accuracy_row *rows;
    size_t row_count;
    const pm__accuracy_config *config;
    bool colourful;
} pm__table;

/* Rows, notes, what the signs mean. table.c */
void pm__table_print(const pm__table *table);

/* For each case: the least error, and the cheapest within 10 % of it. table_summary.c */
void pm__table_summary(const pm__table *table);

/* A number in exactly `width` (at least 5) columns, with 4 digits or so; "-" for what does not exist. sign: '+' to show
 * it, '~' to show that instead of it, 0 for numbers that have none. */
void pm__table_number(FILE *file, int width, double value, char sign);

/* An interval in percent, in 17 columns. sign: as above, '+' or 0. */
void pm__table_interval(FILE *file, pm__interval interval, char sign);

/* Microseconds in 5 columns from ns. */
void pm__table_time(FILE *file, double ns);

/* "k=50" or "R=0.05". */
void pm__table_lookup(const pm__accuracy_row *row, char *text, size_t size);

/* Of rows of the same case, sampler and number of photons (and the same region, if asked): where the run that starts at
 * `first` ends. */
size_t pm__table_run(const pm__table *table, size_t first, bool same_region);

#endif
