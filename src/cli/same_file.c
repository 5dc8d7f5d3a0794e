#include "same_file.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The folder of a path, without links and dots; false: there is none. */
static bool folder_of(const char *path, char folder[PATH_MAX])
{
    char part[PATH_MAX];
    const char *const slash = strrchr(path, '/');
    const int length = slash ? (int)(slash - path) + 1 : 1;
    const int written = snprintf(part, sizeof part, "%.*s", length, slash ? path : ".");
    return written > 0 && written < PATH_MAX && realpath(part, folder);
}

static const char *name_of(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool pm__same_file(const char *a, const char *b)
{
    struct stat of_a, of_b;
    char folder_a[PATH_MAX], folder_b[PATH_MAX];
    if (strcmp(a, b) == 0)
        return true;
    if (strcmp(a, "-") == 0 || strcmp(b, "-") == 0)
        return false;
    const bool a_there = stat(a, &of_a) == 0, b_there = stat(b, &of_b) == 0;
    if (a_there && b_there)
        return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
    return a_there == b_there && strcmp(name_of(a), name_of(b)) == 0 && folder_of(a, folder_a) &&
           folder_of(b, folder_b) && strcmp(folder_a, folder_b) == 0;
}
