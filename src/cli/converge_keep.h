/* The checkpoint of `converge`: what was resumed, and what is saved. */
#ifndef PM_CLI_CONVERGE_KEEP_H
#define PM_CLI_CONVERGE_KEEP_H

#include "../converge/checkpoint.h"
#include "converge_task.h"

typedef struct pm__keep {
    const pm__settings *settings;
    const char *path;          /* where it is written to; NULL: nowhere */
    pm__checkpoint checkpoint; /* room for a part of each series; those with bytes are saved */
    double written;            /* s: when it was last */
    bool stale;                /* the file lacks something */
    bool unreadable;           /* what --resume names could not be read */
} pm__keep;

/* Reads what --resume names and sees whether the file can be written. EINVAL: it is of other options; EIO, EFORMAT,
 * ENOMEM. On any status pm__keep_close frees it. */
pm_status pm__keep_open(const pm__converge_task *task, pm__keep *keep, pm_error *error);
void pm__keep_close(pm__keep *keep);

/* Where a series goes on; NULL: from the start. */
const pm__saved *pm__keep_from(const pm__keep *keep, size_t item);

/* For one that pm__converge has refused: EFORMAT, with the file and the place. */
pm_status pm__keep_refuse(pm__keep *keep, size_t item, pm_error *error);

/* Takes the state of a series, copied, and writes the file unless that was done a moment ago: series may be short, and
 * nobody need wait for the disk after each. EIO, ENOMEM. */
pm_status pm__keep_take(pm__keep *keep, size_t item, const pm__saved *saved, pm_error *error);

/* The series is done. */
void pm__keep_done(pm__keep *keep, size_t item);

/* Writes the file if it lacks something. EIO, ENOMEM. */
pm_status pm__keep_flush(pm__keep *keep, pm_error *error);

/* "resumed from FILE: 2 of 5 series were done, one in hand", if so, to standard error. */
void pm__keep_greet(const pm__keep *keep, size_t series);

/* How to go on, to standard error. */
void pm__keep_part(const pm__keep *keep);

#endif
