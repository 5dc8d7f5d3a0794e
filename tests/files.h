/* A directory of one's own for tests that write files. */
#ifndef PM_TESTS_FILES_H
#define PM_TESTS_FILES_H

#include <check.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PM__TEST_PATH = 512 };

typedef struct pm__test_directory {
    char path[PM__TEST_PATH / 4];
} pm__test_directory;

static inline pm__test_directory pm__test_directory_create(void)
{
    pm__test_directory directory;
    const char *const wanted = getenv("TMPDIR");
    /* Where rewriting a small file many times does not wait for a disk. */
    const char *const base = wanted ? wanted : access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    (void)snprintf(directory.path, sizeof directory.path, "%s/pm-test-XXXXXX", base);
    ck_assert_ptr_nonnull(mkdtemp(directory.path));
    return directory;
}

/* How many entries the directory has; removes them (directories if empty) where asked. */
static inline int pm__test_directory_entries(const pm__test_directory *directory, int remove_them)
{
    int count = 0;
    DIR *const stream = opendir(directory->path);
    ck_assert_ptr_nonnull(stream);
    for (const struct dirent *entry; (entry = readdir(stream));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        count++;
        char path[PM__TEST_PATH];
        (void)snprintf(path, sizeof path, "%s/%s", directory->path, entry->d_name);
        if (remove_them)
            (void)remove(path);
    }
    (void)closedir(stream);
    return count;
}

static inline void pm__test_directory_remove(const pm__test_directory *directory)
{
    (void)pm__test_directory_entries(directory, 1);
    (void)rmdir(directory->path);
}

static inline const char *pm__test_path(const pm__test_directory *directory, const char *name,
                                        char path[PM__TEST_PATH])
{
    (void)snprintf(path, PM__TEST_PATH, "%s/%s", directory->path, name);
    return path;
}

static inline void pm__test_write(const char *path, const void *bytes, size_t count)
{
    FILE *const file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(bytes, 1, count, file), count);
    ck_assert_int_eq(fclose(file), 0);
}

/* Up to size - 1 bytes, NUL-terminated; the count, or -1 where there is no file. */
static inline long pm__test_read(const char *path, char *bytes, size_t size)
{
    FILE *const file = fopen(path, "rb");
    if (!file)
        return -1;
    const size_t count = fread(bytes, 1, size - 1, file);
    bytes[count] = '\0';
    (void)fclose(file);
    return (long)count;
}

#endif
