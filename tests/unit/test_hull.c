/* The hull estimate on point sets whose hull is plain to see. */
#include "../../src/base/vec3.h"
#include "../neighborhood.h"

static hood h;

static pm_status hull_of(const double (*points)[2], size_t count, const char *name, double *value)
{
    const subject s = subject_of(name);
    double result[3] = {NAN, NAN, NAN};
    hood_init(&h, 2);
    for (size_t i = 0; i < count; i++)
        hood_add(&h, points[i][0], points[i][1]);
    const pm_status status = s.estimator->estimate(s.spec.values, &h.lookup, result);
    *value = result[0];
    return status;
}

#define CHECK_HULL(points, name, want)                                                             \
    do {                                                                                           \
        double value_;                                                                             \
        ck_assert_int_eq(hull_of(points, sizeof(points) / sizeof *(points), name, &value_), PM_OK); \
        PM_CHECK_NEAR(value_, want, 1e-14);                                                        \
    } while (0)

START_TEST(test_hull_counts)
{
    static const double square[][2] = {{0, 0}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
    CHECK_HULL(square, "hull:boundary=0", 1 / 4.0);
    CHECK_HULL(square, "hull:boundary=1", 5 / 4.0);
    CHECK_HULL(square, "hull", 1.8 / 4.0);

    /* On edges counts as boundary; coinciding photons count each; a doubled interior one stays inside. */
    static const double rim[][2] = {{0, 0},  {0, 0},  {1, 0},   {-1, 0},  {0, 1},  {0, -1}, {1, 1},
                                    {-1, 1}, {1, -1}, {-1, -1}, {-1, -1}, {1, 0},  {0.5, 1}};
    CHECK_HULL(rim, "hull:boundary=0", 2 / 4.0);
    CHECK_HULL(rim, "hull:boundary=1", 13 / 4.0);

    static const double triangle[][2] = {{0, 0}, {4, 0}, {0, 4}, {2, 2}, {1, 1}};
    CHECK_HULL(triangle, "hull:boundary=0", 1 / 8.0);

    /* All on one circle (exactly): all boundary. */
    static const double circle[][2] = {{5, 0},  {4, 3},  {3, 4},  {0, 5},  {-3, 4},  {-4, 3},
                                       {-5, 0}, {-4, -3}, {-3, -4}, {0, -5}, {3, -4}, {4, -3}};
    CHECK_HULL(circle, "hull:boundary=0", 0.0);
    CHECK_HULL(circle, "hull:boundary=1", 12 / 74.0);
}
END_TEST

START_TEST(test_hull_degenerate)
{
    static const double two[][2] = {{0, 0}, {1, 1}};
    static const double one_point[][2] = {{0.3, 0.7}, {0.3, 0.7}, {0.3, 0.7}, {0.3, 0.7}};
    static const double all_at_0[][2] = {{0, 0}, {0, 0}, {0, 0}};
    static const double level[][2] = {{0, 0}, {1, 0}, {2, 0}, {-5, 0}};
    static const double upright[][2] = {{0, 0}, {0, 1}, {0, 2}, {0, -5}};
    static const double oblique[][2] = {{0, 0}, {0.1, 0.3}, {0.2, 0.6}, {-0.4, -1.2}, {0.7, 2.1}};
    static const double doubled[][2] = {{0, 0}, {1, 2}, {1, 2}, {0, 0}};
    double value;
#define FLAT(points) \
    ck_assert_int_eq(hull_of(points, sizeof(points) / sizeof *(points), "hull", &value), PM_EDEGENERATE)
    FLAT(two);
    FLAT(one_point);
    FLAT(all_at_0);
    FLAT(level);
    FLAT(upright);
    FLAT(oblique);
    FLAT(doubled);
#undef FLAT
    static const double thin[][2] = {{0, 0}, {0, 1e-5}, {1, 0}, {1, 1e-5}, {0.5, 0.5e-5}};
    ck_assert_int_eq(hull_of(thin, 5, "hull:boundary=0", &value), PM_OK);
    PM_CHECK_NEAR(value, 1e5, 1.0);
}
END_TEST

START_TEST(test_hull_outside)
{
    static const double aside[][2] = {{1, 0}, {2, 1}, {2, -1}, {1.75, 0}};
    static const double at_rim[][2] = {{0, 1}, {2, 1}, {2, -1}, {0, -1}, {1, 0}};
    static const double at_corner[][2] = {{0, 0}, {2, 1}, {2, -1}, {1, 0}};
    CHECK_HULL(aside, "hull:boundary=0", 1.0);
    CHECK_HULL(aside, "hull:boundary=0,outside=zero", 0.0);
    CHECK_HULL(at_rim, "hull:boundary=0,outside=zero", 0.25);
    CHECK_HULL(at_corner, "hull:boundary=0,outside=zero", 0.5);
}
END_TEST

START_TEST(test_hull_scratch)
{
    static const double square[][2] = {{0, 0}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
    const subject s = subject_of("hull");
    double value, result[3];
    hull_of(square, 5, "hull", &value);
    h.lookup.scratch_size = 5 * s.estimator->scratch_per_photon;
    ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), PM_OK);
    h.lookup.scratch_size--;
    ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), PM_EINVAL);
    h.lookup.scratch = NULL;
    ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), PM_EINVAL);
}
END_TEST

/* The hull turns with the plane. */
START_TEST(test_hull_in_any_plane)
{
    stream random = {1, 0, 0};
    const subject s = subject_of("hull");
    for (int trial = 0; trial < 200; trial++) {
        hood_init(&h, 2);
        hood_poisson_in(&h, &random, 40, INFINITY, INFINITY);
        const double flat = estimate_of(&s, &h.lookup);
        double n[3] = {uniform(&random) - 0.5, uniform(&random) - 0.5, uniform(&random) - 0.5}, a[3], b[3];
        if (trial < 6) { /* along an axis and against it */
            memset(n, 0, sizeof n);
            n[trial / 2] = trial % 2 ? 1.0 : -1.0;
        }
        pm__normalize(n);
        pm__basis(n, a, b);
        for (int c = 0; c < 3; c++)
            h.lookup.normal[c] = (float)n[c];
        for (size_t i = 0; i < h.set.count; i++) {
            const double x = (double)h.offset[i][0], y = (double)h.offset[i][1], height = uniform(&random);
            for (int c = 0; c < 3; c++) /* heights above the plane do not matter */
                h.offset[i][c] = (float)(x * a[c] + y * b[c] + height * n[c]);
        }
        PM_CHECK_NEAR(estimate_of(&s, &h.lookup), flat, 1e-5 * flat);
    }
}
END_TEST

/* A normal that is unit but for rounding to float costs nothing: offsets (5x, 4y, -3y) are (5x, 5y) in the plane. */
START_TEST(test_hull_takes_float_normals)
{
    static const float corners[][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {0, 0}};
    const subject s = subject_of("hull:boundary=0");
    hood_init(&h, 2);
    h.lookup.normal[1] = 0.6f;
    h.lookup.normal[2] = 0.8f;
    for (size_t i = 0; i < 5; i++) {
        hood_add(&h, 0, 0);
        const float offset[] = {5 * corners[i][0], 4 * corners[i][1], -3 * corners[i][1]};
        memcpy(h.offset[i], offset, sizeof offset);
    }
    PM_CHECK_NEAR(estimate_of(&s, &h.lookup) * 50, 1.0, 1e-13);
}
END_TEST

PM_TEST_MAIN("hull", test_hull_counts, test_hull_degenerate, test_hull_outside, test_hull_scratch,
             test_hull_in_any_plane, test_hull_takes_float_normals)
