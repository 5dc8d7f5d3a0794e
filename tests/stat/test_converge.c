/* Slopes and levels of progressive methods against their laws, on scenes with an exact answer.
 *
 * False alarms: each slope and each level is held within z standard errors of its law, Student's t with 23 degrees of
 * freedom and some 60 comparisons: z = 8 is exceeded by chance about 2e-6 times in all. The law takes radii as they are
 * on average, which is off by about a part in the photons of a lookup: 0.01 of a slope is granted for that. */
#include "../../src/converge/converge.h"
#include "../progress.h"

enum { TRIALS = 24, PASSES = 64 };
static const double z = 8.0, granted = 0.01;

static pm__converge_series measure(const char *scene, const char *method, const char *kernel, double alpha,
                                   double radius)
{
    progress *const p = progress_create(scene, method, kernel, radius);
    pm__converge_series series;
    pm_error error = {""};
    p->config.alpha = alpha;
    p->config.width = p->config.height = 16;
    p->config.photons = 5000;
    p->config.k = 25;
    const pm__converge_config config = {.progressive = p->config, .trials = TRIALS, .passes = PASSES};
    PM_CHECK_OK(pm__converge(&config, &series, &error), error);
    progress_free(p);
    return series;
}

static void check_slope(const pm__converge_series *s, pm__quantity quantity, double predicted, const char *what)
{
    const pm__converge_fit *const fit = &s->fits[quantity];
    ck_assert_msg(fit->fits, "%s: %s", what, fit->detail);
    ck_assert_msg(fabs(fit->slope - predicted) <= z * fit->slope_error + granted,
                  "%s: slope %.4f +- %.4f, predicted %.4f", what, fit->slope, fit->slope_error, predicted);
}

START_TEST(variance_falls_as_the_law_says)
{
    static const struct {
        const char *scene, *method;
    } series[] = {{"scene:plate", "ppm"}, {"scene:water", "ppm:start=first"}, {"scene:point-light", "pppm"},
                  {"scene:water", "sppm"}};
    static const double alphas[] = {0.5, 0.667, 0.8};
    for (size_t i = 0; i < sizeof series / sizeof *series; i++)
        for (size_t a = 0; a < 3; a++) {
            pm__converge_series s = measure(series[i].scene, series[i].method, "disc", alphas[a], 0.0);
            check_slope(&s, PM__VARIANCE, s.fits[PM__VARIANCE].predicted, series[i].scene);
            PM_CHECK_NEAR(s.fits[PM__VARIANCE].asymptote, -alphas[a], 1e-12);
            pm__converge_free(&s);
        }
}
END_TEST

/* A large first radius, so that bias stands clear; along its expected profile, and its size as expected. */
START_TEST(bias_falls_as_the_law_says)
{
    static const double alphas[] = {0.5, 0.667, 0.8};
    for (size_t a = 0; a < 3; a++) {
        pm__converge_series s = measure("scene:point-light", "ppm", "disc", alphas[a], 0.8);
        const pm__converge_row *const last = &s.rows[s.row_count - 1];
        check_slope(&s, PM__BIAS, s.fits[PM__BIAS].predicted, "point-light");
        /* The law's radius is that of an even floor: where light falls off within it, by as much as bias is. */
        ck_assert_msg(fabs(last->along - 1.0) <= z * last->along_error + 0.1, "alpha %g: %.3f of the expected bias",
                      alphas[a], last->along);
        pm__converge_free(&s);
    }
}
END_TEST

/* The two that do not converge: the bias of one pass stays, whatever their noise does. */
START_TEST(averages_level_off)
{
    static const char *const methods[] = {"pm-average", "pm-combine"};
    for (size_t i = 0; i < 2; i++) {
        pm__converge_series s = measure("scene:plate", methods[i], "disc:last=full", 0.5, 0.0);
        check_slope(&s, PM__VARIANCE, -1.0, methods[i]);
        for (size_t r = 3; r < s.row_count; r++) {
            const pm__converge_row *const row = &s.rows[r];
            const double error = (row->rel_bias_ci95.high - row->rel_bias_ci95.low) / 2.0 / 2.069; /* t, 23 */
            ck_assert_msg(fabs(row->rel_bias - row->predicted_rel_bias) <= z * error + 1e-3,
                          "%s after %u passes: bias %.4f +- %.4f, predicted %.4f", methods[i], row->pass,
                          row->rel_bias, error, row->predicted_rel_bias);
        }
        PM_CHECK_NEAR(s.rows[0].predicted_rel_bias, i ? 0.0 : 1.0 / 24.0, 5e-3); /* k = 25: 1/(k-1), and curvature */
        pm__converge_free(&s);
    }
}
END_TEST

/* One map of all photons: the law of a lookup among so many. */
START_TEST(one_map_has_the_law_of_its_size)
{
    pm__converge_series s = measure("scene:water", "pm:beta=0.5", "disc", 0.5, 0.0);
    check_slope(&s, PM__VARIANCE, s.fits[PM__VARIANCE].predicted, "pm");
    PM_CHECK_NEAR(s.fits[PM__VARIANCE].predicted, -0.5, 0.06);
    pm__converge_free(&s);
}
END_TEST

PM_TEST_MAIN("converge", variance_falls_as_the_law_says, bias_falls_as_the_law_says, averages_level_off,
             one_map_has_the_law_of_its_size)
