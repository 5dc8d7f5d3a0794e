/* Damaged OpenEXR files: whatever the damage, a status comes back soon, an error names the file, and an image is whole
 * or empty. Deterministic: the same files at each run. */
#include "../../src/image/image.h"

#include "../exr.h"
#include "../files.h"
#include "damage.h"

#include <time.h>

enum { FILES = 12000, SEEDS = 7, TEST = 11 }; /* TEST: of the dice */

static sample_file seeds[SEEDS];
static char path[PM__TEST_PATH];

/* One of each way to compress and of each type, larger than a block; the last is our own. */
static void make_seeds(const pm__test_directory *directory)
{
    static const sample_exr kinds[SEEDS - 1] = {
        {"BGR", EXR_PIXEL_FLOAT, EXR_COMPRESSION_NONE, 6, 9, -2, 5, 0, false, false, 0},
        {"BGRZ", EXR_PIXEL_UINT, EXR_COMPRESSION_RLE, 12, 9, 0, 0, 0, true, false, 0},
        {"Y", EXR_PIXEL_HALF, EXR_COMPRESSION_ZIPS, 12, 5, 0, -3, 0, false, false, 0},
        {"ABGRYZ", EXR_PIXEL_HALF, EXR_COMPRESSION_ZIP, 12, 20, 0, 0, 0, false, false, 0},
        {"BGR", EXR_PIXEL_HALF, EXR_COMPRESSION_PIZ, 40, 40, 0, 0, 0, true, false, 0},
        {"AY", EXR_PIXEL_FLOAT, EXR_COMPRESSION_PXR24, 12, 20, 1, 1, 0, false, false, 0},
    };
    for (size_t i = 0; i < SEEDS; i++) {
        (void)pm__test_path(directory, "seed.exr", path);
        if (i < SEEDS - 1) {
            write_sample(path, &kinds[i]);
        } else {
            static const pm__attribute attributes[] = {{.name = "scene", .text = "cornell"},
                                                       {.name = "exposure", .number = 2.0}};
            pm__image image;
            PM_CHECK_OK(pm__image_create(20, 20, 3, &image, NULL), (pm_error){""});
            FILE *const file = fopen(path, "wb");
            PM_CHECK_OK(pm__exr_write(file, &image, true, attributes, 2, NULL), (pm_error){""});
            ck_assert_int_eq(fclose(file), 0);
            pm__image_free(&image);
        }
        const long size = pm__test_read(path, (char *)seeds[i].content, sizeof seeds[i].content);
        ck_assert(size > 0 && size < (long)sizeof seeds[i].content / 2);
        seeds[i].size = (size_t)size;
    }
}

/* The header is where damage does most. */
static size_t roll_place(const sample_file *f, dice *d)
{
    return roll(d, roll(d, 3) ? (f->size < 400 ? f->size : 400) : f->size);
}

/* Writes an ugly whole number over four bytes. */
static void replace_number(sample_file *f, size_t at, dice *d)
{
    static const uint32_t numbers[] = {0, 1, 2, 3, 0xffffffff, 0x7fffffff, 0x80000000, 0x7ffffffe, 0x10000, 0xffff,
                                       1 << 20, 1 << 24, 255, 256, 1000, 0x3fffffff, 0x40000000, 16, 32};
    uint32_t number = numbers[roll(d, sizeof numbers / sizeof *numbers)];
    if (f->size - at < 4)
        return;
    if (roll(d, 4) == 0) {
        memcpy(&number, f->content + at, 4);
        number += roll(d, 2) ? 1U : 0xffffffffU;
    }
    memcpy(f->content + at, &number, 4);
}

/* Puts a word of the format in place of a run of letters. */
static void replace_word(sample_file *f, size_t at, dice *d)
{
    static const char *const words[] = {"R", "Y", "", "type", "tiledimage", "deepscanline", "scanlineimage", "chlist",
                                        "box2i", "tiles", "tiledesc", "preview", "string", "stringvector", "chunkCount",
                                        "int", "double", "channels", "dataWindow", "version", "lineOrder",
                                        "floatvector", "opaque", "name", "keycode", "timecode", "m44f", "compression"};
    replace_run(f, at, 'A', words, sizeof words / sizeof *words, d);
}

static void damage(sample_file *f, dice *d)
{
    const size_t at = roll_place(f, d), kind = roll(d, 2 * DAMAGES);
    if (kind < DAMAGES)
        damage_bytes(f, at, kind, d);
    else if (kind < DAMAGES + 4)
        replace_number(f, at, d);
    else
        replace_word(f, at, d);
}

static void check_error(pm_status status, const pm_error *error, const pm__image *image)
{
    ck_assert_msg(status == PM_EFORMAT, "%s: %s", pm_status_text(status), error->text);
    ck_assert_msg(strncmp(error->text, "a file: expected ", 17) == 0, "%s", error->text);
    for (const char *c = error->text; *c; c++)
        ck_assert_msg(*c >= ' ' && *c <= '~', "%s", error->text);
    ck_assert(!image->values && image->width == 0 && image->height == 0 && image->channels == 0);
}

/* Whether the file was read. From memory of just its size, so that a sanitizer sees its end. */
static bool try_image(const sample_file *f)
{
    unsigned char *const bytes = malloc(f->size ? f->size : 1);
    memcpy(bytes, f->content, f->size);
    pm__image image;
    pm_error error = {""};
    const pm_status status = pm__exr_read_memory(bytes, f->size, "a file", &image, &error);
    free(bytes);
    if (status != PM_OK) {
        check_error(status, &error, &image);
        return false;
    }
    ck_assert(image.values && (image.channels == 1 || image.channels == 3));
    const size_t values = image.width * image.height * (size_t)image.channels;
    ck_assert_uint_le(values * 2, f->size * 4096);
    volatile float sum = 0.0F;
    for (size_t i = 0; i < values; i++)
        sum += image.values[i]; /* every value is there */
    (void)sum;
    pm__image_free(&image);
    return true;
}

static void try_attribute(const sample_file *f)
{
    char text[16];
    pm_error error = {""};
    pm__test_write(path, f->content, f->size);
    const pm_status status = pm__exr_attribute(path, "scene", text, sizeof text, &error);
    if (status == PM_OK)
        ck_assert_uint_lt(strlen(text), sizeof text);
    else
        ck_assert_msg(status == PM_EFORMAT || status == PM_ENAME || status == PM_EINVAL, "%s", error.text);
}

START_TEST(damaged_files)
{
    limit_memory();
    const pm__test_directory directory = pm__test_directory_create();
    make_seeds(&directory);
    size_t read = 0, refused = 0;
    for (uint64_t i = 0; i < FILES; i++) {
        dice d = {i, TEST, 0};
        sample_file f = seeds[i % SEEDS];
        for (size_t n = i < SEEDS ? 0 : 1 + roll(&d, 3); n > 0; n--)
            damage(&f, &d);
        const clock_t start = clock();
        const bool got = try_image(&f);
        if (i < SEEDS)
            ck_assert(got);
        *(got ? &read : &refused) += 1;
        if (i % SEEDS == SEEDS - 1)
            try_attribute(&f);
        ck_assert_msg(clock() - start < 2 * CLOCKS_PER_SEC, "file %d took too long", (int)i);
    }
    pm__test_directory_remove(&directory);
    /* The damage is neither always harmless nor always fatal. */
    ck_assert_uint_ge(read, FILES / 50);
    ck_assert_uint_ge(refused, FILES / 4);
}
END_TEST

/* Noise in place of the pixels, and of all behind the magic number. */
START_TEST(noise)
{
    limit_memory();
    const pm__test_directory directory = pm__test_directory_create();
    make_seeds(&directory);
    for (uint64_t i = 0; i < 3000; i++) {
        dice d = {FILES + i, TEST, 0};
        sample_file f = seeds[i % SEEDS];
        for (size_t at = i % 3 ? f.size / 2 + roll(&d, f.size / 2) : 8; at < f.size; at++)
            f.content[at] = (unsigned char)roll(&d, 256);
        (void)try_image(&f);
    }
    pm__test_directory_remove(&directory);
}
END_TEST

PM_TEST_MAIN("fuzz_exr", damaged_files, noise)
