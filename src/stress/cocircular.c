/* Photons on a circle about the query, exactly: whole x and y with x^2 + y^2 = (5 13 17 / d)^2. All tie, all are
 * corners of the hull, and all are farthest. With some in the middle, and repeated. */
#include "test.h"

static void add_circle(pm__hood *hood, pm__dice *dice, int radius, int repeat)
{
    for (int x = -radius; x <= radius; x++)
        for (int y = -radius; y <= radius; y++)
            for (int i = 0; i < repeat && x * x + y * y == radius * radius; i++)
                pm__hood_add(hood, dice, x, y, 0);
}

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const int radii[] = {5, 25, 65, 325};
    const int radius = radii[set % 4], inside = (int)(set / 4 % 3) * 7;
    add_circle(hood, dice, radius, 1 + (int)(set / 12 % 2));
    for (int i = 0; i < inside; i++) {
        const int reach = radius / 2;
        pm__hood_add(hood, dice, pm__roll_between(dice, -reach, reach), pm__roll_between(dice, -reach, reach), 0);
    }
    hood->query.k = set % 2 ? hood->count : hood->count - 3;
    hood->query.max_radius = (float)radius / PM__HOOD_STEPS;
    pm__hood_say(hood, "%zu photons, all but %d on a circle, k = %zu", hood->count, inside, hood->query.k);
}

const pm__stress_test pm__stress_test_cocircular = {
    .name = "cocircular", .summary = "photons on a circle about the query, exactly", .quick = 12, .full = 36,
    .make = make};
