/* Photons dealt to maps: each goes to one, by its number or by chance, in the order in which they came. */
#include "../test.h"

#include "../../src/transport/deal.h"

#include <math.h>

enum { PHOTONS = 9001, MAPS = 4 };

/* The photon of number i has the power i + 1: a float holds it. */
static void deal(const pm__dealing *dealing, size_t map_of[PHOTONS], size_t counts[MAPS])
{
    static pm_photon photons[PHOTONS];
    pm_map *maps[MAPS] = {NULL};
    pm_error error = {""};
    for (size_t i = 0; i < PHOTONS; i++) {
        photons[i] = (pm_photon){.position = {(float)(i % 97), (float)(i % 89), 0.0f}, .direction = {0, 0, -1}};
        photons[i].power[0] = (float)(i + 1);
        map_of[i] = MAPS;
    }
    PM_CHECK_OK(pm__deal(dealing, photons, PHOTONS, NULL, maps, &error), error);
    for (size_t m = 0; m < MAPS; m++) {
        size_t sources[PHOTONS] = {0};
        counts[m] = pm_map_count(maps[m]);
        for (size_t n = 0; n < counts[m]; n++) {
            const pm_photon photon = pm_map_photon(maps[m], (uint32_t)n);
            const size_t i = (size_t)photon.power[0] - 1;
            ck_assert_uint_eq(map_of[i], MAPS);
            map_of[i] = m;
            sources[pm_map_source(maps[m], (uint32_t)n)] = i;
        }
        for (size_t s = 1; s < counts[m]; s++)
            ck_assert_uint_lt(sources[s - 1], sources[s]);
        pm_map_destroy(maps[m]);
    }
    for (size_t i = 0; i < PHOTONS; i++)
        ck_assert_uint_lt(map_of[i], MAPS);
}

START_TEST(round_robin)
{
    static size_t map_of[PHOTONS], counts[MAPS];
    const pm__dealing dealing = {.maps = MAPS, .round_robin = true, .seed = 1};
    deal(&dealing, map_of, counts);
    for (size_t i = 0; i < PHOTONS; i++)
        ck_assert_uint_eq(map_of[i], i % MAPS);
}
END_TEST

/* Counts are binomial, and so are those of neighbours in the same map, and of photons that two trials deal alike: each
 * of the six is within six standard deviations but for a chance of 2e-9. */
START_TEST(at_random)
{
    static size_t map_of[2][PHOTONS], counts[MAPS];
    const double share = 1.0 / MAPS, deviation = sqrt(PHOTONS * share * (1.0 - share));
    size_t next = 0, alike = 0;
    for (uint32_t trial = 0; trial < 2; trial++) {
        const pm__dealing dealing = {.maps = MAPS, .seed = 1, .trial = trial};
        deal(&dealing, map_of[trial], counts);
    }
    for (size_t m = 0; m < MAPS; m++)
        ck_assert_double_le(fabs((double)counts[m] - PHOTONS * share), 6.0 * deviation);
    for (size_t i = 0; i < PHOTONS; i++) {
        alike += map_of[0][i] == map_of[1][i];
        next += i > 0 && map_of[0][i] == map_of[0][i - 1];
    }
    ck_assert_double_le(fabs((double)alike - PHOTONS * share), 6.0 * deviation);
    ck_assert_double_le(fabs((double)next - PHOTONS * share), 6.0 * deviation);
}
END_TEST

PM_TEST_MAIN("deal", round_robin, at_random)
