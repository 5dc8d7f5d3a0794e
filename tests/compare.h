/* Result files made by hand, for tests of compare. */
#ifndef PM_TESTS_COMPARE_H
#define PM_TESTS_COMPARE_H

#include "program.h"
#include "rows.h"

enum { TEXT = 1 << 16 };
static pm__test_directory place;

static const char head[] =
    "{\"schema\":\"photonbench/1\",\"command\":\"%s\",\"machine\":{\"cpu\":\"x\"},\"rows\":[%s]}\n";

static void setup(void)
{
    place = pm__test_directory_create();
}

static void teardown(void)
{
    pm__test_directory_remove(&place);
}

static void write_text(const char *name, const char *text)
{
    char path[PM__TEST_PATH];
    pm__test_write(pm__test_path(&place, name, path), text, strlen(text));
}

static void write_file(const char *name, const char *command, const char *rows)
{
    static char text[2 * TEXT];
    (void)snprintf(text, sizeof text, head, command, rows);
    write_text(name, text);
}

static char rows_a[TEXT], rows_b[TEXT];

static inline const char *command(const char *a, const char *b, const char *rest)
{
    static char line[2 * PM__TEST_PATH + 200];
    (void)snprintf(line, sizeof line, "compare %s/%s %s/%s %s", place.path, a, place.path, b, rest);
    return line;
}

static inline json_t *compare_json(const char *a, const char *b, int status)
{
    json_t *const root = json_loads(pm__expect(command(a, b, "--json -"), status, NULL)->out, 0, NULL);
    ck_assert_ptr_nonnull(root);
    return root;
}

static inline const char *text_of(json_t *root, size_t row, const char *field)
{
    return pm__text_of(pm__item(root, "rows", row), field);
}

static inline double number_of(json_t *root, size_t row, const char *field)
{
    return pm__number_of(pm__item(root, "rows", row), field);
}

static void clear(void)
{
    *rows_a = *rows_b = '\0';
}

#endif
