/* Foreign text made fit for a message: one line, printable, short. */
#ifndef PM_BASE_QUOTE_H
#define PM_BASE_QUOTE_H

#include <stddef.h>

enum { PM__QUOTE_SIZE = 48, PM__NAME_SIZE = 160 };

/* The first bytes of something read from a file; what is not printable ASCII becomes '?', a cut ends in "...". */
void pm__quote(const char *bytes, size_t count, char text[PM__QUOTE_SIZE]);

/* A path; of a long one the end, after "...". Control characters become '?'. */
void pm__quote_path(const char *path, char text[PM__NAME_SIZE]);

#endif
