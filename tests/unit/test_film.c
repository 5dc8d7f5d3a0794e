/* From samples to images: planted samples whose means, biases, noises and errors are known. */
#include "../picture.h"

#include "../../src/methods/film.h"

enum { WIDTH = 20, HEIGHT = 18, PIXELS = WIDTH * HEIGHT, IMAGES = 2 }; /* tiles of 16: four, three of them cut */

static pm__render_config config = {.width = WIDTH, .height = HEIGHT, .aov = true, .trials = 3};

static pm__film film_of(bool truth)
{
    const pm__render_job job = {.config = &config, .images = IMAGES, .truth = truth};
    pm_error error = {""};
    pm__film film;
    PM_CHECK_OK(pm__film_create(&job, true, &film, &error), error);
    ck_assert_uint_eq(film.tiles, 4);
    return film;
}

/* What is planted: of image i, pixel, band, trial and pass. */
static double value(size_t i, size_t pixel, int b, uint32_t trial, uint32_t pass)
{
    return 1.0 + 0.01 * (double)pixel + 0.5 * b + 0.25 * trial * (double)(i + 1) + 0.125 * pass;
}

static double truth_of(size_t pixel, int b)
{
    return pixel % 7 == 3 && b == 1 ? (double)NAN : 2.0 + 0.01 * (double)pixel - 0.125 * b;
}

static void plant_tile(pm__film *film, size_t tile, uint32_t trial, uint32_t pass)
{
    const pm__tile at = pm__film_tile(film, tile, pass, trial);
    const size_t count = pm__tile_pixels(&at), across = at.x1 - at.x0;
    static pm__sample samples[IMAGES * PM__TILE_PIXELS];
    static double truth[PM__TILE_PIXELS][3];
    for (size_t p = 0; p < count; p++) {
        const size_t pixel = (at.y0 + p / across) * WIDTH + at.x0 + p % across;
        for (size_t i = 0; i < IMAGES; i++) {
            pm__sample *const sample = &samples[i * count + p];
            for (int b = 0; b < 3; b++)
                sample->radiance[b] = value(i, pixel, b, trial, pass);
            sample->radius = (float)(trial + pass + i);
            sample->count = (float)(10 * trial + pass);
        }
        for (int b = 0; b < 3; b++)
            truth[p][b] = truth_of(pixel, b);
    }
    pm__film_add(film, tile, samples, film->truth ? (const double(*)[3])truth : NULL);
}

static void plant(pm__film *film, uint32_t trial, uint32_t passes)
{
    for (uint32_t pass = 0; pass < passes; pass++)
        for (size_t tile = 0; tile < film->tiles; tile++)
            plant_tile(film, tile, trial, pass);
    pm__film_end_trial(film);
}

static pm__render_result develop(const pm__film *film, const pm__image *reference)
{
    pm_error error = {""};
    pm__render_result result = {.count = 0};
    PM_CHECK_OK(pm__film_develop(film, reference, true, &result, &error), error);
    ck_assert_uint_eq(result.count, IMAGES);
    return result;
}

static float at(const pm__image *image, size_t pixel, int b)
{
    return image->values[3 * pixel + (size_t)b];
}

START_TEST(tiles_cover_every_pixel_once)
{
    pm__film film = film_of(false);
    int met[PIXELS] = {0};
    for (size_t t = 0; t < film.tiles; t++) {
        const pm__tile tile = pm__film_tile(&film, t, 5, 6);
        ck_assert_uint_eq(tile.pass, 5);
        ck_assert_uint_eq(tile.trial, 6);
        for (size_t y = tile.y0; y < tile.y1; y++)
            for (size_t x = tile.x0; x < tile.x1; x++)
                met[y * WIDTH + x]++;
    }
    for (size_t p = 0; p < PIXELS; p++)
        ck_assert_int_eq(met[p], 1);
    pm__film_destroy(&film);
}
END_TEST

/* Three trials of two passes: the first is shown; bias is of the mean of trials, noise their standard deviation. */
START_TEST(planted_samples_with_a_truth)
{
    pm__film film = film_of(true);
    for (uint32_t trial = 0; trial < 3; trial++)
        plant(&film, trial, 2);
    pm__render_result result = develop(&film, NULL);
    double sum = 0.0, known = 0.0;
    for (size_t p = 0; p < PIXELS; p++)
        for (int b = 0; b < 3; b++)
            if (!isnan(truth_of(p, b))) {
                sum += truth_of(p, b);
                known += 1.0;
            }
    const double mean_truth = sum / known;
    for (size_t i = 0; i < IMAGES; i++) {
        const pm__render_images *const images = &result.images[i];
        double errors = 0.0, squares = 0.0;
        for (size_t p = 0; p < PIXELS; p++)
            for (int b = 0; b < 3; b++) {
                const double truth = truth_of(p, b), first = value(i, p, b, 0, 0) + 0.0625;
                const double step = 0.25 * (double)(i + 1), error = (first - truth) / mean_truth;
                const bool there = !isnan(truth);
                PM_CHECK_NEAR((double)at(&images->radiance, p, b), first, 1e-6);
                PM_CHECK_NEAR((double)at(&images->truth, p, b), there ? truth : 0.0, 1e-6);
                PM_CHECK_NEAR((double)at(&images->error, p, b), there ? error : 0.0, 1e-6);
                PM_CHECK_NEAR((double)at(&images->bias, p, b), there ? error + step / mean_truth : 0.0, 1e-6);
                PM_CHECK_NEAR((double)at(&images->noise, p, b), step / mean_truth, 1e-6); /* of 0, 1, 2 steps: 1 */
                errors += there ? error : 0.0;
                squares += there ? error * error : 0.0;
            }
        PM_CHECK_NEAR(images->mean_error, errors / known, 1e-12);
        PM_CHECK_NEAR(images->rms_error, sqrt(squares / known), 1e-12);
        for (size_t p = 0; p < PIXELS; p++) { /* of the first trial, mean of its passes */
            PM_CHECK_NEAR((double)images->radius.values[p], 0.5 + (double)i, 1e-6);
            PM_CHECK_NEAR((double)images->count.values[p], 0.5, 1e-6);
        }
    }
    pm__render_free(&result);
    pm__film_destroy(&film);
}
END_TEST

/* Over an image's own mean where no truth is known. */
START_TEST(planted_samples_without_a_truth)
{
    pm__film film = film_of(false);
    for (uint32_t trial = 0; trial < 3; trial++)
        plant(&film, trial, 1);
    pm__render_result result = develop(&film, NULL);
    double mean = 0.0;
    for (size_t p = 0; p < PIXELS; p++)
        for (int b = 0; b < 3; b++)
            mean += value(0, p, b, 0, 0) / (3.0 * PIXELS);
    for (size_t i = 0; i < IMAGES; i++) {
        const pm__render_images *const images = &result.images[i];
        ck_assert_ptr_null(images->truth.values);
        ck_assert_ptr_null(images->error.values);
        ck_assert_ptr_null(images->bias.values);
        ck_assert(isnan(images->mean_error) && isnan(images->rms_error));
        for (size_t p = 0; p < PIXELS; p++)
            PM_CHECK_NEAR((double)at(&images->noise, p, 2), 0.25 * (double)(i + 1) / mean, 1e-6);
    }
    pm__render_free(&result);
    pm__film_destroy(&film);
}
END_TEST

/* A reference of half the size: blocks of four pixels; what it does not know is left out. */
START_TEST(blocks_against_a_reference)
{
    pm__film film = film_of(false);
    pm__image reference;
    pm_error error = {""};
    PM_CHECK_OK(pm__image_create(WIDTH / 2, HEIGHT / 2, 3, &reference, &error), error);
    double sum = 0.0, known = 0.0, errors = 0.0, squares = 0.0;
    for (size_t i = 0; i < 3 * PIXELS / 4; i++) {
        reference.values[i] = i % 11 == 5 ? NAN : 1.5f + 0.001f * (float)i;
        sum += i % 11 == 5 ? 0.0 : (double)reference.values[i];
        known += i % 11 == 5 ? 0.0 : 1.0;
    }
    for (uint32_t trial = 0; trial < 3; trial++)
        plant(&film, trial, 1);
    pm__render_result result = develop(&film, &reference);
    const pm__render_images *const images = &result.images[1];
    for (size_t p = 0; p < PIXELS / 4; p++)
        for (int b = 0; b < 3; b++) {
            const size_t corner = p / (WIDTH / 2) * 2 * WIDTH + p % (WIDTH / 2) * 2;
            const double truth = (double)reference.values[3 * p + (size_t)b], scale = known / sum;
            const double block = value(1, corner, b, 0, 0) + 0.01 * (0 + 1 + WIDTH + WIDTH + 1) / 4.0;
            const double off = (block - truth) * scale;
            const bool there = !isnan(truth);
            PM_CHECK_NEAR((double)at(&images->error, p, b), there ? off : 0.0, 1e-6);
            PM_CHECK_NEAR((double)at(&images->bias, p, b), there ? off + 0.5 * scale : 0.0, 1e-6);
            PM_CHECK_NEAR((double)at(&images->noise, p, b), 0.5 * scale, 1e-6);
            errors += there ? off / known : 0.0;
            squares += there ? off * off / known : 0.0;
        }
    PM_CHECK_NEAR(images->mean_error, errors, 1e-10);
    PM_CHECK_NEAR(images->rms_error, sqrt(squares), 1e-10);
    ck_assert_uint_eq(images->radiance.width, WIDTH);
    pm__render_free(&result);
    pm__image_free(&reference);
    pm__film_destroy(&film);
}
END_TEST

START_TEST(references_that_do_not_fit)
{
    static const size_t sizes[][2] = {{40, 36}, {7, 9}, {20, 9}, {10, 18}, {4, 2}};
    pm__film film = film_of(false);
    plant(&film, 0, 1);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        pm_error error = {""};
        pm__image reference;
        pm__render_result result = {.count = 0};
        PM_CHECK_OK(pm__image_create(sizes[i][0], sizes[i][1], 3, &reference, &error), error);
        ck_assert_int_eq(pm__reference_fits(&reference, WIDTH, HEIGHT, &error), PM_EINVAL);
        ck_assert_int_eq(pm__film_develop(&film, &reference, true, &result, &error), PM_EINVAL);
        ck_assert_ptr_nonnull(strstr(error.text, "the reference has"));
        pm__render_free(&result);
        pm__image_free(&reference);
    }
    pm__film_destroy(&film);
}
END_TEST

/* The first trial cut short: tiles with two passes, one and none; each pixel is the mean of what it got. */
START_TEST(a_trial_cut_short)
{
    pm__film film = film_of(true);
    static const uint32_t passes[4] = {2, 1, 0, 1};
    for (size_t tile = 0; tile < 4; tile++)
        for (uint32_t pass = 0; pass < passes[tile]; pass++)
            plant_tile(&film, tile, 0, pass);
    pm__film_end_trial(&film);
    pm__render_result result = develop(&film, NULL);
    const pm__render_images *const images = &result.images[0];
    for (size_t p = 0; p < PIXELS; p++)
        for (int b = 0; b < 3; b++) {
            const uint32_t taken = passes[p / WIDTH / PM__TILE * 2 + p % WIDTH / PM__TILE];
            const double want = taken ? value(0, p, b, 0, 0) + 0.0625 * (taken - 1) : 0.0;
            PM_CHECK_NEAR((double)at(&images->radiance, p, b), want, 1e-6);
            ck_assert(isfinite((double)at(&images->error, p, b)));
        }
    ck_assert_ptr_null(images->noise.values); /* of one trial */
    pm__render_free(&result);
    pm__film_destroy(&film);
}
END_TEST

/* All black: no scale, no infinities. */
START_TEST(a_black_image)
{
    pm__film film = film_of(false);
    static const pm__sample samples[IMAGES * PM__TILE_PIXELS];
    for (int trial = 0; trial < 2; trial++) {
        for (size_t tile = 0; tile < film.tiles; tile++)
            pm__film_add(&film, tile, samples, NULL);
        pm__film_end_trial(&film);
    }
    pm__render_result result = develop(&film, NULL);
    for (size_t p = 0; p < PIXELS; p++)
        PM_CHECK_NEAR((double)at(&result.images[0].noise, p, 0), 0.0, 0.0);
    pm__render_free(&result);
    pm__film_destroy(&film);
}
END_TEST

PM_TEST_MAIN("film", tiles_cover_every_pixel_once, planted_samples_with_a_truth, planted_samples_without_a_truth,
             blocks_against_a_reference, references_that_do_not_fit, a_trial_cut_short, a_black_image)
