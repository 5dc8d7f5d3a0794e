/* Lights chosen for many photons at once: those that are chosen one by one, also where a photon's number is the very
 * end of a light's share; and whether a scene absorbs. */
#include "../../cases/scenes/list.h"
#include "../../src/transport/emission.h"
#include "../lit.h"

#include <string.h>

enum { LIGHTS = 6, BATCHES = 40 };

static const char *const widths[] = {"plain", "avx2", "avx512"};

/* A room's worth of nothing but lamps, each of its power and place. */
static pm__scene *lamps(const double *powers, size_t count)
{
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 1.0, 0.0);
    for (size_t i = 0; i < count; i++) {
        const pm__light lamp = {.kind = PM__POINT, .power = {powers[i], 0.0, 0.0}, .position = {(double)i, 0.0, 1.0}};
        lit_lamp(scene, &lamp);
    }
    return lit_commit(scene);
}

static bool take_width(size_t w)
{
    const pm__batch_kernel *const kernels[] = {&pm__batch_plain, &pm__batch_avx2, &pm__batch_avx512};
    ck_assert_int_eq(setenv("PHOTONBENCH_SIMD", widths[w], 1), 0);
    return pm__batch_choose() == kernels[w]; /* else the processor lacks it */
}

/* Numbers from `first`: to the last bit as they leave by themselves. */
static void check_batch(const pm__emission *emission, uint64_t first, size_t count)
{
    static pm__batch b;
    b.count = count;
    for (size_t i = 0; i < count; i++)
        b.number[i] = first + 3 * i;
    ck_assert(pm__depart_all(emission, pm__batch_choose(), &b));
    for (size_t i = 0; i < count; i++) {
        pm__departure alone;
        ck_assert(pm__depart(emission, b.number[i], &alone));
        for (int axis = 0; axis < 3; axis++)
            ck_assert_msg(b.origin[axis][i] == alone.position[axis] && b.direction[axis][i] == alone.direction[axis] &&
                              b.power[axis][i] == alone.power[axis],
                          "photon %llu: power %.17g at %.17g, alone %.17g at %.17g", (unsigned long long)b.number[i],
                          b.power[axis][i], b.origin[axis][i], alone.power[axis], alone.position[axis]);
    }
}

static void check_emission(const pm__emission *emission)
{
    for (size_t w = 0; w < sizeof widths / sizeof *widths; w++)
        for (uint64_t k = 0; k < BATCHES && take_width(w); k++)
            check_batch(emission, k * 1000003, k % 3 ? PM__BATCH : 5);
}

/* All lights, then each by itself: its share is all of the power, before and behind it none. */
static void check_lights(const pm__scene *scene)
{
    pm__emission emission;
    pm__emission_init(scene, NULL, PM__ALL_LIGHTS, 11, 2, &emission);
    check_emission(&emission);
    for (size_t only = 0; only < pm__scene_light_count(scene); only++) {
        pm__emission_init(scene, NULL, only, 11, 2, &emission);
        check_emission(&emission);
    }
}

START_TEST(test_four_lights)
{
    pm__scene *scene;
    pm__spec spec;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, "scene:four-lights", &spec, &error), error);
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__case_scene_four_lights.build(spec.values, scene, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    ck_assert_uint_eq(pm__scene_light_count(scene), 4);
    check_lights(scene);
    pm__scene_destroy(scene);
}
END_TEST

/* Lamps of very different power, whose sums round. */
START_TEST(test_many_lights)
{
    static const double powers[LIGHTS] = {0.1, 1e-17, 0.7, 1e-3, 0.3, 1e-30};
    pm__scene *const scene = lamps(powers, LIGHTS);
    check_lights(scene);
    pm__scene_destroy(scene);
}
END_TEST

/* The lamp that the photon leaves, by its place. */
static size_t lamp_of(const pm__scene *scene, uint64_t number, bool together)
{
    pm__emission emission;
    pm__departure alone;
    pm__emission_init(scene, NULL, PM__ALL_LIGHTS, 11, 2, &emission);
    ck_assert(pm__depart(&emission, number, &alone));
    if (together) {
        static pm__batch b;
        b.count = 1;
        b.number[0] = number;
        ck_assert(pm__depart_all(&emission, pm__batch_choose(), &b));
        alone.position[0] = b.origin[0][0];
    }
    return (size_t)alone.position[0];
}

/* Of u, the photon's own number of 42 bits, two lamps of 1 W in all have shares [0, u) and [u, 1): the photon is the
 * second's. A share of one unit more, and it is the first's. Both powers, and their sum, are exact. The same with a
 * lamp before them, where u begins the third's. */
START_TEST(test_ends_of_shares)
{
    for (uint64_t number = 0; number < 200; number++) {
        double v[3];
        pm__trace_uniform(11, 2, number, 1, v);
        const double u = v[1], unit = 0x1p-42;
        ck_assert(u > 2.0 * unit && u < 1.0 - 2.0 * unit);
        for (int more = -1; more <= 1; more++) {
            const double end = u + more * unit, half = ldexp(floor(ldexp(u, 40)), -41);
            const double two[] = {end, 1.0 - end}, three[] = {half, end - half, 1.0 - end};
            pm__scene *const pair = lamps(two, 2), *const triple = lamps(three, 3);
            for (int together = 0; together < 2; together++) {
                ck_assert_uint_eq(lamp_of(pair, number, together), more > 0 ? 0 : 1);
                ck_assert_uint_eq(lamp_of(triple, number, together), more > 0 ? 1 : 2);
            }
            pm__scene_destroy(pair);
            pm__scene_destroy(triple);
        }
    }
}
END_TEST

/* ---- Media ---------------------------------------------------------------------------------------- */

static pm__scene *scene_of(const pm__material *materials, size_t count, const pm__material *inner)
{
    pm__scene *const scene = lit_create();
    const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 1.0, 1.0}, .position = {0.0, 0.0, 5.0}};
    const pm__placement place = {.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1.0};
    pm__scene *part;
    pm_error error;
    for (size_t i = 0; i < count; i++)
        lit_sphere(scene, lit_material(scene, &materials[i]), 3.0 * (double)i, 0.0, 0.0, 1.0, false);
    lit_lamp(scene, &lamp);
    if (inner) {
        PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
        lit_sphere(part, lit_material(part, inner), 0.0, 3.0, 0.0, 1.0, false);
        PM_CHECK_OK(pm__scene_place(scene, part, &place, &error), error);
    }
    return lit_commit(scene);
}

START_TEST(test_absorbs)
{
    const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {0.5, 0.5, 0.5}}, black = {.kind = PM__BLACK};
    const pm__material clear = {.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}};
    pm__material tinted[3] = {clear, clear, clear};
    for (int band = 0; band < 3; band++)
        tinted[band].absorption[band] = 1e-9;
    const pm__material none[] = {wall, black, clear}, first[] = {tinted[0], wall}, last[] = {wall, clear, tinted[2]};
    const struct {
        const pm__material *materials;
        size_t count;
        const pm__material *inner;
        bool want;
    } cases[] = {{none, 3, NULL, false}, {none, 3, &clear, false},     {none, 3, &wall, false},
                 {first, 2, NULL, true}, {last, 3, NULL, true},        {none, 3, &tinted[1], true},
                 {first, 2, &wall, true}, {&tinted[1], 1, NULL, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pm__scene *const scene = scene_of(cases[i].materials, cases[i].count, cases[i].inner);
        ck_assert_msg(pm__scene_absorbs(scene) == cases[i].want, "case %zu: %d", i, !cases[i].want);
        pm__scene_destroy(scene);
    }
}
END_TEST

/* A lamp in the middle of a ball of index 1 and radius 1 m, in a black room: all its light passes 1 m of the medium,
 * exp(-absorption) of it is left. Also where the only medium is in a part. */
START_TEST(test_absorbed_in_part)
{
    static const double absorption[3] = {0.5, 2.0, 0.0};
    const pm__material ball = {.kind = PM__GLASS, .ior = {1.0, 1.0, 1.0}, .absorption = {0.5, 2.0, 0.0}};
    const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 2.0, 3.0}, .position = {0.3, 0.2, 0.1}};
    const pm__placement place = {.rotation = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, .scale = 1.0,
                                .offset = {0.3, 0.2, 0.1}};
    for (int in_part = 0; in_part < 2; in_part++) {
        pm__scene *const scene = lit_create(), *part = scene;
        pm_error error;
        lit_sphere(scene, lit_wall(scene, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 4.0, true);
        if (in_part) {
            PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
            lit_sphere(part, lit_material(part, &ball), 0.0, 0.0, 0.0, 1.0, false);
            PM_CHECK_OK(pm__scene_place(scene, part, &place, &error), error);
        } else {
            lit_sphere(scene, lit_material(scene, &ball), 0.3, 0.2, 0.1, 1.0, false);
        }
        lit_lamp(scene, &lamp);
        const pm__shoot_config config = {.scene = lit_commit(scene), .count = 1000, .emitted = true, .seed = 3};
        pm__photon_set set = lit_shoot(&config);
        ck_assert_uint_eq(set.count, 1000);
        for (int band = 0; band < 3; band++)
            PM_CHECK_NEAR(lit_power(&set, band) / (lamp.power[band] * exp(-absorption[band])), 1.0, 1e-6);
        pm__photon_set_free(&set);
        pm__scene_destroy(scene);
    }
}
END_TEST

PM_TEST_MAIN("emission", test_four_lights, test_many_lights, test_ends_of_shares, test_absorbs, test_absorbed_in_part)
