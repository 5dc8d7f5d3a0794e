/* What tests of `report` share: a folder of files, and the data that a page made of them holds. */
#ifndef PM_TESTS_REPORT_H
#define PM_TESTS_REPORT_H

#include "exr.h"
#include "program.h"
#include "rows.h"

enum { PAGE_SIZE = 1 << 24 };

#define HEAD "{\"schema\":\"photonbench/1\",\"command\":"
#define SCRIPT "<script type=\"application/json\" id=\"pm-report\">"

static pm__test_directory place;
static char page[PAGE_SIZE];

static inline void setup(void)
{
    place = pm__test_directory_create();
    ck_assert_int_eq(setenv("SOURCE_DATE_EPOCH", "1000000000", 1), 0);
}

static inline void teardown(void)
{
    char command[2 * PM__TEST_PATH];
    (void)snprintf(command, sizeof command, "rm -rf '%s'", place.path);
    ck_assert_int_eq(system(command), 0);
}

static inline const char *path_of(const char *name)
{
    static char path[PM__TEST_PATH];
    return pm__test_path(&place, name, path);
}

static inline void write_text(const char *name, const char *text)
{
    pm__test_write(path_of(name), text, strlen(text));
}

/* "report" with the words, @ standing for the folder. */
static inline const char *line_of(const char *words)
{
    static char line[4096];
    size_t used = (size_t)snprintf(line, sizeof line, "report ");
    for (; *words && used < sizeof line; words++)
        if (*words == '@')
            used += (size_t)snprintf(line + used, sizeof line - used, "%s/", place.path);
        else
            used += (size_t)snprintf(line + used, sizeof line - used, "%c", *words);
    ck_assert_uint_lt(used, sizeof line);
    return line;
}

/* The data of a page; the caller's. */
static inline json_t *read_page(const char *name)
{
    ck_assert_int_gt(pm__test_read(path_of(name), page, sizeof page), 0);
    char *const start = strstr(page, SCRIPT);
    ck_assert_ptr_nonnull(start);
    ck_assert_ptr_null(strstr(start + 1, SCRIPT));
    ck_assert_ptr_null(strstr(page, "<!--PM-DATA-->"));
    char *const end = strstr(start, "</script>");
    ck_assert_ptr_nonnull(end);
    *end = '\0';
    json_error_t error;
    json_t *const root = json_loads(start + sizeof SCRIPT - 1, JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(root != NULL, "line %d: %s", error.line, error.text);
    return root;
}

static inline bool exists(const char *name)
{
    return access(path_of(name), F_OK) == 0;
}

static inline void write_image(const char *name, int width, int height)
{
    write_sample(path_of(name), &(sample_exr){.channels = "BGR", .type = EXR_PIXEL_FLOAT,
                                              .compression = EXR_COMPRESSION_ZIP, .width = width, .height = height});
}

#endif
