/* What storage policies are measured by: the view, errors told without the noise that trials share, pictures. */
#include "../test.h"

#include "../../cases/scenes/list.h"
#include "../../src/base/random.h"
#include "../../src/image/false_colour.h"
#include "../../src/image/png.h"
#include "../../src/methods/stage.h"
#include "../../src/storage/lights.h"
#include "../../src/storage/tally.h"
#include "../../src/storage/viewing.h"

#include <png.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- The view ---------------------------------------------------------------------------------- */

enum { SIDE = 4 };

/* The inside of a sphere of radius 1 and this albedo, lit from its middle, with a small mirror behind the camera, so
 * that there are caustics. */
static pm__scene *make_ball(double albedo)
{
    const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {albedo, albedo, albedo}};
    const pm__material glass = {.kind = PM__MIRROR, .specular = {1.0, 1.0, 1.0}};
    const pm__light light = {.kind = PM__POINT, .position = {0.0, 0.0, 0.0}, .power = {1.0, 1.0, 1.0}};
    const double centre[3] = {0.0, 0.0, 0.0}, corner[3] = {-0.05, 0.8, -0.05}, u[3] = {0.1, 0.0, 0.0};
    const double v[3] = {0.0, 0.0, 0.1};
    pm_error error = {""};
    pm__scene *scene;
    uint32_t index;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__scene_material(scene, &wall, &index, &error), error);
    PM_CHECK_OK(pm__scene_sphere(scene, index, centre, 1.0, true, &error), error);
    PM_CHECK_OK(pm__scene_material(scene, &glass, &index, &error), error);
    PM_CHECK_OK(pm__scene_rectangle(scene, index, corner, u, v, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, &light, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

/* Two photons of this power, one of which comes from the front of whatever surface: fewer than a lookup wants, so that
 * the estimate is one's power over the whole of the lookup's disc, wherever that is. */
static pm_map *make_even_map(float power)
{
    pm_photon photons[2];
    pm_error error = {""};
    pm_map *map;
    for (int i = 0; i < 2; i++)
        photons[i] = (pm_photon){.direction = {i ? 0.36F : -0.36F, i ? 0.48F : -0.48F, i ? 0.8F : -0.8F},
                                 .power = {power, 2.0F * power, 3.0F * power}};
    PM_CHECK_OK(pm_map_create(photons, 2, NULL, &map, &error), error);
    return map;
}

static pm__viewing *make_viewing(const pm__scene *scene, const pm__camera *camera, const pm__image *reference,
                                 size_t samples)
{
    const pm__viewing_config config = {.scene = scene,
                                       .camera = camera,
                                       .reference = reference,
                                       .width = 2 * SIDE,
                                       .height = 2 * SIDE,
                                       .samples = samples,
                                       .deep = 2 * samples,
                                       .gather = 3,
                                       .near = 0.0,
                                       .k = 50,
                                       .radius = 4.0,
                                       .photons = 200,
                                       .seed = 3};
    pm_error error = {""};
    pm__viewing *viewing;
    PM_CHECK_OK(pm__viewing_create(&config, &viewing, &error), error);
    return viewing;
}

static void look(const pm__viewing *viewing, pm__map_kind kind, pm_map *map, float *errors)
{
    ck_assert_int_eq(pm__viewing_errors(viewing, kind, map, errors), PM_OK);
    pm_map_destroy(map);
}

/* A map whose irradiance is E everywhere adds albedo / pi E to every pixel as a caustic map, which first points look
 * into, and as a global map too where the albedo is 1, for then every ray of gathering goes on with its full weight: L
 * = 1 / pi (irradiance pi L') and L' = E / pi. Relative to the reference's mean, 2. Exact but for floats. */
START_TEST(even_light_gives_an_even_image)
{
    pm_error error = {""};
    pm__scene *const scene = make_ball(1.0);
    const pm__view view = {.eye = {0.0, 0.0, 0.0}, .at = {0.0, -1.0, 0.0}, .up = {0.0, 0.0, 1.0}, .angle = 0.8};
    pm__camera camera;
    pm__image reference;
    PM_CHECK_OK(pm__camera_init(&view, 2 * SIDE, 2 * SIDE, &camera, &error), error);
    PM_CHECK_OK(pm__image_create(SIDE, SIDE, 3, &reference, &error), error);
    for (int i = 0; i < 3 * SIDE * SIDE; i++)
        reference.values[i] = 2.0F;
    pm__viewing *const viewing = make_viewing(scene, &camera, &reference, 2);
    const size_t values = pm__viewing_values(viewing);
    ck_assert_uint_eq(values, 3 * SIDE * SIDE);
    ck_assert(pm__viewing_has(viewing, PM__CAUSTIC_MAP) && pm__viewing_has(viewing, PM__GLOBAL_MAP));
    float *const dark = malloc(PM__GROUPS * values * sizeof *dark);
    float *const lit = malloc(PM__GROUPS * values * sizeof *lit);
    for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
        pm_map *none;
        PM_CHECK_OK(pm_map_create(NULL, 0, NULL, &none, &error), error);
        look(viewing, (pm__map_kind)kind, none, dark);
        look(viewing, (pm__map_kind)kind, make_even_map(2.0F), lit);
        for (size_t i = 0; i < PM__GROUPS * values; i++) {
            const double irradiance = 2.0 * (double)(i % 3 + 1) / (pi * 16.0); /* over a disc of 4 m */
            PM_CHECK_NEAR((double)(lit[i] - dark[i]), irradiance / pi / 2.0, 1e-6);
        }
    }
    /* With the large map itself the image is that of large maps: what was taken off comes back. */
    ck_assert_int_eq(pm__viewing_errors(viewing, PM__GLOBAL_MAP, pm__viewing_global(viewing), lit), PM_OK);
    for (size_t i = 0; i < values; i++) /* of the first group, whose map it is */
        PM_CHECK_NEAR((double)lit[i], (double)pm__viewing_base(viewing)[i], 1e-5);
    free(dark);
    free(lit);
    pm__viewing_destroy(viewing);
    pm__image_free(&reference);
    pm__scene_destroy(scene);
}
END_TEST

/* Lights that are asked by turns give what all of them give, on average: over 20000 numbers at one place of the maze,
 * within 6 standard errors (false alarms 2e-9). Few of its 64 lamps light it. */
START_TEST(lights_by_turns)
{
    enum { DRAWS = 20000 };
    pm_error error = {""};
    pm__spec spec;
    pm__stage stage;
    pm__lights lights;
    double sum[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, "scene:maze:rooms=8", &spec, &error), error);
    PM_CHECK_OK(pm__stage_open(&spec, NULL, 16, 16, &stage, &error), error);
    ck_assert_int_eq(pm__lights_choose(stage.scene, &stage.camera, 16, 16, 1, &lights), PM_OK);
    ck_assert_uint_eq(lights.count, pm__scene_light_count(stage.scene));
    ck_assert_uint_gt(lights.always, 0);
    ck_assert_uint_lt(lights.always, lights.count);
    lights.always = 0; /* so that the others make a difference */
    for (uint64_t i = 0; i < DRAWS; i++) {
        const pm__eye_numbers numbers = pm__eye_numbers_of(5, 0, 0, i);
        pm__eye eye;
        pm__eye_through(&eye, stage.scene, &stage.camera, &numbers, 8.0, 12.0);
        ck_assert(pm__eye_follow(&eye));
        for (int way = 0; way < 2; way++) {
            double radiance[3] = {0.0, 0.0, 0.0};
            if (way)
                pm__lights_add(&lights, &eye, radiance);
            else
                pm__eye_direct(&eye, false, radiance);
            sum[way] += radiance[0];
            square[way] += radiance[0] * radiance[0];
        }
    }
    double variance = 0.0;
    for (int way = 0; way < 2; way++)
        variance += (square[way] / DRAWS - sum[way] / DRAWS * sum[way] / DRAWS) / DRAWS;
    ck_assert_double_gt(sum[0], 0.0);
    PM_CHECK_NEAR(sum[1] / DRAWS, sum[0] / DRAWS, 6.0 * sqrt(variance));
    pm__lights_free(&lights);
    pm__stage_close(&stage);
}
END_TEST

/* ---- Errors ------------------------------------------------------------------------------------ */

enum { VALUES = 4000, TRIALS = 4, RUNS = 40 };

static double normal(uint64_t number)
{
    double u[2];
    pm__random_uniform(11, PM__FOR_TESTS, 0, number, u, 2);
    return sqrt(-2.0 * log(1.0 - u[0])) * cos(2.0 * pi * u[1]);
}

/* Errors with a bias that differs from value to value (mean square 0.04), noise of trials (0.09), of eye paths by
 * group (0.25, the same in all trials, as in the image with large maps), and of the reference (0.16, the same in all
 * groups): bias + trials is what there is to be told. */
static void make_errors(uint64_t run, size_t trial, bool base, float *errors)
{
    for (uint64_t i = 0; i < VALUES; i++) {
        const uint64_t seed = (run * VALUES + i) * 64;
        const double shared = (i % 2 ? 0.2 : -0.2) + 0.4 * normal(seed);
        const double own = base ? 0.0 : 0.3 * normal(seed + 1 + trial);
        for (uint64_t g = 0; g < PM__GROUPS; g++)
            errors[g * VALUES + i] = (float)(shared + own + 0.5 * normal(seed + 32 + g));
    }
}

/* Means over RUNS runs against what they are to be, at 7 standard errors by Student with 39 degrees of
 * freedom: three of them, false alarms 7e-8. */
START_TEST(errors_are_unbiased)
{
    static float errors[PM__GROUPS * VALUES], base[PM__GROUPS * VALUES];
    const double want[3] = {0.04 + 0.09, 0.04, 0.09};
    double sum[3] = {0.0, 0.0, 0.0}, square[3] = {0.0, 0.0, 0.0};
    for (uint64_t run = 0; run < RUNS; run++) {
        pm__tally tally;
        make_errors(run, 0, true, base);
        ck_assert_int_eq(pm__tally_create(VALUES, TRIALS, 0.16, base, &tally), PM_OK);
        for (size_t t = 0; t < TRIALS; t++) {
            make_errors(run, t, false, errors);
            pm__tally_add(&tally, errors);
        }
        /* Squares of roots lose what is below 0: never here, by far. */
        const pm__view_error e = pm__tally_error(&tally);
        const double got[3] = {e.rmse * e.rmse, e.rms_bias * e.rms_bias, e.added * e.added};
        PM_CHECK_NEAR(e.noise * e.noise, got[0] - got[1], 1e-9);
        ck_assert(e.added_ci95.low < e.added && e.added < e.added_ci95.high && e.rmse_ci95.high > e.rmse);
        for (int i = 0; i < 3; i++) {
            sum[i] += got[i];
            square[i] += got[i] * got[i];
        }
        pm__tally_free(&tally);
    }
    for (int i = 0; i < 3; i++) {
        const double mean = sum[i] / RUNS, error = sqrt((square[i] / RUNS - mean * mean) / (RUNS - 1));
        PM_CHECK_NEAR(mean, want[i], 7.0 * error);
        ck_assert_double_lt(error, 0.002);
    }
}
END_TEST

/* Without noise all is plain: e = 0.5 in half of the values and 0.1 in the others. */
START_TEST(errors_without_noise)
{
    float errors[PM__GROUPS * 2], base[PM__GROUPS * 2] = {0.0F};
    pm__tally tally;
    for (int g = 0; g < PM__GROUPS; g++) {
        errors[2 * g] = 0.5F;
        errors[2 * g + 1] = 0.1F;
    }
    ck_assert_int_eq(pm__tally_create(2, 3, 0.0, base, &tally), PM_OK);
    ck_assert(isnan(pm__tally_error(&tally).rmse));
    pm__tally_add(&tally, errors);
    ck_assert(isnan(pm__tally_error(&tally).noise) && isnan(pm__tally_error(&tally).rmse_ci95.low));
    pm__tally_add(&tally, errors);
    pm__tally_add(&tally, errors);
    const pm__view_error e = pm__tally_error(&tally);
    PM_CHECK_NEAR(e.bias, 0.3, 1e-7);
    PM_CHECK_NEAR(e.rmse, sqrt(0.13), 1e-7);
    PM_CHECK_NEAR(e.rms_bias, sqrt(0.13), 1e-7);
    PM_CHECK_NEAR(e.added, sqrt(0.13), 1e-7);
    PM_CHECK_NEAR(e.noise, 0.0, 1e-3);
    PM_CHECK_NEAR(e.rmse_ci95.low, e.rmse, 1e-6);
    pm__tally_free(&tally);
}
END_TEST

/* The jackknife of a mean is the textbook's: t(0.975, 4) = 2.776445105 times sd / sqrt(5) of 1, 2, 4, 8, 10. */
START_TEST(jackknife)
{
    const double x[5] = {1.0, 2.0, 4.0, 8.0, 10.0};
    double without[5];
    for (int i = 0; i < 5; i++)
        without[i] = (25.0 - x[i]) / 4.0;
    PM_CHECK_NEAR(pm__jackknife_half(without, 5), 2.776445105 * sqrt(15.0 / 5.0), 1e-7);
    ck_assert(isnan(pm__jackknife_half(without, 1)));
}
END_TEST

/* ---- Pictures ---------------------------------------------------------------------------------- */

START_TEST(colours_and_png)
{
    pm_error error = {""};
    pm__image image;
    pm__picture picture;
    double low, high;
    uint8_t want[3];
    PM_CHECK_OK(pm__image_create(64, 32, 1, &image, &error), error);
    for (size_t i = 0; i < 64 * 32; i++)
        image.values[i] = (float)(20.0 * pow(10.0, 2.0 * (double)(i / 64) / 31.0)); /* 20 to 2000 */
    pm__colour_range(&image, &low, &high);
    PM_CHECK_NEAR(low, 10.0, 1e-12);
    PM_CHECK_NEAR(high, 1e4, 1e-9);
    image.values[0] = NAN;
    image.values[1] = 0.0F;
    PM_CHECK_OK(pm__colour_scale(&image, low, high, &picture, &error), error);
    ck_assert_uint_gt(picture.width, 512);
    ck_assert_int_eq(picture.pixels[0][0] + picture.pixels[0][1] + picture.pixels[0][2], 0);
    ck_assert_int_eq(picture.pixels[8][0], 48);
    pm__colour_of(log(2000.0 / low) / log(high / low), want);
    ck_assert_int_eq(memcmp(picture.pixels[(picture.height - 1) * picture.width], want, 3), 0);

    char *bytes = NULL;
    size_t size = 0;
    FILE *const file = open_memstream(&bytes, &size);
    PM_CHECK_OK(pm__png_write(file, (const uint8_t(*)[3])picture.pixels, picture.width, picture.height, "a", NULL,
                              &error), error);
    ck_assert_int_eq(fclose(file), 0);
    png_image read = {.version = PNG_IMAGE_VERSION};
    ck_assert_int_ne(png_image_begin_read_from_memory(&read, bytes, size), 0);
    read.format = PNG_FORMAT_RGB;
    ck_assert_uint_eq(read.width, picture.width);
    ck_assert_uint_eq(read.height, picture.height);
    uint8_t *const pixels = malloc(PNG_IMAGE_SIZE(read));
    ck_assert_int_ne(png_image_finish_read(&read, NULL, pixels, 0, NULL), 0);
    ck_assert_int_eq(memcmp(pixels, picture.pixels, PNG_IMAGE_SIZE(read)), 0);
    ck_assert_int_eq(pm__png_write(stderr, NULL, 0, 1, NULL, NULL, &error), PM_EINVAL);
    free(pixels);
    free(bytes);
    pm__picture_free(&picture);
    pm__image_free(&image);
}
END_TEST

PM_TEST_MAIN("storage", even_light_gives_an_even_image, lights_by_turns, errors_are_unbiased,
             errors_without_noise, jackknife, colours_and_png)
