/* Nothing to find: no photons at all, none within the radius, a radius of 0, all on the other side. */
#include "test.h"

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const char *const names[] = {"no photons", "none within the radius", "a radius of 0", "all from behind"};
    const size_t kind = set % 4;
    if (kind)
        pm__hood_scatter(hood, dice, set / 4 % 2 ? 300 : 16, 200, set % 2 == 1);
    if (kind == 1)
        hood->query.position[0] = 1000.0f / PM__HOOD_STEPS;
    if (kind == 2)
        hood->query.max_radius = 0.0f;
    hood->query.front_only = kind == 3;
    for (size_t i = 0; i < hood->count && kind == 3; i++)
        hood->photons[i].direction[2] = 1.0f;
    pm__hood_say(hood, "%s (of %zu)", names[kind], hood->count);
}

const pm__stress_test pm__stress_test_empty = {
    .name = "empty", .summary = "neighbourhoods without a photon", .quick = 8, .full = 32, .make = make};
