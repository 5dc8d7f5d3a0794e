/* What goes wrong around the program: disks and pipes that end, little memory, a kill at any moment. Files are complete
 * or absent, the status is the right one, and what can be taken up again is. */
#include "../program.h"

#include <stdbool.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>

static pm__test_directory place;
static char file[PM__TEST_PATH], err[PM__TEST_PATH], said[4000];

static void set_up(const char *name)
{
    place = pm__test_directory_create();
    (void)pm__test_path(&place, name, file);
    (void)pm__test_path(&place, "err", err);
}

static void tear_down(void)
{
    pm__test_directory_remove(&place);
}

/* With the file's name behind it. */
static const char *with_file(const char *arguments)
{
    static char line[4 * PM__TEST_PATH];
    (void)snprintf(line, sizeof line, "%s%s", arguments, file);
    return line;
}

/* Starts it with as many bytes as given of what is limited; standard output goes nowhere. */
static pid_t start_within(const char *arguments, __rlimit_resource_t what, rlim_t bytes)
{
    const struct rlimit limit = {bytes, bytes};
    const pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        pm__redirect(STDOUT_FILENO, "/dev/null");
        pm__redirect(STDERR_FILENO, err);
        pm__reset_signals();
        (void)signal(SIGXFSZ, SIG_DFL);
        (void)signal(SIGPIPE, SIG_DFL);
        if (setrlimit(what, &limit) != 0)
            _exit(125);
        pm__exec(arguments);
    }
    return child;
}

static int run_within(const char *arguments, __rlimit_resource_t what, rlim_t bytes)
{
    const int status = pm__wait(start_within(arguments, what, bytes));
    ck_assert_int_ge(pm__test_read(err, said, sizeof said), 0);
    (void)unlink(err);
    return status;
}

static bool is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

static void check_nothing_left(const char *arguments)
{
    ck_assert_msg(pm__test_directory_entries(&place, 0) == 0, "%s: files are left: %s", arguments, said);
}

/* ---- Disks and pipes --------------------------------------------------------------------------- */

#define SMALL_SERIES "converge plate --passes 2 --trials 2 --photons-per-pass 50 --size 16x16 --k 5 --quiet "

static const char *const writers[] = {
    "list --json ", "list --csv ", "list -o ",
    "accuracy --case square --estimator disc,cone --k 5 --photons 50 --trials 2 --probes 4 --quiet --json ",
    "render cornell --size 32x32 --photons 50 --spp 1 --k 5 --quiet -o ",
    SMALL_SERIES "--checkpoint ",
    "stress --test single --estimator disc --quiet --json ",
};
enum { WRITERS = sizeof writers / sizeof *writers };

/* Nobody ignores the signal for it. */
START_TEST(files_may_not_grow)
{
    set_up("file");
    for (size_t i = 0; i < WRITERS; i++) {
        const char *const line = with_file(writers[i]);
        ck_assert_msg(run_within(line, RLIMIT_FSIZE, 1000) == 4, "%s: %s", line, said);
        ck_assert_msg(strstr(said, file) && strstr(said, "File too large"), "%s: %s", line, said);
        check_nothing_left(line);
        ck_assert_msg(run_within(line, RLIMIT_FSIZE, RLIM_INFINITY) == 0, "%s: %s", line, said);
        ck_assert(is_there(file));
        ck_assert_int_eq(unlink(file), 0);
    }
    tear_down();
}
END_TEST

/* Where no file can be: below a file, in folders that take none, in none at all. Nothing is computed first. */
START_TEST(nowhere_to_write)
{
    static const char *const kept = "what was there before";
    static const char *const places[] = {"/dev/null/file", "/proc/self/file", "/proc/file", "/nonexistent/file"};
    set_up("file");
    for (size_t i = 0; i < WRITERS; i++) {
        char path[PM__TEST_PATH];
        for (size_t p = 0; p < sizeof places / sizeof *places; p++) {
            (void)snprintf(file, sizeof file, "%s", places[p]);
            ck_assert_msg(run_within(with_file(writers[i]), RLIMIT_FSIZE, RLIM_INFINITY) == 4, "%s: %s", file, said);
            ck_assert_msg(strstr(said, file) && strstr(said, "cannot be opened for writing"), "%s", said);
        }
        pm__test_write(pm__test_path(&place, "plain", path), kept, strlen(kept));
        (void)snprintf(file, sizeof file, "%.400s/file", path);
        ck_assert_msg(run_within(with_file(writers[i]), RLIMIT_FSIZE, RLIM_INFINITY) == 4, "%s: %s", file, said);
        char content[100];
        ck_assert_int_eq(pm__test_read(path, content, sizeof content), (long)strlen(kept));
        ck_assert_int_eq(unlink(path), 0);
        check_nothing_left(writers[i]);
    }
    tear_down();
}
END_TEST

/* A reader that has gone away ends nothing: files are whole, and the status tells. */
START_TEST(broken_pipe)
{
    int ends[2];
    set_up("rows.json");
    const char *const line = with_file("list --json ");
    char both[5 * PM__TEST_PATH];
    (void)snprintf(both, sizeof both, "%s -o -", line);
    ck_assert_int_eq(pipe(ends), 0);
    (void)close(ends[0]);
    const pid_t child = fork();
    if (child == 0) {
        (void)dup2(ends[1], STDOUT_FILENO);
        pm__redirect(STDERR_FILENO, err);
        (void)signal(SIGPIPE, SIG_DFL);
        pm__exec(both);
    }
    (void)close(ends[1]);
    ck_assert_int_eq(pm__wait(child), 4);
    ck_assert_int_gt(pm__test_read(err, said, sizeof said), 0);
    ck_assert_msg(strstr(said, "standard output: Broken pipe") != NULL, "%s", said);
    json_t *const root = json_load_file(file, 0, NULL);
    ck_assert_ptr_nonnull(root);
    json_decref(root);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 2);
    tear_down();
}
END_TEST

/* ---- Little memory ----------------------------------------------------------------------------- */

/* Sanitizers keep tables of terabytes, which no limit of memory leaves room for. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MEMORY_CAN_BE_LIMITED 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MEMORY_CAN_BE_LIMITED 0
#endif
#endif
#ifndef MEMORY_CAN_BE_LIMITED
#define MEMORY_CAN_BE_LIMITED 1
#endif

enum { MEGABYTE = 1 << 20 };

/* What a series had come to is kept, and can be gone on from. */
static void check_resumes(void)
{
    char line[3 * PM__TEST_PATH];
    if (!is_there(file))
        return;
    (void)snprintf(line, sizeof line, SMALL_SERIES "--resume %s", file);
    ck_assert_msg(run_within(line, RLIMIT_AS, RLIM_INFINITY) == 0, "%s: %s", line, said);
    (void)unlink(file);
}

/* Done, or out of memory with nothing left behind. */
static int run_in_memory(const char *line, rlim_t megabytes)
{
    const int status = run_within(line, RLIMIT_AS, megabytes * MEGABYTE);
    ck_assert_msg(status == 0 || (status == 4 && strstr(said, "memory")), "%s: in %ju MB: status %d: %s", line,
                  (uintmax_t)megabytes, status, said);
    ck_assert_msg(status == 4 || is_there(file), "%s: no file", line);
    if (strstr(line, "--checkpoint"))
        check_resumes();
    if (status == 0)
        (void)unlink(file);
    check_nothing_left(line);
    return status;
}

/* 127: no room for the libraries; the program had not begun. */
static rlim_t least_memory(void)
{
    rlim_t megabytes = 64;
    while (run_within("--version", RLIMIT_AS, megabytes * MEGABYTE) == 127 && megabytes < 1024)
        megabytes += 16;
    return megabytes;
}

/* As little as the program begins in (64 MB, if its libraries fit), and more until all is well. */
START_TEST(little_memory)
{
    static const char *const more[] = {
        "accuracy --case square --estimator disc --trials 2 --threads 8 --quiet --json ",
        "render cornell --size 64x64 --spp 1 --photons 2000 --threads 2 --quiet -o ",
        "search --photons 3000000 --search wide --samples 1 --threads 2 --quiet --json ",
        "render water --size 4096x4096 --spp 1 --photons 100 --quiet -o ",
    };
    set_up("file");
    if (MEMORY_CAN_BE_LIMITED) {
        const rlim_t least = least_memory();
        ck_assert_int_eq(run_in_memory(with_file("list --json "), least + 16), 0);
        for (size_t i = 0; i < WRITERS; i++)
            (void)run_in_memory(with_file(writers[i]), least);
        for (size_t i = 0; i < sizeof more / sizeof *more; i++)
            for (rlim_t megabytes = least; megabytes < 300; megabytes += 20)
                if (run_in_memory(with_file(more[i]), megabytes) == 0)
                    break;
    }
    tear_down();
}
END_TEST

/* ---- Killed ------------------------------------------------------------------------------------ */

/* "file", or ".file.XXXXXX.tmp" that a kill left. */
static void check_names(void)
{
    DIR *const stream = opendir(place.path);
    for (const struct dirent *entry; (entry = readdir(stream));) {
        const char *const name = entry->d_name;
        const bool temporary = strlen(name) == strlen(".file.123456.tmp") && strncmp(name, ".file.", 6) == 0 &&
                               strcmp(name + 12, ".tmp") == 0;
        ck_assert_msg(temporary || !strcmp(name, "file") || !strcmp(name, "err") || !strcmp(name, ".") ||
                          !strcmp(name, ".."), "%s is left", name);
        if (temporary) {
            char path[PM__TEST_PATH];
            (void)unlink(pm__test_path(&place, name, path));
        }
    }
    (void)closedir(stream);
}

static void pause_us(long us)
{
    const struct timespec t = {0, us * 1000};
    (void)nanosleep(&t, NULL);
}

/* Killed after ever longer; the file that was there is it still, or the new one is, whole. */
START_TEST(killed_while_writing)
{
    static char was[1 << 20], is[1 << 20];
    unsigned killed = 0, ended = 0;
    set_up("file");
    ck_assert_int_eq(run_within(with_file("list --json "), RLIMIT_FSIZE, RLIM_INFINITY), 0);
    for (long us = 1000; (ended < 3 || killed < 20) && us < 900000; us += 500 + us / 20) {
        const bool existing = us / 1000 % 2 == 0;
        const long size = existing ? pm__test_read(file, was, sizeof was) : 0;
        if (!existing)
            (void)unlink(file);
        const pid_t child = start_within(with_file("list --json "), RLIMIT_FSIZE, RLIM_INFINITY);
        pause_us(us);
        (void)kill(child, SIGKILL);
        const int status = pm__wait(child);
        killed += status == 128 + SIGKILL;
        ended += status == 0;
        const long now = pm__test_read(file, is, sizeof is);
        ck_assert_msg(now >= 0 || !existing, "the file that was there is gone");
        if (now >= 0 && (!existing || now != size || memcmp(was, is, (size_t)size) != 0)) {
            json_t *const root = json_loads(is, JSON_REJECT_DUPLICATES, NULL);
            ck_assert_msg(root != NULL, "a part of a file after %ld us", us);
            json_decref(root);
        }
        check_names();
        if (now < 0)
            ck_assert_int_eq(run_within(with_file("list --json "), RLIMIT_FSIZE, RLIM_INFINITY), 0);
    }
    ck_assert_msg(killed >= 3 && ended >= 3, "%u killed, %u ended by themselves", killed, ended);
    tear_down();
}
END_TEST

/* ---- Resumed ----------------------------------------------------------------------------------- */

#define SERIES "converge plate --method ppm,pppm --trials 2 --passes 20 --photons-per-pass 200 --size 8x8 --k 20 " \
               "--threads 1 --quiet "
#define OFTEN "--checkpoint-seconds 0.001 "

static json_t *rows_of(const char *path)
{
    json_t *const root = json_load_file(path, 0, NULL);
    ck_assert_ptr_nonnull(root);
    json_t *const rows = json_incref(json_object_get(root, "rows"));
    size_t i;
    json_t *row;
    json_array_foreach(rows, i, row)
        (void)json_object_del(row, "seconds");
    json_decref(root);
    return rows;
}

/* The disk is full again and again, a bit later each time; what was saved goes on. */
START_TEST(full_disk_and_resumed)
{
    char rows[PM__TEST_PATH], line[4 * PM__TEST_PATH];
    int failures = 0, status = 4;
    set_up("file");
    (void)snprintf(line, sizeof line, SERIES "--json %s", pm__test_path(&place, "rows", rows));
    ck_assert_int_eq(run_within(line, RLIMIT_FSIZE, RLIM_INFINITY), 0);
    json_t *const want = rows_of(rows);
    for (rlim_t bytes = 400; status == 4 && bytes < 10000000; bytes += bytes / 2) {
        (void)snprintf(line, sizeof line, SERIES OFTEN "--json %s %s %s", rows,
                       is_there(file) ? "--resume" : "--checkpoint", file);
        (void)unlink(rows);
        status = run_within(line, RLIMIT_FSIZE, bytes);
        ck_assert_msg(status == 0 || (status == 4 && strstr(said, "File too large")), "%s: %d: %s", line, status, said);
        ck_assert_msg(is_there(rows) == (status == 0), "%s: rows", line);
        failures += status == 4;
    }
    ck_assert_int_eq(status, 0);
    ck_assert_int_ge(failures, 3);
    json_t *const got = rows_of(rows);
    ck_assert_msg(json_equal(want, got), "the rows differ: %.500s", json_dumps(got, JSON_COMPACT));
    json_decref(want);
    json_decref(got);
    tear_down();
}
END_TEST

PM_TEST_MAIN("cli faults", files_may_not_grow, nowhere_to_write, broken_pipe, little_memory, killed_while_writing,
             full_disk_and_resumed)
