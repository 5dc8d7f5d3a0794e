/* Memory refused where rows are put together.
 *
 * A row is dozens of small values, most of them Jansson's, whose calls take a missing value quietly. In place of
 * looking at each, a refusal is noted, and nothing that was put together meanwhile is given out as complete:
 * pm__sinks_finish and what writes checkpoints ask. */
#ifndef PM_CLI_REFUSED_H
#define PM_CLI_REFUSED_H

#include "../base/status.h"

#include <stdbool.h>

/* Has Jansson's allocations watched, from then on; nothing has been refused so far. Call it before Jansson. */
void pm__refused_watch(void);

/* Notes a refusal. Any thread. */
void pm__refused_note(void);

/* The same where it is one: `memory` is NULL. Returns `memory`. */
void *pm__refused_if_null(void *memory);

/* PM_OK, or ENOMEM: something was refused since. */
pm_status pm__refused_status(pm_error *error);

#endif
