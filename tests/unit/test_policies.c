/* Storage policies: what they keep, that they lose no light, the same for any threads, and bad input. */
#include "../policies.h"

#include "../../src/cli/parallel.h"

#include <stdio.h>
#include <string.h>

static const char *const all_policies[] = {
    "all", "percentage", "probability", "density", "density:constant=2000,accept=cosine", "emission",
    "emission:form=printed", "emission:strays=keep,ratio=4", "peter-pietrek", "emission+density",
    "emission+probability"};
enum { POLICIES = sizeof all_policies / sizeof *all_policies };

/* Every row is tried above. */
START_TEST(test_every_policy_is_here)
{
    for (size_t i = 0; i < pm__policies.count; i++) {
        bool tried = false;
        for (size_t j = 0; j < POLICIES; j++) {
            const pm__spec spec = policed_spec(all_policies[j]);
            tried = tried || spec.entry == pm__policies.entries[i];
        }
        ck_assert_msg(tried, "%s", pm__policies.entries[i]->name);
    }
}
END_TEST

/* ---- Flux -------------------------------------------------------------------------------------- */

static double flux_of(const pm__stored_photons *set)
{
    double sum = 0.0;
    for (size_t i = 0; i < set->count; i++)
        for (int b = 0; b < 3; b++)
            sum += (double)set->photons[i].power[b];
    return sum;
}

/* To 1e-6, everywhere and where it matters, caustics and all, whether much is stored or little. */
START_TEST(test_flux_is_kept)
{
    static const char *const exact[] = {"all", "density", "density:constant=200", "density:constant=1e7",
                                        "density:global=0.01,caustic=0.01", "density:accept=cosine",
                                        "density:neighbors=200,constant=100", "emission+density", "peter-pietrek"};
    policed room = policed_room(), floor = policed_floor(1.0);
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++)
        for (int kind = 0; kind <= PM__MAP_KINDS; kind++) {
            const bool of_room = kind < PM__MAP_KINDS;
            pm__stored_photons set = policed_store(of_room ? &room : &floor, exact[i],
                                                   of_room ? (pm__map_kind)kind : PM__GLOBAL_MAP, 20000, 1);
            ck_assert_uint_gt(set.arrived, 500);
            ck_assert(set.came[PM__IMPORTANT] > 0.0);
            ck_assert(of_room || set.came[PM__IMPORTANT] < 0.3 * set.came[PM__EVERYWHERE]);
            ck_assert_uint_le(set.count, set.arrived);
            for (int part = 0; part < PM__PARTS; part++)
                ck_assert_msg(fabs(set.flux[part] - set.came[part]) <= 1e-6 * set.came[part], "%s: %.9g of %.9g",
                              exact[i], set.flux[part], set.came[part]);
            PM_CHECK_NEAR(flux_of(&set), set.flux[PM__EVERYWHERE], 1e-12 * flux_of(&set));
            pm__stored_photons_free(&set);
        }
    policed_free(&room);
    policed_free(&floor);
}
END_TEST

/* `all` is what pm__shoot gives, bit by bit. */
START_TEST(test_all_are_those_shot)
{
    policed p = policed_room();
    const pm__shoot_config config = {.scene = p.scene, .seed = 5, .trial = (1 << 24) + 1, .count = 3000,
                                     .emitted = true, .normals = true};
    pm__photon_set shot = lit_shoot(&config);
    pm__stored_photons set = policed_store(&p, "all", PM__GLOBAL_MAP, 3000, 1);
    ck_assert_uint_eq(set.count, shot.count);
    ck_assert_uint_eq(set.emitted, 3000);
    ck_assert(!memcmp(set.photons, shot.photons, set.count * sizeof *set.photons));
    ck_assert(!memcmp(set.normals, shot.normals, set.count * sizeof *set.normals));
    pm__photon_set_free(&shot);
    pm__stored_photons_free(&set);
    policed_free(&p);
}
END_TEST

/* Kept by chance: each is an arrival, in order, its power over its probability. */
static void check_chances(const policed *p, const char *policy, pm__map_kind kind,
                          double (*chance)(const policed *p, pm__map_kind kind, double importance))
{
    pm__stored_photons all = policed_store(p, "all", kind, 5000, 1);
    pm__stored_photons set = policed_store(p, policy, kind, 5000, 1);
    size_t from = 0;
    ck_assert_uint_lt(set.count, all.count);
    for (size_t i = 0; i < set.count; i++, from++) {
        float importance;
        while (from < all.count && memcmp(all.photons[from].position, set.photons[i].position, 12) != 0)
            from++;
        ck_assert_uint_lt(from, all.count);
        pm__importance_at(p->importance, kind, (const float(*)[3])all.photons[from].position,
                          (const float(*)[3])all.normals[from], 1, &importance);
        const double expected = chance(p, kind, (double)importance);
        for (int b = 0; b < 3; b++)
            PM_CHECK_NEAR((double)set.photons[i].power[b] * expected, (double)all.photons[from].power[b],
                          4e-7 * (double)all.photons[from].power[b]);
    }
    pm__stored_photons_free(&set);
    pm__stored_photons_free(&all);
}

static double chance_of_share(const policed *p, pm__map_kind kind, double importance)
{
    (void)p;
    (void)kind;
    (void)importance;
    return 0.25;
}

static double chance_of_importance(const policed *p, pm__map_kind kind, double importance)
{
    return fmax(0.05, fmin(importance / (2.0 * pm__importance_mean(p->importance, kind)), 1.0));
}

START_TEST(test_powers_over_probability)
{
    policed p = policed_room();
    check_chances(&p, "percentage:share=0.25", PM__GLOBAL_MAP, chance_of_share);
    check_chances(&p, "probability:full=2,least=0.05", PM__GLOBAL_MAP, chance_of_importance);
    check_chances(&p, "probability:full=2,least=0.05", PM__CAUSTIC_MAP, chance_of_importance);
    policed_free(&p);
}
END_TEST

START_TEST(test_percentage_keeps_caustics)
{
    policed p = policed_room();
    pm__stored_photons set = policed_store(&p, "percentage", PM__CAUSTIC_MAP, 5000, 1);
    ck_assert_uint_gt(set.count, 100);
    ck_assert_uint_eq(set.count, set.arrived);
    pm__stored_photons_free(&set);
    policed_free(&p);
}
END_TEST

/* ---- Threads ----------------------------------------------------------------------------------- */

/* The last first. */
static void run_backwards(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    (void)context;
    while (count-- > 0)
        task(argument, count);
}

static bool same(const pm__stored_photons *a, const pm__stored_photons *b)
{
    return a->count == b->count && a->emitted == b->emitted && a->arrived == b->arrived && a->unmet == b->unmet &&
           !memcmp(a->flux, b->flux, sizeof a->flux) && !memcmp(a->came, b->came, sizeof a->came) &&
           (!a->count || (!memcmp(a->photons, b->photons, a->count * sizeof *a->photons) &&
                          !memcmp(a->normals, b->normals, a->count * sizeof *a->normals)));
}

START_TEST(test_same_for_any_threads)
{
    static size_t two = 2, three = 3;
    const pm_parallel ways[] = {{run_backwards, NULL}, pm__parallel_for(&two), pm__parallel_for(&three)};
    policed p = policed_room();
    for (size_t i = 0; i < POLICIES; i++)
        for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
            const pm__spec spec = policed_spec(all_policies[i]);
            pm__storing_config config = {.scene = p.scene, .kind = (pm__map_kind)kind, .policy = &spec,
                                         .importance = p.importance, .seed = 9, .emitted = 15000, .stored = 4000};
            pm__stored_photons serial = policed_run(&config);
            for (int w = 0; w < 3; w++) {
                config.parallel = &ways[w];
                pm__stored_photons set = policed_run(&config);
                ck_assert_msg(same(&serial, &set), "%s", all_policies[i]);
                pm__stored_photons_free(&set);
            }
            pm__stored_photons_free(&serial);
        }
    policed_free(&p);
}
END_TEST

/* ---- So many stored ---------------------------------------------------------------------------- */

/* At most as many as are wanted, fewer by what one path stores. */
START_TEST(test_wanted)
{
    static const size_t wanted[] = {0, 1, 2, 40, 1000};
    policed p = policed_room();
    for (size_t i = 0; i < POLICIES; i++)
        for (size_t w = 0; w < sizeof wanted / sizeof *wanted; w++) {
            const pm__spec spec = policed_spec(all_policies[i]);
            const pm__storing_config config = {.scene = p.scene, .kind = PM__GLOBAL_MAP, .policy = &spec,
                                               .importance = p.importance, .seed = 9, .emitted = 100000,
                                               .stored = wanted[w]};
            pm__stored_photons set = policed_run(&config);
            if (!strstr(all_policies[i], "printed"))
                ck_assert_msg(set.count <= wanted[w] + 30 && set.count + 30 >= wanted[w], "%s: %zu of %zu",
                              all_policies[i], set.count, wanted[w]);
            ck_assert(isfinite(set.flux[PM__EVERYWHERE]));
            pm__stored_photons_free(&set);
        }
    policed_free(&p);
}
END_TEST

/* ---- Bad input --------------------------------------------------------------------------------- */

/* Light that goes all to one point of a sheet, from above, or from below too: so little that those who came before it
 * all lie on the other side. */
static policed pierced(bool both)
{
    const pm__light above = {.kind = PM__DIRECTIONAL, .position = {0.1, 0.2, 1.0}, .direction = {0.0, 0.0, -1.0},
                             .radius = 1e-12, .power = {1.0, 2.0, 3.0}};
    const pm__light below = {.kind = PM__DIRECTIONAL, .position = {0.1, 0.2, -1.0}, .direction = {0.0, 0.0, 1.0},
                             .radius = 1e-12, .power = {3e-3, 2e-3, 1e-3}};
    static const pm__view view = {{0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.5};
    policed p = {.scene = lit_create()};
    lit_floor(p.scene, lit_wall(p.scene, 0.0, 0.0, 0.0), 0.5, 0.0);
    lit_lamp(p.scene, &above);
    if (both)
        lit_lamp(p.scene, &below);
    lit_commit(p.scene);
    p.importance = policed_importance(p.scene, &view);
    return p;
}

static void check_kept(const pm__stored_photons *set, const char *policy)
{
    ck_assert_msg(fabs(set->flux[0] - set->came[0]) <= 1e-6 * set->came[0] || !strstr(policy, "density"),
                  "%s: %.9g of %.9g", policy, set->flux[0], set->came[0]);
    ck_assert(isfinite(set->flux[0]));
}

START_TEST(test_all_in_one_point)
{
    for (int both = 0; both < 2; both++) {
        policed p = pierced(both);
        for (size_t i = 0; i < POLICIES; i++) {
            pm__stored_photons set = policed_store(&p, all_policies[i], PM__GLOBAL_MAP, 20000, 1);
            check_kept(&set, all_policies[i]);
            PM_CHECK_NEAR(set.came[0], both ? 6.006 : 6.0, 1e-5);
            if (strstr(all_policies[i], "density") && !strstr(all_policies[i], "cosine"))
                ck_assert_uint_le(set.count, 45);
            pm__stored_photons_free(&set);
        }
        policed_free(&p);
    }
}
END_TEST

/* A camera that looks away: nothing is important, and no light is lost. Where least is stored, by a chance of 0.02 of
 * 28,000, the bound is 6 standard deviations. */
START_TEST(test_no_importance)
{
    static const pm__view away = {{0.0, 0.0, 1.0}, {0.0, 0.0, 2.0}, {0.0, 1.0, 0.0}, 0.5};
    policed p = policed_floor(1.0);
    pm__importance_destroy(p.importance);
    p.importance = policed_importance(p.scene, &away);
    ck_assert_uint_eq(pm__importance_count(p.importance, PM__GLOBAL_MAP), 0);
    for (size_t i = 0; i < POLICIES; i++) {
        pm__stored_photons set = policed_store(&p, all_policies[i], PM__GLOBAL_MAP, 50000, 1);
        check_kept(&set, all_policies[i]);
        PM_CHECK_NEAR(set.flux[0], 27.0, 6.75);
        pm__stored_photons_free(&set);
    }
    policed_free(&p);
}
END_TEST

/* None, one, fewer than neighbours. No caustics where nothing makes any. */
START_TEST(test_few_photons)
{
    static const uint64_t few[] = {0, 1, 2, 15};
    policed p = policed_floor(1.0);
    for (size_t i = 0; i < POLICIES; i++) {
        for (size_t f = 0; f < 4; f++) {
            pm__stored_photons set = policed_store(&p, all_policies[i], PM__GLOBAL_MAP, few[f], 1);
            check_kept(&set, all_policies[i]);
            pm__stored_photons_free(&set);
        }
        pm__stored_photons none = policed_store(&p, all_policies[i], PM__CAUSTIC_MAP, 1000, 1);
        ck_assert_uint_eq(none.count, 0);
        pm__stored_photons_free(&none);
    }
    policed_free(&p);
}
END_TEST

START_TEST(test_refusals)
{
    policed p = policed_floor(1.0);
    pm_error error;
    pm__stored_photons set;
    const pm__spec density = policed_spec("density"), power = policed_spec("density:constant=10,power=2");
    const pm__spec constant = policed_spec("density:constant=10");
    pm__storing_config config = {.scene = p.scene, .kind = PM__GLOBAL_MAP, .policy = &density, .emitted = 100,
                                 .stored = SIZE_MAX};
    ck_assert(pm__policy_needs_importance(&density) && !pm__policy_needs_importance(&constant));
    ck_assert(pm__store_photons(&config, &set, &error) == PM_EINVAL);
    ck_assert_ptr_nonnull(strstr(error.text, "importance"));
    config.policy = &constant;
    PM_CHECK_OK(pm__store_photons(&config, &set, &error), error);
    pm__stored_photons_free(&set);
    config.policy = &power;
    config.kind = PM__CAUSTIC_MAP;
    ck_assert(pm__store_photons(&config, &set, &error) == PM_EINVAL);
    ck_assert_ptr_nonnull(strstr(error.text, "map of all light"));
    config.emitted = UINT64_MAX;
    config.policy = &constant;
    ck_assert(pm__store_photons(&config, &set, &error) == PM_EINVAL);
    policed_free(&p);
}
END_TEST

/* ---- What is required -------------------------------------------------------------------------- */

START_TEST(test_required)
{
    policed p = policed_room();
    const pm__spec all = policed_spec("all"), constant = policed_spec("density:constant=7");
    const pm__spec density = policed_spec("density"), both = policed_spec("emission+density");
    for (int k = 0; k < PM__MAP_KINDS; k++) {
        const pm__map_kind kind = (pm__map_kind)k;
        const double mean = pm__importance_mean(p.importance, kind), pixel = kind == PM__CAUSTIC_MAP ? 8.0 : 2.0;
        ck_assert(pm__policy_required(&all, kind, p.importance, mean) == 0.0);
        ck_assert(pm__policy_required(&constant, kind, NULL, mean) == 7.0);
        PM_CHECK_NEAR(pm__policy_required(&density, kind, p.importance, mean), pixel * mean, 1e-12 * pixel * mean);
        PM_CHECK_NEAR(pm__policy_required(&density, kind, p.importance, 0.0), 0.02 * pixel * mean,
                      1e-12 * pixel * mean);
        PM_CHECK_NEAR(pm__policy_required(&both, kind, p.importance, 1e9 * mean), 100.0 * pixel * mean,
                      1e-9 * pixel * mean);
    }
    policed_free(&p);
}
END_TEST

/* A density that so many photons cannot meet is a message, not a loop. */
START_TEST(test_unmet)
{
    policed p = policed_floor(1.0);
    pm__stored_photons dense = policed_store(&p, "density:constant=1e9", PM__GLOBAL_MAP, 20000, 1);
    pm__stored_photons sparse = policed_store(&p, "density:constant=100", PM__GLOBAL_MAP, 20000, 1);
    ck_assert(dense.unmet);
    ck_assert_uint_eq(dense.count, dense.arrived);
    ck_assert(!sparse.unmet);
    pm__stored_photons_free(&dense);
    pm__stored_photons_free(&sparse);
    policed_free(&p);
}
END_TEST

/* C(x): where caustics are little of all light fewer are stored; F = 1 changes nothing. */
START_TEST(test_convergence_of_caustics)
{
    policed p = policed_room();
    pm_error error;
    size_t counts[3];
    pm__stored_photons light = policed_store(&p, "all", PM__GLOBAL_MAP, 20000, 3);
    pm_map *global;
    PM_CHECK_OK(pm_map_create(light.photons, light.count, NULL, &global, &error), error);
    for (int power = 0; power < 3; power++) {
        char text[60];
        (void)snprintf(text, sizeof text, "density:constant=20000,power=%d", power);
        const pm__spec spec = policed_spec(text);
        const pm__storing_config config = {.scene = p.scene, .kind = PM__CAUSTIC_MAP, .policy = &spec, .global = global,
                                           .seed = 5, .emitted = 60000, .stored = SIZE_MAX};
        pm__stored_photons set = policed_run(&config);
        check_kept(&set, "density");
        counts[power] = set.count;
        pm__stored_photons_free(&set);
    }
    ck_assert_uint_gt(counts[0], counts[1]);
    ck_assert_uint_gt(counts[1], counts[2]);
    pm_map_destroy(global);
    pm__stored_photons_free(&light);
    policed_free(&p);
}
END_TEST

PM_TEST_MAIN("policies", test_every_policy_is_here, test_flux_is_kept, test_all_are_those_shot,
             test_powers_over_probability, test_percentage_keeps_caustics, test_same_for_any_threads, test_wanted,
             test_all_in_one_point, test_no_importance, test_few_photons, test_refusals, test_required, test_unmet,
             test_convergence_of_caustics)
