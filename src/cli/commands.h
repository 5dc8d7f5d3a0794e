/* The commands of the program, and what they say to the shell. */
#ifndef PM_CLI_COMMANDS_H
#define PM_CLI_COMMANDS_H

#include "options.h"

/* Exit statuses. */
enum {
    PM__EXIT_DONE = 0,         /* and all checks held */
    PM__EXIT_CHECK_FAILED = 1, /* done, but a check failed */
    PM__EXIT_USAGE = 2,
    PM__EXIT_INPUT = 3,        /* an input file is unreadable or malformed */
    PM__EXIT_OTHER = 4,        /* out of memory, disk full, device */
    PM__EXIT_INTERRUPTED = 130
};

typedef struct pm__command {
    const char *name;
    const char *operands;             /* as help shows them; "" where there are none */
    size_t max_operands;
    const char *job;                  /* one line */
    const char *text;                 /* further help: paragraphs and examples, lines to 100 columns */
    const pm__option *const *options; /* option_count of them; --help comes by itself */
    size_t option_count;
    /* Does the job; returns the exit status. settings: as parsed. */
    int (*run)(pm__settings *settings);
} pm__command;

/* Every command, one row each, in the order in which help shows them. */
#define PM__COMMAND_LIST(X) \
    X(accuracy)             \
    X(search)               \
    X(speed)                \
    X(render)               \
    X(storage)              \
    X(converge)             \
    X(advise)               \
    X(stress)               \
    X(estimate)             \
    X(compare)              \
    X(report)               \
    X(list)                 \
    X(help)

#define X(name) extern const pm__command pm__command_##name;
PM__COMMAND_LIST(X)
#undef X

/* NULL if there is none of that name; then *nearest is a name to suggest, or NULL. */
const pm__command *pm__command_find(const char *name, const char **nearest);

/* What `photonbench help` and `photonbench help COMMAND` show. */
void pm__help_overview(FILE *file);
void pm__help_command(FILE *file, const pm__command *command);

/* "photonbench COMMAND: message" to standard error; command may be NULL. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pm__complain(const char *command, const char *format, ...);

/* The exit status for a status. */
int pm__exit_status(pm_status status);

/* The same, at a command's end, which is said on standard error if it is an error or, not `quiet`, an interruption.
 * interrupted: what is there then. unheld: what to say of a check that failed; NULL: none did. */
int pm__conclude(const char *command, pm_status status, bool quiet, const char *interrupted, const char *unheld,
                 const pm_error *error);

/* The exit status for one that reading input gave. */
int pm__exit_status_of_input(pm_status status);

/* Says that standard output could not be written, if so: PM__EXIT_OTHER, else `status`. */
int pm__finish_stdout(const char *command, int status);

#endif
