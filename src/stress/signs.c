/* Powers that are zero, negative, denormal, or that cancel. */
#include "test.h"

#include <math.h>

static float power(size_t set, size_t i, pm__dice *dice)
{
    const float any = (float)exp2(20.0 * pm__roll(dice) - 10.0);
    switch (set % 5) {
    case 0:
        return i % 2 ? 0.0f : any;
    case 1:
        return pm__roll(dice) < 0.5 ? any : -any;
    case 2:
        return ldexpf(1.0f, -149 + pm__roll_between(dice, 0, 22));
    case 3:
        return i % 2 ? 1.0f : -1.0f; /* an even number of them are nothing at all */
    default:
        return -0.0f;
    }
}

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const char *const names[] = {"every other 0", "of either sign", "denormal", "1 and -1 by turns", "-0"};
    pm__hood_scatter(hood, dice, 120, 300, set / 5 % 2 == 1);
    for (size_t i = 0; i < hood->count; i++)
        for (int c = 0; c < 3; c++)
            hood->photons[i].power[c] = power(set, i, dice);
    hood->query.k = 40;
    pm__hood_say(hood, "powers %s", names[set % 5]);
}

const pm__stress_test pm__stress_test_signs = {
    .name = "signs", .summary = "zero, negative and denormal powers", .quick = 10, .full = 30, .make = make};
