/* The parser: getopt_long for the grammar, our own messages. */
#include "commands.h"
#include "same_file.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

enum { LONG_BASE = 1000 };

void pm__settings_init(pm__settings *settings)
{
    memset(settings, 0, sizeof *settings);
    settings->seed = 1;
    settings->lookup.front_only = true;
}

void pm__settings_free(pm__settings *settings)
{
    free(settings->cases.items);
    free(settings->estimators.items);
    free(settings->samplers.items);
    free(settings->ks.items);
    free(settings->searches.items);
    free(settings->photons.items);
    free(settings->converge.methods.items);
    free(settings->advise.methods.items);
    free(settings->storage.policies.items);
    free(settings->storage.stored.items);
    free(settings->metrics.items);
    free(settings->command_line);
}

/* The command's options and --help, as rows and in getopt's form. */
typedef struct grammar {
    const pm__option *rows[PM__MAX_OPTIONS + 1];
    size_t count;
    struct option longs[PM__MAX_OPTIONS + 2];
    char letters[3 * PM__MAX_OPTIONS];
} grammar;

static void grammar_add(grammar *g, const pm__option *row)
{
    char *const end = g->letters + strlen(g->letters);
    g->longs[g->count] = (struct option){row->name, row->argument ? required_argument : no_argument, NULL,
                                         LONG_BASE + (int)g->count};
    g->rows[g->count++] = row;
    if (row->letter) {
        end[0] = (char)row->letter;
        end[1] = row->argument ? ':' : '\0';
        end[2] = '\0';
    }
}

static void grammar_init(grammar *g, const pm__command *command)
{
    memset(g, 0, sizeof *g);
    g->letters[0] = ':'; /* a missing value is told apart */
    for (size_t i = 0; i < command->option_count && i < PM__MAX_OPTIONS; i++)
        grammar_add(g, command->options[i]);
    grammar_add(g, &pm__option_help);
}

static const pm__option *grammar_find(const grammar *g, int code)
{
    if (code >= LONG_BASE)
        return g->rows[code - LONG_BASE];
    for (size_t i = 0; i < g->count; i++)
        if (g->rows[i]->letter == code)
            return g->rows[i];
    return NULL;
}

/* A long option that getopt_long did not take: an ambiguous abbreviation or an unknown one. */
static pm_status refuse_long(const grammar *g, const char *text, pm_error *error)
{
    const char *names[PM__MAX_OPTIONS + 1];
    const size_t length = strcspn(text, "=");
    char name[64], matches[200] = "";
    size_t used = 0, match_count = 0;
    (void)snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), text);
    for (size_t i = 0; i < g->count; i++) {
        names[i] = g->rows[i]->name;
        if (*name && strncmp(names[i], name, strlen(name)) == 0 && used < sizeof matches)
            used +=
                (size_t)snprintf(matches + used, sizeof matches - used, "%s--%s", match_count++ ? ", " : "", names[i]);
    }
    if (match_count > 1)
        return pm__fail(error, PM_EINVAL, "option '--%s' is ambiguous: it could be %s", name, matches);
    const char *const nearest = pm__nearest_name(name, names, g->count);
    if (nearest)
        return pm__fail(error, PM_ENAME, "unknown option '--%s'; did you mean '--%s'?", name, nearest);
    return pm__fail(error, PM_ENAME, "unknown option '--%s'", name);
}

static pm_status refuse(const grammar *g, int code, const char *text, pm_error *error)
{
    const pm__option *const row = optopt ? grammar_find(g, optopt) : NULL;
    if (code == ':' && row)
        return pm__fail(error, PM_EINVAL, "option '--%s' needs a value: %s", row->name, row->argument);
    if (row)
        return pm__fail(error, PM_EINVAL, "option '--%s' takes no value", row->name);
    if (optopt)
        return pm__fail(error, PM_ENAME, "unknown option '-%c'", optopt >= ' ' && optopt <= '~' ? optopt : '?');
    return refuse_long(g, strncmp(text, "--", 2) == 0 ? text + 2 : text, error);
}

static pm_status take(const pm__option *row, pm__settings *settings, const char *text, pm_error *error)
{
    pm_error reason = {""};
    const pm_status status = row->set(settings, text, &reason);
    if (status)
        return pm__fail(error, status, "--%s: %.280s", row->name, reason.text);
    return PM_OK;
}

static pm_status take_operands(const pm__command *command, int argc, char **argv, pm__settings *settings,
                               pm_error *error)
{
    for (int i = optind; i < argc; i++) {
        if (settings->operand_count >= command->max_operands || settings->operand_count >= PM__MAX_OPERANDS)
            return pm__fail(error, PM_EINVAL, "unexpected argument '%.80s'", argv[i]);
        settings->operands[settings->operand_count++] = argv[i];
    }
    return PM_OK;
}

/* Two kinds of data cannot share a stream. */
static pm_status check_outputs(const pm__settings *settings, pm_error *error)
{
    const char *const names[] = {"--json", "--csv", "--markdown", "-o"};
    const char *const paths[] = {settings->json, settings->csv, settings->markdown, settings->output};
    for (size_t i = 0; i < 4; i++)
        for (size_t j = 0; j < i; j++)
            if (paths[i] && paths[j] && pm__same_file(paths[i], paths[j]) && strcmp(paths[i], "/dev/null") != 0)
                return pm__fail(error, PM_EINVAL, "%s and %s both write to '%.200s'", names[j], names[i], paths[i]);
    return PM_OK;
}

void pm__write_word(FILE *file, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:,=+@%";
    if (*word && !word[strspn(word, plain)]) {
        (void)fputs(word, file);
        return;
    }
    (void)fputc('\'', file);
    for (; *word; word++)
        (void)fputs(*word == '\'' ? "'\\''" : (const char[]){*word, '\0'}, file);
    (void)fputc('\'', file);
}

/* Before getopt reorders the words. */
static pm_status keep_command_line(int argc, char **argv, pm__settings *settings, pm_error *error)
{
    size_t size = 0;
    free(settings->command_line);
    settings->command_line = NULL;
    FILE *const file = open_memstream(&settings->command_line, &size);
    if (!file)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    (void)fputs("photonbench", file);
    for (int i = 0; i < argc; i++) {
        (void)fputc(' ', file);
        pm__write_word(file, argv[i]);
    }
    return fclose(file) == 0 ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory");
}

pm_status pm__options_parse(const pm__command *command, int argc, char **argv, pm__settings *settings, pm_error *error)
{
    grammar g;
    const pm_status kept = keep_command_line(argc, argv, settings, error);
    if (kept)
        return kept;
    grammar_init(&g, command);
    opterr = 0;
    optind = 0; /* GNU: start afresh */
    for (;;) {
        optopt = 0;
        const int code = getopt_long(argc, argv, g.letters, g.longs, NULL);
        if (code == -1)
            break;
        if (code == '?' || code == ':')
            return refuse(&g, code, argv[optind - 1], error);
        const pm_status status = take(grammar_find(&g, code), settings, optarg, error);
        if (status)
            return status;
        if (settings->help)
            return PM_OK;
    }
    const pm_status status = take_operands(command, argc, argv, settings, error);
    return status ? status : check_outputs(settings, error);
}
