/* Storage policies over many trials: flux everywhere and where it matters, densities, local light. Bounds are 6
 * standard errors over trials, a false alarm in 5e8 comparisons. */
#include "../moments.h"
#include "../policies.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846;

static void check_alike(const char *what, const pm__moments *a, const pm__moments *b)
{
    const double error = hypot(pm__moments_error(a), pm__moments_error(b));
    const double got = pm__moments_mean(a), want = pm__moments_mean(b);
    ck_assert_msg(fabs(got - want) <= 6.0 * error + 1e-6 * want, "%s: %.6g +- %.2g, expected %.6g", what, got, error,
                  want);
}

/* Flux by part: what is stored of so many that are sent, or until so many are stored. */
static void measure(const policed *p, const char *policy, pm__map_kind kind, size_t stored, uint32_t trials,
                    pm__moments flux[PM__PARTS])
{
    const pm__spec spec = policed_spec(policy);
    for (uint32_t trial = 0; trial < trials; trial++) {
        const pm__storing_config config = {.scene = p->scene, .kind = kind, .policy = &spec,
                                           .importance = p->importance, .seed = 21, .trial = trial,
                                           .emitted = stored < SIZE_MAX ? 100000 : 600, .stored = stored};
        pm__stored_photons set = policed_run(&config);
        for (int part = 0; part < PM__PARTS; part++)
            pm__moments_add(&flux[part], set.flux[part]);
        pm__stored_photons_free(&set);
    }
}

static const char *const policies[] = {"percentage", "probability", "density", "density:accept=cosine", "emission",
                                       "emission:strata=4,tests=1,ratio=50", "emission:strays=keep",
                                       "peter-pietrek", "emission+density", "emission+probability"};
enum { POLICIES = sizeof policies / sizeof *policies };

static void check_flux(const policed *p, pm__map_kind kind, uint32_t trials)
{
    pm__moments even[PM__PARTS] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}};
    measure(p, "all", kind, SIZE_MAX, 2 * trials, even);
    for (size_t i = 0; i < POLICIES; i++) {
        pm__moments flux[PM__PARTS] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}};
        measure(p, policies[i], kind, SIZE_MAX, trials, flux);
        for (int part = 0; part < PM__PARTS; part++)
            check_alike(policies[i], &flux[part], &even[part]);
    }
}

START_TEST(test_flux_of_a_floor)
{
    policed p = policed_floor(1.0);
    check_flux(&p, PM__GLOBAL_MAP, 60);
    policed_free(&p);
}
END_TEST

START_TEST(test_flux_of_a_room)
{
    policed p = policed_room();
    check_flux(&p, PM__GLOBAL_MAP, 60);
    check_flux(&p, PM__CAUSTIC_MAP, 15);
    policed_free(&p);
}
END_TEST

/* Ending where so many are stored is no bias either (errata 37), be they few. */
START_TEST(test_flux_of_so_many_stored)
{
    static const char *const by_chance[] = {"all", "percentage", "probability"};
    enum { TRIALS = 2000 };
    policed p = policed_floor(1.0);
    for (size_t i = 0; i < 3; i++) {
        pm__moments flux[PM__PARTS] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}};
        const pm__moments exact = {27.0 * 100.0, 27.0 * 27.0 * 100.0, 100};
        measure(&p, by_chance[i], PM__GLOBAL_MAP, 8, TRIALS, flux);
        check_alike(by_chance[i], &flux[PM__EVERYWHERE], &exact);
    }
    policed_free(&p);
}
END_TEST

/* ---- Densities --------------------------------------------------------------------------------- */

static bool is_inside(const pm_photon *photon, double half)
{
    return fabs((double)photon->position[0]) < half && fabs((double)photon->position[1]) < half &&
           photon->position[2] < 0.1f;
}

/* 20 times as many photons as are required everywhere: of each plot half of M are required, no fraction, and as many
 * are stored (erratum 41 has 1.31 times as many, of the printed rule). Without importance, since where that ends plots
 * are cut, and both parts have as many. What falls on a part of the floor stays there on average. */
START_TEST(test_density_and_local_light)
{
    enum { TRIALS = 12, REQUIRED = 400 };
    const double half = 0.5, area = 4.0 * half * half, share = 9.0 / (pi * 2.2 * 2.2);
    const uint64_t emitted = (uint64_t)(20 * REQUIRED * 9 / share);
    policed p = policed_floor(1.0);
    pm__moments density = {0.0, 0.0, 0}, light = {0.0, 0.0, 0};
    const pm__moments even = {3.0 * area * 100.0, 9.0 * area * area * 100.0, 100};
    char policy[40];
    (void)snprintf(policy, sizeof policy, "density:constant=%d", REQUIRED);
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        double count = 0.0, sum = 0.0;
        const pm__spec spec = policed_spec(policy);
        const pm__storing_config config = {.scene = p.scene, .kind = PM__GLOBAL_MAP, .policy = &spec, .seed = 5,
                                           .trial = trial, .emitted = emitted, .stored = SIZE_MAX};
        pm__stored_photons set = policed_run(&config);
        for (size_t i = 0; i < set.count; i++)
            if (is_inside(&set.photons[i], half)) {
                count++;
                for (int b = 0; b < 3; b++)
                    sum += (double)set.photons[i].power[b];
            }
        pm__moments_add(&density, count / area / REQUIRED);
        pm__moments_add(&light, sum);
        pm__stored_photons_free(&set);
    }
    PM_CHECK_NEAR(pm__moments_mean(&density), 1.0, 6.0 * pm__moments_error(&density) + 1e-3);
    check_alike("light", &light, &even);
    policed_free(&p);
}
END_TEST

/* Required of important places: many more are stored there than elsewhere. Of a plot as many are as are required on
 * average of it, up to the next whole number, of 5 to 20: 5 % more on average; and where importance ends, or plots of
 * different sizes meet, more again. */
START_TEST(test_density_by_importance)
{
    policed p = policed_floor(1.0);
    pm__stored_photons set = policed_store(&p, "density:global=0.5", PM__GLOBAL_MAP, 400000, 1);
    const pm__spec spec = policed_spec("density:global=0.5");
    double expected = 0.0, count = 0.0;
    enum { SIDE = 60 };
    for (int i = 0; i < SIDE * SIDE; i++) {
        const float at[1][3] = {{(float)((i % SIDE + 0.5) / SIDE - 0.5), (float)((i / SIDE + 0.5) / SIDE - 0.5), 0.0f}};
        const float up[1][3] = {{0.0f, 0.0f, 1.0f}};
        float there;
        pm__importance_at(p.importance, PM__GLOBAL_MAP, at, up, 1, &there);
        expected += pm__policy_required(&spec, PM__GLOBAL_MAP, p.importance, (double)there) / (SIDE * SIDE);
    }
    for (size_t i = 0; i < set.count; i++)
        count += is_inside(&set.photons[i], 0.5);
    ck_assert_msg(count > 1.0 * expected && count < 1.3 * expected, "%g of %g", count, expected);
    ck_assert(!set.unmet);
    pm__stored_photons_free(&set);
    policed_free(&p);
}
END_TEST

/* ---- Emission ---------------------------------------------------------------------------------- */

/* One stratum of which a share p of photons comes to where it matters: the printed form keeps of that light
 * 1 - (1 - p)^m, of the other light 1 + (1 - p)^m p / (1 - p), and all of it in all (erratum 38). */
START_TEST(test_printed_emission_loses)
{
    enum { TRIALS = 3000, TESTS = 4 };
    policed p = policed_floor(1.0);
    pm__moments even[PM__PARTS] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}}, flux[PM__PARTS] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}};
    measure(&p, "all", PM__GLOBAL_MAP, SIZE_MAX, 400, even);
    const double sent = 3.0 * pi * 2.2 * 2.2, share = pm__moments_mean(&even[PM__IMPORTANT]) / sent;
    const pm__spec spec = policed_spec("emission:strata=1,tests=4,form=printed,ratio=1");
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        const pm__storing_config config = {.scene = p.scene, .kind = PM__GLOBAL_MAP, .policy = &spec,
                                           .importance = p.importance, .seed = 21, .trial = trial, .emitted = 100,
                                           .stored = SIZE_MAX};
        pm__stored_photons set = policed_run(&config);
        for (int part = 0; part < PM__PARTS; part++)
            pm__moments_add(&flux[part], set.flux[part]);
        pm__stored_photons_free(&set);
    }
    const double missed = pow(1.0 - share, TESTS), lost = missed * pm__moments_mean(&even[PM__IMPORTANT]);
    const double off = share / (1.0 - share) * missed * pm__moments_mean(&even[PM__EVERYWHERE]);
    const double other = pm__moments_mean(&even[PM__EVERYWHERE]) - pm__moments_mean(&even[PM__IMPORTANT]);
    const double expected =
        pm__moments_mean(&even[PM__IMPORTANT]) - lost + other * (1.0 + missed * share / (1.0 - share));
    ck_assert(off > 0.0 && missed > 0.1 && missed < 0.95);
    ck_assert(lost > 20.0 * pm__moments_error(&flux[PM__IMPORTANT]));
    PM_CHECK_NEAR(pm__moments_mean(&flux[PM__IMPORTANT]), pm__moments_mean(&even[PM__IMPORTANT]) - lost,
                  6.0 * hypot(pm__moments_error(&flux[PM__IMPORTANT]), pm__moments_error(&even[PM__IMPORTANT])));
    PM_CHECK_NEAR(pm__moments_mean(&flux[PM__EVERYWHERE]), expected,
                  6.0 * hypot(pm__moments_error(&flux[PM__EVERYWHERE]), pm__moments_error(&even[PM__EVERYWHERE])));
    policed_free(&p);
}
END_TEST

/* The greatest power where it matters over the least. */
static double spread_of(const policed *p, const pm__stored_photons *set)
{
    const double threshold = pm__importance_threshold(p->importance, PM__GLOBAL_MAP);
    double least = INFINITY, most = 0.0;
    for (size_t i = 0; i < set->count; i++) {
        const double power = (double)set->photons[i].power[0];
        float there;
        pm__importance_at(p->importance, PM__GLOBAL_MAP, (const float(*)[3])&set->photons[i].position,
                          (const float(*)[3])&set->normals[i], 1, &there);
        least = (double)there >= threshold ? fmin(least, power) : least;
        most = (double)there >= threshold ? fmax(most, power) : most;
    }
    return most / least;
}

/* Photons of small sets that come to where it matters are bright dots there, unless they are shared out. */
START_TEST(test_no_dots)
{
    policed p = policed_floor(1.0);
    const char *const shared = "emission:strata=1024,tests=16";
    const char *const kept = "emission:strata=1024,tests=16,strays=keep";
    double dots = 0.0;
    for (uint32_t trial = 0; trial < 3; trial++) {
        pm__stored_photons without = policed_store(&p, shared, PM__GLOBAL_MAP, 20000, trial);
        pm__stored_photons with = policed_store(&p, kept, PM__GLOBAL_MAP, 20000, trial);
        ck_assert_msg(spread_of(&p, &without) < 4.0, "%g", spread_of(&p, &without));
        dots = fmax(dots, spread_of(&p, &with));
        pm__stored_photons_free(&without);
        pm__stored_photons_free(&with);
    }
    ck_assert_msg(dots > 8.0, "%g", dots);
    policed_free(&p);
}
END_TEST

/* The same where so many are wanted, and parts are of that number: no more, and few less. */
START_TEST(test_no_dots_of_so_many_stored)
{
    policed p = policed_floor(1.0);
    static const size_t wanted[] = {2000, 8000};
    static const char *const policies_of[] = {"emission:strata=1024,tests=16",
                                              "emission:strata=1024,tests=16,strays=keep"};
    double dots[2] = {0.0, 0.0};
    for (uint32_t i = 0; i < 12; i++) {
        const pm__spec spec = policed_spec(policies_of[i % 2]);
        const size_t stored = wanted[i / 2 % 2];
        const pm__storing_config config = {.scene = p.scene, .kind = PM__GLOBAL_MAP, .policy = &spec,
                                           .importance = p.importance, .seed = 5, .trial = i / 4,
                                           .emitted = 64 * (uint64_t)stored, .stored = stored};
        pm__stored_photons set = policed_run(&config);
        ck_assert_msg(set.count <= stored && set.count + stored / 20 >= stored, "%zu of %zu", set.count, stored);
        PM_CHECK_NEAR(set.flux[PM__EVERYWHERE], set.came[PM__EVERYWHERE], 1e-6 * set.came[PM__EVERYWHERE]);
        PM_CHECK_NEAR(set.flux[PM__IMPORTANT], set.came[PM__IMPORTANT], 1e-6 * set.came[PM__IMPORTANT]);
        dots[i % 2] = fmax(dots[i % 2], spread_of(&p, &set));
        pm__stored_photons_free(&set);
    }
    ck_assert_msg(dots[0] < 4.0 && dots[1] > 8.0, "%g, %g", dots[0], dots[1]);
    policed_free(&p);
}
END_TEST

/* Nor is any light lost on average where paths are taken back for parts, everywhere or where it matters, be there many
 * parts or one path to a few photons. */
START_TEST(test_flux_of_so_many_with_parts)
{
    static const size_t wanted[] = {25, 400};
    const char *const policy = "emission:strata=256,tests=4,ratio=64";
    for (int of_room = 0; of_room < 2; of_room++) {
        policed p = of_room ? policed_room() : policed_floor(1.0);
        pm__moments even[PM__PARTS] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}};
        measure(&p, "all", PM__GLOBAL_MAP, SIZE_MAX, 40, even);
        for (int w = 0; w < 2; w++) {
            const pm__spec spec = policed_spec(policy);
            pm__moments flux[PM__PARTS] = {{0.0, 0.0, 0}, {0.0, 0.0, 0}};
            for (uint32_t trial = 0; trial < 1000; trial++) {
                const pm__storing_config config = {.scene = p.scene, .kind = PM__GLOBAL_MAP, .policy = &spec,
                                                   .importance = p.importance, .seed = 22, .trial = trial,
                                                   .emitted = 64 * wanted[w], .stored = wanted[w]};
                pm__stored_photons set = policed_run(&config);
                for (int k = 0; k < PM__PARTS; k++)
                    pm__moments_add(&flux[k], set.flux[k]);
                pm__stored_photons_free(&set);
            }
            for (int k = 0; k < PM__PARTS; k++)
                check_alike(of_room ? "room" : "floor", &flux[k], &even[k]);
        }
        policed_free(&p);
    }
}
END_TEST

/* The greatest of the powers over the least. */
static double range_of(const pm__stored_photons *set)
{
    float least = INFINITY, most = 0.0f;
    for (size_t i = 0; i < set->count; i++) {
        least = fminf(least, set->photons[i].power[0]);
        most = fmaxf(most, set->photons[i].power[0]);
    }
    return (double)most / (double)least;
}

/* By importance most go where it matters. Powers rise to those of small sets, 5 times those of large ones, and no
 * further. */
START_TEST(test_sent_to_where_it_matters)
{
    policed p = policed_floor(1.0);
    pm__stored_photons all = policed_store(&p, "all", PM__GLOBAL_MAP, 20480, 1);
    pm__stored_photons few = policed_store(&p, "emission:strata=1024,tests=8,ratio=5", PM__GLOBAL_MAP, 20480, 1);
    pm__stored_photons many = policed_store(&p, "peter-pietrek:strata=1024", PM__GLOBAL_MAP, 20000, 1);
    size_t counts[3] = {0, 0, 0};
    const pm__stored_photons *const sets[3] = {&all, &few, &many};
    for (int s = 0; s < 3; s++)
        for (size_t i = 0; i < sets[s]->count; i++)
            counts[s] += is_inside(&sets[s]->photons[i], 0.1);
    ck_assert_uint_lt(few.emitted, all.emitted);
    PM_CHECK_NEAR(range_of(&few), 5.0, 1e-3);
    ck_assert_uint_lt(few.count, all.count / 2);
    ck_assert(fabs((double)counts[1] - (double)counts[0]) < 6.0 * sqrt(2.0 * (double)counts[0]));
    ck_assert_uint_gt(counts[2], 3 * counts[0]);
    pm__stored_photons_free(&all);
    pm__stored_photons_free(&few);
    pm__stored_photons_free(&many);
    policed_free(&p);
}
END_TEST

PM_TEST_MAIN("policies", test_flux_of_a_floor, test_flux_of_a_room, test_flux_of_so_many_stored,
             test_density_and_local_light, test_density_by_importance, test_printed_emission_loses, test_no_dots,
             test_no_dots_of_so_many_stored, test_flux_of_so_many_with_parts, test_sent_to_where_it_matters)
