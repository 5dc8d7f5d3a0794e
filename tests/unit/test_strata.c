/* Emission by strata: which, how many, where, and the same many at once as one by one. */
#include "../../src/transport/strata.h"
#include "../lit.h"

#include <string.h>

enum { PER_LIGHT = 20 };

static pm__scene *lamps(void)
{
    static const pm__light point = {.kind = PM__POINT, .position = {0.0, 0.0, 1.0}, .power = {1.0, 2.0, 3.0}};
    static const pm__light rectangle = {.kind = PM__RECTANGLE, .position = {0.0, 0.0, 3.0}, .power = {2.0, 1.0, 0.0},
                                        .edge = {{0.5, 0.0, 0.0}, {0.0, 0.5, 0.0}}};
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 1.0, 0.0);
    lit_lamp(scene, &point);
    lit_lamp(scene, &rectangle);
    return lit_commit(scene);
}

static void share_by_number(const pm__emission *emission, pm__strata *strata, double shares[2 * PER_LIGHT])
{
    for (size_t i = 0; i < strata->count; i++)
        shares[i] = i % 5 == 1 ? 0.0 : 1.0 + (double)i;
    pm__strata_share(emission, strata, shares);
}

/* The first n photons of a van der Corput sequence have each stratum's share within 1 + log2 n of them. */
START_TEST(test_shares)
{
    enum { SENT = 1000 };
    pm__scene *const scene = lamps();
    pm__emission emission;
    pm__strata strata;
    double shares[2 * PER_LIGHT], all = 0.0;
    size_t counts[2 * PER_LIGHT] = {0};
    pm__emission_init(scene, NULL, PM__ALL_LIGHTS, 7, 1, &emission);
    ck_assert(pm__strata_create(&emission, PER_LIGHT, NULL, 4, &strata) == PM_OK);
    ck_assert_uint_eq(strata.count, 32); /* 16 of each light */
    share_by_number(&emission, &strata, shares);
    for (size_t i = 0; i < strata.count; i++)
        all += shares[i];
    for (uint64_t n = 1; n <= SENT; n++) {
        counts[pm__strata_find(&strata, n - 1)]++;
        for (size_t i = 0; i < strata.count; i++)
            ck_assert(fabs((double)counts[i] - (double)n * shares[i] / all) <= 1.0 + log2((double)n) + 1.0);
    }
    for (size_t i = 0; i < strata.count; i++)
        ck_assert((counts[i] == 0) == (shares[i] == 0.0));
    pm__strata_free(&strata);
    pm__scene_destroy(scene);
}
END_TEST

/* Shares times powers are what each light sends; trial photons' add up to the same. */
START_TEST(test_powers)
{
    pm__scene *const scene = lamps();
    pm__emission emission;
    pm__strata strata;
    double shares[2 * PER_LIGHT], all = 0.0, sent = 0.0, tried = 0.0;
    pm__emission_init(scene, NULL, PM__ALL_LIGHTS, 7, 1, &emission);
    ck_assert(pm__strata_create(&emission, PER_LIGHT, NULL, 4, &strata) == PM_OK);
    for (size_t i = 0; i < strata.count; i++)
        all += shares[i] = 2.0 + (double)(i % 3);
    pm__strata_share(&emission, &strata, shares);
    for (size_t i = 0; i < strata.count; i++) {
        const double light = pm__sum(pm__scene_light_at(scene, strata.items[i].light)->power);
        sent += shares[i] / all * strata.items[i].factor * light;
        tried += 4.0 * strata.items[i].trial_factor * light;
    }
    PM_CHECK_NEAR(sent, emission.total, 1e-12 * emission.total);
    PM_CHECK_NEAR(tried, emission.total, 1e-12 * emission.total);
    pm__strata_free(&strata);
    pm__scene_destroy(scene);
}
END_TEST

/* Dealt out: each stratum the whole number below its share or above it, every number once, and with a share of 1 or
 * more all of its power exactly: those below have it on average. The first of two lights is one stratum. */
START_TEST(test_deal)
{
    enum { MOST = 2000 };
    static const bool cut[2] = {false, true};
    pm__scene *const scene = lamps();
    for (uint32_t trial = 0; trial < 20; trial++) {
        pm__emission emission;
        pm__strata strata;
        double shares[2 * PER_LIGHT], all = 0.0, sent[2 * PER_LIGHT] = {0.0};
        size_t counts[2 * PER_LIGHT] = {0};
        pm__emission_init(scene, NULL, PM__ALL_LIGHTS, 7, trial, &emission);
        ck_assert(pm__strata_create(&emission, PER_LIGHT, cut, 4, &strata) == PM_OK);
        ck_assert_uint_eq(strata.count, 17);
        ck_assert_uint_eq(strata.fine, 16);
        ck_assert_uint_eq(strata.items[15].light, 1);
        ck_assert_uint_eq(strata.items[16].light, 0);
        for (size_t i = 0; i < strata.count; i++)
            all += shares[i] = i % 5 == 1 ? 0.0 : i % 5 == 2 ? 0.3 : 1.0 + 7.7 * (double)i;
        const uint64_t dealt = pm__strata_deal(&emission, &strata, shares);
        ck_assert(fabs((double)dealt - all) < 1.0 && dealt < MOST);
        for (uint64_t n = 0; n < dealt; n++) {
            const size_t at = pm__strata_find(&strata, n);
            const double light = pm__sum(pm__scene_light_at(scene, strata.items[at].light)->power);
            counts[at]++;
            sent[at] += strata.items[at].factor * light / (double)dealt;
        }
        for (size_t i = 0; i < strata.count; i++) {
            const double power = strata.items[i].power;
            ck_assert(fabs((double)counts[i] - shares[i]) < 1.0);
            if (shares[i] >= 1.0)
                PM_CHECK_NEAR(sent[i], power, 1e-12 * power);
            else
                PM_CHECK_NEAR(sent[i], counts[i] ? power / shares[i] : 0.0, 1e-12 * power);
        }
        pm__strata_free(&strata);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* A photon's numbers lie in its stratum, of trial ones in turn. */
START_TEST(test_places)
{
    pm__scene *const scene = lamps();
    pm__emission emission;
    pm__strata strata;
    double shares[2 * PER_LIGHT];
    pm__emission_init(scene, NULL, PM__ALL_LIGHTS, 7, 1, &emission);
    ck_assert(pm__strata_create(&emission, PER_LIGHT, NULL, 4, &strata) == PM_OK);
    share_by_number(&emission, &strata, shares);
    for (uint64_t n = 0; n < 2000; n++) {
        const uint64_t number = n % 2 ? PM__MOST_TRACED + n / 2 % (4 * strata.count) : n;
        double u[4] = {0.1, 0x1.fffffffffffffp-1, 0.0, 0.7}, factor;
        const size_t at = pm__strata_find(&strata, number);
        ck_assert(n % 2 == 0 || at == n / 2 % (4 * strata.count) / 4);
        ck_assert_uint_eq(pm__strata_place(&strata, number, u, &factor), strata.items[at].light);
        for (int a = 0; a < 4; a++)
            ck_assert(u[a] >= strata.items[at].low[a] && u[a] < 1.0 &&
                      u[a] <= strata.items[at].low[a] + strata.items[at].width[a]);
        ck_assert(factor == (n % 2 ? strata.items[at].trial_factor : strata.items[at].factor));
    }
    pm__strata_free(&strata);
    pm__scene_destroy(scene);
}
END_TEST

START_TEST(test_many_at_once)
{
    pm__scene *const scene = lamps();
    pm__emission emission;
    pm__strata strata;
    double shares[2 * PER_LIGHT];
    pm__batch b;
    memset(&b, 0, sizeof b);
    pm__emission_init(scene, NULL, PM__ALL_LIGHTS, 7, 1, &emission);
    ck_assert(pm__strata_create(&emission, PER_LIGHT, NULL, 4, &strata) == PM_OK);
    share_by_number(&emission, &strata, shares);
    emission.strata = &strata;
    b.count = PM__BATCH;
    for (size_t i = 0; i < b.count; i++)
        b.number[i] = i % 3 == 2 ? PM__MOST_TRACED + i : i;
    ck_assert(pm__depart_all(&emission, pm__batch_choose(), &b));
    for (size_t i = 0; i < b.count; i++) {
        pm__departure one;
        ck_assert(pm__depart(&emission, b.number[i], &one));
        for (int a = 0; a < 3; a++) {
            ck_assert(b.origin[a][i] == one.position[a]);
            ck_assert(b.direction[a][i] == one.direction[a]);
            ck_assert(b.power[a][i] == one.power[a]);
        }
    }
    pm__strata_free(&strata);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("strata", test_shares, test_powers, test_deal, test_places, test_many_at_once)
