/* Grazing normals, and normals of any length. Photons that arrive along the surface, by the least denormal from the
 * front or from behind; a plane seen from its edge, so that the hull is a sliver; squashed and flat lookups. */
#include "test.h"

#include <math.h>

static const float lengths[] = {1.0f, 1e-30f, 1e30f, 1e-45f, 3e38f};

/* Directions in the plane, but for a hair to either side, or for nothing. */
static void graze(pm__hood *hood, pm__dice *dice)
{
    static const float hairs[] = {0x1p-149f, -0x1p-149f, 0.0f, -0.0f, 1e-20f, -1e-20f, 0x1p-12f, -0x1p-12f};
    for (size_t i = 0; i < hood->count; i++) {
        float *const d = hood->photons[i].direction;
        const double around = 6.283185307179586 * pm__roll(dice);
        d[0] = (float)cos(around);
        d[1] = (float)sin(around);
        d[2] = hairs[pm__roll_between(dice, 0, 7)];
    }
    hood->query.front_only = true;
}

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const float tilts[] = {0.5f, 0x1p-6f, 0x1p-12f, 0x1p-19f};
    const size_t kind = set % 4;
    float *const n = hood->query.normal;
    pm__hood_scatter(hood, dice, 200, 1000, kind == 3);
    n[2] = lengths[set / 4 % 5];
    hood->query.max_radius = 500.0f / PM__HOOD_STEPS;
    if (kind == 0)
        graze(hood, dice);
    if (kind == 1) {
        n[0] = 1.0f;
        n[2] = tilts[set / 4 % 4];
    }
    if (kind == 2) {
        hood->query.shape = PM_LOOKUP_ELLIPSOID;
        hood->query.shape_parameter = (float)(1 << (set / 4 % 5 * 5));
    }
    if (kind == 3) {
        hood->query.shape = PM_LOOKUP_DISC;
        hood->query.shape_parameter = 100.0f / PM__HOOD_STEPS;
    }
    hood->rounds = kind == 1;
    pm__hood_say(hood, kind == 0   ? "directions along the surface, a normal of length %g"
                       : kind == 1 ? "a plane seen from its edge, %g"
                       : kind == 2 ? "squashed %g times"
                                   : "a disc of half height %g",
                 kind == 0 || kind == 1 ? (double)n[2] : (double)hood->query.shape_parameter);
}

const pm__stress_test pm__stress_test_grazing = {
    .name = "grazing", .summary = "directions and planes along the surface, normals of any length", .quick = 20,
    .full = 60, .make = make};
