#include "status.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

const char *pm_status_text(pm_status status)
{
    switch (status) {
#define X(name, code, text) \
    case PM_##name:         \
        return text;
        PM_STATUS_LIST(X)
#undef X
    }
    return "an unknown status";
}

pm_status pm__fail(pm_error *error, pm_status status, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return status;
}

void pm_free(void *memory)
{
    free(memory);
}
