/* Equal distances, more of them than are asked for: the lower index wins, whatever the search's order. Whole lattices
 * about the query, and points of one distance alone, in an order of their own each. */
#include "test.h"

static void shuffle(pm__hood *hood, pm__dice *dice)
{
    for (size_t i = hood->count; i-- > 1;) {
        const size_t j = (size_t)pm__roll_between(dice, 0, (int)i);
        const pm_photon p = hood->photons[i];
        hood->photons[i] = hood->photons[j];
        hood->photons[j] = p;
    }
}

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int sides[] = {1, 2, 4, 6};
    const int side = sides[set % 4];
    const bool deep = set / 4 % 2 == 1;
    for (int x = -side; x <= side; x++)
        for (int y = -side; y <= side; y++)
            for (int z = deep ? -side : 0; z <= (deep ? side : 0); z++)
                pm__hood_add(hood, dice, 16 * x, 16 * y, 16 * z);
    shuffle(hood, dice);
    hood->query.k = (size_t)pm__roll_between(dice, 12, 40);
    hood->query.max_radius = 16.0f * (float)pm__roll_between(dice, 1, side) / PM__HOOD_STEPS;
    pm__hood_say(hood, "a lattice of %zu%s, k = %zu", hood->count, deep ? " in space" : "", hood->query.k);
}

const pm__stress_test pm__stress_test_ties = {
    .name = "ties", .summary = "equal distances, more than are asked for", .quick = 16, .full = 32, .make = make};
