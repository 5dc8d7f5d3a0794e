/* Image metrics: by hand on small images, and by identities. tests/oracle/test_flip_brute.c has formulas again. */
#include "../../src/metrics/colour.h"
#include "../../src/metrics/flip_map.h"
#include "../metrics.h"

#include <float.h>
#include <string.h>

static const char *const names[] = {"mse", "relmse", "mape", "smape", "ssim", "flip", "hdrflip"};
enum { NAMES = sizeof names / sizeof *names };

/* ---- By hand ----------------------------------------------------------------------------------- */

/* Pixel 0: (0 + 2^2 + 3^2) / 3 = 13/3; pixel 1: 0. Of two values the median is their mean, the 95th percentile the
 * second. */
START_TEST(mse_by_hand)
{
    float a[] = {1, 2, 3, 5, 5, 5}, b[] = {1, 0, 0, 5, 5, 5};
    const pm__image tested = image_of(2, 1, a), reference = image_of(2, 1, b);
    pm__measured m = measure("mse", &tested, &reference);
    PM_CHECK_NEAR(m.map[0], 13.0 / 3.0, 1e-15);
    PM_CHECK_NEAR(m.map[1], 0.0, 0.0);
    PM_CHECK_NEAR(m.mean, 13.0 / 6.0, 1e-15);
    PM_CHECK_NEAR(m.median, 13.0 / 6.0, 1e-15);
    PM_CHECK_NEAR(m.p95, 13.0 / 3.0, 1e-15);
    PM_CHECK_NEAR(m.worst, 13.0 / 3.0, 1e-15);
    ck_assert_uint_eq(m.worst_x, 0);
    ck_assert_uint_eq(m.shown.count, 0);
    pm__measured_free(&m);
}
END_TEST

/* A = (3, 1, 0), B = (1, 2, 0). The mean of |B| is 1.
 * relmse: (4 / 1.01 + 1 / 4.01 + 0) / 3, of B as the truth. mape: (2 / 1.01 + 1 / 2.01) / 3. smape: the mean of |A| and
 * |B| together is 7/6; (2 / (4 + 7/600) + 1 / (3 + 7/600)) / 3. */
START_TEST(relative_errors_by_hand)
{
    float a[] = {3, 1, 0}, b[] = {1, 2, 0};
    pm__image tested = image_of(1, 1, a), reference = image_of(1, 1, b);
    PM_CHECK_NEAR(mean_of("relmse", &tested, &reference), (4.0 / 1.01 + 1.0 / 4.01) / 3.0, 1e-14);
    PM_CHECK_NEAR(mean_of("mape", &tested, &reference), (2.0 / 1.01 + 1.0 / 2.01) / 3.0, 1e-14);
    PM_CHECK_NEAR(mean_of("smape", &tested, &reference), (2.0 / (4.0 + 0.07 / 6.0) + 1.0 / (3.0 + 0.07 / 6.0)) / 3.0,
                  1e-14);
    /* B of mean 1 and unit `one` are alike; of 10 times that they are not. */
    times(&tested, 10.0F);
    times(&reference, 10.0F);
    PM_CHECK_NEAR(mean_of("relmse:unit=one", &tested, &reference), (400.0 / 100.01 + 100.0 / 400.01) / 3.0, 1e-14);
    PM_CHECK_NEAR(mean_of("mape:unit=one,epsilon=0", &tested, &reference), (2.0 + 0.5) / 3.0, 1e-14);
    PM_CHECK_NEAR(mean_of("smape:unit=one,epsilon=1", &tested, &reference), (20.0 / 41.0 + 10.0 / 31.0) / 3.0, 1e-14);
}
END_TEST

/* Negative radiance, as differences of images have it: |3 - -1| = 4 of |-1| = 1. */
START_TEST(signs_count_in_differences_only)
{
    float a[] = {3, 3, 3}, b[] = {-1, -1, -1};
    const pm__image tested = image_of(1, 1, a), reference = image_of(1, 1, b);
    PM_CHECK_NEAR(mean_of("mse", &tested, &reference), 16.0, 0.0);
    PM_CHECK_NEAR(mean_of("relmse:epsilon=0", &tested, &reference), 16.0, 0.0);
    PM_CHECK_NEAR(mean_of("mape:epsilon=0", &tested, &reference), 4.0, 0.0);
    PM_CHECK_NEAR(mean_of("smape:epsilon=0", &tested, &reference), 1.0, 0.0);
}
END_TEST

/* Constant images have no variance: what is left is (2 a b + C1) / (a^2 + b^2 + C1) of sRGB codes. A stop brighter,
 * 0.5 is white, code 1, and 0.125 is 0.25, code 1.055 0.25^(1/2.4) - 0.055 = 0.537099. */
START_TEST(ssim_of_constants)
{
    const double code = 1.055 * pow(0.25, 1.0 / 2.4) - 0.055;
    pm__image a = random_image(9, 4, 1), b = random_image(9, 4, 1);
    for (size_t i = 0; i < 108; i++) {
        a.values[i] = 0.125F;
        b.values[i] = 0.5F;
    }
    PM_CHECK_NEAR(code, 0.537099, 1e-6);
    pm__measured m = measure("ssim:grey=none,exposure=1", &a, &b);
    for (size_t p = 0; p < 36; p++)
        PM_CHECK_NEAR(m.map[p], (2.0 * code + 1e-4) / (1.0 + code * code + 1e-4), 1e-9);
    ck_assert_uint_eq(m.shown.count, 1);
    PM_CHECK_NEAR(m.shown.start, 1.0, 1e-12);
    pm__measured_free(&m);
    /* Three stops brighter both are 1 or above. */
    m = measure("ssim:grey=none,exposure=3", &a, &b);
    PM_CHECK_NEAR(m.mean, 1.0, 1e-12);
    pm__measured_free(&m);
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

/* The median of 1 to 200 is 100.5, shown as 0.18; that of black and one dot is the dot's; lamps change nothing. */
START_TEST(the_median_is_middle_grey)
{
    pm__image b = random_image(20, 10, 1);
    for (size_t p = 0; p < 200; p++)
        b.values[3 * p] = b.values[3 * p + 1] = b.values[3 * p + 2] = (float)(1 + p * 77 % 200);
    for (size_t p = 0; p < 200; p++)
        for (size_t c = 0; c < 3 && b.values[3 * p + c] > 150.0F; c++)
            b.values[3 * p + c] = 1e6F;
    pm__measured m = measure("ssim:exposure=3", &b, &b);
    PM_CHECK_NEAR(m.shown.start, 3.0 + log2(0.18 / 100.5), 1e-6);
    pm__measured_free(&m);
    memset(b.values, 0, 3 * 200 * sizeof(float));
    b.values[3 * 199 + 1] = 5.0F;
    m = measure("flip", &b, &b);
    PM_CHECK_NEAR(m.shown.start, log2(0.18 / (5.0 * 0.7152)), 1e-6);
    pm__measured_free(&m);
    pm__image_free(&b);
}
END_TEST

/* ---- FLIP of constants ------------------------------------------------------------------------- */

/* Textbook L*a*b* (to the rounding of its matrix) of sRGB green and blue under D65: (87.7347, -86.1827, 83.1793) and
 * (32.2970, 79.1875, -107.8602); a and b times 0.01 L; |dL| + distance; to the power 0.7: 41.27. */
static double largest_distance(void)
{
    const double green = 0.877347, blue = 0.322970;
    const double da = green * -86.1827 - blue * 79.1875, db = green * 83.1793 - blue * -107.8602;
    return pow(100.0 * (green - blue) + sqrt(da * da + db * db), 0.7);
}

static pm__image constant(size_t width, size_t height, const float rgb[3])
{
    pm__image image;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(width, height, 3, &image, &error), error);
    for (size_t i = 0; i < 3 * width * height; i++)
        image.values[i] = rgb[i % 3];
    return image;
}

/* No edges, no points; filters leave constants alone: FLIP is the colour term. Black to white L* differs by 100:
 * 100^0.7 = 25.119 is above the knee at 0.4 * 41.27, so 0.95 + 0.05 (25.119 - 16.51) / 24.76 = 0.96738. */
START_TEST(flip_of_constants)
{
    const double largest = largest_distance(), knee = 0.4 * largest;
    const struct {
        float a[3], b[3];
        double flip;
    } pairs[] = {
        {{0, 0, 0}, {1, 1, 1}, 0.95 + 0.05 * (pow(100.0, 0.7) - knee) / (largest - knee)},
        {{0, 1, 0}, {0, 0, 1}, 1.0},
        /* Greys: L* = 116 Y^(1/3) - 16. */
        {{0.2F, 0.2F, 0.2F}, {0.5F, 0.5F, 0.5F}, 0.95 * pow(116.0 * (cbrt(0.5) - cbrt(0.2)), 0.7) / knee},
        /* Below (6/29)^3 L* is 903.3 Y. */
        {{0.001F, 0.001F, 0.001F}, {0.003F, 0.003F, 0.003F}, 0.95 * pow(0.002 * 24389.0 / 27.0, 0.7) / knee},
    };
    PM_CHECK_NEAR(pairs[0].flip, 0.96738, 1e-5);
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        pm__image a = constant(30, 23, pairs[i].a), b = constant(30, 23, pairs[i].b);
        pm__measured m = measure("flip:grey=none", &a, &b);
        for (size_t p = 0; p < 30 * 23; p++)
            PM_CHECK_NEAR(m.map[p], pairs[i].flip, 2e-5);
        pm__measured_free(&m);
        pm__image_free(&a);
        pm__image_free(&b);
    }
}
END_TEST

START_TEST(colours_there_and_back)
{
    state = 5;
    for (int i = 0; i < 100; i++) {
        const double rgb[] = {uniform(), uniform(), uniform()};
        double opponent[3], back[3];
        pm__rgb_to_ycxcz(rgb, opponent);
        pm__ycxcz_to_rgb(opponent, back);
        for (int c = 0; c < 3; c++)
            PM_CHECK_NEAR(back[c], rgb[c], 1e-13);
    }
    double white[3], lab[3];
    pm__rgb_to_ycxcz((const double[]){1.0, 1.0, 1.0}, white);
    pm__rgb_to_hunt_lab((const double[]){1.0, 0.0, 0.0}, lab); /* L*a*b* (53.2408, 80.0925, 67.2032) */
    PM_CHECK_NEAR(white[0], 100.0, 1e-12);
    PM_CHECK_NEAR(white[1], 0.0, 1e-12);
    PM_CHECK_NEAR(white[2], 0.0, 1e-12);
    PM_CHECK_NEAR(lab[0], 53.2408, 5e-3);
    PM_CHECK_NEAR(lab[1], 0.532408 * 80.0925, 2e-2);
    PM_CHECK_NEAR(lab[2], 0.532408 * 67.2032, 2e-2);
}
END_TEST

/* ---- Filters ----------------------------------------------------------------------------------- */

static double sum_of(const pm__kernel *kernel, int sign)
{
    double sum = 0.0;
    for (size_t i = 0; i <= 2 * kernel->radius; i++)
        sum += sign * kernel->weights[i] > 0.0 ? kernel->weights[i] : 0.0;
    return sum;
}

/* At 67 pixels to the degree: 3 sqrt(0.04 / 2) / pi * 67 = 9.05, 10 pixels; 3 * 0.5 * 0.082 * 67 = 8.24, 9. */
START_TEST(flip_filters)
{
    pm__flip_filters f;
    pm_error error = {""};
    PM_CHECK_OK(pm__flip_filters_create(67.0, &f, &error), error);
    for (int i = 0; i < PM__CSF_TERMS; i++) {
        ck_assert_uint_eq(f.csf[i].radius, 10);
        PM_CHECK_NEAR(sum_of(&f.csf[i], 1), 1.0, 1e-14);
    }
    PM_CHECK_NEAR(f.share[2] + f.share[3], 1.0, 1e-15);
    ck_assert_uint_eq(f.edge.radius, 9);
    PM_CHECK_NEAR(sum_of(&f.smooth, 1), 1.0, 1e-14);
    PM_CHECK_NEAR(sum_of(&f.edge, 1), 1.0, 1e-14);
    PM_CHECK_NEAR(sum_of(&f.edge, -1), -1.0, 1e-14);
    PM_CHECK_NEAR(sum_of(&f.point, 1), 1.0, 1e-14);
    PM_CHECK_NEAR(sum_of(&f.point, -1), -1.0, 1e-14);
    ck_assert(f.point.weights[9] < 0.0 && f.edge.weights[9] == 0.0);
    pm__flip_filters_free(&f);
}
END_TEST

/* ---- Identities -------------------------------------------------------------------------------- */

START_TEST(equal_images)
{
    static const size_t sizes[][2] = {{1, 1}, {2, 1}, {1, 30}, {31, 12}};
    for (size_t s = 0; s < 4; s++) {
        pm__image a = random_image(sizes[s][0], sizes[s][1], 3);
        for (size_t i = 0; i < NAMES; i++) {
            pm__measured m = measure(names[i], &a, &a);
            const double perfect = m.larger_is_better ? 1.0 : 0.0;
            ck_assert_msg(m.mean == perfect && m.worst == perfect && m.median == perfect && m.p95 == perfect,
                          "%s of equal images: %.17g", names[i], m.mean);
            pm__measured_free(&m);
        }
        pm__image_free(&a);
    }
}
END_TEST

START_TEST(symmetric_where_said)
{
    static const char *const specs[] = {"mse", "smape", "ssim:grey=none", "flip:grey=none"};
    pm__image a = random_image(20, 20, 3), b = random_image(20, 20, 4);
    for (size_t i = 0; i < 4; i++)
        PM_CHECK_NEAR(mean_of(specs[i], &a, &b), mean_of(specs[i], &b, &a), 1e-14);
    ck_assert(mean_of("relmse", &a, &b) != mean_of("relmse", &b, &a));
    ck_assert(mean_of("mape", &a, &b) != mean_of("mape", &b, &a));
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

/* Times 8, exactly: mse 64 times, all others as they were. */
START_TEST(scale)
{
    pm__image a = random_image(20, 20, 3), b = random_image(20, 20, 4);
    double before[NAMES];
    for (size_t i = 0; i < NAMES; i++)
        before[i] = mean_of(names[i], &a, &b);
    times(&a, 8.0F);
    times(&b, 8.0F);
    for (size_t i = 0; i < NAMES; i++)
        PM_CHECK_NEAR(mean_of(names[i], &a, &b) / (i ? 1.0 : 64.0), before[i], 1e-10 * (1.0 + before[i]));
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

/* 0 to 1, and more noise is more of everything. */
START_TEST(bounds_and_order)
{
    pm__image b = random_image(24, 24, 3), a = random_image(24, 24, 3);
    double last[NAMES] = {0};
    for (int step = 1; step <= 3; step++) {
        state = 99;
        for (size_t i = 0; i < 3 * 24 * 24; i++)
            a.values[i] = b.values[i] * (float)(1.0 + 0.3 * step * (uniform() - 0.5));
        for (size_t i = 0; i < NAMES; i++) {
            pm__measured m = measure(names[i], &a, &b);
            const double wrong = m.larger_is_better ? 1.0 - m.mean : m.mean;
            ck_assert_msg(wrong > last[i], "%s does not grow with the noise", names[i]);
            for (size_t p = 0; p < 24 * 24 && m.within_1; p++)
                ck_assert(m.map[p] >= (m.larger_is_better ? -1.0 : 0.0) && m.map[p] <= 1.0);
            last[i] = wrong;
            pm__measured_free(&m);
        }
    }
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

/* Of the reference's luminances 16 and, more than half, 1: four stops apart. Half black: the median of the rest. */
START_TEST(exposures_of_hdrflip)
{
    const double x = (double)tone_inverse();
    pm__image a = constant(5, 1, (const float[]){1, 1, 1}), b = constant(5, 1, (const float[]){1, 1, 1});
    pm__measured m = measure("hdrflip", &a, &b);
    ck_assert_uint_eq(m.shown.count, 1);
    PM_CHECK_NEAR(m.shown.start, log2(x), 1e-12);
    pm__measured_free(&m);
    b.values[0] = b.values[1] = b.values[2] = 16.0F;
    m = measure("hdrflip", &a, &b);
    ck_assert_uint_eq(m.shown.count, 4);
    PM_CHECK_NEAR(m.shown.start, log2(x / 16.0), 1e-12);
    PM_CHECK_NEAR(m.shown.stop, log2(x), 1e-12);
    pm__measured_free(&m);
    memset(&b.values[3], 0, 9 * sizeof(float)); /* 16, 0, 0, 0, 1 */
    m = measure("hdrflip", &a, &b);
    PM_CHECK_NEAR(m.shown.start, log2(x / 16.0), 1e-12);
    PM_CHECK_NEAR(m.shown.stop, log2(x / 8.5), 1e-12);
    ck_assert_uint_eq(m.shown.count, 2);
    pm__measured_free(&m);
    memset(b.values, 0, 15 * sizeof(float));
    m = measure("hdrflip", &a, &b);
    ck_assert_uint_eq(m.shown.count, 1);
    PM_CHECK_NEAR(m.shown.start, 0.0, 0.0);
    ck_assert(m.mean > 0.9);
    pm__measured_free(&m);
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

/* ---- Edges ------------------------------------------------------------------------------------- */

static void refuse(const char *metric, const pm__image *a, const pm__image *b, pm_status want, const char *text)
{
    pm__measured m;
    pm_error error = {""};
    bool undefined;
    const pm__spec spec = spec_of(metric);
    ck_assert_int_eq(pm__metric_measure(&spec, a, b, &m, &undefined, &error), want);
    ck_assert_msg(strstr(error.text, text) != NULL, "'%s' lacks '%s'", error.text, text);
    ck_assert(!undefined);
    pm__measured_free(&m);
}

START_TEST(images_that_are_refused)
{
    pm__image a = random_image(4, 3, 1), b = random_image(3, 4, 1), none = {0}, grey;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(4, 3, 1, &grey, &error), error);
    for (size_t i = 0; i < NAMES; i++) {
        refuse(names[i], &a, &b, PM_EINVAL, "different sizes: 4 x 3, the reference 3 x 4");
        refuse(names[i], NULL, &a, PM_EINVAL, "the tested image: no pixels");
        refuse(names[i], &a, &none, PM_EINVAL, "the reference: no pixels");
        refuse(names[i], &grey, &a, PM_EINVAL, "the tested image: has no R G B");
    }
    a.values[3 * 6 + 2] = NAN;
    a.values[3 * 7] = -INFINITY;
    refuse("mse", &a, &a, PM_EFORMAT, "the tested image: 2 of 36 values are not finite, the first B of pixel (2, 1)");
    pm__image_free(&a);
    pm__image_free(&b);
    pm__image_free(&grey);
}
END_TEST

/* An error relative to black has no value; where nothing differs it is 0, and smape always has one. */
START_TEST(black_references)
{
    pm__image a = constant(3, 3, (const float[]){1, 1, 1}), black = constant(3, 3, (const float[]){0, 0, 0});
    static const char *const undefined_ones[] = {"relmse", "mape"};
    for (int i = 0; i < 2; i++) {
        pm__measured m;
        pm_error error = {""};
        bool undefined;
        const pm__spec spec = spec_of(undefined_ones[i]);
        ck_assert_int_eq(pm__metric_measure(&spec, &a, &black, &m, &undefined, &error), PM_EINVAL);
        ck_assert(undefined);
        ck_assert_ptr_nonnull(strstr(error.text, "the reference is black in pixel (0, 0)"));
        pm__measured_free(&m);
        PM_CHECK_NEAR(mean_of(undefined_ones[i], &black, &black), 0.0, 0.0);
    }
    PM_CHECK_NEAR(mean_of("relmse:unit=one", &a, &black), 100.0, 1e-12);
    PM_CHECK_NEAR(mean_of("smape:epsilon=0", &a, &black), 1.0, 0.0);
    ck_assert(mean_of("flip", &a, &black) > 0.9 && mean_of("ssim", &a, &black) < 0.1);
    pm__image_free(&a);
    pm__image_free(&black);
}
END_TEST

/* The largest and smallest numbers that images hold give numbers; as an image they are cut to what a float holds. */
START_TEST(extremes)
{
    pm__image a = random_image(12, 9, 1), b = random_image(12, 9, 2);
    const float values[] = {FLT_MAX, -FLT_MAX, FLT_MIN, 1e-45F, 0.0F, -0.0F, 1e30F, -1e-45F};
    for (size_t i = 0; i < 3 * 12 * 9; i++) {
        a.values[i] = values[i % 8];
        b.values[i] = values[i % 7];
    }
    for (int turn = 0; turn < 2; turn++) {
        for (size_t i = 0; i < NAMES; i++) {
            pm__measured m = measure(names[i], &a, &b);
            pm__image image;
            pm_error error = {""};
            ck_assert_msg(isfinite(m.mean) && isfinite(m.worst), "%s: %g", names[i], m.mean);
            PM_CHECK_OK(pm__measured_image(&m, &image, &error), error);
            for (size_t p = 0; p < 12 * 9; p++)
                ck_assert_msg(isfinite(image.values[p]) && isfinite(m.map[p]), "%s: %g", names[i], m.map[p]);
            pm__image_free(&image);
            pm__measured_free(&m);
        }
        for (size_t i = 0; i < 3 * 12 * 9; i++) /* nothing but the smallest */
            b.values[i] = i % 5 ? 1e-45F : 0.0F;
    }
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

START_TEST(names_that_are_misspelt)
{
    pm__spec spec;
    pm_error error = {""};
    ck_assert_int_eq(pm__spec_parse(&pm__metrics, "flop", &spec, &error), PM_ENAME);
    ck_assert_ptr_nonnull(strstr(error.text, "did you mean 'flip'"));
    ck_assert_int_eq(pm__spec_parse(&pm__metrics, "flip:ppd=0", &spec, &error), PM_EINVAL);
    ck_assert_uint_eq(pm__metrics.count, NAMES);
    for (size_t i = 0; i < NAMES; i++)
        ck_assert_str_eq(pm__metrics.entries[i]->name, names[i]);
}
END_TEST

PM_TEST_MAIN("metrics", mse_by_hand, relative_errors_by_hand, signs_count_in_differences_only, ssim_of_constants,
             the_median_is_middle_grey, flip_of_constants, colours_there_and_back, flip_filters, equal_images,
             symmetric_where_said, scale, bounds_and_order, exposures_of_hdrflip, images_that_are_refused,
             black_references, extremes, names_that_are_misspelt)
