/* A progress bar on standard error with the time left, where that is a terminal. */
#ifndef PM_CLI_PROGRESS_H
#define PM_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdio.h>

typedef struct pm__progress {
    bool shown;
    double start, last; /* s */
    double before;      /* the fraction that was done at the start */
    int width;          /* of the terminal */
} pm__progress;

/* May escape sequences for colour go to this file? Only to a terminal that is not dumb, and not under NO_COLOR. */
bool pm__colourful(FILE *file);

void pm__progress_start(pm__progress *progress, bool quiet);

/* That much had been done before: the time left is told from what is done from now on. */
void pm__progress_resume(pm__progress *progress, double fraction);

/* fraction: of the work, 0 to 1. One caller at a time. Cheap: draws ten times a second at most. */
void pm__progress_update(pm__progress *progress, double fraction, const char *what);

/* Clears the line. */
void pm__progress_end(pm__progress *progress);

#endif
