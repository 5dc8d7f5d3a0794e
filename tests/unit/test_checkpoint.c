/* The file of a checkpoint: what was written is read, and whatever is wrong is refused, with the place. */
#include "../../src/converge/checkpoint.h"

#include "../files.h"
#include "../test.h"

#include <sys/stat.h>

enum { MOST = 4096 };

static unsigned char content[MOST];
static size_t size;
static pm__test_directory directory;
static char path[PM__TEST_PATH];

/* Where fields stand in the sample: version "1.2", options {"a":1}, series of 5, 0 and 40 bytes. */
enum {
    ORDER = 16, FORMAT = 20, SIZE = 24, VERSION = 32, ASKED = VERSION + 8 + 3, COUNT = ASKED + 8 + 7,
    FIRST = COUNT + 8, SECOND = FIRST + 16 + 5, THIRD = SECOND + 16, SUM = THIRD + 16 + 40, WHOLE = SUM + 8
};

static unsigned char first[5] = {1, 2, 0, 255, 10}, third[40];

static void in_directory(void)
{
    directory = pm__test_directory_create();
    (void)pm__test_path(&directory, "state", path);
}

static void write_sample(void)
{
    char version[] = "1.2", asked[] = "{\"a\":1}";
    pm__checkpoint_part parts[3] = {{{first, sizeof first}, true, 0}, {{NULL, 0}, true, 0},
                                    {{third, sizeof third}, false, 0}};
    for (size_t i = 0; i < sizeof third; i++)
        third[i] = (unsigned char)(i * 37);
    const pm__checkpoint checkpoint = {version, asked, parts, 3};
    FILE *const file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    pm__checkpoint_write(file, &checkpoint);
    ck_assert_int_eq(fclose(file), 0);
    size = (size_t)pm__test_read(path, (char *)content, sizeof content);
    ck_assert_uint_eq(size, WHOLE);
}

/* FNV-1a as its authors publish it: offset basis 14695981039346656037, prime 1099511628211. */
static uint64_t fnv1a(const void *bytes, size_t count)
{
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < count; i++) {
        hash ^= ((const unsigned char *)bytes)[i];
        hash *= 1099511628211u;
    }
    return hash;
}

static pm_status read_file(pm__checkpoint *checkpoint, pm_error *error)
{
    *error = (pm_error){""};
    return pm__checkpoint_read(path, checkpoint, error);
}

static void check_refused(size_t count, pm_status want, const char *what)
{
    pm__checkpoint found;
    pm_error error;
    pm__test_write(path, content, count);
    const pm_status status = read_file(&found, &error);
    ck_assert_msg(status == want, "%s: status %d (%s)", what, (int)status, error.text);
    ck_assert_msg(strstr(error.text, path) != NULL && strstr(error.text, "expected") != NULL, "%s: '%s'", what,
                  error.text);
    ck_assert_msg(strstr(error.text, what) != NULL, "'%s' lacks '%s'", error.text, what);
    ck_assert(!found.version && !found.asked && !found.parts && !found.count);
}

/* The last bytes made right again: what is wrong is then seen by itself. */
static void sum_up(size_t count)
{
    const uint64_t sum = fnv1a(content, count - 8);
    memcpy(content + count - 8, &sum, 8);
}

static void check_field(size_t at, uint64_t value, const char *what)
{
    unsigned char before[WHOLE];
    memcpy(before, content, sizeof before);
    memcpy(content + at, &value, 8);
    sum_up(WHOLE);
    check_refused(WHOLE, PM_EFORMAT, what);
    memcpy(content, before, sizeof before);
}

START_TEST(the_sum_is_fnv1a)
{
    ck_assert_uint_eq(fnv1a("a", 1), 0xaf63dc4c8601ec8cu); /* published values */
    ck_assert_uint_eq(fnv1a("foobar", 6), 0x85944171f73967e8u);
    in_directory();
    write_sample();
    uint64_t sum, length;
    memcpy(&sum, content + SUM, 8);
    memcpy(&length, content + SIZE, 8);
    ck_assert_uint_eq(sum, fnv1a(content, SUM));
    ck_assert_uint_eq(length, WHOLE);
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(what_is_written_is_read)
{
    pm__checkpoint found;
    pm_error error;
    in_directory();
    write_sample();
    PM_CHECK_OK(read_file(&found, &error), error);
    ck_assert_str_eq(found.version, "1.2");
    ck_assert_str_eq(found.asked, "{\"a\":1}");
    ck_assert_uint_eq(found.count, 3);
    ck_assert(found.parts[0].done && found.parts[1].done && !found.parts[2].done);
    ck_assert_uint_eq(found.parts[0].saved.count, sizeof first);
    ck_assert_mem_eq(found.parts[0].saved.bytes, first, sizeof first);
    ck_assert_uint_eq(found.parts[1].saved.count, 0);
    ck_assert_uint_eq(found.parts[2].saved.count, sizeof third);
    ck_assert_mem_eq(found.parts[2].saved.bytes, third, sizeof third);
    ck_assert_uint_eq(found.parts[0].offset, FIRST + 16);
    ck_assert_uint_eq(found.parts[2].offset, THIRD + 16);
    pm__checkpoint_free(&found);
    ck_assert_uint_eq(found.count, 0);
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(nothing_done_yet)
{
    char version[] = "", asked[] = "";
    const pm__checkpoint empty = {version, asked, NULL, 0};
    pm__checkpoint found;
    pm_error error;
    in_directory();
    FILE *const file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    pm__checkpoint_write(file, &empty);
    ck_assert_int_eq(fclose(file), 0);
    PM_CHECK_OK(read_file(&found, &error), error);
    ck_assert_str_eq(found.version, "");
    ck_assert_uint_eq(found.count, 0);
    pm__checkpoint_free(&found);
    pm__test_directory_remove(&directory);
}
END_TEST

/* A place in a message lies within the file. */
START_TEST(cut_at_every_length)
{
    in_directory();
    write_sample();
    for (size_t length = 0; length < WHOLE; length++)
        check_refused(length, PM_EFORMAT, length < 16 ? "byte 0: expected a checkpoint of photonbench" : "byte ");
    content[WHOLE] = 0;
    check_refused(WHOLE + 1, PM_EFORMAT, "a file of as many bytes as"); /* and one too many */
    pm__test_directory_remove(&directory);
}
END_TEST

/* Cut, and the size made right. */
START_TEST(cut_within)
{
    in_directory();
    write_sample();
    unsigned char before[WHOLE];
    memcpy(before, content, sizeof before);
    for (uint64_t length = 64; length < WHOLE; length++) {
        memcpy(content, before, sizeof before);
        memcpy(content + SIZE, &length, 8);
        sum_up(length);
        check_refused(length, PM_EFORMAT, "byte ");
    }
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(every_wrong_bit)
{
    in_directory();
    write_sample();
    for (size_t i = 0; i < WHOLE; i++)
        for (unsigned bit = 0; bit < 8; bit++) {
            content[i] ^= (unsigned char)(1U << bit);
            check_refused(WHOLE, PM_EFORMAT, i >= VERSION ? "checksum" : "byte ");
            content[i] ^= (unsigned char)(1U << bit);
        }
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(every_field)
{
    static const uint64_t huge[] = {UINT64_MAX, UINT64_MAX - 7, (uint64_t)1 << 63, (uint64_t)1 << 32, WHOLE};
    in_directory();
    write_sample();
    for (size_t i = 0; i < sizeof huge / sizeof *huge; i++) {
        if (huge[i] != WHOLE)
            check_field(SIZE, huge[i], "a file of as many bytes as");
        check_field(VERSION, huge[i], "byte 32: expected the length of the version");
        check_field(ASKED, huge[i], "byte 43: expected the length of the options");
        check_field(COUNT, huge[i], "byte 58: expected a number of series");
        check_field(FIRST, huge[i], "byte 66: expected 0 or 1");
        check_field(FIRST + 8, huge[i], "byte 74: expected the length of a series");
        check_field(THIRD + 8, huge[i], "expected the length of a series");
    }
    check_field(COUNT, 2, "expected the checksum"); /* bytes are left */
    check_field(COUNT, 4, "byte 159: expected 0 or 1");
    check_field(THIRD + 8, sizeof third - 1, "expected the checksum");
    check_field(THIRD, 2, "expected 0 or 1");
    check_field(VERSION, 4, "byte 44: expected the length of the options"); /* all after it is shifted */
    content[VERSION + 9] = '\0';
    sum_up(WHOLE);
    check_refused(WHOLE, PM_EFORMAT, "byte 40: expected text");
    write_sample();
    content[ORDER] = 4;
    content[ORDER + 3] = 1;
    sum_up(WHOLE);
    check_refused(WHOLE, PM_EFORMAT, "byte 16: expected the byte order");
    write_sample();
    content[FORMAT] = 2;
    sum_up(WHOLE);
    check_refused(WHOLE, PM_EFORMAT, "byte 20: expected format 1, found 2");
    pm__test_directory_remove(&directory);
}
END_TEST

START_TEST(what_is_no_file)
{
    pm__checkpoint found;
    pm_error error;
    in_directory();
    ck_assert_int_eq(read_file(&found, &error), PM_EIO);
    ck_assert_ptr_nonnull(strstr(error.text, "state: cannot be opened: No such file"));
    ck_assert_int_eq(mkfifo(path, 0600), 0); /* which nobody writes to */
    ck_assert_int_eq(read_file(&found, &error), PM_EIO);
    ck_assert_ptr_nonnull(strstr(error.text, "no regular file"));
    ck_assert_int_eq(pm__checkpoint_read(directory.path, &found, &error), PM_EIO);
    ck_assert_int_eq(pm__checkpoint_read("/dev/zero", &found, &error), PM_EIO);
    ck_assert_uint_eq(found.count, 0);
    pm__test_directory_remove(&directory);
}
END_TEST

PM_TEST_MAIN("checkpoint", the_sum_is_fnv1a, what_is_written_is_read, nothing_done_yet, cut_at_every_length, cut_within,
             every_wrong_bit, every_field, what_is_no_file)
