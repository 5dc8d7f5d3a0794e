/* Scenes that are rendered: they can be built with all parameters, are looked at from somewhere that sees them, have no
 * holes, know which medium is where, and lose no light. */
#include "../test.h"

#include "../../cases/scenes/list.h"
#include "../../src/base/random.h"
#include "../../src/transport/trace.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- Building ---- */

static const pm__case *case_of(const pm__spec *spec)
{
    return (const pm__case *)(const void *)spec->entry;
}

static pm__spec parsed(const char *text)
{
    pm__spec spec;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, text, &spec, &error), error);
    return spec;
}

/* Not committed. */
static pm__scene *built(const pm__spec *spec)
{
    pm__scene *scene = NULL;
    pm_error error = {""};
    char text[PM__MAX_SPEC];
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    pm__spec_format(spec, text, sizeof text);
    const pm_status status = case_of(spec)->build(spec->values, scene, &error);
    ck_assert_msg(status == PM_OK, "%s: %s", text, error.text);
    return scene;
}

static pm__scene *committed(const pm__spec *spec)
{
    pm__scene *const scene = built(spec);
    pm_error error;
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

static pm__scene *scene_named(const char *text)
{
    const pm__spec spec = parsed(text);
    return committed(&spec);
}

/* It is built and has a camera, and the middle of the image is a surface (of scenes with a truth it may be bare). */
static void check_seen(const pm__spec *spec, bool bare)
{
    char text[PM__MAX_SPEC];
    pm__scene *const scene = committed(spec);
    pm__view view;
    pm__camera camera;
    pm__hit hit;
    pm_error error;
    double direction[3];
    case_of(spec)->view(spec->values, &view);
    PM_CHECK_OK(pm__camera_init(&view, 256, 256, &camera, &error), error);
    pm__camera_direction(&camera, 128, 128, direction);
    pm__spec_format(spec, text, sizeof text);
    ck_assert_msg(bare || pm__scene_intersect(scene, camera.eye, direction, INFINITY, PM__NO_SHAPE, &hit),
                  "%s: nothing is seen", text);
    pm__scene_destroy(scene);
}

/* One parameter, or all (param_count), at an end of its range. false: refused together with the others. */
static bool set_extreme(pm__spec *spec, size_t which, bool high)
{
    pm_error error;
    pm__spec_default(spec->entry, spec);
    for (size_t i = 0; i < spec->entry->param_count; i++) {
        const pm__param *const param = &spec->entry->params[i];
        if ((i == which || which == spec->entry->param_count) && param->type != PM__CHOICE)
            spec->values[i] = high ? param->max : param->min;
    }
    return !spec->entry->resolve || spec->entry->resolve(spec->values, &error) == PM_OK;
}

START_TEST(every_scene_is_built_and_seen)
{
    size_t seen = 0;
    for (size_t k = 0; k < pm__scene_cases.count; k++) {
        pm__spec spec;
        pm__spec_default(pm__scene_cases.entries[k], &spec);
        if (!case_of(&spec)->view) {
            ck_assert_msg(case_of(&spec)->truth != NULL, "%s: neither view nor truth", spec.entry->name);
            continue;
        }
        seen++;
        check_seen(&spec, false);
        for (size_t i = 0; i <= spec.entry->param_count && spec.entry->param_count; i++)
            for (int high = 0; high < 2; high++)
                if (set_extreme(&spec, i, high))
                    check_seen(&spec, case_of(&spec)->truth);
    }
    ck_assert_uint_ge(seen, 6);
}
END_TEST

START_TEST(bad_parameters_are_refused)
{
    static const struct {
        const char *text;
        pm_status status;
    } rows[] = {
        {"scene:cornell:albedo=1", PM_EINVAL},      {"scene:cornell:moved=0.31", PM_EINVAL},
        {"scene:cornell:ior=0.9", PM_EINVAL},       {"scene:cornell:colour=1", PM_ENAME},
        {"scene:cornell:ior=nan", PM_EINVAL},       {"scene:cornell-diffuse:ior=1.5", PM_ENAME},
        {"scene:cornell-water:level=0", PM_EINVAL}, {"scene:cornell-water:waves=0.1", PM_EINVAL},
        {"scene:four-lights:albedo=-1", PM_EINVAL}, {"scene:cognac:turns=160.5", PM_EINVAL},
        {"scene:cognac:depth=0.1", PM_EINVAL},      {"scene:cornel", PM_ENAME},
        {"scene:torus:sun=0", PM_EINVAL},           {"scene:torus:sun=21", PM_EINVAL},
        {"scene:lamp:glass=0.09", PM_EINVAL},       {"scene:lamp:sun=5", PM_ENAME},
        {"scene:egg:ball=0.4", PM_EINVAL},          {"scene:egg:ior=0.9", PM_EINVAL},
        {"scene:office:desks=0", PM_EINVAL},        {"scene:office:desks=2.5", PM_EINVAL},
        {"scene:maze:rooms=1", PM_EINVAL},          {"scene:maze:rooms=17", PM_EINVAL},
        {"scene:wide-floor:radius=4", PM_EINVAL},   {"scene:wide-floor:sun=0", PM_EINVAL},
    };
    for (size_t i = 0; i < COUNT(rows); i++) {
        pm__spec spec;
        pm_error error;
        ck_assert_msg(pm__spec_parse(&pm__scene_cases, rows[i].text, &spec, &error) == rows[i].status, "%s",
                      rows[i].text);
    }
}
END_TEST

/* ---- No holes ---- */

static void direction_of(const double u[2], double direction[3])
{
    const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z);
    direction[0] = r * cos(2.0 * pi * u[1]);
    direction[1] = r * sin(2.0 * pi * u[1]);
    direction[2] = z;
}

typedef struct box {
    const char *scene;
    double half[2], height;
    bool open; /* in front: there alone rays get out */
} box;

static const box boxes[] = {{"scene:cornell", {0.5, 0.5}, 1, true},
                            {"scene:cornell:moved=0.3", {0.5, 0.5}, 1, true},
                            {"scene:cornell-diffuse", {0.5, 0.5}, 1, true},
                            {"scene:cornell-water", {0.5, 0.5}, 1, true},
                            {"scene:fractal-cornell", {0.5, 0.5}, 1, true},
                            {"scene:four-lights", {1, 1.25}, 1.25, false},
                            {"scene:lamp", {0.8, 0.9}, 1.4, false},
                            {"scene:egg", {1.8, 1.8}, 2.7, false},
                            {"scene:office", {5.2, 4.8}, 2.7, false},
                            {"scene:office:desks=1", {1.6, 1.5}, 2.7, false},
                            {"scene:maze", {24.0625, 24.0625}, 2.5, false},
                            {"scene:maze:rooms=3", {4.5625, 4.5625}, 2.5, false}};

/* All is within the room, mirrors and glass but for the water clear of the floor and the walls. */
START_TEST(rooms_hold_all)
{
    for (size_t k = 0; k < COUNT(boxes); k++) {
        const double half[2] = {boxes[k].half[0], boxes[k].half[1]};
        pm__scene *const scene = scene_named(boxes[k].scene);
        ck_assert_uint_ge(pm__scene_object_count(scene), 6);
        for (size_t i = 0; i < pm__scene_object_count(scene); i++) {
            const pm__object object = pm__scene_object(scene, i);
            const bool rests = pm__is_rough(object.material) || strstr(boxes[k].scene, "water");
            const double room = rests ? 1e-6 : -1e-6;
            for (int a = 0; a < 2; a++)
                ck_assert_msg(object.low[a] >= -half[a] - room && object.high[a] <= half[a] + room, "%s: object %zu",
                              boxes[k].scene, i);
            ck_assert_msg(object.low[2] >= -room && object.high[2] <= boxes[k].height + room, "%s: object %zu",
                          boxes[k].scene, i);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* A million rays in all, of any origin and direction within. */
START_TEST(rooms_have_no_holes)
{
    const uint64_t rays = 1000000 / COUNT(boxes);
    for (size_t k = 0; k < COUNT(boxes); k++) {
        const box *const b = &boxes[k];
        pm__scene *const scene = scene_named(b->scene);
        for (uint64_t i = 0; i < rays; i++) {
            double u[5], direction[3];
            pm__random_uniform(3, PM__FOR_TESTS, (uint32_t)k, i, u, 5);
            const double origin[3] = {b->half[0] * (2.0 * u[0] - 1.0), b->half[1] * (2.0 * u[1] - 1.0),
                                      b->height * u[2]};
            direction_of(u + 3, direction);
            pm__hit hit;
            if (pm__scene_intersect(scene, origin, direction, INFINITY, PM__NO_SHAPE, &hit))
                continue;
            const double way = (-b->half[1] - origin[1]) / direction[1];
            const double x = origin[0] + way * direction[0], z = origin[2] + way * direction[2];
            ck_assert_msg(b->open && way > 0.0 && fabs(x) <= b->half[0] && z >= 0.0 && z <= b->height,
                          "%s: ray %d gets out at (%g, %g)", b->scene, (int)i, x, z);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* ---- Lamps and media ---- */

/* A lamp's light starts in the open, and squares have their wall behind them at a distance. */
static void check_lamp(const char *name, const pm__scene *scene, const pm__light *light)
{
    for (uint64_t i = 0; i < 2000; i++) {
        double u[4], position[3], direction[3];
        pm__hit hit;
        pm__random_uniform(4, PM__FOR_TESTS, 0, i, u, 4);
        pm__emit(light, u, position, direction);
        const bool met = pm__scene_intersect(scene, position, direction, INFINITY, PM__NO_SHAPE, &hit);
        ck_assert_msg(!met || hit.distance > 1e-2, "%s: a lamp stands in something", name);
        const double up[3] = {0, 0, 1};
        position[2] -= 5e-3;
        if (light->kind == PM__RECTANGLE && pm__scene_intersect(scene, position, up, INFINITY, PM__NO_SHAPE, &hit))
            ck_assert_msg(hit.distance > 5.5e-3, "%s: a lamp lies in the ceiling", name);
    }
}

START_TEST(lamps_stand_free)
{
    for (size_t k = 0; k < pm__scene_cases.count; k++) {
        pm__spec spec;
        pm__spec_default(pm__scene_cases.entries[k], &spec);
        if (case_of(&spec)->truth)
            continue;
        pm__scene *const scene = committed(&spec);
        for (size_t i = 0; i < pm__scene_light_count(scene); i++) {
            const pm__light *const light = pm__scene_light_at(scene, i);
            ck_assert(light->kind == PM__RECTANGLE || light->kind == PM__BALL || light->kind == PM__SUN);
            check_lamp(spec.entry->name, scene, light);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

static bool same(const double a[3], const double b[3])
{
    return memcmp(a, b, 3 * sizeof *a) == 0;
}

/* A straight line from a lamp through all glass: each boundary must have on its near side the medium, told by its
 * absorption, that the line is in. Returns how many boundaries it met. */
static int follow(const char *name, const pm__scene *scene, uint64_t number)
{
    double u[4], at[3], direction[3], medium[3] = {0, 0, 0};
    uint32_t from = PM__NO_SHAPE;
    pm__hit hit;
    pm__random_uniform(5, PM__FOR_TESTS, 0, number, u, 4);
    pm__emit(pm__scene_light_at(scene, 0), u, at, direction);
    int met = 0;
    while (pm__scene_intersect(scene, at, direction, INFINITY, from, &hit) && hit.material->kind == PM__GLASS) {
        const bool enters = pm__dot(direction, hit.normal) < 0.0;
        const double *const near = enters ? hit.material->outside : hit.material->absorption;
        const double *const far = enters ? hit.material->absorption : hit.material->outside;
        ck_assert_msg(same(near, medium), "%s: line %d, boundary %d at (%g, %g, %g): not in the medium before it", name,
                      (int)number, met, hit.position[0], hit.position[1], hit.position[2]);
        memcpy(medium, far, sizeof medium);
        memcpy(at, hit.position, sizeof at);
        from = hit.shape;
        met++;
    }
    return met;
}

START_TEST(media_follow_one_another)
{
    static const char *const names[] = {"scene:cognac", "scene:cognac:depth=0.06,turns=16", "scene:cornell-water",
                                        "scene:cornell-water:level=0.85,waves=0.02",
                                        "scene:egg", "scene:wide-floor:radius=5"};
    for (size_t k = 0; k < COUNT(names); k++) {
        pm__scene *const scene = scene_named(names[k]);
        int most = 0;
        for (uint64_t i = 0; i < 100000; i++) {
            const int met = follow(names[k], scene, i);
            most = met > most ? met : most;
        }
        ck_assert_int_ge(most, k < 2 ? 6 : 1); /* the glass of cognac: at least wall, cognac, wall */
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Clear of the floor; and from the axis outward the bowl's inside, then its outside, as far off as glass is thick. */
START_TEST(glass_has_a_wall)
{
    pm__scene *const scene = scene_named("scene:cognac");
    for (size_t i = 0; i < pm__scene_object_count(scene); i++)
        if (pm__scene_object(scene, i).material->kind == PM__GLASS)
            ck_assert(pm__scene_object(scene, i).low[2] > 1e-4);
    for (double z = 0.055; z < 0.134; z += 0.0005) {
        const double axis[3] = {0, 0, z}, out[3] = {1, 0, 0};
        pm__hit inside, outside;
        ck_assert(pm__scene_intersect(scene, axis, out, INFINITY, PM__NO_SHAPE, &inside));
        ck_assert(pm__dot(out, inside.normal) < 0.0);
        ck_assert(pm__scene_intersect(scene, inside.position, out, INFINITY, inside.shape, &outside));
        ck_assert(pm__dot(out, outside.normal) > 0.0);
        ck_assert_msg(outside.distance > 1e-3 && outside.distance < 8e-3, "%g m of glass at %g m", outside.distance, z);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Light is not lost ---- */

/* What the photons leave behind, by band, over the lamps' power: all of it where nothing else absorbs. A photon's own
 * sum is one sample. low, high: with the glossy lobe's albedo taken as its bound, or as 0. */
typedef struct ledger {
    const pm__scene *scene;
    double power[3], own[2][3], sum[2][3], squares[2][3];
    uint64_t number, stored;
} ledger;

static void close_entry(ledger *book)
{
    for (int end = 0; end < 2; end++)
        for (int b = 0; b < 3; b++) {
            book->sum[end][b] += book->own[end][b];
            book->squares[end][b] += book->own[end][b] * book->own[end][b];
            book->own[end][b] = 0.0;
        }
}

static bool enter(void *context, uint64_t number, const pm__stored *photon)
{
    ledger *const book = context;
    double above[3], down[3];
    pm__hit hit;
    if (number != book->number)
        close_entry(book);
    book->number = number;
    book->stored++;
    for (int a = 0; a < 3; a++) {
        down[a] = -photon->normal[a];
        above[a] = photon->position[a] - 1e-6 * down[a];
    }
    ck_assert(pm__scene_intersect(book->scene, above, down, 1e-5, PM__NO_SHAPE, &hit));
    for (int b = 0; b < 3; b++) {
        const double kept = photon->power[b] / book->power[b], gone = 1.0 - hit.material->diffuse[b];
        book->own[0][b] += kept * (gone - hit.material->specular[b]);
        book->own[1][b] += kept * gone;
    }
    return true;
}

/* A black sky around all catches what gets out. least: of the power, that must be found again. */
static void check_ledger(const char *name, double least)
{
    enum { PHOTONS = 20000 };
    const pm__material black = {.kind = PM__DIFFUSE};
    const double middle[3] = {0, 0, 0.5};
    const pm__spec spec = parsed(name);
    pm__scene *const scene = built(&spec);
    pm_error error;
    uint32_t sky;
    PM_CHECK_OK(pm__scene_material(scene, &black, &sky, &error), error);
    PM_CHECK_OK(pm__scene_sphere(scene, sky, middle, 50.0, true, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    ledger book = {.scene = scene};
    pm__scene_power(scene, book.power);
    const pm__trace_config config = {.scene = scene, .seed = 11};
    ck_assert_uint_eq(pm__trace(&config, 0, PHOTONS, enter, &book), PHOTONS);
    close_entry(&book);
    ck_assert_uint_gt(book.stored, PHOTONS / 2);
    for (int b = 0; b < 3; b++) {
        const double low = book.sum[0][b] / PHOTONS, high = book.sum[1][b] / PHOTONS;
        const double low_error = sqrt((book.squares[0][b] / PHOTONS - low * low) / PHOTONS);
        const double high_error = sqrt((book.squares[1][b] / PHOTONS - high * high) / PHOTONS);
        ck_assert_msg(low - 6.0 * low_error <= 1.0 && high + 6.0 * high_error >= least,
                      "%s, band %d: %g(%g) to %g(%g) of the power is absorbed, not %g to 1", name, b, low, low_error,
                      high, high_error, least);
    }
    pm__scene_destroy(scene);
}

/* 6 standard errors: a false alarm in less than 1e-7 of all runs. */
START_TEST(no_light_is_lost)
{
    check_ledger("scene:cornell", 1.0);
    check_ledger("scene:cornell:ior=3,moved=-0.15", 1.0);
    check_ledger("scene:cornell-diffuse", 1.0);
    check_ledger("scene:cornell-diffuse:albedo=0", 1.0);
    check_ledger("scene:cornell-water:absorption=0", 1.0);
    check_ledger("scene:four-lights", 1.0);
    check_ledger("scene:fractal-cornell", 1.0);
    check_ledger("scene:fractal-cornell:depth=4", 1.0);
    check_ledger("scene:torus", 1.0);
    check_ledger("scene:lamp", 1.0);
    check_ledger("scene:lamp:glass=0.08,ior=3", 1.0);
    check_ledger("scene:egg", 1.0);
    check_ledger("scene:egg:ior=3", 1.0);
    check_ledger("scene:office", 1.0);
    check_ledger("scene:office:desks=1,albedo=0.99", 1.0);
    check_ledger("scene:maze", 1.0);
    check_ledger("scene:maze:rooms=2,albedo=0", 1.0);
    check_ledger("scene:wide-floor", 1.0);
    check_ledger("scene:cornell-water", 0.5); /* some in the water */
    check_ledger("scene:cognac", 0.95);       /* and little in glass and cognac */
}
END_TEST

/* ---- The caustic of the glass ---- */

enum { CELLS = 64 };

static const double cell_side = 0.5 / CELLS; /* m */

static bool light_up(void *context, uint64_t number, const pm__stored *photon)
{
    double(*const cells)[CELLS] = context;
    (void)number;
    const double x = CELLS / 2 + photon->position[0] / cell_side, y = CELLS / 2 + photon->position[1] / cell_side;
    if (x >= 0.0 && x < CELLS && y >= 0.0 && y < CELLS)
        cells[(int)y][(int)x] += photon->power[0];
    return true;
}

/* Irradiance by the ball alone: from outside it is as a point. */
static double direct(const pm__light *ball, int column, int row)
{
    const double x = (column + 0.5 - CELLS / 2) * cell_side - ball->position[0];
    const double y = (row + 0.5 - CELLS / 2) * cell_side - ball->position[1], z = ball->position[2];
    return ball->power[0] * z / (4.0 * pi * pow(x * x + y * y + z * z, 1.5));
}

/* Somewhere four times as much light comes through the glass as would come if it were not there. */
START_TEST(cognac_has_a_caustic)
{
    enum { PHOTONS = 500000 };
    static double cells[CELLS][CELLS];
    pm__scene *const scene = scene_named("scene:cognac");
    const pm__light *const ball = pm__scene_light_at(scene, 0);
    pm__paths *paths;
    pm_error error;
    double most = 0.0;
    ck_assert_int_eq(ball->kind, PM__BALL);
    PM_CHECK_OK(pm__paths_create("LS+D", &paths, &error), error);
    const pm__trace_config config = {.scene = scene, .paths = paths, .seed = 12};
    (void)pm__trace(&config, 0, PHOTONS, light_up, cells);
    for (int row = 0; row < CELLS; row++)
        for (int column = 0; column < CELLS; column++)
            most = fmax(most, cells[row][column] / (PHOTONS * cell_side * cell_side) / direct(ball, column, row));
    ck_assert_msg(most > 4.0, "the caustic is at most %g times as bright as direct light", most);
    pm__paths_destroy(paths);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("views", every_scene_is_built_and_seen, bad_parameters_are_refused, rooms_hold_all, rooms_have_no_holes,
             lamps_stand_free, media_follow_one_another, glass_has_a_wall, no_light_is_lost, cognac_has_a_caustic)
