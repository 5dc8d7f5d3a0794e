/* Parts of scenes where they are placed: the same hits as of the same shapes added one by one, nothing that rays slip
 * through, ends of rays on placed shapes, objects, refusals. */
#include "../shapes.h"

#include <string.h>

enum { RAYS = 20000, PLACES = 6 };

static const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {0.5, 0.5, 0.5}};

/* A turn by `angle` about a unit axis (Rodrigues), or its mirror image. */
static pm__placement placement(const double axis[3], double angle, bool mirrored, double scale, double x, double y,
                               double z)
{
    pm__placement p = {.scale = scale, .offset = {x, y, z}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int k = 3 - i - j;
            const double twist = i == j ? 0.0 : (j == (i + 1) % 3 ? -axis[k] : axis[k]) * sin(angle);
            const double entry = cos(angle) * (i == j) + (1.0 - cos(angle)) * axis[i] * axis[j] + twist;
            p.rotation[i][j] = mirrored ? -entry : entry;
        }
    return p;
}

static pm__placement random_placement(uint64_t number)
{
    double offset[3], axis[3], u[2];
    random_ray(30, number, 2.0, offset, axis);
    pm__random_uniform(7, PM__FOR_TESTS, 31, number, u, 2);
    return placement(axis, 6.0 * u[0], number % 2, exp(2.0 * u[1] - 1.5), offset[0], offset[1], offset[2]);
}

static void place_vector(const pm__placement *p, double scale, const double v[3], double placed[3])
{
    for (int i = 0; i < 3; i++)
        placed[i] = scale * pm__dot(p->rotation[i], v);
}

static void place_point(const pm__placement *p, const double v[3], double placed[3])
{
    place_vector(p, p->scale, v, placed);
    for (int i = 0; i < 3; i++)
        placed[i] += p->offset[i];
}

/* A sphere, a disc and a rectangle; as they are, and as placed. */
enum { SHAPES = 3 };

static void make_shapes(pm__shape shapes[SHAPES])
{
    memset(shapes, 0, SHAPES * sizeof *shapes);
    shapes[0] = sphere(0.3, -0.2, 0.5, 0.4);
    shapes[1] =
        (pm__shape){.kind = PM__SHAPE_DISC, .centre = {-0.5, 0.2, 0.0}, .normal = {0.6, 0.0, 0.8}, .radius = 0.5};
    shapes[2] = (pm__shape){
        .kind = PM__SHAPE_RECTANGLE, .centre = {-0.6, -0.7, -0.4}, .edge = {{1.3, 0.1, 0.2}, {-0.2, 1.1, 0.3}}};
}

static pm__shape placed_shape(const pm__placement *p, bool mirrored, const pm__shape *shape)
{
    pm__shape placed = *shape;
    place_point(p, shape->centre, placed.centre);
    place_vector(p, 1.0, shape->normal, placed.normal);
    /* A mirrored normal is not the product of the mirrored edges: they change places. */
    for (int e = 0; e < 2; e++)
        place_vector(p, p->scale, shape->edge[mirrored ? 1 - e : e], placed.edge[e]);
    placed.radius *= p->scale;
    return placed;
}

/* The part goes in PLACES times, between two shapes of the scene's own; and one by one. */
static pm__scene *placed_scene(void)
{
    pm__shape shapes[SHAPES], own = sphere(0.0, 0.0, 0.0, 0.3);
    make_shapes(shapes);
    pm__scene *const scene = new_scene(), *part;
    pm_error error;
    uint32_t material;
    PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
    PM_CHECK_OK(pm__scene_material(part, &white, &material, &error), error);
    for (int i = 0; i < SHAPES; i++)
        PM_CHECK_OK(add(part, &shapes[i], &error), error);
    PM_CHECK_OK(add(scene, &own, &error), error);
    for (uint64_t i = 0; i < PLACES; i++) {
        const pm__placement p = random_placement(i);
        PM_CHECK_OK(pm__scene_place(scene, part, &p, &error), error);
    }
    own.radius = 0.2;
    own.centre[2] = 1.5;
    PM_CHECK_OK(add(scene, &own, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

static pm__scene *direct_scene(void)
{
    pm__shape shapes[SHAPES], all[PLACES * SHAPES + 2];
    make_shapes(shapes);
    memset(all, 0, sizeof all);
    all[0] = sphere(0.0, 0.0, 0.0, 0.3);
    for (uint64_t i = 0; i < PLACES; i++) {
        const pm__placement p = random_placement(i);
        for (int j = 0; j < SHAPES; j++)
            all[1 + SHAPES * (int)i + j] = placed_shape(&p, i % 2, &shapes[j]);
    }
    all[PLACES * SHAPES + 1] = sphere(0.0, 0.0, 1.5, 0.2);
    return scene_of(all, PLACES * SHAPES + 2);
}

/* On from hit to hit in both: the same shapes by number, to rounding the same places; the materials of the part. Rays
 * that graze meet by rounding what they meet: those are left out. */
START_TEST(test_same_hits)
{
    pm__scene *const placed = placed_scene(), *const direct = direct_scene();
    int met_count = 0, seen[PLACES * SHAPES + 2] = {0};
    double o[3], d[3], unused[3];
    uint32_t from = PM__NO_SHAPE;
    for (int i = 0; i < 4 * RAYS; i++) {
        pm__hit got, want;
        random_ray(32, (uint64_t)i, 3.0, from == PM__NO_SHAPE ? o : unused, d);
        const bool met = pm__scene_intersect(direct, o, d, INFINITY, from, &want);
        const bool found = pm__scene_intersect(placed, o, d, INFINITY, from, &got);
        const uint32_t left = from;
        ck_assert_msg(met == found, "ray %d: %d, directly %d", i, found, met);
        from = PM__NO_SHAPE;
        if (!met)
            continue;
        ck_assert_msg(got.shape == want.shape, "ray %d: shape %u, directly %u", i, got.shape, want.shape);
        const double slant = fabs(pm__dot(want.normal, d)), tolerance = 4e-14 / slant;
        PM_CHECK_NEAR(got.distance, want.distance, tolerance);
        for (int a = 0; a < 3; a++) {
            PM_CHECK_NEAR(got.position[a], want.position[a], tolerance);
            PM_CHECK_NEAR(got.normal[a], want.normal[a], 2.0 * tolerance);
        }
        const bool own = got.shape == 0 || got.shape == PLACES * SHAPES + 1;
        ck_assert_int_eq(got.material->kind, own ? PM__BLACK : PM__DIFFUSE);
        ck_assert(!pm__scene_blocked(placed, o, left, got.position, got.shape));
        seen[got.shape]++;
        met_count++;
        memcpy(o, got.position, sizeof o);
        from = got.shape;
    }
    ck_assert_int_gt(met_count, RAYS / 2);
    for (int i = 0; i < PLACES * SHAPES + 2; i++)
        ck_assert_msg(seen[i] > 50, "shape %d is met %d times", i, seen[i]);
    pm__scene_destroy(placed);
    pm__scene_destroy(direct);
}
END_TEST

/* Ways between points on placed shapes: blocked as directly. */
START_TEST(test_same_blocked)
{
    pm__scene *const placed = placed_scene(), *const direct = direct_scene();
    double last[3] = {0.0, 0.0, 5.0};
    uint32_t to = PM__NO_SHAPE;
    int count = 0, blocked = 0;
    for (int i = 0; i < RAYS; i++) {
        double o[3], d[3];
        pm__hit hit;
        random_ray(33, (uint64_t)i, 3.0, o, d);
        if (!pm__scene_intersect(direct, o, d, INFINITY, PM__NO_SHAPE, &hit))
            continue;
        const bool want = pm__scene_blocked(direct, hit.position, hit.shape, last, to);
        ck_assert_msg(pm__scene_blocked(placed, hit.position, hit.shape, last, to) == want, "way %d: not %d", i, want);
        ck_assert_msg(pm__scene_blocked(placed, last, to, hit.position, hit.shape) == want, "back %d: not %d", i, want);
        count++;
        blocked += want;
        memcpy(last, hit.position, sizeof last);
        to = hit.shape;
    }
    ck_assert(blocked > count / 10 && blocked < count - count / 20);
    pm__scene_destroy(placed);
    pm__scene_destroy(direct);
}
END_TEST

/* ---- Meshes --------------------------------------------------------------------------------------- */

static const float corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                    {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
static const uint32_t triangles[12][3] = {{0, 1, 2}, {1, 3, 2}, {4, 6, 5}, {5, 6, 7}, {0, 4, 1}, {1, 4, 5},
                                          {2, 3, 6}, {3, 7, 6}, {0, 2, 4}, {2, 6, 4}, {1, 5, 3}, {3, 5, 7}};

static pm__scene *part_of(pm__scene *scene)
{
    pm__scene *part;
    pm_error error;
    uint32_t material;
    PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
    PM_CHECK_OK(pm__scene_material(part, &white, &material, &error), error);
    return part;
}

static pm__scene *box_at(const pm__placement *p)
{
    pm__scene *const scene = new_scene(), *const part = part_of(scene);
    pm_error error;
    PM_CHECK_OK(pm__scene_mesh(part, 0, corners, 8, triangles, 12, &error), error);
    PM_CHECK_OK(pm__scene_place(scene, part, p, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

/* Distance within the cube from -1 to 1. */
static double to_wall(const double o[3], const double d[3])
{
    double nearest = INFINITY;
    for (int a = 0; a < 3; a++)
        nearest = fmin(nearest, d[a] == 0.0 ? INFINITY : (copysign(1.0, d[a]) - o[a]) / d[a]);
    return nearest;
}

/* Within 1e-4 of an edge: from there float may lead a ray past both walls. */
static bool by_edge(const double o[3])
{
    int walls = 0;
    for (int a = 0; a < 3; a++)
        walls += fabs(o[a]) > 1.0 - 1e-4;
    return walls > 1;
}

static void into_part(const pm__placement *p, const double o[3], double in_part[3])
{
    for (int a = 0; a < 3; a++) {
        in_part[a] = 0.0;
        for (int b = 0; b < 3; b++)
            in_part[a] += p->rotation[b][a] * (o[b] - p->offset[b]) / p->scale;
    }
}

/* Quarter turns, powers of two: the same box added directly has corners exact in float, and distances are the same to
 * the last bit. */
START_TEST(test_exact_box)
{
    const pm__placement p = {.rotation = {{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}}, .scale = 0.25, .offset = {0.5, -2, 0.75}};
    float moved[8][3];
    for (int i = 0; i < 8; i++) {
        double placed[3];
        place_point(&p, (double[3]){(double)corners[i][0], (double)corners[i][1], (double)corners[i][2]}, placed);
        for (int a = 0; a < 3; a++)
            moved[i][a] = (float)placed[a];
    }
    pm__scene *const placed = box_at(&p), *const direct = new_scene();
    pm_error error;
    PM_CHECK_OK(pm__scene_mesh(direct, 0, (const float(*)[3])moved, 8, triangles, 12, &error), error);
    PM_CHECK_OK(pm__scene_commit(direct, &error), error);
    double o[3] = {0.5, -2.0, 0.75}, d[3], unused[3], in_part[3];
    uint32_t from = PM__NO_SHAPE;
    pm__hit got = {0}, want;
    for (int i = 0; i < 3 * RAYS; i++) {
        random_ray(34, (uint64_t)i, 1.0, unused, d);
        for (int a = 0, out = from != PM__NO_SHAPE && pm__dot(got.normal, d) < 0.0; a < 3 && out; a++)
            d[a] = -d[a];
        ck_assert_msg(pm__scene_intersect(direct, o, d, INFINITY, from, &want), "ray %d escapes", i);
        ck_assert_msg(pm__scene_intersect(placed, o, d, INFINITY, from, &got), "ray %d escapes the part", i);
        ck_assert_uint_eq(got.shape, want.shape);
        PM_CHECK_NEAR(got.distance, want.distance, 1e-15);
        into_part(&p, got.position, in_part);
        const bool stays = by_edge(in_part);
        memcpy(o, stays ? p.offset : got.position, sizeof o);
        from = stays ? PM__NO_SHAPE : got.shape;
    }
    pm__scene_destroy(placed);
    pm__scene_destroy(direct);
}
END_TEST

/* Any turn, any scale, far off or not: a ray within never gets out, and meets the walls where it should. */
START_TEST(test_watertight)
{
    static const double axis[3] = {0.36, 0.48, -0.8};
    const pm__placement places[] = {placement(axis, 0.7, false, 1.0, 0.0, 0.0, 0.0),
                                    placement(axis, 2.1, false, 0.37, 1.0, -2.0, 0.5),
                                    placement(axis, -1.1, true, 1e-3, 10.0, 20.0, -30.0),
                                    placement(axis, 0.2, false, 1e-6, 1.0, 2.0, 3.0),
                                    placement(axis, 4.0, false, 1e4, -3e3, 2e3, 1.0)};
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        const pm__placement *const p = &places[k];
        pm__scene *const scene = box_at(p);
        double o[3], d[3], unused[3], largest = 0.0;
        memcpy(o, p->offset, sizeof o);
        uint32_t from = PM__NO_SHAPE;
        pm__hit hit = {0};
        for (int a = 0; a < 3; a++)
            largest = fmax(largest, fabs(o[a]) + 2.0 * p->scale);
        for (int i = 0; i < 2 * RAYS; i++) {
            random_ray(35, (uint64_t)i, 1.0, unused, d);
            if (i % 3 == 0 && from != PM__NO_SHAPE) { /* along the wall, nearly */
                const double along = pm__dot(hit.normal, d) - 1e-3;
                for (int a = 0; a < 3; a++)
                    d[a] -= along * hit.normal[a];
                (void)pm__normalize(d);
            }
            for (int a = 0, out = from != PM__NO_SHAPE && pm__dot(hit.normal, d) < 0.0; a < 3 && out; a++)
                d[a] = -d[a];
            double in_part[3], way[3], ahead[3];
            for (int a = 0; a < 3; a++)
                ahead[a] = p->offset[a] + p->scale * d[a];
            into_part(p, o, in_part);
            into_part(p, ahead, way);
            ck_assert_msg(pm__scene_intersect(scene, o, d, INFINITY, from, &hit), "place %zu: ray %d escapes", k, i);
            const double slant = fabs(pm__dot(hit.normal, d)), rounding = 1e-14 * largest / slant;
            ck_assert_uint_ne(hit.shape, from);
            PM_CHECK_NEAR(hit.distance, p->scale * to_wall(in_part, way), rounding);
            ck_assert(!pm__scene_blocked(scene, o, from, hit.position, hit.shape));
            into_part(p, hit.position, in_part);
            const bool stays = by_edge(in_part);
            memcpy(o, stays ? p->offset : hit.position, sizeof o);
            from = stays ? PM__NO_SHAPE : hit.shape;
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Squares of two triangles tile a floor at height 0 and, turned over, a ceiling at 1, both from -SIDE to SIDE; all as
 * `frame` places it. */
enum { SIDE = 5 };

static pm__scene *tiled_scene(const pm__placement *frame)
{
    static const float square[4][3] = {{-1, -1, 2}, {1, -1, 2}, {-1, 1, 2}, {1, 1, 2}};
    static const uint32_t halves[2][3] = {{0, 1, 2}, {1, 3, 2}};
    pm__scene *const scene = new_scene(), *const part = part_of(scene);
    pm_error error;
    PM_CHECK_OK(pm__scene_mesh(part, 0, square, 4, halves, 2, &error), error);
    for (int i = 0; i < 2 * SIDE * SIDE; i++) {
        const bool up = i < SIDE * SIDE;
        const double middle[3] = {2 * (i % SIDE) - SIDE + 1, 2 * (i / SIDE % SIDE) - SIDE + 1, up ? -2 : 3};
        pm__placement p = *frame;
        place_point(frame, middle, p.offset);
        for (int row = 0; row < 3 && !up; row++)
            for (int column = 1; column < 3; column++)
                p.rotation[row][column] = -p.rotation[row][column];
        PM_CHECK_OK(pm__scene_place(scene, part, &p, &error), error);
    }
    pm__placement larger = *frame; /* above it all */
    larger.scale *= 64.0;
    PM_CHECK_OK(pm__scene_place(scene, part, &larger, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    ck_assert_uint_eq(pm__scene_object_count(scene), 2 * SIDE * SIDE + 1);
    return scene;
}

/* What leaves a tile meets no neighbour, what runs towards the ceiling finds no gap, and nothing lies between two
 * points of the floor, also where it is far off and small, so that positions are coarse. */
START_TEST(test_tiles)
{
    static const double axis[3] = {0.36, 0.48, -0.8}, down[3] = {0.0, 0.0, -1.0};
    const pm__placement frames[] = {placement(axis, 0.7, false, 0.3, 1.0, 2.0, 3.0),
                                    placement(axis, 2.1, false, 1e-3, 100.0, 200.0, 300.0)};
    for (int k = 0; k < 2; k++) {
        const pm__placement *const frame = &frames[k];
        const double rounding = k ? 1e-12 : 1e-14;
        pm__scene *const scene = tiled_scene(frame);
        double last[3] = {0.0}, start[3], falling[3];
        uint32_t from = PM__NO_SHAPE;
        place_vector(frame, 1.0, down, falling);
        for (int i = 0; i < RAYS; i++) {
            double at[3], d[3], target[3], way[3];
            pm__hit floor, ceiling;
            random_ray(36, (uint64_t)i, 0.999 * SIDE, at, d);
            at[2] = 0.5;
            place_point(frame, at, start);
            ck_assert_msg(pm__scene_intersect(scene, start, falling, INFINITY, PM__NO_SHAPE, &floor), "ray %d", i);
            PM_CHECK_NEAR(floor.distance, 0.5 * frame->scale, rounding);
            for (int a = 0; a < 3; a++)
                at[a] = a < 2 ? at[a] * (i % 2 ? 0.1 : 0.9) + 0.1 * d[a] : 1.0;
            place_point(frame, at, target);
            for (int a = 0; a < 3; a++)
                way[a] = target[a] - floor.position[a];
            const double length = pm__normalize(way);
            ck_assert_msg(pm__scene_intersect(scene, floor.position, way, INFINITY, floor.shape, &ceiling), "%d", i);
            PM_CHECK_NEAR(ceiling.distance, length, 100.0 * rounding);
            ck_assert(!pm__scene_blocked(scene, floor.position, floor.shape, ceiling.position, ceiling.shape));
            if (from != PM__NO_SHAPE)
                ck_assert_msg(!pm__scene_blocked(scene, floor.position, floor.shape, last, from), "floor: %d", i);
            memcpy(last, floor.position, sizeof last);
            from = floor.shape;
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* ---- Objects, refusals ------------------------------------------------------------------------------- */

START_TEST(test_objects)
{
    pm__scene *const scene = new_scene(), *const part = part_of(scene);
    pm_error error;
    const pm__placement p = {.rotation = {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, .scale = 2.0, .offset = {10, 20, 30}};
    PM_CHECK_OK(pm__scene_mesh(part, 0, corners, 8, triangles, 12, &error), error);
    PM_CHECK_OK(pm__scene_sphere(part, 0, (double[3]){5.0, 0.0, 0.0}, 1.0, false, &error), error);
    PM_CHECK_OK(pm__scene_sphere(scene, 0, (double[3]){1.0, 2.0, 3.0}, 4.0, false, &error), error);
    PM_CHECK_OK(pm__scene_place(scene, part, &p, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    static const double boxes[3][2][3] = {
        {{-3, -2, -1}, {5, 6, 7}}, {{8, 18, 28}, {12, 22, 32}}, {{8, 28, 28}, {12, 32, 32}}};
    ck_assert_uint_eq(pm__scene_object_count(scene), 3);
    for (size_t i = 0; i < 3; i++) {
        const pm__object object = pm__scene_object(scene, i);
        for (int a = 0; a < 3; a++) {
            PM_CHECK_NEAR(object.low[a], boxes[i][0][a], 1e-13);
            PM_CHECK_NEAR(object.high[a], boxes[i][1][a], 1e-13);
        }
        ck_assert_int_eq(object.material->kind, i == 0 ? PM__BLACK : PM__DIFFUSE);
    }
    pm__scene_destroy(scene);
}
END_TEST

static void check_refused(pm_status status, const pm_error *error, const char *text)
{
    ck_assert_int_eq(status, PM_EINVAL);
    ck_assert_msg(strstr(error->text, text) != NULL, "\"%s\" does not say \"%s\"", error->text, text);
}

START_TEST(test_refusals)
{
    static const pm__placement good = {.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1.0};
    static const struct {
        pm__placement placement;
        const char *text;
    } cases[] = {
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1.01}}, .scale = 1.0}, "rows 2 and 2"},
        {{.rotation = {{1, 0, 0}, {0.1, 1, 0}, {0, 0, 1}}, .scale = 1.0}, "rows 0 and 1"},
        {{.rotation = {{1, 0, 0}, {0, NAN, 0}, {0, 0, 1}}, .scale = 1.0}, "not orthonormal"},
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 0.0}, "scale is not above 0 and finite (0)"},
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = -2.0}, "scale"},
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = NAN}, "scale"},
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = INFINITY}, "scale"},
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1e12}, "reaches from"},
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1.0, .offset = {0, NAN, 0}}, "offset[1] is nan"},
        {{.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .scale = 1.0, .offset = {0, 0, 1e13}}, "offset[2]"},
    };
    pm__scene *const scene = new_scene(), *const other = new_scene(), *part, *inner, *unused;
    pm_error error;
    uint32_t material;
    PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
    PM_CHECK_OK(pm__scene_part(scene, &unused, &error), error); /* filled or not, it may be left out */
    check_refused(pm__scene_place(scene, part, &good, &error), &error, "the part has no shape");
    check_refused(pm__scene_sphere(part, 0, (double[3]){0}, 2.0, false, &error), &error, "there is no material 0");
    PM_CHECK_OK(pm__scene_material(part, &white, &material, &error), error);
    PM_CHECK_OK(pm__scene_sphere(part, 0, (double[3]){0}, 2.0, false, &error), error);
    check_refused(pm__scene_light(part, &lamp, &error), &error, "no lights of its own");
    check_refused(pm__scene_part(part, &inner, &error), &error, "a part has no parts");
    ck_assert_ptr_null(inner);
    check_refused(pm__scene_place(other, part, &good, &error), &error, "not of this scene");
    check_refused(pm__scene_place(scene, other, &good, &error), &error, "not of this scene");
    check_refused(pm__scene_place(scene, scene, &good, &error), &error, "not of this scene");
    check_refused(pm__scene_commit(part, &error), &error, "with its scene");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_refused(pm__scene_place(scene, part, &cases[i].placement, &error), &error, cases[i].text);
    check_refused(pm__scene_commit(scene, &error), &error, "no shape");
    PM_CHECK_OK(pm__scene_place(scene, part, &good, &error), error);
    PM_CHECK_OK(pm__scene_place(scene, part, &good, &error), error);
    check_refused(pm__scene_sphere(part, 0, (double[3]){0}, 1.0, false, &error), &error, "the part has been placed");
    check_refused(pm__scene_material(part, &white, &material, &error), &error, "the part has been placed");
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    check_refused(pm__scene_place(scene, part, &good, &error), &error, "the scene is committed");
    check_refused(pm__scene_part(scene, &part, &error), &error, "the scene is committed");
    pm__scene_destroy(scene);
    pm__scene_destroy(other);
}
END_TEST

PM_TEST_MAIN("parts", test_same_hits, test_same_blocked, test_exact_box, test_watertight, test_tiles, test_objects,
             test_refusals)
