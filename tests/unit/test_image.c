/* Images in memory, files within the program, and references from a table of them. */
#include "../../src/image/embed.h"
#include "../../src/image/reference.h"

#include "../test.h"

#include <stdint.h>
#include <string.h>

START_TEST(created_and_freed)
{
    pm__image image;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(7, 5, 3, &image, &error), error);
    ck_assert(image.width == 7 && image.height == 5 && image.channels == 3);
    for (int i = 0; i < 7 * 5 * 3; i++)
        ck_assert(image.values[i] == 0.0F);
    pm__image_free(&image);
    ck_assert(!image.values && image.width == 0);
    pm__image_free(&image);
}
END_TEST

START_TEST(sizes_refused)
{
    static const struct {
        size_t width, height;
        int channels;
    } bad[] = {{0, 5, 3}, {5, 0, 3}, {5, 5, 2}, {5, 5, 0}, {5, 5, -1}, {5, 5, 4}, {PM__LONGEST_SIDE + 1, 1, 1},
               {1, PM__LONGEST_SIDE + 1, 1}, {1 << 14, (1 << 14) + 1, 1}, {SIZE_MAX, SIZE_MAX, 3},
               {(size_t)1 << 32, (size_t)1 << 32, 3}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        pm__image image = {3, 3, 3, NULL};
        pm_error error = {""};
        ck_assert_int_eq(pm__image_create(bad[i].width, bad[i].height, bad[i].channels, &image, &error), PM_EINVAL);
        ck_assert_msg(strstr(error.text, "an image"), "%s", error.text);
        ck_assert(!image.values && image.width == 0 && image.height == 0 && image.channels == 0);
    }
}
END_TEST

PM__EMBED(licence, "LICENSE");

/* From the first byte to the last, and no further: the licence's text is known. */
START_TEST(files_are_embedded)
{
    const size_t size = (size_t)((uintptr_t)licence_end - (uintptr_t)licence);
    static const char end[] = "limitations under the License.\n";
    ck_assert_uint_gt(size, 10000);
    ck_assert_ptr_nonnull(memmem(licence, 100, "Apache License", 14));
    ck_assert_int_eq(memcmp(licence + size - (sizeof end - 1), end, sizeof end - 1), 0);
    ck_assert_uint_eq(licence[size], 0);
}
END_TEST

/* An image's file in memory. */
typedef struct stored {
    unsigned char *bytes;
    size_t size;
} stored;

static stored store(size_t width, size_t height, int channels, float value)
{
    pm__image image;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(width, height, channels, &image, &error), error);
    for (size_t i = 0; i < width * height * (size_t)channels; i++)
        image.values[i] = value + (float)i;
    char *bytes = NULL;
    stored s = {NULL, 0};
    FILE *const file = open_memstream(&bytes, &s.size);
    PM_CHECK_OK(pm__exr_write(file, &image, false, NULL, 0, &error), error);
    ck_assert_int_eq(fclose(file), 0);
    pm__image_free(&image);
    s.bytes = (unsigned char *)bytes;
    return s;
}

static pm__reference_row make_row(const char *scene, stored radiance, stored error)
{
    return (pm__reference_row){scene, radiance.bytes, radiance.bytes + radiance.size, error.bytes,
                               error.bytes + error.size};
}

static void check_reference(const pm__reference_row *table, const char *scene, float first)
{
    pm__reference reference;
    pm_error error = {""};
    PM_CHECK_OK(pm__reference_load_from(table, scene, &reference, &error), error);
    ck_assert(reference.radiance.width == 3 && reference.radiance.height == 2 && reference.radiance.channels == 3);
    ck_assert(reference.radiance.values[17] == first + 17.0F);
    ck_assert(reference.error.values[17] == first + 117.0F);
    pm__reference_free(&reference);
    ck_assert(!reference.radiance.values && !reference.error.values);
}

START_TEST(references_are_found)
{
    const stored a = store(3, 2, 3, 1.0F), a_error = store(3, 2, 3, 101.0F);
    const stored b = store(3, 2, 3, 2.0F), b_error = store(3, 2, 3, 102.0F);
    const pm__reference_row table[] = {make_row("pool", a, a_error), make_row("deep_blue_pool", b, b_error), {0}};
    check_reference(table, "pool", 1.0F);
    check_reference(table, "deep-blue-pool", 2.0F);
    check_reference(table, "deep_blue-pool", 2.0F);
    static const char *const unknown[] = {"", "poo", "pools", "deep blue pool", "deep", "scene:pool"};
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++) {
        pm__reference reference;
        pm_error error = {""};
        ck_assert_int_eq(pm__reference_load_from(table, unknown[i], &reference, &error), PM_ENAME);
        ck_assert_msg(strstr(error.text, unknown[i]), "%s", error.text);
        ck_assert(!reference.radiance.values && !reference.error.values);
    }
    free(a.bytes);
    free(a_error.bytes);
    free(b.bytes);
    free(b_error.bytes);
}
END_TEST

static void check_unfit(pm__reference_row row)
{
    const pm__reference_row table[] = {row, {0}};
    pm__reference reference;
    pm_error error = {""};
    ck_assert_int_eq(pm__reference_load_from(table, "pool", &reference, &error), PM_EFORMAT);
    ck_assert_msg(strstr(error.text, "the reference of pool: expected"), "%s", error.text);
    ck_assert(!reference.radiance.values && !reference.error.values);
}

START_TEST(unfit_references)
{
    const stored a = store(3, 2, 3, 1.0F), turned = store(2, 3, 3, 1.0F), grey = store(3, 2, 1, 1.0F);
    const stored cut = {a.bytes, a.size - 1};
    check_unfit(make_row("pool", a, turned));
    check_unfit(make_row("pool", a, grey));
    check_unfit(make_row("pool", grey, grey));
    check_unfit(make_row("pool", a, cut));
    check_unfit(make_row("pool", cut, a));
    free(a.bytes);
    free(turned.bytes);
    free(grey.bytes);
}
END_TEST

/* Those in the program: colour, finite, standard errors not below 0. */
START_TEST(own_references)
{
    for (const pm__reference_row *row = pm__references; row->scene; row++) {
        pm__reference reference;
        pm_error error = {""};
        ck_assert(pm__reference_exists(row->scene));
        PM_CHECK_OK(pm__reference_load(row->scene, &reference, &error), error);
        ck_assert_int_eq(reference.radiance.channels, 3);
        for (size_t i = 0; i < reference.radiance.width * reference.radiance.height * 3; i++) {
            ck_assert(isfinite(reference.radiance.values[i]));
            ck_assert(isfinite(reference.error.values[i]) && reference.error.values[i] >= 0.0F);
        }
        pm__reference_free(&reference);
    }
    pm__reference reference;
    ck_assert(!pm__reference_exists("no-such-scene"));
    ck_assert_int_eq(pm__reference_load("no-such-scene", &reference, NULL), PM_ENAME);
    pm__reference_free(&reference);
}
END_TEST

PM_TEST_MAIN("image", created_and_freed, sizes_refused, files_are_embedded, references_are_found, unfit_references,
             own_references)
