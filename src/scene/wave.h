/* Where rays meet the wave of shapes.h, z = c + a cos kx: one by one and by the hundred alike.
 *
 * A ray's height over the wave, h(t) = h(0) + t climb + a (cos phi(0) - cos phi(t)), has a second derivative of at most
 * `bend`. From a height h and a slope s no root is thus nearer than that of the parabola h + s t - bend t^2 / 2. Going
 * there again and again comes to the first root and passes none; once near it the steps shrink as Newton's. */
#ifndef PM_SCENE_WAVE_H
#define PM_SCENE_WAVE_H

#include "../base/turn.h"
#include "shapes.h"
#include "slab.h"

#include <float.h>
#include <math.h>

#define PM__PER_RADIAN 0.15915494309189533577 /* turns */

/* What stays on the way along a ray. */
typedef struct pm__above {
    double climb, lift, bend;      /* of z; the wave's part of the slope; 1/m */
    double turns;                  /* of half the phase per m */
    double last, tolerance, least; /* m: roots are looked for to `last`, and taken from above `least` */
} pm__above;

/* What changes. */
typedef struct pm__march {
    double t, height;    /* m */
    double sine, cosine; /* of the phase */
    double side;         /* 1: above the wave; -1: below */
    uint64_t goes_on;    /* 1; 0: no farther. At `t` there is a root if `is_root` is 1 */
    uint64_t is_root;
} pm__march;

/* leaves: the origin lies on the wave. That root is passed over, and others nearer than the shape's slack. */
PM__INLINE pm__march pm__wave_begin(const pm__shape *shape, const double o[3], const double d[3], double reach,
                                    bool leaves, pm__above *over)
{
    const double slack = shape->slack, a = shape->amplitude;
    double low = 0.0, high = (double)INFINITY, sine, cosine;
    for (int axis = 0; axis < 2; axis++) {
        const double half = shape->extent[axis] + slack;
        pm__slab_cut(o[axis], 1.0 / d[axis], -half, half, &low, &high);
    }
    /* A little higher than the wave, more so from far off: the height has its right sign where the ray comes in. */
    const double away = fabs(o[2] - shape->centre[2]), rounding = 0x1p-48 * away;
    const double crest = fabs(a) * (1.0 + 1e-9) + (rounding > 64.0 * slack ? rounding : 64.0 * slack);
    pm__slab_cut(o[2] - shape->centre[2], 1.0 / d[2], -crest, crest, &low, &high);
    const double enter = leaves ? 0.0 : low;
    const double x = o[0] + enter * d[0], z = o[2] + enter * d[2] - shape->centre[2];
    const double rate = shape->wavenumber * d[0]; /* of the phase, 1/m */
    pm__turns(shape->wavenumber * PM__PER_RADIAN * x, &sine, &cosine);
    over->climb = d[2];
    over->lift = a * rate;
    over->bend = fabs(over->lift * rate);
    over->turns = 0.5 * PM__PER_RADIAN * rate;
    over->last = high < reach ? high : reach;
    over->tolerance = 1e-15 * (high - enter);
    over->least = leaves ? slack : 0.0;
    const double above = z - a * cosine, height = leaves ? 0.0 : above;
    const double tells = leaves ? over->climb + over->lift * sine : height;
    return (pm__march){.t = enter,
                       .height = height,
                       .sine = sine,
                       .cosine = cosine,
                       .side = tells < 0.0 ? -1.0 : 1.0,
                       /* What is no ray, as in a batch behind the last one, may have no end. */
                       .goes_on = (enter < over->last) & (over->last <= DBL_MAX)};
}

/* On by one step. The height is kept up by differences, as products: exact for short steps from the wave. A root that
 * is not to be taken is passed over: from there the ray goes on along the other side. */
PM__INLINE void pm__wave_step(const pm__above *over, double amplitude, pm__march *m)
{
    const double s = m->side * (over->climb + over->lift * m->sine), h = m->side * m->height;
    const double square = s * s + 2.0 * over->bend * h, root = sqrt(square > 0.0 ? square : 0.0);
    const bool falls = s < 0.0;
    /* Where the wave is level along the ray: over 0. What is added ends a march that stays as high as it is. */
    const double rises = s + root + DBL_MIN, ratio = (falls ? 2.0 * h : rises) / (falls ? root - s : over->bend);
    /* On at any rate until roots are taken: a ray that but touches the wave went from side to side in one place. */
    const bool may_turn = falls & (m->t > over->least);
    /* Farther where it rises: neither slope nor bend may lead away. NaN, of what is no ray, ends the march. */
    const double creep = falls ? over->tolerance : 1e3 * over->tolerance;
    const double least = may_turn ? -(double)INFINITY : creep, step = ratio < least ? least : ratio;
    /* What is left after a step e is below bend e^2 / |s|. */
    const double left = over->bend * step * step, small = 0.25 * over->tolerance * -s;
    const bool is_last = falls & ((step <= over->tolerance) | (left <= small));
    double across, along;
    pm__turns(over->turns * step, &across, &along);
    const double middle = m->sine * along + m->cosine * across; /* of the phase half-way */
    const double twice_across = 2.0 * across * along, twice_along = 1.0 - 2.0 * across * across;
    const double sine = m->sine * twice_along + m->cosine * twice_across;
    const double cosine = m->cosine * twice_along - m->sine * twice_across;
    const double t = m->t + step, height = m->height + (over->climb * step + 2.0 * amplitude * middle * across);
    const bool is_within = t <= over->last, is_taken = t > over->least;
    m->t = t;
    m->sine = sine;
    m->cosine = cosine;
    m->height = is_last ? 0.0 : height;
    m->side = is_last ? -m->side : m->side;
    m->is_root = is_last & is_within & is_taken;
    m->goes_on = is_within & !(is_last & is_taken);
}

/* pm__shape_settle. */
PM__INLINE void pm__wave_settle(const pm__shape *shape, double position[3], double normal[3])
{
    double sine, cosine;
    pm__turns(shape->wavenumber * PM__PER_RADIAN * position[0], &sine, &cosine);
    const double steep = shape->amplitude * shape->wavenumber * sine, length = sqrt(steep * steep + 1.0);
    position[2] = shape->centre[2] + shape->amplitude * cosine;
    normal[0] = steep / length;
    normal[1] = 0.0;
    normal[2] = 1.0 / length;
}

#endif
