/* The loops of batch.h over photons that leave lights and surfaces, in the width PM__LANES. */
#include "batch.h"

#include "rough.h"

#include <float.h>

/* ---- Lights ------------------------------------------------------------------------------------- */

PM__INLINE void emit_at(pm__batch *b, size_t i, const pm__lamp *lamp, pm__light_kind kind, int64_t light,
                        const double power[3])
{
    const double u[4] = {b->u[0][i], b->u[1][i], b->u[2][i], b->v[0][i]};
    const bool is_its = b->place[i] == light;
    double position[3], direction[3];
    pm__lamp_emit(lamp, kind, u, position, direction);
    for (int axis = 0; axis < 3; axis++) {
        b->origin[axis][i] = is_its ? position[axis] : b->origin[axis][i];
        b->direction[axis][i] = is_its ? direction[axis] : b->direction[axis][i];
        b->power[axis][i] = is_its ? power[axis] : b->power[axis][i];
    }
}

PM__INLINE void emit_all(pm__batch *b, const pm__lamp *lamp, pm__light_kind kind, int64_t light, const double power[3])
{
    const size_t count = whole(b);
    const pm__lamp own = *lamp;
    const double each[3] = {power[0], power[1], power[2]};
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        emit_at(b, i, &own, kind, light, each);
}

static void emit(pm__batch *b, const pm__lamp *lamp, int64_t light, const double power[3])
{
    switch (lamp->light.kind) {
    case PM__POINT:
    case PM__SPOT:
        emit_all(b, lamp, PM__SPOT, light, power);
        break;
    case PM__DIRECTIONAL:
        emit_all(b, lamp, PM__DIRECTIONAL, light, power);
        break;
    case PM__RECTANGLE:
        emit_all(b, lamp, PM__RECTANGLE, light, power);
        break;
    case PM__BALL:
        emit_all(b, lamp, PM__BALL, light, power);
        break;
    case PM__SUN:
        emit_all(b, lamp, PM__SUN, light, power);
        break;
    }
}

/* ---- Surfaces ----------------------------------------------------------------------------------- */

/* A photon at a surface, turned to the side that it comes from. */
typedef struct arrival {
    double facing[3], incoming[3], bands[3], power[3];
    double against; /* what goes along the normal as it was: below 0 from its side */
} arrival;

PM__INLINE arrival arrival_of(const pm__batch *b, size_t i)
{
    arrival at;
    for (int k = 0; k < 3; k++) {
        at.facing[k] = b->normal[k][i];
        at.incoming[k] = b->direction[k][i];
        at.bands[k] = b->bands[k][i];
        at.power[k] = b->power[k][i];
    }
    at.against = pm__dot(at.facing, at.incoming);
    const double sign = at.against < 0.0 ? 1.0 : -1.0;
    for (int k = 0; k < 3; k++)
        at.facing[k] = sign * at.facing[k];
    return at;
}

PM__INLINE void go(pm__batch *b, size_t i, bool is_its, bool goes_on, const double power[3], const double outgoing[3])
{
    for (int k = 0; k < 3; k++) {
        b->power[k][i] = is_its ? power[k] : b->power[k][i];
        b->outgoing[k][i] = is_its ? outgoing[k] : b->outgoing[k][i];
    }
    const uint64_t on = goes_on & (pm__sum(power) < (double)FLT_MAX);
    b->goes_on[i] = is_its ? on : b->goes_on[i];
}

PM__INLINE void scatter_diffuse_at(pm__batch *b, size_t i)
{
    const arrival at = arrival_of(b, i);
    const double none[3] = {0.0, 0.0, 0.0};
    const double chance = pm__roulette(at.bands, none, at.power).diffuse, factor = 1.0 / chance;
    double outgoing[3], power[3];
    pm__cosine_direction(at.facing, b->u[1][i], b->u[2][i], outgoing);
    for (int k = 0; k < 3; k++)
        power[k] = at.power[k] * (at.bands[k] * factor);
    go(b, i, b->kind[i] == PM__DIFFUSE, (pm__largest(at.power) > 0.0) & (b->u[0][i] < chance), power, outgoing);
}

static void scatter_diffuse(pm__batch *b)
{
    const size_t count = whole(b);
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        scatter_diffuse_at(b, i);
}

/* The index of refraction and power, by choose_index of material.c. Each choice is a comparison of its own: what is
 * made of several is not made SIMD. */
PM__INLINE double index_of(const arrival *at, double u, double power[3])
{
    const double *const p = at->power, *const ior = at->bands;
    const double total = pm__sum(p), x = u * total, by1 = p[1] > 0.0 ? 1.0 : 0.0, last = p[2] > 0.0 ? 2.0 : by1;
    const double beyond = x < p[0] + p[1] ? 1.0 : last, band = x < p[0] ? 0.0 : beyond;
    const double of1 = band == 1.0 ? ior[1] : ior[0], chosen = band == 2.0 ? ior[2] : of1;
    double otherwise = 0.0;
    for (int k = 0; k < 3; k++)
        otherwise += ior[k] == chosen ? 0.0 : p[k];
    for (int k = 0; k < 3; k++) {
        const double alone = band == (double)k ? total : 0.0;
        power[k] = otherwise > 0.0 ? alone : p[k];
    }
    return chosen;
}

PM__INLINE void scatter_mirror_at(pm__batch *b, size_t i)
{
    const arrival at = arrival_of(b, i);
    const double none[3] = {0.0, 0.0, 0.0}, chance = pm__roulette(none, at.bands, at.power).specular;
    const double twice = 2.0 * pm__dot(at.facing, at.incoming), factor = 1.0 / chance;
    double outgoing[3], power[3];
    for (int k = 0; k < 3; k++) {
        outgoing[k] = at.incoming[k] - twice * at.facing[k];
        power[k] = at.power[k] * (at.bands[k] * factor);
    }
    pm__normalize_known(outgoing); /* unit but for rounding */
    go(b, i, b->kind[i] == PM__MIRROR, (pm__largest(at.power) > 0.0) & (b->u[0][i] < chance), power, outgoing);
}

PM__INLINE void scatter_glass_at(pm__batch *b, size_t i)
{
    const arrival at = arrival_of(b, i);
    double power[3], outgoing[3];
    const double ior = index_of(&at, b->u[1][i], power), inverse = 1.0 / ior;
    const double eta = at.against < 0.0 ? ior : inverse;
    const double against = -pm__dot(at.facing, at.incoming), cosine = against < 1.0 ? against : 1.0;
    const double sine2 = (1.0 - cosine * cosine) / (eta * eta), far = sqrt(1.0 - sine2);
    const double s = (cosine - eta * far) / (cosine + eta * far), p = (eta * cosine - far) / (eta * cosine + far);
    const double reflected = sine2 >= 1.0 ? 1.0 : 0.5 * (s * s + p * p);
    const double twice = 2.0 * pm__dot(at.facing, at.incoming);
    const bool is_reflected = b->u[0][i] < reflected;
    for (int k = 0; k < 3; k++) {
        const double through = at.incoming[k] / eta + (cosine / eta - far) * at.facing[k];
        outgoing[k] = is_reflected ? at.incoming[k] - twice * at.facing[k] : through;
    }
    pm__normalize_known(outgoing); /* unit but for rounding */
    go(b, i, b->kind[i] == PM__GLASS, pm__largest(at.power) > 0.0, power, outgoing);
}

PM__INLINE void scatter_glossy_at(pm__batch *b, size_t i)
{
    const arrival at = arrival_of(b, i);
    const double specular[3] = {b->specular[0][i], b->specular[1][i], b->specular[2][i]}, alpha = b->alpha[i];
    const double from[3] = {-at.incoming[0], -at.incoming[1], -at.incoming[2]};
    const pm__chances chance = pm__roulette(at.bands, specular, at.power);
    const double u0 = b->u[0][i], u1 = b->u[1][i], u2 = b->u[2][i];
    const double rest = (u0 - chance.diffuse) / chance.specular;
    double facet[3], mirrored[3], outgoing[3], power[3];
    pm__cosine_direction(at.facing, u1, u2, outgoing);
    pm__sample_facet(at.facing, from, alpha, u1, u2, facet);
    const double twice = 2.0 * pm__dot(facet, at.incoming);
    const double by_diffuse = 1.0 / chance.diffuse, by_specular = 1.0 / chance.specular;
    for (int k = 0; k < 3; k++)
        mirrored[k] = at.incoming[k] - twice * facet[k];
    pm__normalize_known(mirrored);
    const double cosine = pm__dot(at.facing, mirrored);
    for (int k = 0; k < 3; k++) {
        power[k] = at.power[k] * (u0 < chance.diffuse ? at.bands[k] * by_diffuse : specular[k] * by_specular);
        outgoing[k] = u0 < chance.diffuse ? outgoing[k] : mirrored[k];
    }
    const double seen = cosine * pm__masking_over_cosine(cosine, alpha), above = cosine > 0.0 ? seen : 0.0;
    const double least = above < 1.0 ? above : 1.0, limit = u0 < chance.diffuse ? 1.0 : least;
    const double drawn = u0 < chance.diffuse ? u0 : rest;
    go(b, i, b->kind[i] == PM__GLOSSY, (pm__largest(at.power) > 0.0) & (drawn < limit), power, outgoing);
}

static void scatter_mirror(pm__batch *b)
{
    const size_t count = whole(b);
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        scatter_mirror_at(b, i);
}

static void scatter_glass(pm__batch *b)
{
    const size_t count = whole(b);
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        scatter_glass_at(b, i);
}

static void scatter_glossy(pm__batch *b)
{
    const size_t count = whole(b);
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        scatter_glossy_at(b, i);
}

#define PM__BATCH_KERNEL                                                                                 \
    {                                                                                                    \
        .draw = draw, .emit = emit, .begin = begin, .meet_flat = meet_flat, .meet_sphere = meet_sphere,  \
        .meet_cylinder = meet_cylinder, .meet_wave = meet_wave, .cut = cut, .settle = settle,            \
        .settle_round = settle_round, .settle_wave = settle_wave,                                        \
        .scatter = {[PM__DIFFUSE] = scatter_diffuse, [PM__GLOSSY] = scatter_glossy,                      \
                    [PM__MIRROR] = scatter_mirror, [PM__GLASS] = scatter_glass},                         \
    }
