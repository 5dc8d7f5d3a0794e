/* Photon sets: how many, in which order, the same for any threads, and what is refused. */
#include "../../src/cli/parallel.h"
#include "../lit.h"

#include <float.h>
#include <string.h>

static const char *const samplers[] = {"poisson", "stratified", "sobol"};

/* A coloured sphere with a glass ball in it, seen by two lamps: paths store none, one or several photons. */
static pm__scene *room(double ball)
{
    static const pm__light left = {.kind = PM__POINT, .position = {-0.6, 0.0, 0.1}, .power = {1.0, 2.0, 3.0}};
    static const pm__light right = {.kind = PM__POINT, .position = {0.1, 0.5, 0.6}, .power = {0.5, 0.5, 0.5}};
    pm__scene *const scene = lit_create();
    lit_sphere(scene, lit_wall(scene, 0.8, 0.5, 0.2), 0.0, 0.0, 0.0, 1.0, true);
    lit_sphere(scene, lit_glass(scene), ball, 0.0, -0.3, 0.2, false);
    lit_lamp(scene, &left);
    lit_lamp(scene, &right);
    return lit_commit(scene);
}

static bool same(const pm__photon_set *a, const pm__photon_set *b)
{
    return a->count == b->count && a->emitted == b->emitted &&
           !memcmp(a->photons, b->photons, a->count * sizeof *a->photons) && !a->normals == !b->normals &&
           (!a->normals || !memcmp(a->normals, b->normals, a->count * sizeof *a->normals));
}

START_TEST(test_counts)
{
    static const size_t counts[] = {0, 1, 2, 511, 513, 3000};
    pm__scene *const scene = room(0.3);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        pm__shoot_config config = {.scene = scene, .seed = 5, .count = counts[i], .emitted = true};
        pm__photon_set set = lit_shoot(&config);
        ck_assert_uint_eq(set.emitted, counts[i]);
        ck_assert_ptr_null(set.normals);
        pm__photon_set_free(&set);
        ck_assert_ptr_null(set.photons);
        config.emitted = false;
        set = lit_shoot(&config);
        ck_assert_uint_eq(set.count, counts[i]);
        pm__photon_set_free(&set);
    }
    pm__scene_destroy(scene);
}
END_TEST

typedef struct records {
    pm__stored *items;
    size_t count;
} records;

static bool keep(void *context, uint64_t number, const pm__stored *stored)
{
    records *const r = context;
    (void)number;
    r->items = realloc(r->items, (r->count + 1) * sizeof *r->items);
    r->items[r->count++] = *stored;
    return true;
}

/* As pm__trace gives them, one by one. */
START_TEST(test_emitted_are_those_traced)
{
    enum { COUNT = 2000 };
    pm__scene *const scene = room(0.3);
    const pm__shoot_config config = {.scene = scene, .seed = 5, .trial = 2, .count = COUNT, .emitted = true,
                                     .normals = true};
    const pm__trace_config tracing = {.scene = scene, .seed = 5, .trial = 2};
    pm__photon_set set = lit_shoot(&config);
    records r = {NULL, 0};
    (void)pm__trace(&tracing, 0, COUNT, keep, &r);
    ck_assert_uint_eq(set.count, r.count);
    for (size_t i = 0; i < r.count; i++)
        for (int a = 0; a < 3; a++) {
            ck_assert(set.photons[i].position[a] == (float)r.items[i].position[a]);
            ck_assert(set.photons[i].direction[a] == (float)r.items[i].direction[a]);
            ck_assert(set.normals[i][a] == (float)r.items[i].normal[a]);
            PM_CHECK_NEAR((double)set.photons[i].power[a], r.items[i].power[a] / COUNT,
                          2.0 * (double)FLT_EPSILON * r.items[i].power[a] / COUNT);
        }
    pm__photon_set_free(&set);
    free(r.items);
    pm__scene_destroy(scene);
}
END_TEST

/* The last first. */
static void run_backwards(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    (void)context;
    while (count-- > 0)
        task(argument, count);
}

START_TEST(test_same_for_any_threads)
{
    static size_t threads = 3;
    const pm_parallel ways[] = {{run_backwards, NULL}, pm__parallel_for(&threads)};
    pm__scene *const scene = room(0.3);
    for (int s = 0; s < 3; s++)
        for (int emitted = 0; emitted < 2; emitted++) {
            pm__shoot_config config = {.scene = scene, .seed = 9, .trial = 1, .sampler = lit_sampler(samplers[s]),
                                       .count = 7001, .emitted = emitted, .normals = true};
            pm__photon_set serial = lit_shoot(&config);
            for (int w = 0; w < 2; w++) {
                config.parallel = &ways[w];
                pm__photon_set set = lit_shoot(&config);
                ck_assert(same(&serial, &set));
                pm__photon_set_free(&set);
            }
            pm__photon_set_free(&serial);
        }
    pm__scene_destroy(scene);
}
END_TEST

/* Of single stored photons, the power of N out of e is (N - 1) / (e - 1) of what is sent: all of it where all are
 * stored. */
START_TEST(test_power_where_all_is_stored)
{
    static const pm__light lamp = {.kind = PM__POINT, .position = {0.2, 0.0, 0.0}, .power = {1.0, 2.0, 4.0}};
    pm__scene *const scene = lit_create();
    lit_sphere(scene, lit_wall(scene, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 1.0, true);
    lit_lamp(scene, &lamp);
    lit_commit(scene);
    for (int s = 0; s < 3; s++)
        for (size_t count = 1; count < 3000; count = 3 * count + 1) {
            const pm__shoot_config config = {.scene = scene, .seed = 1, .sampler = lit_sampler(samplers[s]),
                                             .count = count};
            pm__photon_set set = lit_shoot(&config);
            for (int b = 0; b < 3; b++)
                PM_CHECK_NEAR(lit_power(&set, b), lamp.power[b], 1e-6 * lamp.power[b]);
            ck_assert_uint_eq(set.emitted, set.count);
            pm__photon_set_free(&set);
        }
    pm__scene_destroy(scene);
}
END_TEST

/* ---- A changed scene ([C02] 5.1) --------------------------------------------------------------- */

/* Does the way from `from` on to `to` come near a ball of radius 0.2 at (x, 0, -0.3)? */
static bool passes(const double from[3], const double to[3], double x)
{
    double way[3], out[3];
    const double centre[3] = {x, 0.0, -0.3};
    for (int i = 0; i < 3; i++) {
        way[i] = to[i] - from[i];
        out[i] = centre[i] - from[i];
    }
    const double t = fmin(fmax(pm__dot(way, out) / pm__dot(way, way), 0.0), 1.0);
    for (int i = 0; i < 3; i++)
        out[i] -= t * way[i];
    return pm__dot(out, out) < 0.2001 * 0.2001;
}

/* Photons of one path. */
typedef struct path {
    size_t count;
    pm__stored photons[PM__LONGEST_PATH];
} path;

static bool keep_path(void *context, uint64_t number, const pm__stored *stored)
{
    path *const p = context;
    (void)number;
    p->photons[p->count++] = *stored;
    return true;
}

static void trace_path(const pm__scene *scene, uint64_t number, path *p)
{
    const pm__trace_config tracing = {.scene = scene, .seed = 3};
    p->count = 0;
    (void)pm__trace(&tracing, number, 1, keep_path, p);
}

/* Of a path from either lamp through a room without a ball: straight from where it is stored to where it is next. */
static bool touches(const pm__scene *scene, const path *p, double x)
{
    bool touched = false;
    for (size_t i = 0; i < p->count; i++)
        for (size_t lamp = 0; lamp < 2; lamp++) {
            const double *const from = i ? p->photons[i - 1].position : pm__scene_light_at(scene, lamp)->position;
            touched = touched || passes(from, p->photons[i].position, x);
        }
    return touched;
}

static bool same_path(const path *a, const path *b)
{
    return a->count == b->count && !memcmp(a->photons, b->photons, a->count * sizeof *a->photons);
}

/* A glass ball that moves changes the photons whose way it stood in or stands in now, and no other: number, path and
 * power stay bit by bit. */
START_TEST(test_moved_glass_changes_what_it_touches)
{
    enum { COUNT = 20000 };
    static path before, after, without;
    pm__scene *const old = room(0.3), *const new = room(0.35), *const empty = room(5.0);
    size_t changed = 0;
    for (uint64_t n = 0; n < COUNT; n++) {
        trace_path(old, n, &before);
        trace_path(new, n, &after);
        if (same_path(&before, &after))
            continue;
        trace_path(empty, n, &without);
        ck_assert_msg(touches(empty, &without, 0.3) || touches(empty, &without, 0.35),
                      "photon %llu changed, and had no glass in its way", (unsigned long long)n);
        changed++;
    }
    ck_assert_uint_gt(changed, COUNT / 100);
    ck_assert_uint_lt(changed, COUNT / 4);
    pm__scene_destroy(old);
    pm__scene_destroy(new);
    pm__scene_destroy(empty);
}
END_TEST

/* A floor under parallel light, and a glass ball above it at x. */
static pm__photon_set floor_photons(double x)
{
    static const pm__light sun = {.kind = PM__DIRECTIONAL, .position = {0.0, 0.0, 3.0}, .direction = {0.0, 0.0, -1.0},
                                  .radius = 2.0, .power = {1.0, 1.0, 1.0}};
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 0.0, 0.0, 0.0), 3.0, 0.0);
    lit_sphere(scene, lit_glass(scene), x, 0.0, 0.6, 0.3, false);
    lit_lamp(scene, &sun);
    const pm__shoot_config config = {.scene = lit_commit(scene), .seed = 3, .count = 20000, .emitted = true};
    const pm__photon_set set = lit_shoot(&config);
    pm__scene_destroy(scene);
    return set;
}

static bool outside(const pm_photon *p)
{
    const double y = (double)p->position[1];
    bool out = true;
    for (int i = 0; i < 2; i++) {
        const double x = (double)p->position[0] - (i ? -0.7 : 0.7);
        out = out && x * x + y * y > 0.3001 * 0.3001;
    }
    return out && (double)p->direction[2] == -1.0;
}

/* The next photon that came straight down beside both places. */
static size_t next_outside(const pm__photon_set *set, size_t i)
{
    while (i < set->count && !outside(&set->photons[i]))
        i++;
    return i;
}

/* Only the caustic and the shadow move: all other photons are there as before, bit by bit and in order. */
START_TEST(test_only_the_caustic_moves)
{
    pm__photon_set a = floor_photons(-0.7), b = floor_photons(0.7);
    size_t i = next_outside(&a, 0), j = next_outside(&b, 0), unchanged = 0;
    for (; i < a.count && j < b.count; unchanged++) {
        ck_assert(!memcmp(&a.photons[i], &b.photons[j], sizeof a.photons[i]));
        i = next_outside(&a, i + 1);
        j = next_outside(&b, j + 1);
    }
    ck_assert(i == a.count && j == b.count);
    ck_assert_uint_gt(unchanged, 18000); /* 1 - 2 * 0.09 / 4 of 20000 */
    pm__photon_set_free(&a);
    pm__photon_set_free(&b);
}
END_TEST

/* ---- Samplers and lights ----------------------------------------------------------------------- */

/* Lights of 1 : 2 : 4, each into its own black sphere: photons of equal power, by share. */
START_TEST(test_lights_by_share)
{
    enum { COUNT = 1000 };
    pm__scene *const scene = lit_create();
    const uint32_t wall = lit_wall(scene, 0.0, 0.0, 0.0);
    for (int i = 0; i < 3; i++) {
        const double watts = 1 << i;
        const pm__light lamp = {.kind = PM__POINT, .position = {10.0 * i, 0.0, 0.0}, .power = {watts, 0.0, 0.0}};
        lit_sphere(scene, wall, 10.0 * i, 0.0, 0.0, 1.0, true);
        lit_lamp(scene, &lamp);
    }
    lit_commit(scene);
    for (uint32_t trial = 0; trial < 40; trial++) {
        const pm__shoot_config config = {.scene = scene, .seed = 1, .trial = trial, .sampler = lit_sampler("sobol"),
                                         .count = COUNT, .emitted = true};
        pm__photon_set set = lit_shoot(&config);
        size_t counts[3] = {0};
        ck_assert_uint_eq(set.count, COUNT);
        for (size_t i = 0; i < set.count; i++) {
            counts[(int)((set.photons[i].position[0] + 1.5f) / 10.0f)]++;
            PM_CHECK_NEAR((double)set.photons[i].power[0], 7.0 / COUNT, 1e-6 * 7.0 / COUNT);
        }
        for (int i = 0; i < 3; i++)
            PM_CHECK_NEAR((double)counts[i], COUNT * (1 << i) / 7.0, 1.0);
        pm__photon_set_free(&set);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* A third of the lamp's photons come to be stored, of sets that must be whole. */
START_TEST(test_about_as_many_as_asked)
{
    pm__scene *const scene = room(0.3);
    pm__paths *paths;
    pm_error error;
    PM_CHECK_OK(pm__paths_create("LS+D", &paths, &error), error);
    for (int s = 1; s < 3; s++) {
        const pm__shoot_config config = {.scene = scene, .paths = paths, .seed = 4, .sampler = lit_sampler(samplers[s]),
                                         .count = 5000};
        pm__photon_set set = lit_shoot(&config);
        /* Counts of the trial run and of the set have deviations of 4.5 and 1.4 %. */
        PM_CHECK_NEAR((double)set.count, 5000.0, 6.0 * 0.047 * 5000.0);
        pm__photon_set_free(&set);
    }
    pm__paths_destroy(paths);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Shadow photons ------------------------------------------------------------------------------ */

/* A lamp at height 2 over a floor, and between them at height 1 a disc of radius 0.25: its shadow has radius 0.5. */
static pm__scene *shaded(const pm__material *material)
{
    static const double centre[3] = {0.0, 0.0, 1.0}, up[3] = {0.0, 0.0, 1.0};
    static const pm__light lamp = {.kind = PM__SPOT, .position = {0.0, 0.0, 2.0}, .direction = {0.0, 0.0, -1.0},
                                   .angle = 0.5, .power = {1.0, 1.0, 1.0}};
    static const pm__light other = {.kind = PM__POINT, .position = {0.0, 0.0, 5.0}, .power = {1.0, 1.0, 1.0}};
    pm__scene *const scene = lit_create();
    pm_error error;
    lit_lamp(scene, &other);
    lit_lamp(scene, &lamp);
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 3.0, 0.0);
    PM_CHECK_OK(pm__scene_disc(scene, lit_material(scene, material), centre, up, 0.25, &error), error);
    return lit_commit(scene);
}

static void check_shadows(const pm__material *material, const pm__sampler *sampler, size_t expected_on_disc)
{
    pm__scene *const scene = shaded(material);
    const pm__shoot_config config = {.scene = scene, .seed = 2, .sampler = sampler, .count = 4900, .normals = true};
    pm__photon_set set;
    unsigned char *shadow;
    pm_error error;
    size_t on_disc = 0, dark = 0;
    PM_CHECK_OK(pm__shoot_shadows(&config, 1, &set, &shadow, &error), error);
    for (size_t i = 0; i < set.count; i++) {
        const pm_photon *const p = &set.photons[i];
        const double rho = hypot((double)p->position[0], (double)p->position[1]);
        const bool disc = p->position[2] > 0.5f;
        on_disc += disc;
        dark += shadow[i];
        ck_assert(shadow[i] == (!disc && rho < 0.5));
        PM_CHECK_NEAR((double)p->power[0], shadow[i] ? 0.0 : 1.0 / (double)set.emitted, 1e-9);
        ck_assert(set.normals[i][2] == 1.0f);
    }
    ck_assert_uint_eq(set.count, set.emitted + on_disc);
    ck_assert_uint_eq(on_disc, expected_on_disc ? dark : 0);
    /* (1 - cos atan(1/4)) / (1 - cos 0.5) = 0.2440 of 4900, within 6 deviations */
    PM_CHECK_NEAR((double)dark, 0.24398 * 4900.0, 6.0 * sqrt(4900.0 * 0.244 * 0.756));
    free(shadow);
    pm__photon_set_free(&set);
    pm__scene_destroy(scene);
}

START_TEST(test_shadows)
{
    const pm__material rough = {.kind = PM__DIFFUSE, .diffuse = {0.5, 0.5, 0.5}}, mirror = {.kind = PM__MIRROR};
    for (int s = 0; s < 3; s++) {
        check_shadows(&rough, lit_sampler(samplers[s]), 1);
        check_shadows(&mirror, lit_sampler(samplers[s]), 0);
    }
}
END_TEST

/* ---- What is refused ----------------------------------------------------------------------------- */

static bool stop_at_once(void *context)
{
    (void)context;
    return true;
}

static void check_refused(const pm__shoot_config *config, pm_status expected, const char *text)
{
    pm_error error = {""};
    pm__photon_set set = {.count = 1, .emitted = 1};
    ck_assert_int_eq(pm__shoot(config, &set, &error), expected);
    ck_assert_msg(strstr(error.text, text), "'%s' does not say '%s'", error.text, text);
    ck_assert(!set.photons && !set.normals && set.count == 0 && set.emitted == 0);
    ck_assert_int_eq(pm__shoot(config, &set, NULL), expected);
}

START_TEST(test_refusals)
{
    pm__scene *const scene = room(0.3);
    pm__paths *never;
    pm_error error;
    PM_CHECK_OK(pm__paths_create("LSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSSD", &never, &error), error);
    for (int s = 0; s < 3; s++) {
        const pm__sampler *const sampler = lit_sampler(samplers[s]);
        pm__shoot_config config = {.scene = scene, .seed = 1, .sampler = sampler, .count = 100,
                                   .canceled = stop_at_once};
        check_refused(&config, PM_ECANCELED, "canceled");
        config.canceled = NULL;
        config.paths = never;
        check_refused(&config, PM_EINVAL, "0 of ");
        config.paths = NULL;
        config.count = PM_MAX_PHOTONS + 1;
        check_refused(&config, PM_EINVAL, "at most");
    }
    pm__paths_destroy(never);
    pm__scene_destroy(scene);
}
END_TEST

/* Lamps of more or less power than floats hold: fine where the photons' fits. */
static pm_status shoot_watts(double watts, size_t count, pm_error *error)
{
    const pm__light lamp = {.kind = PM__POINT, .power = {watts, watts, watts}};
    pm__scene *const scene = lit_create();
    lit_sphere(scene, lit_wall(scene, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 1.0, true);
    lit_lamp(scene, &lamp);
    lit_commit(scene);
    const pm__shoot_config config = {.scene = scene, .seed = 1, .count = count, .emitted = true};
    pm__photon_set set;
    const pm_status status = pm__shoot(&config, &set, error);
    if (status == PM_OK)
        PM_CHECK_NEAR(lit_power(&set, 1) / watts, 1.0, 1e-6);
    pm__photon_set_free(&set);
    pm__scene_destroy(scene);
    return status;
}

START_TEST(test_powers_of_floats)
{
    pm_error error;
    PM_CHECK_OK(shoot_watts(1e40, 1000, &error), error);
    PM_CHECK_OK(shoot_watts(1e-34, 1000, &error), error);
    ck_assert_int_eq(shoot_watts(1e40, 10, &error), PM_EINVAL);
    ck_assert_ptr_nonnull(strstr(error.text, "more than a float holds"));
    ck_assert_int_eq(shoot_watts(1e-36, 1000, &error), PM_EINVAL);
    ck_assert_ptr_nonnull(strstr(error.text, "less than a float holds"));
}
END_TEST

/* A room for sets, used for one after the other: the same photons, nothing lost, and empty after an error. */
START_TEST(test_room)
{
    static const size_t counts[] = {700, 3000, 20, 2000};
    pm__scene *const scene = room(0.3);
    pm__photon_room of_photons = {NULL, 0};
    for (size_t i = 0; i < 2 * sizeof counts / sizeof *counts; i++) {
        const size_t at = i / 2;
        const bool spread = i % 2;
        pm__shoot_config config = {.scene = scene, .seed = 5, .trial = (uint32_t)i, .count = counts[at],
                                   .emitted = true, .sampler = spread ? lit_sampler("sobol") : NULL};
        pm__photon_set own = lit_shoot(&config);
        config.room = &of_photons;
        pm__photon_set set = lit_shoot(&config);
        ck_assert(same(&own, &set));
        ck_assert(set.photons == of_photons.photons && of_photons.capacity >= set.count);
        pm__photon_set_free(&set);
        ck_assert_ptr_nonnull(of_photons.photons);
        config.normals = true; /* these have memory of their own */
        set = lit_shoot(&config);
        ck_assert(set.photons != of_photons.photons);
        pm__photon_set_free(&set);
        pm__photon_set_free(&own);
    }
    const pm__shoot_config stopped = {.scene = scene, .count = 1000, .emitted = true, .canceled = stop_at_once,
                                      .room = &of_photons};
    check_refused(&stopped, PM_ECANCELED, "canceled");
    ck_assert(!of_photons.photons && !of_photons.capacity);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("shoot", test_counts, test_emitted_are_those_traced, test_same_for_any_threads,
             test_power_where_all_is_stored, test_moved_glass_changes_what_it_touches, test_only_the_caustic_moves,
             test_lights_by_share, test_about_as_many_as_asked, test_shadows, test_refusals, test_powers_of_floats,
             test_room)
