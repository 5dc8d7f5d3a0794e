/* One photon, or a few: fewer than any estimator would like, at the query, near it, or out of reach. */
#include "test.h"

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int away[] = {0, 1, 300, 1000};
    const int count = 1 + (int)(set / 4 % 4), x = away[set % 4];
    for (int i = 0; i < count; i++)
        pm__hood_add(hood, dice, x, i * i, 0);
    hood->query.k = set / 16 % 2 ? 3 : 20;
    pm__hood_say(hood, "%d photon%s, the first %d steps away, k = %zu", count, count > 1 ? "s" : "", x, hood->query.k);
}

const pm__stress_test pm__stress_test_single = {
    .name = "single", .summary = "one photon, or a few", .quick = 32, .full = 32, .make = make};
