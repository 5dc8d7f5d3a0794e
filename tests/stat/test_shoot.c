/* Photon sets stand for the power that they should, however they are counted and spread. Bounds are 6 standard errors
 * over trials, a false alarm in 5e8 comparisons. */
#include "../lit.h"
#include "../moments.h"

static const double albedo[3] = {0.9, 0.6, 0.2};
static const char *const samplers[] = {"poisson", "stratified", "sobol"};

/* A closed sphere, coloured: band b is stored 1/(1 - albedo) times on average, its photons changing power on the way,
 * so that what a path stores depends on how many photons it stores. */
static pm__scene *furnace(void)
{
    static const pm__light lamp = {.kind = PM__POINT, .position = {0.5, 0.0, 0.0}, .power = {1.0, 1.0, 1.0}};
    pm__scene *const scene = lit_create();
    lit_sphere(scene, lit_wall(scene, albedo[0], albedo[1], albedo[2]), 0.0, 0.0, 0.0, 1.0, true);
    lit_lamp(scene, &lamp);
    return lit_commit(scene);
}

static void check_mean(const char *what, const pm__moments *m, double expected)
{
    const double error = pm__moments_error(m), mean = pm__moments_mean(m);
    ck_assert_msg(fabs(mean - expected) <= 6.0 * error + 1e-6 * expected, "%s: mean %.6g, expected %.6g +- %.2g", what,
                  mean, expected, error);
}

/* The power of all stored photons is 1/(1 - albedo) in each band, where a path stores a number of photons that differs,
 * and may be more than are wanted. */
static void check_stored(const pm__scene *scene, size_t count, uint64_t most, uint32_t trials)
{
    size_t whole = 0;
    pm__moments bands[3] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}, {0.0, 0.0, 0}};
    for (uint32_t trial = 0; trial < trials; trial++) {
        const pm__shoot_config config = {.scene = scene, .seed = 37, .trial = trial, .count = count, .most = most};
        pm__photon_set set = lit_shoot(&config);
        ck_assert(set.count == count || (most && set.count < count && set.emitted == most));
        whole += set.count == count;
        for (int b = 0; b < 3; b++)
            pm__moments_add(&bands[b], lit_power(&set, b));
        pm__photon_set_free(&set);
    }
    for (int b = 0; b < 3; b++)
        check_mean("stored", &bands[b], 1.0 / (1.0 - albedo[b]));
    ck_assert(most ? whole > trials / 10 && whole < trials - trials / 10 : whole == trials);
}

START_TEST(test_stored_counts_are_unbiased)
{
    pm__scene *const scene = furnace();
    check_stored(scene, 1, 0, 3000);
    check_stored(scene, 2, 0, 3000);
    check_stored(scene, 7, 0, 3000);
    check_stored(scene, 30, 0, 3000);
    pm__scene_destroy(scene);
}
END_TEST

/* Tracing ends with the limit as often as with the photons, and with both together the power is right. */
START_TEST(test_stored_counts_with_a_limit_are_unbiased)
{
    pm__scene *const scene = furnace();
    check_stored(scene, 7, 1, 3000);
    check_stored(scene, 12, 2, 3000);
    check_stored(scene, 30, 4, 3000);
    pm__scene_destroy(scene);
}
END_TEST

/* Photons that are spread are as many as the limit allows, and none at all is no error. */
START_TEST(test_a_limit_that_leaves_nothing)
{
    pm__scene *const scene = furnace();
    pm__paths *none;
    pm_error error;
    PM_CHECK_OK(pm__paths_create("LS+D", &none, &error), error); /* nothing is specular */
    for (int s = 0; s < 3; s++) {
        pm__shoot_config config = {.scene = scene, .paths = none, .seed = 39, .count = 10, .most = 4096,
                                   .sampler = lit_sampler(samplers[s])};
        pm__photon_set set = lit_shoot(&config);
        ck_assert_uint_eq(set.count, 0);
        ck_assert_uint_ge(set.emitted, 4096);
        ck_assert_uint_le(set.emitted, 8192); /* of a whole set */
        pm__photon_set_free(&set);
        config.paths = NULL;
        config.count = 1000000;
        set = lit_shoot(&config);
        ck_assert(set.count > 0 && set.emitted >= 4096 && set.emitted <= 8192);
        pm__photon_set_free(&set);
    }
    pm__paths_destroy(none);
    pm__scene_destroy(scene);
}
END_TEST

START_TEST(test_emitted_counts_are_unbiased)
{
    pm__scene *const scene = furnace();
    for (int s = 0; s < 3; s++) {
        pm__moments bands[3] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}, {0.0, 0.0, 0}};
        for (uint32_t trial = 0; trial < 1500; trial++) {
            const pm__shoot_config config = {.scene = scene, .seed = 38, .trial = trial, .count = 10, .emitted = true,
                                             .sampler = lit_sampler(samplers[s])};
            pm__photon_set set = lit_shoot(&config);
            for (int b = 0; b < 3; b++)
                pm__moments_add(&bands[b], lit_power(&set, b));
            pm__photon_set_free(&set);
        }
        for (int b = 0; b < 3; b++)
            check_mean(samplers[s], &bands[b], 1.0 / (1.0 - albedo[b]));
    }
    pm__scene_destroy(scene);
}
END_TEST

/* Lamps of 1, 0.05 and 3 W, each in a black sphere of its own. Sets of few photons, of which the weak lamp has a
 * fraction of one. */
START_TEST(test_lights_by_share)
{
    static const double watts[3] = {1.0, 0.05, 3.0};
    pm__scene *const scene = lit_create();
    const uint32_t wall = lit_wall(scene, 0.0, 0.0, 0.0);
    for (int i = 0; i < 3; i++) {
        const pm__light lamp = {.kind = PM__POINT, .position = {10.0 * i, 0.0, 0.0}, .power = {watts[i], 0.0, 0.0}};
        lit_sphere(scene, wall, 10.0 * i, 0.0, 0.0, 1.0, true);
        lit_lamp(scene, &lamp);
    }
    lit_commit(scene);
    for (int s = 0; s < 3; s++) {
        pm__moments power[3] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}, {0.0, 0.0, 0}};
        for (uint32_t trial = 0; trial < 4000; trial++) {
            const pm__shoot_config config = {.scene = scene, .seed = 39, .trial = trial, .count = 11, .emitted = true,
                                             .sampler = lit_sampler(samplers[s])};
            pm__photon_set set = lit_shoot(&config);
            double sum[3] = {0.0, 0.0, 0.0};
            for (size_t i = 0; i < set.count; i++)
                sum[(int)((set.photons[i].position[0] + 1.5f) / 10.0f)] += (double)set.photons[i].power[0];
            for (int i = 0; i < 3; i++)
                pm__moments_add(&power[i], sum[i]);
            pm__photon_set_free(&set);
        }
        for (int i = 0; i < 3; i++)
            check_mean(samplers[s], &power[i], watts[i]);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* Parallel light through a disc of radius 1 onto a floor: photons within 0.5 of (0.3, 0), a quarter of all. Independent
 * ones have the binomial variance. Of n stratified ones only those in cells that the rim crosses vary, each by 1/4 at
 * most. A cell of n = C R (angle, radius squared) is at most 2 pi / C long and reaches from a ring to the next, so the
 * rim, which any ray and any circle about the middle meets twice at most, crosses 2 (C + R) cells at most. The ratio of
 * a measured to a true variance of 300 trials is within 1 +- 6 sqrt(2 / 299). */
START_TEST(test_spread_photons_are_less_noisy)
{
    enum { PHOTONS = 2500, TRIALS = 300 };
    static const pm__light sun = {.kind = PM__DIRECTIONAL, .position = {0, 0, 1}, .direction = {0, 0, -1},
                                  .radius = 1.0, .power = {1, 1, 1}};
    const double wide = 6.0 * sqrt(2.0 / (TRIALS - 1.0)), binomial = PHOTONS * 0.25 * 0.75;
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 2.0, 0.0);
    lit_lamp(scene, &sun);
    lit_commit(scene);
    double variance[3];
    for (int s = 0; s < 3; s++) {
        pm__moments inside = {0.0, 0.0, 0};
        for (uint32_t trial = 0; trial < TRIALS; trial++) {
            const pm__shoot_config config = {.scene = scene, .seed = 40, .trial = trial, .count = PHOTONS,
                                             .emitted = true, .sampler = lit_sampler(samplers[s])};
            pm__photon_set set = lit_shoot(&config);
            double sum = 0.0;
            for (size_t i = 0; i < set.count; i++) {
                const double x = (double)set.photons[i].position[0] - 0.3, y = (double)set.photons[i].position[1];
                sum += x * x + y * y < 0.25 ? (double)set.photons[i].power[0] : 0.0;
            }
            pm__moments_add(&inside, sum * PHOTONS);
            pm__photon_set_free(&set);
        }
        check_mean(samplers[s], &inside, 0.25 * PHOTONS);
        variance[s] = pm__moments_variance(&inside);
    }
    /* 2 (C + R) with C R = 2500 and C / R = pi */
    const double columns = sqrt(PHOTONS * 3.15), rows = PHOTONS / columns;
    ck_assert_double_gt(variance[0], binomial * (1.0 - wide));
    ck_assert_double_lt(variance[0], binomial * (1.0 + wide));
    ck_assert_double_lt(variance[1], 0.25 * 2.0 * (columns + rows) * 1.05 * (1.0 + wide));
    ck_assert_double_lt(variance[2], fmin(binomial, variance[1]));
    pm__scene_destroy(scene);
}
END_TEST

/* The caustic of a glass ball under three kinds of lamps, with photons sent everywhere and only to the glass: the same
 * power, at less noise for the same number emitted. */
START_TEST(test_projection_maps_keep_the_power)
{
    static const pm__light lamps[3] = {
        {.kind = PM__POINT, .position = {0, 0, 2.5}, .power = {1, 1, 1}},
        {.kind = PM__RECTANGLE, .position = {-0.2, 0.2, 2.5}, .edge = {{0, -0.4, 0}, {0.4, 0, 0}}, .power = {2, 2, 2}},
        {.kind = PM__BALL, .position = {1, 0, 2}, .radius = 0.1, .power = {0.5, 0.5, 0.5}}};
    pm__scene *const scene = lit_create();
    pm__projection *projection;
    pm__paths *paths;
    pm_error error;
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 3.0, 0.0);
    lit_sphere(scene, lit_glass(scene), 0.0, 0.0, 0.8, 0.4, false);
    for (int i = 0; i < 3; i++)
        lit_lamp(scene, &lamps[i]);
    lit_commit(scene);
    PM_CHECK_OK(pm__projection_create(scene, true, &projection, &error), error);
    PM_CHECK_OK(pm__paths_create("LS+D", &paths, &error), error);
    for (int s = 0; s < 3; s++)
        for (int stored = 0; stored < 2; stored++) {
            pm__moments plain = {0.0, 0.0, 0}, aimed = {0.0, 0.0, 0};
            for (uint32_t trial = 0; trial < 100; trial++) {
                pm__shoot_config config = {.scene = scene, .paths = paths, .seed = 41, .trial = trial,
                                           .sampler = lit_sampler(samplers[s]), .count = stored ? 200 : 2000,
                                           .emitted = !stored};
                pm__photon_set set = lit_shoot(&config);
                pm__moments_add(&plain, lit_power(&set, 0));
                pm__photon_set_free(&set);
                config.projection = projection;
                config.seed = 42;
                set = lit_shoot(&config);
                pm__moments_add(&aimed, lit_power(&set, 0));
                pm__photon_set_free(&set);
            }
            const double bound = 6.0 * sqrt((pm__moments_variance(&plain) + pm__moments_variance(&aimed)) / 100.0);
            PM_CHECK_NEAR(pm__moments_mean(&aimed), pm__moments_mean(&plain), bound);
            /* By the same number emitted, with a share q of the power sent and p of it in the caustic, independent
             * photons have the variance p (q - p) instead of p (1 - p); a ratio of two of 100 trials errs by a factor
             * of 3 at most. Of a number stored it is about the same either way. */
            if (s == 0 && !stored)
                ck_assert_double_lt(3.0 * pm__moments_variance(&aimed), pm__moments_variance(&plain));
        }
    pm__paths_destroy(paths);
    pm__projection_destroy(projection);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("shoot", test_stored_counts_are_unbiased, test_stored_counts_with_a_limit_are_unbiased,
             test_a_limit_that_leaves_nothing, test_emitted_counts_are_unbiased, test_lights_by_share,
             test_spread_photons_are_less_noisy, test_projection_maps_keep_the_power)
