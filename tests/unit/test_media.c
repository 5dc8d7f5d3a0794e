/* Nested media. A ball of glass (radius 1) stands in the middle of a ball of water (radius 2) in air; both let light
 * straight on (index 1), so what Beer's law leaves is known by hand: the water's chord less the glass's of the one, the
 * glass's chord of the other. With real indices, light through the middle is not bent either. */
#include "../../src/transport/trace.h"
#include "../test.h"

#include <string.h>

enum { PHOTONS = 3000 };

static const double water[3] = {0.5, 0.0, 1.0}, solid[3] = {0.25, 2.0, 0.0}, middle[3] = {0.0, 0.0, 0.0};

static uint32_t add_material(pm__scene *scene, const pm__material *material)
{
    pm_error error;
    uint32_t index;
    PM_CHECK_OK(pm__scene_material(scene, material, &index, &error), error);
    return index;
}

/* The light stands at the height `lamp`; everything ends on a white rectangle at the height -3 or, if `inside`, -1.5:
 * within the water, where no boundary comes after the glass. */
static pm__scene *nested(double outer_ior, double inner_ior, const pm__light *light, bool inside)
{
    pm__scene *scene;
    pm_error error;
    pm__material outer = {.kind = PM__GLASS, .ior = {outer_ior, outer_ior, outer_ior}};
    pm__material inner = {.kind = PM__GLASS, .ior = {inner_ior, inner_ior, inner_ior}};
    const pm__material wall = {.kind = PM__DIFFUSE};
    memcpy(outer.absorption, water, sizeof water);
    memcpy(inner.absorption, solid, sizeof solid);
    memcpy(inner.outside, water, sizeof water);
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__scene_sphere(scene, add_material(scene, &outer), middle, 2.0, false, &error), error);
    PM_CHECK_OK(pm__scene_sphere(scene, add_material(scene, &inner), middle, 1.0, false, &error), error);
    const double size = inside ? 0.5 : 9.0, corner[3] = {-size, -size, inside ? -1.5 : -3.0};
    const double u[3] = {2.0 * size, 0.0, 0.0}, v[3] = {0.0, 2.0 * size, 0.0};
    PM_CHECK_OK(pm__scene_rectangle(scene, add_material(scene, &wall), corner, u, v, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, light, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

typedef struct tally {
    double (*way)(double miss, bool in_glass); /* m in the glass, or in the water, of light `miss` m off the middle */
    int count;
} tally;

static bool check_power(void *context, uint64_t number, const pm__stored *photon)
{
    tally *const t = context;
    const double miss = hypot(photon->position[0], photon->position[1]);
    for (int b = 0; b < 3; b++) {
        const double want = exp(-water[b] * t->way(miss, false) - solid[b] * t->way(miss, true));
        ck_assert_msg(fabs(photon->power[b] / want - 1.0) < 1e-12, "photon %d, %g off, band %d: %.17g, by hand %.17g",
                      (int)number, miss, b, photon->power[b], want);
    }
    t->count++;
    return true;
}

static int check_scene(pm__scene *scene, const char *expression, double (*way)(double miss, bool in_glass))
{
    pm_error error;
    pm__paths *paths;
    PM_CHECK_OK(pm__paths_create(expression, &paths, &error), error);
    tally t = {way, 0};
    const pm__trace_config config = {.scene = scene, .paths = paths, .seed = 5};
    ck_assert_uint_eq(pm__trace(&config, 0, PHOTONS, check_power, &t), PHOTONS);
    pm__paths_destroy(paths);
    pm__scene_destroy(scene);
    return t.count;
}

static double half_chord(double radius, double miss)
{
    return sqrt(fmax(0.0, radius * radius - miss * miss));
}

static double through(double miss, bool in_glass)
{
    return 2.0 * (in_glass ? half_chord(1.0, miss) : half_chord(2.0, miss) - half_chord(1.0, miss));
}

static pm__light beam(double radius, double height)
{
    return (pm__light){.kind = PM__DIRECTIONAL,
                       .power = {1.0, 1.0, 1.0},
                       .position = {0.0, 0.0, height},
                       .direction = {0.0, 0.0, -1.0},
                       .radius = radius};
}

START_TEST(test_straight_through)
{
    const pm__light wide = beam(2.5, 3.0);
    ck_assert_int_eq(check_scene(nested(1.0, 1.0, &wide, false), "LS*D", through), PHOTONS);
}
END_TEST

/* On the axis, with what indices do: a photon either goes on with all its power or is turned back. */
START_TEST(test_along_the_axis)
{
    const pm__light thin = beam(1e-9, 3.0);
    const int count = check_scene(nested(1.33, 1.5 / 1.33, &thin, false), "LSSSSD", through);
    const double outer = 1.0 - pow(0.33 / 2.33, 2), inner = 1.0 - pow((1.5 - 1.33) / (1.5 + 1.33), 2);
    const double chance = pow(outer * inner, 2); /* 6 standard deviations: a false alarm once in 5e8 */
    PM_CHECK_NEAR((double)count / PHOTONS, chance, 6.0 * sqrt(chance * (1.0 - chance) / PHOTONS));
}
END_TEST

/* The light in the glass: no boundary has been left yet. Then in the water. */
static double from_middle(double miss, bool in_glass)
{
    (void)miss;
    (void)in_glass;
    return 1.0;
}

static double from_water(double miss, bool in_glass)
{
    (void)miss;
    return in_glass ? 2.0 : 1.5;
}

START_TEST(test_light_within)
{
    const pm__light in_glass = beam(1e-9, 0.0), in_water = beam(1e-9, 1.5);
    ck_assert_int_eq(check_scene(nested(1.0, 1.0, &in_glass, false), "LSSD", from_middle), PHOTONS);
    ck_assert_int_eq(check_scene(nested(1.0, 1.0, &in_water, false), "LSSSD", from_water), PHOTONS);
}
END_TEST

/* A wall in the water: the boundary left last says that it is water. */
static double to_wall(double miss, bool in_glass)
{
    return in_glass ? 2.0 * half_chord(1.0, miss) : half_chord(2.0, miss) - 2.0 * half_chord(1.0, miss) + 1.5;
}

START_TEST(test_wall_within)
{
    const pm__light narrow = beam(0.4, 3.0);
    ck_assert_int_eq(check_scene(nested(1.0, 1.0, &narrow, true), "LSSSD", to_wall), PHOTONS);
}
END_TEST

PM_TEST_MAIN("media", test_straight_through, test_along_the_axis, test_light_within, test_wall_within)
