/* Errata of photon tracing. Bounds: 5.5 standard errors of the mean, a false alarm in 4e-8. */
#include "../../src/base/random.h"
#include "../../cases/scenes/list.h"
#include "../../src/transport/shoot.h"
#include "../lit.h"

enum { RUNS = 40000, WANTED = 100 };

static const double share = 0.1; /* of emitted photons that are stored */

/* How many are emitted until the last that is wanted is stored: a sum of geometric numbers. */
static double emitted_until_stored(uint64_t run)
{
    double u[WANTED], sum = 0.0;
    pm__random_uniform(37, PM__FOR_TESTS, 0, run, u, WANTED);
    for (int i = 0; i < WANTED; i++)
        sum += floor(log1p(-u[i]) / log1p(-share)) + 1.0;
    return sum;
}

/* Dividing by the number emitted when the N-th was stored makes the light too bright by (1 - p) / N; one less of both
 * is right. */
START_TEST(erratum_37)
{
    double printed = 0.0, right = 0.0, square = 0.0;
    for (uint64_t run = 0; run < RUNS; run++) {
        const double emitted = emitted_until_stored(run), estimate = (WANTED - 1.0) / (emitted - 1.0) / share;
        printed += WANTED / emitted / share / RUNS;
        right += estimate / RUNS;
        square += estimate * estimate / RUNS;
    }
    const double error = sqrt((square - right * right) / RUNS);
    PM_CHECK_NEAR(right, 1.0, 5.5 * error);
    PM_CHECK_NEAR(printed, 1.0 + (1.0 - share) / WANTED, 5.5 * error + 1.5e-4); /* to the order 1 / N^2 */
    ck_assert_double_gt(printed - 1.0, 5.5 * error);
}
END_TEST

/* Photons along paths that each store k with the chance (1 - rho) rho^k: mean rho / (1 - rho). */
static const double rho = 0.8;

/* Runs until `wanted` are stored; the power of one a path by the three forms. */
static void count_paths(uint64_t run, int wanted, double power[3])
{
    int lengths[64], paths = 0, stored = 0, longer = 0;
    while (stored < wanted) {
        double u;
        ck_assert_int_lt(paths, 64);
        pm__random_uniform(38, PM__FOR_TESTS, (uint32_t)paths, run, &u, 1);
        lengths[paths] = (int)floor(log1p(-u) / log(rho));
        stored += lengths[paths++];
    }
    double last = 0.0;
    for (int i = 0; i < paths; i++)
        if (lengths[i] > stored - wanted) {
            longer++;
            last += lengths[i];
        }
    power[0] = (double)wanted / paths;
    power[1] = paths > 1 ? (wanted - 1.0) / (paths - 1.0) : 1.0;
    power[2] = paths > 1 ? (stored - last / longer) / (paths - 1.0) : stored;
}

/* Where a path stores several photons, (N - 1)/(e - 1) is bright too, by about the number that is stored between the
 * last path's first and the N-th, over e. Right is what all paths store but for the mean of those that may have been
 * the last, over e - 1. */
START_TEST(erratum_37_several_a_path)
{
    enum { SEVERAL = 50 };
    const double truth = rho / (1.0 - rho);
    double mean[3] = {0.0}, square[3] = {0.0}, error[3];
    for (uint64_t run = 0; run < RUNS; run++) {
        double power[3];
        count_paths(run, SEVERAL, power);
        for (int i = 0; i < 3; i++) {
            mean[i] += power[i] / truth / RUNS;
            square[i] += power[i] * power[i] / (truth * truth) / RUNS;
        }
    }
    for (int i = 0; i < 3; i++)
        error[i] = sqrt((square[i] - mean[i] * mean[i]) / RUNS);
    PM_CHECK_NEAR(mean[2], 1.0, 5.5 * error[2]);
    ck_assert_double_gt(mean[1] - 1.0, 0.05 + 5.5 * error[1]);
    ck_assert_double_gt(mean[0] - 1.0, 5.5 * error[0]);
}
END_TEST

/* ---- Projection maps --------------------------------------------------------------------------- */

static const double pi = 3.14159265358979323846;

/* The share of cells of equal extent in latitude and longitude on which some of the directions lies, and of those of
 * equal flux. */
static double share_of_cells(double low, double high)
{
    enum { CELLS = 1800 }; /* of latitude, 0 at the pole; all longitudes are alike */
    int on = 0;
    for (int i = 0; i < CELLS; i++) {
        const double theta = pi * (i + 0.5) / CELLS;
        on += theta >= low && theta < high;
    }
    return (double)on / CELLS;
}

/* What a lamp at the origin sends to a ball of glass, by its projection map. */
static double projected(const double at[3], double radius)
{
    static const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 1.0, 1.0}};
    pm__scene *const scene = lit_create();
    pm__projection *projection;
    pm_error error;
    lit_sphere(scene, lit_glass(scene), at[0], at[1], at[2], radius, false);
    lit_lamp(scene, &lamp);
    lit_commit(scene);
    PM_CHECK_OK(pm__projection_create(scene, true, &projection, &error), error);
    const double sent = pm__projection_share(projection, 0);
    pm__projection_destroy(projection);
    pm__scene_destroy(scene);
    return sent;
}

/* The share of cells that hold objects is that of the light only if cells have equal flux. By cells of equal latitude
 * and longitude a cap of 30 degrees at the pole has 2.488 times its light, and a band of 30 degrees either side of the
 * equator 0.667 times. Ours for the box about a ball there, of half width a at distance d, is the box's own solid angle
 * but for cells on its rim. */
START_TEST(erratum_35)
{
    PM_CHECK_NEAR(share_of_cells(0.0, pi / 6.0) / (0.5 * (1.0 - cos(pi / 6.0))), 2.488, 2e-3);
    PM_CHECK_NEAR(share_of_cells(pi / 3.0, 2.0 * pi / 3.0) / cos(pi / 3.0), 2.0 / 3.0, 2e-3);
    static const double places[2][3] = {{0.0, 0.0, 2.0}, {2.0, 0.0, 0.0}};
    for (int p = 0; p < 2; p++) {
        const double a = 0.8, d = 2.0 - a; /* its near face: a square of half width a at d hides the rest */
        const double face = 4.0 * asin(a * a / (a * a + d * d)) / (4.0 * pi);
        const double sent = projected(places[p], a);
        /* The rim, eight times atan(a / d) long, is at most a cell's diagonal of 0.11 wide but at the pole, where cells
         * reach 0.18 down */
        ck_assert_double_ge(sent, face);
        ck_assert_double_le(sent, face + 8.0 * atan(a / d) * (p ? 0.11 : 0.18) / (4.0 * pi));
    }
}
END_TEST

/* A direction <x, y, z> out of the unit ball by rejection is no unit vector: its mean length is 3/4. What leaves our
 * lamps is. */
START_TEST(erratum_36)
{
    static const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 1.0, 1.0}};
    double mean = 0.0;
    int kept = 0;
    for (uint64_t i = 0; i < RUNS; i++) {
        double u[4], position[3], direction[3];
        pm__random_uniform(36, PM__FOR_TESTS, 0, i, u, 4);
        const double x = 2.0 * u[0] - 1.0, y = 2.0 * u[1] - 1.0, z = 2.0 * u[2] - 1.0, r = sqrt(x * x + y * y + z * z);
        if (r <= 1.0) {
            mean += r;
            kept++;
        }
        pm__emit(&lamp, u, position, direction);
        PM_CHECK_NEAR(pm__dot(direction, direction), 1.0, 1e-14);
    }
    /* Variance 3/5 - 9/16 */
    PM_CHECK_NEAR(mean / kept, 0.75, 5.5 * sqrt(0.0375 / kept));
}
END_TEST

/* Red power of the photons of 20,000 emitted into the box with two spheres that are stored along these paths. */
static double stored_power(const pm__scene *scene, const char *expression)
{
    pm_error error = {""};
    pm__paths *paths;
    pm__photon_set set;
    double sum = 0.0;
    PM_CHECK_OK(pm__paths_create(expression, &paths, &error), error);
    const pm__shoot_config config = {.scene = scene, .paths = paths, .seed = 45, .count = 20000, .emitted = true};
    PM_CHECK_OK(pm__shoot(&config, &set, &error), error);
    for (size_t i = 0; i < set.count; i++)
        sum += (double)set.photons[i].power[0];
    pm__photon_set_free(&set);
    pm__paths_destroy(paths);
    return sum;
}

/* The global map L{S|D}*D holds what shadow rays and the caustic map show already: beside them it would be counted
 * twice. Only the paths that met a rough surface before are left for it. */
START_TEST(erratum_45)
{
    pm_error error = {""};
    pm__scene *scene;
    const pm__case *const box = &pm__case_scene_cornell;
    pm__spec spec;
    pm__spec_default(&box->entry, &spec);
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(box->build(spec.values, scene, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    const double global = stored_power(scene, "L.*D"), direct = stored_power(scene, "LD");
    const double caustic = stored_power(scene, "LS+D"), rest = stored_power(scene, "L.*D.*D");
    PM_CHECK_NEAR(direct + caustic + rest, global, 1e-9 * global); /* the same photons: no noise between */
    PM_CHECK_NEAR(direct + caustic, 0.51 * global, 0.02 * global);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("errata_transport", erratum_45, erratum_37, erratum_37_several_a_path, erratum_35, erratum_36)
