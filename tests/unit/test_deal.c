/* Photons dealt to several maps: none is lost, each map keeps their order, and at random each is as likely as
 * another. */
#include "../../src/transport/deal.h"
#include "../test.h"

enum { COUNT = 20000, MOST = 64 };

/* The photon's number is its power. */
static pm_photon *numbered(size_t count)
{
    pm_photon *const photons = calloc(count ? count : 1, sizeof *photons);
    ck_assert_ptr_nonnull(photons);
    for (size_t i = 0; i < count; i++)
        photons[i] = (pm_photon){.position = {(float)(i % 100), (float)(i / 100), 0.0f},
                                 .direction = {0.0f, 0.0f, -1.0f},
                                 .power = {(float)i, 1.0f, 0.0f}};
    return photons;
}

/* to[i]: the map that has photon i. Sizes of the maps. */
static void deal(const pm__dealing *dealing, size_t count, size_t *to, size_t *sizes)
{
    pm_photon *const photons = numbered(count);
    pm_map *maps[MOST] = {NULL};
    pm_error error = {""};
    PM_CHECK_OK(pm__deal(dealing, photons, count, NULL, maps, &error), error);
    size_t all = 0;
    for (size_t i = 0; i < count; i++)
        to[i] = SIZE_MAX;
    for (size_t m = 0; m < dealing->maps; m++) {
        all += sizes[m] = pm_map_count(maps[m]);
        for (uint32_t n = 0; n < sizes[m]; n++) {
            const size_t photon = (size_t)pm_map_photon(maps[m], n).power[0];
            ck_assert_uint_eq(to[photon], SIZE_MAX);
            to[photon] = m;
        }
        for (uint32_t n = 0; n < sizes[m]; n++) { /* their order: as many of the map before it as its index says */
            size_t before = 0;
            const size_t photon = (size_t)pm_map_photon(maps[m], n).power[0];
            if (n % 997)
                continue;
            for (size_t i = 0; i < photon; i++)
                before += to[i] == m;
            ck_assert_uint_eq(before, pm_map_source(maps[m], n));
        }
        pm_map_destroy(maps[m]);
    }
    ck_assert_uint_eq(all, count);
    free(photons);
}

START_TEST(in_turn)
{
    static size_t to[COUNT], sizes[MOST];
    const pm__dealing dealing = {.maps = 7, .round_robin = true};
    deal(&dealing, 1000, to, sizes);
    for (size_t i = 0; i < 1000; i++)
        ck_assert_uint_eq(to[i], i % 7);
}
END_TEST

/* Chi-square of sizes, and of pairs of neighbours in the photons' order; 6 standard deviations by the cube root of
 * Wilson and Hilferty: 1e-9 each. */
static void check_even(const size_t *counts, size_t bins, double total)
{
    double chi2 = 0.0;
    for (size_t i = 0; i < bins; i++)
        chi2 += pow((double)counts[i] - total / (double)bins, 2) / (total / (double)bins);
    const double v = 2.0 / (9.0 * (double)(bins - 1));
    const double z = (cbrt(chi2 / (double)(bins - 1)) - (1.0 - v)) / sqrt(v);
    ck_assert_msg(fabs(z) < 6.0, "chi-square %g of %zu", chi2, bins - 1);
}

START_TEST(at_random)
{
    static size_t to[COUNT], again[COUNT], other[COUNT], sizes[MOST], pairs[16];
    pm__dealing dealing = {.maps = 4, .seed = 5, .trial = 2};
    deal(&dealing, COUNT, to, sizes);
    check_even(sizes, 4, COUNT);
    for (size_t i = 0; i + 1 < COUNT; i += 2)
        pairs[4 * to[i] + to[i + 1]]++;
    check_even(pairs, 16, COUNT / 2.0);
    deal(&dealing, COUNT, again, sizes);
    ck_assert_mem_eq(to, again, sizeof to);
    dealing.trial = 3;
    deal(&dealing, COUNT, other, sizes);
    size_t same = 0;
    for (size_t i = 0; i < COUNT; i++)
        same += to[i] == other[i];
    ck_assert_msg(fabs((double)same - 0.25 * COUNT) < 6.0 * sqrt(COUNT * 0.25 * 0.75), "%zu alike", same);
}
END_TEST

/* Fewer photons than maps, and none. */
START_TEST(few)
{
    static size_t to[COUNT], sizes[MOST];
    for (size_t count = 0; count < 5; count++)
        for (int round_robin = 0; round_robin < 2; round_robin++) {
            const pm__dealing dealing = {.maps = MOST, .round_robin = round_robin, .seed = 1};
            deal(&dealing, count, to, sizes);
        }
}
END_TEST

PM_TEST_MAIN("deal", in_turn, at_random, few)
