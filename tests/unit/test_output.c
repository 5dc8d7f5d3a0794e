/* Output files are complete or absent, and every failure is told. */
#include "../../src/base/output.h"

#include "../files.h"
#include "../test.h"

#include <fcntl.h>
#include <sys/stat.h>

static pm__test_directory directory;
static char path[PM__TEST_PATH];

static const char *in_directory(const char *name)
{
    if (!directory.path[0])
        directory = pm__test_directory_create();
    return pm__test_path(&directory, name, path);
}

static void check_content(const char *name, const char *want)
{
    char got[256], full[PM__TEST_PATH];
    ck_assert_int_ge(pm__test_read(pm__test_path(&directory, name, full), got, sizeof got), 0);
    ck_assert_str_eq(got, want);
}

static void write_whole(const char *name, const char *text)
{
    pm__output out;
    pm_error error = {""};
    PM_CHECK_OK(pm__output_open(in_directory(name), &out, &error), error);
    (void)fputs(text, out.file);
    PM_CHECK_OK(pm__output_commit(&out, &error), error);
    ck_assert_ptr_null(out.file);
    pm__output_discard(&out);
    check_content(name, text);
}

static int mode_of(const char *name)
{
    struct stat status;
    ck_assert_int_eq(stat(in_directory(name), &status), 0);
    return (int)(status.st_mode & 0777);
}

START_TEST(new_and_replaced)
{
    (void)umask(027);
    write_whole("new", "first\n");
    ck_assert_int_eq(mode_of("new"), 0640);
    ck_assert_int_eq(chmod(in_directory("new"), 0600), 0);
    write_whole("new", "second\n");
    ck_assert_int_eq(mode_of("new"), 0600);
    ck_assert_int_eq(pm__test_directory_entries(&directory, 0), 1);
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(discarded)
{
    pm__output out;
    pm_error error = {""};
    write_whole("kept", "old\n");
    PM_CHECK_OK(pm__output_open(in_directory("kept"), &out, &error), error);
    (void)fputs("half of the ne", out.file);
    (void)fflush(out.file);
    check_content("kept", "old\n");
    ck_assert_int_eq(pm__test_directory_entries(&directory, 0), 2);
    pm__output_discard(&out);
    check_content("kept", "old\n");
    PM_CHECK_OK(pm__output_open(in_directory("never"), &out, &error), error);
    (void)fputs("something", out.file);
    pm__output_discard(&out);
    pm__output_discard(&out);
    ck_assert_int_eq(pm__test_directory_entries(&directory, 0), 1);
    pm__test_directory_remove(&directory);
}
END_TEST

/* The name that a killed process leaves behind. */
START_TEST(temporary_name)
{
    pm__output out;
    pm_error error = {""};
    PM_CHECK_OK(pm__output_open(in_directory("result.json"), &out, &error), error);
    char pattern[PM__TEST_PATH];
    (void)pm__test_path(&directory, ".result.json.", pattern);
    ck_assert_int_eq(strncmp(out.temporary, pattern, strlen(pattern)), 0);
    ck_assert_uint_eq(strlen(out.temporary), strlen(pattern) + strlen("XXXXXX.tmp"));
    ck_assert_str_eq(out.temporary + strlen(pattern) + 6, ".tmp");
    pm__output_discard(&out);
    char longest[256];
    memset(longest, 'n', sizeof longest);
    longest[255] = '\0';
    write_whole(longest, "a name of 255 bytes\n");
    pm__test_directory_remove(&directory);
}
END_TEST

static void link_to(const char *target, const char *name)
{
    ck_assert_int_eq(symlink(target, in_directory(name)), 0);
}

static bool is_link(const char *name)
{
    struct stat status;
    return lstat(in_directory(name), &status) == 0 && S_ISLNK(status.st_mode);
}

START_TEST(links_followed)
{
    write_whole("target", "old\n");
    char first[PM__TEST_PATH];
    link_to("target", "first");
    link_to(pm__test_path(&directory, "first", first), "second");
    write_whole("second", "through two links\n");
    check_content("target", "through two links\n");
    ck_assert(is_link("first") && is_link("second") && !is_link("target"));
    link_to("not-yet", "dangling");
    write_whole("dangling", "made\n");
    check_content("not-yet", "made\n");
    ck_assert(is_link("dangling") && !is_link("not-yet"));
    ck_assert_int_eq(pm__test_directory_entries(&directory, 0), 5);
    pm__test_directory_remove(&directory);
}
END_TEST

static void refuse_open(const char *where, const char *reason)
{
    pm__output out;
    pm_error error = {""};
    ck_assert_int_eq(pm__output_open(where, &out, &error), PM_EIO);
    ck_assert_ptr_null(out.file);
    ck_assert_msg(strstr(error.text, where) != NULL, "%s", error.text);
    ck_assert_msg(strstr(error.text, reason) != NULL, "%s", error.text);
}

START_TEST(refused)
{
    pm__output out;
    refuse_open(in_directory("no/such/directory"), "No such file or directory");
    refuse_open(directory.path, "Is a directory");
    refuse_open("", "No such file or directory");
    link_to("loop", "loop");
    refuse_open(in_directory("loop"), "Too many levels of symbolic links");
    write_whole("plain", "x");
    refuse_open(in_directory("plain/below"), "Not a directory");
    ck_assert_int_eq(pm__output_open(NULL, &out, NULL), PM_EINVAL);
    if (geteuid() != 0) {
        ck_assert_int_eq(chmod(in_directory("plain"), 0444), 0);
        refuse_open(in_directory("plain"), "Permission denied");
    }
    ck_assert_int_eq(pm__test_directory_entries(&directory, 0), 2);
    pm__test_directory_remove(&directory);
}
END_TEST

/* A device is written in place; what it refuses is told, whether little or much was written. */
START_TEST(full_device)
{
    const int lines[] = {1, 100000};
    for (int i = 0; i < 2; i++)
        for (int block = 0; block < 2; block++) {
            pm__output out;
            pm_error error = {""};
            static const char zeros[1 << 17];
            PM_CHECK_OK(pm__output_open("/dev/full", &out, &error), error);
            for (int n = 0; n < lines[i]; n++)
                (void)fputs("some text\n", out.file);
            if (block)
                (void)fwrite(zeros, 1, sizeof zeros, out.file);
            ck_assert_int_eq(pm__output_commit(&out, &error), PM_EIO);
            ck_assert_msg(strstr(error.text, "/dev/full") && strstr(error.text, "No space left on device"), "%s",
                          error.text);
            ck_assert_ptr_null(out.file);
        }
    struct stat status;
    ck_assert(stat("/dev/full", &status) == 0 && S_ISCHR(status.st_mode));
}
END_TEST

/* A failed write of a regular file leaves the old one. */
START_TEST(failed_write)
{
    pm__output out;
    pm_error error = {""};
    write_whole("kept", "old\n");
    PM_CHECK_OK(pm__output_open(in_directory("kept"), &out, &error), error);
    const int full = open("/dev/full", O_WRONLY);
    ck_assert_int_ge(dup2(full, fileno(out.file)), 0);
    (void)close(full);
    for (int i = 0; i < 100000; i++)
        (void)fputs("new\n", out.file);
    ck_assert_int_eq(pm__output_commit(&out, &error), PM_EIO);
    ck_assert_msg(strstr(error.text, "No space left on device") != NULL, "%s", error.text);
    check_content("kept", "old\n");
    ck_assert_int_eq(pm__test_directory_entries(&directory, 0), 1);
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(pipe_in_place)
{
    pm__output out;
    pm_error error = {""};
    char got[64];
    ck_assert_int_eq(mkfifo(in_directory("fifo"), 0600), 0);
    const int reader = open(path, O_RDONLY | O_NONBLOCK);
    ck_assert_int_ge(reader, 0);
    PM_CHECK_OK(pm__output_open(path, &out, &error), error);
    (void)fputs("through", out.file);
    PM_CHECK_OK(pm__output_commit(&out, &error), error);
    ck_assert_int_eq((int)read(reader, got, sizeof got), 7);
    (void)close(reader);
    struct stat status;
    ck_assert(stat(path, &status) == 0 && S_ISFIFO(status.st_mode));
    pm__test_directory_remove(&directory);
}
END_TEST

/* As /dev/stdout with the output redirected to a file: the open file itself gets the text. */
START_TEST(open_descriptor)
{
    pm__output out;
    pm_error error = {""};
    char name[64];
    const int fd = open(in_directory("redirected"), O_RDWR | O_CREAT, 0600);
    ck_assert_int_eq((int)write(fd, "before\n", 7), 7);
    (void)snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
    PM_CHECK_OK(pm__output_open(name, &out, &error), error);
    (void)fputs("after\n", out.file);
    PM_CHECK_OK(pm__output_commit(&out, &error), error);
    check_content("redirected", "before\nafter\n");
    struct stat by_name, by_fd;
    ck_assert(stat(in_directory("redirected"), &by_name) == 0 && fstat(fd, &by_fd) == 0);
    ck_assert_uint_eq(by_name.st_ino, by_fd.st_ino);
    (void)close(fd);
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(names_in_messages)
{
    char text[PM__NAME_SIZE], quote[PM__QUOTE_SIZE], long_path[1000];
    pm__quote_path("a\nb\033[1m\x7f" "c", text);
    ck_assert_str_eq(text, "a?b?[1m?c");
    memset(long_path, 'd', sizeof long_path);
    memcpy(long_path + sizeof long_path - 6, "/name", 6);
    pm__quote_path(long_path, text);
    ck_assert_uint_eq(strlen(text), PM__NAME_SIZE - 1);
    ck_assert_int_eq(strncmp(text, "...d", 4), 0);
    ck_assert_str_eq(text + strlen(text) - 5, "/name");
    long_path[PM__NAME_SIZE - 1] = '\0';
    pm__quote_path(long_path, text);
    ck_assert_str_eq(text, long_path);
    pm__quote("x\0\xff y", 5, quote);
    ck_assert_str_eq(quote, "x?? y");
    pm__quote(long_path, 100, quote);
    ck_assert_uint_eq(strlen(quote), PM__QUOTE_SIZE - 1);
    ck_assert_str_eq(quote + strlen(quote) - 4, "d...");
}
END_TEST

PM_TEST_MAIN("output", new_and_replaced, discarded, temporary_name, links_followed, refused, full_device, failed_write,
             pipe_in_place, open_descriptor, names_in_messages)
