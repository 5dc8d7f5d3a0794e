/* help: what the commands do and take. */
#include "commands.h"
#include "version.h"
#include "wrap.h"

#include <string.h>

enum { OPTION_COLUMN = 28 };

static const pm__command *const commands[] = {
#define X(name) &pm__command_##name,
    PM__COMMAND_LIST(X)
#undef X
};

void pm__help_overview(FILE *file)
{
    (void)fputs("photonbench " PM_VERSION ": how biased, how noisy and how slow photon-map radiance estimators are\n\n"
                "Usage: photonbench COMMAND [options]\n"
                "       photonbench help [COMMAND]\n"
                "       photonbench --version\n\n"
                "Commands:\n",
                file);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        (void)fprintf(file, "  %-10s  %s\n", commands[i]->name, commands[i]->job);
    (void)fputs("\nExit status: 0 done, 1 a check failed, 2 usage, 3 an input file is unreadable or malformed,\n"
                "4 anything else (out of memory, disk full), 130 interrupted.\n",
                file);
}

static void print_option(FILE *file, const pm__option *option)
{
    char left[64];
    if (option->letter)
        (void)snprintf(left, sizeof left, "  -%c, --%s", option->letter, option->name);
    else
        (void)snprintf(left, sizeof left, "  --%s", option->name);
    (void)fprintf(file, "%s%s%s", left, option->argument ? " " : "", option->argument ? option->argument : "");
    const int used = (int)(strlen(left) + (option->argument ? 1 + strlen(option->argument) : 0));
    (void)fprintf(file, "%*s", used < OPTION_COLUMN - 1 ? OPTION_COLUMN - used : 2, "");
    pm__wrap(file, option->help, used < OPTION_COLUMN - 1 ? OPTION_COLUMN : used + 2, OPTION_COLUMN);
}

void pm__help_command(FILE *file, const pm__command *command)
{
    (void)fprintf(file, "Usage: photonbench %s%s%s%s\n\n", command->name, command->option_count ? " [options]" : "",
                  *command->operands ? " " : "", command->operands);
    pm__wrap(file, command->job, 0, 0);
    (void)fputs("\nOptions (defaults in parentheses):\n", file);
    for (size_t i = 0; i < command->option_count; i++)
        print_option(file, command->options[i]);
    print_option(file, &pm__option_help);
    (void)fprintf(file, "\n%s", command->text);
}

static int run(pm__settings *settings)
{
    const char *nearest = NULL;
    if (!settings->operand_count) {
        pm__help_overview(stdout);
        return PM__EXIT_DONE;
    }
    const pm__command *const command = pm__command_find(settings->operands[0], &nearest);
    if (command) {
        pm__help_command(stdout, command);
        return PM__EXIT_DONE;
    }
    if (nearest)
        pm__complain("help", "unknown command '%.80s'; did you mean '%s'?", settings->operands[0], nearest);
    else
        pm__complain("help", "unknown command '%.80s'", settings->operands[0]);
    return PM__EXIT_USAGE;
}

const pm__command pm__command_help = {
    .name = "help",
    .operands = "[COMMAND]",
    .max_operands = 1,
    .job = "what a command does and takes",
    .text = "Example:\n"
            "  photonbench help accuracy\n",
    .run = run,
};
