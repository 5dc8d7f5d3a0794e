/* Far from the origin: extents of 1 m at 1e5 m, where floats are 2^-7 m apart, and so everywhere on a lattice; 1e-3 m
 * at 1e7 m, where floats are 1 m apart and all photons are at one point, which has a status. */
#include "test.h"

#include <math.h>

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const double offsets[] = {1e5, -1e5, 1e7};
    static const int axes[] = {1, 2, 4, 7, 5}; /* bit a: axis a is shifted */
    const double offset = offsets[set % 3], extent = set % 3 == 2 ? 1e-3 : 1.0;
    const int shifted = axes[set / 3 % 5];
    pm__hood_scatter(hood, dice, 200, 1000, set / 3 % 2 == 1);
    for (size_t i = 0; i < hood->count; i++)
        for (int a = 0; a < 3; a++) {
            const double x = (double)hood->photons[i].position[a] * extent;
            hood->photons[i].position[a] = (float)((shifted >> a & 1 ? offset : 0.0) + x);
        }
    for (int a = 0; a < 3; a++)
        hood->query.position[a] = shifted >> a & 1 ? (float)offset : 0.0f;
    hood->query.max_radius = (float)(0.5 * extent);
    hood->rounds = extent != 1.0 && shifted != 7; /* 1e-3 is on no lattice */
    pm__hood_say(hood, "%g m at %g m along axes %d", extent, offset, shifted);
}

const pm__stress_test pm__stress_test_offsets = {
    .name = "offsets", .summary = "1 m at 1e5 m, and 1e-3 m at 1e7 m", .quick = 15, .full = 45, .make = make};
