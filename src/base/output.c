#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_LINKS = 40, MAX_TRIES = 100, SUFFIX = 6, MAX_STEM = 200 };

static pm_status fail(const pm__output *output, int number, const char *doing, pm_error *error)
{
    return pm__fail(error, number == ENOMEM ? PM_ENOMEM : PM_EIO, "%s: %s: %s", output->name, doing,
                    strerror(number));
}

/* The length of the directory part, with its slash; 0 for a bare name. */
static size_t directory_length(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* What the link at `path` points to, seen from where `path` is seen; freed by the caller. NULL with errno:
 * EINVAL if it is no link. */
static char *follow_link(const char *path)
{
    char link[PATH_MAX];
    const ssize_t length = readlink(path, link, sizeof link - 1);
    if (length < 0)
        return NULL;
    link[length] = '\0';
    const size_t directory = link[0] == '/' ? 0 : directory_length(path);
    char *const next = malloc(directory + (size_t)length + 1);
    if (!next)
        return NULL;
    memcpy(next, path, directory);
    memcpy(next + directory, link, (size_t)length + 1);
    return next;
}

static bool is_magic(const char *path)
{
    return strncmp(path, "/proc/", 6) == 0;
}

/* The name behind all links, which need not exist; freed by the caller. realpath() would refuse a dangling link,
 * which open() with O_CREAT follows. NULL with errno. */
static char *resolve(const char *path)
{
    char *current = strdup(path);
    for (int i = 0; current && i < MAX_LINKS; i++) {
        /* The links there stand for open files, not for names. */
        if (is_magic(current))
            return current;
        char *const next = follow_link(current);
        if (!next && (errno == EINVAL || errno == ENOENT))
            return current;
        free(current);
        current = next;
        if (!next)
            return NULL;
    }
    if (current)
        errno = ELOOP;
    free(current);
    return NULL;
}

static void random_suffix(char text[SUFFIX], unsigned attempt)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz012345";
    unsigned char bytes[SUFFIX];
    /* Uniqueness comes from O_EXCL; the numbers only make a collision rare. */
    if (getrandom(bytes, sizeof bytes, GRND_NONBLOCK) != (ssize_t)sizeof bytes)
        for (int i = 0; i < SUFFIX; i++)
            bytes[i] = (unsigned char)((unsigned)getpid() >> (5 * i) ^ attempt);
    for (int i = 0; i < SUFFIX; i++)
        text[i] = letters[bytes[i] % 32];
}

/* Creates `.NAME.XXXXXX.tmp` beside the target: a descriptor, or -1 with errno. */
static int create_temporary(pm__output *output)
{
    const size_t directory = directory_length(output->target);
    const char *const name = output->target + directory;
    const size_t stem = strnlen(name, MAX_STEM);
    char *const path = malloc(directory + stem + SUFFIX + sizeof "...tmp");
    if (!path)
        return -1;
    memcpy(path, output->target, directory);
    path[directory] = '.';
    memcpy(path + directory + 1, name, stem);
    char *const suffix = path + directory + 1 + stem;
    suffix[0] = '.';
    memcpy(suffix + 1 + SUFFIX, ".tmp", 5);
    for (unsigned attempt = 0; attempt < MAX_TRIES; attempt++) {
        random_suffix(suffix + 1, attempt);
        const int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0) {
            output->temporary = path;
            return fd;
        }
        if (errno != EEXIST)
            break;
    }
    free(path);
    return -1;
}

/* A private file must not become public by being rewritten. */
static int open_beside(pm__output *output, const struct stat *existing)
{
    if (existing && access(output->target, W_OK) != 0)
        return -1;
    const int fd = create_temporary(output);
    if (fd >= 0 && existing)
        (void)fchmod(fd, existing->st_mode & 0777);
    return fd;
}

static int open_descriptor(const char *path, pm__output *output)
{
    struct stat status;
    const bool exists = stat(path, &status) == 0;
    if (!exists && errno != ENOENT)
        return -1;
    if (!*path || (exists && S_ISDIR(status.st_mode))) {
        errno = *path ? EISDIR : ENOENT;
        return -1;
    }
    if (exists && !S_ISREG(status.st_mode))
        return open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
    char *const target = resolve(path);
    if (!target)
        return -1;
    if (is_magic(target)) {
        free(target);
        return open(path, O_WRONLY | O_CLOEXEC | O_APPEND);
    }
    output->target = target;
    return open_beside(output, exists ? &status : NULL);
}

/* Leaves *output closed, its file gone unless it was committed. */
static void release(pm__output *output)
{
    if (output->temporary)
        (void)unlink(output->temporary);
    free(output->temporary);
    free(output->target);
    memset(output, 0, sizeof *output);
}

pm_status pm__output_open(const char *path, pm__output *output, pm_error *error)
{
    memset(output, 0, sizeof *output);
    if (!path)
        return pm__fail(error, PM_EINVAL, "an output file needs a path");
    pm__quote_path(path, output->name);
    const int fd = open_descriptor(path, output);
    if (fd >= 0)
        output->file = fdopen(fd, "wb");
    if (output->file)
        return PM_OK;
    const pm_status status = fail(output, errno, "cannot be opened for writing", error);
    if (fd >= 0)
        (void)close(fd);
    release(output);
    return status;
}

/* 0, or the error number of what went wrong since opening. */
static int close_checked(FILE *file)
{
    const bool failed = ferror(file) != 0;
    errno = 0;
    /* stdio forgets the number of an earlier failure: one more byte to the spoilt file brings it back. */
    if (failed && fputc('\n', file) == EOF && !errno)
        errno = EIO;
    int number = fflush(file) != 0 || errno ? errno : 0;
    if (fclose(file) != 0 && !number)
        number = errno;
    return failed && !number ? EIO : number;
}

pm_status pm__output_commit(pm__output *output, pm_error *error)
{
    pm_status status = PM_OK;
    const int number = close_checked(output->file);
    if (number)
        status = fail(output, number, "cannot be written", error);
    else if (output->temporary && rename(output->temporary, output->target) != 0)
        status = fail(output, errno, "cannot be replaced", error);
    if (status == PM_OK) {
        free(output->temporary);
        output->temporary = NULL;
    }
    release(output);
    return status;
}

void pm__output_discard(pm__output *output)
{
    if (output->file)
        (void)fclose(output->file);
    release(output);
}
