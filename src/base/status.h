/* Errors with text, shared by every layer. */
#ifndef PM_BASE_STATUS_H
#define PM_BASE_STATUS_H

#include "../photonmap.h"

/* Writes the formatted sentence to error (if not NULL) and returns status, so that a caller can
 * `return pm__fail(error, PM_EINVAL, "...", ...)`. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
pm_status pm__fail(pm_error *error, pm_status status, const char *format, ...);

#endif
