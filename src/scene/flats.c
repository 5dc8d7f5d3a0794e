#include "flats.h"

#include "../base/inline.h"

#include <math.h>
#include <string.h>

/* Which planes lie behind a ray, and which is the nearest, is as good as random: no branches. */
enum { LANES = 4 };
typedef double lanes __attribute__((vector_size(8 * LANES), may_alias));
typedef int64_t mask __attribute__((vector_size(8 * LANES), may_alias));

void pm__flats_add(pm__flats *flats, const pm__shape *shape, uint32_t number)
{
    const size_t at = flats->count++;
    const bool is_disc = shape->kind == PM__SHAPE_DISC;
    const double reach = shape->radius + shape->slack;
    for (int axis = 0; axis < 3; axis++) {
        flats->corner[axis][at] = shape->centre[axis];
        flats->normal[axis][at] = shape->normal[axis];
        for (int i = 0; i < 2 && !is_disc; i++)
            flats->dual[i][axis][at] = shape->dual[i][axis];
    }
    for (int i = 0; i < 2; i++)
        flats->margin[i][at] = is_disc ? 0.0 : shape->margin[i];
    flats->square[at] = is_disc ? reach * reach : (double)INFINITY;
    flats->number[at] = number;
#if defined(__x86_64__)
    flats->wide = __builtin_cpu_supports("avx2");
#endif
}

#define LOAD(type, array) (*(const type *)(const void *)&(array)[at])
#define DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])
#define WHERE(condition, a, b, type) ((type)(((mask)(a) & (condition)) | ((mask)(b) & ~(condition))))
#if defined(__clang__)
#define SWAP(a, i, j, k, l) __builtin_shufflevector(a, a, i, j, k, l)
#else
#define SWAP(a, i, j, k, l) __builtin_shuffle(a, (mask){i, j, k, l})
#endif

/* What four of them say: distances where they are met, INFINITY elsewhere. */
PM__INLINE void meet_four(const pm__flats *flats, size_t at, const pm__ray *ray, int64_t from, int64_t to,
                          lanes *distance)
{
    lanes offset[3], normal[3];
    for (int axis = 0; axis < 3; axis++) {
        normal[axis] = LOAD(lanes, flats->normal[axis]);
        offset[axis] = ray->origin[axis] - LOAD(lanes, flats->corner[axis]);
    }
    const lanes t = -DOT(normal, offset) / DOT(normal, ray->direction);
    mask met = (t > 0.0) & (t <= ray->reach);
    for (int axis = 0; axis < 3; axis++)
        offset[axis] += t * ray->direction[axis];
    for (int i = 0; i < 2; i++) {
        const lanes dual[3] = {LOAD(lanes, flats->dual[i][0]), LOAD(lanes, flats->dual[i][1]),
                               LOAD(lanes, flats->dual[i][2])};
        const lanes along = DOT(dual, offset), margin = LOAD(lanes, flats->margin[i]);
        met &= (along >= -margin) & (along <= 1.0 + margin);
    }
    const mask number = LOAD(mask, flats->number);
    met &= (DOT(offset, offset) <= LOAD(lanes, flats->square)) & (number != from) & (number != to);
    *distance = WHERE(met, t, (lanes){0} + (double)INFINITY, lanes);
}

/* The nearest in each lane, lower places first; then of the lanes, by pairs. */
PM__INLINE size_t meet_all(const pm__flats *flats, const pm__ray *ray, int64_t from, int64_t to, double *distance)
{
    lanes least = (lanes){0} + (double)INFINITY;
    mask place = {0, 1, 2, 3}, best = (mask){0} + (int64_t)flats->count;
    for (size_t at = 0; at < flats->count; at += LANES, place += LANES) {
        lanes t;
        meet_four(flats, at, ray, from, to, &t);
        const mask nearer = t < least;
        least = WHERE(nearer, t, least, lanes);
        best = WHERE(nearer, place, best, mask);
    }
    for (int step = 0; step < 2; step++) {
        const lanes other = step ? SWAP(least, 1, 0, 3, 2) : SWAP(least, 2, 3, 0, 1);
        const mask there = step ? SWAP(best, 1, 0, 3, 2) : SWAP(best, 2, 3, 0, 1);
        const mask nearer = (other < least) | ((other == least) & (there < best));
        least = WHERE(nearer, other, least, lanes);
        best = WHERE(nearer, there, best, mask);
    }
    *distance = least[0];
    return (size_t)best[0];
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static size_t meet_wide(const pm__flats *flats, const pm__ray *ray, int64_t from,
                                                        int64_t to, double *distance)
{
    return meet_all(flats, ray, from, to, distance);
}
#endif

size_t pm__flats_meet(const pm__flats *flats, const pm__ray *ray, uint32_t from, uint32_t to, double *distance)
{
#if defined(__x86_64__)
    if (flats->wide)
        return meet_wide(flats, ray, (int64_t)from, (int64_t)to, distance);
#endif
    return meet_all(flats, ray, (int64_t)from, (int64_t)to, distance);
}
