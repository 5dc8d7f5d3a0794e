/* All neighbours at distance 0: no area, so a status; and with one elsewhere. */
#include "test.h"

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int counts[] = {12, 20, 64, 300};
    const int count = counts[set % 4];
    const bool away = set / 4 % 2 == 1;
    const int x = set / 8 % 2 ? 600 : 0;
    for (int i = 0; i < count; i++)
        pm__hood_add(hood, dice, x, -x, 0);
    if (away)
        pm__hood_add(hood, dice, x + 3, 4 - x, 0);
    hood->query.position[0] = (float)x / PM__HOOD_STEPS;
    hood->query.position[1] = -(float)x / PM__HOOD_STEPS;
    hood->query.k = away ? hood->count : 12;
    hood->query.max_radius = set / 16 % 2 ? 0.0f : 5.0f / PM__HOOD_STEPS;
    pm__hood_say(hood, "%d photons at the query%s", count, away ? ", one 5 steps off" : "");
}

const pm__stress_test pm__stress_test_coincident = {
    .name = "coincident", .summary = "all neighbours at distance 0, or all but one", .quick = 32, .full = 32,
    .make = make};
