/* Many photons in few places: ties by the dozen at every distance, nodes without extent, splits that split nothing. */
#include "test.h"

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int places[] = {1, 2, 3, 5, 12, 40};
    static const size_t counts[] = {17, 48, 257, 900};
    const int some = places[set % 6];
    const size_t count = counts[set / 6 % 4];
    const bool deep = set % 2 == 1;
    int at[40][3];
    for (int i = 0; i < some; i++)
        for (int a = 0; a < 3; a++)
            at[i][a] = a == 2 && !deep ? 0 : pm__roll_between(dice, -40, 40);
    for (size_t i = 0; i < count; i++) {
        const int *const p = at[pm__roll_between(dice, 0, some - 1)];
        pm__hood_add(hood, dice, p[0], p[1], p[2]);
    }
    hood->query.k = 25;
    hood->query.max_radius = 30.0f / PM__HOOD_STEPS;
    pm__hood_say(hood, "%zu photons in %d places%s", count, some, deep ? " in space" : "");
}

const pm__stress_test pm__stress_test_duplicates = {
    .name = "duplicates", .summary = "many photons in the same few places", .quick = 12, .full = 36, .make = make};
