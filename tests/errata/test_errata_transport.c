/* Errata of photon tracing, shown without a scene. Bounds: 5.5 standard errors of the mean, a false alarm in 4e-8. */
#include "../../src/base/random.h"
#include "../test.h"

enum { RUNS = 40000, WANTED = 100 };

static const double share = 0.1; /* of emitted photons that are stored */

/* How many are emitted until the last that is wanted is stored: a sum of geometric numbers. */
static double emitted_until_stored(uint64_t run)
{
    double u[WANTED], sum = 0.0;
    pm__random_uniform(37, PM__FOR_TESTS, 0, run, u, WANTED);
    for (int i = 0; i < WANTED; i++)
        sum += floor(log1p(-u[i]) / log1p(-share)) + 1.0;
    return sum;
}

/* Dividing by the number emitted when the N-th was stored makes the light too bright by (1 - p) / N; one less of both
 * is right. */
START_TEST(erratum_37)
{
    double printed = 0.0, right = 0.0, square = 0.0;
    for (uint64_t run = 0; run < RUNS; run++) {
        const double emitted = emitted_until_stored(run), estimate = (WANTED - 1.0) / (emitted - 1.0) / share;
        printed += WANTED / emitted / share / RUNS;
        right += estimate / RUNS;
        square += estimate * estimate / RUNS;
    }
    const double error = sqrt((square - right * right) / RUNS);
    PM_CHECK_NEAR(right, 1.0, 5.5 * error);
    PM_CHECK_NEAR(printed, 1.0 + (1.0 - share) / WANTED, 5.5 * error + 1.5e-4); /* to the order 1 / N^2 */
    ck_assert_double_gt(printed - 1.0, 5.5 * error);
}
END_TEST

PM_TEST_MAIN("errata_transport", erratum_37)
