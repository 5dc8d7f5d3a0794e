/* Do two paths name one file? */
#ifndef PM_CLI_SAME_FILE_H
#define PM_CLI_SAME_FILE_H

#include <stdbool.h>

/* The same text, the same file that is there, or the same name in one folder where none is there yet. */
bool pm__same_file(const char *a, const char *b);

#endif
