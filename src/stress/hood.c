#include "hood.h"

#include "../base/random.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static const float step = 0x1p-10f;

double pm__roll(pm__dice *dice)
{
    double u;
    pm__random_uniform(dice->seed, PM__FOR_TESTS, dice->test, dice->number++, &u, 1);
    return u;
}

int pm__roll_between(pm__dice *dice, int low, int high)
{
    return low + (int)(pm__roll(dice) * (double)(high - low + 1));
}

void pm__hood_clear(pm__hood *hood)
{
    pm_photon *const photons = hood->photons;
    *hood = (pm__hood){.photons = photons};
    pm_query_init(&hood->query);
    hood->query.k = 20;
    hood->query.max_radius = 300.0f * step;
}

void pm__hood_add(pm__hood *hood, pm__dice *dice, int x, int y, int z)
{
    if (hood->count == PM__HOOD_MOST)
        return;
    pm_photon *const p = &hood->photons[hood->count++];
    const double up = 2.0 * pm__roll(dice) - 1.0, around = 6.283185307179586 * pm__roll(dice);
    *p = (pm_photon){.position = {(float)x * step, (float)y * step, (float)z * step},
                     .direction = {(float)(sqrt(1.0 - up * up) * cos(around)),
                                   (float)(sqrt(1.0 - up * up) * sin(around)), (float)up}};
    for (int c = 0; c < 3; c++)
        p->power[c] = (float)exp2(2.0 * pm__roll(dice) - 1.0);
}

void pm__hood_scatter(pm__hood *hood, pm__dice *dice, size_t count, int reach, bool deep)
{
    for (size_t i = 0; i < count; i++) {
        const int x = pm__roll_between(dice, -reach, reach), y = pm__roll_between(dice, -reach, reach);
        pm__hood_add(hood, dice, x, y, deep ? pm__roll_between(dice, -reach, reach) : 0);
    }
}

void pm__hood_stretch(pm__hood *hood, float factor)
{
    for (size_t i = 0; i < hood->count; i++)
        for (int a = 0; a < 3; a++)
            hood->photons[i].position[a] *= factor;
    for (int a = 0; a < 3; a++)
        hood->query.position[a] *= factor;
    hood->query.max_radius *= factor;
    if (hood->query.shape == PM_LOOKUP_DISC)
        hood->query.shape_parameter *= factor;
}

void pm__hood_say(pm__hood *hood, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(hood->what, sizeof hood->what, format, arguments);
    va_end(arguments);
}
