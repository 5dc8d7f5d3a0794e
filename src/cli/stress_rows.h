/* The rows of `stress` as data and on the screen. */
#ifndef PM_CLI_STRESS_ROWS_H
#define PM_CLI_STRESS_ROWS_H

#include "../stress/stress.h"
#include "results.h"

typedef struct pm__stress_results {
    const pm__settings *settings;
    const pm__stress_config *config;
    const pm__stress_widths *widths;
    const pm__stress_row *rows;
    size_t count;
    double wall_s;
    bool interrupted;
} pm__stress_results;

/* Writes the rows to all sinks and closes them. */
pm_status pm__stress_write(const pm__stress_results *results, pm__sinks *sinks, pm_error *error);

/* A line for each test with the row nearest to its bound, failures in full; 100 columns. */
void pm__stress_print(FILE *file, const pm__stress_results *results);

#endif
