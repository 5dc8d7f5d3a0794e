/* Photon tracing in scenes whose sums are known. Bounds are 6 standard deviations of the true law: a false alarm once
 * in 5e8 comparisons, 2e-8 for the file. */
#include "../../src/transport/trace.h"
#include "../test.h"

#include <string.h>

enum { PHOTONS = 100000 };

static const double pi = 3.14159265358979323846;
static const double middle[3] = {0.0, 0.0, 0.0};

/* ---- Scenes ---------------------------------------------------------------------------------- */

static uint32_t add_material(pm__scene *scene, const pm__material *material)
{
    pm_error error;
    uint32_t index;
    PM_CHECK_OK(pm__scene_material(scene, material, &index, &error), error);
    return index;
}

static uint32_t add_wall(pm__scene *scene, double albedo)
{
    const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {albedo, albedo, albedo}};
    return add_material(scene, &wall);
}

static void add_sphere(pm__scene *scene, uint32_t material, const double centre[3], double radius, bool inward)
{
    pm_error error;
    PM_CHECK_OK(pm__scene_sphere(scene, material, centre, radius, inward, &error), error);
}

static void add_point_light(pm__scene *scene, double x, double power)
{
    pm_error error;
    const pm__light light = {.kind = PM__POINT, .position = {x, 0.1, -0.2}, .power = {power, power, power}};
    PM_CHECK_OK(pm__scene_light(scene, &light, &error), error);
}

static pm__scene *create(void)
{
    pm_error error;
    pm__scene *scene;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    return scene;
}

static void commit(pm__scene *scene)
{
    pm_error error;
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
}

/* A sphere of radius 1 about the middle, with a point light off its centre. */
static pm__scene *furnace(double albedo)
{
    pm__scene *const scene = create();
    add_sphere(scene, add_wall(scene, albedo), middle, 1.0, true);
    add_point_light(scene, 0.6, 1.0);
    commit(scene);
    return scene;
}

/* The cube from -1 to 1 as a mesh, normals inward. */
static void add_box(pm__scene *scene, uint32_t material)
{
    static const float corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                        {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
    static const uint32_t triangles[12][3] = {{0, 1, 2}, {1, 3, 2}, {4, 6, 5}, {5, 6, 7}, {0, 4, 1}, {1, 4, 5},
                                              {2, 3, 6}, {3, 7, 6}, {0, 2, 4}, {2, 6, 4}, {1, 5, 3}, {3, 5, 7}};
    pm_error error;
    PM_CHECK_OK(pm__scene_mesh(scene, material, corners, 8, triangles, 12, &error), error);
}

/* ---- What is stored -------------------------------------------------------------------------- */

typedef struct record {
    uint64_t number;
    pm__stored stored;
} record;

typedef struct records {
    record *items;
    size_t count, capacity, limit; /* limit: stop when it is reached; 0: none */
} records;

static bool keep(void *context, uint64_t number, const pm__stored *photon)
{
    records *const r = context;
    if (r->count == r->capacity) {
        r->capacity = 2 * r->capacity + 1024;
        r->items = realloc(r->items, r->capacity * sizeof *r->items);
        ck_assert_ptr_nonnull(r->items);
    }
    r->items[r->count++] = (record){number, *photon};
    return r->count != r->limit;
}

static records trace(const pm__scene *scene, const char *expression, uint64_t first, uint64_t count)
{
    pm_error error;
    pm__paths *paths = NULL;
    if (expression)
        PM_CHECK_OK(pm__paths_create(expression, &paths, &error), error);
    records r = {0};
    const pm__trace_config config = {.scene = scene, .paths = paths, .seed = 7, .trial = 3};
    ck_assert_uint_eq(pm__trace(&config, first, count, keep, &r), count);
    pm__paths_destroy(paths);
    return r;
}

static void check_near(const char *what, double got, double want, double error)
{
    ck_assert_msg(fabs(got - want) <= 6.0 * error, "%s: %g, expected %g, error %g", what, got, want, error);
}

static bool same(const record *a, const record *b)
{
    return a->number == b->number && !memcmp(&a->stored, &b->stored, sizeof a->stored);
}

/* ---- Furnaces -------------------------------------------------------------------------------- */

/* Every photon is stored a geometric number of times: mean 1 / (1 - rho), variance rho / (1 - rho)^2, kurtosis
 * 9 + (1 - rho)^2 / rho. */
static void check_counts(const records *r, double rho)
{
    double square = 0.0;
    for (size_t i = 0; i < r->count;) {
        size_t next = i;
        while (next < r->count && r->items[next].number == r->items[i].number)
            next++;
        square += (double)((next - i) * (next - i));
        i = next;
    }
    const double mean = 1.0 / (1.0 - rho), variance = rho * mean * mean, got = (double)r->count / PHOTONS;
    check_near("stored a photon", got, mean, sqrt(variance / PHOTONS));
    const double kurtosis = 9.0 + (1.0 - rho) * (1.0 - rho) / rho;
    /* About the true mean. */
    const double spread = square / PHOTONS - 2.0 * mean * got + mean * mean;
    check_near("variance", spread, variance, variance * sqrt((kurtosis - 1.0) / PHOTONS));
}

static void check_power(const records *r)
{
    for (size_t i = 0; i < r->count; i++)
        for (int b = 0; b < 3; b++)
            PM_CHECK_NEAR(r->items[i].stored.power[b], 1.0, 1e-12);
}

START_TEST(test_sphere_furnace)
{
    static const double albedos[] = {0.2, 0.5, 0.8};
    for (int a = 0; a < 3; a++) {
        pm__scene *const scene = furnace(albedos[a]);
        const records r = trace(scene, NULL, 0, PHOTONS);
        check_counts(&r, albedos[a]);
        check_power(&r);
        pm__scene_destroy(scene);
        free(r.items);
    }
}
END_TEST

START_TEST(test_box_furnace)
{
    pm__scene *const scene = create();
    add_box(scene, add_wall(scene, 0.7));
    add_point_light(scene, 0.6, 1.0);
    commit(scene);
    const records r = trace(scene, NULL, 0, PHOTONS);
    check_counts(&r, 0.7);
    check_power(&r);
    pm__scene_destroy(scene);
    free(r.items);
}
END_TEST

/* Behind the first bounce all of the sphere is lit alike, wherever the light stands: the height of photons is uniform
 * on [-1, 1] (Archimedes), independent of that of the bounce before. */
START_TEST(test_sphere_is_lit_alike)
{
    pm__scene *const scene = furnace(0.5);
    const records r = trace(scene, "LD(D+)", 0, PHOTONS);
    check_near("stored", (double)r.count / PHOTONS, 1.0, sqrt(2.0 / PHOTONS));
    double mean = 0.0, square = 0.0, turn = 0.0;
    const double n = (double)r.count;
    for (size_t i = 0; i < r.count; i++) {
        const pm__stored *const p = &r.items[i].stored;
        mean += p->position[0] / n;
        square += p->position[0] * p->position[0] / n;
        turn += p->position[1] * p->position[2] / n;
        PM_CHECK_NEAR(pm__dot(p->position, p->normal), -1.0, 1e-9);
        ck_assert(pm__dot(p->direction, p->normal) < 0.0);
    }
    check_near("x", mean, 0.0, sqrt(1.0 / (3.0 * n)));
    check_near("x squared", square, 1.0 / 3.0, sqrt((1.0 / 5.0 - 1.0 / 9.0) / n));
    check_near("y z", turn, 0.0, sqrt(1.0 / (15.0 * n)));
    pm__scene_destroy(scene);
    free(r.items);
}
END_TEST

/* Lights 1 : 3 : by power, and the power of each band as emitted. */
START_TEST(test_lights_by_power)
{
    pm__scene *const scene = create();
    pm_error error;
    pm__light red = {.kind = PM__SPOT, .power = {1.0, 0.0, 0.0}, .direction = {0.0, 0.0, 1.0}, .angle = 0.5};
    pm__light blue = {.kind = PM__SPOT, .power = {0.0, 1.0, 2.0}, .direction = {0.0, 0.0, -1.0}, .angle = 0.5};
    add_sphere(scene, add_wall(scene, 0.0), middle, 1.0, true);
    PM_CHECK_OK(pm__scene_light(scene, &red, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, &blue, &error), error);
    commit(scene);
    const records r = trace(scene, NULL, 0, PHOTONS);
    ck_assert_uint_eq(r.count, PHOTONS);
    double reds = 0.0;
    for (size_t i = 0; i < r.count; i++) {
        const pm__stored *const p = &r.items[i].stored;
        const bool up = p->position[2] > 0.0;
        reds += up;
        for (int b = 0; b < 3; b++)
            PM_CHECK_NEAR(p->power[b], (up ? red.power[b] : blue.power[b]) / (up ? 0.25 : 0.75), 1e-14);
    }
    check_near("of the first light", reds / PHOTONS, 0.25, sqrt(0.25 * 0.75 / PHOTONS));
    pm__scene_destroy(scene);
    free(r.items);
}
END_TEST

/* ---- A photon's path depends on its number alone ---------------------------------------------- */

/* A box with a mirror ball and a glass ball, and perhaps a small rough ball in a corner. */
static pm__scene *room(bool corner)
{
    static const double left[3] = {-0.5, 0.2, -0.6}, right[3] = {0.5, -0.4, -0.6}, away[3] = {0.8, 0.8, 0.8};
    const pm__material mirror = {.kind = PM__MIRROR, .specular = {0.9, 0.9, 0.9}};
    const pm__material glass = {.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}, .absorption = {0.1, 0.2, 0.3}};
    const pm__material glossy = {.kind = PM__GLOSSY, .diffuse = {0.5, 0.1, 0.1}, .specular = {0.2, 0.6, 0.6},
                                 .roughness = 0.1};
    pm__scene *const scene = create();
    add_box(scene, add_material(scene, &glossy));
    add_sphere(scene, add_material(scene, &mirror), left, 0.35, false);
    add_sphere(scene, add_material(scene, &glass), right, 0.35, false);
    if (corner)
        add_sphere(scene, add_wall(scene, 0.5), away, 0.15, false);
    add_point_light(scene, 0.0, 1.0);
    commit(scene);
    return scene;
}

START_TEST(test_alone_as_in_a_range)
{
    enum { COUNT = 2000 };
    pm__scene *const scene = room(true);
    const records all = trace(scene, NULL, 0, COUNT);
    size_t at = 0;
    for (uint64_t n = 0; n < COUNT; n++) {
        const records one = trace(scene, NULL, n, 1);
        for (size_t i = 0; i < one.count; i++, at++)
            ck_assert(at < all.count && same(&one.items[i], &all.items[at]));
        free(one.items);
    }
    ck_assert_uint_eq(at, all.count);
    pm__scene_destroy(scene);
    free(all.items);
}
END_TEST

static bool on_corner_ball(const pm__stored *p)
{
    const double d[3] = {p->position[0] - 0.8, p->position[1] - 0.8, p->position[2] - 0.8};
    return pm__dot(d, d) < 0.16 * 0.16;
}

/* The ball in the corner changes the paths that meet it, and no other. */
START_TEST(test_changes_elsewhere_do_not_matter)
{
    enum { COUNT = 20000 };
    pm__scene *const before = room(false), *const after = room(true);
    const records a = trace(before, NULL, 0, COUNT), b = trace(after, NULL, 0, COUNT);
    size_t i = 0, j = 0, touched = 0;
    for (uint64_t n = 0; n < COUNT; n++) {
        size_t i_end = i, j_end = j;
        bool meets = false;
        for (; i_end < a.count && a.items[i_end].number == n;)
            i_end++;
        for (; j_end < b.count && b.items[j_end].number == n; j_end++)
            meets = meets || on_corner_ball(&b.items[j_end].stored);
        touched += meets;
        ck_assert(meets || i_end - i == j_end - j);
        for (size_t k = 0; !meets && k < i_end - i; k++)
            ck_assert(same(&a.items[i + k], &b.items[j + k]));
        i = i_end;
        j = j_end;
    }
    ck_assert(touched > 0 && touched < COUNT / 2);
    pm__scene_destroy(before);
    pm__scene_destroy(after);
    free(a.items);
    free(b.items);
}
END_TEST

START_TEST(test_stops_when_told)
{
    pm__scene *const scene = furnace(0.0);
    records r = {.limit = 10};
    const pm__trace_config config = {.scene = scene, .seed = 1};
    ck_assert_uint_eq(pm__trace(&config, 100, 1000, keep, &r), 10);
    ck_assert_uint_eq(r.items[9].number, 109);
    pm__scene_destroy(scene);
    free(r.items);
}
END_TEST

/* ---- Paths and media -------------------------------------------------------------------------- */

/* Each stored photon has one of these paths, and the same record whichever is asked for. */
START_TEST(test_paths_share_out_the_photons)
{
    enum { COUNT = 5000 };
    static const char *const parts[] = {"LD", "LS+D", "L.*D.*D"};
    pm__scene *const scene = room(true);
    const records all = trace(scene, NULL, 0, COUNT), again = trace(scene, "L.*D", 0, COUNT);
    ck_assert_uint_eq(all.count, again.count);
    records part[3];
    size_t at[3] = {0}, sum = 0;
    for (int p = 0; p < 3; p++) {
        part[p] = trace(scene, parts[p], 0, COUNT);
        sum += part[p].count;
        ck_assert(part[p].count > 0);
    }
    ck_assert_uint_eq(sum, all.count);
    for (size_t i = 0; i < all.count; i++) {
        int found = 0;
        for (int p = 0; p < 3 && !found; p++)
            if (at[p] < part[p].count && same(&all.items[i], &part[p].items[at[p]])) {
                found = 1;
                at[p]++;
            }
        ck_assert(found && same(&all.items[i], &again.items[i]));
    }
    for (int p = 0; p < 3; p++)
        free(part[p].items);
    pm__scene_destroy(scene);
    free(all.items);
    free(again.items);
}
END_TEST

/* How far a photon went through the unit ball, straight from a point in it to where it is stored. */
static double way_from(const pm__stored *from, const pm__stored *to)
{
    const double b = pm__dot(from->position, to->direction), c = pm__dot(from->position, from->position);
    const double step[3] = {to->position[0] - from->position[0], to->position[1] - from->position[1],
                            to->position[2] - from->position[2]};
    return fmin(sqrt(pm__dot(step, step)), sqrt(b * b + 1.0 - c) - b);
}

/* The same for light that comes down from above. */
static double way_down(const pm__stored *to)
{
    const double *const x = to->position;
    const double top = sqrt(1.0 - x[0] * x[0] - x[1] * x[1]);
    return fmin(top - x[2], 2.0 * top);
}

/* A ball of index 1 that absorbs, under parallel light, with two rough discs in it: one at the centre, the other
 * upright, with its back to that. */
static pm__scene *absorber(const pm__material *clear)
{
    static const double up[3] = {0.0, 0.0, 1.0}, side[3] = {0.7, 0.0, 0.3}, away[3] = {1.0, 0.0, 0.0};
    const pm__light light = {.kind = PM__DIRECTIONAL, .position = {0.0, 0.0, 3.0}, .direction = {0.0, 0.0, -1.0},
                             .radius = 1.0, .power = {1.0, 1.0, 1.0}};
    pm_error error;
    pm__scene *const scene = create();
    const uint32_t wall = add_wall(scene, 1.0);
    add_sphere(scene, add_material(scene, clear), middle, 1.0, false);
    add_sphere(scene, add_wall(scene, 0.0), middle, 5.0, true);
    PM_CHECK_OK(pm__scene_disc(scene, wall, middle, up, 0.5, &error), error);
    PM_CHECK_OK(pm__scene_disc(scene, wall, side, away, 0.25, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, &light, &error), error);
    commit(scene);
    return scene;
}

/* Light goes straight on, and loses power over its way in the ball; rough surfaces do not end the ball. */
START_TEST(test_beer)
{
    const pm__material clear = {.kind = PM__GLASS, .ior = {1.0, 1.0, 1.0}, .absorption = {0.0, 0.5, 2.0}};
    pm__scene *const scene = absorber(&clear);
    const records r = trace(scene, NULL, 0, 5000);
    int within = 0;
    for (size_t i = 0; i < r.count; i++) {
        const pm__stored *const p = &r.items[i].stored;
        const bool first = i == 0 || r.items[i - 1].number != r.items[i].number;
        const pm__stored *const before = first ? NULL : &r.items[i - 1].stored;
        const double way = before ? way_from(before, p) : way_down(p);
        within += before && pm__dot(p->position, p->position) < 1.0;
        ck_assert(pm__dot(p->direction, p->normal) < 0.0);
        for (int k = 0; k < 3; k++)
            PM_CHECK_NEAR(p->power[k], (before ? before->power[k] : 1.0) * exp(-clear.absorption[k] * way), 1e-9);
    }
    ck_assert(r.count > 6000 && within > 50);
    pm__scene_destroy(scene);
    free(r.items);
}
END_TEST

/* From a light within glass: total reflection keeps what is beyond the critical angle, and what leaves is stored. Light
 * from the centre leaves straight: 1 - R of it at once, all in the end. */
START_TEST(test_light_within_glass)
{
    const pm__material glass = {.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}, .absorption = {0.0, 0.0, 1.0}};
    pm_error error;
    pm__scene *const scene = create();
    add_sphere(scene, add_material(scene, &glass), middle, 1.0, false);
    add_sphere(scene, add_wall(scene, 0.0), middle, 2.0, true);
    const pm__light light = {.kind = PM__POINT, .power = {1.0, 1.0, 1.0}};
    PM_CHECK_OK(pm__scene_light(scene, &light, &error), error);
    commit(scene);
    const records r = trace(scene, "LSD", 0, PHOTONS);
    check_near("leave at once", (double)r.count / PHOTONS, 0.96, sqrt(0.96 * 0.04 / PHOTONS));
    for (size_t i = 0; i < r.count; i++)
        PM_CHECK_NEAR(r.items[i].stored.power[2], exp(-1.0), 1e-9);
    const records all = trace(scene, NULL, 0, PHOTONS);
    ck_assert_uint_eq(all.count, PHOTONS);
    pm__scene_destroy(scene);
    free(r.items);
    free(all.items);
}
END_TEST

/* Half of a spot's photons hit a black screen: none is stored there, nor goes on. */
START_TEST(test_black)
{
    const pm__material black = {.kind = PM__BLACK};
    static const double corner[3] = {0.0, -9.0, 1.0}, u[3] = {9.0, 0.0, 0.0}, v[3] = {0.0, 18.0, 0.0};
    static const double left[3] = {-9.0, -9.0, 1.0};
    pm_error error;
    pm__scene *const scene = create();
    PM_CHECK_OK(pm__scene_rectangle(scene, add_material(scene, &black), corner, u, v, &error), error);
    PM_CHECK_OK(pm__scene_rectangle(scene, add_wall(scene, 0.0), left, u, v, &error), error);
    const pm__light light = {
        .kind = PM__SPOT, .direction = {0.0, 0.0, 1.0}, .angle = pi / 4.0, .power = {1.0, 1.0, 1.0}};
    PM_CHECK_OK(pm__scene_light(scene, &light, &error), error);
    commit(scene);
    const records r = trace(scene, NULL, 0, PHOTONS);
    check_near("on the left", (double)r.count / PHOTONS, 0.5, sqrt(0.25 / PHOTONS));
    pm__scene_destroy(scene);
    free(r.items);
}
END_TEST

PM_TEST_MAIN("trace", test_sphere_furnace, test_box_furnace, test_sphere_is_lit_alike, test_lights_by_power,
             test_alone_as_in_a_range, test_changes_elsewhere_do_not_matter, test_stops_when_told,
             test_paths_share_out_the_photons, test_beer, test_light_within_glass, test_black)
