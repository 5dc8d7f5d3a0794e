/* The bench of tracing: what it compares is the same work, and what it refuses. Its times are not looked at here. */
#include "../../bench/tracing.h"
#include "../../cases/case.h"
#include "../test.h"

#include <string.h>

enum { PHOTONS = 300 };

static void check_row(const char *name, double agreement)
{
    pm__spec spec;
    pm__tracing_row row;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, name, &spec, &error), error);
    PM_CHECK_OK(pm__bench_tracing(&spec, PHOTONS, 0.0, &row, &error), error);
    ck_assert_str_eq(row.scene, spec.entry->name);
    ck_assert_uint_eq(row.photons, PHOTONS);
    ck_assert_uint_ge(row.rays, PHOTONS);
    const double times[] = {row.ns_per_ray_traced, row.ns_per_ray_scene, row.ns_per_ray_embree, row.ns_per_ray_robust};
    for (int i = 0; i < 4; i++)
        ck_assert_msg(times[i] > 0.0 && isfinite(times[i]), "%s: time %d is %g", name, i, times[i]);
    ck_assert(row.ratio > 0.0 && row.ratio_ci95.low <= row.ratio && row.ratio <= row.ratio_ci95.high);
    ck_assert(row.scene_ratio > 0.0 && row.robust_ratio > 0.0);
    ck_assert_msg(row.agreement >= agreement && row.agreement <= 1.0, "%s: agreement %g", name, row.agreement);
    ck_assert_uint_gt(row.samples, 0);
}

/* A closed room, and one of meshes, spheres and parts. What Embree has in other shapes (the disc's square, chords for
 * arcs) it may meet a little more or less often. */
START_TEST(test_rows)
{
    check_row("scene:integrating-sphere", 1.0);
    check_row("scene:fractal-cornell", 0.999);
    check_row("scene:nephroid", 0.8);
}
END_TEST

/* Rays that the recording sees are those that are traced: as many as photons need in a furnace, one and one more for
 * each reflection. */
START_TEST(test_rays)
{
    pm__spec spec;
    pm__tracing_row row;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, "scene:furnace:albedo=0", &spec, &error), error);
    PM_CHECK_OK(pm__bench_tracing(&spec, PHOTONS, 0.0, &row, &error), error);
    ck_assert_uint_eq(row.rays, PHOTONS);
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, "scene:furnace:albedo=0.9", &spec, &error), error);
    PM_CHECK_OK(pm__bench_tracing(&spec, 3000, 0.0, &row, &error), error);
    /* 10 rays a photon, standard deviation sqrt(90); 6 of the mean's: a false alarm once in 5e8 */
    PM_CHECK_NEAR((double)row.rays / 3000.0, 10.0, 6.0 * sqrt(90.0 / 3000.0));
}
END_TEST

START_TEST(test_refusals)
{
    pm__spec spec;
    pm__tracing_row row;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, "square", &spec, &error), error);
    ck_assert_int_eq(pm__bench_tracing(&spec, PHOTONS, 0.0, &row, &error), PM_EINVAL);
    ck_assert_ptr_nonnull(strstr(error.text, "square is not a scene"));
    PM_CHECK_OK(pm__spec_parse(&pm__all_cases, "scene:furnace", &spec, &error), error);
    ck_assert_int_eq(pm__bench_tracing(&spec, 0, 0.0, &row, &error), PM_EINVAL);
    ck_assert_ptr_nonnull(strstr(error.text, "no ray"));
}
END_TEST

PM_TEST_MAIN("tracing", test_rows, test_rays, test_refusals)
