/* Paths from the camera through mirrors, glass and media, against what can be worked out by hand. Where chance decides,
 * the counts have their bounds for a false alarm in 1e-7 each (5.3 standard deviations of the binomial). */
#include "../../src/base/vec3.h"
#include "../../src/transport/eye.h"
#include "../lit.h"

#include <string.h>

enum { PATHS = 20000 };

static const double pi = 3.14159265358979323846;

static pm__eye start(const pm__scene *scene, double x, double y, double z, double dx, double dy, double dz,
                     uint64_t number)
{
    const double from[3] = {x, y, z};
    double direction[3] = {dx, dy, dz};
    const pm__eye_numbers numbers = pm__eye_numbers_of(3, 0, 0, number);
    pm__eye eye;
    pm__normalize(direction);
    pm__eye_start(&eye, scene, &numbers, from, direction);
    return eye;
}

static uint32_t mirror(pm__scene *scene, double r, double g, double b)
{
    const pm__material material = {.kind = PM__MIRROR, .specular = {r, g, b}};
    return lit_material(scene, &material);
}

static uint32_t glass(pm__scene *scene, double ior, double inside, double outside)
{
    const pm__material material = {.kind = PM__GLASS, .ior = {ior, ior, ior},
                                   .absorption = {inside, 2.0 * inside, 0.0}, .outside = {outside, 0.0, 3.0 * outside}};
    return lit_material(scene, &material);
}

static void lamp_far_off(pm__scene *scene)
{
    const pm__light light = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0, 0, 1000}};
    lit_lamp(scene, &light);
}

static void upright(pm__scene *scene, uint32_t material, double x, double size)
{
    pm_error error;
    const double corner[3] = {x, -size, -size}, u[3] = {0, 2.0 * size, 0}, v[3] = {0, 0, 2.0 * size};
    PM_CHECK_OK(pm__scene_rectangle(scene, material, corner, u, v, &error), error);
}

static double binomial_bound(double n, double p)
{
    return 5.3 * sqrt(n * p * (1.0 - p)) + 1.0;
}

/* Between two mirrors that face each other, to a wall at the end: the place reached, and the weight. */
START_TEST(two_mirrors)
{
    pm__scene *const scene = lit_create();
    upright(scene, mirror(scene, 1.0, 1.0, 1.0), -1.0, 100.0);
    upright(scene, mirror(scene, 1.0, 1.0, 1.0), 1.0, 100.0);
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 2.0, -7.5);
    lamp_far_off(scene);
    lit_commit(scene);
    pm__eye eye = start(scene, 0, 0, 0, 1, 0, -1, 0);
    ck_assert(pm__eye_follow(&eye));
    ck_assert_int_eq(eye.bounces, 4); /* at z = -1, -3, -5, -7 */
    PM_CHECK_NEAR(eye.hit.position[0], -0.5, 1e-12);
    PM_CHECK_NEAR(eye.hit.position[2], -7.5, 1e-12);
    PM_CHECK_NEAR(eye.travelled, 0.5 * sqrt(2.0), 1e-12);
    for (int b = 0; b < 3; b++)
        PM_CHECK_NEAR(eye.weight[b], 1.0, 0.0);
    PM_CHECK_NEAR(eye.facing[2], 1.0, 0.0);
    PM_CHECK_NEAR(eye.outgoing[2], sqrt(0.5), 1e-12);
    pm__scene_destroy(scene);
}
END_TEST

/* Coloured: the mean of what goes on is the reflectance by band, whatever roulette does. */
START_TEST(a_coloured_mirror)
{
    pm__scene *const scene = lit_create();
    upright(scene, mirror(scene, 0.8, 0.4, 0.2), 1.0, 10.0);
    upright(scene, lit_wall(scene, 1, 1, 1), -1.0, 10.0);
    lamp_far_off(scene);
    lit_commit(scene);
    double sum[3] = {0, 0, 0};
    for (uint64_t i = 0; i < PATHS; i++) {
        pm__eye eye = start(scene, 0, 0, 0, 1, 0, 0, i);
        if (pm__eye_follow(&eye))
            for (int b = 0; b < 3; b++)
                sum[b] += eye.weight[b] / PATHS;
    }
    static const double want[3] = {0.8, 0.4, 0.2};
    for (int b = 0; b < 3; b++) /* a path goes on with chance 0.8 */
        PM_CHECK_NEAR(sum[b], want[b], want[b] / 0.8 * binomial_bound(PATHS, 0.8) / PATHS);
    pm__scene_destroy(scene);
}
END_TEST

/* Straight down into still water: radiance of the floor comes up as T / n^2; out of it, as T n^2; a plate changes
 * nothing but T. Each path that gets through carries exactly the ratio of squares. */
static void check_crossing(pm__scene *scene, double z, double chance, const double weight[3])
{
    double through = 0.0;
    for (uint64_t i = 0; i < PATHS; i++) {
        pm__eye eye = start(scene, 0, 0, z, 0, 0, -1, i);
        if (!pm__eye_follow(&eye))
            continue;
        through += 1.0;
        for (int b = 0; b < 3; b++)
            PM_CHECK_NEAR(eye.weight[b], weight[b], 1e-12 * weight[b]);
    }
    PM_CHECK_NEAR(through, chance * PATHS, binomial_bound(PATHS, chance));
}

START_TEST(radiance_changes_with_the_square_of_the_index)
{
    const double n = 1.33, t = 1.0 - pow((n - 1.0) / (n + 1.0), 2);
    const double in[3] = {1.0 / (n * n), 1.0 / (n * n), 1.0 / (n * n)}, out[3] = {n * n, n * n, n * n};
    static const double same[3] = {1, 1, 1};
    for (int i = 0; i < 3; i++) {
        pm__scene *const scene = lit_create();
        if (i < 2) {
            lit_floor(scene, glass(scene, i ? 1.0 / n : n, 0, 0), 5.0, 1.0);
        } else {
            pm_error error;
            const double corner[3] = {-5, -5, 0.8}, u[3] = {0, 10, 0}, v[3] = {10, 0, 0};
            const uint32_t plate = glass(scene, n, 0, 0);
            lit_floor(scene, plate, 5.0, 1.0);
            PM_CHECK_OK(pm__scene_rectangle(scene, plate, corner, u, v, &error), error);
        }
        lit_floor(scene, lit_wall(scene, 1, 1, 1), 5.0, 0.0);
        lamp_far_off(scene);
        lit_commit(scene);
        const double *const weight[] = {in, out, same}; /* air over water, water over air, a plate */
        /* the plate with all its internal reflections: T^2 / (1 - R^2) */
        check_crossing(scene, 2.0, i < 2 ? t : t * t / (1.0 - (1.0 - t) * (1.0 - t)), weight[i]);
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Bands that bend apart: each keeps its own mean though a path carries one alone. */
START_TEST(bands_that_bend_apart_keep_their_means)
{
    static const double n[3] = {1.3, 1.5, 1.9};
    pm__scene *const scene = lit_create();
    const pm__material prism = {.kind = PM__GLASS, .ior = {n[0], n[1], n[2]}};
    lit_floor(scene, lit_material(scene, &prism), 5.0, 1.0);
    lit_floor(scene, lit_wall(scene, 1, 1, 1), 5.0, 0.0);
    lamp_far_off(scene);
    lit_commit(scene);
    double sum[3] = {0, 0, 0}, most[3] = {0, 0, 0};
    int mixed = 0;
    for (uint64_t i = 0; i < PATHS; i++) {
        pm__eye eye = start(scene, 0, 0, 2, 0.3, 0, -1, i);
        if (!pm__eye_follow(&eye))
            continue;
        for (int b = 0; b < 3; b++) {
            sum[b] += eye.weight[b] / PATHS;
            most[b] = fmax(most[b], eye.weight[b]);
        }
        mixed += (eye.weight[0] > 0.0) + (eye.weight[1] > 0.0) + (eye.weight[2] > 0.0) != 1;
    }
    ck_assert_int_eq(mixed, 0);
    for (int b = 0; b < 3; b++) {
        double refracted;
        const double want = (1.0 - pm__fresnel(1.0 / sqrt(1.09), n[b], &refracted)) / (n[b] * n[b]);
        const double chance = want / most[b]; /* all that carry the band carry the same */
        PM_CHECK_NEAR(sum[b], want, most[b] * binomial_bound(PATHS, chance) / PATHS);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* Balls in one another that do not bend light: 1 m in the outer, 1 m in the inner, 0.5 m in the outer again, air. */
START_TEST(beers_law_in_nested_media)
{
    pm__scene *const scene = lit_create();
    lit_sphere(scene, glass(scene, 1.0, 0.3, 0.0), 0, 0, 0, 1.25, false);
    lit_sphere(scene, glass(scene, 1.0, 0.7, 0.3), 0.25, 0, 0, 0.5, false);
    upright(scene, lit_wall(scene, 1, 1, 1), 3.0, 5.0);
    lamp_far_off(scene);
    lit_commit(scene);
    pm__eye eye = start(scene, -4, 0, 0, 1, 0, 0, 0);
    ck_assert(pm__eye_follow(&eye));
    ck_assert_int_eq(eye.bounces, 4);
    /* outer: 0.3, 0.6, 0; inner: 0.7, 1.4, 0; what the inner ball's boundary says of the outer: 0.3, 0, 0.9 */
    const double red = 0.3 * 1.0 + 0.7 * 1.0 + 0.3 * 0.5;
    PM_CHECK_NEAR(eye.weight[0], exp(-red), 1e-12);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Lights that are seen ---------------------------------------------------------------------- */

static const double lamp_radius = 0.5;

static double lamp_radiance(void)
{
    return 1.0 / (4.0 * pi * pi * lamp_radius * lamp_radius);
}

static void add_lamp(pm__scene *scene, double x, double y, double z)
{
    const pm__light light = {.kind = PM__BALL, .power = {1, 2, 3}, .position = {x, y, z}, .radius = lamp_radius};
    lit_lamp(scene, &light);
}

/* A lamp seen straight, and again behind its mirror image; not through a wall; and absorbed by what it stands in. */
START_TEST(lamps_are_seen_by_the_way_they_are_met)
{
    pm__scene *const scene = lit_create();
    upright(scene, mirror(scene, 1, 1, 1), 4.0, 10.0);
    upright(scene, lit_wall(scene, 0, 0, 0), -4.0, 10.0);
    add_lamp(scene, 2.0, 0, 0);
    add_lamp(scene, -6.0, 0, 0); /* behind the wall */
    lit_commit(scene);
    pm__eye eye = start(scene, 0, 0, 0, 1, 0, 0, 0);
    ck_assert(pm__eye_follow(&eye));
    for (int b = 0; b < 3; b++)
        PM_CHECK_NEAR(eye.emitted[b], 2.0 * (b + 1) * lamp_radiance(), 1e-12);
    eye = start(scene, 0, 0, 0, 0, 1, 0, 0);
    ck_assert(!pm__eye_follow(&eye));
    PM_CHECK_NEAR(eye.emitted[0], 0.0, 0.0);
    pm__scene_destroy(scene);
}
END_TEST

START_TEST(lamps_in_a_medium_are_absorbed)
{
    pm__scene *const scene = lit_create();
    lit_sphere(scene, glass(scene, 1.0, 0.4, 0.0), 0, 0, 0, 2.0, false);
    add_lamp(scene, 1.0, 0, 0);
    lit_commit(scene);
    const double from_without = 0.4 * 2.5, from_within = 0.4 * 0.5;
    pm__eye eye = start(scene, -5, 0, 0, 1, 0, 0, 0);
    ck_assert(!pm__eye_follow(&eye));
    PM_CHECK_NEAR(eye.emitted[0], exp(-from_without) * lamp_radiance(), 1e-12);
    PM_CHECK_NEAR(eye.emitted[1], 2.0 * exp(-2.0 * from_without) * lamp_radiance(), 1e-12);
    PM_CHECK_NEAR(eye.emitted[2], 3.0 * lamp_radiance(), 1e-12);
    eye = start(scene, 0, 0, 0, 1, 0, 0, 0);
    ck_assert(!pm__eye_follow(&eye));
    PM_CHECK_NEAR(eye.emitted[0], exp(-from_within) * lamp_radiance(), 1e-12);
    pm__scene_destroy(scene);
}
END_TEST

/* Off a rough surface lamps count by shadow rays, so not where they are met, but behind a mirror where caustics are
 * wanted: never both. */
START_TEST(no_lamp_counts_twice)
{
    for (int mirrored = 0; mirrored < 2; mirrored++)
        for (int caustics = 0; caustics < 2; caustics++) {
            pm__scene *const scene = lit_create();
            lit_sphere(scene, lit_wall(scene, 1, 1, 1), 0, 0, 0, 0.01, false);
            const uint32_t shell = mirrored ? mirror(scene, 1, 1, 1) : lit_wall(scene, 0, 0, 0);
            lit_sphere(scene, shell, 0, 0, 0, 10.0, true);
            add_lamp(scene, 0, 0, 5.0);
            lit_commit(scene);
            bool any = false;
            for (uint64_t i = 0; i < 300; i++) {
                pm__eye eye = start(scene, 0, 0, 1, 0, 0, -1, i);
                ck_assert(pm__eye_follow(&eye));
                PM_CHECK_NEAR(eye.emitted[0], 0.0, 0.0);
                eye.sees_caustics = caustics;
                while (pm__eye_bounce(&eye) && eye.bounces < 3 && pm__eye_follow(&eye))
                    ck_assert(!eye.sees_lights || eye.hit.material->kind != PM__MIRROR);
                any = any || eye.emitted[0] > 0.0;
            }
            ck_assert_msg(any == (mirrored && caustics), "mirror %d, caustics wanted %d", mirrored, caustics);
            pm__scene_destroy(scene);
        }
}
END_TEST

/* The numbers of a path are its own: of seed, trial, pass, pixel and place in the path. */
START_TEST(numbers_of_a_path_are_its_own)
{
    enum { KEYS = 7 };
    static const uint64_t keys[KEYS][4] = {/* seed, trial, pass, pixel */
                                           {1, 0, 0, 0}, {2, 0, 0, 0}, {1, 1, 0, 0}, {1, 0, 1, 0},
                                           {1, 0, 0, 1}, {1, 4096, 0, 0}, {1, 4097, 0, 0}};
    double first[KEYS][3];
    for (int i = 0; i < KEYS; i++) {
        double again[3];
        pm__eye_numbers one = pm__eye_numbers_of(keys[i][0], (uint32_t)keys[i][1], (uint32_t)keys[i][2], keys[i][3]);
        pm__eye_numbers two = one;
        pm__eye_uniform(&one, first[i]);
        pm__eye_uniform(&two, again);
        ck_assert_mem_eq(first[i], again, sizeof again);
        pm__eye_uniform(&two, again);
        ck_assert_mem_ne(first[i], again, sizeof again);
        for (int j = 0; j < i; j++)
            ck_assert_mem_ne(first[i], first[j], sizeof first[i]);
    }
}
END_TEST

PM_TEST_MAIN("eye", two_mirrors, a_coloured_mirror, radiance_changes_with_the_square_of_the_index,
             bands_that_bend_apart_keep_their_means, beers_law_in_nested_media, lamps_are_seen_by_the_way_they_are_met,
             lamps_in_a_medium_are_absorbed, no_lamp_counts_twice, numbers_of_a_path_are_its_own)
