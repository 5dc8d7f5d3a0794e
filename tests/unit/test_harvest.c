/* Photons gathered from made-up paths: path n stores so many, each of which says whose it is. What is taken is compared
 * with paths taken one by one; on threads, some of which lag behind. */
#include "../../src/transport/shares.h"
#include "../test.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { BLOCK = 512, THREADS = 3 };

/* ---- Ways to run ------------------------------------------------------------------------------- */

static void run_backwards(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    (void)context;
    while (count-- > 0)
        task(argument, count);
}

typedef struct crew {
    void (*task)(void *argument, size_t index);
    void *argument;
    size_t count;
    _Atomic size_t next;
} crew;

static void *labour(void *context)
{
    crew *const c = context;
    for (size_t i; (i = c->next++) < c->count;)
        c->task(c->argument, i);
    return NULL;
}

static void run_threads(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    crew c = {task, argument, count, 0};
    pthread_t threads[THREADS];
    (void)context;
    for (int i = 0; i < THREADS; i++)
        ck_assert_int_eq(pthread_create(&threads[i], NULL, labour, &c), 0);
    for (int i = 0; i < THREADS; i++)
        ck_assert_int_eq(pthread_join(threads[i], NULL), 0);
}

static const pm_parallel backwards = {run_backwards, NULL}, threads = {run_threads, NULL};
static const pm_parallel *const ways[] = {NULL, &backwards, &threads};
enum { WAYS = 3 };

/* ---- Paths ------------------------------------------------------------------------------------- */

typedef struct made_up {
    size_t (*stores)(uint64_t path);
    uint64_t slow, huge; /* paths: one of a block that takes its time, and one whose photons no float holds */
} made_up;

static size_t stores_few(uint64_t path)
{
    return path * 2654435761U % 4;
}

static size_t stores_next_to_none(uint64_t path)
{
    return path == 700 ? 2 : 0;
}

/* A thousand times as many in the end as in the beginning. */
static size_t stores_more_and_more(uint64_t path)
{
    return path < 10000 ? path % 100 == 0 : path < 12000 ? 3 : path == 14999 ? 1000 : path % 128;
}

static size_t stores_all_it_may(uint64_t path)
{
    (void)path;
    return PM__LONGEST_PATH;
}

static pm__stored photon_of(const made_up *paths, uint64_t path, size_t i)
{
    const double power = path == paths->huge ? 1e39 : i == 1 ? 0.0 : 1.0 + (double)(path % 7);
    return (pm__stored){.position = {(double)(path >> 16), (double)(path & 0xffff), (double)i},
                        .direction = {(double)(path % 3), 0.0, 1.0},
                        .normal = {0.0, (double)(path % 5), (double)i},
                        .power = {power, i == 1 ? 0.0 : 0.5, 0.0}};
}

static void trace(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    const made_up *const paths = tracing;
    const struct timespec while_others_go_on = {.tv_nsec = 50000000};
    if (paths->slow - first < count)
        (void)nanosleep(&while_others_go_on, NULL);
    for (uint64_t path = first; path < first + count; path++)
        for (size_t i = 0; i < paths->stores(path); i++) {
            const pm__stored stored = photon_of(paths, path, i);
            if (!store(context, path, &stored))
                return;
        }
}

static const made_up few = {stores_few, UINT64_MAX, UINT64_MAX};

/* ---- One by one -------------------------------------------------------------------------------- */

static bool same_vector(const float a[3], const double b[3], double factor)
{
    return a[0] == (float)(factor * b[0]) && a[1] == (float)(factor * b[1]) && a[2] == (float)(factor * b[2]);
}

static bool is_photon(const pm__harvest *h, const pm__harvest_wish *wish, size_t at, uint64_t path, size_t i)
{
    const made_up *const paths = wish->tracing;
    const pm__stored stored = photon_of(paths, path, i);
    const unsigned first = i == 0 ? PM__FIRST_OF_PATH : 0, dark = i == 1 ? PM__NO_POWER : 0;
    const unsigned mark = (unsigned)paths->stores(path) | first | dark;
    return same_vector(h->photons[at].position, stored.position, 1.0) &&
           same_vector(h->photons[at].direction, stored.direction, 1.0) &&
           same_vector(h->photons[at].power, stored.power, wish->share > 0.0 ? wish->share : 1.0 / h->unit) &&
           (!h->normals || same_vector(h->normals[at], stored.normal, 1.0)) && (!h->marks || h->marks[at] == mark);
}

static void check_harvest(const pm__harvest *h, const pm__harvest_wish *wish)
{
    const made_up *const paths = wish->tracing;
    uint64_t emitted = 0;
    size_t count = 0, right = 0;
    for (; emitted < wish->most && count < wish->wanted; emitted++)
        for (size_t i = 0; i < paths->stores(wish->first + emitted); i++, count++)
            right += count < h->count && is_photon(h, wish, count, wish->first + emitted, i);
    ck_assert_uint_eq(h->count, count);
    ck_assert_uint_eq(right, count);
    ck_assert_uint_eq(h->emitted, emitted);
}

static void gather_all_ways(const pm__harvest_wish *wish, bool normals)
{
    for (int way = 0; way < WAYS; way++) {
        const pm__shoot_config config = {.normals = normals, .parallel = ways[way]};
        pm__harvest h;
        pm_error error;
        PM_CHECK_OK(pm__harvest_paths(&config, wish, &h, &error), error);
        ck_assert(!h.normals == !normals && !h.marks == !wish->marks);
        check_harvest(&h, wish);
        pm__harvest_free(&h);
        ck_assert(!h.photons && !h.normals && !h.marks && h.count == 0);
    }
}

START_TEST(test_all_paths_in_their_order)
{
    static const uint64_t paths[] = {1, 2, BLOCK, BLOCK + 1, 3 * BLOCK - 1, 100000};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        const pm__harvest_wish wish = {.tracer = trace, .tracing = &few, .power = 3.0, .share = i % 2 ? 0.25 : 0.0,
                                       .first = 1000 * i, .most = paths[i], .wanted = SIZE_MAX, .marks = i % 3};
        gather_all_ways(&wish, i % 2);
    }
}
END_TEST

/* No path more than it takes, wherever that one lies, and the last one as a whole. */
START_TEST(test_as_many_photons_as_wanted)
{
    for (size_t wanted = 1; wanted < 50000; wanted = wanted < 4 ? wanted + 1 : wanted * 5 / 3) {
        pm__harvest_wish wish = {.tracer = trace, .tracing = &few, .power = 3.0, .first = wanted,
                                 .most = PM__MOST_TRACED, .wanted = wanted, .marks = true};
        gather_all_ways(&wish, wanted % 2);
        wish.most = wanted / 2 + 1;
        gather_all_ways(&wish, false);
    }
}
END_TEST

/* The arrays must grow where it is not foreseen, also by what one block stores. */
START_TEST(test_room_for_more_than_expected)
{
    static const made_up paths = {stores_more_and_more, UINT64_MAX, UINT64_MAX};
    for (uint64_t most = 9000; most <= 27000; most += 3000) {
        const pm__harvest_wish wish = {.tracer = trace, .tracing = &paths, .power = 3.0, .most = most,
                                       .wanted = SIZE_MAX, .marks = true};
        gather_all_ways(&wish, true);
    }
}
END_TEST

/* Others finish what lies ahead of a slow thread, until there is too much of it. */
START_TEST(test_a_thread_that_lags_behind)
{
    for (uint64_t slow = 0; slow < 40 * BLOCK; slow += 13 * BLOCK) {
        const made_up paths = {stores_few, slow, UINT64_MAX};
        const pm__harvest_wish wish = {.tracer = trace, .tracing = &paths, .power = 3.0, .most = 400000,
                                       .wanted = slow % 2 ? SIZE_MAX : 500000};
        gather_all_ways(&wish, false);
    }
}
END_TEST

/* Given up behind the first block by which more than 100000 paths were traced for each photon and for ten. */
START_TEST(test_in_vain)
{
    static const made_up paths = {stores_next_to_none, UINT64_MAX, UINT64_MAX};
    for (int way = 0; way < WAYS; way++) {
        const pm__shoot_config config = {.parallel = ways[way]};
        const pm__harvest_wish wish = {.tracer = trace, .tracing = &paths, .power = 3.0, .most = PM__MOST_TRACED,
                                       .wanted = 3};
        pm__harvest h;
        pm_error error;
        PM_CHECK_OK(pm__harvest_paths(&config, &wish, &h, &error), error);
        ck_assert_uint_eq(h.count, 2);
        ck_assert_uint_eq(h.emitted, 1200000 / BLOCK * BLOCK + BLOCK);
        pm__harvest_free(&h);
    }
}
END_TEST

/* ---- What ends it ------------------------------------------------------------------------------ */

static void check_fails(const pm__shoot_config *config, const pm__harvest_wish *wish, pm_status expected,
                        const char *text)
{
    pm__harvest h;
    pm_error error = {""};
    ck_assert_int_eq(pm__harvest_paths(config, wish, &h, &error), expected);
    ck_assert_msg(strstr(error.text, text), "'%s' does not say '%s'", error.text, text);
    ck_assert(!h.photons && !h.normals && !h.marks && h.count == 0);
}

static bool is_canceled(void *context)
{
    _Atomic int *const left = context;
    return (*left)-- <= 0;
}

/* On one thread behind exactly the blocks before; on more behind some of them. */
START_TEST(test_canceled_in_the_middle)
{
    for (int asked = 0; asked < 300; asked = 2 * asked + 1)
        for (int way = 0; way < WAYS; way++) {
            _Atomic int left = asked;
            size_t behind = 0;
            char text[80] = "canceled behind ";
            const pm__shoot_config config = {.normals = true, .parallel = ways[way], .canceled = is_canceled,
                                             .context = &left};
            const pm__harvest_wish wish = {.tracer = trace, .tracing = &few, .power = 3.0, .most = 400000,
                                           .wanted = asked % 2 ? SIZE_MAX : 500000};
            for (uint64_t path = 0; path < (uint64_t)asked * BLOCK; path++)
                behind += stores_few(path);
            if (ways[way] != &threads)
                (void)snprintf(text, sizeof text, "canceled behind %zu stored", behind);
            check_fails(&config, &wish, PM_ECANCELED, text);
        }
}
END_TEST

/* Nobody asks what lies behind the last photon wanted. */
START_TEST(test_canceled_too_late)
{
    for (int way = 0; way < 2; way++) {
        _Atomic int left = 3;
        const pm__shoot_config config = {.parallel = ways[way], .canceled = is_canceled, .context = &left};
        const pm__harvest_wish wish = {.tracer = trace, .tracing = &few, .power = 3.0, .most = PM__MOST_TRACED,
                                       .wanted = 2 * BLOCK};
        pm__harvest h;
        pm_error error;
        PM_CHECK_OK(pm__harvest_paths(&config, &wish, &h, &error), error);
        check_harvest(&h, &wish);
        pm__harvest_free(&h);
    }
}
END_TEST

START_TEST(test_power_of_floats)
{
    for (int way = 0; way < WAYS; way++) {
        const made_up paths = {stores_few, UINT64_MAX, 20001};
        const pm__shoot_config config = {.parallel = ways[way]};
        const pm__harvest_wish wish = {.tracer = trace, .tracing = &paths, .power = 1e20, .share = 0.5,
                                       .most = 50000, .wanted = SIZE_MAX};
        check_fails(&config, &wish, PM_EINVAL, "a photon of 5e+38 W is more than a float holds");
    }
}
END_TEST

/* Address space that is left, in bytes. Sanitizers need theirs. */
static bool limit_memory(size_t bytes)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
    (void)bytes;
    return false;
#else
    size_t pages = 0;
    FILE *const file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%zu", &pages) != 1)
        return false;
    (void)fclose(file);
    const struct rlimit limit = {pages * 4096 + bytes, RLIM_INFINITY};
    return setrlimit(RLIMIT_AS, &limit) == 0;
#endif
}

/* For what a block stores, for what is wanted at once, and for what the paths turn out to store. */
START_TEST(test_out_of_memory)
{
    static const made_up most = {stores_all_it_may, UINT64_MAX, UINT64_MAX};
    static const made_up more = {stores_more_and_more, UINT64_MAX, UINT64_MAX};
    const pm__harvest_wish wishes[] = {
        {.tracer = trace, .tracing = &most, .power = 3.0, .most = BLOCK, .wanted = SIZE_MAX},
        {.tracer = trace, .tracing = &few, .power = 3.0, .most = PM__MOST_TRACED, .wanted = 10000000},
        {.tracer = trace, .tracing = &more, .power = 3.0, .most = 200000, .wanted = SIZE_MAX, .marks = true}};
    static const size_t bytes[] = {10000000, 100000000, 100000000};
    static const char *const texts[] = {"out of memory behind 0 stored photons",
                                        "out of memory behind 0 stored photons", "out of memory behind "};
    for (int i = 0; i < 3; i++)
        for (int way = 0; way < 2; way++) {
            const pm__shoot_config config = {.normals = i == 2, .parallel = ways[way]};
            if (limit_memory(bytes[i]))
                check_fails(&config, &wishes[i], PM_ENOMEM, texts[i]);
        }
}
END_TEST

/* ---- Shares ------------------------------------------------------------------------------------ */

/* A harvest of `long_paths` of PM__LONGEST_PATH photons at its end, and before them single photons: photon i has
 * position i. */
static pm__harvest row_of(size_t singles, size_t long_paths)
{
    const size_t count = singles + long_paths * PM__LONGEST_PATH;
    pm__harvest h = {.photons = malloc(count * sizeof *h.photons), .normals = malloc(count * sizeof *h.normals),
                     .marks = malloc(count * sizeof *h.marks), .count = count, .emitted = 2 * (singles + long_paths),
                     .unit = 2.0};
    for (size_t i = 0; i < count; i++) {
        const bool single = i < singles;
        const bool first = single || (i - singles) % PM__LONGEST_PATH == 0;
        h.photons[i] = (pm_photon){{(float)i, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {1.0f, (float)(i % 3), 0.5f}};
        memcpy(h.normals[i], h.photons[i].position, sizeof h.normals[i]);
        h.marks[i] = (uint16_t)((first ? PM__FIRST_OF_PATH : 0) | (single ? 1 : PM__LONGEST_PATH));
    }
    return h;
}

/* So many in the order in which they came, each with the share of its path (shares.c). */
static void check_shares(const pm__harvest *h, size_t wanted, size_t singles, size_t long_paths)
{
    const size_t over = singles + long_paths * PM__LONGEST_PATH - wanted;
    const double longer = (double)(over ? long_paths : long_paths + singles);
    const double share = 2.0 * (double)(wanted + over) / (double)wanted / (2.0 * (double)(singles + long_paths) - 1.0);
    size_t dropped = 0, right = 0;
    ck_assert_uint_eq(h->count, wanted);
    for (size_t i = 0; i < wanted; i++) {
        const size_t from = (size_t)h->photons[i].position[0];
        const double each = from < singles && over ? share : share * (1.0 - 1.0 / longer);
        right += from >= i + dropped && fabs((double)h->photons[i].power[0] - each) <= 1e-7 * each &&
                 fabs((double)h->photons[i].power[1] - (double)(from % 3) * each) <= 3e-7 * each &&
                 h->normals[i][0] == h->photons[i].position[0];
        dropped = from - i;
    }
    ck_assert_uint_eq(right, wanted);
    ck_assert_uint_le(dropped, over);
}

static bool same(const pm__harvest *a, const pm__harvest *b)
{
    return a->count == b->count && !memcmp(a->photons, b->photons, a->count * sizeof *a->photons) &&
           !memcmp(a->normals, b->normals, a->count * sizeof *a->normals);
}

/* By any number, across the ends of pieces of photons that are moved at once, whichever of them is moved first. */
START_TEST(test_photons_too_many_are_left_out)
{
    static const size_t overs[] = {0, 1, 2, 17, 500, PM__LONGEST_PATH - 1};
    for (size_t singles = 3; singles < 40000; singles = singles * 23 + 1)
        for (size_t i = 0; i < sizeof overs / sizeof *overs; i++) {
            pm__harvest made[WAYS];
            const size_t long_paths = 1 + i % 2, wanted = singles + long_paths * PM__LONGEST_PATH - overs[i];
            for (int way = 0; way < WAYS; way++) {
                const pm__shoot_config config = {.seed = singles, .count = wanted, .parallel = ways[way]};
                pm_error error;
                made[way] = row_of(singles, long_paths);
                PM_CHECK_OK(pm__share_wanted(&config, &made[way], 1.0, &error), error);
                check_shares(&made[way], wanted, singles, long_paths);
                ck_assert(same(&made[0], &made[way]));
            }
            for (int way = 0; way < WAYS; way++)
                pm__harvest_free(&made[way]);
        }
}
END_TEST

/* Of a thousand photons one is left, any of them as likely: in 2000 runs the mean of its number is within 5 deviations,
 * and the least and the greatest are among the outermost 7 (else: (1 - 0.007)^2000 = 8e-7). */
START_TEST(test_any_photon_is_left_out)
{
    enum { RUNS = 2000 };
    double sum = 0.0, least = PM__LONGEST_PATH, greatest = 0.0;
    for (uint64_t seed = 0; seed < RUNS; seed++) {
        const pm__shoot_config config = {.seed = seed, .count = 1};
        pm__harvest h = row_of(0, 1);
        pm_error error;
        h.emitted = 1;
        PM_CHECK_OK(pm__share_wanted(&config, &h, 1.0, &error), error);
        const double left = (double)h.photons[0].position[0];
        sum += left;
        least = fmin(least, left);
        greatest = fmax(greatest, left);
        pm__harvest_free(&h);
    }
    PM_CHECK_NEAR(sum / RUNS, 499.5, 5.0 * sqrt((1e6 - 1.0) / 12.0 / RUNS));
    ck_assert_msg(least <= 6.0 && greatest >= 993.0, "%g to %g", least, greatest);
}
END_TEST

START_TEST(test_shares_of_floats)
{
    for (int way = 0; way < WAYS; way++) {
        const pm__shoot_config config = {.count = 20000, .parallel = ways[way]};
        pm__harvest h = row_of(20000, 0);
        pm_error error;
        h.unit = 1e38;
        ck_assert_int_eq(pm__share_alike(&config, &h, 5.0, &error), PM_EINVAL);
        ck_assert_ptr_nonnull(strstr(error.text, "more W than a float holds"));
        ck_assert_int_eq(pm__share_wanted(&config, &h, 1e-34, &error), PM_EINVAL);
        ck_assert_ptr_nonnull(strstr(error.text, "less than a float holds"));
        pm__harvest_free(&h);
    }
}
END_TEST

/* A room is of photons alone: what else is wished has memory of its own, and all of it. */
START_TEST(test_numbers_beside_a_room)
{
    pm__photon_room room = {NULL, 0};
    pm__harvest_wish wish = {.tracer = trace, .tracing = &few, .power = 1.0, .share = 1.0, .most = 5000,
                             .wanted = SIZE_MAX};
    const pm__shoot_config config = {.room = &room};
    pm_error error;
    pm__harvest h;
    PM_CHECK_OK(pm__harvest_paths(&config, &wish, &h, &error), error);
    ck_assert(h.photons == room.photons && room.capacity >= h.count);
    wish.numbers = true;
    PM_CHECK_OK(pm__harvest_paths(&config, &wish, &h, &error), error);
    ck_assert_ptr_nonnull(h.numbers);
    ck_assert(h.photons != room.photons);
    for (size_t i = 0; i < h.count; i++)
        ck_assert(h.photons[i].position[1] == (float)(h.numbers[i] & 0xffff));
    pm__harvest_free(&h);
    free(room.photons);
}
END_TEST

PM_TEST_MAIN("harvest", test_all_paths_in_their_order, test_as_many_photons_as_wanted,
             test_room_for_more_than_expected, test_a_thread_that_lags_behind, test_in_vain,
             test_canceled_in_the_middle, test_canceled_too_late, test_power_of_floats, test_out_of_memory,
             test_photons_too_many_are_left_out, test_any_photon_is_left_out, test_shares_of_floats,
             test_numbers_beside_a_room)
