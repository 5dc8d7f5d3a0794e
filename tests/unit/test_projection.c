/* Projection maps: nothing that may meet an object is left out, little else is left in, and where photons are sent they
 * are sent evenly. */
#include "../lit.h"

#include "../../src/base/random.h"
#include "../../src/base/vec3.h"

enum { RAYS = 100000 };

static const pm__light lights[] = {
    {.kind = PM__POINT, .position = {0.1, 0.2, 0.3}, .power = {1, 1, 1}},
    {.kind = PM__SPOT, .position = {0.1, 0.2, 0.3}, .direction = {0.6, 0.0, -0.8}, .angle = 0.7, .power = {1, 1, 1}},
    {.kind = PM__SPOT, .position = {0.1, 0.2, 0.3}, .direction = {0.0, -0.6, 0.8}, .angle = 2.5, .power = {1, 1, 1}},
    {.kind = PM__DIRECTIONAL, .position = {0.0, 0.0, 3.0}, .direction = {0.0, 0.6, -0.8}, .radius = 2.0,
     .power = {1, 1, 1}},
    {.kind = PM__RECTANGLE, .position = {-0.2, -0.3, 0.3}, .edge = {{0.5, 0.1, 0.0}, {0.0, 0.4, 0.2}},
     .power = {1, 1, 1}},
    {.kind = PM__BALL, .position = {0.1, 0.2, 0.3}, .radius = 0.3, .power = {1, 1, 1}},
    {.kind = PM__SUN, .position = {0.0, 0.0, 3.0}, .direction = {0.0, 0.6, -0.8}, .radius = 2.0, .angle = 0.05,
     .power = {1, 1, 1}},
    {.kind = PM__SUN, .position = {0.2, 0.1, 0.5}, .direction = {0.6, 0.0, -0.8}, .radius = 0.3, .angle = 1.5,
     .power = {1, 1, 1}},
};
enum { LIGHTS = sizeof lights / sizeof *lights };

/* Glass balls and a flat mirror about the lights, of sizes from 0.02 to 0.3, and rough ones. */
static pm__scene *scatter(uint32_t trial)
{
    static const pm__material shine = {.kind = PM__MIRROR};
    pm__scene *const scene = lit_create();
    const uint32_t glass = lit_glass(scene), rough = lit_wall(scene, 0.5, 0.5, 0.5);
    const uint32_t mirror = lit_material(scene, &shine);
    for (uint64_t i = 0; i < 6; i++) {
        double u[4], at[3];
        pm__random_uniform(1, PM__FOR_TESTS, trial, i, u, 4);
        for (int a = 0; a < 3; a++)
            at[a] = 4.0 * u[a] - 2.0;
        lit_sphere(scene, i % 3 ? glass : rough, at[0], at[1], at[2], 0.02 * pow(15.0, u[3]), false);
    }
    const double corner[3] = {-0.5, -0.5, -1.5}, e[3] = {0.4, 0.0, 0.0}, f[3] = {0.0, 0.3, 0.1};
    pm_error error;
    PM_CHECK_OK(pm__scene_rectangle(scene, mirror, corner, e, f, &error), error);
    for (int l = 0; l < LIGHTS; l++)
        lit_lamp(scene, &lights[l]);
    return lit_commit(scene);
}

static bool hits_box(const double o[3], const double d[3], const pm__object *box)
{
    double enter = 0.0, leave = INFINITY;
    for (int a = 0; a < 3; a++) {
        const double x = (box->low[a] - o[a]) / d[a], y = (box->high[a] - o[a]) / d[a];
        enter = fmax(enter, fmin(x, y));
        leave = fmin(leave, fmax(x, y));
    }
    return enter <= leave;
}

static bool is_specular(const pm__object *object)
{
    return object->material->kind == PM__MIRROR || object->material->kind == PM__GLASS;
}

/* Does a photon by these numbers meet the box of an object? */
static bool meets(const pm__scene *scene, bool specular, const pm__light *light, const double u[4])
{
    double o[3], d[3];
    pm__emit(light, u, o, d);
    for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
        const pm__object box = pm__scene_object(scene, i);
        if ((!specular || is_specular(&box)) && hits_box(o, d, &box))
            return true;
    }
    return false;
}

static pm__projection *project(const pm__scene *scene, bool specular)
{
    pm__projection *projection;
    pm_error error;
    PM_CHECK_OK(pm__projection_create(scene, specular, &projection, &error), error);
    return projection;
}

START_TEST(test_nothing_is_left_out)
{
    for (uint32_t trial = 0; trial < 8; trial++) {
        pm__scene *const scene = scatter(trial);
        for (int specular = 0; specular < 2; specular++) {
            pm__projection *const projection = project(scene, specular);
            for (size_t l = 0; l < LIGHTS; l++)
                for (uint64_t i = 0; i < RAYS / 10; i++) {
                    double u[4];
                    pm__random_uniform(2, PM__FOR_TESTS, trial, i, u, 4);
                    ck_assert_msg(!meets(scene, specular, &lights[l], u) || pm__projection_covers(projection, l, u),
                                  "light %zu: (%g, %g, %g, %g) is left out", l, u[0], u[1], u[2], u[3]);
                }
            pm__projection_destroy(projection);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Shares are those of the boxes, a cell's width wider at most about each: measured against rays. */
START_TEST(test_little_is_left_in)
{
    /* What lies within a cell of a box, by light: areas have few cells in each of four dimensions, and a
     * sun as wide as the sky gains nothing. */
    static const double extra[LIGHTS] = {0.03, 0.15, 0.03, 0.03, 0.15, 0.5, 0.1, 1.0};
    for (uint32_t trial = 0; trial < 4; trial++) {
        pm__scene *const scene = scatter(trial);
        pm__projection *const projection = project(scene, true);
        for (size_t l = 0; l < LIGHTS; l++) {
            double met = 0.0, covered = 0.0;
            for (uint64_t i = 0; i < RAYS; i++) {
                double u[4];
                pm__random_uniform(3, PM__FOR_TESTS, trial, i, u, 4);
                met += meets(scene, true, &lights[l], u);
                covered += pm__projection_covers(projection, l, u);
            }
            const double share = pm__projection_share(projection, l);
            PM_CHECK_NEAR(covered / RAYS, share, 6.0 * sqrt(0.25 / RAYS));
            ck_assert_msg(share <= met / RAYS + extra[l], "light %zu: share %g, met %g", l, share, met / RAYS);
        }
        pm__projection_destroy(projection);
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Aimed numbers lie in cells that are on, evenly: a box is met share times less often than by numbers aimed. Standard
 * deviations of a share: bounds 6 of them. */
START_TEST(test_aim_is_even)
{
    pm__scene *const scene = scatter(5);
    pm__projection *const projection = project(scene, true);
    for (size_t l = 0; l < LIGHTS; l++) {
        const double share = pm__projection_share(projection, l);
        double met = 0.0, aimed = 0.0, mean[4] = {0.0}, expected[4] = {0.0}, on = 0.0;
        for (uint64_t i = 0; i < RAYS && share > 0.0; i++) {
            double u[4];
            pm__random_uniform(4, PM__FOR_TESTS, (uint32_t)l, i, u, 4);
            met += meets(scene, true, &lights[l], u);
            if (pm__projection_covers(projection, l, u)) {
                on++;
                for (int a = 0; a < 4; a++)
                    expected[a] += u[a];
            }
            pm__projection_aim(projection, l, u);
            ck_assert(pm__projection_covers(projection, l, u));
            aimed += meets(scene, true, &lights[l], u);
            for (int a = 0; a < 4; a++) {
                ck_assert(u[a] >= 0.0 && u[a] < 1.0);
                mean[a] += u[a] / RAYS;
            }
        }
        if (!(share > 0.0))
            continue;
        const double p = met / RAYS, q = aimed / RAYS;
        PM_CHECK_NEAR(q * share, p, 6.0 * sqrt((p + share * share * q) / RAYS));
        for (int a = 0; a < 4; a++)
            PM_CHECK_NEAR(mean[a], expected[a] / on, 6.0 * 0.5 * sqrt(1.0 / on + 1.0 / RAYS));
    }
    pm__projection_destroy(projection);
    pm__scene_destroy(scene);
}
END_TEST

/* What points are spread evenly stay so over the cells that are on: a grid of numbers has one in each of its cells'
 * images, so no quarter of what is sent holds more than its share but for a rim. */
START_TEST(test_aim_keeps_order)
{
    enum { SIDE = 64 };
    pm__scene *const scene = scatter(2);
    pm__projection *const projection = project(scene, true);
    double before = -1.0;
    for (int i = 0; i < SIDE; i++) {
        double u[4] = {(i + 0.5) / SIDE, 0.5, 0.5, 0.5};
        pm__projection_aim(projection, 0, u);
        ck_assert_double_gt(u[0], before);
        before = u[0];
        double last = -1.0;
        for (int j = 0; j < SIDE; j++) {
            double v[4] = {(i + 0.5) / SIDE, (j + 0.5) / SIDE, 0.5, 0.5};
            pm__projection_aim(projection, 0, v);
            ck_assert(v[0] == before && v[1] > last);
            last = v[1];
        }
    }
    pm__projection_destroy(projection);
    pm__scene_destroy(scene);
}
END_TEST

/* A lamp that turns its back on the glass sends nothing: the other has all photons, and its share of the power. */
START_TEST(test_lights_that_do_not_reach)
{
    static const pm__light down = {.kind = PM__SPOT, .position = {0, 0, 2}, .direction = {0, 0, -1}, .angle = 0.5,
                                   .power = {1, 1, 1}};
    static const pm__light up = {.kind = PM__SPOT, .position = {0, 0, 2}, .direction = {0, 0, 1}, .angle = 0.5,
                                 .power = {9, 9, 9}};
    pm__scene *const scene = lit_create();
    pm__paths *paths;
    pm_error error;
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 5.0, 0.0);
    lit_sphere(scene, lit_glass(scene), 0.0, 0.0, 1.0, 0.2, false);
    lit_lamp(scene, &up);
    lit_lamp(scene, &down);
    lit_commit(scene);
    pm__projection *const projection = project(scene, true);
    PM_CHECK_OK(pm__paths_create("LS+D", &paths, &error), error);
    ck_assert(pm__projection_share(projection, 0) == 0.0);
    const double share = pm__projection_share(projection, 1);
    ck_assert(share > 0.1 && share < 0.7);
    for (int sampler = 0; sampler < 2; sampler++) {
        const pm__shoot_config config = {.scene = scene, .paths = paths, .seed = 1, .projection = projection,
                                         .sampler = lit_sampler(sampler ? "sobol" : "poisson"), .count = 1000,
                                         .emitted = true};
        pm__photon_set set = lit_shoot(&config);
        ck_assert_uint_gt(set.count, 300);
        ck_assert_uint_eq(set.emitted, 1000);
        for (size_t i = 0; i < set.count; i++)
            PM_CHECK_NEAR((double)set.photons[i].power[0], share / 1000.0, 1e-9);
        pm__photon_set_free(&set);
    }
    pm__paths_destroy(paths);
    pm__projection_destroy(projection);
    pm__scene_destroy(scene);
}
END_TEST

/* No glass, no caustic: nothing is sent, which is no error of emitted photons, and one of stored ones. */
START_TEST(test_nothing_to_send_to)
{
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 1.0, 0.0);
    lit_lamp(scene, &lights[0]);
    lit_commit(scene);
    pm__projection *const projection = project(scene, true);
    ck_assert(pm__projection_share(projection, 0) == 0.0);
    for (int sampler = 0; sampler < 2; sampler++) {
        pm__shoot_config config = {.scene = scene, .projection = projection, .count = 100, .emitted = true,
                                   .sampler = lit_sampler(sampler ? "stratified" : "poisson")};
        pm__photon_set set = lit_shoot(&config);
        ck_assert_uint_eq(set.count, 0);
        pm__photon_set_free(&set);
        config.emitted = false;
        ck_assert_int_eq(pm__shoot(&config, &set, NULL), PM_EINVAL);
    }
    pm__projection_destroy(projection);
    pm__projection_destroy(NULL);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("projection", test_nothing_is_left_out, test_little_is_left_in, test_aim_is_even, test_aim_keeps_order,
             test_lights_that_do_not_reach, test_nothing_to_send_to)
