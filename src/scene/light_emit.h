/* How photons leave a light, one by one or many at once. */
#ifndef PM_SCENE_LIGHT_EMIT_H
#define PM_SCENE_LIGHT_EMIT_H

#include "../base/inline.h"
#include "../base/turn.h"
#include "../base/vec3.h"
#include "light.h"

/* A light, and what is the same for all its photons. */
typedef struct pm__lamp {
    pm__light light;
    double axis[3]; /* unit: that it shines about, or its normal */
    double width;   /* 1 - cosine of the cone's half; of a sun its sine squared */
    double side;    /* of a ball that shines: 1 outside, -1 inside */
} pm__lamp;

static inline pm__lamp pm__lamp_of(const pm__light *light)
{
    pm__lamp lamp = {.light = *light, .axis = {0.0, 0.0, 1.0}, .width = 2.0, .side = light->inward ? -1.0 : 1.0};
    if (light->kind == PM__RECTANGLE) {
        pm__cross(light->edge[0], light->edge[1], lamp.axis);
        (void)pm__normalize_near(lamp.axis);
    } else if (light->kind == PM__SPOT || light->kind == PM__DIRECTIONAL || light->kind == PM__SUN) {
        const double half = sin(0.5 * light->angle), sine = sin(light->angle);
        lamp.width = light->kind == PM__SUN ? sine * sine : 2.0 * half * half; /* 1 - cos(angle) = 2 sin^2(angle / 2) */
        for (int i = 0; i < 3; i++)
            lamp.axis[i] = light->direction[i];
    }
    return lamp;
}

/* z = 1 - below about `axis`; `below` rather than z, so that narrow cones keep their digits. */
static inline void pm__about(const double axis[3], double below, double turn, double direction[3])
{
    double s[3], t[3], sine, cosine;
    pm__basis(axis, s, t);
    pm__turn(turn, &sine, &cosine);
    const double r = sqrt(below * (2.0 - below)), x = r * cosine, y = r * sine;
    for (int i = 0; i < 3; i++)
        direction[i] = x * s[i] + y * t[i] + (1.0 - below) * axis[i];
}

/* Lambert: density cos / pi. */
static inline void pm__cosine_about(const double normal[3], double u0, double u1, double direction[3])
{
    const double z = sqrt(1.0 - u1);
    pm__about(normal, u1 / (1.0 + z), u0, direction);
}

/* pm__emit for a light of this kind: named, since a loop for each has no branch. */
PM__INLINE void pm__lamp_emit(const pm__lamp *lamp, pm__light_kind kind, const double u[4], double position[3],
                              double direction[3])
{
    const pm__light *const light = &lamp->light;
    double normal[3], s[3], t[3], sine, cosine;
    for (int i = 0; i < 3; i++) {
        position[i] = light->position[i];
        direction[i] = lamp->axis[i];
    }
    if (kind == PM__POINT || kind == PM__SPOT) {
        pm__about(lamp->axis, lamp->width * u[1], u[0], direction);
    } else if (kind == PM__DIRECTIONAL || kind == PM__SUN) {
        pm__basis(lamp->axis, s, t);
        pm__turn(u[0], &sine, &cosine);
        const double r = light->radius * sqrt(u[1]), x = r * cosine, y = r * sine;
        for (int i = 0; i < 3; i++)
            position[i] = light->position[i] + x * s[i] + y * t[i];
        if (kind == PM__SUN) { /* even radiance: cosine to the window */
            const double sine2 = lamp->width * u[3];
            pm__about(lamp->axis, sine2 / (1.0 + sqrt(1.0 - sine2)), u[2], direction);
        }
    } else if (kind == PM__RECTANGLE) {
        for (int i = 0; i < 3; i++)
            position[i] += u[0] * light->edge[0][i] + u[1] * light->edge[1][i];
        pm__cosine_about(lamp->axis, u[2], u[3], direction);
    } else {
        pm__about(lamp->axis, 2.0 * u[1], u[0], normal);
        for (int i = 0; i < 3; i++)
            position[i] += light->radius * normal[i];
        for (int i = 0; i < 3; i++)
            normal[i] *= lamp->side;
        pm__cosine_about(normal, u[2], u[3], direction);
    }
}

#endif
