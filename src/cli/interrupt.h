/* SIGINT, SIGTERM and SIGHUP as a question that work asks now and then. */
#ifndef PM_CLI_INTERRUPT_H
#define PM_CLI_INTERRUPT_H

#include <stdbool.h>

enum { PM__MOST_HELD = 264 };

/* From now on such a signal removes what pm__interrupt_hold named and ends the process at once, with
 * PM__EXIT_INTERRUPTED. A signal that the process was started to ignore stays ignored, here and below. SIGPIPE and
 * SIGXFSZ are ignored: the write fails, and is an error like others. */
void pm__interrupt_obey(void);

/* From now on the first such signal only sets a flag; a second one ends the process as above. */
void pm__interrupt_watch(void);

bool pm__interrupted(void);

/* Names a file (copied) that a signal which ends the process must not leave behind. The number to release it by; -1
 * for NULL, or where PM__MOST_HELD are held. One thread. */
int pm__interrupt_hold(const char *path);

/* The file is gone, or has its final name. -1 is allowed. */
void pm__interrupt_release(int number);

/* Signals wait between the two: a file is then made and held as one. */
void pm__interrupt_block(void);
void pm__interrupt_unblock(void);

#endif
