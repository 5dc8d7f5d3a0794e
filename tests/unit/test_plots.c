/* Plots: where photons are counted and power waits. Areas and sizes against their definitions, the table against a
 * list, and what density stores against a plain loop over all arrivals, one by one. */
#include "../../src/base/random.h"
#include "../../src/transport/plots.h"
#include "../policies.h"

enum { NEIGHBORS = 20 };

static const double pi = 3.14159265358979323846;

static pm__plots made(double usual, double least, double across)
{
    static const double low[3] = {-1.0, -2.0, 3.0};
    pm__plots plots;
    pm__plots_init(&plots, NEIGHBORS, usual, least, low, across, 0, false);
    return plots;
}

static pm_photon at(double x, double y, double z)
{
    return (pm_photon){.position = {(float)x, (float)y, (float)z}, .direction = {0.0f, 0.0f, -1.0f}};
}

static pm__plot_place place_of(const pm__plots *plots, const pm_photon *photon, const float normal[3], double required)
{
    const float wanted = (float)required;
    const unsigned char important = 0;
    pm__plot_place place;
    pm__plots_place(plots, photon, (const float(*)[3])normal, &wanted, &important, 1, &place);
    return place;
}

/* Of a flat plot from M / 4 to all of M are required, M / 2 of one of the usual density. */
START_TEST(test_sizes)
{
    static const float up[3] = {0.0f, 0.0f, 1.0f};
    pm__plots plots = made(1000.0, 10.0, 10.0);
    const pm_photon photon = at(0.3, 0.4, 5.0);
    for (double required = 10.0; required < 1e5; required *= 1.037) {
        const pm__plot_place place = place_of(&plots, &photon, up, required);
        PM_CHECK_NEAR((double)place.wanted, required * (double)place.area, 2e-5 * (double)place.wanted);
        ck_assert(place.wanted > 0.2499f * NEIGHBORS && place.wanted < 1.0001f * NEIGHBORS);
    }
    PM_CHECK_NEAR((double)place_of(&plots, &photon, up, 1000.0).wanted, 0.5 * NEIGHBORS, 1e-3);
    pm__plots_free(&plots);
}
END_TEST

/* Tilted, the piece in a square's column is larger by one over the cosine. */
START_TEST(test_tilted)
{
    pm__plots plots = made(1000.0, 10.0, 10.0);
    const pm_photon photon = at(0.3, 0.4, 5.0);
    for (int i = 0; i < 40; i++) {
        const double angle = pi / 160.0 * i;
        const float normal[3] = {(float)sin(angle), 0.0f, (float)-cos(angle)};
        PM_CHECK_NEAR((double)place_of(&plots, &photon, normal, 1000.0).area, 0.01 / cos(angle), 1e-6);
    }
    pm__plots_free(&plots);
}
END_TEST

/* Two points of a plane have one plot where, and only where, they lie in one square; normals and importance tell. */
START_TEST(test_squares)
{
    static const float up[3] = {0.0f, 0.0f, 1.0f}, down[3] = {0.0f, 0.0f, -1.0f};
    pm__plots plots = made(1000.0, 10.0, 10.0);
    const double edge = 0.1, offset = (double)plots.frame.offset;
    const pm_photon middle = at(0.3, 0.4, 3.0);
    const uint64_t key = place_of(&plots, &middle, up, 1000.0).key;
    ck_assert(key != place_of(&plots, &middle, down, 1000.0).key);
    for (int i = 0; i < 4000; i++) {
        double u[2];
        pm__random_uniform(5, PM__FOR_TESTS, 0, (uint64_t)i, u, 2);
        const double x = 0.2 + 0.2 * u[0], y = 0.3 + 0.2 * u[1];
        const pm_photon photon = at(x, y, 3.0);
        const bool same = floor((x + 1.0 + offset) / edge) == floor((1.3 + offset) / edge) &&
                          floor((y + 2.0 + offset) / edge) == floor((2.4 + offset) / edge);
        ck_assert_msg(same == (place_of(&plots, &photon, up, 1000.0).key == key), "%g %g", x, y);
    }
    pm__plots_free(&plots);
}
END_TEST

/* What is counted in another size too is counted there by the same thread. */
START_TEST(test_beside)
{
    static const float normals[3][3] = {{0.0f, 0.0f, 1.0f}, {0.6f, 0.0f, -0.8f}, {-0.64f, 0.6f, 0.48f}};
    pm__plots plots = made(1000.0, 20.0, 10.0);
    size_t finer = 0, coarser = 0;
    for (int i = 0; i < 6000; i++) {
        double u[4];
        pm__random_uniform(6, PM__FOR_TESTS, 0, (uint64_t)i, u, 4);
        const pm_photon photon = at(5.0 * u[0], 5.0 * u[1], 3.0 + 5.0 * u[2]);
        const double required = 20.0 * pow(5000.0, u[3]);
        const float *const normal = normals[i % 3];
        const pm__plot_place place = place_of(&plots, &photon, normal, required);
        const uint64_t key = place.key, beside = place.beside;
        if (!beside)
            continue;
        ck_assert_uint_eq(pm__plot_shard_of(&plots, key), place.shard);
        ck_assert_uint_eq(pm__plot_shard_of(&plots, beside), place.shard);
        finer += beside >> 60 < key >> 60;
        coarser += beside >> 60 > key >> 60;
    }
    ck_assert_uint_gt(finer, 500);
    ck_assert_uint_gt(coarser, 500);
    pm__plots_free(&plots);
}
END_TEST

START_TEST(test_table)
{
    enum { KEYS = 3000 };
    pm__plots plots = made(1000.0, 10.0, 10.0);
    pm__plot_shard copy;
    for (uint64_t key = 1; key <= KEYS; key++)
        for (int twice = 0; twice < 2; twice++) {
            pm__plot *const plot = pm__plot_add(&plots, 3, key);
            ck_assert_ptr_nonnull(plot);
            plot->stored += (uint32_t)key;
        }
    ck_assert_uint_eq(plots.shards[3].count, KEYS);
    ck_assert(pm__plot_shard_copy(&plots.shards[3], &copy) == PM_OK);
    for (uint64_t key = 1; key <= KEYS; key++) {
        ck_assert_uint_eq(pm__plot_find(&plots.shards[3], key)->stored, 2 * key);
        ck_assert_uint_eq(pm__plot_find(&copy, key)->stored, 2 * key);
    }
    ck_assert_uint_eq(pm__plot_find(&copy, KEYS + 1)->key, 0);
    pm__plot_shard_free(&copy);
    pm__plots_free(&plots);
}
END_TEST

/* Of a plot that ends at a third of its square: (n - 1) / (n + 1) of it is spanned on average, so what is told of it is
 * right on average. Bound: 6 standard errors. */
START_TEST(test_filled)
{
    enum { TRIALS = 4000, CAME = 12 };
    double sum = 0.0, square = 0.0;
    for (int trial = 0; trial < TRIALS; trial++) {
        pm__plot plot = {.key = 1, .box = {UINT8_MAX, 0, UINT8_MAX, 0}};
        for (int i = 0; i < CAME; i++) {
            double u[2];
            pm__random_uniform(7, PM__FOR_TESTS, (uint32_t)trial, (uint64_t)i, u, 2);
            const uint8_t where[2] = {(uint8_t)(256.0 * (0.25 + u[0] / 3.0)), (uint8_t)(256.0 * (0.1 + u[1] / 2.0))};
            pm__plot_meet(&plot, 2.0f, where);
        }
        const double filled = (double)pm__plot_filled(&plot);
        PM_CHECK_NEAR((double)pm__plot_wanted(&plot), 2.0 * filled, 1e-6);
        sum += filled / TRIALS;
        square += filled * filled / TRIALS;
    }
    PM_CHECK_NEAR(sum, 1.0 / 6.0, 6.0 * sqrt((square - sum * sum) / TRIALS) + 0.004); /* 256ths, and whole ones */
}
END_TEST

/* ---- One by one --------------------------------------------------------------------------------- */

typedef struct plain {
    uint64_t key;
    double waiting[3];
    pm__plot counts;     /* what came */
    size_t stored, takers;
} plain;

static plain *plain_of(plain *list, size_t *count, uint64_t key)
{
    size_t i = 0;
    while (i < *count && list[i].key != key)
        i++;
    if (i == *count) {
        list[i] = (plain){.key = key, .counts = {.box = {UINT8_MAX, 0, UINT8_MAX, 0}}};
        ++*count;
    }
    return &list[i];
}

/* The floor's density rule by hand: normals are all up, so each photon that comes from above faces all others. */
static void check_one_by_one(double constant, const char *policy)
{
    static const double low[3] = {-1.5, -1.5, 0.0};
    policed p = policed_floor(1.0);
    const pm__spec spec = policed_spec(policy);
    pm__stored_photons all = policed_store(&p, "all", PM__GLOBAL_MAP, 40000, 1);
    pm__stored_photons set = policed_store(&p, policy, PM__GLOBAL_MAP, 40000, 1);
    const double mean = pm__importance_mean(p.importance, PM__GLOBAL_MAP), wish = constant > 0.0 ? constant : mean;
    const double usual = constant > 0.0 ? constant : pm__policy_required(&spec, PM__GLOBAL_MAP, p.importance, mean);
    const double least = constant > 0.0 ? constant : pm__policy_required(&spec, PM__GLOBAL_MAP, p.importance, 0.0);
    plain *const list = calloc(all.count, sizeof *list);
    uint64_t *const keys = calloc(all.count, sizeof *keys);
    size_t plots_count = 0, stored = 0;
    pm__plots plots;
    ck_assert(wish > 0.0 && list && keys);
    pm__plots_init(&plots, NEIGHBORS, usual, least, low, sqrt(9.0 + 9.0 + 0.0625), 0, false);
    for (size_t i = 0; i < all.count; i++) {
        const float(*const normal)[3] = (const float(*)[3])all.normals[i];
        float importance;
        pm__plot_place place;
        pm__importance_at(p.importance, PM__GLOBAL_MAP, (const float(*)[3])all.photons[i].position, normal, 1,
                          &importance);
        const float required =
            (float)pm__policy_required(&spec, PM__GLOBAL_MAP, p.importance, (double)importance);
        const unsigned char part =
            (double)importance >= pm__importance_threshold(p.importance, PM__GLOBAL_MAP);
        pm__plots_place(&plots, &all.photons[i], normal, &required, &part, 1, &place);
        plain *own = plain_of(list, &plots_count, place.key);
        pm__plot_meet(&own->counts, place.wanted, place.at);
        if (own->takers > 0 && (float)own->stored >= pm__plot_wanted(&own->counts)) {
            for (int b = 0; b < 3; b++)
                own->waiting[b] += (double)all.photons[i].power[b];
            continue;
        }
        own->stored++;
        own->takers++;
        if (place.beside && !(constant > 0.0))
            plain_of(list, &plots_count, place.beside)->stored++;
        ck_assert_uint_lt(stored, set.count);
        ck_assert(!memcmp(set.photons[stored].position, all.photons[i].position, sizeof set.photons[0].position));
        keys[stored++] = place.key;
        all.photons[stored - 1] = all.photons[i];
    }
    ck_assert_uint_eq(stored, set.count);
    ck_assert_uint_lt(stored, all.count / 2);
    for (size_t i = 0; i < stored; i++) {
        const plain *const own = plain_of(list, &plots_count, keys[i]);
        for (int b = 0; b < 3; b++) {
            const double expected = (double)all.photons[i].power[b] + own->waiting[b] / (double)own->takers;
            PM_CHECK_NEAR((double)set.photons[i].power[b], expected, 1e-6 * expected);
        }
    }
    free(list);
    free(keys);
    pm__plots_free(&plots);
    pm__stored_photons_free(&all);
    pm__stored_photons_free(&set);
    policed_free(&p);
}

START_TEST(test_one_by_one)
{
    check_one_by_one(400.0, "density:constant=400");
    check_one_by_one(0.0, "density:global=0.2");
}
END_TEST

PM_TEST_MAIN("plots", test_sizes, test_tilted, test_squares, test_beside, test_table, test_filled, test_one_by_one)
