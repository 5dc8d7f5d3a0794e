/* Importance by the density of importons, against exact integrals of the camera's.
 *
 * Inside a sphere of radius R (here 1 m) light, and importance, from a diffuse bounce falls evenly on all of it, from
 * wherever it comes: with the albedo a and P pixels the global importance is a P / (4 pi R^2). And what is within the
 * distance r of a point on a sphere is a cap of the area pi r^2 exactly, so the estimate has no edge and no curvature
 * to be wrong by. A ray that a diffuse wall sends out is shorter than `near` where its cosine is below near / 2R, with
 * the chance q = (near / 2R)^2, the cosine's square being even.
 *
 * False alarms: bounds are 5.3 standard deviations and more, 1e-7 each, below 1e-5 in all for other seeds; the seeds
 * here are fixed. */
#include "../importance.h"

enum { PATHS = 40000, RAYS = 4 * PATHS };

static const double albedo = 0.6;

static void random_sphere(size_t i, double point[3])
{
    double u[2];
    pm__random_uniform(21, PM__FOR_TESTS, 0, i, u, 2);
    const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z);
    point[0] = r * cos(2.0 * important_pi * u[1]);
    point[1] = r * sin(2.0 * important_pi * u[1]);
    point[2] = z;
}

static pm__scene *make_ball(double ball)
{
    pm__scene *const scene = lit_create();
    if (ball > 0.0)
        lit_sphere(scene, lit_glass(scene), 0.2, 0.1, 0, ball, false);
    lit_sphere(scene, lit_wall(scene, albedo, albedo, albedo), 0, 0, 0, 1.0, true);
    far_lamp(scene);
    return lit_commit(scene);
}

/* ---- The whole of it --------------------------------------------------------------------------- */

/* What comes to the walls: all pixels first, through whatever glass; then a ray each of RAYS, and more while it is too
 * short. Global importons are chances p = a (1 - q) / (1 - a q); caustic ones beside the first a geometric number of
 * mean m = a q / (1 - a q) and variance m (1 + m). */
START_TEST(flux_and_nearness)
{
    static const double nearness[] = {0.0, 1.0, 1.7, 2.5};
    pm__scene *const scene = make_ball(0.0);
    const pm__camera camera = look(0.1, -0.3, 0.2, 0, 1, 0, 1.2);
    pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_SCREEN);
    pm__importons sets[PM__MAP_KINDS];
    config.near = nearness[_i];
    const double q = fmin(1.0, 0.25 * config.near * config.near), p = albedo * (1.0 - q) / (1.0 - albedo * q);
    const double m = albedo * q / (1.0 - albedo * q), share = (double)PIXELS / RAYS;
    importons_made(&config, sets);
    PM_CHECK_NEAR(flux_of(&sets[PM__GLOBAL_MAP]), PIXELS * p, 5.3 * share * sqrt(RAYS * p * (1.0 - p)));
    PM_CHECK_NEAR(flux_of(&sets[PM__CAUSTIC_MAP]), PIXELS * (1.0 + m),
                  5.3 * share * sqrt(RAYS * m * (1.0 + m)) + 1e-5 * PIXELS);
    PM_CHECK_NEAR((double)sets[PM__GLOBAL_MAP].count, RAYS * p, 5.3 * sqrt(RAYS * p * (1.0 - p)));
    pm__importons_free(sets);
    pm__scene_destroy(scene);
}
END_TEST

/* Glass that absorbs nothing takes nothing: each path comes to the wall with all that it had. */
START_TEST(glass_takes_nothing)
{
    pm__scene *const scene = make_ball(0.4);
    const pm__camera camera = look(0.1, -0.8, 0.2, 0.1, 0, 0, 0.9);
    const pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_SCREEN);
    pm__importons sets[PM__MAP_KINDS];
    importons_made(&config, sets);
    ck_assert_uint_eq(sets[PM__CAUSTIC_MAP].count, PATHS);
    PM_CHECK_NEAR(flux_of(&sets[PM__CAUSTIC_MAP]), PIXELS, 1e-5 * PIXELS);
    PM_CHECK_NEAR(flux_of(&sets[PM__GLOBAL_MAP]), PIXELS * albedo, 5.3 * PIXELS * sqrt(albedo * (1.0 - albedo) / RAYS));
    pm__importons_free(sets);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Estimates --------------------------------------------------------------------------------- */

/* N importons, each anywhere on the sphere: at one of them the mean of (k - 2) / (pi r^2) is (N - 1) / 4 pi exactly. Of
 * the mean over all the relative standard deviation is that of a degenerate U-statistic of kernels of k points,
 * sqrt(2 / (N k)), over a quarter of them less than twice that: the bounds are 6 of them. At places anywhere the
 * nearest one's estimate is off by what it itself does to it, which is below 1 / k; these are some 500 neighbourhoods
 * of their own. */
START_TEST(even_in_a_sphere)
{
    enum { POINTS = 2000 };
    static const size_t nearest[] = {10, 200};
    const size_t k = nearest[_i / 2];
    const bool quarter = _i % 2;
    pm__scene *const scene = make_ball(0.0);
    const pm__camera camera = look(0.1, -0.3, 0.2, 0, 1, 0, 1.2);
    pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_SCREEN);
    config.nearest = k;
    config.share = quarter ? 0.25 : 1.0;
    pm__importance *const importance = importance_made(&config);
    const double count = (double)pm__importance_count(importance, PM__GLOBAL_MAP);
    const double kd = (double)k, sphere = 4.0 * important_pi, want = albedo * PIXELS / sphere;
    const double here = (count - 1.0) * PIXELS / RAYS / sphere;
    const double pairs = (quarter ? 0.25 : 1.0) * count * kd; /* of an importon that carries and one near it */
    PM_CHECK_NEAR(pm__importance_mean(importance, PM__GLOBAL_MAP), here, 6.0 * here * sqrt(2.0 / pairs));
    double sum = 0.0;
    for (size_t i = 0; i < POINTS; i++) {
        double p[3];
        random_sphere(i, p);
        sum += importance_at(importance, PM__GLOBAL_MAP, p[0], p[1], p[2], -p[0], -p[1], -p[2]) / POINTS;
    }
    const double neighborhoods = fmin(POINTS, count / kd);
    PM_CHECK_NEAR(sum, want, want * (5.3 / sqrt((kd - 3.0) * neighborhoods) + 1.0 / kd));
    pm__importance_destroy(importance);
    pm__scene_destroy(scene);
}
END_TEST

/* A floor from straight above: each lookup, well within the view and apart from the others, is at most as uncertain as
 * of independent importons, (k - 2) / (pi r^2) with Gamma's law: within 0.65 and 1.6 but for 1e-8. Evenly spread ones
 * make it low by up to 1.5 / k. */
START_TEST(a_floor_from_straight_above)
{
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 10.0, 0.0);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0, 0, 2, 0, 0, 0, 0.7);
    const pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_SCREEN);
    pm__importance *const importance = importance_made(&config);
    const double half = 2.0 * tan(0.35), want = PIXELS / (4.0 * half * half);
    const double r = sqrt(200.0 * PIXELS / (important_pi * PATHS * want));
    double sum = 0.0, points = 0.0;
    for (double x = -half + 2.0 * r; x < half - 2.0 * r; x += 2.5 * r)
        for (double y = -half + 2.0 * r; y < half - 2.0 * r; y += 2.5 * r) {
            const double value = importance_at(importance, PM__CAUSTIC_MAP, x, y, 0, 0, 0, 1) / want;
            ck_assert_msg(value > 0.65 && value < 1.6, "%g of what it should be at (%g, %g)", value, x, y);
            sum += value;
            points += 1.0;
        }
    ck_assert(points >= 64.0);
    PM_CHECK_NEAR(sum / points, 1.0, 5.3 / sqrt(197.0 * points) + 1.5 / 200.0);
    pm__importance_destroy(importance);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- From a floor to a plate ------------------------------------------------------------------- */

/* Form factor from a point on a plate to a rectangle on a parallel one h below, of which the corner is straight below
 * the point: the classical one, odd in x and y so that corners add up. */
static double corner_factor(double x, double y, double h)
{
    const double a = x / h, b = y / h, u = sqrt(1.0 + a * a), v = sqrt(1.0 + b * b);
    return (a / u * atan(b / u) + b / v * atan(a / v)) / (2.0 * important_pi);
}

static double square_factor(double x, double y, double half, double h)
{
    return corner_factor(half - x, half - y, h) + corner_factor(half + x, half - y, h) +
           corner_factor(half - x, half + y, h) + corner_factor(half + x, half + y, h);
}

/* The camera, between two plates, sees a square of the lower one, evenly. What that sends to squares of the upper one
 * is its form factor's integral, here by midpoints of 200 x 200 cells (error below 1e-5); each ray arrives there or
 * not. */
START_TEST(from_a_floor_to_a_plate)
{
    static const double regions[] = {0.4, 1.0, 2.5};
    const double high = 2.0, half = tan(0.5);
    pm__scene *const scene = lit_create();
    const uint32_t grey = lit_wall(scene, albedo, albedo, albedo);
    lit_floor(scene, grey, 60.0, 0.0);
    lit_floor(scene, grey, 60.0, high);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0, 0, 1, 0, 0, 0, 1.0);
    pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_SCREEN);
    pm__importons sets[PM__MAP_KINDS];
    const double seen = PIXELS / (4.0 * half * half);
    importons_made(&config, sets);
    for (int i = 0; i < 3; i++) {
        enum { CELLS = 200 };
        const double b = regions[i], cell = 2.0 * b / CELLS;
        double want = 0.0, got = 0.0;
        for (int x = 0; x < CELLS; x++)
            for (int y = 0; y < CELLS; y++)
                want += albedo * seen * square_factor(-b + (x + 0.5) * cell, -b + (y + 0.5) * cell, half, high) *
                        cell * cell;
        for (size_t j = 0; j < sets[PM__GLOBAL_MAP].count; j++) {
            const pm_photon *const importon = &sets[PM__GLOBAL_MAP].importons[j];
            if (fabsf(importon->position[0]) < (float)b && fabsf(importon->position[1]) < (float)b)
                got += (double)importon->power[PM__IMPORTON_PIXELS];
        }
        const double p = want / PIXELS;
        PM_CHECK_NEAR(got, want, 5.3 * PIXELS * sqrt(p * (1.0 - p) / RAYS) + 1e-4 * want);
    }
    pm__importons_free(sets);
    config.share = 0.25;
    pm__importance *const importance = importance_made(&config);
    for (double x = -1.0; x <= 1.0; x += 0.5) {
        const double want = albedo * seen * square_factor(x, 0.3, half, high);
        const double value = importance_at(importance, PM__GLOBAL_MAP, x, 0.3, high, 0, 0, -1) / want;
        ck_assert_msg(value > 0.65 && value < 1.6, "%g of what it should be at %g", value, x);
        PM_CHECK_NEAR(importance_at(importance, PM__GLOBAL_MAP, x, 0.3, high, 0, 0, 1), 0.0, 0.0);
    }
    pm__importance_destroy(importance);
    pm__scene_destroy(scene);
}
END_TEST

int main(void)
{
    Suite *const suite = suite_create("importance");
    TCase *const tcase = tcase_create("importance");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, flux_and_nearness, 0, 4);
    tcase_add_test(tcase, glass_takes_nothing);
    tcase_add_loop_test(tcase, even_in_a_sphere, 0, 4);
    tcase_add_test(tcase, a_floor_from_straight_above);
    tcase_add_test(tcase, from_a_floor_to_a_plate);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
