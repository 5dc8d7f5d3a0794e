/* Runs build/photonbench as a user would. */
#ifndef PM_TESTS_PROGRAM_H
#define PM_TESTS_PROGRAM_H

#include "files.h"
#include "test.h"

#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>

#ifndef PM_BUILD
#define PM_BUILD "build"
#endif

enum { PM__OUTPUT_SIZE = 1 << 20, PM__MAX_ARGUMENTS = 40 };

typedef struct pm__run {
    int status; /* of exit; 128 + the signal where one ended it */
    char out[PM__OUTPUT_SIZE], err[1 << 16];
} pm__run;

static pm__run pm__last_run;

/* Splits at blanks; the words live in `line`. */
static inline void pm__split(char *line, char **words)
{
    size_t count = 0;
    words[count++] = (char *)(uintptr_t) "photonbench";
    for (char *word = strtok(line, " "); word && count + 1 < PM__MAX_ARGUMENTS; word = strtok(NULL, " "))
        words[count++] = word;
    words[count] = NULL;
}

static inline void pm__exec(const char *arguments)
{
    char line[4096], *words[PM__MAX_ARGUMENTS];
    (void)snprintf(line, sizeof line, "%s", arguments);
    pm__split(line, words);
    (void)execv(PM_BUILD "/photonbench", words);
    _exit(127);
}

static inline void pm__redirect(int fd, const char *path)
{
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (file < 0 || dup2(file, fd) < 0)
        _exit(126);
    (void)close(file);
}

/* Signals as a terminal's shell leaves them: nohup and background jobs ignore some, and the program would too. */
static inline void pm__reset_signals(void)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    sigset_t none;
    (void)sigemptyset(&none);
    (void)sigprocmask(SIG_SETMASK, &none, NULL);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        (void)signal(signals[i], SIG_DFL);
}

/* Starts the program; arguments separated by blanks. out: where standard output goes. */
static inline pid_t pm__start(const char *arguments, const char *out, const char *err)
{
    const pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        pm__redirect(STDOUT_FILENO, out);
        pm__redirect(STDERR_FILENO, err);
        pm__reset_signals();
        pm__exec(arguments);
    }
    return child;
}

static inline int pm__wait(pid_t child)
{
    int status;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* Runs and waits; the result lives until the next run. */
static inline const pm__run *pm__run_program(const char *arguments)
{
    const pm__test_directory place = pm__test_directory_create();
    char out[PM__TEST_PATH], err[PM__TEST_PATH];
    (void)pm__test_path(&place, "out", out);
    (void)pm__test_path(&place, "err", err);
    pm__last_run.status = pm__wait(pm__start(arguments, out, err));
    (void)pm__test_read(out, pm__last_run.out, sizeof pm__last_run.out);
    (void)pm__test_read(err, pm__last_run.err, sizeof pm__last_run.err);
    pm__test_directory_remove(&place);
    return &pm__last_run;
}

/* Runs; fails the test unless the status is `status` and standard error holds `part` (NULL: nothing at all). */
static inline const pm__run *pm__expect(const char *arguments, int status, const char *part)
{
    const pm__run *const run = pm__run_program(arguments);
    ck_assert_msg(run->status == status, "photonbench %s: status %d, not %d: %.2000s", arguments, run->status, status,
                  run->err);
    if (part)
        ck_assert_msg(strstr(run->err, part) != NULL, "photonbench %s: '%.2000s' lacks '%s'", arguments, run->err,
                      part);
    else
        ck_assert_msg(!*run->err, "photonbench %s: unexpected message '%.2000s'", arguments, run->err);
    return run;
}

/* What a run printed with --json -, parsed; the caller's. */
static inline json_t *pm__expect_json(const char *arguments)
{
    json_error_t error;
    const pm__run *const run = pm__expect(arguments, 0, NULL);
    json_t *const root = json_loads(run->out, JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(root != NULL, "photonbench %s: line %d: %s", arguments, error.line, error.text);
    return root;
}

/* The keys of an object are exactly these, separated by blanks, in this order. */
static inline void pm__check_keys(json_t *object, const char *want)
{
    char got[2000] = "";
    const char *key;
    json_t *value;
    json_object_foreach(object, key, value) {
        ck_assert_uint_lt(strlen(got) + strlen(key) + 2, sizeof got);
        (void)strcat(strcat(got, *got ? " " : ""), key);
    }
    ck_assert_str_eq(got, want);
}

#endif
