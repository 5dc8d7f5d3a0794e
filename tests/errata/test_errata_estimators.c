/* Errata 1 to 9 and 46 and the theorems T1 to T3, on even light: the printed form misses the truth by more than chance
 * and by the amount that theory says, the corrected form holds.
 *
 * References without a closed form (stratified photons) were simulated elsewhere: docs/errata.md; `slack` is five of
 * their standard errors. */
#include "../panel.h"

#include <gsl/gsl_cdf.h>

/* ---- Errata 1, 2: the last photon of disc and ball -------- */

START_TEST(test_1_disc_and_ball)
{
    static const size_t counts[] = {5, 10, 50, 200};
    stream s = {1, 0, 0};
    panel p;
    for (int dimensions = 2; dimensions <= 3; dimensions++)
        for (size_t i = 0; i < 4; i++) {
            const double n = (double)counts[i];
            PANEL(p, "disc", "disc:last=none", "oracle:last=none");
            run_poisson(&p, &s, dimensions, counts[i], i == 3 ? 40000 : 60000);
            CHECK_BIASED(p.results[0]);
            CHECK_MEAN(p.results[0], n / (n - 1));
            CHECK_MEAN(p.results[1], 1.0);
            CHECK_MEAN(p.results[2], 1.0);
            if (counts[i] > 10) /* the variance's own error needs eight moments */
                CHECK_VARIANCE(p.results[1], 1 / (n - 2));
        }
}
END_TEST

START_TEST(test_1_and_2_half_is_for_stratified_photons)
{
    static const struct {
        size_t n, runs;
        double full, half, slack, deviation;
    } table[] = {{5, 40000, 1.1570, 1.0413, 35e-4, .2581},
                 {10, 40000, 1.0668, 1.0134, 15e-4, .1420},
                 {25, 20000, 1.0239, 1.0034, 10e-4, .0691},
                 {50, 10000, 1.0114, 1.0013, 5e-4, .0408}};
    stream s = {2, 0, 0};
    panel p;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const double n = (double)table[i].n;
        PANEL(p, "disc", "disc:last=half");
        run_poisson(&p, &s, 2, table[i].n, 150000);
        CHECK_BIASED(p.results[1]);
        CHECK_MEAN(p.results[1], 1 + 0.5 / (n - 1));

        PANEL(p, "disc", "disc:last=half", "disc:last=none");
        run_stratified(&p, &s, table[i].n, table[i].runs);
        CHECK_BIASED(p.results[0]);
        CHECK_BIASED(p.results[2]); /* too dark */
        CHECK_MEAN_WITHIN(p.results[0], table[i].full, table[i].slack);
        CHECK_MEAN_WITHIN(p.results[1], table[i].half, table[i].slack);
        PM_CHECK_NEAR(sqrt(moments_variance(&p.results[1])) / table[i].deviation, 1.0, 0.06);
        if (table[i].n >= 25)
            CHECK_MEAN_WITHIN(p.results[1], 1.0, 4e-3);
    }
}
END_TEST

/* ---- Errata 3 to 7: kernels -------- */

/* Equation 2.13 has no area: it does not change with the size of the scene, but irradiance does, by 4 for half the
 * length. */
START_TEST(test_3_the_gaussian_needs_an_area)
{
    stream s = {3, 0, 0};
    const subject g = subject_of("gaussian:form=normalised");
    double printed[2], estimate[2];
    hood_init(&h, 2);
    hood_poisson(&h, &s, 50);
    for (int half = 0; half < 2; half++) {
        h.lookup.unit = half ? 0.5 : 1.0;
        printed[half] = 0.0;
        for (size_t i = 0; i < h.set.count; i++)
            printed[half] += (double)h.flux[i][0] * g.estimator->weight(g.spec.values,
                                                                        (double)h.distance2[i] / h.set.radius2);
        estimate[half] = estimate_of(&g, &h.lookup);
    }
    ck_assert(printed[1] == printed[0]);
    ck_assert(estimate[1] == 4.0 * estimate[0]);
}
END_TEST

START_TEST(test_4_gaussian_forms)
{
    const double c = 0.531154927, rim = 0.25115; /* errata, section 3 */
    stream s = {4, 0, 0};
    panel p;
    PANEL(p, "gaussian:last=none", "gaussian", "gaussian:form=normalised,last=none", "gaussian:form=normalised",
          "gaussian:form=pavicic");
    for (int dimensions = 2; dimensions <= 3; dimensions++)
        if (dimensions == 2) {
            run_poisson(&p, &s, 2, 50, 60000);
            CHECK_BIASED(p.results[0]);
            CHECK_MEAN(p.results[0], c);
            CHECK_MEAN_WITHIN(p.results[1], c + rim / 49, 1e-6);
            CHECK_MEAN(p.results[2], 1.0);
            CHECK_VARIANCE(p.results[2], 1.1293085 / 48);
            CHECK_MEAN_WITHIN(p.results[3], 1 + rim / c / 49, 1e-6);
            CHECK_MEAN_WITHIN(p.results[4], 0.9999867, 1e-7);
            CHECK_VARIANCE(p.results[4], 1.6527221 / 48);
        } else {
            PANEL(p, "gaussian:form=normalised,last=none", "gaussian:form=pavicic");
            run_poisson(&p, &s, 3, 50, 60000);
            CHECK_MEAN(p.results[0], 1.0);
            CHECK_MEAN(p.results[1], 1.0);
        }
}
END_TEST

START_TEST(test_5_and_6_cone)
{
    stream s = {5, 0, 0};
    panel p;
    PANEL(p, "cone:k=2", "cone:k=2,last=none", "cone:k=1", "cone:k=0.9");
    run_poisson(&p, &s, 2, 10, 200000);
    CHECK_BIASED(p.results[0]);
    CHECK_MEAN(p.results[0], 1 + 0.75 / 9); /* (1 - 1/k)/((1 - 2/(3k))(n-1)): 8.3 % */
    CHECK_MEAN(p.results[1], 1.0);
    CHECK_MEAN(p.results[2], 1.0);
    CHECK_MEAN(p.results[3], 1.0);
    /* With the normaliser as printed, valid for k >= 1 only: */
    const double printed = moments_mean(&p.results[3]) * 0.27 / (1 - 2 / 2.7);
    ck_assert(printed - 1.0 > 5.5 * moments_error(&p.results[3]));

    /* Half of the last photon's weight is right for neither kind of photons. */
    PANEL(p, "cone", "cone:last=half", "cone:last=none");
    run_poisson(&p, &s, 2, 10, 400000);
    const double excess = 1 / 11.0 / (13 / 33.0) / 9;
    CHECK_MEAN(p.results[0], 1 + excess);
    CHECK_MEAN(p.results[1], 1 + excess / 2);
    CHECK_BIASED(p.results[1]);
    CHECK_MEAN(p.results[2], 1.0);
    PANEL(p, "cone", "cone:last=half");
    run_stratified(&p, &s, 25, 20000);
    CHECK_MEAN_WITHIN(p.results[0], 1.0015, 10e-4);
    CHECK_MEAN_WITHIN(p.results[1], 0.9968, 10e-4);
    CHECK_BIASED(p.results[1]);
    ck_assert(fabs(moments_mean(&p.results[0]) - 1) < fabs(moments_mean(&p.results[1]) - 1));
}
END_TEST

START_TEST(test_7_noise_of_the_cone)
{
    stream s = {6, 0, 0};
    panel p;
    PANEL(p, "disc:last=none", "cone:last=none");
    run_poisson(&p, &s, 2, 50, 60000);
    CHECK_VARIANCE(p.results[1], 1.295858 / 48);
    ck_assert(moments_variance(&p.results[1]) - moments_variance(&p.results[0]) >
              SIGMAS * (moments_variance_error(&p.results[0]) + moments_variance_error(&p.results[1])));
    PANEL(p, "disc:last=half", "cone:last=half", "epanechnikov");
    run_stratified(&p, &s, 25, 20000);
    for (int i = 1; i < 3; i++) /* the other way round: the paper's "more noise" is false for its own photons */
        ck_assert(moments_variance(&p.results[0]) - moments_variance(&p.results[i]) >
                  SIGMAS * (moments_variance_error(&p.results[0]) + moments_variance_error(&p.results[i])));
    PM_CHECK_NEAR(sqrt(moments_variance(&p.results[1])), 0.0529, 0.06 * 0.0529);
    PM_CHECK_NEAR(sqrt(moments_variance(&p.results[2])), 0.0549, 0.06 * 0.0549);
}
END_TEST

/* Theorem T1: any kernel over the photons inside is unbiased, with relative variance inflation/(n-2). */
START_TEST(test_t1_kernels)
{
    static const double inflation[] = {1.5, 1.03125, 1.1293085, 1.6527221, 4 / 3.0, 1.8};
    stream s = {7, 0, 0};
    panel p;
    for (int dimensions = 2; dimensions <= 3; dimensions++) {
        PANEL(p, "cone:k=1,last=none", "cone:k=2,last=none", "gaussian:form=normalised,last=none",
              "gaussian:form=pavicic,last=none", "epanechnikov", "biweight", "cone:k=0.7,last=none");
        run_poisson(&p, &s, dimensions, 30, 50000);
        for (size_t i = 0; i < p.count; i++)
            CHECK_MEAN_WITHIN(p.results[i], 1.0, i == 3 ? 1.4e-5 : 0.0);
        for (size_t i = 0; i < 6 && dimensions == 2; i++)
            CHECK_VARIANCE(p.results[i], inflation[i] / 28);
    }
}
END_TEST

/* ---- Errata 8, 9: the hull -------- */

START_TEST(test_8_hull)
{
    static const struct {
        size_t n;
        double printed; /* 20 % of the boundary */
    } table[] = {{10, 1.315}, {15, 1.188}, {25, 1.111}, {50, 1.061}};
    static const double sides[][2] = {{INFINITY, INFINITY}, {0, INFINITY}, {0.7, INFINITY}, {0, 0}};
    stream s = {8, 0, 0};
    panel p;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        for (size_t side = 0; side < 4; side++) { /* interior, on an edge, near it, in a corner: 0 is exact at all */
            PANEL(p, "hull", "hull:boundary=0", "disc:last=none");
            run_corner(&p, &s, table[i].n, sides[side][0], sides[side][1], side == 0 ? 20000 : 10000);
            CHECK_BIASED(p.results[0]);
            CHECK_MEAN(p.results[1], 1.0);
            if (side == 0)
                CHECK_MEAN_WITHIN(p.results[0], table[i].printed, 0.01);
            if (side == 1 || side == 3)
                CHECK_MEAN(p.results[2], side == 1 ? 0.5 : 0.25); /* where the disc is dark */
        }
    PANEL(p, "hull:boundary=0,outside=zero");
    run_corner(&p, &s, 8, INFINITY, INFINITY, 40000);
    CHECK_MEAN(p.results[0], 1 - 7 / 64.0);
}
END_TEST

START_TEST(test_8_and_9_hull_of_stratified_photons)
{
    stream s = {9, 0, 0};
    panel p;
    PANEL(p, "hull", "hull:boundary=0");
    run_stratified(&p, &s, 15, 40000);
    CHECK_MEAN_WITHIN(p.results[0], 1.0067, 35e-4);
    CHECK_BIASED(p.results[1]);
    PANEL(p, "hull", "disc:last=half", "hull:boundary=0");
    run_stratified(&p, &s, 25, 20000);
    CHECK_MEAN_WITHIN(p.results[0], 1.0006, 25e-4);
    CHECK_BIASED(p.results[2]);
    /* Noisier than the disc, in spite of 5.5.4: by 16 % ... */
    PM_CHECK_NEAR(sqrt(moments_variance(&p.results[0]) / moments_variance(&p.results[1])), .0805 / .0692, 0.06);
    /* ... and with random photons by 13 %. */
    PANEL(p, "hull:boundary=0", "disc:last=none");
    run_corner(&p, &s, 50, INFINITY, INFINITY, 20000);
    PM_CHECK_NEAR(sqrt(moments_variance(&p.results[0]) / moments_variance(&p.results[1])), 1.136, 0.03);
}
END_TEST

/* ---- Theorems T2, T3 and errata 46 -------- */

START_TEST(test_t2_maximum_radius)
{
    static const double expected[] = {4, 9, 14}; /* photons within the maximum radius */
    const size_t n = 10;
    stream s = {14, 0, 0};
    for (size_t i = 0; i < 3; i++) {
        panel p;
        PANEL(p, "disc", "disc:last=none", "epanechnikov");
        hood_init(&h, 2);
        for (int run = 0; run < 100000; run++) {
            const double limit = expected[i] / pi;
            hood_poisson(&h, &s, n);
            h.set.cut = h.set.radius2 > limit;
            while (h.set.count && (double)h.distance2[h.set.count - 1] > limit)
                h.set.count--;
            if (h.set.cut)
                h.set.radius2 = limit;
            panel_add(&p, &h.lookup);
        }
        CHECK_MEAN(p.results[0], 1 + gsl_cdf_gamma_P(expected[i], (double)n - 1, 1.0) / ((double)n - 1));
        CHECK_MEAN(p.results[1], 1.0);
        CHECK_MEAN(p.results[2], 1.0);
        if (i)
            CHECK_BIASED(p.results[0]);
    }
}
END_TEST

START_TEST(test_t3_differential)
{
    stream s = {15, 0, 0};
    panel p;
    for (int dimensions = 2; dimensions <= 3; dimensions++) {
        PANEL(p, "differential:last=none", "differential:rule=significance,last=none",
              "differential:rule=significance,z=2,last=none", "differential:trend=5,last=none", "differential",
              "differential:rule=significance", "disc:last=none");
        run_poisson(&p, &s, dimensions, 200, 30000);
        for (size_t i = 0; i < 4; i++)
            CHECK_MEAN(p.results[i], 1.0);
        CHECK_BIASED(p.results[4]);
        CHECK_BIASED(p.results[5]);
        /* Stopping by chance costs noise: deviations of section 6, of the disc's 0.0711. */
        PM_CHECK_NEAR(sqrt(moments_variance(&p.results[1])), 0.0797, 0.004);
        PM_CHECK_NEAR(sqrt(moments_variance(&p.results[2])), 0.0930, 0.004);
        CHECK_VARIANCE(p.results[6], 1 / 198.0);
        ck_assert(moments_variance(&p.results[0]) > 1.5 * moments_variance(&p.results[6]));
        ck_assert(moments_variance(&p.results[3]) > 3.0 * moments_variance(&p.results[6]));
    }
}
END_TEST

START_TEST(test_46_dark_edges_stay)
{
    stream s = {16, 0, 0};
    panel p;
    PANEL(p, "differential:last=none", "differential:rule=significance,last=none");
    run_corner(&p, &s, 200, 0.0, INFINITY, 8000);
    CHECK_MEAN(p.results[0], 0.5);
    CHECK_MEAN(p.results[1], 0.5);
    PANEL(p, "differential:last=none", "differential:rule=significance,last=none");
    run_corner(&p, &s, 200, 0.0, 0.0, 4000);
    CHECK_MEAN(p.results[0], 0.25);
    CHECK_MEAN(p.results[1], 0.25);
    /* Half a flat radius inside it does help, but not entirely: section 6. */
    PANEL(p, "disc:last=none", "differential:rule=significance,last=none");
    run_corner(&p, &s, 200, 0.5 * sqrt(200 / pi), INFINITY, 10000);
    CHECK_MEAN_WITHIN(p.results[0], 0.7715, 0.003);
    CHECK_MEAN_WITHIN(p.results[1], 0.8218, 0.005);
    CHECK_BIASED(p.results[1]);
}
END_TEST

PM_TEST_MAIN("errata of the estimators", test_1_disc_and_ball, test_1_and_2_half_is_for_stratified_photons,
             test_3_the_gaussian_needs_an_area, test_4_gaussian_forms, test_5_and_6_cone, test_7_noise_of_the_cone,
             test_t1_kernels, test_8_hull, test_8_and_9_hull_of_stratified_photons, test_t2_maximum_radius,
             test_t3_differential, test_46_dark_edges_stay)
