/* Writes that fail at the nth byte, for every n of small files and for many of large ones: the status is 4, or PM_EIO,
 * the message names the file and the reason, nothing is left behind, and a file that was there stays as it was.
 *
 * The system does it: beyond RLIMIT_FSIZE a write comes back short, and then with EFBIG, as on a full disk with
 * ENOSPC. */
#include "../../src/base/output.h"
#include "../../src/image/image.h"
#include "../../src/image/png.h"
#include "command.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>

static const char old[] = "what was there before";

/* No file may be longer than so many bytes. RLIM_INFINITY: any. */
static void limit_files(rlim_t bytes)
{
    struct rlimit limit;
    ck_assert_int_eq(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes;
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

/* Standard error within limits: a pipe is no file, and holds more than is said. */
typedef struct hearing {
    int kept, pipe[2];
} hearing;

static hearing hear(void)
{
    hearing h = {.kept = dup(STDERR_FILENO)};
    ck_assert_int_eq(pipe(h.pipe), 0);
    ck_assert_int_ge(dup2(h.pipe[1], STDERR_FILENO), 0);
    return h;
}

static void hear_out(hearing *h)
{
    (void)fflush(stderr);
    pm__restore(STDERR_FILENO, h->kept);
    (void)close(h->pipe[1]);
    const ssize_t count = read(h->pipe[0], pm__said, sizeof pm__said - 1);
    pm__said[count > 0 ? count : 0] = '\0';
    (void)close(h->pipe[0]);
}

static char room[8000];

/* Exit status of a command whose files may have `bytes` bytes. */
static int run_within(const char *line, rlim_t bytes)
{
    char *words[PM__WORDS];
    const int count = pm__words(line, room, sizeof room, words);
    (void)fflush(NULL);
    const int out = pm__divert_to(STDOUT_FILENO, "/dev/null");
    hearing h = hear();
    limit_files(bytes);
    const int status = pm__run_words(count, words);
    limit_files(RLIM_INFINITY);
    pm__restore(STDOUT_FILENO, out);
    hear_out(&h);
    return status;
}

static long size_of(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 ? (long)about.st_size : -1;
}

/* The next n to try: all up to 64, then each a bit farther than the last, so that some 200 reach any size. */
static long next(long n)
{
    return n < 64 || getenv("PM_FULL") ? n + 1 : n + 1 + n / 24;
}

static void set_up(const char *name, bool existing, char path[PM__TEST_PATH])
{
    (void)signal(SIGXFSZ, SIG_IGN);
    pm__place = pm__test_directory_create();
    (void)pm__test_path(&pm__place, name, path);
    if (existing)
        pm__test_write(path, old, sizeof old - 1);
}

/* After a failure. */
static void check_untouched(const char *what, long n, const char *path, bool existing)
{
    char content[100];
    ck_assert_msg(pm__test_directory_entries(&pm__place, 0) == (existing ? 1 : 0), "%s: byte %ld fails: files are left",
                  what, n);
    if (existing)
        ck_assert_msg(pm__test_read(path, content, sizeof content) == (long)sizeof old - 1 && !strcmp(content, old),
                      "%s: byte %ld fails: the file that was there is not as it was", what, n);
}

static void check_command_on(const char *line, const char *name, bool existing)
{
    char path[PM__TEST_PATH];
    long n = 0, failures = 0;
    int status;
    set_up(name, existing, path);
    while ((status = run_within(line, (rlim_t)n)) != PM__EXIT_DONE) {
        ck_assert_msg(status == PM__EXIT_OTHER, "%s: byte %ld fails: status %d, %s", line, n, status, pm__said);
        ck_assert_msg(strstr(pm__said, path) && strstr(pm__said, "File too large"), "%s: byte %ld fails: %s", line, n,
                      pm__said);
        check_untouched(line, n, path, existing);
        failures++;
        n = next(n);
    }
    ck_assert_msg(failures > 64 || failures >= size_of(path), "%s: only %ld failures", line, failures);
    ck_assert_msg(size_of(path) > 0 && size_of(path) <= n, "%s: %ld bytes within %ld", line, size_of(path), n);
    ck_assert_int_eq(pm__test_directory_entries(&pm__place, 0), 1);
    pm__test_directory_remove(&pm__place);
}

static void check_command(const char *line, const char *name)
{
    check_command_on(line, name, false);
    check_command_on(line, name, true);
}

#define SOME "accuracy --case square --estimator disc --k 5 --photons 50 --trials 2 --probes 4 --threads 1 --quiet "

START_TEST(rows_and_tables)
{
    check_command(SOME "--json @rows", "rows");
    check_command(SOME "--csv @rows", "rows");
    check_command(SOME "--markdown @rows", "rows");
    check_command(SOME "-o @table", "table");
}
END_TEST

START_TEST(images)
{
    check_command("render plate --size 20x20 --photons 50 --spp 1 --k 5 --threads 1 --quiet -o @image.exr",
                  "image.exr");
}
END_TEST

/* Whatever a checkpoint's fault is, it shows before the work, or leaves the one before. */
START_TEST(checkpoints)
{
    check_command("converge plate --passes 2 --trials 2 --photons-per-pass 50 --size 4x4 --k 5 --threads 1 --quiet "
                  "--checkpoint @state", "state");
}
END_TEST

/* ---- Functions --------------------------------------------------------------------------------- */

typedef pm_status (*writer)(const char *path, pm_error *error);

static void check_writer_on(const char *what, writer write, bool existing)
{
    char path[PM__TEST_PATH];
    pm_error error;
    set_up("file", existing, path);
    for (long n = 0;; n = next(n)) {
        *error.text = '\0';
        limit_files((rlim_t)n);
        const pm_status status = write(path, &error);
        limit_files(RLIM_INFINITY);
        if (status == PM_OK) {
            ck_assert_msg(n > 64 && size_of(path) > 0 && size_of(path) <= n, "%s: within %ld", what, n);
            break;
        }
        ck_assert_msg(status == PM_EIO, "%s: byte %ld fails: status %d", what, n, (int)status);
        ck_assert_msg(strstr(error.text, path) && strstr(error.text, "File too large"), "%s: byte %ld fails: %s",
                      what, n, error.text);
        check_untouched(what, n, path, existing);
    }
    pm__test_directory_remove(&pm__place);
}

static void check_writer(const char *what, writer write)
{
    check_writer_on(what, write, false);
    check_writer_on(what, write, true);
}

static pm_status write_photons(const char *path, pm_error *error)
{
    static pm_photon photons[300];
    return pm_ply_write_photons(path, photons, 300, error);
}

/* As the program writes pictures: what failed in the library is told by the file's close. */
static pm_status write_picture(const char *path, pm_error *error)
{
    static uint8_t pixels[40 * 40][3];
    uint32_t x = 1;
    for (size_t i = 0; i < 40 * 40; i++)
        for (int c = 0; c < 3; c++)
            pixels[i][c] = (uint8_t)((x = x * 1664525u + 1013904223u) >> 24);
    pm__output output;
    pm_status status = pm__output_open(path, &output, error);
    if (status != PM_OK)
        return status;
    status = pm__png_write(output.file, (const uint8_t(*)[3])pixels, 40, 40, "noise", NULL, error);
    const pm_status closed = pm__output_commit(&output, error);
    ck_assert_msg(status == PM_OK || closed != PM_OK, "a picture that failed is a file");
    return closed;
}

START_TEST(photon_files)
{
    check_writer("photons", write_photons);
}
END_TEST

START_TEST(pictures)
{
    check_writer("a picture", write_picture);
}
END_TEST

PM_TEST_MAIN("writes that fail", rows_and_tables, images, checkpoints, photon_files, pictures)
