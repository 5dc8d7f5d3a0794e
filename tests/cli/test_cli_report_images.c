/* Images in reports: reduced, described, and beside the page where they do not fit. */
#include "../../src/image/image.h"
#include "../report.h"

#include <sys/stat.h>

static size_t base64_bytes(const char *text, unsigned char *bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t count = 0;
    unsigned bits = 0;
    int held = 0;
    for (; *text && *text != '='; text++) {
        ck_assert_ptr_nonnull(strchr(digits, *text));
        bits = bits << 6 | (unsigned)(strchr(digits, *text) - digits);
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes[count++] = (unsigned char)(bits >> held & 255);
        }
    }
    return count;
}

/* An image of the page, decoded into a file. */
static void unpack(const json_t *image, const char *name)
{
    static unsigned char bytes[1 << 20];
    const char *const text = pm__text_of(image, "exr");
    ck_assert_uint_gt(strlen(text), 100);
    ck_assert_uint_lt(strlen(text), sizeof bytes);
    ck_assert_uint_eq(strlen(text) % 4, 0);
    pm__test_write(path_of(name), bytes, base64_bytes(text, bytes));
}

/* The mean over a block of 3 x 3 of samples, the image's edge cutting it off. */
static double mean_of_samples(char channel, int column, int row, int width, int height)
{
    double sum = 0.0;
    int count = 0;
    for (int y = 3 * row; y < 3 * row + 3 && y < height; y++)
        for (int x = 3 * column; x < 3 * column + 3 && x < width; x++, count++)
            sum += sample_value(channel, x, y);
    return sum / count;
}

static void check_means(const char *name)
{
    static const int places[][2] = {{0, 0}, {171, 0}, {5, 99}, {171, 99}};
    pm__image image;
    ck_assert_int_eq(pm__exr_read(path_of(name), &image, NULL), PM_OK);
    for (size_t i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) {
            const double want = mean_of_samples("RGB"[c], places[i][0], places[i][1], 515, 300);
            PM_CHECK_NEAR((double)image.values[(places[i][1] * 172 + places[i][0]) * 3 + c], want, want / 2048.0);
        }
    pm__image_free(&image);
}

START_TEST(images_are_reduced_and_told)
{
    setup();
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    write_image("b.truth.exr", 515, 300); /* blocks of 3 x 3; the last columns are of 2 */
    write_image("big", 256, 257);
    write_image("c.exr", 7, 5);
    (void)pm__expect(line_of("@a.json @b.truth.exr @big @c.exr -o @out"), 0, NULL);
    json_t *const root = read_page("out/index.html");
    ck_assert_uint_eq(pm__items(root, "images"), 3);
    json_t *const first = pm__item(root, "images", 0), *const last = pm__item(root, "images", 2);
    pm__check_keys(first, "name file scene label kind width height channels href attributes exr");
    ck_assert_str_eq(pm__text_of(first, "kind"), "truth");
    ck_assert_str_eq(pm__text_of(first, "file"), "b.truth.exr");
    ck_assert_int_eq((int)pm__number_of(first, "width"), 172);
    ck_assert_int_eq((int)pm__number_of(first, "height"), 100);
    ck_assert_uint_eq(pm__items(first, "channels"), 3);
    ck_assert(pm__is_null(first, "href"));
    ck_assert_str_eq(pm__text_of(last, "kind"), "image");
    ck_assert_int_eq((int)pm__number_of(last, "width"), 7);
    unpack(first, "unpacked.exr");
    check_means("unpacked.exr");
    json_decref(root);
    /* What was packed is an image that this program reads, reduced to itself. */
    (void)pm__expect(line_of("@a.json @unpacked.exr -o @again"), 0, NULL);
    json_t *const again = read_page("again/index.html");
    ck_assert_int_eq((int)pm__number_of(pm__item(again, "images", 0), "width"), 172);
    json_decref(again);
    teardown();
}
END_TEST

/* What `render` writes says what it is; a truth that two estimators share is there once. */
START_TEST(renders_are_described)
{
    setup();
    char line[600];
    (void)snprintf(line, sizeof line,
                   "render water --estimator disc,hull:boundary=0 --size 8x8 --spp 1 --photons 2000 --k 10 --aov "
                   "--trials 2 --quiet -o %s/i.exr", place.path);
    (void)pm__expect(line, 0, NULL);
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    (void)pm__expect(line_of("@a.json @i.water.disc.exr @i.water.disc.truth.exr @i.water.hull-boundary=0.exr "
                             "@i.water.hull-boundary=0.truth.exr @i.water.disc.count.exr -o @out"), 0, NULL);
    json_t *const root = read_page("out/index.html");
    static const char *const want[][3] = {{"water.disc", "disc, k = 10", "image"},
                                          {"water.disc.truth", "truth (exact)", "truth"},
                                          {"water.hull:boundary=0", "hull:boundary=0, k = 10", "image"},
                                          {"water.disc.count", "disc, k = 10: count", "count"}};
    ck_assert_uint_eq(pm__items(root, "images"), 4);
    for (size_t i = 0; i < 4; i++) {
        json_t *const image = pm__item(root, "images", i), *const more = json_object_get(image, "attributes");
        ck_assert_str_eq(pm__text_of(image, "name"), want[i][0]);
        ck_assert_str_eq(pm__text_of(image, "label"), want[i][1]);
        ck_assert_str_eq(pm__text_of(image, "kind"), want[i][2]);
        ck_assert_str_eq(pm__text_of(image, "scene"), "scene:water");
        ck_assert_str_eq(pm__text_of(more, "seed"), "1");
        ck_assert_ptr_nonnull(strstr(pm__text_of(more, "command"), "photonbench render water"));
        ck_assert_uint_eq(pm__items(image, "channels"), i == 3 ? 1 : 3);
    }
    json_decref(root);
    teardown();
}
END_TEST

/* Pixels that do not compress. */
static void write_noise(const char *name, unsigned seed)
{
    pm__image image;
    ck_assert_int_eq(pm__image_create(256, 256, 3, &image, NULL), PM_OK);
    for (size_t i = 0; i < 3 * 256 * 256; i++) {
        seed = seed * 1664525u + 1013904223u;
        image.values[i] = (float)(seed >> 8) / 16777216.0F;
    }
    FILE *const file = fopen(path_of(name), "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(pm__exr_write(file, &image, false, NULL, 0, NULL), PM_OK);
    ck_assert_int_eq(fclose(file), 0);
    pm__image_free(&image);
}

/* More than a page takes. */
START_TEST(further_images_stand_beside)
{
    setup();
    enum { IMAGES = 20 };
    char words[400] = "@a.json ", name[40];
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    for (int i = 0; i < IMAGES; i++) {
        (void)snprintf(name, sizeof name, "i%d.exr", i);
        write_noise(name, (unsigned)i);
        (void)snprintf(words + strlen(words), sizeof words - strlen(words), "@i%d.exr ", i);
    }
    (void)strcat(words, "-o @out --quiet");
    (void)pm__expect(line_of(words), 0, NULL);
    json_t *const root = read_page("out/index.html");
    struct stat status;
    ck_assert_int_eq(stat(path_of("out/index.html"), &status), 0);
    size_t beside = 0;
    for (size_t i = 0; i < IMAGES; i++) {
        const json_t *const image = pm__item(root, "images", i);
        const char *const href = pm__text_of(image, "href");
        ck_assert(pm__is_null(image, "exr") != pm__is_null(image, "href"));
        if (!*href)
            continue;
        static char script[1 << 20];
        char path[100], start[80];
        beside++;
        (void)snprintf(path, sizeof path, "out/%.80s", href);
        ck_assert_int_gt(pm__test_read(path_of(path), script, sizeof script), 100);
        (void)snprintf(start, sizeof start, "window.pmImage(\"%s\", \"", pm__text_of(image, "file"));
        ck_assert_ptr_eq(strstr(script, start), script);
        ck_assert_str_eq(script + strlen(script) - 4, "\");\n");
        path[strlen(path) - 3] = '\0';
        ck_assert(exists(path));
    }
    ck_assert_msg(status.st_size < 8500000, "%ld bytes", (long)status.st_size);
    ck_assert_msg(beside > 0 && beside < IMAGES, "%zu beside, page of %ld bytes", beside, (long)status.st_size);
    json_decref(root);
    teardown();
}
END_TEST

PM_TEST_MAIN("cli report images", images_are_reduced_and_told, renders_are_described, further_images_stand_beside)
