/* What the files of `converge` share: its series, their rows, the screen. */
#ifndef PM_CLI_CONVERGE_TASK_H
#define PM_CLI_CONVERGE_TASK_H

#include "../converge/converge.h"
#include "results.h"

/* One series, and what was found. */
typedef struct pm__converge_item {
    const pm__spec *scene, *method;
    const pm__spec *estimator; /* NULL: the method looks none up */
    double alpha;              /* NAN: its radii do not shrink */
    size_t kernel;             /* number of the estimator */
    const char *status;        /* "ok", "interrupted", "unsupported"; NULL: not begun */
    char detail[PM__CONVERGE_DETAIL];
    pm__converge_series series;
} pm__converge_item;

typedef struct pm__converge_task {
    const pm__settings *settings;
    pm__converge_item *items;
    size_t count;
    pm__converge_config config; /* but for scene, method, estimator and alpha */
    const char *search;         /* "auto": none is named, each method as it is fastest */
} pm__converge_task;

/* The options in effect: all that is needed to run the same again. converge_rows.c */
json_t *pm__converge_options_of(const pm__converge_task *task);

/* "variance", ... converge_rows.c */
extern const char *const pm__converge_quantity_names[PM__QUANTITIES];

/* The screen table, 100 columns. converge_table.c */
void pm__converge_print(FILE *file, const pm__converge_task *task);

/* Writes rows, fits and watched points to all sinks and closes them. converge_rows.c */
pm_status pm__converge_write(const pm__converge_task *task, double wall_s, bool interrupted, pm__sinks *sinks,
                             pm_error *error);

#endif
