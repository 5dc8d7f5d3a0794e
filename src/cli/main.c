/* photonbench: dispatch. */
#include "commands.h"
#include "interrupt.h"
#include "refused.h"
#include "version.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

/* A file opened later must not become standard output because that was closed. Written to, the stand-in fails. */
static void occupy_standard_files(void)
{
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) == -1)
            (void)open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

static int run_command(const pm__command *command, int argc, char **argv)
{
    pm__settings settings;
    pm_error error = {""};
    pm__settings_init(&settings);
    int status = PM__EXIT_USAGE;
    const pm_status parsed = pm__options_parse(command, argc, argv, &settings, &error);
    if (parsed != PM_OK) {
        pm__complain(command->name, "%s", error.text);
        (void)fprintf(stderr, "Try 'photonbench %s --help'.\n", command->name);
        status = pm__exit_status(parsed);
    } else if (settings.help) {
        pm__help_command(stdout, command);
        status = PM__EXIT_DONE;
    } else {
        status = command->run(&settings);
    }
    pm__settings_free(&settings);
    return pm__finish_stdout(command->name, status);
}

static int refuse(const char *name, const char *nearest)
{
    const char *const what = *name == '-' ? "option" : "command";
    if (nearest)
        pm__complain(NULL, "unknown %s '%.80s'; did you mean '%s'?", what, name, nearest);
    else
        pm__complain(NULL, "unknown %s '%.80s'", what, name);
    (void)fputs("Try 'photonbench help'.\n", stderr);
    return PM__EXIT_USAGE;
}

int main(int argc, char **argv)
{
    occupy_standard_files();
    pm__interrupt_obey();
    pm__refused_watch();
    const char *const name = argc > 1 ? argv[1] : NULL;
    if (!name) {
        pm__help_overview(stderr);
        return PM__EXIT_USAGE;
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        pm__help_overview(stdout);
        return pm__finish_stdout(NULL, PM__EXIT_DONE);
    }
    if (strcmp(name, "--version") == 0) {
        (void)puts("photonbench " PM_VERSION);
        return pm__finish_stdout(NULL, PM__EXIT_DONE);
    }
    const char *nearest;
    const pm__command *const command = pm__command_find(name, &nearest);
    return command ? run_command(command, argc - 1, argv + 1) : refuse(name, nearest);
}
