/* First radii of progressive methods. */
#include "../progress.h"

/* The grid finds all photons within a radius and nothing else: radii of the k nearest come by another way, and are the
 * same. */
START_TEST(whatever_the_search)
{
    progress *const any = progress_open(progress_create("scene:furnace", "ppm", "disc", 0.0));
    progress *const grid = progress_create("scene:furnace", "ppm", "disc", 0.0);
    grid->config.search = pm_search_find("grid");
    ck_assert_ptr_nonnull(grid->config.search);
    (void)progress_open(grid);
    for (size_t i = 0; i < any->progression.points; i++) {
        ck_assert_double_gt((double)any->progression.radius[i], 0.0);
        ck_assert_double_eq((double)any->progression.radius[i], (double)grid->progression.radius[i]);
    }
    progress_free(any);
    progress_free(grid);
}
END_TEST

PM_TEST_MAIN("first radii", whatever_the_search)
