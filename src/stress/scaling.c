/* All lengths and powers times powers of two: the estimate follows to the last bit, whatever the photons. */
#include "test.h"

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int lengths[] = {1, -1, 7, -30, 100, -110, 0, 60};
    static const int powers[] = {0, 5, -20, 0, -60, 60, 100, -100};
    pm__hood_scatter(hood, dice, set % 3 ? 300 : 40, set % 3 == 1 ? 20 : 1000, set % 2 == 1);
    for (size_t i = 0; i < hood->count && set % 5 == 4; i++)
        hood->photons[i].position[1] = hood->photons[i].position[0]; /* a line: a status follows as well */
    hood->query.k = 30;
    hood->query.max_radius = 400.0f / PM__HOOD_STEPS;
    hood->query.position[0] = 11.0f / PM__HOOD_STEPS;
    hood->twin_length = lengths[set % 8];
    hood->twin_power = powers[(set + set / 8) % 8];
    pm__hood_say(hood, "lengths times 2^%d, powers times 2^%d", hood->twin_length, hood->twin_power);
}

const pm__stress_test pm__stress_test_scaling = {
    .name = "scaling", .summary = "lengths and powers times powers of two: the same bits", .quick = 16, .full = 48,
    .make = make};
