#include "strata.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>

/* The number whose first draw is the shift. */
#define SHIFTING (PM__OTHER_NUMBERS + 3)

/* Photons of a run: those that are traced together. */
enum { RUN = PM__BATCH };

/* Which of a light's numbers is halved first, second, ...: those that say where its photons go. */
enum { CYCLE = 8 };
static const unsigned char halved[][CYCLE] = {[PM__POINT] = {0, 1, 0, 1, 0, 1, 0, 1},
                                              [PM__SPOT] = {0, 1, 0, 1, 0, 1, 0, 1},
                                              [PM__DIRECTIONAL] = {0, 1, 0, 1, 0, 1, 0, 1},
                                              [PM__RECTANGLE] = {2, 3, 2, 3, 2, 3, 0, 1},
                                              [PM__BALL] = {0, 1, 2, 3, 0, 1, 2, 3},
                                              [PM__SUN] = {0, 1, 0, 1, 0, 1, 2, 3}};

/* Cells by number; their product is the largest power of two that is not above per_light. */
static size_t grid_of(const pm__light *light, size_t per_light, size_t grid[4])
{
    size_t cells = 1;
    for (int a = 0; a < 4; a++)
        grid[a] = 1;
    for (size_t i = 0; 2 * cells <= per_light; i++, cells *= 2)
        grid[halved[light->kind][i % CYCLE]] *= 2;
    return cells;
}

static double sent_by(const pm__emission *emission, size_t light)
{
    const double power = pm__sum(pm__scene_light_at(emission->scene, light)->power);
    return emission->projection ? power * pm__projection_share(emission->projection, light) : power;
}

static void add_light(const pm__emission *emission, size_t light, size_t per_light, pm__strata *strata)
{
    const pm__light *const from = pm__scene_light_at(emission->scene, light);
    size_t grid[4];
    const size_t cells = grid_of(from, per_light, grid);
    const double power = sent_by(emission, light) / (double)cells;
    for (size_t cell = 0; cell < cells; cell++) {
        pm__stratum *const stratum = &strata->items[strata->count++];
        size_t rest = cell;
        *stratum = (pm__stratum){.light = light, .power = power, .load = 1.0,
                                 .trial_factor = power / pm__sum(from->power) / (double)strata->tests};
        for (int a = 0; a < 4; a++) {
            stratum->width[a] = 1.0 / (double)grid[a];
            stratum->low[a] = (double)(rest % grid[a]) * stratum->width[a];
            rest /= grid[a];
        }
    }
}

/* Lights that are cut first. */
static void add_lights(const pm__emission *emission, size_t per_light, const bool *cut, pm__strata *strata)
{
    const size_t lights = pm__scene_light_count(emission->scene);
    for (int turn = 0; turn < 2; turn++) {
        for (size_t i = 0; i < lights; i++)
            if ((!cut || cut[i]) == (turn == 0) && sent_by(emission, i) > 0.0)
                add_light(emission, i, turn == 0 ? per_light : 1, strata);
        strata->fine = turn == 0 ? strata->count : strata->fine;
    }
}

pm_status pm__strata_create(const pm__emission *emission, size_t per_light, const bool *cut, size_t tests,
                            pm__strata *strata)
{
    const size_t lights = pm__scene_light_count(emission->scene);
    size_t most = 0;
    double u[3];
    for (size_t i = 0; i < lights; i++)
        most += !cut || cut[i] ? per_light : 1;
    pm__trace_uniform(emission->seed, emission->trial, SHIFTING, 0, u);
    *strata = (pm__strata){.items = pm__alloc(most, sizeof *strata->items),
                           .ends = pm__alloc(most, sizeof *strata->ends),
                           .tests = tests,
                           .shift = u[0]};
    if (!strata->items || !strata->ends) {
        pm__strata_free(strata);
        return PM_ENOMEM;
    }
    add_lights(emission, per_light, cut, strata);
    return PM_OK;
}

void pm__strata_free(pm__strata *strata)
{
    free(strata->items);
    free(strata->ends);
    *strata = (pm__strata){0};
}

void pm__strata_share(const pm__emission *emission, pm__strata *strata, const double *shares)
{
    double all = 0.0, before = 0.0;
    for (size_t i = 0; i < strata->count; i++)
        all += shares[i];
    for (size_t i = 0; i < strata->count; i++) {
        pm__stratum *const stratum = &strata->items[i];
        const double light = pm__sum(pm__scene_light_at(emission->scene, stratum->light)->power);
        before += shares[i];
        strata->ends[i] = before / all;
        stratum->factor = shares[i] > 0.0 ? stratum->power / light / (shares[i] / all) : 0.0;
    }
    for (size_t i = strata->count; i-- > 0;) { /* rounding leaves nothing behind the last that sends */
        strata->ends[i] = INFINITY;
        if (shares[i] > 0.0)
            break;
    }
}

static uint64_t common_divisor(uint64_t a, uint64_t b)
{
    while (b > 0) {
        const uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

/* The sum of the first counts is that of their shares, rounded by a chance common to all. */
uint64_t pm__strata_deal(const pm__emission *emission, pm__strata *strata, const double *shares)
{
    static const double golden = 0.6180339887498949; /* of a circle: what lies evenly after any number of steps */
    double before = 0.0;
    uint64_t dealt = 0;
    for (size_t i = 0; i < strata->count; i++) {
        before += shares[i];
        strata->items[i].first = dealt;
        dealt = (uint64_t)(before + strata->shift);
    }
    strata->sent = dealt;
    strata->runs = dealt / RUN;
    strata->stride = (uint64_t)(golden * (double)strata->runs) + 1;
    while (common_divisor(strata->stride, strata->runs) > 1)
        strata->stride++;
    for (size_t i = 0; i < strata->count; i++) {
        pm__stratum *const stratum = &strata->items[i];
        const double light = pm__sum(pm__scene_light_at(emission->scene, stratum->light)->power);
        const uint64_t end = i + 1 < strata->count ? stratum[1].first : dealt;
        const double sent = shares[i] < 1.0 ? shares[i] : (double)(end - stratum->first);
        stratum->factor = sent > 0.0 ? stratum->power / light / sent * (double)dealt : 0.0;
    }
    return dealt;
}

/* Its bits, the last first, behind a binary point. */
static double van_der_corput(uint64_t number)
{
    number = (number >> 1 & 0x5555555555555555u) | (number & 0x5555555555555555u) << 1;
    number = (number >> 2 & 0x3333333333333333u) | (number & 0x3333333333333333u) << 2;
    number = (number >> 4 & 0x0f0f0f0f0f0f0f0fu) | (number & 0x0f0f0f0f0f0f0f0fu) << 4;
    number = (number >> 8 & 0x00ff00ff00ff00ffu) | (number & 0x00ff00ff00ff00ffu) << 8;
    number = (number >> 16 & 0x0000ffff0000ffffu) | (number & 0x0000ffff0000ffffu) << 16;
    number = number >> 32 | number << 32;
    return (double)(number >> 11) * 0x1p-53;
}

/* The last stratum whose photons begin at or before that at this place: what has none has the next one's beginning. */
static size_t find_dealt(const pm__strata *strata, uint64_t number)
{
    const uint64_t run = number / RUN;
    const uint64_t at = run < strata->runs ? run * strata->stride % strata->runs * RUN + number % RUN : number;
    size_t low = 0, high = strata->count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (strata->items[middle].first <= at)
            low = middle;
        else
            high = middle;
    }
    return low;
}

size_t pm__strata_find(const pm__strata *strata, uint64_t number)
{
    if (number >= PM__MOST_TRACED)
        return (size_t)((number - PM__MOST_TRACED) / strata->tests);
    if (strata->sent > 0)
        return find_dealt(strata, number);
    const double sum = van_der_corput(number) + strata->shift, at = sum < 1.0 ? sum : sum - 1.0;
    size_t low = 0, high = strata->count - 1;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (at < strata->ends[middle])
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

size_t pm__strata_place(const pm__strata *strata, uint64_t number, double u[4], double *factor)
{
    static const double below_one = 0x1.fffffffffffffp-1;
    const pm__stratum *const stratum = &strata->items[pm__strata_find(strata, number)];
    for (int a = 0; a < 4; a++)
        u[a] = fmin(stratum->low[a] + u[a] * stratum->width[a], below_one);
    *factor = number >= PM__MOST_TRACED ? stratum->trial_factor : stratum->factor;
    return stratum->light;
}
