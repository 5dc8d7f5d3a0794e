/* Photons traced together: to the last bit those that are traced one by one, in the same order, in every width. */
#include "../../cases/scenes/list.h"
#include "../../src/transport/emission.h"
#include "../lit.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

static const char *const widths[] = {"plain", "v2", "avx2", "avx512"};
enum { WIDTHS = 4 };

/* All materials, shapes and lights; parts; light inside a medium; more stored of a photon than a wave has room for. */
static const char *const scenes[] = {"scene:cornell", "scene:cornell-diffuse", "scene:cornell-water", "scene:nephroid",
                                     "scene:prism", "scene:pool", "scene:plate", "scene:glossy-plane",
                                     "scene:four-lights", "scene:fractal-cornell", "scene:cognac",
                                     "scene:furnace:albedo=0.95", "scene:glass-sphere", "scene:egg", "scene:office",
                                     "scene:maze", "scene:wide-floor"};
enum { SCENES = sizeof scenes / sizeof *scenes };

static pm__scene *scene_of(const char *text)
{
    pm__scene *scene = NULL;
    pm__spec spec;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, text, &spec, &error), error);
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(((const pm__case *)(const void *)spec.entry)->build(spec.values, scene, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    return scene;
}

/* false: the processor lacks it. */
static bool take_width(const char *name)
{
    const pm__batch_kernel *const kernel = strcmp(name, "avx512") == 0 ? &pm__batch_avx512
                                           : strcmp(name, "avx2") == 0 ? &pm__batch_avx2
                                                                       : &pm__batch_plain;
    ck_assert_int_eq(setenv("PHOTONBENCH_SIMD", name, 1), 0);
    if (pm__batch_choose() == kernel)
        return true;
    (void)printf("SKIP: this processor has no %s\n", name);
    return false;
}

/* ---- What is stored ------------------------------------------------------------------------------ */

typedef struct item {
    uint64_t number;
    pm__stored stored;
} item;

typedef struct records {
    item *items;
    size_t count, capacity;
    size_t most; /* says stop at this one; 0: never */
} records;

static bool keep(void *context, uint64_t number, const pm__stored *stored)
{
    records *const r = context;
    if (r->count == r->capacity) {
        r->capacity = 2 * r->capacity + 64;
        r->items = realloc(r->items, r->capacity * sizeof *r->items);
        ck_assert_ptr_nonnull(r->items);
    }
    r->items[r->count++] = (item){number, *stored};
    return r->count != r->most;
}

static void check_same(const records *a, const records *b, const char *what)
{
    ck_assert_msg(a->count == b->count, "%s: %zu stored, not %zu", what, a->count, b->count);
    for (size_t i = 0; i < a->count; i++)
        ck_assert_msg(!memcmp(&a->items[i], &b->items[i], sizeof *a->items), "%s: stored photon %zu differs", what, i);
}

/* ---- One by one ---------------------------------------------------------------------------------- */

/* By the plain calls alone: pm__depart, pm__scene_intersect, pm__scatter. */
static void trace_one(const pm__scene *scene, uint64_t seed, uint64_t number, records *r)
{
    pm__emission emission;
    pm__departure photon;
    pm__hit hit = {.shape = PM__NO_SHAPE};
    const double *medium = NULL;
    pm__emission_init(scene, NULL, PM__ALL_LIGHTS, seed, 0, &emission);
    ck_assert(pm__depart(&emission, number, &photon));
    for (uint32_t step = 0; step < PM__LONGEST_PATH; step++) {
        double u[3], outgoing[3];
        if (!pm__scene_intersect(scene, photon.position, photon.direction, INFINITY, hit.shape, &hit))
            return;
        if (hit.material->kind == PM__BLACK)
            return;
        if (hit.material->kind == PM__GLASS)
            medium = pm__medium_before(hit.material, hit.normal, photon.direction);
        if (medium)
            pm__attenuate(medium, hit.distance, photon.power);
        if (pm__is_rough(hit.material)) {
            pm__stored stored;
            const double sign = pm__dot(photon.direction, hit.normal) > 0.0 ? -1.0 : 1.0;
            for (int k = 0; k < 3; k++) {
                stored.position[k] = hit.position[k];
                stored.direction[k] = photon.direction[k];
                stored.normal[k] = sign * hit.normal[k];
                stored.power[k] = photon.power[k];
            }
            (void)keep(r, number, &stored);
        }
        pm__trace_uniform(seed, 0, number, 2 + step, u);
        if (pm__scatter(hit.material, hit.normal, photon.direction, u, photon.power, outgoing) == PM__ABSORBED ||
            !(pm__sum(photon.power) < (double)FLT_MAX))
            return;
        if (hit.material->kind == PM__GLASS)
            medium = pm__medium_beyond(hit.material, hit.normal, outgoing);
        memcpy(photon.position, hit.position, sizeof photon.position);
        memcpy(photon.direction, outgoing, sizeof photon.direction);
    }
}

static records one_by_one(const pm__scene *scene, uint64_t first, uint64_t count)
{
    records r = {0};
    for (uint64_t i = 0; i < count; i++)
        trace_one(scene, 3, first + i, &r);
    return r;
}

static records together(const pm__scene *scene, uint64_t first, uint64_t count)
{
    const pm__trace_config config = {.scene = scene, .seed = 3};
    records r = {0};
    ck_assert_uint_eq(pm__trace(&config, first, count, keep, &r), count);
    return r;
}

START_TEST(test_as_one_by_one)
{
    static const uint64_t counts[] = {1, 7, 64, 1000};
    for (size_t s = 0; s < SCENES; s++) {
        pm__scene *const scene = scene_of(scenes[s]);
        for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
            const uint64_t first = i * 4294967000; /* the last ones pass 2^32 on their way */
            const records alone = one_by_one(scene, first, counts[i]);
            for (size_t w = 0; w < WIDTHS; w++) {
                char what[100];
                if (!take_width(widths[w]))
                    continue;
                const records all = together(scene, first, counts[i]);
                (void)snprintf(what, sizeof what, "%s, %d photons, %s", scenes[s], (int)counts[i], widths[w]);
                check_same(&all, &alone, what);
                free(all.items);
            }
            free(alone.items);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

START_TEST(test_stops_where_told)
{
    static const size_t at[] = {1, 2, 100, 257, 1031};
    pm__scene *const scene = scene_of("scene:cornell-diffuse");
    const pm__trace_config config = {.scene = scene, .seed = 3};
    const records all = together(scene, 40, 1000);
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        records some = {.most = at[i]};
        ck_assert_uint_eq(pm__trace(&config, 40, 1000, keep, &some), all.items[at[i] - 1].number - 40 + 1);
        ck_assert_uint_eq(some.count, at[i]);
        ck_assert(!memcmp(some.items, all.items, at[i] * sizeof *all.items));
        free(some.items);
    }
    free(all.items);
    pm__scene_destroy(scene);
}
END_TEST

/* Where nothing is lost each photon is stored as often as it can be. */
START_TEST(test_longest_paths)
{
    static const pm__light lamp = {.kind = PM__POINT, .power = {1.0, 1.0, 1.0}};
    pm__scene *const scene = lit_create();
    lit_sphere(scene, lit_wall(scene, 1.0, 1.0, 1.0), 0.0, 0.0, 0.0, 1.0, true);
    lit_lamp(scene, &lamp);
    lit_commit(scene);
    const records all = together(scene, 0, 5);
    ck_assert_uint_eq(all.count, 5 * PM__LONGEST_PATH);
    for (size_t i = 0; i < all.count; i++)
        ck_assert_uint_eq(all.items[i].number, i / PM__LONGEST_PATH);
    free(all.items);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Paths and watchers -------------------------------------------------------------------------- */

typedef struct watched {
    records stored;
    size_t rays;
    size_t before; /* rays when the last photon was stored */
} watched;

static bool keep_watched(void *context, uint64_t number, const pm__stored *stored)
{
    watched *const w = context;
    ck_assert_uint_gt(w->rays, 0);
    w->before = w->rays;
    return keep(&w->stored, number, stored);
}

static void count_ray(void *context, const double origin[3], const double direction[3], uint32_t from)
{
    watched *const w = context;
    w->rays++;
    ck_assert(isfinite(pm__sum(origin)) && fabs(pm__dot(direction, direction) - 1.0) < 1e-12);
    ck_assert(w->rays > 1 || from == PM__NO_SHAPE);
}

/* Those on the wanted paths are those of all; watched or not. */
START_TEST(test_paths_and_watchers)
{
    pm__scene *const scene = scene_of("scene:cornell");
    pm__paths *paths = NULL;
    pm_error error;
    PM_CHECK_OK(pm__paths_create("LS+D", &paths, &error), error);
    const pm__trace_config config = {.scene = scene, .seed = 3, .paths = paths};
    watched w = {.rays = 0};
    records all = {0};
    ck_assert_uint_eq(pm__trace(&config, 0, 2000, keep, &all), 2000);
    ck_assert_uint_eq(pm__trace_watched(&config, 0, 2000, keep_watched, count_ray, &w), 2000);
    ck_assert_uint_gt(all.count, 50);
    check_same(&all, &w.stored, "watched");
    ck_assert_uint_ge(w.rays, 2000 + all.count);
    free(all.items);
    free(w.stored.items);
    pm__paths_destroy(paths);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Random numbers ------------------------------------------------------------------------------ */

START_TEST(test_random_numbers)
{
    static const uint64_t starts[] = {0, 4294967290, PM__MOST_TRACED - 200};
    static pm__batch batch;
    for (size_t w = 0; w < WIDTHS; w++) {
        if (!take_width(widths[w]))
            continue;
        for (size_t s = 0; s < 3; s++)
            for (uint32_t block = 0; block < 3; block++) {
                const uint64_t seed = 0x123456789abcdef * (s + 1);
                batch.count = PM__BATCH - 3 * s;
                for (size_t i = 0; i < batch.count; i++)
                    batch.number[i] = starts[s] + i * (s + 1);
                pm__batch_choose()->draw(&batch, seed, 77 + block, block, batch.u);
                for (size_t i = 0; i < batch.count; i++) {
                    double u[3];
                    pm__trace_uniform(seed, 77 + block, batch.number[i], block, u);
                    for (int k = 0; k < 3; k++)
                        ck_assert(u[k] == batch.u[k][i]);
                }
            }
    }
}
END_TEST

PM_TEST_MAIN("wave", test_as_one_by_one, test_stops_where_told, test_longest_paths, test_paths_and_watchers,
             test_random_numbers)
