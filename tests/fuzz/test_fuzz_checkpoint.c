/* Damaged checkpoints, their checksums made right again or not: whatever the damage, a status comes back soon, an error
 * names the file and the place, and a checkpoint is whole or empty. Deterministic: the same files at each run. */
#include "../../src/converge/checkpoint.h"

#include "../files.h"
#include "damage.h"

#include <time.h>

enum { FILES = 12000, TEST = 12 }; /* TEST: of the dice */

static char path[PM__TEST_PATH];

static void make_seed(sample_file *f)
{
    char version[] = "0.1.0", asked[] = "{\"scene\":[\"scene:plate\"],\"passes\":6}";
    unsigned char bytes[300];
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)(i * 73);
    pm__checkpoint_part parts[4] = {{{bytes, 300}, true, 0}, {{NULL, 0}, true, 0}, {{bytes, 7}, true, 0},
                                    {{bytes, 100}, false, 0}};
    const pm__checkpoint checkpoint = {version, asked, parts, 4};
    FILE *const file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    pm__checkpoint_write(file, &checkpoint);
    ck_assert_int_eq(fclose(file), 0);
    const long size = pm__test_read(path, (char *)f->content, sizeof f->content);
    ck_assert_int_gt(size, 500);
    f->size = (size_t)size;
}

/* Writes an ugly number over eight bytes. */
static void replace_number(sample_file *f, size_t at, dice *d)
{
    static const uint64_t numbers[] = {0, 1, 2, 7, 8, 300, UINT64_MAX, UINT64_MAX - 7, (uint64_t)1 << 63, 1u << 31,
                                       (uint64_t)1 << 32, (uint64_t)1 << 40, 0xfffffffffffffff0u};
    uint64_t number = numbers[roll(d, sizeof numbers / sizeof *numbers)];
    if (f->size < at + 8)
        return;
    if (roll(d, 3) == 0) {
        memcpy(&number, f->content + at, 8);
        number += roll(d, 2) ? 1U : UINT64_MAX;
    }
    memcpy(f->content + at, &number, 8);
}

/* Size and checksum made right, so that what lies behind them is reached. */
static void make_plausible(sample_file *f)
{
    if (f->size < 64)
        return;
    const uint64_t size = f->size;
    uint64_t sum = 14695981039346656037u;
    memcpy(f->content + 24, &size, 8);
    for (size_t i = 0; i < f->size - 8; i++)
        sum = (sum ^ f->content[i]) * 1099511628211u;
    memcpy(f->content + f->size - 8, &sum, 8);
}

static bool try_file(void)
{
    pm__checkpoint found;
    pm_error error = {""};
    const pm_status status = pm__checkpoint_read(path, &found, &error);
    if (status == PM_OK) {
        for (size_t i = 0; i < found.count; i++)
            for (size_t b = 0; b < found.parts[i].saved.count; b++)
                ck_assert_uint_le(found.parts[i].saved.bytes[b], 255); /* all can be touched */
        ck_assert(found.version && found.asked && strlen(found.version) + strlen(found.asked) < sizeof(sample_file));
        pm__checkpoint_free(&found);
        return true;
    }
    ck_assert_msg(status == PM_EFORMAT, "%s: %s", pm_status_text(status), error.text);
    ck_assert_msg(strstr(error.text, path) && strstr(error.text, ", byte ") && strstr(error.text, ": expected "), "%s",
                  error.text);
    for (const char *c = error.text; *c; c++)
        ck_assert_msg(*c >= ' ' && *c <= '~', "%s", error.text);
    ck_assert(!found.version && !found.asked && !found.parts && !found.count);
    return false;
}

START_TEST(damaged_files)
{
    const pm__test_directory directory = pm__test_directory_create();
    (void)pm__test_path(&directory, "state", path);
    sample_file seed;
    size_t read = 0, refused = 0;
    make_seed(&seed);
    limit_memory();
    for (uint64_t i = 0; i < FILES; i++) {
        dice d = {i, TEST, 0};
        sample_file f = seed;
        for (size_t n = i ? 1 + roll(&d, 3) : 0; n > 0 && f.size; n--) {
            const size_t at = roll(&d, f.size), kind = roll(&d, DAMAGES + 4);
            if (kind < DAMAGES)
                damage_bytes(&f, at, kind, &d);
            else
                replace_number(&f, roll(&d, 2) ? at : 32 + roll(&d, 64), &d);
        }
        if (i % 8)
            make_plausible(&f);
        pm__test_write(path, f.content, f.size);
        const clock_t start = clock();
        const bool got = try_file();
        ck_assert(got || i);
        *(got ? &read : &refused) += 1;
        ck_assert_msg(clock() - start < 2 * CLOCKS_PER_SEC, "file %d took too long", (int)i);
    }
    pm__test_directory_remove(&directory);
    /* The damage is neither always harmless nor always fatal: that in a series itself is not this reader's to see. */
    ck_assert_uint_ge(read, FILES / 50);
    ck_assert_uint_ge(refused, FILES / 4);
}
END_TEST

PM_TEST_MAIN("fuzz_checkpoint", damaged_files)
