#include "eye.h"

#include "../base/sobol.h"

#include <math.h>
#include <string.h>

enum { LONGEST = 1000 };

pm__eye_numbers pm__eye_numbers_of(uint64_t seed, uint32_t trial, uint32_t pass, uint64_t pixel)
{
    /* 40 bits: pixels take the lower 28, trials the rest; what is over goes on top of the pass. */
    return (pm__eye_numbers){seed, pixel | (uint64_t)(trial & 0xfff) << 28, pass ^ (trial >> 12) << 20, 0};
}

void pm__eye_uniform(pm__eye_numbers *numbers, double u[3])
{
    pm__random_triple(numbers->seed, PM__FOR_EYES, numbers->pass, numbers->number, numbers->block++, u);
}

void pm__eye_start(pm__eye *eye, const pm__scene *scene, const pm__eye_numbers *numbers, const double origin[3],
                   const double direction[3])
{
    *eye = (pm__eye){.scene = scene,
                     .numbers = *numbers,
                     .shape = PM__NO_SHAPE,
                     .weight = {1.0, 1.0, 1.0},
                     .sees_lights = true,
                     .sees_caustics = true};
    memcpy(eye->origin, origin, sizeof eye->origin);
    memcpy(eye->direction, direction, sizeof eye->direction);
}

void pm__eye_through(pm__eye *eye, const pm__scene *scene, const pm__camera *camera, const pm__eye_numbers *numbers,
                     double x, double y)
{
    double direction[3];
    pm__camera_direction(camera, x, y, direction);
    pm__eye_start(eye, scene, numbers, camera->eye, direction);
}

void pm__place_in_pixel(uint64_t seed, uint64_t pixel, uint32_t pass, double at[2])
{
    for (int d = 0; d < 2; d++) {
        uint32_t keys[4];
        pm__random_words(seed, PM__FOR_PIXELS, (uint32_t)d, pixel, 0, keys);
        at[d] = (double)pm__owen_scramble(pm__sobol(pass, d), keys) * 0x1p-32;
    }
}

/* Lights may stand within a medium: what lies between is absorbed as on any way. */
static void see_lights(pm__eye *eye, double reach)
{
    const size_t count = pm__scene_light_count(eye->scene);
    for (size_t i = 0; i < count; i++) {
        double radiance[3], distance;
        const pm__light *const light = pm__scene_light_at(eye->scene, i);
        if (!pm__light_seen(light, eye->origin, eye->direction, reach, radiance, &distance))
            continue;
        if (eye->absorption)
            pm__attenuate(eye->absorption, distance, radiance);
        for (int b = 0; b < 3; b++)
            eye->emitted[b] += eye->weight[b] * radiance[b];
    }
}

/* As for photons: a glass boundary says what lies before it; elsewhere the medium is that beyond the boundary left
 * last. */
static void learn_medium(pm__eye *eye)
{
    if (eye->hit.material->kind == PM__GLASS)
        eye->absorption = pm__medium_before(eye->hit.material, eye->hit.normal, eye->direction);
}

static void depart(pm__eye *eye, const double outgoing[3])
{
    memcpy(eye->origin, eye->hit.position, sizeof eye->origin);
    memcpy(eye->direction, outgoing, sizeof eye->direction);
    eye->shape = eye->hit.shape;
    eye->bounces++;
}

/* Basic radiance, L / n^2, is what stays: of the light that arrives from the far side the near side sees
 * (n near / n far)^2. */
static void cross_boundary(pm__eye *eye, bool front)
{
    const pm__material *const glass = eye->hit.material;
    for (int b = 0; b < 3; b++)
        eye->weight[b] *= front ? 1.0 / (glass->ior[b] * glass->ior[b]) : glass->ior[b] * glass->ior[b];
}

static bool scatter_by(pm__eye *eye, const double u[3])
{
    double outgoing[3];
    const bool front = pm__dot(eye->direction, eye->hit.normal) < 0.0;
    const pm__event event = pm__scatter(eye->hit.material, eye->hit.normal, eye->direction, u, eye->weight, outgoing);
    if (event == PM__ABSORBED)
        return false;
    if (event == PM__TRANSMITTED)
        cross_boundary(eye, front);
    if (eye->hit.material->kind == PM__GLASS)
        eye->absorption = pm__medium_beyond(eye->hit.material, eye->hit.normal, outgoing);
    depart(eye, outgoing);
    return true;
}

static bool scatter(pm__eye *eye)
{
    double u[3];
    pm__eye_uniform(&eye->numbers, u);
    return scatter_by(eye, u);
}

static void stand(pm__eye *eye)
{
    const double sign = pm__dot(eye->direction, eye->hit.normal) > 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; i++) {
        eye->facing[i] = sign * eye->hit.normal[i];
        eye->outgoing[i] = -eye->direction[i];
    }
}

/* To the next surface and what is seen on the way. false: the path ends there. */
static bool advance(pm__eye *eye)
{
    const bool met = pm__scene_intersect(eye->scene, eye->origin, eye->direction, INFINITY, eye->shape, &eye->hit);
    if (met)
        learn_medium(eye);
    if (eye->sees_lights)
        see_lights(eye, met ? eye->hit.distance : INFINITY);
    if (!met || eye->hit.material->kind == PM__BLACK)
        return false;
    eye->travelled = eye->hit.distance;
    if (eye->absorption)
        pm__attenuate(eye->absorption, eye->hit.distance, eye->weight);
    if (pm__is_rough(eye->hit.material))
        stand(eye);
    return true;
}

pm__eye_met pm__eye_step(pm__eye *eye)
{
    if (eye->bounces >= LONGEST || !advance(eye))
        return PM__EYE_ENDS;
    if (pm__is_rough(eye->hit.material))
        return PM__EYE_STANDS;
    if (!scatter(eye))
        return PM__EYE_ENDS;
    eye->sees_lights = eye->sees_caustics;
    return PM__EYE_PASSES;
}

bool pm__eye_follow(pm__eye *eye)
{
    pm__eye_met met;
    do
        met = pm__eye_step(eye);
    while (met == PM__EYE_PASSES);
    return met == PM__EYE_STANDS;
}

/* ---- All ways ---------------------------------------------------------------------------------- */

typedef struct branching {
    double least;
    pm__eye_visit visit;
    void *context;
} branching;

static void follow_branches(const branching *all, pm__eye *eye);

/* One way on, in the bands of the weight, which holds the share of this way: by a number that chooses it. */
static void take_branch(const branching *all, const pm__eye *eye, const double weight[3], double u)
{
    pm__eye next = *eye;
    const double numbers[3] = {u, 0.0, 0.0};
    if (!(fmax(weight[0], fmax(weight[1], weight[2])) >= all->least))
        return;
    memcpy(next.weight, weight, sizeof next.weight);
    for (int b = 0; b < 3; b++)
        next.emitted[b] = 0.0;
    if (!scatter_by(&next, numbers))
        return;
    if (eye->hit.material->kind == PM__MIRROR) /* the share is in the weight already: no roulette */
        memcpy(next.weight, weight, sizeof next.weight);
    next.sees_lights = next.sees_caustics;
    follow_branches(all, &next);
}

/* Reflected and refracted, band by band where they bend differently. */
static void branch_at_glass(const branching *all, const pm__eye *eye)
{
    static const double refracted = 1.0 - 0x1p-53;
    const pm__material *const glass = eye->hit.material;
    const double cosine = -pm__dot(eye->direction, eye->hit.normal);
    const bool alike = glass->ior[0] == glass->ior[1] && glass->ior[1] == glass->ior[2];
    for (int band = 0; band < (alike ? 1 : 3); band++) {
        const double ior = glass->ior[band];
        double far, back[3] = {0.0, 0.0, 0.0}, on[3] = {0.0, 0.0, 0.0};
        const double reflected = pm__fresnel(fmin(1.0, fabs(cosine)), cosine > 0.0 ? ior : 1.0 / ior, &far);
        for (int b = 0; b < 3; b++)
            if (alike || b == band) {
                back[b] = eye->weight[b] * reflected;
                on[b] = eye->weight[b] * (1.0 - reflected);
            }
        take_branch(all, eye, back, 0.0);
        if (reflected < 1.0)
            take_branch(all, eye, on, refracted);
    }
}

static void follow_branches(const branching *all, pm__eye *eye)
{
    const bool met = eye->bounces < LONGEST && advance(eye), reached = met && pm__is_rough(eye->hit.material);
    all->visit(all->context, eye, reached);
    if (!met || reached)
        return;
    if (eye->hit.material->kind == PM__GLASS) {
        branch_at_glass(all, eye);
    } else {
        double weight[3];
        for (int b = 0; b < 3; b++)
            weight[b] = eye->weight[b] * eye->hit.material->specular[b];
        take_branch(all, eye, weight, 0.0);
    }
}

void pm__eye_follow_all(const pm__eye *eye, double least, pm__eye_visit visit, void *context)
{
    const branching all = {least, visit, context};
    pm__eye first = *eye;
    follow_branches(&all, &first);
}

bool pm__eye_bounce(pm__eye *eye)
{
    eye->sees_lights = false;
    return scatter(eye);
}

bool pm__eye_sample(pm__eye *eye, const pm__light *light, pm__eye_lit *lit)
{
    double u[3], brdf[3];
    pm__eye_uniform(&eye->numbers, u);
    *lit = (pm__eye_lit){.arrives = false};
    lit->arrives = pm__light_reach(light, eye->hit.position, u, &lit->sample);
    const double cosine = lit->arrives ? pm__dot(eye->facing, lit->sample.direction) : 0.0;
    if (!(cosine > 0.0))
        return false;
    pm__material_brdf(eye->hit.material, eye->hit.normal, lit->sample.direction, eye->outgoing, brdf);
    for (int b = 0; b < 3; b++)
        lit->radiance[b] = eye->weight[b] * brdf[b] * cosine * lit->sample.irradiance[b];
    return true;
}

bool pm__eye_blocked(const pm__eye *eye, const pm__eye_lit *lit)
{
    return pm__scene_blocked(eye->scene, eye->hit.position, eye->hit.shape, lit->sample.position, PM__NO_SHAPE);
}

void pm__eye_direct(pm__eye *eye, bool all, double radiance[3])
{
    const size_t count = pm__scene_light_count(eye->scene);
    for (size_t i = 0; i < count; i++) {
        pm__eye_lit lit;
        const bool shines = pm__eye_sample(eye, pm__scene_light_at(eye->scene, i), &lit);
        if (!shines && !(all && lit.arrives))
            continue;
        const bool blocked = pm__eye_blocked(eye, &lit);
        for (int b = 0; b < 3 && !blocked; b++)
            radiance[b] += lit.radiance[b];
    }
}
