/* Photons on a line, through the query or beside it, and lines with a photon or two aside: hulls of no area, of one
 * triangle full of points on its edges, and slivers. */
#include "test.h"

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int slopes[][2] = {{1, 0}, {0, 1}, {1, 1}, {3, 7}, {-5, 2}, {10, -1}};
    const int *const slope = slopes[set % 6];
    const int aside = (int)(set / 6 % 4), shift = set % 2 ? 9 : 0;
    for (int i = 0; i < 40; i++) {
        const int along = pm__roll_between(dice, -60, 60);
        pm__hood_add(hood, dice, shift + along * slope[0], along * slope[1], 0);
    }
    if (aside == 1 || aside == 2)
        pm__hood_add(hood, dice, shift - 20 * slope[1], 20 * slope[0], 0);
    if (aside == 2)
        pm__hood_add(hood, dice, shift + 25 * slope[1], -25 * slope[0], 0);
    if (aside == 3)
        pm__hood_add(hood, dice, shift + 5, 5, 0);
    hood->query.k = 30 + set % 12;
    hood->query.max_radius = 700.0f / PM__HOOD_STEPS;
    pm__hood_say(hood, "a line along %d, %d, %s", slope[0], slope[1],
                 aside == 0   ? "nothing beside it"
                 : aside == 3 ? "one close beside it"
                 : aside == 1 ? "one beside it"
                              : "one on either side");
}

const pm__stress_test pm__stress_test_collinear = {
    .name = "collinear", .summary = "photons on a line, with none, one or two aside", .quick = 24, .full = 48,
    .make = make};
