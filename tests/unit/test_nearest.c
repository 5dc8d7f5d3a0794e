/* The nearest photon in front by cells that remember, against pm_map_search for k = 1, to the last bit: with the first
 * ask of a cell and with the twelfth, by one thread and by three at once. */
#include "../../src/base/memory.h"
#include "../../src/base/random.h"
#include "../../src/cli/parallel.h"
#include "../../src/transport/nearest.h"
#include "../test.h"

#include <string.h>

enum { POINTS = 1500, ROUNDS = 12, FLAT = 0, ROUND, HEAP, TWIN, FEW, KINDS };

typedef struct fixture {
    pm_map *map;
    size_t count;
    float positions[POINTS][3], normals[POINTS][3];
    pm_neighbor want[POINTS];
} fixture;

static void uniform(uint32_t what, size_t i, double u[4])
{
    pm__random_uniform(11, PM__FOR_TESTS, what, i, u, 4);
}

static void ball_direction(const double u[2], float direction[3])
{
    const double z = 2.0 * u[0] - 1.0, r = sqrt(1.0 - z * z), phi = 6.283185307179586 * u[1];
    direction[0] = (float)(r * cos(phi));
    direction[1] = (float)(r * sin(phi));
    direction[2] = (float)z;
}

/* A floor seen from above; a ball from all around; photons and directions at random, far denser at one end; some in
 * each of 1600 places, where the lower index wins; three. */
static void place(int kind, uint32_t what, size_t i, float position[3], float direction[3])
{
    double u[4];
    uniform(what, i, u);
    ball_direction(u + 2, direction);
    for (int a = 0; a < 3; a++)
        position[a] = (float)(kind == HEAP || kind == FEW ? u[a] * u[a] * u[a] * u[a] : a == 2 ? 0.0 : u[a]);
    if (kind == FLAT)
        direction[2] = fabsf(direction[2]);
    if (kind == ROUND)
        memcpy(position, direction, 3 * sizeof *position);
    for (int a = 0; a < 2 && kind == TWIN; a++)
        position[a] = (float)(floor(u[a] * 40.0) / 40.0);
}

static void set_up(int kind, size_t count, double reach, fixture *f)
{
    pm_photon *const photons = pm__alloc_zero(count, sizeof *photons);
    pm_error error;
    for (size_t i = 0; i < count; i++) {
        place(kind, 1, i, photons[i].position, photons[i].direction);
        for (int a = 0; a < 3; a++)
            photons[i].direction[a] = -photons[i].direction[a];
    }
    f->count = count;
    PM_CHECK_OK(pm_map_create(photons, count, NULL, &f->map, &error), error);
    free(photons);
    for (size_t i = 0; i < POINTS; i++) {
        place(kind, 2, i % (POINTS / 2), f->positions[i], f->normals[i]); /* each point twice, of two normals */
        if (kind == FLAT) {
            f->normals[i][0] = f->normals[i][1] = 0.0f;
            f->normals[i][2] = i % 3 ? 1.0f : -1.0f;
        }
        if (i >= POINTS / 2)
            for (int a = 0; a < 3; a++)
                f->normals[i][a] = -f->normals[i][a];
        if (i % 7 == 0)
            f->positions[i][2] += 0.3f; /* off the surface */
        if (i % 50 == 0)
            f->positions[i][0] += 30.0f; /* far off */
        pm_query query;
        size_t found;
        pm_query_init(&query);
        memcpy(query.position, f->positions[i], sizeof query.position);
        memcpy(query.normal, f->normals[i], sizeof query.normal);
        query.k = 1;
        query.max_radius = (float)reach;
        query.front_only = true;
        ck_assert_int_eq(pm_map_search(f->map, &query, &f->want[i], 1, &found), PM_OK);
        if (!found)
            f->want[i].number = UINT32_MAX;
    }
}

/* What all threads have in common; each task asks for all points. */
typedef struct asking {
    fixture *f;
    pm__nearest *nearest;
    _Atomic size_t wrong, none;
} asking;

static void ask_all(void *argument, size_t task)
{
    asking *const a = argument;
    for (size_t first = 0; first < POINTS; first += PM__NEAREST_AT_ONCE) {
        pm_neighbor found[PM__NEAREST_AT_ONCE];
        const size_t rest = POINTS - first, some = rest < PM__NEAREST_AT_ONCE ? rest : PM__NEAREST_AT_ONCE;
        const float(*const positions)[3] = (const float(*)[3])a->f->positions + first;
        pm__nearest_find(a->nearest, positions, (const float(*)[3])a->f->normals + first, some, found);
        for (size_t i = 0; i < some; i++) {
            const pm_neighbor *const want = &a->f->want[first + i];
            const bool none = want->number == UINT32_MAX;
            a->wrong += found[i].number != want->number || (!none && found[i].distance2 != want->distance2);
            a->none += none;
        }
    }
    (void)task;
}

static void check(int kind, size_t count, double reach, double spacing, size_t thread_count)
{
    static fixture f;
    size_t threads = thread_count;
    const pm_parallel parallel = pm__parallel_for(&threads);
    set_up(kind, count, reach, &f);
    asking a = {.f = &f};
    ck_assert_int_eq(pm__nearest_create(f.map, reach, spacing, &a.nearest), PM_OK);
    if (thread_count > 1)
        parallel.run(parallel.context, ROUNDS, ask_all, &a);
    for (size_t i = 0; i < ROUNDS && thread_count == 1; i++)
        ask_all(&a, i);
    ck_assert_msg(a.wrong == 0, "kind %d, %zu photons, reach %g, spacing %g: %zu of %d differ", kind, count, reach,
                  spacing, (size_t)a.wrong, ROUNDS * POINTS);
    ck_assert_msg(reach < 1.0 || a.none < (size_t)ROUNDS * POINTS, "kind %d: there is none for any point", kind);
    pm__nearest_destroy(a.nearest);
    pm_map_destroy(f.map);
}

START_TEST(the_nearest_of_all)
{
    const size_t count = _i == FEW ? 3 : 4000;
    check(_i, count, 100.0, 0.02, 1);
    check(_i, count, 100.0, 0.3, 1);  /* lists too long for the first cells */
    check(_i, count, 0.05, 0.02, 1);  /* many have none within reach */
    check(_i, count, 1e-3, 1e-5, 1);  /* cells of which each point has its own */
    check(_i, count, 100.0, 10.0, 1); /* long for all cells */
}
END_TEST

START_TEST(threads_that_meet)
{
    check(HEAP, 4000, 100.0, 0.1, 3);
    check(ROUND, 4000, 100.0, 0.1, 3);
}
END_TEST

/* What is no point has no nearest photon, nor a place in the table. */
START_TEST(what_is_not_finite)
{
    static fixture f;
    static const float bad[] = {NAN, INFINITY, -INFINITY, 3e38f};
    pm__nearest *nearest;
    set_up(FLAT, 100, 10.0, &f);
    ck_assert_int_eq(pm__nearest_create(f.map, 10.0, 0.1, &nearest), PM_OK);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        for (int a = 0; a < 3; a++)
            for (int round = 0; round < ROUNDS; round++) {
                float positions[2][3] = {{0.5f, 0.5f, 0.0f}, {0.5f, 0.5f, 0.0f}};
                float normals[2][3] = {{0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 1.0f}};
                pm_neighbor found[2];
                positions[0][a] = bad[i];
                normals[1][a] = i < 3 ? bad[i] : 0.0f;
                normals[1][2] = i < 3 ? normals[1][2] : 0.0f;
                pm__nearest_find(nearest, (const float(*)[3])positions, (const float(*)[3])normals, 2, found);
                ck_assert_uint_eq(found[0].number, UINT32_MAX);
                ck_assert_uint_eq(found[1].number, UINT32_MAX);
            }
    pm__nearest_destroy(nearest);
    pm__nearest_destroy(NULL);
    pm_map_destroy(f.map);
}
END_TEST

int main(void)
{
    Suite *const suite = suite_create("nearest");
    TCase *const tcase = tcase_create("nearest");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, the_nearest_of_all, 0, KINDS);
    tcase_add_test(tcase, threads_that_meet);
    tcase_add_test(tcase, what_is_not_finite);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
