/* Estimators one by one: closed forms, cut and degenerate lookups, scale. Weights are in test_kernels.c, the hull in
 * test_hull.c. */
#include "../neighborhood.h"

static const double pi = 3.14159265358979323846;

static hood h;

/* ---- Single estimates -------- */

/* Four photons at distances 1, 2, 3, 4 with flux 1, 2, 3, 4 (doubled in the second band, none in the third). */
static void four_photons(int dimensions)
{
    hood_init(&h, dimensions);
    for (int i = 1; i <= 4; i++) {
        hood_add(&h, i % 2 ? i : 0.0, i % 2 ? 0.0 : i);
        h.flux[i - 1][0] = (float)i;
        h.flux[i - 1][1] = (float)(2 * i);
        h.flux[i - 1][2] = 0.0f;
    }
}

START_TEST(test_estimates_in_closed_form)
{
    static const struct {
        const char *name;
        double flux; /* weighted, over the normaliser */
    } table[] = {{"disc", 10},
                 {"disc:last=half", 8},
                 {"disc:last=none", 6},
                 {"cone:k=1", (0.75 + 1 + 0.75) * 3},
                 {"cone:k=2", (0.875 + 1.5 + 1.875 + 2) * 1.5},
                 {"cone:k=2,last=none", (0.875 + 1.5 + 1.875) * 1.5},
                 {"cone:k=0.5", 0.5 * 12},
                 {"epanechnikov", (15 + 24 + 21) / 16.0 * 2},
                 {"biweight", (225 + 288 + 147) / 256.0 * 3},
                 {"oracle:last=none", 6},
                 {"oracle:last=full", 10},
                 {"differential", 10},
                 {"differential:last=none,rule=significance", 6},
                 {"precomputed", 10},
                 {"precomputed:form=unbiased", 5}};
    four_photons(2);
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const subject s = subject_of(table[i].name);
        double result[3];
        ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), PM_OK);
        PM_CHECK_NEAR(result[0], table[i].flux / (16 * pi), 1e-15);
        PM_CHECK_NEAR(result[1], 2 * table[i].flux / (16 * pi), 1e-15);
        ck_assert(result[2] == 0.0);
    }
    four_photons(3);
    h.lookup.unit = 0.5;
    const subject s = subject_of("cone:k=2");
    PM_CHECK_NEAR(estimate_of(&s, &h.lookup), 6.25 / (1 - 3.0 / 8.0) / (4.0 / 3.0 * pi * 8), 1e-15);
}
END_TEST

/* Contract: a lookup cut by its radius has area pi R2, kernels over R, no correction for the last photon. */
START_TEST(test_cut_lookups)
{
    static const struct {
        const char *name;
        double flux;
    } table[] = {{"disc:last=none", 10},
                 {"cone:k=2,last=none", (1 - 0.1 + 2 - 0.4 + 3 - 0.9 + 4 - 1.6) * 1.5},
                 {"epanechnikov:last=half", (10 - (1 + 8 + 27 + 64) / 25.0) * 2},
                 {"oracle:last=none", 10},
                 {"differential:last=none", 10},
                 {"precomputed", 10},
                 {"precomputed:form=unbiased", 9}};
    four_photons(2);
    h.set.cut = true;
    h.set.radius2 = 25;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const subject s = subject_of(table[i].name);
        PM_CHECK_NEAR(estimate_of(&s, &h.lookup), table[i].flux / (25 * pi), 1e-15);
    }
}
END_TEST

START_TEST(test_oracle_uses_its_number)
{
    const subject s = subject_of("oracle:last=none"), full = subject_of("oracle:last=full");
    four_photons(2);
    h.lookup.oracle_k = 3;
    PM_CHECK_NEAR(estimate_of(&s, &h.lookup), 3 / (9 * pi), 1e-15);
    PM_CHECK_NEAR(estimate_of(&full, &h.lookup), 6 / (9 * pi), 1e-15);
    h.set.cut = true; /* the cut is far outside the photons that are used */
    h.set.radius2 = 100;
    PM_CHECK_NEAR(estimate_of(&s, &h.lookup), 3 / (9 * pi), 1e-15);
    h.lookup.oracle_k = 4;
    PM_CHECK_NEAR(estimate_of(&s, &h.lookup), 10 / (100 * pi), 1e-15);
}
END_TEST

START_TEST(test_every_last_of_equal_photons)
{
    /* last=none leaves out one photon however many tie, in whatever order photons come. */
    const subject s = subject_of("disc:last=none"), p = subject_of("precomputed:form=unbiased");
    hood_init(&h, 2);
    hood_add(&h, 2, 0);
    hood_add(&h, 0, 2);
    hood_add(&h, 0, 0);
    hood_add(&h, 1, 0);
    h.flux[1][0] = 5.0f; /* the last of them: the search's order has it so */
    h.set.radius2 = 4;
    PM_CHECK_NEAR(estimate_of(&s, &h.lookup), 3 / (4 * pi), 1e-15);
    PM_CHECK_NEAR(estimate_of(&p, &h.lookup), 2 / (4 * pi), 1e-15);
}
END_TEST

/* ---- Combined -------- */

static hood parts[4];

static pm_status combine(const char *name, double *value)
{
    const subject s = subject_of(name);
    pm__neighbors sets[4];
    for (int m = 0; m < 4; m++)
        sets[m] = parts[m].set;
    pm__lookup lookup = parts[0].lookup;
    lookup.sets = sets;
    lookup.set_count = 4;
    double result[3];
    const pm_status status = s.estimator->estimate(s.spec.values, &lookup, result);
    *value = result[0];
    return status;
}

static void check_combined(const char *name, double want)
{
    double value;
    ck_assert_int_eq(combine(name, &value), PM_OK);
    PM_CHECK_NEAR(value, want, 1e-14);
}

START_TEST(test_combined_sets)
{
    double value;
    for (int m = 0; m < 4; m++) { /* map m: three photons, the farthest at m + 1 */
        hood_init(&parts[m], 2);
        for (int i = 1; i <= 3; i++)
            hood_add(&parts[m], i * (m + 1) / 3.0, 0);
    }
    check_combined("combined", 4 * 12 / (30 * pi));
    check_combined("combined:last=none", 4 * 11 / (30 * pi));
    check_combined("combined:rule=mean", 3 / pi * (1 + 1 / 4.0 + 1 / 9.0 + 1 / 16.0));
    check_combined("combined:rule=mean,last=none", 2 / pi * (1 + 1 / 4.0 + 1 / 9.0 + 1 / 16.0));

    parts[1].set.cut = true; /* all of its photons count, over its sphere */
    parts[1].set.radius2 = 8;
    check_combined("combined:last=none", 4 * (9 * 8 / 9.0 + 3) / (34 * pi));
    check_combined("combined:rule=mean,last=none", 1 / pi * (2 + 3 / 8.0 + 2 / 9.0 + 2 / 16.0));

    parts[1].set.count = 0; /* an empty sphere is a region too */
    check_combined("combined", 4 * 9 / (34 * pi));
    check_combined("combined:rule=mean", 3 / pi * (1 + 1 / 9.0 + 1 / 16.0));

    parts[1].set.cut = false; /* an empty map without a limit says nothing */
    parts[1].set.radius2 = 0;
    check_combined("combined", 3 * 9 / (26 * pi));
    check_combined("combined:rule=mean", 3 / pi * (1 + 1 / 9.0 + 1 / 16.0));

    for (int m = 0; m < 4; m++) { /* every map cut: nothing is on a rim */
        parts[m].set.cut = true;
        parts[m].set.radius2 = 16;
    }
    check_combined("combined:last=none", 9 / (16 * pi));
    check_combined("combined:rule=mean,last=none", 9 / (16 * pi));

    for (int m = 0; m < 4; m++)
        parts[m].set = (pm__neighbors){0};
    ck_assert_int_eq(combine("combined", &value), PM_EDEGENERATE);
}
END_TEST

/* ---- All of them -------- */

static const char *const all[] = {"disc",
                                  "disc:last=half",
                                  "cone",
                                  "cone:k=0.7,last=none",
                                  "gaussian",
                                  "gaussian:form=pavicic",
                                  "gaussian:form=normalised,last=half",
                                  "epanechnikov",
                                  "biweight",
                                  "differential",
                                  "differential:trend=4,start=5",
                                  "differential:rule=significance,z=1,last=none",
                                  "hull",
                                  "hull:boundary=0",
                                  "combined",
                                  "combined:rule=mean",
                                  "precomputed",
                                  "precomputed:form=unbiased",
                                  "oracle"};
enum { ALL = sizeof all / sizeof *all };

/* Powers of two pass through to the last bit: lengths, the map's unit, powers. */
START_TEST(test_scales_exactly)
{
    static const int exponents[][3] = {{3, 0, 0}, {0, -7, 0}, {0, 0, 20}, {-30, 40, -60}, {30, -90, 60}};
    static hood scaled;
    stream random = {2, 0, 0};
    for (int dimensions = 2; dimensions <= 3; dimensions++)
        for (size_t i = 0; i < ALL; i++) {
            const subject s = subject_of(all[i]);
            if (!(s.estimator->dimensions >> dimensions & 1U))
                continue;
            hood_init(&h, dimensions);
            if (dimensions == 2)
                hood_poisson_in(&h, &random, 60, 1.0, INFINITY);
            else
                hood_poisson(&h, &random, 60);
            const double before = estimate_of(&s, &h.lookup);
            ck_assert(before > 0.0 || !strcmp(all[i], "cone:k=0.7,last=none"));
            for (size_t j = 0; j < sizeof exponents / sizeof *exponents; j++) {
                const int length = exponents[j][0], unit = exponents[j][1], power = exponents[j][2];
                hood_init(&scaled, dimensions);
                scaled.set.count = h.set.count;
                scaled.set.radius2 = ldexp(h.set.radius2, 2 * length);
                scaled.lookup.unit = ldexp(1.0, unit);
                for (size_t k = 0; k < h.set.count; k++) {
                    scaled.distance2[k] = ldexpf(h.distance2[k], 2 * length);
                    for (int c = 0; c < 3; c++) {
                        scaled.offset[k][c] = ldexpf(h.offset[k][c], length);
                        scaled.flux[k][c] = ldexpf(h.flux[k][c], power);
                    }
                }
                const double after = estimate_of(&s, &scaled.lookup);
                ck_assert_msg(after == ldexp(before, power - dimensions * (length + unit)), "%s", all[i]);
            }
        }
}
END_TEST

/* A region of no measure has a status; one photon away from the query point is enough for most. */
START_TEST(test_degenerate_regions)
{
    for (size_t i = 0; i < ALL; i++) {
        const subject s = subject_of(all[i]);
        double result[3];
        hood_init(&h, 2);
        for (int j = 0; j < 30; j++)
            hood_add(&h, 0, 0);
        ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), PM_EDEGENERATE);
        hood_add(&h, 2, 0);
        const bool hull = !strncmp(all[i], "hull", 4);
        ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), hull ? PM_EDEGENERATE : PM_OK);
        ck_assert(hull || (isfinite(result[0]) && result[0] > 0.0));
        hood_init(&h, 2);
        hood_add(&h, 1, 0);
        ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), hull ? PM_EDEGENERATE : PM_OK);
        ck_assert(hull || (isfinite(result[0]) && result[0] >= 0.0));
    }
}
END_TEST

/* ---- Differential -------- */

START_TEST(test_differential_resolves_its_trend)
{
    char text[PM__MAX_SPEC];
    const subject plain = subject_of("differential"), significance = subject_of("differential:rule=significance");
    pm__spec_format(&plain.spec, text, sizeof text);
    ck_assert_str_eq(text, "differential:rule=monotone,z=2.5,start=20,trend=10,last=full,noise=poisson");
    pm__spec_format(&significance.spec, text, sizeof text);
    ck_assert_str_eq(text, "differential:rule=significance,z=2.5,start=20,trend=3,last=full,noise=poisson");
    const subject given = subject_of("differential:rule=significance,trend=5");
    pm__spec_format(&given.spec, text, sizeof text);
    ck_assert_str_eq(text, "differential:rule=significance,z=2.5,start=20,trend=5,last=full,noise=poisson");
}
END_TEST

/* Photons at measure 1, 2, ..., 30 keep E_n = 1; then empty space, so that E falls with every photon to come. */
START_TEST(test_differential_stops_where_the_trend_shows)
{
    hood_init(&h, 2);
    for (int n = 1; n <= 100; n++) {
        const double measure = n <= 30 ? n : 30 + 4 * (n - 30);
        hood_add(&h, sqrt(measure / pi), 0);
    }
    const subject monotone = subject_of("differential:trend=7,start=30");
    PM_CHECK_NEAR(estimate_of(&monotone, &h.lookup), 37 / (30 + 4 * 7.0), 1e-6);
    /* stages 30, 36, 43, 52: after three the fall of ln E is 0.73, 5.9 times sqrt(1/30 - 1/52) = 0.119 */
    const subject significance = subject_of("differential:rule=significance,start=30,z=5");
    PM_CHECK_NEAR(estimate_of(&significance, &h.lookup), 52 / (30 + 4 * 22.0), 1e-6);
    /* never 50 standard deviations */
    const subject never = subject_of("differential:rule=significance,start=30,z=50");
    PM_CHECK_NEAR(estimate_of(&never, &h.lookup), 100 / (30 + 4 * 70.0), 1e-6);
    /* ln E falls by 0.82 to 52 and 0.95 to 62: with sqrt(0.59 30^-1.5) = 0.0599 that is 13.7 and 15.9 */
    const subject even = subject_of("differential:rule=significance,start=30,z=15,noise=stratified");
    PM_CHECK_NEAR(estimate_of(&even, &h.lookup), 62 / (30 + 4 * 32.0), 1e-6);
}
END_TEST

/* Nor does E = 0 make a trend while no photon has flux, nor photons at the query point itself a first estimate. */
START_TEST(test_differential_waits_for_an_estimate)
{
    const subject monotone = subject_of("differential:trend=7");
    hood_init(&h, 2);
    for (int n = 1; n <= 100; n++) {
        hood_add(&h, sqrt(n / pi), 0);
        h.flux[n - 1][0] = h.flux[n - 1][1] = h.flux[n - 1][2] = n > 40 ? 1.0f : 0.0f;
    }
    PM_CHECK_NEAR(estimate_of(&monotone, &h.lookup), 7 / 47.0, 1e-6);
    hood_init(&h, 2);
    for (int n = 1; n <= 100; n++)
        hood_add(&h, n > 25 ? sqrt((26 + 4 * (n - 26)) / pi) : 0, 0);
    PM_CHECK_NEAR(estimate_of(&monotone, &h.lookup), 33 / (26 + 4 * 7.0), 1e-6);
}
END_TEST

START_TEST(test_uniform_means)
{
    static const struct {
        const char *name;
        size_t k;
        double want;
    } table[] = {{"differential:last=none", 50, 1.0},
                 {"differential:rule=significance,last=none", 500, 1.0},
                 {"differential", 50, NAN},
                 {"differential", 15, 15 / 14.0},
                 {"hull:boundary=0", 10, 1.0},
                 {"hull:boundary=0", 3, 0.0},
                 {"hull:boundary=0,outside=zero", 4, 0.25},
                 {"hull", 10, NAN},
                 {"combined:maps=16", 64, 64 / 63.0},
                 {"combined:maps=16,last=half", 64, 63.5 / 63.0},
                 {"combined:maps=16,last=none", 64, 1.0},
                 {"combined:maps=16,rule=mean", 64, 4 / 3.0},
                 {"combined:maps=2,rule=mean", 9, (4 / 3.0 + 5 / 4.0) / 2},
                 {"combined:maps=16,rule=mean,last=none", 64, 1.0},
                 {"oracle:last=none", 50, 1.0},
                 {"oracle:last=half", 50, NAN}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const subject s = subject_of(table[i].name);
        const double got = s.estimator->uniform_mean(s.spec.values, table[i].k, 2);
        if (isnan(table[i].want))
            ck_assert(isnan(got));
        else
            PM_CHECK_NEAR(got, table[i].want, 1e-15);
    }
    const subject keep = subject_of("hull:boundary=0"), zero = subject_of("hull:boundary=0,outside=zero");
    ck_assert(keep.estimator->holds_at_edges(keep.spec.values));
    ck_assert(!zero.estimator->holds_at_edges(zero.spec.values));
}
END_TEST

PM_TEST_MAIN("estimators", test_estimates_in_closed_form, test_cut_lookups, test_oracle_uses_its_number,
             test_every_last_of_equal_photons, test_combined_sets, test_scales_exactly, test_degenerate_regions,
             test_differential_resolves_its_trend, test_differential_stops_where_the_trend_shows,
             test_differential_waits_for_an_estimate, test_uniform_means)
