/* The scenes of which little is seen: egg, office, maze, wide floor. What the camera sees is what it should; all doors
 * of the maze together lead everywhere; boxes and walls are closed, and their normals point outward. */
#include "../picture.h"

#include "../../src/base/random.h"
#include "../../src/transport/trace.h"

enum { SIDE = 64, PIXELS = SIDE * SIDE };

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

static pm__camera camera_of(const pm__spec *spec)
{
    pm__view view;
    pm__camera camera;
    pm_error error;
    ((const pm__case *)(const void *)spec->entry)->view(spec->values, &view);
    PM_CHECK_OK(pm__camera_init(&view, SIDE, SIDE, &camera, &error), error);
    return camera;
}

/* Uniform over all directions. */
static void any_direction(const double u[2], double direction[3])
{
    const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z);
    direction[0] = r * cos(2.0 * pi * u[1]);
    direction[1] = r * sin(2.0 * pi * u[1]);
    direction[2] = z;
}

/* ---- What is seen ---- */

/* Straight from the camera no lamp; returns in how many pixels the first surface is of that kind. */
static size_t seen_of(const char *name, pm__material_kind kind)
{
    pm__spec spec;
    pm__scene *const scene = scene_of(name, &spec);
    const pm__camera camera = camera_of(&spec);
    size_t seen = 0;
    for (int i = 0; i < PIXELS; i++) {
        double way[3], radiance[3], distance;
        pm__hit hit;
        pm__camera_direction(&camera, i % SIDE + 0.5, i / SIDE + 0.5, way);
        ck_assert(pm__scene_intersect(scene, camera.eye, way, INFINITY, PM__NO_SHAPE, &hit));
        seen += hit.material->kind == kind;
        for (size_t k = 0; k < pm__scene_light_count(scene); k++)
            ck_assert_msg(!pm__light_seen(pm__scene_light_at(scene, k), camera.eye, way, hit.distance, radiance,
                                          &distance),
                          "%s: a lamp in the picture", name);
    }
    pm__scene_destroy(scene);
    return seen;
}

START_TEST(the_camera_sees_its_subject)
{
    const size_t egg = seen_of("scene:egg", PM__GLASS), ball = seen_of("scene:wide-floor", PM__GLASS);
    const size_t pad = seen_of("scene:office", PM__GLOSSY), alone = seen_of("scene:office:desks=1", PM__GLOSSY);
    ck_assert(egg > PIXELS / 10 && egg < PIXELS / 2);
    ck_assert(ball > PIXELS / 20 && ball < PIXELS / 4);
    ck_assert(pad > PIXELS / 8 && pad < PIXELS / 2);
    ck_assert_uint_eq(pad, alone);
    ck_assert_uint_eq(seen_of("scene:maze", PM__DIFFUSE), PIXELS);
    ck_assert_uint_eq(seen_of("scene:maze:rooms=2", PM__DIFFUSE), PIXELS);
    ck_assert_uint_eq(seen_of("scene:maze:rooms=12", PM__DIFFUSE), PIXELS);
    ck_assert_uint_gt(seen_of("scene:office:desks=16", PM__GLOSSY), PIXELS / 8);
}
END_TEST

/* Little of the whole is in view: the box about what is seen straight, over the floor of all. */
START_TEST(little_is_seen)
{
    static const struct {
        const char *name;
        double floor, most; /* m2; share of it */
    } rows[] = {{"scene:office", 10.4 * 9.6, 0.02},
                {"scene:maze", 48.125 * 48.125, 0.03},
                {"scene:wide-floor", 20.0 * 20.0 * 3.14159, 0.03}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        pm__spec spec;
        pm__scene *const scene = scene_of(rows[k].name, &spec);
        const pm__camera camera = camera_of(&spec);
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int i = 0; i < PIXELS; i++) {
            double way[3];
            pm__hit hit;
            pm__camera_direction(&camera, i % SIDE + 0.5, i / SIDE + 0.5, way);
            ck_assert(pm__scene_intersect(scene, camera.eye, way, INFINITY, PM__NO_SHAPE, &hit));
            for (int a = 0; a < 2; a++) {
                low[a] = fmin(low[a], hit.position[a]);
                high[a] = fmax(high[a], hit.position[a]);
            }
        }
        const double share = (high[0] - low[0]) * (high[1] - low[1]) / rows[k].floor;
        ck_assert_msg(share < rows[k].most, "%s: %g of it is seen", rows[k].name, share);
        pm__scene_destroy(scene);
    }
}
END_TEST

/* ---- Closed, and the right way round ---- */

/* From each lamp from surface to surface: each is met from its front. */
START_TEST(surfaces_are_met_from_their_front)
{
    static const char *const names[] = {"scene:office", "scene:office:desks=1", "scene:maze", "scene:maze:rooms=2",
                                        "scene:maze:rooms=12"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        pm__spec spec;
        pm__scene *const scene = scene_of(names[k], &spec);
        for (uint64_t i = 0; i < 20000; i++) {
            double u[4], at[3], way[3];
            pm__hit hit = {.shape = PM__NO_SHAPE};
            pm__random_uniform(1, PM__FOR_TESTS, 0, i, u, 4);
            pm__emit(pm__scene_light_at(scene, i % pm__scene_light_count(scene)), u, at, way);
            for (uint32_t bounce = 1; bounce < 8; bounce++) {
                ck_assert_msg(pm__scene_intersect(scene, at, way, INFINITY, hit.shape, &hit), "%s: open", names[k]);
                ck_assert_msg(pm__dot(hit.normal, way) < 0.0, "%s: back at (%g, %g, %g)", names[k], hit.position[0],
                              hit.position[1], hit.position[2]);
                pm__random_uniform(1, PM__FOR_TESTS, bounce, i, u, 2);
                any_direction(u, way);
                for (int a = 0; a < 3; a++)
                    way[a] *= pm__dot(hit.normal, way) < 0.0 ? -1.0 : 1.0;
                memcpy(at, hit.position, sizeof at);
            }
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* A line through the egg goes in and out by turns, and the egg does not touch the floor. */
START_TEST(the_egg_is_closed)
{
    pm__spec spec;
    pm__scene *const scene = scene_of("scene:egg", &spec);
    size_t met = 0;
    for (size_t i = 0; i < pm__scene_object_count(scene); i++)
        if (pm__scene_object(scene, i).material->kind == PM__GLASS)
            ck_assert(pm__scene_object(scene, i).low[2] > 1e-5 && pm__scene_object(scene, i).high[2] > 0.8);
    for (uint64_t i = 0; i < 20000; i++) {
        double u[4], at[3] = {0, 0, 1.1}, way[3];
        pm__hit hit = {.shape = PM__NO_SHAPE};
        bool outside = true;
        pm__random_uniform(1, PM__FOR_TESTS, 9, i, u, 4);
        at[0] = 2.0 * u[0] - 1.0;
        at[1] = 2.0 * u[1] - 1.0;
        any_direction(u + 2, way);
        way[2] = -fabs(way[2]);
        while (pm__scene_intersect(scene, at, way, INFINITY, hit.shape, &hit) && hit.material->kind == PM__GLASS) {
            ck_assert((pm__dot(hit.normal, way) < 0.0) == outside);
            met += outside;
            outside = !outside;
            memcpy(at, hit.position, sizeof at);
        }
        ck_assert(outside);
    }
    ck_assert_uint_gt(met, 500);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- The maze ---- */

static const int step[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

/* Is there a doorway from the room's middle that way? At a height above the blocks', below the doors'. */
static bool open_to(const pm__scene *scene, int rooms, int x, int y, const int way[2])
{
    const double from[3] = {3.0 * (x - 0.5 * (rooms - 1)), 3.0 * (y - 0.5 * (rooms - 1)), 1.6};
    const double to[3] = {from[0] + 2.0 * way[0], from[1] + 2.0 * way[1], from[2]};
    return !pm__scene_blocked(scene, from, PM__NO_SHAPE, to, PM__NO_SHAPE);
}

/* Rooms that can be reached; *doors: of all rooms, each counted from both sides. */
static int reached(const pm__scene *scene, int rooms, int *doors)
{
    bool seen[16 * 16] = {true};
    int queue[16 * 16] = {0}, count = 1;
    *doors = 0;
    for (int next = 0; next < count; next++) {
        const int x = queue[next] % rooms, y = queue[next] / rooms;
        for (int d = 0; d < 4; d++) {
            if (!open_to(scene, rooms, x, y, step[d]))
                continue;
            const int i = (y + step[d][1]) * rooms + x + step[d][0];
            ck_assert_msg(x + step[d][0] >= 0 && x + step[d][0] < rooms && i >= 0 && i < rooms * rooms,
                          "a door to nowhere");
            (*doors)++;
            if (!seen[i])
                queue[count++] = i;
            seen[i] = true;
        }
    }
    return count;
}

/* All rooms, and still a maze: n - 1 doors at least join n rooms, but not all walls have one. */
START_TEST(doors_lead_to_all_rooms)
{
    for (int rooms = 2; rooms <= 16; rooms++) {
        char name[32];
        pm__spec spec;
        int doors;
        (void)snprintf(name, sizeof name, "scene:maze:rooms=%d", rooms);
        pm__scene *const scene = scene_of(name, &spec);
        const int all = rooms * rooms, walls = 2 * rooms * (rooms - 1);
        ck_assert_int_eq(reached(scene, rooms, &doors), all);
        ck_assert_int_eq(doors % 2, 0);
        ck_assert_int_ge(doors / 2, all - 1);
        ck_assert_msg(rooms < 4 || doors / 2 < walls * 3 / 4, "%d rooms: %d doors in %d walls", all, doors / 2, walls);
        ck_assert_uint_eq(pm__scene_light_count(scene), (size_t)all);
        ck_assert(open_to(scene, rooms, (rooms - 1) / 2, (rooms - 1) / 2, step[1]));
        pm__scene_destroy(scene);
    }
}
END_TEST

/* ---- The wide floor ---- */

/* All of the rim has the whole sun: irradiance over the mean cosine to the axis, cos^2(a / 2), is as promised. */
START_TEST(all_of_the_floor_is_in_the_sun)
{
    enum { GRID = 12, RIM = 64 };
    static const char *const names[] = {"scene:wide-floor", "scene:wide-floor:sun=20,radius=5",
                                        "scene:wide-floor:sun=20,radius=200", "scene:wide-floor:sun=0.1"};
    static const double radii[] = {20, 5, 200, 20};
    for (int k = 0; k < 4; k++) {
        pm__spec spec;
        pm__scene *const scene = scene_of(names[k], &spec);
        const pm__light *const sun = pm__scene_light_at(scene, 0);
        for (int i = 0; i < RIM; i++) {
            const double turn = 2.0 * pi * i / RIM, at[3] = {radii[k] * cos(turn), radii[k] * sin(turn), 0};
            double sum = 0.0;
            for (int j = 0; j < GRID * GRID; j++) {
                const double u[2] = {(j % GRID + 0.5) / GRID, (j / GRID + 0.999) / GRID};
                pm__light_sample s;
                ck_assert_msg(pm__light_reach(sun, at, u, &s), "%s: the rim at %g", names[k], turn);
                sum += s.irradiance[0] / (GRID * GRID);
            }
            PM_CHECK_NEAR(sum * pow(cos(0.5 * sun->angle), 2), 6.0, 1e-9);
        }
        /* The window's rim is above the floor and the ball. */
        const double sine = sqrt(1.0 - sun->direction[2] * sun->direction[2]);
        ck_assert_double_gt(sun->position[2] - sun->radius * sine, 1.0);
        pm__scene_destroy(scene);
    }
}
END_TEST

/* ---- Caustics ---- */

typedef struct spots {
    const pm__camera *camera;
    double seen[PIXELS]; /* W to the pixel */
    double all, in_view;
} spots;

static bool see(void *context, uint64_t number, const pm__stored *photon)
{
    spots *const s = context;
    double at[2], density;
    (void)number;
    s->all += photon->power[0];
    if (!pm__camera_project(s->camera, photon->position, at, &density) || !(at[0] >= 0.0 && at[0] < SIDE) ||
        !(at[1] >= 0.0 && at[1] < SIDE))
        return true;
    s->in_view += photon->power[0];
    s->seen[(int)at[1] * SIDE + (int)at[0]] += photon->power[0];
    return true;
}

static int descending(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p < q) - (p > q);
}

/* Light through the glass comes together in view: half of what falls there in few pixels. Pixels differ in size, but
 * not by much. */
START_TEST(caustics_are_narrow_and_seen)
{
    static const struct {
        const char *name;
        uint64_t photons;
        double in_view;
        int pixels;
    } rows[] = {{"scene:egg", 400000, 0.4, PIXELS / 20}, {"scene:wide-floor", 4000000, 0.4, PIXELS / 50}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        static spots s;
        pm__spec spec;
        pm__paths *paths;
        pm_error error;
        pm__scene *const scene = scene_of(rows[k].name, &spec);
        const pm__camera camera = camera_of(&spec);
        s = (spots){.camera = &camera};
        PM_CHECK_OK(pm__paths_create("LS+D", &paths, &error), error);
        const pm__trace_config config = {.scene = scene, .paths = paths, .seed = 12};
        (void)pm__trace(&config, 0, rows[k].photons, see, &s);
        ck_assert_msg(s.in_view > rows[k].in_view * s.all, "%s: %g of it is in view", rows[k].name, s.in_view / s.all);
        qsort(s.seen, PIXELS, sizeof *s.seen, descending);
        double sum = 0.0;
        int pixels = 0;
        while (sum < 0.5 * s.in_view)
            sum += s.seen[pixels++];
        ck_assert_msg(pixels < rows[k].pixels, "%s: half of it takes %d pixels", rows[k].name, pixels);
        pm__paths_destroy(paths);
        pm__scene_destroy(scene);
    }
}
END_TEST

PM_TEST_MAIN("scenes of which little is seen", the_camera_sees_its_subject, little_is_seen,
             surfaces_are_met_from_their_front, the_egg_is_closed, doors_lead_to_all_rooms,
             all_of_the_floor_is_in_the_sun, caustics_are_narrow_and_seen)
