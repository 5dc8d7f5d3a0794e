/* Extents from 1e-30 to 1e30 m, and to where floats end. By powers of two nothing rounds; by powers of ten each
 * coordinate does. */
#include "test.h"

#include <math.h>

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int twos[] = {-130, -100, -40, 40, 100, 127};
    static const int tens[] = {-30, -20, -7, 7, 20, 30};
    const bool by_ten = set % 2 == 1;
    const int exponent = by_ten ? tens[set / 2 % 6] : twos[set / 2 % 6];
    pm__hood_scatter(hood, dice, 200, 1000, set / 4 % 2 == 1);
    hood->query.max_radius = 400.0f / PM__HOOD_STEPS;
    if (by_ten) {
        pm__hood_stretch(hood, (float)pow(10.0, exponent));
        hood->rounds = true;
    } else { /* 2^-130 is no float's inverse, nor a normal one */
        pm__hood_stretch(hood, ldexpf(1.0f, exponent / 2));
        pm__hood_stretch(hood, ldexpf(1.0f, exponent - exponent / 2));
    }
    pm__hood_say(hood, "extents of %s%d m", by_ten ? "1e" : "2^", exponent);
}

const pm__stress_test pm__stress_test_extents = {
    .name = "extents", .summary = "extents of 1e-30 to 1e30 m", .quick = 12, .full = 36, .make = make};
