/* One photon, or the query, very far from the rest. Lengths are kept in units of the largest coordinate: near ones
 * shrink as a stray photon gets farther, until their squares underflow; that must show in a status, not in a number. */
#include "test.h"

#include <math.h>

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const double far[] = {1e5, 1e10, 1e15, 1e18, 1e20, 1e22, 1e25, 1e30, 3e38};
    const double distance = far[set % 9];
    const bool query = set / 9 % 2 == 1;
    pm__hood_scatter(hood, dice, 200, 1000, set % 2 == 1);
    hood->query.max_radius = 400.0f / PM__HOOD_STEPS;
    if (query) {
        const double reach = set / 18 % 2 || set % 2 == 0 ? 0.5 : 2.0; /* none, or all */
        hood->query.position[0] = (float)distance;
        hood->query.max_radius = (float)(distance < 1e38 ? reach * distance : 0.5 * distance);
        hood->rounds = true;
    } else {
        pm__hood_add(hood, dice, 0, 0, 0);
        hood->photons[hood->count - 1].position[set / 18 % 3] = (float)distance;
    }
    hood->coarse = true;
    pm__hood_say(hood, "%s at %g m", query ? "the query" : "one photon", distance);
}

const pm__stress_test pm__stress_test_stray = {
    .name = "stray", .summary = "one photon, or the query, up to 3e38 m from the rest", .quick = 18, .full = 54,
    .make = make};
