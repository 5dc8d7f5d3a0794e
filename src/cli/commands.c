/* The list of commands, messages and exit statuses. */
#include "commands.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>

#define X(name) +1
enum { COMMAND_COUNT = PM__COMMAND_LIST(X) };
#undef X

static const pm__command *const commands[] = {
#define X(name) &pm__command_##name,
    PM__COMMAND_LIST(X)
#undef X
};

const pm__command *pm__command_find(const char *name, const char **nearest)
{
    const char *names[COMMAND_COUNT + 2];
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(commands[i]->name, name) == 0)
            return commands[i];
        names[i] = commands[i]->name;
    }
    names[COMMAND_COUNT] = "--version";
    names[COMMAND_COUNT + 1] = "--help";
    *nearest = pm__nearest_name(name, names, COMMAND_COUNT + 2);
    return NULL;
}

void pm__complain(const char *command, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)fprintf(stderr, "photonbench%s%s: ", command ? " " : "", command ? command : "");
    (void)vfprintf(stderr, format, arguments);
    (void)fputc('\n', stderr);
    va_end(arguments);
}

int pm__exit_status(pm_status status)
{
    switch (status) {
    case PM_OK:
        return PM__EXIT_DONE;
    case PM_EINVAL:
    case PM_ENAME:
        return PM__EXIT_USAGE;
    case PM_ECANCELED:
        return PM__EXIT_INTERRUPTED;
    case PM_ENOMEM:
    case PM_EIO:
    case PM_EFORMAT:
    case PM_ENONFINITE:
    case PM_EDEGENERATE:
    case PM_ETRUNCATED:
    case PM_EBROKEN:
        break;
    }
    return PM__EXIT_OTHER;
}

int pm__conclude(const char *command, pm_status status, bool quiet, const char *interrupted, const char *unheld,
                 const pm_error *error)
{
    if (status == PM_OK && unheld) {
        pm__complain(command, "%s", unheld);
        return PM__EXIT_CHECK_FAILED;
    }
    if (status == PM_ECANCELED && !quiet)
        pm__complain(command, "interrupted: %s", interrupted);
    else if (status != PM_OK && status != PM_ECANCELED)
        pm__complain(command, "%s", *error->text ? error->text : pm_status_text(status));
    return pm__exit_status(status);
}

int pm__exit_status_of_input(pm_status status)
{
    return status == PM_ENOMEM || status == PM_OK ? pm__exit_status(status) : PM__EXIT_INPUT;
}

int pm__finish_stdout(const char *command, int status)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return status;
    if (status == PM__EXIT_DONE)
        pm__complain(command, "standard output: %s", errno ? strerror(errno) : "cannot be written");
    return status == PM__EXIT_DONE ? PM__EXIT_OTHER : status;
}
