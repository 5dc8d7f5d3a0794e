/* The point sets of the search bench: where their photons lie, and that nothing but seed and number matters. */
#include "../../bench/workloads.h"
#include "../test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 20000 };

static pm_photon photons[COUNT], others[COUNT];
static pm_surface_point queries[COUNT];

static const pm__workload *find(const char *name)
{
    const pm__entry *const entry = pm__find(&pm__workloads, name);
    ck_assert_msg(entry != NULL, "no point set %s", name);
    return (const pm__workload *)(const void *)entry;
}

static void backwards(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    (void)context;
    while (count-- > 0)
        task(argument, count);
}

START_TEST(test_only_seed_and_number_matter)
{
    const pm_parallel reversed = {backwards, NULL};
    for (size_t w = 0; w < pm__workloads.count; w++) {
        const pm__workload *const workload = (const pm__workload *)(const void *)pm__workloads.entries[w];
        pm__workload_photons(workload, 7, COUNT, NULL, photons);
        pm__workload_photons(workload, 7, COUNT, &reversed, others);
        ck_assert_int_eq(memcmp(photons, others, sizeof photons), 0);
        pm__workload_photons(workload, 7, 100, NULL, others);
        for (size_t i = 0; i < 100; i++)
            ck_assert_int_eq(memcmp(photons[i].position, others[i].position, sizeof photons[i].position), 0);
        pm__workload_photons(workload, 8, COUNT, NULL, others);
        ck_assert_int_ne(memcmp(photons, others, sizeof photons), 0);
    }
}
END_TEST

START_TEST(test_directions_are_unit_and_power_adds_up)
{
    for (size_t w = 0; w < pm__workloads.count; w++) {
        double power = 0.0;
        pm__workload_photons((const pm__workload *)(const void *)pm__workloads.entries[w], 1, COUNT, NULL, photons);
        for (size_t i = 0; i < COUNT; i++) {
            double square = 0.0;
            for (int a = 0; a < 3; a++)
                square += (double)photons[i].direction[a] * (double)photons[i].direction[a];
            PM_CHECK_NEAR(square, 1.0, 1e-5);
            power += (double)photons[i].power[0];
        }
        PM_CHECK_NEAR(power, 1.0, 1e-5);
    }
}
END_TEST

/* Distance to the sphere that a point of the box lies on, or to the nearest wall; the layout is restated here. */
static double off_surface(const double p[3])
{
    static const double centres[2][3] = {{-0.42, 0.3, -0.65}, {0.42, -0.28, -0.65}};
    double best = INFINITY;
    for (int a = 0; a < 3; a++)
        best = fmin(best, fabs(1.0 - fabs(p[a])));
    for (int s = 0; s < 2; s++) {
        const double d[3] = {p[0] - centres[s][0], p[1] - centres[s][1], p[2] - centres[s][2]};
        best = fmin(best, fabs(sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - 0.35));
    }
    return best;
}

START_TEST(test_box_photons_lie_on_surfaces_and_arrive_from_the_front)
{
    size_t on_spheres = 0;
    for (uint64_t i = 0; i < COUNT; i++) {
        double u[PM__WORKLOAD_NUMBERS];
        pm__workload_point point;
        pm__random_uniform(3, PM__FOR_TESTS, 0, i, u, PM__WORKLOAD_NUMBERS);
        find("box")->draw(u, &point);
        ck_assert_double_lt(off_surface(point.position), 1e-12);
        double along = 0.0;
        for (int a = 0; a < 3; a++) {
            along += point.normal[a] * point.direction[a];
            ck_assert_double_le(fabs(point.position[a]), 1.0);
        }
        ck_assert_double_lt(along, 0.0);
        on_spheres += fabs(point.position[0]) < 1.0 && fabs(point.position[1]) < 1.0 && fabs(point.position[2]) < 1.0;
    }
    ck_assert_uint_gt(on_spheres, COUNT / 100); /* the spheres are hit ... */
    ck_assert_uint_lt(on_spheres, COUNT / 2);   /* ... and not only they */
}
END_TEST

/* First hits straight from the light: the share that lands in a patch below it is its form factor. By Monte Carlo's own
 * integral: from a small light at height 2, a floor disc of radius R takes R^2 / (R^2 + 4) of a point light's flux. */
START_TEST(test_cosine_emission_has_the_form_factor_of_a_disc)
{
    const double down[3] = {0.0, 0.0, -1.0};
    size_t inside = 0;
    for (uint64_t i = 0; i < COUNT; i++) {
        double u[2], d[3];
        pm__random_uniform(5, PM__FOR_TESTS, 1, i, u, 2);
        pm__cosine_direction(down, u, d);
        inside += (d[0] * d[0] + d[1] * d[1]) * 4.0 / (d[2] * d[2]) < 0.25; /* R = 0.5 */
    }
    const double p = 0.25 / 4.25, sigma = sqrt(p * (1.0 - p) / COUNT);
    PM_CHECK_NEAR((double)inside / COUNT, p, 5.5 * sigma);
}
END_TEST

enum { STEPS = 600 };

static void trace_nephroid(double curve[STEPS][2])
{
    for (int j = 0; j < STEPS; j++) {
        const double t = j * (6.283185307179586 / STEPS);
        curve[j][0] = 0.25 * (3.0 * cos(t) - cos(3.0 * t));
        curve[j][1] = 0.25 * (3.0 * sin(t) - sin(3.0 * t));
    }
}

static double off_curve(double curve[STEPS][2], double x, double y)
{
    double nearest = INFINITY;
    for (int j = 0; j < STEPS; j++)
        nearest = fmin(nearest, (x - curve[j][0]) * (x - curve[j][0]) + (y - curve[j][1]) * (y - curve[j][1]));
    return sqrt(nearest);
}

/* Blurred by 0.01, of the four fifths on the curve exp(-7^2 / 2) = 2e-11 are more than 0.07 away from where they
 * started; of the uniform fifth those are whose part of the square lies beyond, which a grid of points tells to 1e-4:
 * its cells of 0.02 err on the band's rims alone, some 600 cells of area 4e-4 that err by chance. Bound: 5.5 sigma. */
START_TEST(test_caustic_follows_the_nephroid)
{
    enum { CELLS = 100 };
    double curve[STEPS][2];
    size_t far = 0, beyond = 0;
    trace_nephroid(curve);
    pm__workload_photons(find("caustic"), 1, COUNT, NULL, photons);
    for (size_t i = 0; i < COUNT; i++)
        far += off_curve(curve, (double)photons[i].position[0], (double)photons[i].position[1]) > 0.07;
    for (size_t i = 0; i < (size_t)CELLS * CELLS; i++)
        beyond += off_curve(curve, 2.0 * ((double)(i % CELLS) + 0.5) / CELLS - 1.0,
                               2.0 * ((double)(i / CELLS) + 0.5) / CELLS - 1.0) > 0.07;
    const double share = 0.2 * (double)beyond / (CELLS * CELLS);
    PM_CHECK_NEAR((double)far / COUNT, share, 5.5 * sqrt(share * (1.0 - share) / COUNT) + 5e-4);
}
END_TEST

static int compare_positions(const void *a, const void *b)
{
    return memcmp(((const pm_photon *)a)->position, ((const pm_photon *)b)->position, 3 * sizeof(float));
}

START_TEST(test_duplicates_repeat)
{
    size_t distinct = 1, longest = 1, length = 1;
    pm__workload_photons(find("duplicates"), 1, COUNT, NULL, photons);
    qsort(photons, COUNT, sizeof *photons, compare_positions);
    for (size_t i = 1; i < COUNT; i++) {
        const bool same = compare_positions(&photons[i - 1], &photons[i]) == 0;
        length = same ? length + 1 : 1;
        longest = length > longest ? length : longest;
        distinct += !same;
    }
    ck_assert_uint_gt(longest, 15); /* 10 a point in the mean */
    ck_assert_uint_lt(distinct, COUNT / 2 + 1001);
}
END_TEST

static double path_length(void)
{
    double sum = 0.0;
    for (size_t i = 1; i < COUNT; i++) {
        double square = 0.0;
        for (int a = 0; a < 3; a++)
            square += pow((double)queries[i].position[a] - (double)queries[i - 1].position[a], 2.0);
        sum += sqrt(square);
    }
    return sum;
}

START_TEST(test_morton_order_is_coherent_and_a_permutation)
{
    double before[3] = {0.0, 0.0, 0.0}, after[3] = {0.0, 0.0, 0.0};
    pm__workload_queries(find("volume"), 1, COUNT, NULL, queries);
    const double random_path = path_length();
    for (size_t i = 0; i < COUNT; i++)
        for (int a = 0; a < 3; a++)
            before[a] += (double)queries[i].position[a];
    ck_assert_int_eq(pm__morton_order(queries, COUNT), PM_OK);
    for (size_t i = 0; i < COUNT; i++)
        for (int a = 0; a < 3; a++)
            after[a] += (double)queries[i].position[a];
    for (int a = 0; a < 3; a++)
        PM_CHECK_NEAR(after[a], before[a], 1e-6);
    ck_assert_double_lt(path_length(), 0.1 * random_path); /* 20000 points are 1/27 of the edge apart */
}
END_TEST

START_TEST(test_queries_of_given_photons_stay_near_them)
{
    pm__workload_photons(find("square"), 1, COUNT, NULL, photons);
    pm__photon_queries(photons, NULL, COUNT, 1, COUNT, queries);
    for (size_t i = 0; i < COUNT; i++) {
        double square = 0.0;
        for (int a = 0; a < 3; a++) {
            square += (double)queries[i].normal[a] * (double)queries[i].normal[a];
            ck_assert_double_le(fabs((double)queries[i].position[a] - 0.5), 0.55);
        }
        PM_CHECK_NEAR(square, 1.0, 1e-5);
    }
    pm__photon_queries(NULL, NULL, 0, 1, COUNT, queries); /* none: at the origin */
    ck_assert(!(queries[0].position[0] != 0.0f));
}
END_TEST

PM_TEST_MAIN("workloads", test_only_seed_and_number_matter, test_directions_are_unit_and_power_adds_up,
             test_box_photons_lie_on_surfaces_and_arrive_from_the_front,
             test_cosine_emission_has_the_form_factor_of_a_disc, test_caustic_follows_the_nephroid,
             test_duplicates_repeat, test_morton_order_is_coherent_and_a_permutation,
             test_queries_of_given_photons_stay_near_them)
