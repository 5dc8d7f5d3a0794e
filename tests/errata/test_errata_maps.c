/* Errata 10 to 13: several maps, and estimates kept at photons. `slack`: as in test_errata_estimators.c. */
#include "../panel.h"

/* ---- Errata 10 to 12: several maps -------- */

static hood parts[16];
static pm__neighbors part_sets[16];

static pm__lookup combine(size_t maps)
{
    pm__lookup lookup = parts[0].lookup;
    for (size_t m = 0; m < maps; m++)
        part_sets[m] = parts[m].set;
    lookup.sets = part_sets;
    lookup.set_count = maps;
    return lookup;
}

/* Each map a sample of its own of density 1/M. */
static void run_separate(panel *p, stream *s, size_t maps, size_t k, bool stratified, size_t runs)
{
    for (size_t m = 0; m < maps; m++) {
        hood_init(&parts[m], 2);
        parts[m].lookup.unit = sqrt((double)maps);
    }
    for (size_t i = 0; i < runs; i++) {
        for (size_t m = 0; m < maps; m++)
            if (stratified)
                hood_stratified(&parts[m], s, k);
            else
                hood_poisson(&parts[m], s, k);
        const pm__lookup lookup = combine(maps);
        panel_add(p, &lookup);
    }
}

/* One stratified sample of 200 photons a row, dealt at random or in turn. */
static void run_dealt(panel *p, stream *s, size_t maps, size_t k, bool in_turn, size_t runs)
{
    static spot spots[MAX_SPOTS];
    for (size_t i = 0; i < runs; i++) {
        const size_t found = stratify(s, 13.0, spots), offset = below(s, 200);
        for (size_t m = 0; m < maps; m++)
            hood_init(&parts[m], 2);
        for (size_t j = 0; j < found; j++) {
            const size_t number = offset + (size_t)(200 * (spots[j].row + 20) + spots[j].column + 20);
            hood *const part = &parts[in_turn ? number % maps : below(s, maps)];
            if (part->set.count < k)
                hood_add(part, spots[j].x, spots[j].y);
        }
        for (size_t m = 0; m < maps; m++)
            if (parts[m].set.count < k)
                ck_abort_msg("too few photons");
        const pm__lookup lookup = combine(maps);
        panel_add(p, &lookup);
    }
}

START_TEST(test_10_and_11_random_maps)
{
    static const size_t table[][2] = {{2, 16}, {4, 16}, {16, 4}, {8, 8}};
    stream s = {10, 0, 0};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const size_t maps = table[i][0], k = table[i][1];
        const double n = (double)(maps * k), share = (double)k;
        panel p;
        PANEL(p, "combined:rule=mean", "combined:rule=mean,last=none", "combined", "combined:last=none",
              "combined:last=half");
        run_separate(&p, &s, maps, k, false, 40000);
        CHECK_BIASED(p.results[0]);
        CHECK_MEAN(p.results[0], share / (share - 1));
        CHECK_MEAN(p.results[1], 1.0);
        CHECK_BIASED(p.results[2]);
        CHECK_MEAN(p.results[2], n / (n - 1));
        CHECK_MEAN(p.results[3], 1.0);
        CHECK_MEAN(p.results[4], (n - 0.5) / (n - 1));
        CHECK_VARIANCE(p.results[3], 1 / (n - 2));
        if (k >= 16) /* else the fourth moments are wild */
            CHECK_VARIANCE(p.results[1], 1 / (n - 2 * (double)maps));
    }
}
END_TEST

START_TEST(test_11_and_12_stratified_maps)
{
    stream s = {11, 0, 0};
    panel p;
    PANEL(p, "combined", "combined:rule=mean");
    run_separate(&p, &s, 16, 4, true, 4000);
    CHECK_BIASED(p.results[0]);
    CHECK_MEAN_WITHIN(p.results[0], 1.127, 0.004);
    CHECK_MEAN_WITHIN(p.results[1], 1.2244, 0.004);
    PANEL(p, "combined", "combined:last=half");
    run_dealt(&p, &s, 16, 4, false, 4000);
    CHECK_MEAN_WITHIN(p.results[0], 1.0108, 0.003);
    CHECK_MEAN_WITHIN(p.results[1], 1.0108 - 0.5 / 64, 0.003);
    PANEL(p, "combined");
    run_dealt(&p, &s, 16, 4, true, 1500); /* not "equal to random dealing" */
    CHECK_MEAN_WITHIN(p.results[0], 1.2202, 0.005);
    ck_assert(moments_mean(&p.results[0]) > 1.15);
}
END_TEST

/* ---- Errata 13: estimates at photons -------- */

START_TEST(test_13_at_a_photon)
{
    static const size_t counts[] = {10, 50};
    stream s = {12, 0, 0};
    panel p;
    for (size_t i = 0; i < 2; i++)
        for (int dimensions = 2; dimensions <= 3; dimensions++) {
            const double n = (double)counts[i];
            PANEL(p, "precomputed", "precomputed:form=unbiased");
            hood_init(&h, dimensions);
            for (int run = 0; run < 40000; run++) {
                hood_poisson(&h, &s, counts[i] - 1);
                hood_add(&h, sqrt(h.set.radius2), 0.0); /* the farthest moves up; the photon itself takes its place */
                h.distance2[counts[i] - 2] = 0.0f;
                panel_add(&p, &h.lookup);
            }
            CHECK_BIASED(p.results[0]);
            CHECK_MEAN(p.results[0], n / (n - 2));
            CHECK_MEAN(p.results[1], 1.0);
            if (counts[i] > 10)
                CHECK_VARIANCE(p.results[1], 1 / (n - 3));
        }
}
END_TEST

/* Seen from a random point through its nearest photon: sparse spots own larger cells, which undoes half of the 25 %. */
START_TEST(test_13_through_the_nearest_photon)
{
    static spot others[100];
    stream s = {13, 0, 0};
    static hood around;
    panel p;
    PANEL(p, "precomputed");
    hood_init(&around, 2);
    hood_init(&h, 2);
    for (int run = 0; run < 30000; run++) {
        hood_poisson_in(&h, &s, 100, INFINITY, INFINITY);
        for (size_t i = 0; i < 100; i++) {
            const double x = (double)(h.offset[i][0] - h.offset[0][0]), y = (double)(h.offset[i][1] - h.offset[0][1]);
            others[i] = (spot){.distance2 = x * x + y * y, .x = x, .y = y};
        }
        qsort(others, 100, sizeof *others, compare_spots);
        around.set.count = 0;
        for (int i = 0; i < 10; i++)
            hood_add(&around, others[i].x, others[i].y);
        ck_assert(sqrt(around.set.radius2) + sqrt((double)h.distance2[0]) < sqrt(h.set.radius2));
        panel_add(&p, &around.lookup);
    }
    CHECK_BIASED(p.results[0]);
    CHECK_MEAN_WITHIN(p.results[0], 1.117, 0.006);
    ck_assert(moments_mean(&p.results[0]) < 10 / 8.0 - 0.1);
}
END_TEST

PM_TEST_MAIN("errata of several maps", test_10_and_11_random_maps, test_11_and_12_stratified_maps, test_13_at_a_photon,
             test_13_through_the_nearest_photon)
