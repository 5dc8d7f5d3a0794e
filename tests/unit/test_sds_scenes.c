/* The torus in glass and the lamp in its bulb: they stand as they should, and shadow rays see none of their light. */
#include "../picture.h"

#include "../../src/base/random.h"

enum { RAYS = 20000 };

static const double pi = 3.14159265358979323846;

static pm__scene *scene_of(const char *text, pm__spec *spec)
{
    pm__scene *const scene = lit_create();
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, text, spec, &error), error);
    const pm__case *const c = (const pm__case *)(const void *)spec->entry;
    PM_CHECK_OK(c->build(spec->values, scene, &error), error);
    return lit_commit(scene);
}

/* Uniform over all directions. */
static void any_direction(const double u[2], double direction[3])
{
    const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z);
    direction[0] = r * cos(2.0 * pi * u[1]);
    direction[1] = r * sin(2.0 * pi * u[1]);
    direction[2] = z;
}

static bool is_kind(const pm__scene *scene, size_t object, pm__material_kind kind)
{
    return pm__scene_object(scene, object).material->kind == kind;
}

/* The cube is of six faces clear of the floor; all else but the floor, the torus, is well within. */
START_TEST(the_torus_is_in_the_cube)
{
    pm__spec spec;
    pm__scene *const scene = scene_of("scene:torus", &spec);
    size_t faces = 0, within = 0;
    for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
        const pm__object object = pm__scene_object(scene, i);
        faces += is_kind(scene, i, PM__GLASS);
        if (is_kind(scene, i, PM__GLASS))
            ck_assert(object.low[2] > 1e-5 && object.high[2] > object.low[2] - 1e-9);
        bool inside = true;
        for (int a = 0; a < 3; a++)
            inside = inside && object.low[a] > (a < 2 ? -0.45 : 0.05) && object.high[a] < (a < 2 ? 0.45 : 0.95);
        within += inside;
    }
    ck_assert_uint_eq(faces, 6);
    ck_assert_uint_eq(within, 1);
    ck_assert_uint_eq(pm__scene_object_count(scene), 8);
    pm__scene_destroy(scene);
}
END_TEST

/* From within the cube every line meets the torus an even number of times, from without first, then glass from within.
 * By Crofton a closed body that is met is met by lines in proportion to its surface; the torus is not small. */
START_TEST(torus_and_cube_are_closed)
{
    pm__spec spec;
    pm__scene *const scene = scene_of("scene:torus", &spec);
    size_t met = 0;
    for (uint64_t i = 0; i < RAYS; i++) {
        double u[5], way[3];
        pm__random_uniform(1, PM__FOR_TESTS, 1, i, u, 5);
        double at[3] = {0.98 * u[0] - 0.49, 0.98 * u[1] - 0.49, 0.999};
        any_direction(u + 2, way);
        way[2] = -fabs(way[2]);
        pm__hit hit = {.shape = PM__NO_SHAPE};
        bool outside = true;
        for (;;) {
            ck_assert(pm__scene_intersect(scene, at, way, INFINITY, hit.shape, &hit));
            const bool enters = pm__dot(hit.normal, way) < 0.0;
            if (hit.material->kind == PM__GLASS) {
                ck_assert(outside && !enters);
                break;
            }
            ck_assert_msg(enters == outside, "ray %d: the torus is open at (%g, %g, %g)", (int)i, hit.position[0],
                          hit.position[1], hit.position[2]);
            met += enters;
            outside = !outside;
            memcpy(at, hit.position, sizeof at);
        }
    }
    ck_assert_uint_gt(met, RAYS / 10);
    pm__scene_destroy(scene);
}
END_TEST

static void check_lit(const pm__light *sun, double x, double y, double z)
{
    enum { GRID = 20 };
    const double at[3] = {x, y, z};
    double sum = 0.0;
    for (int i = 0; i < GRID * GRID; i++) {
        const double u[2] = {(i % GRID + 0.5) / GRID, (i / GRID + 0.999) / GRID};
        pm__light_sample s;
        ck_assert_msg(pm__light_reach(sun, at, u, &s), "(%g, %g, %g) does not see all of the sun", x, y, z);
        sum += s.irradiance[0] / (GRID * GRID);
    }
    /* Irradiance over the mean cosine to the axis, which is that of the cone's half: cos^2(a / 2). */
    PM_CHECK_NEAR(sum * pow(cos(0.5 * sun->angle), 2), 6.0, 1e-9);
}

/* However large the sun is, all of the floor and the cube have it, at the same irradiance. */
START_TEST(all_is_in_the_sun)
{
    static const char *const suns[] = {"scene:torus:sun=0.1", "scene:torus", "scene:torus:sun=20"};
    static const double halves[] = {0.05, 2.5, 10.0}; /* degrees */
    for (int i = 0; i < 3; i++) {
        pm__spec spec;
        pm__scene *const scene = scene_of(suns[i], &spec);
        const pm__light *const sun = pm__scene_light_at(scene, 0);
        PM_CHECK_NEAR(sun->angle, halves[i] * pi / 180.0, 1e-15);
        for (size_t j = 0; j < pm__scene_object_count(scene); j++) {
            const pm__object object = pm__scene_object(scene, j);
            for (int corner = 0; corner < 8; corner++)
                check_lit(sun, corner & 1 ? object.low[0] : object.high[0],
                          corner & 2 ? object.low[1] : object.high[1], corner & 4 ? object.low[2] : object.high[2]);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* From the middle: out of the hollow, through as much glass as asked for. */
START_TEST(the_bulb_is_a_shell)
{
    pm__spec spec;
    pm__scene *const scene = scene_of("scene:lamp:glass=0.05", &spec);
    const pm__light *const ball = pm__scene_light_at(scene, 0);
    for (uint64_t i = 0; i < 1000; i++) {
        double u[2], way[3];
        pm__hit inner, outer;
        pm__random_uniform(1, PM__FOR_TESTS, 2, i, u, 2);
        any_direction(u, way);
        ck_assert(pm__scene_intersect(scene, ball->position, way, INFINITY, PM__NO_SHAPE, &inner));
        ck_assert(inner.material->kind == PM__GLASS && pm__dot(inner.normal, way) < 0.0);
        ck_assert_double_gt(inner.distance, ball->radius);
        ck_assert(pm__scene_intersect(scene, inner.position, way, INFINITY, inner.shape, &outer));
        ck_assert(outer.material->kind == PM__GLASS && pm__dot(outer.normal, way) > 0.0);
        PM_CHECK_NEAR(outer.distance, 0.05, 1e-12);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* Who looks from the camera, and on by the mirror, never meets the bulb, but the mirror often enough. */
START_TEST(the_bulb_is_out_of_the_picture)
{
    enum { SIDE = 128 };
    pm__spec spec;
    pm__scene *const scene = scene_of("scene:lamp", &spec);
    pm__view view;
    pm__camera camera;
    pm_error error;
    size_t mirrored = 0;
    ((const pm__case *)(const void *)spec.entry)->view(spec.values, &view);
    PM_CHECK_OK(pm__camera_init(&view, SIDE, SIDE, &camera, &error), error);
    for (int i = 0; i <= SIDE * SIDE; i++) {
        double way[3];
        pm__hit hit;
        pm__camera_direction(&camera, i % SIDE + 0.5, i / SIDE + 0.5, way);
        ck_assert(pm__scene_intersect(scene, camera.eye, way, INFINITY, PM__NO_SHAPE, &hit));
        if (hit.material->kind == PM__MIRROR) {
            const double twice = 2.0 * pm__dot(way, hit.normal);
            for (int a = 0; a < 3; a++)
                way[a] -= twice * hit.normal[a];
            mirrored++;
            ck_assert(pm__scene_intersect(scene, hit.position, way, INFINITY, hit.shape, &hit));
        }
        ck_assert_msg(pm__is_rough(hit.material), "pixel %d: glass is seen", i);
    }
    ck_assert(mirrored > SIDE * SIDE / 20 && mirrored < SIDE * SIDE / 2);
    pm__scene_destroy(scene);
}
END_TEST

/* Shadow rays from the room's surfaces to the ball, from the torus to the sun: all end at glass. */
START_TEST(no_shadow_ray_gets_through)
{
    static const char *const names[] = {"scene:lamp", "scene:torus"};
    static const double starts[][3] = {{0.6, -0.6, 0.3}, {0.3, -0.4, 0.2}};
    for (int k = 0; k < 2; k++) {
        pm__spec spec;
        pm__scene *const scene = scene_of(names[k], &spec);
        const pm__light *const light = pm__scene_light_at(scene, 0);
        size_t asked = 0;
        for (uint64_t i = 0; i < RAYS; i++) {
            double u[4], way[3];
            pm__hit hit;
            pm__light_sample s;
            pm__random_uniform(1, PM__FOR_TESTS, 3, i, u, 4);
            any_direction(u, way);
            if (!pm__scene_intersect(scene, starts[k], way, INFINITY, PM__NO_SHAPE, &hit) ||
                !pm__is_rough(hit.material) || !pm__light_reach(light, hit.position, u + 2, &s))
                continue;
            asked++;
            ck_assert_msg(pm__scene_blocked(scene, hit.position, hit.shape, s.position, PM__NO_SHAPE),
                          "%s: (%g, %g, %g) is lit", names[k], hit.position[0], hit.position[1], hit.position[2]);
        }
        ck_assert_uint_gt(asked, RAYS / 20);
        pm__scene_destroy(scene);
    }
}
END_TEST

PM_TEST_MAIN("SDS scenes", the_torus_is_in_the_cube, torus_and_cube_are_closed, all_is_in_the_sun, the_bulb_is_a_shell,
             the_bulb_is_out_of_the_picture, no_shadow_ray_gets_through)
