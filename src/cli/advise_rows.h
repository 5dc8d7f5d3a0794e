/* The rows of `advise` as data and on the screen. */
#ifndef PM_CLI_ADVISE_ROWS_H
#define PM_CLI_ADVISE_ROWS_H

#include "../converge/advise.h"
#include "results.h"

typedef struct pm__advise_task {
    const pm__settings *settings;
    const pm__advise_config *config;
    const pm__advice *advice;
    size_t count;
    double wall_s;
    bool interrupted; /* before the advised row was verified */
} pm__advise_task;

/* The command that runs a piece of advice. */
void pm__advise_command(const pm__advise_task *task, const pm__advice *advice, char *text, size_t size);

/* Writes the rows to all sinks and closes them. */
pm_status pm__advise_write(const pm__advise_task *task, pm__sinks *sinks, pm_error *error);

/* A table of 100 columns, the command of the advised row and what came of it. */
void pm__advise_print(FILE *file, const pm__advise_task *task);

#endif
