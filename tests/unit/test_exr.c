/* OpenEXR files: what is written is read back to the last bit, and what cannot be read is refused with a reason. */
#include "../../src/image/image.h"

#include "../exr.h"
#include "../files.h"
#include "../test.h"

#include <float.h>
#include <inttypes.h>
#include <pthread.h>
#include <sys/stat.h>

static pm__test_directory directory;
static char path[PM__TEST_PATH];

static const char *in_directory(const char *name)
{
    if (!directory.path[0])
        directory = pm__test_directory_create();
    return pm__test_path(&directory, name, path);
}

static void cleanup(void)
{
    if (directory.path[0])
        pm__test_directory_remove(&directory);
    directory.path[0] = '\0';
}

static pm__image make_image(size_t width, size_t height, int channels)
{
    pm__image image;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(width, height, channels, &image, &error), error);
    for (size_t i = 0; i < width * height * (size_t)channels; i++)
        image.values[i] = 0.25F * (float)i - 3.0F;
    return image;
}

static void write_to(const char *to, const pm__image *image, bool half, const pm__attribute *attributes, size_t count)
{
    pm_error error = {""};
    FILE *const file = fopen(to, "wb");
    ck_assert_ptr_nonnull(file);
    PM_CHECK_OK(pm__exr_write(file, image, half, attributes, count, &error), error);
    ck_assert_int_eq(fclose(file), 0);
}

static pm__image read_from(const char *from)
{
    pm__image image;
    pm_error error = {""};
    PM_CHECK_OK(pm__exr_read(from, &image, &error), error);
    return image;
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void check_same(const pm__image *a, const pm__image *b)
{
    ck_assert_uint_eq(a->width, b->width);
    ck_assert_uint_eq(a->height, b->height);
    ck_assert_int_eq(a->channels, b->channels);
    for (size_t i = 0; i < a->width * a->height * (size_t)a->channels; i++)
        ck_assert_msg(bits_of(a->values[i]) == bits_of(b->values[i]), "value %zu: %a, %a", i, (double)a->values[i],
                      (double)b->values[i]);
}

static void check_round_trip(const pm__image *image, bool half)
{
    write_to(in_directory("a.exr"), image, half, NULL, 0);
    pm__image got = read_from(path);
    check_same(image, &got);
    pm__image_free(&got);
}

/* More rows than a block of ZIP has, blocks that are cut, one pixel, one row, one column. */
START_TEST(every_shape_comes_back)
{
    static const size_t sizes[][2] = {{1, 1}, {1, 40}, {333, 1}, {16, 16}, {7, 17}, {50, 33}, {64, 100}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int channels = 1; channels <= 3; channels += 2) {
            pm__image image = make_image(sizes[i][0], sizes[i][1], channels);
            check_round_trip(&image, false);
            pm__image_free(&image);
        }
    cleanup();
}
END_TEST

static float from_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* NaNs with what they carry, infinities, zeros of both signs, denormals, the extremes; then bits of every kind. */
START_TEST(every_float_comes_back)
{
    const float odd[] = {from_bits(0x7fc00000), from_bits(0xffc12345), from_bits(0x7f800001), INFINITY, -INFINITY, 0.0F,
                         -0.0F, FLT_MIN, FLT_MAX, -FLT_MAX, FLT_TRUE_MIN, -FLT_TRUE_MIN, FLT_MIN / 3.0F, 1.0F / 3.0F};
    pm__image image = make_image(60, 50, 3);
    for (size_t i = 0; i < 60 * 50 * 3; i++)
        image.values[i] = i < sizeof odd / sizeof *odd ? odd[i] : from_bits((uint32_t)i * 2654435761U);
    check_round_trip(&image, false);
    pm__image_free(&image);
    cleanup();
}
END_TEST

/* A half has 11 significant bits, exponents from -14 to 15, denormals in steps of 2^-24 (IEEE 754 binary16). In double
 * the nearest is exact arithmetic: nearbyint rounds ties to even. */
static double nearest_half(double x)
{
    int exponent;
    (void)frexp(x, &exponent); /* |x| in [2^(e-1), 2^e) */
    const double step = ldexp(1.0, (exponent < -13 ? -13 : exponent) - 11);
    const double rounded = nearbyint(x / step) * step;
    return fabs(rounded) > 65504.0 ? copysign(INFINITY, x) : rounded;
}

/* Chunks about as long compressed as they are: more random bits a row than the compression of the rest gains, and less;
 * some come to the same length to the byte. */
START_TEST(chunks_that_hardly_shrink)
{
    uint32_t state = 1;
    for (int random = 0; random < 400; random++) {
        pm__image image = make_image(16, 16, 1);
        for (int i = 0; i < 256; i++) {
            state = state * 1664525u + 1013904223u;
            const uint32_t bits = 0x3f800000u | (i < 156 + random / 4 ? state >> 9 : 0);
            memcpy(&image.values[i], &bits, sizeof bits);
        }
        check_round_trip(&image, false);
        pm__image_free(&image);
    }
    cleanup();
}
END_TEST

START_TEST(halves_are_the_nearest)
{
    static const float some[] = {0.0F, -0.0F, 1.0F, 65504.0F, 65519.0F, 65520.0F, 1e6F, -1e30F, 0x1p-24F, 0x1p-25F,
                                 0x1.000002p-25F, -0x1p-26F, 0x1.002p0F, 0x1.006p0F, 0x1.002002p0F, 0x1.ffep-15F,
                                 INFINITY, -INFINITY, 2049.0F, 2051.0F, 1e-10F, FLT_TRUE_MIN};
    enum { SOME = sizeof some / sizeof *some, COUNT = 64 * 64 * 3 };
    pm__image image = make_image(64, 64, 3);
    for (size_t i = 0; i < COUNT; i++) /* random bits of exponents from 2^-30 to 2^18 */
        image.values[i] = i < SOME ? some[i]
                                   : ldexpf(1.0F + (float)((i * 2654435761U >> 7) % (1 << 20)) / (1 << 20),
                                            (int)(i % 49) - 30) * (i % 2 ? 1.0F : -1.0F);
    write_to(in_directory("half.exr"), &image, true, NULL, 0);
    pm__image got = read_from(path);
    for (size_t i = 0; i < COUNT; i++) {
        const double x = (double)image.values[i], want = isinf(x) ? x : nearest_half(x);
        ck_assert_msg((double)got.values[i] == want && !signbit(got.values[i]) == !signbit(x), "%a: %a, not %a", x,
                      (double)got.values[i], want);
    }
    image.values[0] = NAN;
    write_to(path, &image, true, NULL, 0);
    pm__image_free(&got);
    got = read_from(path);
    ck_assert(isnan(got.values[0]));
    pm__image_free(&got);
    pm__image_free(&image);
    cleanup();
}
END_TEST

static void check_attribute(const char *from, const char *name, const char *want)
{
    char text[64];
    pm_error error = {""};
    PM_CHECK_OK(pm__exr_attribute(from, name, text, sizeof text, &error), error);
    ck_assert_str_eq(text, want);
}

START_TEST(attributes_come_back)
{
    const pm__attribute attributes[] = {{.name = "scene", .text = "glass-sphere:ior=1.5,d=4"},
                                        {.name = "empty", .text = ""},
                                        {.name = "exposure", .number = 0.1},
                                        {.name = "missing", .number = NAN},
                                        {.name = "a-name-of-31-bytes-at-the-limit", .text = "x"}};
    pm__image image = make_image(3, 2, 3);
    write_to(in_directory("a.exr"), &image, false, attributes, 5);
    check_attribute(path, "scene", attributes[0].text);
    check_attribute(path, "empty", "");
    check_attribute(path, "exposure", "0.10000000000000001");
    check_attribute(path, "missing", "nan");
    check_attribute(path, attributes[4].name, "x");
    char text[25] = "before";
    pm_error error = {""};
    text[24] = '!';
    ck_assert_int_eq(pm__exr_attribute(path, "scene", text, 24, &error), PM_EINVAL);
    ck_assert_int_eq(text[24], '!');
    PM_CHECK_OK(pm__exr_attribute(path, "scene", text, 25, &error), error);
    ck_assert_int_eq(pm__exr_attribute(path, "Scene", text, 25, &error), PM_ENAME);
    ck_assert_msg(strstr(error.text, path) && strstr(error.text, "\"Scene\""), "%s", error.text);
    ck_assert_int_eq(pm__exr_attribute(path, "channels", text, 25, &error), PM_ENAME);
    ck_assert_int_eq(pm__exr_attribute("/nowhere/at.exr", "scene", text, 25, &error), PM_EIO);
    pm__image_free(&image);
    cleanup();
}
END_TEST

/* Taking them would change what the format says of the image, or one of them would be lost. */
START_TEST(attributes_refused)
{
    static const pm__attribute bad[][2] = {
        {{.name = "type", .text = "tiledimage"}},     {{.name = "channels", .text = "R"}},
        {{.name = "dataWindow", .number = 1.0}},      {{.name = "compression", .text = "none"}},
        {{.name = "a", .text = "1"}, {.name = "a", .text = "2"}}, {{.name = "", .text = "1"}},
        {{.name = "0123456789012345678901234567890123456789", .text = "1"}},
        {{.name = "tiles", .text = "1"}},             {{.name = "chunkCount", .text = "1"}},
        {{.name = "version", .text = "1"}},           {{.name = "name", .text = "1"}},
    };
    pm__image image = make_image(3, 2, 3);
    FILE *const file = tmpfile();
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        pm_error error = {""};
        const pm_status status = pm__exr_write(file, &image, false, bad[i], bad[i][1].name ? 2 : 1, &error);
        ck_assert_msg(status == PM_EINVAL, "%s: %s", bad[i][0].name, pm_status_text(status));
        ck_assert_msg(strstr(error.text, "attribute"), "%s", error.text);
    }
    ck_assert_int_eq(ftell(file), 0);
    (void)fclose(file);
    pm__image_free(&image);
}
END_TEST

/* What other programs need: windows from (0, 0), square pixels, rows from the top; asked of the library itself. */
START_TEST(header_is_standard)
{
    pm__image image = make_image(5, 20, 3);
    write_to(in_directory("a.exr"), &image, false, NULL, 0);
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.flags = EXR_CONTEXT_FLAG_STRICT_HEADER;
    exr_context_t context;
    SAMPLE_OK(exr_start_read(&context, path, &settings));
    exr_attr_box2i_t data, display;
    SAMPLE_OK(exr_get_data_window(context, 0, &data));
    SAMPLE_OK(exr_get_display_window(context, 0, &display));
    ck_assert(data.min.x == 0 && data.min.y == 0 && data.max.x == 4 && data.max.y == 19);
    ck_assert_int_eq(memcmp(&data, &display, sizeof data), 0);
    exr_attr_v2f_t centre;
    float aspect, width;
    SAMPLE_OK(exr_get_pixel_aspect_ratio(context, 0, &aspect));
    SAMPLE_OK(exr_get_screen_window_center(context, 0, &centre));
    SAMPLE_OK(exr_get_screen_window_width(context, 0, &width));
    ck_assert(aspect == 1.0F && width == 1.0F && centre.x == 0.0F && centre.y == 0.0F);
    exr_lineorder_t order;
    exr_compression_t compression;
    SAMPLE_OK(exr_get_lineorder(context, 0, &order));
    SAMPLE_OK(exr_get_compression(context, 0, &compression));
    ck_assert(order == EXR_LINEORDER_INCREASING_Y && compression == EXR_COMPRESSION_ZIP);
    const exr_attr_chlist_t *channels;
    SAMPLE_OK(exr_get_channels(context, 0, &channels));
    ck_assert_int_eq(channels->num_channels, 3);
    for (int i = 0; i < 3; i++)
        ck_assert(channels->entries[i].name.str[0] == "BGR"[i] && channels->entries[i].pixel_type == EXR_PIXEL_FLOAT);
    SAMPLE_OK(exr_finish(&context));
    pm__image_free(&image);
    cleanup();
}
END_TEST

START_TEST(same_bytes_again)
{
    static char first[1 << 16], second[1 << 16];
    const pm__attribute attribute = {.name = "scene", .text = "cornell"};
    pm__image image = make_image(40, 40, 3);
    write_to(in_directory("a.exr"), &image, false, &attribute, 1);
    const long size = pm__test_read(path, first, sizeof first);
    write_to(path, &image, false, &attribute, 1);
    ck_assert_int_eq(pm__test_read(path, second, sizeof second), size);
    ck_assert(size > 400 && size < (long)sizeof first - 1);
    ck_assert_int_eq(memcmp(first, second, (size_t)size), 0);
    pm__image_free(&image);
    cleanup();
}
END_TEST

static void *read_through(void *from)
{
    static pm__image got;
    got = read_from(from);
    return &got;
}

/* A FIFO on both sides, of more bytes than a pipe holds. */
START_TEST(pipes_will_do)
{
    pm__image image = make_image(200, 200, 3);
    for (size_t i = 0; i < 120000; i++)
        image.values[i] = from_bits((uint32_t)i * 2654435761U);
    ck_assert_int_eq(mkfifo(in_directory("fifo"), 0600), 0);
    pthread_t reader;
    ck_assert_int_eq(pthread_create(&reader, NULL, read_through, path), 0);
    write_to(path, &image, false, NULL, 0);
    void *got;
    ck_assert_int_eq(pthread_join(reader, &got), 0);
    check_same(&image, got);
    pm__image_free(got);
    pm__image_free(&image);
    cleanup();
}
END_TEST

START_TEST(full_device)
{
    for (size_t side = 2; side <= 200; side += 198) { /* less and more than a stream's buffer */
        pm__image image = make_image(side, side, 3);
        FILE *const file = fopen("/dev/full", "wb");
        ck_assert_ptr_nonnull(file);
        pm_error error = {""};
        ck_assert_int_eq(pm__exr_write(file, &image, false, NULL, 0, &error), PM_EIO);
        ck_assert_msg(strstr(error.text, "No space left"), "%s", error.text);
        (void)fclose(file);
        pm__image_free(&image);
    }
    const pm__image empty = {0};
    ck_assert_int_eq(pm__exr_write(stdout, &empty, false, NULL, 0, NULL), PM_EINVAL);
}
END_TEST

static void check_sample(const sample_exr *s)
{
    write_sample(in_directory("s.exr"), s);
    pm__image got = read_from(path);
    const char *const names = got.channels == 3 ? "RGB" : "Y";
    ck_assert(got.width == (size_t)s->width && got.height == (size_t)s->height);
    for (int y = 0; y < s->height; y++)
        for (int x = 0; x < s->width; x++)
            for (int c = 0; c < got.channels; c++)
                PM_CHECK_NEAR((double)got.values[(y * s->width + x) * got.channels + c],
                              (double)sample_value(names[c], x, y), 0.0);
    pm__image_free(&got);
}

/* Of every compression that is read; with PXR24's 24 bits whole numbers lose nothing. */
START_TEST(other_files_are_read)
{
    static const exr_compression_t exact[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                              EXR_COMPRESSION_ZIP,  EXR_COMPRESSION_PIZ, EXR_COMPRESSION_PXR24};
    static const char *const channels[] = {"BGR", "ABGR", "ABGRYZ", "Y", "AYZ", "BGY"};
    for (size_t i = 0; i < 6; i++)
        for (int type = 0; type < 3; type++)
            for (size_t c = 0; c < 6; c++)
                check_sample(&(sample_exr){.channels = channels[c], .type = (exr_pixel_type_t)type,
                                           .compression = exact[i], .width = 37, .height = 41, .x = (int)c * 3 - 5,
                                           .y = 11 - 7 * type, .from_below = c % 2 == 1});
    cleanup();
}
END_TEST

static void check_refused(const char *name, pm_status want, const char *reason)
{
    pm__image image = {1, 1, 1, NULL};
    pm_error error = {""};
    const pm_status status = pm__exr_read(name, &image, &error);
    ck_assert_msg(status == want, "%s: %s", reason, pm_status_text(status));
    ck_assert_msg(strstr(error.text, name) && strstr(error.text, reason), "%s", error.text);
    ck_assert(!image.values && image.width == 0 && image.channels == 0);
}

static void check_sample_refused(const sample_exr *s, const char *reason)
{
    write_sample(in_directory("s.exr"), s);
    check_refused(path, PM_EFORMAT, reason);
}

/* Writes the sample with one byte changed: at an offset, or that of an attribute's value. */
static void write_changed(const sample_exr *s, size_t at, const char *attribute, int value)
{
    static char bytes[1 << 16];
    write_sample(in_directory("s.exr"), s);
    const size_t size = (size_t)pm__test_read(path, bytes, sizeof bytes);
    if (attribute) {
        const char *const found = memmem(bytes, size, attribute, strlen(attribute) + 1);
        ck_assert_ptr_nonnull(found);
        const char *const type = found + strlen(attribute) + 1;
        at = (size_t)(type + strlen(type) + 1 + 4 - bytes);
    }
    bytes[at] = (char)value;
    pm__test_write(path, bytes, size);
}

START_TEST(other_kinds_refused)
{
    sample_exr s = {.channels = "BGR", .type = EXR_PIXEL_FLOAT, .compression = EXR_COMPRESSION_ZIP, .width = 20,
                    .height = 20};
    s.tiled = true;
    check_sample_refused(&s, "found tiles");
    s.tiled = false;
    s.parts = 2;
    check_sample_refused(&s, "found several parts");
    s.parts = 0;
    write_changed(&s, 5, NULL, 8);
    check_refused(path, PM_EFORMAT, "found deep pixels");
    write_changed(&s, 0, "compression", EXR_COMPRESSION_B44); /* release 3.1.5 decodes floats in it wrongly */
    check_refused(path, PM_EFORMAT, "found another");
    write_changed(&s, 0, "compression", EXR_COMPRESSION_DWAB);
    check_refused(path, PM_EFORMAT, "found another");
    write_changed(&s, 0, "compression", 77);
    check_refused(path, PM_EFORMAT, "expected");
    s.channels = "BR";
    check_sample_refused(&s, "found no G");
    s.channels = "AG";
    check_sample_refused(&s, "found no R B");
    s.channels = "AZ";
    check_sample_refused(&s, "found none of them");
    s.channels = "BGR";
    s.subsampling = 2;
    check_sample_refused(&s, "channel \"R\" subsampled");
    s.channels = "BGRZ";
    check_sample_refused(&s, "channel \"Z\" subsampled");
    cleanup();
}
END_TEST

START_TEST(unreadable_files)
{
    check_refused("/nowhere/at.exr", PM_EIO, "No such file");
    check_refused("/tmp", PM_EIO, "directory");
    check_refused("/dev/zero", PM_EFORMAT, "76 2f 31 01"); /* soon, though it has no end */
    check_refused("/dev/null", PM_EFORMAT, "76 2f 31 01");
    pm__test_write(in_directory("text"), "an image? no", 12);
    check_refused(path, PM_EFORMAT, "76 2f 31 01");
    pm__test_write(path, "\x76\x2f\x31\x01\x03\0\0\0", 8);
    check_refused(path, PM_EFORMAT, "found 3");
    cleanup();
}
END_TEST

static unsigned char *find_bytes(unsigned char *in, size_t size, const char *what, size_t length)
{
    unsigned char *const found = memmem(in, size, what, length);
    ck_assert_ptr_nonnull(found);
    return found;
}

/* The header's claim is checked against the file before anything is allocated by it. */
START_TEST(false_sizes)
{
    static unsigned char bytes[1 << 16];
    pm__image image = make_image(8, 8, 3);
    write_to(in_directory("a.exr"), &image, false, NULL, 0);
    const size_t size = (size_t)pm__test_read(path, (char *)bytes, sizeof bytes);
    unsigned char *const window = find_bytes(bytes, size, "dataWindow\0box2i\0\x10\0\0", 21) + 21;
    static const struct {
        int32_t x0, y0, x1, y1;
        const char *reason;
    } windows[] = {{0, 0, 1 << 21, 7, "at most 268435456"},
                   {0, 0, 7, INT32_MAX - 1, ""},
                   {INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX, ""},
                   {0, 0, 99999, 99999, "at most 268435456"},
                   {0, 0, 9999, 9999, "expected data for 10000 x 10000 pixels"},
                   {5, 5, 4, 5, ""},
                   {0, 0, 7, 255, ""}};
    for (size_t i = 0; i < sizeof windows / sizeof *windows; i++) {
        memcpy(window, &windows[i].x0, 16);
        pm__test_write(path, bytes, size);
        check_refused(path, PM_EFORMAT, windows[i].reason);
    }
    pm__image_free(&image);
    cleanup();
}
END_TEST

/* Cut anywhere: never an image, never a crash. */
START_TEST(cut_files)
{
    static char bytes[1 << 16];
    pm__image image = make_image(20, 40, 1), got;
    write_to(in_directory("a.exr"), &image, false, NULL, 0);
    const size_t size = (size_t)pm__test_read(path, bytes, sizeof bytes);
    for (size_t n = 0; n < size; n++) {
        pm_error error = {""};
        void *const exact = malloc(n ? n : 1); /* so that a sanitizer sees the end */
        memcpy(exact, bytes, n);
        ck_assert_int_eq(pm__exr_read_memory(exact, n, "cut", &got, &error), PM_EFORMAT);
        ck_assert_msg(strncmp(error.text, "cut: expected", 13) == 0, "%s", error.text);
        ck_assert_ptr_null(got.values);
        free(exact);
    }
    pm__image_free(&image);
    cleanup();
}
END_TEST

PM_TEST_MAIN("exr", every_shape_comes_back, every_float_comes_back, chunks_that_hardly_shrink, halves_are_the_nearest,
             attributes_come_back, attributes_refused, header_is_standard, same_bytes_again, pipes_will_do, full_device,
             other_files_are_read, other_kinds_refused, unreadable_files, false_sizes, cut_files)
