/* An output file that is complete or absent.
 *
 *     pm__output out;
 *     status = pm__output_open(path, &out, error);
 *     ... fprintf(out.file, ...) as often as needed, unchecked ...
 *     status = pm__output_commit(&out, error);          or pm__output_discard(&out)
 *
 * A regular file is written under a temporary name in the target's directory and renamed over the target on
 * commit; a symbolic link stays and its target is replaced. An existing file keeps its mode, a new one gets 0666
 * less the umask. A process that is killed leaves the target as it was, and beside it `.NAME.XXXXXX.tmp` (`temporary`,
 * for a signal handler to unlink).
 * What is not a regular file (device, pipe, FIFO), and a file reached through /proc (as /dev/stdout is), is written
 * in place: there is nothing to rename, but its close is checked all the same. */
#ifndef PM_BASE_OUTPUT_H
#define PM_BASE_OUTPUT_H

#include "quote.h"
#include "status.h"

#include <stdio.h>

typedef struct pm__output {
    FILE *file;      /* binary, buffered; NULL when not open */
    char *target;    /* what the rename replaces; NULL: written in place */
    char *temporary; /* the name written to; NULL likewise */
    char name[PM__NAME_SIZE];
} pm__output;

/* EIO (error names path and reason) or ENOMEM; *output is then closed. */
pm_status pm__output_open(const char *path, pm__output *output, pm_error *error);

/* Flushes, closes, renames. EIO if any write since opening failed: then nothing is left behind. Closes *output
 * in either case. */
pm_status pm__output_commit(pm__output *output, pm_error *error);

/* Closes without a trace (what was written in place stays written). A closed *output is allowed. */
void pm__output_discard(pm__output *output);

#endif
