/* The error that a film of one trial of independent samples says its pixels have: of n samples
 *     variance of the mean = sum (x - mean)^2 / (n (n - 1)). */
#include "../test.h"

#include "../../src/methods/film.h"

START_TEST(of_planted_samples)
{
    static const double samples[] = {1.0, 2.0, 3.0, 6.0}; /* mean 3, squares of deviations 4 + 1 + 0 + 9 = 14 */
    const pm__render_config config = {.width = 1, .height = 1, .trials = 1, .aov = true};
    const pm__render_job job = {.config = &config, .images = 1};
    pm__film film;
    pm_error error = {""};
    PM_CHECK_OK(pm__film_create(&job, false, &film, &error), error);
    for (size_t i = 0; i < 4; i++) {
        const pm__sample sample = {.radiance = {samples[i], 2.0 * samples[i], 7.0}};
        pm__film_add(&film, 0, &sample, NULL);
    }
    pm__film_end_trial(&film);
    PM_CHECK_NEAR(film.first[0][0], 3.0, 1e-15);
    PM_CHECK_NEAR(film.square[0][0], 14.0 / 12.0, 1e-14);
    PM_CHECK_NEAR(film.square[0][1], 4.0 * 14.0 / 12.0, 1e-14);
    PM_CHECK_NEAR(film.square[0][2], 0.0, 1e-14);
    pm__film_destroy(&film);
}
END_TEST

/* Of one sample nothing is known of its error. */
START_TEST(of_one_sample)
{
    const pm__render_config config = {.width = 1, .height = 1, .trials = 1, .aov = true};
    const pm__render_job job = {.config = &config, .images = 1};
    const pm__sample sample = {.radiance = {5.0, 5.0, 5.0}};
    pm__film film;
    pm_error error = {""};
    PM_CHECK_OK(pm__film_create(&job, false, &film, &error), error);
    pm__film_add(&film, 0, &sample, NULL);
    pm__film_end_trial(&film);
    ck_assert_double_eq(film.square[0][0], 0.0);
    pm__film_destroy(&film);
}
END_TEST

PM_TEST_MAIN("film error", of_planted_samples, of_one_sample)
