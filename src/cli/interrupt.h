/* SIGINT, SIGTERM and SIGHUP as a question that work asks now and then. */
#ifndef PM_CLI_INTERRUPT_H
#define PM_CLI_INTERRUPT_H

#include <stdbool.h>

/* From now on the first such signal only sets a flag; a second one ends the process at once. A signal that the
 * process was started to ignore stays ignored. */
void pm__interrupt_watch(void);

bool pm__interrupted(void);

#endif
