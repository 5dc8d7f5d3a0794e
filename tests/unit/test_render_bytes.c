/* What a render says that it will hold, against what film.h, image.h and photonmap.h say of each thing, by hand. */
#include "../test.h"

#include "../../src/base/param.h"
#include "../../src/methods/method.h"

enum { PIXELS = 20 * 10, PHOTONS = 1000 };

static double bytes_of(const char *method, const char *const *names, size_t count, size_t trials, bool aov)
{
    pm__spec spec;
    pm_error error = {""};
    pm_estimator *estimators[4] = {NULL};
    PM_CHECK_OK(pm__spec_parse(&pm__methods, method, &spec, &error), error);
    for (size_t i = 0; i < count; i++)
        PM_CHECK_OK(pm_estimator_create(names[i], &estimators[i], &error), error);
    const pm__render_config config = {.method = &spec,
                                      .estimators = (const pm_estimator *const *)estimators,
                                      .estimator_count = count,
                                      .search = pm_search_find("brute"),
                                      .photons = PHOTONS,
                                      .width = 20,
                                      .height = 10,
                                      .trials = trials,
                                      .aov = aov};
    const double bytes = pm__render_bytes(&config);
    for (size_t i = 0; i < count; i++)
        pm_estimator_destroy(estimators[i]);
    return bytes;
}

/* A pixel of a film: sum and first image 24 each, radius and count 8 each; in the image 12. With further images: radius
 * and count 4 each; of several trials mean and squares 24 each and noise 12; of one trial without maps squares and
 * noise. A photon: 36 as traced; position and index 16, power 12 in the map, and 4 more while it is built. */
START_TEST(by_hand)
{
    static const char *const names[] = {"disc", "cone", "combined"};
    const double map = PHOTONS * (36.0 + 16.0 + 12.0 + 4.0), own = PHOTONS * (16.0 + 12.0);
    ck_assert_double_eq(bytes_of("visualize", names, 1, 1, false), PIXELS * 76.0 + map);
    ck_assert_double_eq(bytes_of("visualize", names, 2, 1, false), 2 * PIXELS * 76.0 + map);
    ck_assert_double_eq(bytes_of("full", names, 3, 1, false), 3 * PIXELS * 76.0 + map + own);
    ck_assert_double_eq(bytes_of("visualize", names, 1, 8, false), PIXELS * 76.0 + map);
    ck_assert_double_eq(bytes_of("visualize", names, 1, 8, true), PIXELS * (76.0 + 8.0 + 60.0) + map);
    ck_assert_double_eq(bytes_of("visualize", names, 1, 1, true), PIXELS * (76.0 + 8.0) + map);
    ck_assert_double_eq(bytes_of("path", names, 1, 1, false), PIXELS * 76.0);
    ck_assert_double_eq(bytes_of("path", names, 3, 1, true), PIXELS * (76.0 + 36.0));
    ck_assert_double_eq(bytes_of("path", names, 1, 8, true), PIXELS * (76.0 + 60.0));
}
END_TEST

PM_TEST_MAIN("render bytes", by_hand)
