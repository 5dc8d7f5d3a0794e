/* Surfaces of revolution: volumes in closed form, closed meshes edge by edge, rings shared between meshes, refusals. */
#include "../test.h"

#include "../../src/base/random.h"
#include "../../src/base/vec3.h"
#include "../../src/scene/revolve.h"
#include "../../src/scene/scene.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

#define COUNT(array) (sizeof(array) / sizeof *(array))

static pm__mesh turned(const double (*profile)[2], size_t count, size_t turns)
{
    pm__mesh mesh;
    pm_error error;
    PM_CHECK_OK(pm__revolve(profile, count, turns, &mesh, &error), error);
    return mesh;
}

static void corner(const pm__mesh *mesh, size_t triangle, int i, double at[3])
{
    for (int a = 0; a < 3; a++)
        at[a] = (double)mesh->vertices[mesh->triangles[triangle][i]][a];
}

/* By the divergence theorem; positive where normals point out. */
static double volume(const pm__mesh *mesh)
{
    double sum = 0.0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double p[3], q[3], r[3], n[3];
        corner(mesh, i, 0, p);
        corner(mesh, i, 1, q);
        corner(mesh, i, 2, r);
        pm__cross(q, r, n);
        sum += pm__dot(p, n) / 6.0;
    }
    return sum;
}

/* Frusta of regular polygons: the circle's pi is (n / 2) sin(2 pi / n). */
static double frusta(const double (*profile)[2], size_t count, size_t turns)
{
    const double disc = 0.5 * (double)turns * sin(2.0 * pi / (double)turns);
    double sum = 0.0;
    for (size_t i = 0; i + 1 < count; i++) {
        const double a = profile[i][0], b = profile[i + 1][0];
        sum += disc / 3.0 * (a * a + a * b + b * b) * (profile[i + 1][1] - profile[i][1]);
    }
    return sum;
}

static double least_area(const pm__mesh *mesh)
{
    double least = INFINITY;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double p[3], q[3], r[3], n[3];
        corner(mesh, i, 0, p);
        corner(mesh, i, 1, q);
        corner(mesh, i, 2, r);
        for (int a = 0; a < 3; a++) {
            q[a] -= p[a];
            r[a] -= p[a];
        }
        pm__cross(q, r, n);
        least = fmin(least, 0.5 * sqrt(pm__dot(n, n)));
    }
    return least;
}

/* Of a closed mesh each edge is run through once each way. */
static void check_closed(const pm__mesh *mesh)
{
    const size_t n = mesh->vertex_count;
    signed char *const runs = calloc(n * n, 1);
    ck_assert_ptr_nonnull(runs);
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++) {
            const size_t a = mesh->triangles[i][k], b = mesh->triangles[i][(k + 1) % 3];
            ck_assert_uint_lt(a, n);
            ck_assert_uint_ne(a, b);
            ck_assert_msg(++runs[a * n + b] == 1, "edge %zu to %zu twice", a, b);
        }
    for (size_t a = 0; a < n; a++)
        for (size_t b = 0; b < n; b++)
            ck_assert_int_eq(runs[a * n + b], runs[b * n + a]);
    free(runs);
}

/* ---- Shapes ---- */

static const double cone[][2] = {{0, 0}, {1, 0}, {0, 2}};
static const double barrel[][2] = {{0, -1}, {0.5, -1}, {0.75, 0}, {0.5, 1}, {0, 1}};
static const double hourglass[][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 2}, {0, 2}};
static const double bowl[][2] = {{0, 0}, {1, 0}, {1, 1}, {0.9, 1}, {0.9, 0.25}, {0, 0.25}};

static const struct {
    const double (*profile)[2];
    size_t count;
    double around; /* the volume with true circles, over pi */
} solids[] = {
    {cone, COUNT(cone), 2.0 / 3.0},
    {barrel, COUNT(barrel), 2.0 / 3.0 * (0.25 + 0.375 + 0.5625)},
    {hourglass, COUNT(hourglass), 1.0 / 3.0 + 4.0 / 3.0},
    {bowl, COUNT(bowl), 1.0 - 0.81 * 0.75},
};

START_TEST(volumes_are_those_of_frusta)
{
    static const size_t turns[] = {3, 4, 7, 64};
    for (size_t i = 0; i < COUNT(solids); i++) {
        PM_CHECK_NEAR(frusta(solids[i].profile, solids[i].count, PM__MOST_TURNS), pi * solids[i].around, 1e-7);
        for (size_t j = 0; j < COUNT(turns); j++) {
            pm__mesh mesh = turned(solids[i].profile, solids[i].count, turns[j]);
            PM_CHECK_NEAR(volume(&mesh), frusta(solids[i].profile, solids[i].count, turns[j]), 2e-6);
            ck_assert(least_area(&mesh) > 1e-4);
            check_closed(&mesh);
            pm__mesh_free(&mesh);
            ck_assert_ptr_null(mesh.vertices);
        }
    }
}
END_TEST

START_TEST(sizes)
{
    pm__mesh mesh = turned(barrel, COUNT(barrel), 10); /* poles, 3 rings; caps, 2 belts */
    ck_assert_uint_eq(mesh.vertex_count, 32);
    ck_assert_uint_eq(mesh.triangle_count, 60);
    pm__mesh_free(&mesh);
    mesh = turned(hourglass, COUNT(hourglass), 5); /* 3 poles, 2 rings */
    ck_assert_uint_eq(mesh.vertex_count, 13);
    ck_assert_uint_eq(mesh.triangle_count, 20);
    pm__mesh_free(&mesh);
    mesh = turned(bowl + 1, 2, 3); /* open */
    ck_assert_uint_eq(mesh.vertex_count, 6);
    ck_assert_uint_eq(mesh.triangle_count, 6);
    pm__mesh_free(&mesh);
}
END_TEST

/* Backward, normals point inward; a ring profile that comes back to its start is a torus (Pappus: area times way). */
START_TEST(directions)
{
    const double back[][2] = {{0, 2}, {1, 0}, {0, 0}}, ring[][2] = {{2, 0}, {3, 0}, {3, 1}, {2, 1}, {2, 0}};
    pm__mesh mesh = turned(back, COUNT(back), 50);
    PM_CHECK_NEAR(volume(&mesh), -frusta(cone, COUNT(cone), 50), 2e-6);
    pm__mesh_free(&mesh);
    mesh = turned(ring, COUNT(ring), 1000);
    PM_CHECK_NEAR(volume(&mesh), 2.0 * pi * 2.5, 2e-4);
    pm__mesh_free(&mesh);
}
END_TEST

/* A sphere in chords of the angle h both ways: around, sin(h) / h of the volume is left, h^2 / 6 missing; along the
 * profile chords lie h^2 / 12 below the arc on average, times the area 4 pi that is h^2 / 4 of the volume. */
START_TEST(spheres_converge)
{
    enum { STEPS = 100, TURNS = 200 };
    double profile[STEPS + 1][2];
    for (int i = 0; i <= STEPS; i++) {
        profile[i][0] = i % STEPS ? sin(pi * i / STEPS) : 0.0;
        profile[i][1] = -cos(pi * i / STEPS);
    }
    pm__mesh mesh = turned((const double(*)[2])profile, STEPS + 1, TURNS);
    const double h = 2.0 * pi / TURNS, missing = 1.0 - volume(&mesh) / (4.0 / 3.0 * pi);
    PM_CHECK_NEAR(missing, h * h * (1.0 / 6.0 + 1.0 / 4.0), 1e-6);
    pm__mesh_free(&mesh);
}
END_TEST

/* ---- Meshes together ---- */

static bool has_vertex(const pm__mesh *mesh, const float vertex[3])
{
    for (size_t i = 0; i < mesh->vertex_count; i++)
        if (memcmp(mesh->vertices[i], vertex, sizeof mesh->vertices[i]) == 0)
            return true;
    return false;
}

/* Parts of one profile share the ring at which it was cut, bit by bit. */
START_TEST(rings_are_shared)
{
    const double low[][2] = {{0, 0}, {0.3, 0.01}, {0.7123, 0.1}}, high[][2] = {{0.7123, 0.1}, {0.1, 0.7}, {0, 0.8}};
    pm__mesh a = turned(low, COUNT(low), 37), b = turned(high, COUNT(high), 37);
    size_t shared = 0;
    for (size_t i = 0; i < a.vertex_count; i++)
        shared += has_vertex(&b, a.vertices[i]);
    ck_assert_uint_eq(shared, 37);
    pm__mesh_free(&a);
    pm__mesh_free(&b);
}
END_TEST

static pm__scene *scene_of(const pm__mesh *meshes, size_t count)
{
    static const pm__material black = {.kind = PM__BLACK};
    static const pm__light lamp = {.kind = PM__POINT, .power = {1, 1, 1}};
    pm__scene *scene;
    pm_error error;
    uint32_t material;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__scene_material(scene, &black, &material, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, &lamp, &error), error);
    for (size_t i = 0; i < count; i++)
        PM_CHECK_OK(pm__scene_mesh(scene, material, (const float(*)[3])meshes[i].vertices, meshes[i].vertex_count,
                                   (const uint32_t(*)[3])meshes[i].triangles, meshes[i].triangle_count, &error),
                    error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

static void direction_of(uint64_t number, double direction[3])
{
    double u[2];
    pm__random_uniform(5, PM__FOR_TESTS, 1, number, u, 2);
    const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z);
    direction[0] = r * cos(2.0 * pi * u[1]);
    direction[1] = r * sin(2.0 * pi * u[1]);
    direction[2] = z;
}

/* From within two cups rim to rim no ray gets out, and all meet the inside. Every second one is sent at the seam. */
START_TEST(no_ray_escapes)
{
    const double low[][2] = {{0, -1}, {0.9, -0.6}, {1, 0}}, high[][2] = {{1, 0}, {0.6, 0.7}, {0, 1}};
    pm__mesh cups[2] = {turned(low, COUNT(low), 48), turned(high, COUNT(high), 48)};
    pm__scene *const scene = scene_of(cups, 2);
    for (uint64_t i = 0; i < 200000; i++) {
        const double origin[3] = {0.1, 0.2, -0.05};
        double direction[3];
        pm__hit hit;
        direction_of(i, direction);
        if (i % 2) { /* at the seam, the polygon of 48 corners */
            const double turn = atan2(direction[1], direction[0]), side = pi / 24.0;
            const double off = fmod(turn + 2.0 * pi, side) - 0.5 * side;
            const double r = cos(0.5 * side) / cos(off);
            const double at[3] = {r * cos(turn), r * sin(turn), 0.0};
            for (int a = 0; a < 3; a++)
                direction[a] = at[a] - origin[a];
            (void)pm__normalize(direction);
        }
        ck_assert_msg(pm__scene_intersect(scene, origin, direction, INFINITY, PM__NO_SHAPE, &hit), "ray %d", (int)i);
        ck_assert(pm__dot(direction, hit.normal) > 0.0);
    }
    pm__scene_destroy(scene);
    pm__mesh_free(&cups[0]);
    pm__mesh_free(&cups[1]);
}
END_TEST

/* ---- Refusals ---- */

static void check_refused(const double (*profile)[2], size_t count, size_t turns, const char *why)
{
    pm__mesh mesh = {.vertex_count = 7};
    pm_error error = {""};
    ck_assert_int_eq(pm__revolve(profile, count, turns, &mesh, &error), PM_EINVAL);
    ck_assert_msg(strstr(error.text, why) != NULL, "'%s' does not say '%s'", error.text, why);
    ck_assert_uint_eq(mesh.vertex_count, 0);
    ck_assert_ptr_null(mesh.vertices);
    pm__mesh_free(&mesh);
}

START_TEST(refusals)
{
    const double bad[][3][2] = {{{1, 0}, {-1, 1}, {0, 2}}, {{1, 0}, {NAN, 1}, {0, 2}}, {{1, 0}, {1, NAN}, {0, 2}},
                                {{1, 0}, {INFINITY, 1}, {0, 2}}, {{1, 0}, {1, -2e12}, {0, 2}}};
    const double same[][2] = {{1, 0}, {1, 1}, {1, 1}}, axis[][2] = {{1, 0}, {0, 1}, {0, 2}};
    for (size_t i = 0; i < COUNT(bad); i++)
        check_refused(bad[i], 3, 8, "point 1 ");
    check_refused(same, 3, 8, "point 2 (1, 1) is as the one before it");
    check_refused(axis, 3, 8, "points 1 and 2 both lie on the axis");
    check_refused(cone, 0, 8, "0 points");
    check_refused(cone, 1, 8, "1 points");
    check_refused(cone, (size_t)PM__MOST_PROFILE + 1, 8, "65537 points"); /* the points are not looked at */
    check_refused(cone, 3, 2, "2 turns");
    check_refused(cone, 3, (size_t)PM__MOST_TURNS + 1, "65537 turns");
    check_refused(cone, PM__MOST_PROFILE, PM__MOST_TURNS, "too many");
}
END_TEST

PM_TEST_MAIN("revolve", volumes_are_those_of_frusta, sizes, directions, spheres_converge, rings_are_shared,
             no_ray_escapes, refusals)
