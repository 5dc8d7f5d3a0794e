/* Renders against closed forms. Renders of different seeds are the replicates; Student's bound for a false alarm in
 * 1e-6 over the file (CHECKS comparisons, two-sided). */
#include "../../src/cli/parallel.h"
#include "../../src/stats/stats.h"
#include "../picture.h"

enum { REPEATS = 24, CHECKS = 40, SIDE = 24 };

static const double pi = 3.14159265358979323846;

typedef struct mean_of {
    double mean, error; /* standard error */
} mean_of;

static mean_of settle(const double values[REPEATS])
{
    mean_of m = {0.0, 0.0};
    double square = 0.0;
    for (int i = 0; i < REPEATS; i++)
        m.mean += values[i] / REPEATS;
    for (int i = 0; i < REPEATS; i++)
        square += (values[i] - m.mean) * (values[i] - m.mean);
    m.error = sqrt(square / (REPEATS * (REPEATS - 1.0)));
    return m;
}

/* allowed: what the expectation itself may be off. */
static void check_mean(const char *what, const double values[REPEATS], double want, double allowed)
{
    const mean_of m = settle(values);
    const double bound = pm__student_quantile(1.0 - 0.5e-6 / CHECKS, REPEATS - 1.0);
    ck_assert_msg(fabs(m.mean - want) <= allowed + bound * m.error + 1e-6 * fabs(want),
                  "%s: %.6f, expected %.6f, %.1f standard errors", what, m.mean, want, (m.mean - want) / m.error);
}

static picture *picture_small(const char *scene, const char *method, const char *estimators, const pm__view *view)
{
    static size_t threads;
    static pm_parallel parallel;
    parallel = pm__parallel_for(&threads);
    picture *const p = picture_create(scene, method, estimators);
    p->config.width = p->config.height = SIDE;
    p->config.view = view;
    p->config.aov = true;
    p->config.parallel = &parallel;
    return p;
}

/* ---- Estimates --------------------------------------------------------------------------------- */

static const struct {
    const char *spec;
    double excess; /* times 1/(k - 1): the known bias of independent photons on flat irradiance */
} kinds[] = {{"disc", 1.0}, {"disc:last=none", 0.0}, {"cone:k=1,last=none", 0.0}, {"epanechnikov:last=none", 0.0},
             {"combined:deal=random,last=none", 0.0}, {"combined:deal=separate,last=none", 0.0}};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* Mean error over the image, beside what is known of it. */
static void check_estimates(const char *scene, const pm__view *view, size_t k, size_t photons, double allowed)
{
    char all[400] = "";
    for (size_t i = 0; i < KINDS; i++)
        (void)snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? "," : "", kinds[i].spec);
    picture *const p = picture_small(scene, "visualize", all, view);
    double errors[KINDS][REPEATS];
    p->config.photons = photons;
    p->config.k = k;
    p->config.spp = 1;
    for (uint64_t seed = 0; seed < REPEATS; seed++) {
        p->config.seed = 1000 + seed;
        pm__render_result result = picture_render(p);
        ck_assert_str_eq(result.truth, "exact");
        for (size_t i = 0; i < KINDS; i++)
            errors[i][seed] = result.images[i].mean_error;
        pm__render_free(&result);
    }
    for (size_t i = 0; i < KINDS; i++)
        check_mean(kinds[i].spec, errors[i], kinds[i].excess / ((double)k - 1.0), allowed);
    picture_free(p);
}

/* The middle of the floor under the light: E varies over 1 m, a lookup takes 2 cm. */
START_TEST(irradiance_under_a_square)
{
    const pm__view view = {.eye = {0, -0.8, 0.9}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.5};
    check_estimates("scene:rect-light", &view, 20, 20000, 1e-3);
}
END_TEST

/* Photons sent to the floor alone: of a lamp that shines all around less than half of them are left, and the light is
 * the same. */
START_TEST(photons_that_are_aimed)
{
    const pm__view view = {.eye = {0, -0.8, 0.9}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.5};
    picture *const p = picture_small("scene:point-light", "visualize:aim=objects", "disc:last=none", &view);
    picture *const all = picture_small("scene:point-light", "visualize", "disc:last=none", &view);
    double errors[REPEATS];
    p->config.photons = all->config.photons = 20000;
    p->config.k = all->config.k = 20;
    p->config.spp = all->config.spp = 1;
    for (uint64_t seed = 0; seed < REPEATS; seed++) {
        p->config.seed = all->config.seed = 500 + seed;
        pm__render_result aimed = picture_render(p), plain = picture_render(all);
        errors[seed] = aimed.images[0].mean_error;
        ck_assert_uint_lt(aimed.emitted, plain.emitted / 2);
        pm__render_free(&aimed);
        pm__render_free(&plain);
    }
    check_mean("aim=objects", errors, 0.0, 1e-3);
    picture_free(p);
    picture_free(all);
}
END_TEST

/* Radiance of a glossy plane: every photon comes from one direction, so that the BRDF is common to all. */
START_TEST(radiance_of_a_glossy_plane)
{
    const pm__view view = {.eye = {1.2, 0.5, 1.0}, .at = {0.5, 0.5, 0}, .up = {0, 0, 1}, .angle = 0.3};
    check_estimates("scene:glossy-plane", &view, 20, 10000, 1e-4);
}
END_TEST

/* The floor of still water, through its surface: what is seen is T / n^2 of what leaves it, in truth and estimate. */
START_TEST(a_floor_through_water)
{
    pm__view view = {.eye = {0, -0.2, 2.6}, .at = {0, 0, 0}, .up = {0, 1, 0}, .angle = 0.7};
    const double n = 1.33, t = 1.0 - pow((n - 1.0) / (n + 1.0), 2), foot = .3192943474;
    picture *const p = picture_small("scene:water", "visualize", "disc:last=none", &view);
    double errors[REPEATS];
    p->config.photons = 20000;
    p->config.k = 20;
    for (uint64_t seed = 0; seed < REPEATS; seed++) {
        p->config.seed = seed;
        pm__render_result result = picture_render(p);
        errors[seed] = result.images[0].mean_error;
        pm__render_free(&result);
    }
    check_mean("through water", errors, 0.0, 2e-3);
    /* The truth itself. At the foot, from straight above: a sample is T-th by chance, and has 1 / n^2. */
    view.angle = 0.02;
    view.eye[1] = 0.0;
    p->config.photons = 100;
    for (uint64_t seed = 0; seed < REPEATS; seed++) {
        p->config.seed = seed;
        pm__render_result result = picture_render(p);
        errors[seed] = picture_mean(&result.images[0].truth, 0);
        pm__render_free(&result);
    }
    check_mean("its truth", errors, foot / pi * t / (n * n), 1e-3 * foot / pi);
    picture_free(p);
}
END_TEST

/* Noise over trials: 1/sqrt(k - 2) of the estimate (for N photons in all its variance is 1 - (k - 1)/N of that). */
START_TEST(noise_over_trials)
{
    const pm__view view = {.eye = {1.2, 0.5, 1.0}, .at = {0.5, 0.5, 0}, .up = {0, 0, 1}, .angle = 0.3};
    enum { TRIALS = 12, K = 20, PHOTONS = 5000 };
    picture *const p = picture_small("scene:glossy-plane", "visualize", "disc:last=none", &view);
    double ratio[REPEATS];
    p->config.photons = PHOTONS;
    p->config.k = K;
    p->config.spp = 1;
    p->config.trials = TRIALS;
    p->config.width = p->config.height = 16;
    for (uint64_t seed = 0; seed < REPEATS; seed++) {
        double noise = 0.0, truth = 0.0, mean = 0.0;
        p->config.seed = 50 + seed;
        pm__render_result result = picture_render(p);
        const pm__render_images *const images = &result.images[0];
        mean = picture_mean(&images->truth, 0);
        for (size_t i = 0; i < 256; i++) {
            noise += pow((double)images->noise.values[3 * i], 2);
            truth += pow((double)images->truth.values[3 * i] / mean, 2);
        }
        ratio[seed] = noise / truth;
        pm__render_free(&result);
    }
    check_mean("variance over trials", ratio, (1.0 - (K - 1.0) / PHOTONS) / (K - 2.0), 1e-3 / (K - 2.0));
    picture_free(p);
}
END_TEST

/* ---- Path tracing ------------------------------------------------------------------------------ */

static void path_means(const char *scene, const pm__view *view, size_t spp, double means[REPEATS])
{
    picture *const p = picture_small(scene, "path", "disc", view);
    p->config.aov = false;
    p->config.spp = spp;
    for (uint64_t seed = 0; seed < REPEATS; seed++) {
        p->config.seed = seed;
        pm__render_result result = picture_render(p);
        means[seed] = picture_mean(&result.images[0].radiance, 1);
        pm__render_free(&result);
    }
    picture_free(p);
}

START_TEST(the_furnace)
{
    static const char *const scenes[] = {"scene:furnace:albedo=0", "scene:furnace:albedo=0.5",
                                         "scene:furnace:albedo=0.8"};
    static const double albedo[] = {0.0, 0.5, 0.8};
    for (int i = 0; i < 3; i++) {
        double means[REPEATS];
        path_means(scenes[i], NULL, 2, means);
        check_mean(scenes[i], means, 1.0 / (1.0 - albedo[i]), 0.0);
    }
}
END_TEST

/* White floor: E / pi, over the very samples of the pixels. */
START_TEST(direct_light_of_a_square)
{
    const pm__view view = {.eye = {0, -0.8, 0.9}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.9};
    picture *const truth = picture_small("scene:rect-light", "visualize", "disc", &view);
    double means[REPEATS];
    path_means("scene:rect-light", &view, 2, means);
    truth->config.photons = 100;
    for (uint64_t seed = 0; seed < REPEATS; seed++) {
        truth->config.seed = seed;
        pm__render_result result = picture_render(truth);
        means[seed] /= picture_mean(&result.images[0].truth, 1);
        pm__render_free(&result);
    }
    check_mean("path under a square", means, 1.0, 0.0);
    picture_free(truth);
}
END_TEST

/* A point light of 1 W half way to the wall, in a sphere of albedo rho: L = rho / pi (direct + rho / (1 - rho) / 4 pi).
 * Seen from the light, the whole of the wall: direct is Phi cos / (4 pi d^2), with d and cos of the wall's point. */
static double sphere_radiance(const pm__view *view, double rho)
{
    pm_error error;
    pm__camera camera;
    double sum = 0.0;
    enum { FINE = 200 };
    PM_CHECK_OK(pm__camera_init(view, FINE, FINE, &camera, &error), error);
    for (int i = 0; i < FINE * FINE; i++) {
        double d[3], at[3], way[3], square = 0.0;
        pm__camera_direction(&camera, i % FINE + 0.5, i / FINE + 0.5, d);
        const double b = pm__dot(d, view->eye), c = pm__dot(view->eye, view->eye) - 1.0, t = -b + sqrt(b * b - c);
        for (int a = 0; a < 3; a++) {
            at[a] = view->eye[a] + t * d[a];
            way[a] = at[a] - (a == 0 ? 0.5 : 0.0);
            square += way[a] * way[a];
        }
        sum += pm__dot(way, at) / sqrt(square) / (4.0 * pi * square);
    }
    return rho / pi * (sum / (FINE * FINE) + rho / (1.0 - rho) / (4.0 * pi));
}

START_TEST(the_integrating_sphere)
{
    const pm__view view = {.eye = {-0.5, 0.1, 0}, .at = {1, 0.3, 0.2}, .up = {0, 0, 1}, .angle = 1.4};
    double means[REPEATS];
    path_means("scene:integrating-sphere:albedo=0.7", &view, 4, means);
    const double want = sphere_radiance(&view, 0.7);
    check_mean("path in the integrating sphere", means, want, 1e-4 * want);
}
END_TEST

PM_TEST_MAIN("render", irradiance_under_a_square, photons_that_are_aimed, radiance_of_a_glossy_plane,
             a_floor_through_water, noise_over_trials, the_furnace, direct_light_of_a_square, the_integrating_sphere)
