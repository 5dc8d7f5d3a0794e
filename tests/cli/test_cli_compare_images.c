/* compare of two images as a script sees it, on small ones made by hand. */
#include "../../src/image/image.h"
#include "../exr.h"
#include "../program.h"
#include "../rows.h"


static pm__test_directory place;

static void write_image(const char *name, const pm__image *image)
{
    char path[PM__TEST_PATH];
    pm_error error = {""};
    FILE *const file = fopen(pm__test_path(&place, name, path), "wb");
    ck_assert_ptr_nonnull(file);
    PM_CHECK_OK(pm__exr_write(file, image, false, NULL, 0, &error), error);
    ck_assert_int_eq(fclose(file), 0);
}

static void write_values(const char *name, size_t width, size_t height, const float *values)
{
    pm__image image;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(width, height, 3, &image, &error), error);
    memcpy(image.values, values, 3 * width * height * sizeof *values);
    write_image(name, &image);
    pm__image_free(&image);
}

/* a: twice b in the first of 2 x 1 pixels. Of these: mse (1 + 4 + 16) / 3 = 7 and 0; relmse by |B|'s mean 13/6. */
static const float of_a[] = {2, 4, 8, 1, 2, 3}, of_b[] = {1, 2, 4, 1, 2, 3};

static void setup(void)
{
    place = pm__test_directory_create();
    write_values("a.exr", 2, 1, of_a);
    write_values("b.exr", 2, 1, of_b);
}

static void teardown(void)
{
    pm__test_directory_remove(&place);
}

/* "compare @a @b --metric mse": @ is the directory and a slash. */
static const char *line_of(const char *words)
{
    static char line[4 * PM__TEST_PATH];
    size_t used = 0;
    *line = '\0';
    for (const char *c = words; *c; c++)
        used += (size_t)snprintf(line + used, sizeof line - used, "%.*s%s", *c == '@' ? PM__TEST_PATH : 1,
                                 *c == '@' ? place.path : c, *c == '@' ? "/" : "");
    return line;
}

static bool is_there(const char *name)
{
    char path[PM__TEST_PATH];
    return access(pm__test_path(&place, name, path), R_OK) == 0;
}

START_TEST(rows)
{
    setup();
    json_t *const root = pm__expect_json(line_of("compare @a.exr @b.exr --json -"));
    pm__check_keys(root, "schema command version options seed machine wall_s rows");
    static const char *const metrics[] = {"mse", "relmse:epsilon=0.01,unit=mean", "mape:epsilon=0.01,unit=mean",
                                          "smape:epsilon=0.01,unit=mean", "ssim:exposure=0,grey=auto",
                                          "flip:ppd=67,exposure=0,grey=auto", "hdrflip:ppd=67"};
    ck_assert_uint_eq(pm__items(root, "rows"), 7);
    for (size_t i = 0; i < 7; i++) {
        json_t *const row = pm__item(root, "rows", i);
        pm__check_keys(row, "metric better unit mean median p95 worst worst_x worst_y exposures exposure_start "
                            "exposure_stop image status detail");
        ck_assert_str_eq(pm__text_of(row, "metric"), metrics[i]);
        ck_assert_str_eq(pm__text_of(row, "better"), i == 4 ? "larger" : "smaller");
        ck_assert_str_eq(pm__text_of(row, "status"), "ok");
        ck_assert(pm__is_null(row, "image") && pm__is_null(row, "exposures") == (i < 4));
        ck_assert_double_eq(pm__number_of(row, "worst_y"), 0.0);
    }
    const json_t *const mse = pm__item(root, "rows", 0);
    PM_CHECK_NEAR(pm__number_of(mse, "mean"), 3.5, 1e-12);
    PM_CHECK_NEAR(pm__number_of(mse, "median"), 3.5, 1e-12);
    PM_CHECK_NEAR(pm__number_of(mse, "p95"), 7.0, 1e-12);
    PM_CHECK_NEAR(pm__number_of(mse, "worst"), 7.0, 1e-12);
    const double floor = 0.01 * 169.0 / 36.0; /* 0.01 (13/6)^2 */
    PM_CHECK_NEAR(pm__number_of(pm__item(root, "rows", 1), "mean"),
                  (1.0 / (1.0 + floor) + 4.0 / (4.0 + floor) + 16.0 / (16.0 + floor)) / 6.0, 1e-12);
    const json_t *const options = json_object_get(root, "options");
    ck_assert_str_eq(pm__text_of(options, "kind"), "images");
    PM_CHECK_NEAR(pm__number_of(options, "width"), 2.0, 0.0);
    json_decref(root);
    teardown();
}
END_TEST

/* The first image is tested, the second the truth: the other way round relative errors differ. */
START_TEST(the_second_is_the_reference)
{
    setup();
    json_t *const there = pm__expect_json(line_of("compare @a.exr @b.exr --metric mape:epsilon=0,mse --json -"));
    json_t *const back = pm__expect_json(line_of("compare @b.exr @a.exr --metric mape:epsilon=0,mse --json -"));
    PM_CHECK_NEAR(pm__number_of(pm__item(there, "rows", 0), "mean"), 0.5, 1e-12);
    PM_CHECK_NEAR(pm__number_of(pm__item(back, "rows", 0), "mean"), 0.25, 1e-12);
    PM_CHECK_NEAR(pm__number_of(pm__item(there, "rows", 1), "mean"), pm__number_of(pm__item(back, "rows", 1), "mean"),
                  0.0);
    json_decref(there);
    json_decref(back);
    teardown();
}
END_TEST

START_TEST(equal_images_and_the_screen)
{
    setup();
    const char *const out = pm__expect(line_of("compare @b.exr @b.exr --metric mse,ssim,hdrflip"), 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(out, "b.exr (tested)"));
    ck_assert_ptr_nonnull(strstr(out, "2 x 1 pixels"));
    ck_assert_ptr_nonnull(strstr(out, "mse                     0          0          0          0 at (0, 0)"));
    ck_assert_ptr_nonnull(strstr(out, "ssim                    1          1          1          1 at (0, 0)"));
    ck_assert_ptr_null(strstr(out, " \n"));
    ck_assert_str_eq(pm__expect(line_of("compare @b.exr @b.exr --quiet"), 0, NULL)->out, "");
    teardown();
}
END_TEST

/* Each metric's map, of the size of the images, with what it is in its header; and a picture. */
START_TEST(maps)
{
    setup();
    char path[PM__TEST_PATH], text[200];
    pm_error error = {""};
    pm__image map;
    json_t *const root = pm__expect_json(
        line_of("compare @a.exr @b.exr --metric mse,relmse:epsilon=0,ssim,hdrflip:ppd=30 -o @e.exr --json -"));
    static const char *const names[] = {"e.mse", "e.relmse-epsilon=0", "e.ssim", "e.hdrflip-ppd=30"};
    for (size_t i = 0; i < 4; i++) {
        char name[60];
        (void)snprintf(name, sizeof name, "%s.png", names[i]);
        ck_assert_msg(is_there(name), "no %s", name);
        (void)snprintf(name, sizeof name, "%s.exr", names[i]);
        PM_CHECK_OK(pm__exr_read(pm__test_path(&place, name, path), &map, &error), error);
        ck_assert_str_eq(pm__text_of(pm__item(root, "rows", i), "image"), path);
        ck_assert(map.width == 2 && map.height == 1 && map.channels == 1);
        PM_CHECK_NEAR(0.5 * ((double)map.values[0] + (double)map.values[1]),
                      pm__number_of(pm__item(root, "rows", i), "mean"), 1e-6);
        pm__image_free(&map);
    }
    PM_CHECK_OK(pm__exr_attribute(path, "metric", text, sizeof text, &error), error);
    ck_assert_str_eq(text, "hdrflip:ppd=30");
    PM_CHECK_OK(pm__exr_attribute(path, "reference", text, sizeof text, &error), error);
    ck_assert_ptr_nonnull(strstr(text, "b.exr"));
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 2 + 8);
    json_decref(root);
    teardown();
}
END_TEST

START_TEST(maps_that_cannot_be_written)
{
    setup();
    (void)pm__expect(line_of("compare @a.exr @b.exr -o @sub/e"), 4, "sub/e.mse.exr: cannot be opened");
    (void)pm__expect(line_of("compare @a.exr @b.exr -o -"), 2, "'-' is no name for them");
    write_values("e.mse.exr", 2, 1, of_b);
    (void)pm__expect(line_of("compare @a.exr @e.mse.exr -o @e"), 2, "would take the place of");
    (void)pm__expect(line_of("compare @a.exr @b.exr -o @f --metric mse --json @f.mse.png"), 2,
                     "would take the place of");
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 3);
    /* What is written under that name stands where a file was. */
    (void)pm__expect(line_of("compare @a.exr @b.exr -o @e --metric mse --quiet"), 0, NULL);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 4);
    teardown();
}
END_TEST

/* A value that does not exist is null and says why; the others are there. */
START_TEST(black_reference)
{
    setup();
    static const float black[6] = {0};
    write_values("black.exr", 2, 1, black);
    json_t *const root = pm__expect_json(line_of("compare @a.exr @black.exr -o @e --json -"));
    const json_t *const row = pm__item(root, "rows", 1);
    ck_assert_str_eq(pm__text_of(row, "status"), "undefined");
    ck_assert_ptr_nonnull(strstr(pm__text_of(row, "detail"), "the reference is black in pixel (0, 0)"));
    ck_assert(pm__is_null(row, "mean") && pm__is_null(row, "worst") && pm__is_null(row, "worst_x"));
    ck_assert(pm__is_null(row, "image") && !is_there("e.relmse.exr") && is_there("e.flip.exr"));
    ck_assert_str_eq(pm__text_of(pm__item(root, "rows", 3), "status"), "ok");
    json_decref(root);
    ck_assert_ptr_nonnull(strstr(pm__expect(line_of("compare @a.exr @black.exr"), 0, NULL)->out,
                                 "the reference is black"));
    teardown();
}
END_TEST

START_TEST(files_that_are_refused)
{
    setup();
    char path[PM__TEST_PATH];
    static const char json[] = "{\"schema\":\"photonbench/1\",\"command\":\"search\",\"rows\":[]}";
    static const float bad[] = {1, 1, NAN, INFINITY, 1, 1};
    const sample_exr grey = {.channels = "Y", .type = EXR_PIXEL_FLOAT, .width = 2, .height = 1};
    const sample_exr depth = {.channels = "Z", .type = EXR_PIXEL_FLOAT, .width = 2, .height = 1};
    pm__test_write(pm__test_path(&place, "r.json", path), json, sizeof json - 1);
    pm__test_write(pm__test_path(&place, "cut.exr", path), "\x76\x2f\x31\x01\x02", 5);
    write_values("bad.exr", 2, 1, bad);
    write_values("tall.exr", 1, 2, of_b);
    write_sample(pm__test_path(&place, "grey.exr", path), &grey);
    write_sample(pm__test_path(&place, "depth.exr", path), &depth);
    static const struct {
        const char *a, *b;
        int status;
        const char *message;
    } pairs[] = {
        {"a.exr", "none.exr", 3, "none.exr: cannot be opened: No such file"},
        {"none.exr", "b.exr", 3, "none.exr: cannot be opened: No such file"},
        {"a.exr", "r.json", 2, "a.exr is an OpenEXR image, "},
        {"r.json", "b.exr", 2, "r.json is none: two images can be compared, or two JSON results"},
        {"a.exr", "cut.exr", 3, "cut.exr: "},
        {"a.exr", "tall.exr", 2, "images of different sizes: "},
        {"a.exr", "grey.exr", 2, "grey.exr: has no R G B"},
        {"depth.exr", "b.exr", 3, "depth.exr: expected "},
        {"bad.exr", "b.exr", 3, "bad.exr: 2 of 6 values are not finite, the first B of pixel (0, 0)"},
        {"a.exr", "bad.exr", 3, "bad.exr: 2 of 6 values are not finite"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        char words[80];
        (void)snprintf(words, sizeof words, "compare @%s @%s -o @e", pairs[i].a, pairs[i].b);
        ck_assert_str_eq(pm__expect(line_of(words), pairs[i].status, pairs[i].message)->out, "");
        ck_assert_int_eq(pm__test_directory_entries(&place, 0), 8);
    }
    teardown();
}
END_TEST

START_TEST(metrics_that_are_misspelt)
{
    setup();
    (void)pm__expect(line_of("compare @a.exr @b.exr --metric flipp"), 2, "did you mean 'flip'?");
    (void)pm__expect(line_of("compare @a.exr @b.exr --metric flip:pdd=3"), 2, "did you mean 'ppd'?");
    (void)pm__expect(line_of("compare @a.exr @b.exr --metric flip:ppd=0"), 2, "ppd");
    (void)pm__expect(line_of("compare @a.exr @b.exr --metric rmse"), 2, "rmse");
    json_t *const root = pm__expect_json(line_of("compare @a.exr @b.exr --metric mse,mse,flip,flip:ppd=67 --json -"));
    ck_assert_uint_eq(pm__items(root, "rows"), 2);
    json_decref(root);
    teardown();
}
END_TEST

START_TEST(as_tables)
{
    setup();
    const char *const csv = pm__expect(line_of("compare @a.exr @b.exr --metric mse --csv -"), 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(csv, "metric,better,unit,mean,median,p95,worst,worst_x,worst_y,"));
    ck_assert_ptr_nonnull(strstr(csv, "mse,smaller,(W/(m2 sr))^2,3.5,3.5,7,7,0,0,"));
    (void)pm__expect(line_of("compare @a.exr @b.exr --json /dev/full"), 4, "No space left");
    teardown();
}
END_TEST

PM_TEST_MAIN("cli compare of images", rows, the_second_is_the_reference, equal_images_and_the_screen, maps,
             maps_that_cannot_be_written, black_reference, files_that_are_refused, metrics_that_are_misspelt, as_tables)
