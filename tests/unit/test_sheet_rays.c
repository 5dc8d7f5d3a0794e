/* Scenes with sheets against the same scenes whose sheets are not known as such, since a corner within is a vertex of
 * its own: every ray, way and photon to the last bit. */
#include "../../src/transport/trace.h"
#include "../batches.h"
#include "../lit.h"
#include "../terrain.h"

enum { RAYS = 30000, PHOTONS = 4000, KINDS = 4 };

/* ---- Scenes --------------------------------------------------------------------------------------- */

static const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 2.0, 3.0}, .position = {0.1, 0.2, 1.7}};

static void add_sheet(pm__scene *scene, const terrain *t, uint32_t material, bool split)
{
    const terrain apart = terrain_split(t);
    terrain_add(split ? &apart : t, material, scene);
}

/* A body, hence no sheet: a box with corners (-h, -h, -h) to (h, h, h) about the centre. */
static void add_box(pm__scene *scene, uint32_t material, const float centre[3], float h)
{
    static const uint32_t triangles[12][3] = {{0, 2, 1}, {3, 1, 2}, {4, 5, 6}, {7, 6, 5}, {0, 1, 4}, {5, 4, 1},
                                              {2, 6, 3}, {7, 3, 6}, {0, 4, 2}, {6, 2, 4}, {1, 3, 5}, {7, 5, 3}};
    float v[8][3];
    pm_error error;
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++)
            v[i][axis] = centre[axis] + (i >> axis & 1 ? h : -h);
    PM_CHECK_OK(pm__scene_mesh(scene, material, (const float(*)[3])v, 8, triangles, 12, &error), error);
}

/* In a ball of mirror and wall: one sheet of water; five sheets along all axes, facing either way, that cross; two
 * parts that hold one, turned and scaled; or a sheet that is all that Embree holds, numbered between exact shapes. */
static pm__scene *scene_of(int kind, bool split)
{
    static const float corner[3] = {0.4f, 0.3f, -0.9f}, other[3] = {-0.5f, 0.1f, 0.35f};
    pm__scene *const scene = lit_create();
    const uint32_t wall = lit_wall(scene, 0.9, 0.8, 0.7), glass = lit_glass(scene);
    pm_error error;
    lit_sphere(scene, wall, 0.0, 0.0, 0.0, 2.5, true);
    lit_sphere(scene, glass, 0.3, -0.4, 0.9, 0.25, false);
    lit_floor(scene, wall, 0.5, -1.2);
    if (kind != 3)
        add_box(scene, wall, corner, 0.3f);
    if (kind != 2)
        for (int i = 0; i < (kind == 1 ? 5 : 1); i++) {
            const terrain t = terrain_of((i + 2) % 3, i % 2, 0.2 * i - 0.3, 0.1, (uint64_t)i);
            add_sheet(scene, &t, i % 2 ? wall : glass, split);
        }
    if (kind == 3)
        lit_sphere(scene, glass, -0.5, 0.1, 0.35, 0.3, false);
    else
        add_box(scene, glass, other, 0.2f);
    if (kind == 2) {
        pm__scene *part;
        const pm__placement places[2] = {{{{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}, 0.7, {0.4, 0.3, 0.2}},
                                         {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, 0.9, {-0.2, 0.1, -0.1}}};
        PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
        const uint32_t inner = lit_wall(part, 0.5, 0.9, 0.6);
        const terrain t = terrain_of(2, false, 0.0, 0.15, 9);
        add_sheet(part, &t, inner, split);
        add_box(part, lit_glass(part), corner, 0.3f);
        for (int i = 0; i < 2; i++)
            PM_CHECK_OK(pm__scene_place(scene, part, &places[i], &error), error);
    }
    lit_lamp(scene, &lamp);
    return lit_commit(scene);
}

static size_t sheet_count(const pm__scene *scene)
{
    size_t count = 0;
    for (size_t i = 0; i < scene->held_count; i++)
        count += scene->held[i].steep < 1.0;
    for (size_t i = 0; i < scene->part_count; i++)
        count += sheet_count(scene->parts[i]);
    return count;
}

/* Sheets that lie in no part: does the ray leave, or come to, one of them so steeply that it is known to be free? */
static bool is_spared(const pm__scene *scene, uint32_t shape, const double d[3])
{
    for (size_t i = 0; i < scene->held_count; i++) {
        const pm__held *const held = &scene->held[i];
        if (shape >= held->first && shape < held->end && fabs(d[held->axis]) > held->steep)
            return true;
    }
    return false;
}

START_TEST(test_known)
{
    static const size_t least[KINDS] = {1, 2, 1, 1};
    for (int kind = 0; kind < KINDS; kind++) {
        pm__scene *const whole = scene_of(kind, false), *const split = scene_of(kind, true);
        ck_assert_uint_ge(sheet_count(whole), least[kind]);
        ck_assert_uint_eq(sheet_count(split), 0);
        ck_assert_uint_le(whole->held_count, PM__MOST_HELD);
        ck_assert_uint_eq(whole->shape_count, split->shape_count);
        pm__scene_destroy(whole);
        pm__scene_destroy(split);
    }
}
END_TEST

/* ---- Rays and ways -------------------------------------------------------------------------------- */

static bool is_same(const pm__hit *a, const pm__hit *b)
{
    return a->distance == b->distance && a->shape == b->shape && a->material->kind == b->material->kind &&
           !memcmp(a->position, b->position, sizeof a->position) && !memcmp(a->normal, b->normal, sizeof a->normal);
}

/* On from where the ray before ended, in any direction or to the middle; out of the ball, and anew from the lamp. */
static size_t check_rays(const pm__scene *whole, const pm__scene *split, asked *rays)
{
    double at[3] = {0.1, 0.2, 1.7}, before[3] = {0.2, 0.2, 1.7};
    uint32_t from = PM__NO_SHAPE, last = PM__NO_SHAPE;
    size_t spared = 0;
    for (uint64_t i = 0; i < RAYS; i++) {
        double u[3], d[3];
        pm__hit hit, same;
        pm__random_uniform(7, PM__FOR_TESTS, 62, i, u, 3);
        for (int axis = 0; axis < 3; axis++)
            d[axis] = 2.0 * u[axis] - 1.0 - (i % 2 ? at[axis] : 0.0);
        (void)pm__normalize(d);
        rays[i] = (asked){.origin = {at[0], at[1], at[2]}, .direction = {d[0], d[1], d[2]}, .from = from};
        const bool met = pm__scene_intersect(whole, at, d, INFINITY, from, &hit);
        ck_assert_int_eq(pm__scene_intersect(split, at, d, INFINITY, from, &same), met);
        spared += is_spared(whole, from, d);
        if (!met) {
            memcpy(at, lamp.position, sizeof at);
            last = from = PM__NO_SHAPE;
            memcpy(before, at, sizeof before);
            before[0] += 0.1;
            continue;
        }
        ck_assert_msg(is_same(&hit, &same), "ray %d: shape %u at %.17g, not %u at %.17g", (int)i, hit.shape,
                      hit.distance, same.shape, same.distance);
        ck_assert_msg(pm__scene_blocked(whole, before, last, hit.position, hit.shape) ==
                          pm__scene_blocked(split, before, last, hit.position, hit.shape),
                      "way %d from shape %u to %u", (int)i, last, hit.shape);
        memcpy(before, at, sizeof at);
        last = from;
        memcpy(at, hit.position, sizeof at);
        from = hit.shape;
    }
    return spared;
}

START_TEST(test_rays)
{
    static asked rays[RAYS];
    for (int kind = 0; kind < KINDS; kind++) {
        pm__scene *const whole = scene_of(kind, false), *const split = scene_of(kind, true);
        const size_t spared = check_rays(whole, split, rays);
        ck_assert_msg(kind == 2 || spared > RAYS / 50, "only %zu rays leave a sheet steeply", spared);
        check_batches(whole, rays, RAYS, "sheets");
        check_batches(split, rays, RAYS, "sheets not known as such");
        pm__scene_destroy(whole);
        pm__scene_destroy(split);
    }
}
END_TEST

/* Between points on the sheet itself, where the way may be steep at neither end: against the same once more, and open
 * ones among them. */
START_TEST(test_ways_on_sheets)
{
    for (int kind = 0; kind < KINDS; kind += 1 + (kind == 1)) {
        pm__scene *const whole = scene_of(kind, false), *const split = scene_of(kind, true);
        double last[3];
        uint32_t to = PM__NO_SHAPE;
        int open = 0, blocked = 0;
        for (uint64_t i = 0; i < RAYS; i++) {
            double u[3];
            pm__hit hit;
            pm__random_uniform(7, PM__FOR_TESTS, 63, i, u, 3);
            const double down[3] = {0.0, 0.0, i % 2 ? 1.0 : -1.0};
            const double at[3] = {1.8 * u[0] - 0.9, 1.8 * u[1] - 0.9, i % 2 ? -0.8 : 0.3};
            if (!pm__scene_intersect(whole, at, down, 1.5, PM__NO_SHAPE, &hit))
                continue;
            if (to != PM__NO_SHAPE) {
                const bool want = pm__scene_blocked(split, hit.position, hit.shape, last, to);
                ck_assert_int_eq(pm__scene_blocked(whole, hit.position, hit.shape, last, to), want);
                ck_assert_int_eq(pm__scene_blocked(whole, last, to, hit.position, hit.shape), want);
                *(want ? &blocked : &open) += 1;
            }
            memcpy(last, hit.position, sizeof last);
            to = hit.shape;
        }
        ck_assert_msg(open > 50 && blocked > 1000, "%d open, %d blocked", open, blocked);
        pm__scene_destroy(whole);
        pm__scene_destroy(split);
    }
}
END_TEST

/* ---- Photons -------------------------------------------------------------------------------------- */

typedef struct records {
    pm__stored *items;
    size_t count, capacity;
} records;

static bool keep(void *context, uint64_t number, const pm__stored *stored)
{
    records *const r = context;
    (void)number;
    if (r->count == r->capacity) {
        r->capacity = 2 * r->capacity + 1024;
        r->items = realloc(r->items, r->capacity * sizeof *r->items);
        ck_assert_ptr_nonnull(r->items);
    }
    r->items[r->count++] = *stored;
    return true;
}

START_TEST(test_photons)
{
    for (int kind = 0; kind < KINDS; kind++) {
        records all[2] = {{0}};
        for (int split = 0; split < 2; split++) {
            pm__scene *const scene = scene_of(kind, split);
            const pm__trace_config config = {.scene = scene, .seed = 5};
            ck_assert_uint_eq(pm__trace(&config, 0, PHOTONS, keep, &all[split]), PHOTONS);
            pm__scene_destroy(scene);
        }
        ck_assert_uint_gt(all[0].count, 2 * PHOTONS);
        ck_assert_uint_eq(all[0].count, all[1].count);
        for (size_t i = 0; i < all[0].count; i++)
            ck_assert_msg(!memcmp(&all[0].items[i], &all[1].items[i], sizeof *all[0].items), "photon %zu differs", i);
        free(all[0].items);
        free(all[1].items);
    }
}
END_TEST

PM_TEST_MAIN("sheet rays", test_known, test_rays, test_ways_on_sheets, test_photons)
