/* Voxels about photons, what is near them, and whom strays meet: against brute force, for photons that lie in space, in
 * clusters, in a plane, in one point and far off, by any threads. */
#include "../policies.h"

#include "../../src/base/random.h"
#include "../../src/cli/parallel.h"
#include "../../src/map/map.h"
#include "../../src/transport/stray_places.h"
#include "../../src/transport/surroundings.h"
#include "../../src/transport/vicinity.h"

#include <stdlib.h>

enum { PHOTONS = 6000, EVERY = 50, SIDE = PM__VOXEL_SIDE, ALL = SIDE * SIDE * SIDE, POINTS = 300 };

typedef enum shape { IN_SPACE, IN_CLUSTERS, IN_A_PLANE, IN_ONE_POINT, FAR_OFF, SHAPES } shape;

static pm_photon photons[PHOTONS];
static float normals[PHOTONS][3];
static unsigned char part[PHOTONS];
static uint32_t named[PHOTONS];

static void place_of(shape as, const double u[3], size_t i, double place[3])
{
    for (int a = 0; a < 3; a++) {
        const double cluster = (double)(i % 7 * 37 % 11);
        place[a] = as == IN_CLUSTERS ? cluster * (a + 1) + 0.01 * u[a] * u[a] : 2.0 * u[a];
        place[a] = as == FAR_OFF ? 1e5 * (a + 1) + 100.0 * u[a] : place[a];
        place[a] = as == IN_ONE_POINT ? 0.3 : place[a];
    }
    if (as == IN_A_PLANE)
        place[2] = 0.7;
}

/* Four of five come from above; every 50th carries 10 times the power, those at one side matter. */
static void make_photons(shape as)
{
    for (size_t i = 0; i < PHOTONS; i++) {
        double u[3], place[3];
        pm__random_triple(11, PM__FOR_TESTS, (uint32_t)as, i, 0, u);
        place_of(as, u, i, place);
        const float power = i % EVERY == 7 ? 10.0f / 3.0f : 1.0f / 3.0f, side = i % 5 == 3 ? -1.0f : 1.0f;
        photons[i] = (pm_photon){.position = {(float)place[0], (float)place[1], (float)place[2]},
                                 .direction = {0.0f, 0.0f, -side}, .power = {power, power, power}};
        normals[i][2] = side;
        part[i] = as == IN_ONE_POINT ? i % 3 == 0 : u[0] < 0.3;
    }
}

static void box_of(float low[3], float high[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (size_t i = 0; i < PHOTONS; i++)
            if (part[i]) {
                low[a] = fminf(low[a], photons[i].position[a]);
                high[a] = fmaxf(high[a], photons[i].position[a]);
            }
    }
}

/* The last first. */
static void run_backwards(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    (void)context;
    while (count-- > 0)
        task(argument, count);
}

/* ---- Voxels ------------------------------------------------------------------------------------- */

static void count_one(void *argument, size_t i)
{
    named[i] = pm__voxels_count(argument, photons[i].position, part[i]);
}

static pm__voxels counted(const pm_parallel *parallel)
{
    pm__voxels voxels;
    float low[3], high[3];
    box_of(low, high);
    ck_assert_int_eq(pm__voxels_create(low, high, &voxels), PM_OK);
    parallel->run(parallel->context, PHOTONS, count_one, &voxels);
    pm__voxels_gather(&voxels, parallel);
    return voxels;
}

/* The one it lies in, but for rounding; none if it lies farther than a quarter of the box from it. */
static void check_named(size_t i, const float low[3], const float high[3])
{
    const size_t at[3] = {named[i] % SIDE, named[i] / SIDE % SIDE, named[i] / SIDE / SIDE};
    double widest = 0.0, beyond = -INFINITY;
    for (int a = 0; a < 3; a++)
        widest = fmax(widest, (double)high[a] - (double)low[a]);
    for (int a = 0; a < 3; a++) {
        const double p = (double)photons[i].position[a], edge = 1.5 * widest / SIDE;
        const double eps = 1e-4 * edge + 2e-7 * fabs(p), first = (double)low[a] - 0.25 * widest;
        if (named[i] != PM__OUTSIDE)
            ck_assert(p >= first + (double)at[a] * edge - eps && p <= first + ((double)at[a] + 1.0) * edge + eps);
        beyond = fmax(beyond, fmax(first - p, p - first - 1.5 * widest) + eps);
    }
    ck_assert(named[i] != PM__OUTSIDE || beyond >= 0.0);
    ck_assert(named[i] != PM__OUTSIDE || !part[i]);
}

static void check_counts(const pm__voxels *v)
{
    uint32_t *const expected = calloc(ALL, sizeof *expected);
    unsigned char *const seeds = calloc(ALL, 1);
    ck_assert(expected && seeds);
    for (size_t i = 0; i < PHOTONS; i++)
        if (named[i] != PM__OUTSIDE)
            seeds[named[i]] |= part[i];
    ck_assert(!memcmp((const void *)v->seeds, seeds, ALL));
    for (size_t level = 0, before = 0; level < PM__VOXEL_LEVELS; level++) {
        const size_t side = (size_t)SIDE >> level, all = side * side * side;
        memset(expected, 0, ALL * sizeof *expected);
        for (size_t i = 0; i < PHOTONS; i++)
            if (named[i] != PM__OUTSIDE)
                expected[((named[i] / SIDE / SIDE >> level) * side + (named[i] / SIDE % SIDE >> level)) * side +
                         (named[i] % SIDE >> level)]++;
        ck_assert(!memcmp((const void *)(v->counts + before), expected, all * sizeof *expected));
        before += all;
    }
    free(expected);
    free(seeds);
}

START_TEST(voxels_count)
{
    static size_t three = 3;
    const pm_parallel ways[] = {{run_backwards, NULL}, pm__parallel_for(&three)};
    static const float bad[3][3] = {{NAN, 0.0f, 0.0f}, {0.0f, INFINITY, 0.0f}, {0.0f, 0.0f, -1e30f}};
    float low[3], high[3];
    for (int as = 0; as < SHAPES; as++) {
        make_photons((shape)as);
        for (int w = 0; w < 2; w++) {
            pm__voxels voxels = counted(&ways[w]);
            box_of(low, high);
            for (size_t i = 0; i < PHOTONS; i++)
                check_named(i, low, high);
            check_counts(&voxels);
            for (int i = 0; i < 2 + (as != IN_ONE_POINT); i++) /* of a point alone all finite places are in its voxel */
                ck_assert_uint_eq(pm__voxels_count(&voxels, bad[i], true), PM__OUTSIDE);
            pm__voxels_free(&voxels);
        }
    }
}
END_TEST

/* The least level whose voxel holds enough, of photon i. */
static size_t level_of(size_t i, uint32_t enough)
{
    size_t level = 0;
    for (; level + 1 < PM__VOXEL_LEVELS; level++) {
        size_t count = 0;
        for (size_t j = 0; j < PHOTONS; j++) {
            bool together = named[j] != PM__OUTSIDE;
            for (uint32_t by = 1; by < ALL; by *= SIDE)
                together = together && (named[j] / by % SIDE >> level) == (named[i] / by % SIDE >> level);
            count += together;
        }
        if (count >= enough)
            break;
    }
    return level;
}

static void add_reach(size_t i, size_t level, unsigned char *held)
{
    for (uint32_t at = 0; at < ALL; at++) {
        bool near = true;
        for (uint32_t by = 1; by < ALL && near; by *= SIDE) {
            const int a = (int)(at / by % SIDE >> level), b = (int)(named[i] / by % SIDE >> level);
            near = abs(a - b) <= 1;
        }
        held[at] |= near;
    }
}

START_TEST(reach_spreads)
{
    static const uint32_t enough[] = {1, 12, 1000000};
    const pm_parallel backwards = {run_backwards, NULL};
    pm__reach *const reach = malloc(2 * sizeof *reach);
    unsigned char *const held = malloc(ALL);
    ck_assert(reach && held);
    for (int as = 0; as < SHAPES; as++)
        for (int e = 0; e < 3; e++) {
            make_photons((shape)as);
            for (size_t i = 0; i < PHOTONS; i++) /* few matter; the least corner too */
                part[i] = part[i] && i % 500 < 6;
            pm__voxels voxels = counted(&backwards);
            memset(reach, 0, 2 * sizeof *reach);
            memset(held, 0, ALL);
            pm__reach_mark_all(&voxels, enough[e], &reach[0]);
            for (size_t i = 0; i < PHOTONS; i++)
                if (part[i]) {
                    pm__reach_mark(&voxels, photons[i].position, enough[e], &reach[1]);
                    add_reach(i, level_of(i, enough[e]), held);
                }
            for (int r = 0; r < 2; r++) {
                pm__reach_spread(&reach[r]);
                uint32_t same = 0;
                for (uint32_t at = 0; at < ALL; at++)
                    same += pm__reach_holds(&reach[r], at) == (held[at] != 0);
                ck_assert_uint_eq(same, ALL);
                ck_assert(!pm__reach_holds(&reach[r], PM__OUTSIDE));
            }
            pm__voxels_free(&voxels);
        }
    free(reach);
    free(held);
}
END_TEST

/* ---- Vicinity ----------------------------------------------------------------------------------- */

static double nearest_to(const pm_map *map, const float place[3])
{
    double least = INFINITY;
    for (uint32_t i = 0; i < PHOTONS; i++) {
        float p[3];
        double sum = 0.0;
        pm__position(map, i, p);
        for (int a = 0; a < 3; a++)
            sum += ((double)p[a] - (double)place[a]) * ((double)p[a] - (double)place[a]);
        least = fmin(least, sum);
    }
    return sqrt(least);
}

/* Where nothing is held none lies within reach, and there are such places. */
START_TEST(vicinity_misses_none)
{
    static const double reaches[] = {0.01, 0.06};
    for (int as = 0; as < SHAPES; as++)
        for (int r = 0; r < 2; r++) {
            pm_error error;
            pm_map *map;
            pm__vicinity near_by;
            size_t none = 0;
            make_photons((shape)as);
            PM_CHECK_OK(pm_map_create(photons, PHOTONS, NULL, &map, &error), error);
            ck_assert_int_eq(pm__vicinity_create(map, reaches[r], &near_by), PM_OK);
            for (size_t i = 0; i < POINTS; i++) {
                double u[3];
                float place[3];
                pm__random_triple(13, PM__FOR_TESTS, (uint32_t)r, i, 0, u);
                pm__position(map, (uint32_t)(i * 19), place);
                for (int a = 0; a < 3; a++)
                    place[a] += (float)(reaches[r] * (i % 3 == 0 ? 8.0 : 1.0) * (2.0 * u[a] - 1.0));
                const bool holds = pm__vicinity_holds(&near_by, place);
                ck_assert(holds || nearest_to(map, place) > reaches[r]);
                none += !holds;
            }
            ck_assert_uint_gt(none, 0);
            pm__vicinity_free(&near_by);
            pm_map_destroy(map);
        }
}
END_TEST

/* ---- Whom strays meet --------------------------------------------------------------------------- */

/* Sent evenly a photon has the power 1. In the stock, or put aside. */
static void set_up(pm__storing_config *config, pm__sender *sender, pm__storage *storage, bool aside)
{
    *config = (pm__storing_config){.emitted = PHOTONS, .stored = SIZE_MAX};
    *sender = (pm__sender){.places = malloc(PHOTONS * sizeof(size_t)), .strays = malloc(PHOTONS * sizeof(pm__stray))};
    *storage = (pm__storage){.config = config, .planned = PHOTONS, .unit = 1.0, .sender = sender,
                             .stock = {.photons = photons, .normals = normals, .part = part, .count = PHOTONS}};
    storage->emission.total = 1.0;
    ck_assert(sender->places && sender->strays);
    for (size_t i = 7; i < PHOTONS; i += EVERY) {
        sender->places[sender->place_count++] = i;
        if (aside)
            sender->strays[sender->stray_count++] = pm__stray_of(storage, &photons[i], normals[i], part[i]);
    }
}

static double between(const pm_photon *photon, size_t who)
{
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double d = (double)photon->position[a] - (double)photons[who].position[a];
        sum += d * d;
    }
    return sum;
}

static int by_number(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool is_alike(const pm__stray *stray, size_t who)
{
    return (part[who] != 0) == stray->important && normals[who][2] == stray->normal[2];
}

/* Distances of up to as many as it has parts, of the nearest 16 that came to its side. */
static size_t by_brute_force(const pm__stray *stray, double expected[16])
{
    static struct {
        double distance;
        size_t who;
    } all[PHOTONS];
    size_t count = 0, found = 0;
    for (size_t i = 0; i < PHOTONS; i++)
        if (photons[i].direction[2] * stray->normal[2] < 0.0f) {
            all[count].distance = between(&stray->photon, i);
            all[count++].who = i;
        }
    qsort(all, count, sizeof *all, by_number);
    ck_assert_uint_eq(stray->parts, 5);
    for (size_t i = 0; i < 2 * stray->parts + 6 && found < stray->parts; i++)
        if (is_alike(stray, all[i].who))
            expected[found++] = all[i].distance;
    return found;
}

/* Voxels may hold too few, so that some meet others than their nearest. */
static void check_places(shape as, const pm__stray_places *places)
{
    size_t same = 0, all = 0;
    for (size_t i = 0; i < places->stray_count; i++) {
        const pm__stray *const stray = &places->strays[i];
        double expected[16];
        const size_t count = by_brute_force(stray, expected);
        bool equal = places->count[i] == count;
        ck_assert_uint_le(places->count[i], stray->parts);
        for (size_t n = 0; n < places->count[i]; n++) {
            const uint32_t *const alike = places->alike + places->first[i];
            ck_assert(alike[n] < PHOTONS && is_alike(stray, alike[n]));
            for (size_t m = 0; m < n; m++)
                ck_assert_uint_ne(alike[m], alike[n]);
            equal = equal && between(&stray->photon, alike[n]) == expected[n];
        }
        same += equal;
        all++;
    }
    if (as != IN_ONE_POINT) /* of which which come first is not said */
        ck_assert_msg((double)same >= 0.95 * (double)all, "%d: %zu of %zu", (int)as, same, all);
}

/* Those that matter all are found; others by the voxels that are near. */
static void check_near(const pm__storage *storage, const pm__stray_places *places)
{
    const pm_parallel backwards = {run_backwards, NULL};
    pm__voxels voxels = counted(&backwards);
    pm__reach *const reach = calloc(1, sizeof *reach);
    size_t next = 0;
    ck_assert_ptr_nonnull(reach);
    pm__reach_mark_all(&voxels, 12, reach);
    pm__reach_spread(reach);
    for (size_t i = 0; i < storage->sender->place_count; i++) {
        const size_t place = storage->sender->places[i];
        const bool found = next < places->stray_count && places->strays[next].place == place;
        ck_assert(found || !part[place]);
        ck_assert(found == pm__reach_holds(reach, named[place]));
        next += found;
    }
    ck_assert_uint_eq(next, places->stray_count);
    free(reach);
    pm__voxels_free(&voxels);
}

static bool alike(const pm__stray_places *a, const pm__stray_places *b)
{
    bool same = a->stray_count == b->stray_count;
    for (size_t i = 0; i < a->stray_count && same; i++)
        same = a->strays[i].place == b->strays[i].place && a->first[i] == b->first[i] && a->count[i] == b->count[i] &&
               !memcmp(a->alike + a->first[i], b->alike + b->first[i], a->count[i] * sizeof *a->alike);
    return same;
}

static void check_finding(shape as, bool aside)
{
    static size_t two = 2, three = 3;
    const pm_parallel ways[] = {{run_backwards, NULL}, pm__parallel_for(&two), pm__parallel_for(&three)};
    pm_status (*const find)(pm__storage *, pm__stray_places *) = aside ? pm__find_near_strays
                                                                        : pm__find_near_importance;
    pm__storing_config config;
    pm__sender sender;
    pm__storage storage;
    pm__stray_places serial;
    make_photons(as);
    set_up(&config, &sender, &storage, aside);
    ck_assert_int_eq(find(&storage, &serial), PM_OK);
    ck_assert_uint_gt(serial.stray_count, 20);
    check_places(as, &serial);
    if (!aside)
        check_near(&storage, &serial);
    for (int w = 0; w < 3; w++) {
        pm__stray_places places;
        config.parallel = &ways[w];
        ck_assert_int_eq(find(&storage, &places), PM_OK);
        ck_assert(alike(&serial, &places));
        pm__stray_places_free(&places);
    }
    pm__stray_places_free(&serial);
    free(sender.places);
    free(sender.strays);
}

START_TEST(strays_meet_their_nearest)
{
    for (int as = 0; as < SHAPES; as++)
        for (int aside = 0; aside < 2; aside++)
            check_finding((shape)as, aside);
}
END_TEST

PM_TEST_MAIN("surroundings", voxels_count, reach_spreads, vicinity_misses_none, strays_meet_their_nearest)
