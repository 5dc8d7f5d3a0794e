/* All photons that there are: k = N - 1, N, N + 1 and far more, for N about the sizes of blocks and nodes. */
#include "test.h"

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const size_t counts[] = {3, 15, 16, 17, 64, 255, 256, 257, 1000, 4100};
    static const char *const names[] = {"k = N - 1", "k = N", "k = N + 1", "k = 1e9"};
    const size_t count = counts[set / 4 % 10];
    pm__hood_scatter(hood, dice, count, 1000, set % 2 == 1);
    hood->query.k = set % 4 == 3 ? 1000000000 : count - 1 + set % 4;
    hood->query.max_radius = 1000.0f / PM__HOOD_STEPS;
    pm__hood_say(hood, "%zu photons, %s", count, names[set % 4]);
}

const pm__stress_test pm__stress_test_whole = {
    .name = "whole", .summary = "k = N and beyond", .quick = 32, .full = 40, .make = make};
