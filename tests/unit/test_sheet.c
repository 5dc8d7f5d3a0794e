/* Meshes known as sheets, and what is no sheet.
 *
 * Over a triangle with corners at (u_i, v_i), height h_i, the height is a linear function; its gradient g by Cramer's
 * rule. A way along the surface rises at most |g| per m seen from above: the sine |g| / sqrt(1 + g^2). */
#include "../terrain.h"

enum { TERRAINS = 40, RAYS = 400 };

/* ---- The oracle ----------------------------------------------------------------------------------- */

typedef struct slope {
    double sine, along[3]; /* the steepest way up, unit */
} slope;

static slope slope_of(const terrain *t, size_t triangle)
{
    const uint32_t *const c = t->triangles[triangle];
    const int axis = t->axis, u = (axis + 1) % 3, v = (axis + 2) % 3;
    double e[2][3];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = (double)t->vertices[c[i + 1]][k] - (double)t->vertices[c[0]][k];
    const double area = e[0][u] * e[1][v] - e[0][v] * e[1][u];
    const double gu = (e[0][axis] * e[1][v] - e[1][axis] * e[0][v]) / area;
    const double gv = (e[1][axis] * e[0][u] - e[0][axis] * e[1][u]) / area;
    const double square = gu * gu + gv * gv, length = sqrt(square * (1.0 + square));
    slope s = {.sine = sqrt(square / (1.0 + square))};
    s.along[axis] = s.sine;
    s.along[u] = gu / length;
    s.along[v] = gv / length;
    return s;
}

static size_t steepest_of(const terrain *t)
{
    size_t best = 0;
    for (size_t i = 1; i < t->triangle_count; i++)
        best = slope_of(t, i).sine > slope_of(t, best).sine ? i : best;
    return best;
}

static pm__scene *scene_with(const terrain *t)
{
    static const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {0.5, 0.5, 0.5}};
    static const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 1.0, 1.0}};
    pm__scene *scene;
    pm_error error;
    uint32_t material;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__scene_material(scene, &wall, &material, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, &lamp, &error), error);
    terrain_add(t, material, scene);
    return scene;
}

/* Along the axis; 2: no sheet. */
static double steepness(const terrain *t, int axis)
{
    pm__scene *const scene = scene_with(t);
    const double steep = pm__sheet_steepness(scene->geometries[0], axis);
    pm__scene_destroy(scene);
    return steep;
}

/* Along none. */
static void check_refused(const terrain *t, const char *what)
{
    for (int axis = 0; axis < 3; axis++) {
        const double steep = steepness(t, axis);
        ck_assert_msg(steep == 2.0, "%s, along %c: a sheet, of steepness %g", what, 'x' + axis, steep);
    }
}

/* ---- Sheets --------------------------------------------------------------------------------------- */

START_TEST(test_steepness)
{
    for (int way = 0; way < 6; way++)
        for (uint64_t i = 0; i < TERRAINS; i++) {
            const double rough = 0.3 * pow(0.1, (double)(i % 7));
            const terrain t = terrain_of(way % 3, way / 3, 5.0 - (double)i, rough, i);
            const double want = slope_of(&t, steepest_of(&t)).sine;
            /* At a slope near 0 the sine comes of the cosine's digits beyond 1: 1e-16 there is 1e-16 / sine. */
            PM_CHECK_NEAR(steepness(&t, t.axis), want + 1e-6, 1e-12 + 1e-15 / want);
            for (int other = 1; other < 3; other++)
                ck_assert(steepness(&t, (t.axis + other) % 3) == 2.0);
            const terrain split = terrain_split(&t);
            check_refused(&split, "a seam of two vertices in one place");
        }
}
END_TEST

/* Level, it may lie anywhere and have but two triangles, or a border finer than what lies within. */
START_TEST(test_few_triangles)
{
    for (int way = 0; way < 6; way++) {
        terrain t = {.axis = way % 3, .faces_back = way / 3};
        for (int i = 0; i < 4; i++)
            terrain_vertex(&t, i % 2, i / 2, 3.0);
        terrain_triangle(&t, 0, 1, 3);
        terrain_triangle(&t, 0, 3, 2);
        PM_CHECK_NEAR(steepness(&t, t.axis), 0.0, 2e-6);
        terrain_vertex(&t, 0.5, 0.0, 3.25); /* in the middle of a side: 1/4 up in 1/2 */
        t.triangle_count = 1;
        memcpy(t.triangles[0], (uint32_t[3]){0, t.faces_back ? 3 : 4, t.faces_back ? 4 : 3}, sizeof *t.triangles);
        terrain_triangle(&t, 4, 1, 3);
        terrain_triangle(&t, 0, 3, 2);
        ck_assert_uint_eq(steepest_of(&t), 0);
        PM_CHECK_NEAR(steepness(&t, t.axis), slope_of(&t, 0).sine, 2e-6);
    }
}
END_TEST

/* ---- What the steepness is for ---------------------------------------------------------------------- */

/* Does a ray that leaves triangle `from` meet another? Both sides of each, 1e-9 m off. */
static bool meets_again(const terrain *t, size_t from, const double o[3], const double d[3])
{
    for (size_t i = 0; i < t->triangle_count; i++) {
        double e[2][3], to[3], p[3], q[3];
        if (i == from)
            continue;
        const uint32_t *const c = t->triangles[i];
        for (int k = 0; k < 3; k++) {
            to[k] = o[k] - (double)t->vertices[c[0]][k];
            for (int n = 0; n < 2; n++)
                e[n][k] = (double)t->vertices[c[n + 1]][k] - (double)t->vertices[c[0]][k];
        }
        pm__cross(d, e[1], p);
        pm__cross(to, e[0], q);
        const double volume = pm__dot(e[0], p), u = pm__dot(to, p) / volume, v = pm__dot(d, q) / volume;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && pm__dot(e[1], q) / volume > 1e-9)
            return true;
    }
    return false;
}

static void point_on(const terrain *t, size_t triangle, double a, double b, double at[3])
{
    const uint32_t *const c = t->triangles[triangle];
    for (int k = 0; k < 3; k++)
        at[k] = (1.0 - a - b) * (double)t->vertices[c[0]][k] + a * (double)t->vertices[c[1]][k] +
                b * (double)t->vertices[c[2]][k];
}

/* A way of this sine along the axis, either way up, in the given direction as seen along it. */
static void aim(const terrain *t, double sine, double u, double v, double d[3])
{
    const double length = sqrt((1.0 - sine * sine) / (u * u + v * v));
    d[t->axis] = sine;
    d[(t->axis + 1) % 3] = u * length;
    d[(t->axis + 2) % 3] = v * length;
}

/* Random ones: just steeper never, down to half as steep sometimes. */
START_TEST(test_rays_that_leave)
{
    int again = 0, count = 0;
    for (uint64_t n = 0; n < TERRAINS; n++) {
        const terrain t = terrain_of((int)(n % 3), n % 2, 0.2, 0.25, n);
        const double steep = steepness(&t, t.axis);
        for (uint64_t i = 0; i < RAYS; i++) {
            double u[6], o[3], d[3];
            pm__random_uniform(7, PM__FOR_TESTS, 61, n * RAYS + i, u, 6);
            const size_t from = (size_t)(u[0] * (double)t.triangle_count);
            const double angle = 6.283185307179586 * u[3], up = i % 2 ? 1.0 : -1.0;
            point_on(&t, from, (1.0 - u[1]) * u[2], u[1] * u[2], o);
            aim(&t, up * (steep + 1e-9 + (1.0 - steep) * u[4] * u[4] * u[4]), cos(angle), sin(angle), d);
            ck_assert_msg(!meets_again(&t, from, o, d), "terrain %d, ray %d meets it again", (int)n, (int)i);
            aim(&t, up * steep * (1.0 - 0.5 * u[5]), cos(angle), sin(angle), d);
            again += meets_again(&t, from, o, d);
            count++;
        }
    }
    ck_assert_msg(again > count / 100, "of %d flatter rays %d meet it again", count, again);
}
END_TEST

/* From near the lower end of the steepest triangle up its slope: by a hundredth flatter than that the way runs under
 * the surface and has to come out again, unless the border is nearer; by a hundredth steeper it runs over it. */
START_TEST(test_up_the_steepest)
{
    int again = 0;
    for (uint64_t n = 0; n < TERRAINS; n++) {
        const terrain t = terrain_of((int)(n % 3), n % 2, 0.2, 0.25, n);
        const size_t from = steepest_of(&t);
        const slope s = slope_of(&t, from);
        const int u = (t.axis + 1) % 3, v = (t.axis + 2) % 3;
        double o[3], d[3];
        point_on(&t, from, 0.3, 0.3, o);
        aim(&t, 0.99 * s.sine, s.along[u], s.along[v], d);
        again += meets_again(&t, from, o, d);
        aim(&t, 1.000002 * s.sine + 1e-6, s.along[u], s.along[v], d);
        ck_assert(fabs(d[t.axis]) > steepness(&t, t.axis) && !meets_again(&t, from, o, d));
    }
    ck_assert_int_gt(again, TERRAINS / 2);
}
END_TEST

/* ---- What is no sheet ------------------------------------------------------------------------------- */

static terrain gentle(int way)
{
    return terrain_of(way % 3, way / 3, 1.0, 0.05, 3);
}

static void remove_triangle(terrain *t, size_t at)
{
    memcpy(t->triangles[at], t->triangles[--t->triangle_count], sizeof *t->triangles);
}

/* Triangles left out: one, a hole in the middle, one at the border, at a corner. */
START_TEST(test_holes)
{
    for (int way = 0; way < 6; way++)
        for (size_t at = 0; at < (size_t)(2 * CELLS * CELLS); at++) {
            terrain t = gentle(way);
            remove_triangle(&t, at);
            check_refused(&t, "a triangle is left out");
        }
}
END_TEST

/* A second sheet over or under the first, or in its place; one that faces the other way (so that areas cancel). */
START_TEST(test_stacked)
{
    static const double levels[] = {1.5, 1.0, -3.0};
    for (int way = 0; way < 6; way++)
        for (int k = 0; k < 6; k++) {
            terrain t = gentle(way);
            const terrain other = terrain_of(way % 3, k < 3 ? way / 3 : !(way / 3), levels[k % 3], 0.05, 3);
            for (size_t i = 0; i < other.triangle_count; i++)
                for (int c = 0; c < 3; c++)
                    t.triangles[t.triangle_count + i][c] = other.triangles[i][c] + (uint32_t)t.vertex_count;
            memcpy(t.vertices + t.vertex_count, other.vertices, other.vertex_count * sizeof *t.vertices);
            t.triangle_count += other.triangle_count;
            t.vertex_count += other.vertex_count;
            check_refused(&t, "two sheets");
        }
}
END_TEST

/* One place covered twice and another of the same size left out: the areas add up to the rectangle's. Seen from its
 * edges alone: with corners of their own, or with those of the sheet. */
START_TEST(test_twice_and_not_at_all)
{
    for (int way = 0; way < 6; way++)
        for (int apart = 0; apart < 2; apart++) {
            terrain t = {.axis = way % 3, .faces_back = way / 3};
            for (int j = 0; j < 4; j++)
                for (int i = 0; i < 4; i++)
                    terrain_vertex(&t, i, j, 0.1 * ((i + 2 * j) % 3));
            for (size_t cell = 0; cell < 9; cell++) {
                size_t at = cell / 3 * 4 + cell % 3;
                if (cell == 4) /* the middle one instead lies on a corner's, or on the one beside */
                    at = way % 2 ? 0 : 4;
                const size_t c[4] = {at, at + 1, at + 4, at + 5};
                size_t corners[4];
                for (int k = 0; k < 4; k++) {
                    corners[k] = c[k];
                    if (cell != 4 || !apart)
                        continue;
                    corners[k] = t.vertex_count;
                    memcpy(t.vertices[t.vertex_count++], t.vertices[c[k]], sizeof *t.vertices);
                }
                terrain_triangle(&t, corners[0], corners[1], corners[2]);
                terrain_triangle(&t, corners[3], corners[2], corners[1]);
            }
            check_refused(&t, "one cell twice, one not at all");
        }
}
END_TEST

/* Round about its middle: 12 corners on a circle; and a rectangle with one corner cut off, or standing on a corner. */
START_TEST(test_borders)
{
    for (int way = 0; way < 6; way++) {
        terrain t = {.axis = way % 3, .faces_back = way / 3};
        terrain_vertex(&t, 0.0, 0.0, 0.1);
        for (int i = 0; i < 12; i++)
            terrain_vertex(&t, cos(i * 0.52359877559829887), sin(i * 0.52359877559829887), 0.0);
        for (size_t i = 1; i <= 12; i++)
            terrain_triangle(&t, 0, i, i % 12 + 1);
        check_refused(&t, "a round border");
        t = (terrain){.axis = way % 3, .faces_back = way / 3};
        const double diamond[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
        for (int i = 0; i < 4; i++)
            terrain_vertex(&t, diamond[i][0], diamond[i][1], 0.0);
        terrain_triangle(&t, 0, 1, 2);
        terrain_triangle(&t, 0, 2, 3);
        check_refused(&t, "a rectangle on its corner");
        t = gentle(way);
        t.vertices[SIDE * SIDE - 1][(t.axis + 1) % 3] -= 0.001f;
        check_refused(&t, "one corner drawn in");
        t = gentle(way);
        t.vertices[3][(t.axis + 2) % 3] -= 0.001f;
        check_refused(&t, "the border drawn out in one place");
        t = gentle(way);
        terrain_vertex(&t, 7.0, 0.0, 0.0);
        check_refused(&t, "a vertex far off, of no triangle");
    }
}
END_TEST

/* An upright triangle on a sheet, an inner place moved over its neighbour (a fold), triangles turned about, and one
 * place so high that triangles are all but upright. */
START_TEST(test_folds)
{
    for (int way = 0; way < 6; way++) {
        const size_t middle = SIDE * SIDE / 2;
        terrain t = gentle(way);
        terrain_vertex(&t, 0.1, 0.1, 1.5);
        terrain_vertex(&t, 0.2, 0.2, 1.5);
        terrain_vertex(&t, 0.1, 0.1, 2.0);
        terrain_triangle(&t, t.vertex_count - 3, t.vertex_count - 2, t.vertex_count - 1);
        check_refused(&t, "an upright triangle");
        t = gentle(way);
        t.vertices[middle][(t.axis + 1) % 3] += 0.5f;
        check_refused(&t, "a fold");
        for (size_t i = 0; i < t.triangle_count; i += 5) {
            t = gentle(way);
            const uint32_t swap = t.triangles[i][0];
            t.triangles[i][0] = t.triangles[i][1];
            t.triangles[i][1] = swap;
            check_refused(&t, "a triangle turned about");
        }
        t = gentle(way);
        t.vertices[middle][t.axis] += 1000.0f;
        check_refused(&t, "all but upright");
    }
}
END_TEST

/* Bodies: a cube, and one whose top is a terrain. */
START_TEST(test_closed)
{
    static const uint32_t faces[6][4] = {{0, 2, 1, 3}, {4, 5, 6, 7}, {0, 1, 4, 5}, {2, 6, 3, 7}, {0, 4, 2, 6},
                                         {1, 3, 5, 7}};
    for (int inward = 0; inward < 2; inward++)
        for (int skew = 0; skew < 2; skew++) {
            terrain t = {.axis = 2, .faces_back = inward};
            for (int i = 0; i < 8; i++)
                terrain_vertex(&t, i % 2, i / 2 % 2, i / 4 + 0.2 * skew * (i % 3));
            for (int f = 0; f < 6; f++) {
                terrain_triangle(&t, faces[f][0], faces[f][1], faces[f][2]);
                terrain_triangle(&t, faces[f][3], faces[f][2], faces[f][1]);
            }
            check_refused(&t, "a cube");
            memmove(t.triangles, t.triangles + 2, 2 * sizeof *t.triangles); /* the top alone is one */
            t.triangle_count = 2;
            memmove(t.vertices, t.vertices + 4, 4 * sizeof *t.vertices);
            for (int i = 0; i < 6; i++)
                t.triangles[i / 3][i % 3] -= 4;
            t.vertex_count = 4;
            ck_assert(steepness(&t, 2) < 1.0);
        }
}
END_TEST

PM_TEST_MAIN("sheet", test_steepness, test_few_triangles, test_rays_that_leave, test_up_the_steepest, test_holes,
             test_stacked, test_twice_and_not_at_all, test_borders, test_folds, test_closed)
