/* Commands of the program, run within the test, so that the faults of allocation.h and writing.h reach them. */
#ifndef PM_TESTS_FAULTS_COMMAND_H
#define PM_TESTS_FAULTS_COMMAND_H

#include "../../src/cli/commands.h"
#include "../../src/cli/refused.h"
#include "../files.h"
#include "../test.h"

#include <fcntl.h>
#include <jansson.h>
#include <stdbool.h>
#include <string.h>

enum { PM__WORDS = 60, PM__SAID = 4000 };

static pm__test_directory pm__place;
static char pm__said[PM__SAID]; /* by the last command, to standard error */

/* Standard output and error into files, and back. */
static inline int pm__divert_to(int fd, const char *path)
{
    const int kept = dup(fd), file = open(path, O_CREAT | O_TRUNC | O_RDWR, 0600);
    if (kept < 0 || file < 0 || dup2(file, fd) < 0)
        abort();
    (void)close(file);
    return kept;
}

static inline int pm__divert(int fd, const char *name)
{
    char path[PM__TEST_PATH];
    return pm__divert_to(fd, pm__test_path(&pm__place, name, path));
}

static inline void pm__restore(int fd, int kept)
{
    if (dup2(kept, fd) < 0)
        abort();
    (void)close(kept);
}

/* "accuracy --case square --json @rows.json": words parted by blanks, @ for the directory and a slash. */
static inline int pm__words(const char *line, char *room, size_t size, char *words[PM__WORDS])
{
    size_t used = 0;
    int count = 0;
    for (const char *c = line; *c; c++)
        used += (size_t)snprintf(room + used, size - used, "%.*s%s", *c == '@' ? PM__TEST_PATH : 1,
                                 *c == '@' ? pm__place.path : c, *c == '@' ? "/" : "");
    for (char *word = strtok(room, " "); word && count + 1 < PM__WORDS; word = strtok(NULL, " "))
        words[count++] = word;
    words[count] = NULL;
    return count;
}

static inline int pm__run_words(int count, char **words)
{
    const char *nearest;
    const pm__command *const command = pm__command_find(words[0], &nearest);
    pm__settings settings;
    pm_error error = {""};
    pm__refused_watch();
    pm__settings_init(&settings);
    const pm_status parsed = pm__options_parse(command, count, words, &settings, &error);
    if (parsed != PM_OK)
        pm__complain(command->name, "%s", error.text);
    const int status = parsed == PM_OK ? command->run(&settings) : pm__exit_status(parsed);
    pm__settings_free(&settings);
    return pm__finish_stdout(command->name, status);
}

/* What the last command said, into pm__said. */
static inline void pm__listen(void)
{
    char path[PM__TEST_PATH];
    (void)pm__test_read(pm__test_path(&pm__place, "err", path), pm__said, sizeof pm__said);
}

/* The exit status; what was printed is in the directory's files "out" and "err". */
static inline int pm__run_command(const char *line)
{
    static char room[8000];
    char *words[PM__WORDS];
    const int count = pm__words(line, room, sizeof room, words);
    (void)fflush(NULL);
    const int out = pm__divert(STDOUT_FILENO, "out"), err = pm__divert(STDERR_FILENO, "err");
    const int status = pm__run_words(count, words);
    (void)fflush(stdout);
    clearerr(stdout);
    pm__restore(STDOUT_FILENO, out);
    pm__restore(STDERR_FILENO, err);
    return status;
}

/* ---- What came ---------------------------------------------------------------------------------- */

static inline bool pm__is_of_the_clock(const char *key)
{
    static const char *const parts[] = {"ns_", "_ms", "seconds", "_s", "ratio", "samples", "load", "pareto",
                                        "efficiency", "governor"};
    bool is = false;
    const size_t length = strlen(key);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const char *const at = strstr(key, parts[i]);
        is = is || (at && (strcmp(parts[i], "_s") != 0 || at + 2 == key + length));
    }
    return is;
}

static inline void pm__forget_the_clock(json_t *value)
{
    const char *key;
    json_t *member;
    size_t i;
    void *next;
    json_object_foreach_safe(value, next, key, member) {
        if (pm__is_of_the_clock(key))
            (void)json_object_del(value, key);
        else
            pm__forget_the_clock(member);
    }
    json_array_foreach(value, i, member)
        pm__forget_the_clock(member);
}

/* The rows of a JSON file, but for what the clock says; freed by the caller. NULL: it is none. */
static inline char *pm__rows_of(const char *name)
{
    char path[PM__TEST_PATH];
    json_t *const root = json_load_file(pm__test_path(&pm__place, name, path), JSON_REJECT_DUPLICATES, NULL);
    if (!root)
        return NULL;
    pm__forget_the_clock(root);
    char *const text = json_dumps(root, JSON_COMPACT);
    json_decref(root);
    return text;
}

#endif
