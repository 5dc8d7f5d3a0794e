/* Rays through scenes: the nearest of many shapes against a loop over all, triangles against rectangles, what blocks
 * and what does not, refusals, threads. */
#include "../shapes.h"

#include <dirent.h>
#include <pthread.h>
#include <string.h>

/* So few that Embree is not asked, and so many that it is. */
enum { RAYS = 40000, FEW = 5, MANY = 40 };

static const uint32_t counts[] = {FEW, 2 * FEW, MANY};

/* ---- Many shapes ---------------------------------------------------------------------------------- */

static void random_shapes(pm__shape *shapes, uint32_t count)
{
    for (int i = 0; i < (int)count; i++) {
        double c[3], n[3], t[3];
        random_ray(10, (uint64_t)i, 1.5, c, n);
        pm__basis(n, (double[3]){0.0}, t);
        switch (i % 5) {
        case 0:
            shapes[i] = sphere(c[0], c[1], c[2], 0.3);
            break;
        case 1:
            shapes[i] = cylinder(c[0], c[1], 0.25, c[2], c[2] + 0.5, n[0]);
            break;
        case 2:
            shapes[i] = (pm__shape){.kind = PM__SHAPE_RECTANGLE};
            memcpy(shapes[i].edge[0], n, sizeof n);
            memcpy(shapes[i].edge[1], t, sizeof t);
            break;
        case 3:
            shapes[i] = (pm__shape){.kind = PM__SHAPE_DISC, .radius = 0.4};
            memcpy(shapes[i].normal, n, sizeof n);
            break;
        default:
            shapes[i] = wave(0.02 + 0.004 * (i % 20), 9.0);
        }
        memcpy(shapes[i].centre, c, sizeof c);
        if (shapes[i].kind == PM__SHAPE_CYLINDER)
            shapes[i].centre[2] = 0.0;
        if (shapes[i].kind == PM__SHAPE_WAVE)
            shapes[i].centre[0] = shapes[i].centre[1] = 0.0;
    }
}

/* The nearest by asking each; blocked likewise. */
static uint32_t nearest_of(const pm__shape *shapes, uint32_t count, pm__ray ray, uint32_t from, uint32_t to,
                           double *distance)
{
    uint32_t best = PM__NO_SHAPE;
    const double reach = ray.reach;
    *distance = reach;
    for (uint32_t i = 0; i < count; i++) {
        double t;
        ray.leaves = i == from;
        ray.arrives = i == to;
        if (pm__shape_meet(&shapes[i], &ray, &t) && t < *distance) {
            *distance = t;
            best = i;
        }
    }
    return best;
}

static pm__ray ray_of(const double o[3], const double d[3], double reach)
{
    return (pm__ray){.origin = {o[0], o[1], o[2]}, .direction = {d[0], d[1], d[2]}, .reach = reach};
}

static void check_nearest(uint32_t count)
{
    pm__shape shapes[MANY];
    random_shapes(shapes, count);
    pm__scene *const scene = scene_of(shapes, count);
    int met_count = 0;
    double o[3], d[3], unused[3], distance;
    uint32_t from = PM__NO_SHAPE;
    for (int i = 0; i < 3 * RAYS; i++) {
        pm__hit hit;
        if (from == PM__NO_SHAPE) /* else on from where the ray before ended */
            random_ray(11, (uint64_t)i, i % 3 ? 2.0 : 2000.0, o, d);
        else
            random_ray(12, (uint64_t)i, 2.0, unused, d);
        if (from == PM__NO_SHAPE && i % 3 == 0) { /* from far off towards the middle */
            for (int a = 0; a < 3; a++)
                d[a] = d[a] - o[a];
            (void)pm__normalize(d);
        }
        const double reach = i % 2 ? (double)INFINITY : (double)(i % 5);
        const uint32_t best = nearest_of(shapes, count, ray_of(o, d, reach), from, PM__NO_SHAPE, &distance);
        const bool met = pm__scene_intersect(scene, o, d, reach, from, &hit);
        ck_assert_msg(met == (best != PM__NO_SHAPE), "ray %d: met %d, the loop finds %u", i, met, best);
        if (met) {
            ck_assert_uint_eq(hit.shape, best);
            /* With the nearer hit as reach the wave searches a shorter bracket: rounding differs. */
            PM_CHECK_NEAR(hit.distance, distance, 1e-12 * fmax(1.0, distance));
            memcpy(o, hit.position, sizeof o);
            met_count++;
        }
        from = met ? hit.shape : PM__NO_SHAPE;
    }
    ck_assert_int_gt(met_count, RAYS / 2);
    pm__scene_destroy(scene);
}

START_TEST(test_nearest)
{
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        check_nearest(counts[i]);
}
END_TEST

/* Ways between points on shapes: against the loop; the same both ways round; and open up to the first hit. */
static void check_blocked(uint32_t many)
{
    pm__shape shapes[MANY];
    random_shapes(shapes, many);
    pm__scene *const scene = scene_of(shapes, many);
    double b[3] = {0.0, 0.0, 5.0};
    uint32_t to = PM__NO_SHAPE;
    int blocked_count = 0, count = 0;
    for (int i = 0; i < RAYS; i++) {
        double o[3], d[3], distance;
        pm__hit hit;
        random_ray(13, (uint64_t)i, 2.0, o, d);
        if (!pm__scene_intersect(scene, o, d, INFINITY, PM__NO_SHAPE, &hit))
            continue;
        ck_assert_msg(!pm__scene_blocked(scene, o, PM__NO_SHAPE, hit.position, hit.shape), "ray %d to its hit", i);
        ck_assert_msg(!pm__scene_blocked(scene, hit.position, hit.shape, o, PM__NO_SHAPE), "ray %d from its hit", i);
        double beyond[3], way[3];
        for (int a = 0; a < 3; a++) {
            beyond[a] = hit.position[a] + 1e-6 * d[a];
            way[a] = b[a] - hit.position[a];
        }
        if (fabs(pm__dot(hit.normal, d)) > 1e-3)
            ck_assert_msg(pm__scene_blocked(scene, o, PM__NO_SHAPE, beyond, PM__NO_SHAPE), "ray %d beyond", i);
        const double length = pm__normalize(way);
        const pm__ray ray = ray_of(hit.position, way, length);
        const bool want = nearest_of(shapes, many, ray, hit.shape, to, &distance) != PM__NO_SHAPE;
        ck_assert_msg(pm__scene_blocked(scene, hit.position, hit.shape, b, to) == want, "way %d: not %d", i, want);
        ck_assert_msg(pm__scene_blocked(scene, b, to, hit.position, hit.shape) == want, "back %d: not %d", i, want);
        blocked_count += want;
        count++;
        memcpy(b, hit.position, sizeof b);
        to = hit.shape;
    }
    ck_assert(count > RAYS / 10 && blocked_count > count / 10 && blocked_count < count - count / 100);
    pm__scene_destroy(scene);
}

START_TEST(test_blocked)
{
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        check_blocked(counts[i]);
}
END_TEST

/* On a sphere alone: what faces away is blocked by the sphere itself, a chord is not. */
START_TEST(test_blocked_by_itself)
{
    pm__shape shape = sphere(0.5, 0.25, -0.125, 1.5);
    pm__scene *const scene = scene_of(&shape, 1);
    for (int i = 0; i < RAYS; i++) {
        double o[3], n[3], m[3], p[3], q[3], unused[3], way[3];
        random_ray(14, (uint64_t)i, 4.0, o, n);
        random_ray(15, (uint64_t)i, 4.0, unused, m);
        for (int a = 0; a < 3; a++) {
            p[a] = shape.centre[a] + 1.5 * n[a];
            q[a] = shape.centre[a] + 1.5 * m[a];
            way[a] = o[a] - p[a];
            unused[a] = o[a] - shape.centre[a];
        }
        ck_assert(!pm__scene_blocked(scene, p, 0, q, 0));
        const bool inside = pm__dot(unused, unused) < 2.25, faces = pm__dot(way, n) > 0.0;
        ck_assert_msg(pm__scene_blocked(scene, o, PM__NO_SHAPE, p, 0) == (!inside && !faces), "way %d", i);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Triangles ------------------------------------------------------------------------------------ */

/* A box of twelve triangles and one of six rectangles, offset so that floats are exact, give the same paths. */
START_TEST(test_box_of_triangles)
{
    static const float corners[8][3] = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0},
                                        {-1, -1, 2}, {1, -1, 2}, {-1, 1, 2}, {1, 1, 2}};
    static const uint32_t faces[6][4] = {{0, 1, 2, 3}, {4, 6, 5, 7}, {0, 4, 1, 5}, {2, 3, 6, 7}, {0, 2, 4, 6},
                                         {1, 5, 3, 7}};
    uint32_t triangles[12][3];
    pm__shape flats[6];
    memset(flats, 0, sizeof flats);
    for (int f = 0; f < 6; f++) {
        const uint32_t *const c = faces[f];
        memcpy(triangles[2 * f], (uint32_t[3]){c[0], c[1], c[2]}, sizeof *triangles);
        memcpy(triangles[2 * f + 1], (uint32_t[3]){c[3], c[2], c[1]}, sizeof *triangles);
        flats[f].kind = PM__SHAPE_RECTANGLE;
        for (int a = 0; a < 3; a++) {
            flats[f].centre[a] = (double)corners[c[0]][a];
            for (int e = 0; e < 2; e++)
                flats[f].edge[e][a] = (double)(corners[c[1 + e]][a] - corners[c[0]][a]);
        }
    }
    pm__scene *const exact = scene_of(flats, 6), *const mesh = new_scene();
    pm_error error;
    PM_CHECK_OK(pm__scene_disc(mesh, 0, (double[3]){0, 0, -9}, (double[3]){0, 0, 1}, 1.0, &error), error);
    PM_CHECK_OK(pm__scene_mesh(mesh, 0, corners, 8, (const uint32_t(*)[3])triangles, 12, &error), error);
    PM_CHECK_OK(pm__scene_commit(mesh, &error), error);
    double o[3] = {0.1, 0.2, 0.3}, d[3], unused[3], inward[3] = {0.0};
    uint32_t from[2] = {PM__NO_SHAPE, PM__NO_SHAPE};
    for (int i = 0; i < 3 * RAYS; i++) {
        pm__hit want, got;
        random_ray(16, (uint64_t)i, 1.0, unused, d);
        for (int a = 0, turn = pm__dot(inward, d) < 0.0; a < 3 && turn; a++)
            d[a] = -d[a]; /* into the box */
        ck_assert_msg(pm__scene_intersect(exact, o, d, INFINITY, from[0], &want), "ray %d escapes", i);
        ck_assert_msg(pm__scene_intersect(mesh, o, d, INFINITY, from[1], &got), "ray %d escapes the mesh", i);
        PM_CHECK_NEAR(got.distance, want.distance, 4e-15 * fmax(1.0, 1.0 / fabs(pm__dot(want.normal, d))));
        ck_assert_uint_eq((got.shape - 1) / 2, want.shape);
        PM_CHECK_NEAR(pm__dot(got.normal, want.normal), 1.0, 1e-15);
        ck_assert(!pm__scene_blocked(mesh, o, from[1], got.position, got.shape));
        ck_assert(pm__scene_blocked(mesh, o, from[1], (double[3]){o[0] + 8 * d[0], o[1] + 8 * d[1], o[2] + 8 * d[2]},
                                    PM__NO_SHAPE));
        for (int a = 0; a < 3; a++) /* a position kept in float is off the triangle: still not met */
            unused[a] = o[a] - (from[1] == PM__NO_SHAPE ? 0.0 : 1e-8 * inward[a]);
        ck_assert(pm__scene_intersect(mesh, unused, d, INFINITY, from[1], &got));
        ck_assert_uint_ne(got.shape, from[1]);
        PM_CHECK_NEAR(got.distance, want.distance, 1e-7 / fabs(pm__dot(want.normal, d)));
        memcpy(o, want.position, sizeof o);
        memcpy(inward, got.normal, sizeof o);
        from[0] = want.shape;
        from[1] = got.shape;
    }
    pm__scene_destroy(exact);
    pm__scene_destroy(mesh);
}
END_TEST

enum { SHEETS = 21 }; /* so many that Embree holds them */

/* Sheets 1e-9 m apart (of triangles: the spacing of floats), within the rounding of float: the nearest is met, whatever
 * the order in which they were made. */
START_TEST(test_nearer_than_float)
{
    for (int order = 1; order < SHEETS; order++) {
        pm__scene *const scene = new_scene();
        pm_error error;
        double nearest = INFINITY;
        for (int i = 0; i < SHEETS; i++) {
            const int level = (i * 5 + order) % SHEETS;
            const double z = 1.0 + 1e-9 * level, corner[3] = {-3, -3, z}, u[3] = {6, 0, 0}, v[3] = {0, 6, 0};
            const float height = 1.0f + 0x1p-23f * (float)(level + (order % 3 ? 0 : 3));
            const float corners[3][3] = {{-4, -4, height}, {4, -4, height}, {0, 6, height}};
            static const uint32_t triangle[1][3] = {{0, 1, 2}};
            if (order % 3 != 1)
                PM_CHECK_OK(pm__scene_mesh(scene, 0, corners, 3, triangle, 1, &error), error);
            if (order % 3 != 2)
                PM_CHECK_OK(pm__scene_rectangle(scene, 0, corner, u, v, &error), error);
            nearest = fmin(nearest, order % 3 == 2 ? (double)height : z);
        }
        PM_CHECK_OK(pm__scene_commit(scene, &error), error);
        for (int i = 0; i < RAYS / 20; i++) {
            double o[3], d[3];
            pm__hit hit;
            random_ray(17, (uint64_t)i, 0.5, o, d);
            d[2] = 2.0 + fabs(d[2]);
            (void)pm__normalize(d);
            ck_assert(pm__scene_intersect(scene, o, d, INFINITY, PM__NO_SHAPE, &hit));
            PM_CHECK_NEAR(hit.distance, (nearest - o[2]) / d[2], 2e-15);
            PM_CHECK_NEAR(hit.position[2], nearest, 3e-16);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* The same for oblique triangles, z = 1 + slope x + y/4: they cross at x = 0, each has corners of its own, exact in
 * float. */
START_TEST(test_oblique_sheets)
{
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    pm__scene *const scene = new_scene();
    pm_error error;
    double slope[SHEETS];
    for (int i = 0; i < SHEETS; i++) {
        const float tilt = 0.5f + 0x1p-16f * (float)(i * 5 % SHEETS), more = 0x1p-6f * (float)i;
        const float x[3] = {-0.5f - more, 0.5f + more, more}, y[3] = {-0.5f, -0.5f - more, 0.75f};
        float corners[3][3];
        for (int c = 0; c < 3; c++)
            memcpy(corners[c], (float[3]){x[c], y[c], 1.0f + tilt * x[c] + 0.25f * y[c]}, sizeof *corners);
        PM_CHECK_OK(pm__scene_mesh(scene, 0, (const float(*)[3])corners, 3, triangle, 1, &error), error);
        slope[i] = (double)tilt;
    }
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    for (int i = 0; i < RAYS; i++) {
        double o[3], d[3], nearest = INFINITY;
        pm__hit hit;
        random_ray(19, (uint64_t)i, 0.005, o, d);
        d[2] = 1000.0;
        (void)pm__normalize(d);
        for (int s = 0; s < SHEETS; s++)
            nearest = fmin(nearest, (1.0 + slope[s] * o[0] + 0.25 * o[1] - o[2]) /
                                        (d[2] - slope[s] * d[0] - 0.25 * d[1]));
        ck_assert(pm__scene_intersect(scene, o, d, INFINITY, PM__NO_SHAPE, &hit));
        PM_CHECK_NEAR(hit.distance, nearest, 2e-15);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Refusals, threads ------------------------------------------------------------------------------- */

static void check_refused(pm_status status, const pm_error *error, const char *part)
{
    ck_assert_int_eq(status, PM_EINVAL);
    ck_assert_msg(strstr(error->text, part) != NULL, "\"%s\" does not say \"%s\"", error->text, part);
}

START_TEST(test_refusals)
{
    static const struct {
        pm__shape shape;
        const char *part;
    } cases[] = {
        {{.kind = PM__SHAPE_SPHERE, .radius = 0.0}, "shape 1 (sphere): its radius is not above 0 and finite (0)"},
        {{.kind = PM__SHAPE_SPHERE, .radius = NAN}, "radius"},
        {{.kind = PM__SHAPE_SPHERE, .radius = INFINITY}, "radius"},
        {{.kind = PM__SHAPE_SPHERE, .radius = 1.0, .centre = {0.0, NAN, 0.0}}, "(0, nan, 0) is not finite"},
        {{.kind = PM__SHAPE_SPHERE, .radius = 1.0, .centre = {0.0, 0.0, 1e13}}, "beyond"},
        {{.kind = PM__SHAPE_CYLINDER, .radius = 1.0, .low = 2.0, .high = 2.0, .from = -1.0}, "from 2 to 2"},
        {{.kind = PM__SHAPE_CYLINDER, .radius = 1.0, .low = 0.0, .high = NAN, .from = -1.0}, "height"},
        {{.kind = PM__SHAPE_CYLINDER, .radius = 1.0, .high = 2.0, .from = 1.0}, "`from`"},
        {{.kind = PM__SHAPE_RECTANGLE, .edge = {{1.0, 2.0, 3.0}, {-2.0, -4.0, -6.0}}}, "span no area"},
        {{.kind = PM__SHAPE_RECTANGLE, .edge = {{1.0, 2.0, 3.0}, {0.0}}}, "span no area"},
        {{.kind = PM__SHAPE_RECTANGLE, .edge = {{1.0, 2.0, 3.0}, {NAN, 0.0, 0.0}}}, "not finite"},
        {{.kind = PM__SHAPE_DISC, .radius = 1.0, .normal = {0.0, 0.0, 2.0}}, "(0, 0, 2) is not of length 1"},
        {{.kind = PM__SHAPE_DISC, .radius = -1.0, .normal = {0.0, 0.0, 1.0}}, "(-1)"},
        {{.kind = PM__SHAPE_WAVE, .amplitude = 0.5, .wavenumber = 2.0, .extent = {1.0, 1.0}}, "below 1 (1)"},
        {{.kind = PM__SHAPE_WAVE, .amplitude = 0.1, .wavenumber = -2.0, .extent = {1.0, 1.0}}, "wavenumber"},
        {{.kind = PM__SHAPE_WAVE, .amplitude = 0.1, .wavenumber = 2.0, .extent = {1.0, 0.0}}, "extent"},
        {{.kind = PM__SHAPE_WAVE, .amplitude = 0.1, .wavenumber = 2.0, .extent = {500001.0, 1.0}},
         "wavenumber times extent is above a million (1e+06)"},
        {{.kind = PM__SHAPE_WAVE, .amplitude = 1e-9, .wavenumber = 1e8, .extent = {1.0, 1.0}}, "(1e+08)"},
    };
    static const float v[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}}, bad[3][3] = {{0, 0, NAN}};
    static const float far[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, INFINITY, 0}};
    static const float point[3][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    static const uint32_t good[1][3] = {{0, 1, 2}}, flat[2][3] = {{0, 1, 2}, {0, 1, 3}}, wild[1][3] = {{0, 1, 4}};
    pm__scene *const scene = new_scene();
    pm_error error;
    check_refused(pm__scene_commit(scene, &error), &error, "no shape");
    PM_CHECK_OK(pm__scene_sphere(scene, 0, (double[3]){0}, 1.0, false, &error), error);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_refused(add(scene, &cases[i].shape, &error), &error, cases[i].part);
    check_refused(pm__scene_sphere(scene, 1, (double[3]){0}, 1.0, false, &error), &error, "there is no material 1");
    check_refused(pm__scene_mesh(scene, 0, v, 4, flat, 2, &error), &error, "triangle 1 (0, 1, 3) spans no area");
    check_refused(pm__scene_mesh(scene, 0, v, 4, wild, 1, &error), &error, "triangle 0 (0, 1, 4) names a vertex");
    check_refused(pm__scene_mesh(scene, 0, bad, 3, good, 1, &error), &error, "vertex 0 (0, 0, nan)");
    check_refused(pm__scene_mesh(scene, 0, far, 3, good, 1, &error), &error, "vertex 2 (0, inf, 0)");
    check_refused(pm__scene_mesh(scene, 0, point, 3, good, 1, &error), &error, "triangle 0 (0, 1, 2) spans no area");
    check_refused(pm__scene_mesh(scene, 0, v, 4, good, 0, &error), &error, "4 vertices and 0 triangles");
    check_refused(pm__scene_mesh(scene, 0, v, 0, good, 1, &error), &error, "0 vertices and 1 triangles");
    check_refused(pm__scene_mesh(scene, 7, v, 4, good, 1, &error), &error, "shape 1: there is no material 7");
    pm__material material = {.kind = PM__DIFFUSE, .diffuse = {0.5, NAN, 0.5}};
    uint32_t index;
    check_refused(pm__scene_material(scene, &material, &index, &error), &error, "material 1: ");
    material.diffuse[1] = 1.5;
    check_refused(pm__scene_material(scene, &material, &index, &error), &error, "diffuse[1] is 1.5");
    const pm__light dark = {.kind = PM__POINT}, wild_light = {.kind = PM__POINT, .power = {1.0, NAN, 1.0}};
    check_refused(pm__scene_light(scene, &dark, &error), &error, "adds up to 0");
    check_refused(pm__scene_light(scene, &wild_light, &error), &error, "power[1] is nan");
    ck_assert_uint_eq(pm__scene_light_count(scene), 1); /* what was refused has left no trace */
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    check_refused(pm__scene_sphere(scene, 0, (double[3]){0}, 1.0, false, &error), &error, "committed");
    pm__hit hit;
    ck_assert(!pm__scene_intersect(scene, (double[3]){NAN, 0, 0}, (double[3]){0, 0, 1}, 1.0, PM__NO_SHAPE, &hit));
    pm__scene_destroy(scene);
    pm__scene_destroy(NULL);
}
END_TEST

/* A scene without light is refused at the end, and can still be given one. */
START_TEST(test_no_light)
{
    pm__scene *scene;
    pm_error error;
    uint32_t material;
    pm__hit hit;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__scene_material(scene, &black, &material, &error), error);
    PM_CHECK_OK(pm__scene_sphere(scene, 0, (double[3]){0}, 1.0, false, &error), error);
    check_refused(pm__scene_commit(scene, &error), &error, "the scene has no light");
    PM_CHECK_OK(pm__scene_light(scene, &lamp, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    ck_assert(pm__scene_intersect(scene, (double[3]){0}, (double[3]){0, 0, 1}, 2.0, PM__NO_SHAPE, &hit));
    pm__scene_destroy(scene);
}
END_TEST

typedef struct job {
    const pm__scene *scene;
    double sum;
} job;

static void *many_rays(void *argument)
{
    job *const j = argument;
    for (int i = 0; i < RAYS; i++) {
        double o[3], d[3];
        pm__hit hit;
        random_ray(18, (uint64_t)i, 2.0, o, d);
        if (pm__scene_intersect(j->scene, o, d, INFINITY, PM__NO_SHAPE, &hit))
            j->sum += hit.distance + hit.normal[0] + hit.shape;
    }
    return NULL;
}

START_TEST(test_threads)
{
    pm__shape shapes[MANY];
    random_shapes(shapes, MANY);
    pm__scene *const scene = scene_of(shapes, MANY);
    DIR *const tasks = opendir("/proc/self/task"); /* none is started: ".", ".." and this one */
    int task_count = 0;
    for (; tasks && readdir(tasks); task_count++) {}
    ck_assert_int_eq(tasks ? task_count : 3, 3);
    if (tasks)
        closedir(tasks);
    job jobs[3] = {{.scene = scene}, {.scene = scene}, {.scene = scene}};
    pthread_t threads[2];
    many_rays(&jobs[2]);
    for (int i = 0; i < 2; i++)
        ck_assert_int_eq(pthread_create(&threads[i], NULL, many_rays, &jobs[i]), 0);
    for (int i = 0; i < 2; i++)
        ck_assert_int_eq(pthread_join(threads[i], NULL), 0);
    ck_assert_double_eq(jobs[0].sum, jobs[2].sum);
    ck_assert_double_eq(jobs[1].sum, jobs[2].sum);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("scene", test_nearest, test_blocked, test_blocked_by_itself, test_box_of_triangles,
             test_nearer_than_float, test_oblique_sheets, test_refusals, test_no_light,
             test_threads)
