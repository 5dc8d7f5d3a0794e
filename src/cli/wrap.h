/* Text broken into lines for the screen. */
#ifndef PM_CLI_WRAP_H
#define PM_CLI_WRAP_H

#include <stdio.h>

enum { PM__SCREEN_WIDTH = 100 };

/* Prints `text` from column `column` on; lines end before PM__SCREEN_WIDTH, further ones start at `indent`. Ends the
 * last line. */
void pm__wrap(FILE *file, const char *text, int column, int indent);

#endif
