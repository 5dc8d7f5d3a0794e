/* Sine and cosine of turns against libm in extended precision. There u is reduced to half a turn before 2 pi comes in,
 * which in binary is exact: what is left is libm's own rounding, 2^-64. */
#include "../../src/base/random.h"
#include "../../src/base/turn.h"
#include "../test.h"

#include <float.h>

enum { RANDOM = 200000 };

static void check_turns(double u)
{
    const long double angle = 6.28318530717958647692528676655900577L * ((long double)u - rintl((long double)u));
    double sine, cosine;
    pm__turns(u, &sine, &cosine);
    const long double off = fabsl((long double)sine - sinl(angle)), away = fabsl((long double)cosine - cosl(angle));
    ck_assert_msg(off <= 0x1p-52L && away <= 0x1p-52L, "%.17g (%a) turns: sine %.17g, cosine %.17g; off by %Lg, %Lg",
                  u, u, sine, cosine, off, away);
    /* The circle mirrored: to the last bit. */
    double back, same;
    pm__turns(-u, &back, &same);
    ck_assert_msg(back == -sine && same == cosine, "%.17g turns and back: %.17g %.17g, %.17g %.17g", u, sine, back,
                  cosine, same);
}

/* Numbers of every size up to 2^48, and up to a million where waves are. */
START_TEST(test_random_turns)
{
    for (uint64_t i = 0; i < RANDOM; i++) {
        double u[2];
        pm__random_uniform(7, PM__FOR_TESTS, 0, i, u, 2);
        check_turns(2.0 * u[0] - 1.0);
        check_turns(1e6 * (2.0 * u[0] - 1.0));
        check_turns((2.0 * u[0] - 1.0) * ldexp(1.0, (int)(108.0 * u[1]) - 60));
    }
}
END_TEST

/* Where a quarter ends (an odd eighth) sine and cosine change places; at whole quarters signs change. */
START_TEST(test_ends_of_eighths)
{
    static const double whole[] = {0.0, 1.0, 2.0, 3.0, 100.0, 65535.0, 999999.0, 0x1p31, 0x1p32 + 1.0, 0x1p47};
    for (size_t w = 0; w < sizeof whole / sizeof *whole; w++)
        for (int eighth = 0; eighth <= 8; eighth++) {
            const double at = whole[w] + eighth / 8.0;
            check_turns(at);
            check_turns(nextafter(at, DBL_MAX));
            check_turns(nextafter(at, -DBL_MAX));
        }
}
END_TEST

/* Exactly so, at any number of quarters; and within half a turn the digits of pm__turn. */
START_TEST(test_quarters)
{
    for (int i = -4000000; i <= 4000000; i += i > -50 && i < 50 ? 1 : 997) {
        const int quarter = (i % 4 + 4) % 4;
        double sine, cosine;
        pm__turns(0.25 * i, &sine, &cosine);
        PM_CHECK_NEAR(sine, quarter == 1 ? 1.0 : quarter == 3 ? -1.0 : 0.0, 0.0);
        PM_CHECK_NEAR(cosine, quarter == 0 ? 1.0 : quarter == 2 ? -1.0 : 0.0, 0.0);
    }
    for (uint64_t i = 0; i < RANDOM; i++) {
        double u, sine[2], cosine[2];
        pm__random_uniform(7, PM__FOR_TESTS, 1, i, &u, 1);
        pm__turn(u, &sine[0], &cosine[0]);
        pm__turns(u, &sine[1], &cosine[1]);
        ck_assert_msg(sine[0] == sine[1] && cosine[0] == cosine[1], "%.17g: %.17g %.17g, %.17g %.17g", u, sine[0],
                      sine[1], cosine[0], cosine[1]);
    }
}
END_TEST

/* Halves go to the even neighbour, as rint has it. */
START_TEST(test_whole)
{
    for (int i = -1000; i <= 1000; i++)
        for (int step = -1; step <= 1; step++) {
            const double at = 0.25 * i, x = step == 0 ? at : nextafter(at, step * DBL_MAX);
            PM_CHECK_NEAR(pm__whole(x), rint(x), 0.0);
            PM_CHECK_NEAR(pm__whole(x + 0x1p50), rint(x + 0x1p50), 0.0);
            PM_CHECK_NEAR(pm__whole(x - 0x1p50), rint(x - 0x1p50), 0.0);
        }
    for (uint64_t i = 0; i < RANDOM; i++) {
        double u[2];
        pm__random_uniform(7, PM__FOR_TESTS, 2, i, u, 2);
        const double x = (2.0 * u[0] - 1.0) * ldexp(1.0, (int)(u[1] * 51.0));
        PM_CHECK_NEAR(pm__whole(x), rint(x), 0.0);
    }
}
END_TEST

/* Up to an eighth either way, both ends included. */
START_TEST(test_eighth)
{
    for (int i = -RANDOM; i <= RANDOM; i++) {
        const double r = 0.78539816339744830962 * i / RANDOM;
        double sine, cosine;
        pm__eighth(r, &sine, &cosine);
        ck_assert_msg(fabsl((long double)sine - sinl((long double)r)) <= 0x1p-52L &&
                          fabsl((long double)cosine - cosl((long double)r)) <= 0x1p-52L,
                      "%.17g: %.17g %.17g", r, sine, cosine);
    }
}
END_TEST

PM_TEST_MAIN("turn", test_random_turns, test_ends_of_eighths, test_quarters, test_whole, test_eighth)
