/* Embree's own scenes, which the bench of tracing compares with. */
#include "../../bench/plain_scene.h"
#include "../shapes.h"

/* Embree's own scene is the same scene: its first hits are where ours are, to float and to the chords of its arcs. */
START_TEST(test_plain_scene)
{
    static const float corners[3][3] = {{-2, -2, -1.5f}, {2, -2, -1.5f}, {0, 2, -1.5f}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    pm__scene *const scene = new_scene(), *part;
    pm__plain_scene plain;
    pm_error error;
    uint32_t material;
    pm__shape ball = sphere(0.3, -0.4, 0.5, 0.3), tube = cylinder(-0.5, 0.4, 0.3, -0.5, 0.6, 0.2);
    pm__shape pond = wave(0.05, 3.0);
    const pm__placement placement = {.rotation = {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, .scale = 0.5, .offset = {0, 0, 2}};
    PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
    PM_CHECK_OK(pm__scene_material(part, &black, &material, &error), error);
    PM_CHECK_OK(add(part, &ball, &error), error);
    const double origin[3] = {0, 0, 0}, u[3] = {1, 0, 0}, v[3] = {0, 2, 0};
    PM_CHECK_OK(pm__scene_rectangle(part, 0, origin, u, v, &error), error);
    PM_CHECK_OK(pm__scene_place(scene, part, &placement, &error), error);
    PM_CHECK_OK(add(scene, &ball, &error), error);
    PM_CHECK_OK(add(scene, &tube, &error), error);
    PM_CHECK_OK(add(scene, &pond, &error), error);
    PM_CHECK_OK(pm__scene_mesh(scene, 0, corners, 3, triangle, 1, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    for (int robust = 0; robust < 2; robust++) {
        int met_count = 0, agreeing = 0;
        PM_CHECK_OK(pm__plain_scene_create(scene, robust, &plain, &error), error);
        for (int i = 0; i < 20000; i++) {
            double o[3], d[3];
            pm__hit hit;
            random_ray(60, (uint64_t)i, 2.5, o, d);
            struct RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            struct RTCRayHit answer = {.ray = {.org_x = (float)o[0], .org_y = (float)o[1], .org_z = (float)o[2],
                                               .dir_x = (float)d[0], .dir_y = (float)d[1], .dir_z = (float)d[2],
                                               .tfar = INFINITY, .mask = 0xffffffff},
                                       .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
            rtcIntersect1(plain.scene, &context, &answer);
            if (!pm__scene_intersect(scene, o, d, INFINITY, PM__NO_SHAPE, &hit))
                continue;
            met_count++;
            agreeing += fabs((double)answer.ray.tfar - hit.distance) < 2e-3 * (1.0 + hit.distance);
        }
        ck_assert_msg(met_count > 2000 && agreeing > met_count * 98 / 100, "%d of %d", agreeing, met_count);
        pm__plain_scene_destroy(&plain);
    }
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("plain-scene", test_plain_scene)
