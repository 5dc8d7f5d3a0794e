/* Powers from 1e-38 to 1e38 W in one neighbourhood: double has room for all of it, single precision has not. */
#include "test.h"

#include <float.h>
#include <math.h>

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const char *const names[] = {"1e-38 to 1e38 W", "1e38 W and 1e-38 W by turns", "the largest float each"};
    pm__hood_scatter(hood, dice, 120, 300, set % 2 == 1);
    for (size_t i = 0; i < hood->count; i++)
        for (int c = 0; c < 3; c++)
            hood->photons[i].power[c] = set % 3 == 0   ? (float)pow(10.0, 76.0 * pm__roll(dice) - 38.0)
                                        : set % 3 == 1 ? i % 2 ? 1e38f : 1e-38f
                                                       : FLT_MAX;
    hood->query.k = set % 4 < 2 ? 40 : 12;
    pm__hood_say(hood, "powers of %s", names[set % 3]);
}

const pm__stress_test pm__stress_test_powers = {
    .name = "powers", .summary = "powers of 1e-38 to 1e38 W in one neighbourhood", .quick = 12, .full = 36,
    .make = make};
