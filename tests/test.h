/* What every test file shares: a Check suite with its main, and a tolerance that says what it compared.
 *
 * A test file is a program: it defines tests with START_TEST and ends with PM_TEST_MAIN("name", test_a, test_b).
 * Randomness has fixed seeds; a statistical bound states its false-alarm rate. */
#ifndef PM_TESTS_TEST_H
#define PM_TESTS_TEST_H

#include <check.h>
#include <math.h>
#include <stdlib.h>

#define PM_CHECK_NEAR(got, want, tolerance)                                                                       \
    do {                                                                                                          \
        const double got_ = (got), want_ = (want), tolerance_ = (tolerance);                                      \
        ck_assert_msg(fabs(got_ - want_) <= tolerance_, "%s = %.17g, expected %.17g within %g", #got, got_, want_, \
                      tolerance_);                                                                                \
    } while (0)

#define PM_CHECK_OK(call, error)                                                                                \
    do {                                                                                                        \
        const pm_status status_ = (call);                                                                       \
        ck_assert_msg(status_ == PM_OK, "%s: %s (%s)", #call, pm_status_text(status_), (error).text);           \
    } while (0)

/* For mains of their own: the status to end with. */
static inline int pm__test_run(Suite *suite)
{
    SRunner *const runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

static inline int pm__test_main(const char *name, const TTest *const *tests, size_t count)
{
    Suite *const suite = suite_create(name);
    TCase *const tcase = tcase_create(name);
    tcase_set_timeout(tcase, getenv("PM_FULL") ? 3600 : 300);
    for (size_t i = 0; i < count; i++)
        tcase_add_test(tcase, tests[i]);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}

#define PM_TEST_MAIN(name, ...)                                                        \
    int main(void)                                                                     \
    {                                                                                  \
        const TTest *const tests[] = {__VA_ARGS__};                                    \
        return pm__test_main(name, tests, sizeof tests / sizeof *tests);               \
    }

#endif
