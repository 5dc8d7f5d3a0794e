#include "emission.h"

#include "../base/memory.h"
#include "strata.h"

#include <math.h>
#include <stdlib.h>

/* Numbers that no photon has: the fraction by which lights' counts are rounded, and keys of the lights' points. */
#define ROUNDING (PM__OTHER_NUMBERS + 0)
#define KEYS (PM__OTHER_NUMBERS + 1)

void pm__trace_uniform(uint64_t seed, uint32_t trial, uint64_t number, uint32_t block, double u[3])
{
    pm__random_triple(seed, PM__FOR_TRACING, trial, number, block, u);
}

/* W that the light sends. */
static double sent(const pm__emission *emission, size_t light)
{
    if (emission->only != PM__ALL_LIGHTS && emission->only != light)
        return 0.0;
    const double power = pm__sum(pm__scene_light_at(emission->scene, light)->power);
    return emission->projection ? power * pm__projection_share(emission->projection, light) : power;
}

void pm__emission_init(const pm__scene *scene, const pm__projection *projection, size_t only, uint64_t seed,
                       uint32_t trial, pm__emission *emission)
{
    *emission = (pm__emission){.scene = scene, .projection = projection, .only = only, .seed = seed, .trial = trial};
    for (size_t i = 0; i < pm__scene_light_count(scene); i++)
        emission->total += sent(emission, i);
}

/* Each light with a key of its own: lights that are alike must not send alike. */
static void init_points(const pm__emission *emission, const pm__sampler *sampler, size_t light, uint64_t count,
                        pm__points *points)
{
    static const double square[2] = {1.0, 1.0}, round_square[2] = {3.14159265358979323846, 1.0};
    const pm__light *const at = pm__scene_light_at(emission->scene, light);
    uint32_t key[4];
    pm__random_words(emission->seed, PM__FOR_TRACING, 0, KEYS, (uint32_t)light, key);
    /* Of all but rectangles the first number is an angle, of 2 pi, beside a cosine or a radius squared. */
    pm__points_init(points, sampler, (uint64_t)key[0] << 32 | key[1], PM__FOR_PHOTONS, emission->trial, count, 4, 2,
                    at->kind == PM__RECTANGLE ? square : round_square);
}

/* The sum of the counts of the first lights is that of their shares, rounded up by a chance common to all: each light
 * has then the whole number below its share or the one above, its share on average, and all of them `count`. */
static void deal_numbers(pm__emission *emission, const pm__sampler *sampler, uint64_t count)
{
    const size_t lights = pm__scene_light_count(emission->scene);
    double u[3], before = 0.0;
    uint64_t dealt = 0, drawn = 0;
    pm__trace_uniform(emission->seed, emission->trial, ROUNDING, 0, u);
    for (size_t i = 0; i < lights; i++) {
        before += sent(emission, i);
        const double end = fmin((double)count * fmin(before / emission->total, 1.0) + u[0], (double)count);
        const uint64_t wanted = (uint64_t)end - dealt;
        uint64_t made = 0;
        if (wanted > 0) {
            init_points(emission, sampler, i, wanted, &emission->points[i]);
            made = emission->points[i].count;
            emission->weight[i] = (double)wanted / (double)made;
            dealt += wanted;
        }
        emission->first[i] = drawn;
        drawn += made;
    }
    emission->first[lights] = drawn;
    for (size_t i = 0; i < lights; i++)
        emission->weight[i] *= (double)drawn / (double)dealt;
}

pm_status pm__emission_spread(pm__emission *emission, const pm__sampler *sampler, uint64_t count, pm_error *error)
{
    const size_t lights = pm__scene_light_count(emission->scene);
    if (count > UINT32_MAX)
        return pm__fail(error, PM_EINVAL, "%llu photons spread by %s: at most %u", (unsigned long long)count,
                        sampler->entry.name, UINT32_MAX);
    emission->points = pm__alloc_zero(lights, sizeof *emission->points);
    emission->first = pm__alloc_zero(lights + 1, sizeof *emission->first);
    emission->weight = pm__alloc_zero(lights, sizeof *emission->weight);
    if (!emission->points || !emission->first || !emission->weight) {
        pm__emission_free(emission);
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu lights", lights);
    }
    if (emission->total > 0.0 && count > 0)
        deal_numbers(emission, sampler, count);
    return PM_OK;
}

uint64_t pm__emission_count(const pm__emission *emission)
{
    return emission->first[pm__scene_light_count(emission->scene)];
}

void pm__emission_free(pm__emission *emission)
{
    free(emission->points);
    free(emission->first);
    free(emission->weight);
    emission->points = NULL;
    emission->first = NULL;
    emission->weight = NULL;
}

/* By power: the photons of all lights then carry the same. */
static size_t choose_light(const pm__emission *emission, double u)
{
    const size_t count = pm__scene_light_count(emission->scene);
    size_t chosen = 0;
    double before = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double power = sent(emission, i);
        if (power > 0.0)
            chosen = i;
        before += power;
        if (u * emission->total < before)
            break;
    }
    return chosen;
}

/* The light whose numbers hold it. */
static size_t light_of(const pm__emission *emission, uint64_t number)
{
    size_t low = 0, high = pm__scene_light_count(emission->scene);
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (emission->first[middle] <= number)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Of the light's power. */
static double factor_of(const pm__emission *emission, size_t light)
{
    const double factor = emission->total / pm__sum(pm__scene_light_at(emission->scene, light)->power);
    return emission->points ? factor * emission->weight[light] : factor;
}

/* The numbers by which a photon leaves, from those that a sampler or chance gives, the light, and the factor of its
 * power. */
static size_t prepare(const pm__emission *emission, uint64_t number, double u[6], double *factor)
{
    size_t light;
    if (emission->strata) {
        light = pm__strata_place(emission->strata, number, u, factor);
    } else if (emission->points) {
        light = light_of(emission, number);
        const pm__points *const points = &emission->points[light];
        points->sampler->point(points, number - emission->first[light], u);
    } else {
        light = choose_light(emission, u[4]);
    }
    if (!emission->strata)
        *factor = factor_of(emission, light);
    if (emission->projection)
        pm__projection_aim(emission->projection, light, u);
    return light;
}

bool pm__depart(const pm__emission *emission, uint64_t number, pm__departure *departure)
{
    double u[6], factor;
    if (!(emission->total > 0.0))
        return false;
    if (!emission->points) {
        pm__trace_uniform(emission->seed, emission->trial, number, 0, u);
        pm__trace_uniform(emission->seed, emission->trial, number, 1, u + 3);
    }
    const size_t light = prepare(emission, number, u, &factor);
    const pm__light *const from = pm__scene_light_at(emission->scene, light);
    pm__emit(from, u, departure->position, departure->direction);
    for (int b = 0; b < 3; b++)
        departure->power[b] = from->power[b] * factor;
    return true;
}

/* choose_light for all: each light in turn takes those that come to it. */
static void choose_lights(const pm__emission *emission, pm__batch *photons)
{
    double before = 0.0;
    for (size_t i = 0; i < photons->count; i++)
        photons->place[i] = 0;
    for (size_t light = 0; light < pm__scene_light_count(emission->scene); light++) {
        const double power = sent(emission, light);
        for (size_t i = 0; i < photons->count && power > 0.0; i++)
            photons->place[i] = photons->v[1][i] * emission->total < before ? photons->place[i] : (int64_t)light;
        before += power;
    }
}

/* Their lights, as their places; u and v[0] as pm__emit has them; of strata v[1]: the factors of their powers. */
static void prepare_all(const pm__emission *emission, const pm__batch_kernel *kernel, pm__batch *photons)
{
    if (!emission->points) {
        kernel->draw(photons, emission->seed, emission->trial, 0, photons->u);
        kernel->draw(photons, emission->seed, emission->trial, 1, photons->v);
    }
    if (!emission->points && !emission->projection && !emission->strata) {
        choose_lights(emission, photons);
        return;
    }
    for (size_t i = 0; i < photons->count; i++) {
        double u[6], factor;
        for (int k = 0; k < 3; k++) {
            u[k] = photons->u[k][i];
            u[k + 3] = photons->v[k][i];
        }
        photons->place[i] = (int64_t)prepare(emission, photons->number[i], u, &factor);
        for (int k = 0; k < 3; k++)
            photons->u[k][i] = u[k];
        photons->v[0][i] = u[3];
        photons->v[1][i] = factor;
    }
}

static void depart_from(const pm__emission *emission, const pm__batch_kernel *kernel, size_t light, pm__batch *photons)
{
    const pm__light *const from = pm__scene_light_at(emission->scene, light);
    const pm__lamp lamp = pm__lamp_of(from);
    double power[3];
    for (int b = 0; b < 3; b++)
        power[b] = emission->strata ? from->power[b] : from->power[b] * factor_of(emission, light);
    kernel->emit(photons, &lamp, (int64_t)light, power);
}

/* Of many lights: one by one, with the same digits. */
static void depart_singly(const pm__emission *emission, pm__batch *photons)
{
    for (size_t i = 0; i < photons->count; i++) {
        const size_t light = (size_t)photons->place[i];
        const pm__light *const from = pm__scene_light_at(emission->scene, light);
        const double u[4] = {photons->u[0][i], photons->u[1][i], photons->u[2][i], photons->v[0][i]};
        const double factor = emission->strata ? 1.0 : factor_of(emission, light);
        double position[3], direction[3];
        pm__emit(from, u, position, direction);
        for (int axis = 0; axis < 3; axis++) {
            photons->origin[axis][i] = position[axis];
            photons->direction[axis][i] = direction[axis];
            photons->power[axis][i] = from->power[axis] * factor;
        }
    }
}

bool pm__depart_all(const pm__emission *emission, const pm__batch_kernel *kernel, pm__batch *photons)
{
    enum { FEW = 8 };
    size_t few[FEW + 1], count = 0;
    if (!(emission->total > 0.0))
        return false;
    prepare_all(emission, kernel, photons);
    for (size_t i = 0; i < photons->count && count <= FEW; i++) {
        size_t known = 0;
        while (known < count && few[known] != (size_t)photons->place[i])
            known++;
        if (known == count)
            few[count++] = (size_t)photons->place[i];
    }
    for (size_t i = 0; i < count && count <= FEW; i++)
        depart_from(emission, kernel, few[i], photons);
    if (count > FEW)
        depart_singly(emission, photons);
    for (int b = 0; b < 3 && emission->strata; b++)
        for (size_t i = 0; i < photons->count; i++)
            photons->power[b][i] *= photons->v[1][i];
    return true;
}
