/* Rays aimed at the edges of meshes, where Embree in float may propose both triangles, or the one behind the other. */
#include "../../src/base/random.h"
#include "../../src/scene/revolve.h"
#include "../lit.h"

#include <string.h>

enum { RAYS = 200000 };

/* A ball of glass: 12 rings of 16. */
static pm__scene *glass_ball(pm__mesh *mesh)
{
    enum { RINGS = 12, TURNS = 16 };
    pm_error error = {""};
    double profile[RINGS + 1][2];
    for (int i = 0; i <= RINGS; i++) {
        const double angle = 3.141592653589793 * i / RINGS;
        profile[i][0] = i == 0 || i == RINGS ? 0.0 : 0.3 * sin(angle);
        profile[i][1] = 0.4 - 0.3 * cos(angle);
    }
    PM_CHECK_OK(pm__revolve((const double(*)[2])profile, RINGS + 1, TURNS, mesh, &error), error);
    pm__scene *const scene = lit_create();
    PM_CHECK_OK(pm__scene_mesh(scene, lit_glass(scene), (const float(*)[3])mesh->vertices, mesh->vertex_count,
                               (const uint32_t(*)[3])mesh->triangles, mesh->triangle_count, &error), error);
    const pm__light lamp = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0, 0, 2}};
    lit_lamp(scene, &lamp);
    return lit_commit(scene);
}

/* From a point outside to one on an edge, and straight on: where a line goes in, or comes out, it does so once. (Where
 * the edge is the outline as seen from there, float may have it miss the one triangle and meet the other.) */
START_TEST(lines_cross_edges_once)
{
    pm__mesh mesh;
    pm__scene *const scene = glass_ball(&mesh);
    int met = 0;
    for (uint64_t i = 0; i < RAYS; i++) {
        double u[6], at[3], direction[3];
        pm__random_uniform(3, PM__FOR_TESTS, 0, i, u, 6);
        const uint32_t *const triangle = mesh.triangles[(size_t)(u[0] * (double)mesh.triangle_count)];
        const int side = (int)(3.0 * u[1]);
        const float *const a = mesh.vertices[triangle[side]], *const b = mesh.vertices[triangle[(side + 1) % 3]];
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = 4.0 * u[3 + axis] - 2.0 + (axis == 2 ? 2.7 : 0.0);
            direction[axis] = (1.0 - u[2]) * (double)a[axis] + u[2] * (double)b[axis] - at[axis];
        }
        (void)pm__normalize(direction);
        uint32_t from = PM__NO_SHAPE;
        bool inside = false;
        pm__hit hit;
        while (pm__scene_intersect(scene, at, direction, INFINITY, from, &hit)) {
            const bool enters = pm__dot(direction, hit.normal) < 0.0;
            const bool twice = from != PM__NO_SHAPE && hit.distance <= 1e-6 && enters == inside;
            ck_assert_msg(!twice, "line %d %s twice at an edge", (int)i, enters ? "enters" : "leaves");
            inside = enters;
            memcpy(at, hit.position, sizeof at);
            from = hit.shape;
            met++;
        }
    }
    ck_assert_int_gt(met, RAYS);
    pm__mesh_free(&mesh);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("mesh edges", lines_cross_edges_once)
