/* Sets turned and moved as a whole: coordinates round anew, and no verdict may change by it. */
#include "test.h"

#include <math.h>

/* Rotation by a random quaternion (Shoemake 1992). */
static void random_turn(pm__dice *dice, double m[3][3])
{
    const double a = 6.283185307179586 * pm__roll(dice), b = 6.283185307179586 * pm__roll(dice), u = pm__roll(dice);
    const double w = sqrt(u) * cos(b), x = sqrt(1.0 - u) * sin(a), y = sqrt(1.0 - u) * cos(a), z = sqrt(u) * sin(b);
    const double all[3][3] = {{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
                              {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
                              {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            m[i][j] = all[i][j];
}

static void move(double m[3][3], const double by[3], float v[3])
{
    const double old[3] = {(double)v[0], (double)v[1], (double)v[2]};
    for (int a = 0; a < 3; a++)
        v[a] = (float)(m[a][0] * old[0] + m[a][1] * old[1] + m[a][2] * old[2] + by[a]);
}

static void make(pm__hood *hood, size_t set, pm__dice *dice)
{
    static const double shifts[] = {0.0, 1.0, 30.0, 1000.0};
    static const double none[3] = {0.0, 0.0, 0.0};
    const double shift = shifts[set / 2 % 4];
    const double by[3] = {shift, -0.7 * shift, 0.3 * shift};
    const bool turned = set % 2 == 1, line = set % 8 == 7;
    double m[3][3], straight[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    pm__hood_scatter(hood, dice, line ? 50 : 200, 1000, set / 8 % 2 == 1);
    for (size_t i = 0; i < hood->count && line; i++)
        hood->photons[i].position[1] = hood->photons[i].position[2] = 0.0f;
    hood->query.max_radius = 400.0f / PM__HOOD_STEPS;
    random_turn(dice, m);
    for (size_t i = 0; i < hood->count; i++) {
        move(turned ? m : straight, by, hood->photons[i].position);
        move(turned ? m : straight, none, hood->photons[i].direction);
    }
    move(turned ? m : straight, by, hood->query.position);
    move(turned ? m : straight, none, hood->query.normal);
    hood->rounds = true;
    pm__hood_say(hood, "%s, %smoved by %g m", line ? "a line" : "a scatter", turned ? "turned and " : "", shift);
}

const pm__stress_test pm__stress_test_motion = {
    .name = "motion", .summary = "turned and moved as a whole", .quick = 16, .full = 48, .make = make};
