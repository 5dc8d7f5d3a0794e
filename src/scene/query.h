/* A ray on its way through a scene: what is proposed to it is judged here, in double. For rays.c and judge.c alone. */
#ifndef PM_SCENE_QUERY_H
#define PM_SCENE_QUERY_H

#include "rays.h"

/* Embree culls in float: with coordinates to `extent`, origin, direction and box are each off by a few 2^-24 of it.
 * Its boxes are padded, its rays lengthened at both ends by more than that, and what it then proposes is judged in
 * double. */
#define PM__PADDING 0x1p-20
#define PM__SHIFT 0x1p-18

typedef struct pm__query {
    struct RTCIntersectContext context; /* first: Embree passes its address on. Set when Embree is asked */
    const pm__scene *scene;
    pm__ray ray;               /* its reach: the first hit so far. Its ends are set for each shape */
    double end[3];             /* where a way ends that may be blocked */
    double start;              /* m from the origin: where Embree's ray starts */
    uint32_t from, to;         /* PM__NO_SHAPE: neither end lies on one; PM__ELSEWHERE: on one of another part */
    uint32_t shape;            /* of the first hit */
    const pm__geometry *met;   /* NULL: none so far */
    const pm__geometry *place; /* of the part that this is in; NULL: it is in none */
} pm__query;

/* Does the ray meet the shape `number` of the geometry, within its reach? Not of a placed part. */
bool pm__query_meet(pm__query *q, const pm__geometry *geometry, uint32_t number, double *distance);

/* Equal distances go to the lower number, whatever the order in which they are proposed. */
static inline bool pm__query_shorten(pm__query *q, double distance, uint32_t number)
{
    if (!(distance <= q->ray.reach) || (distance == q->ray.reach && number > q->shape))
        return false;
    q->ray.reach = distance;
    q->shape = number;
    return true;
}

/* Takes a proposed hit if it is the first so far. */
bool pm__query_take(pm__query *q, const pm__geometry *geometry, uint32_t number);

/* The same of all shapes that Embree does not hold. */
void pm__query_take_few(pm__query *q);
bool pm__query_meets_few(pm__query *q);

/* Asks Embree beside them, from where the ray enters its box (m; 0: it starts there) to where it leaves it; true:
 * something is nearer. And what the first hit is. */
bool pm__query_ask_embree(pm__query *q, double enter, double leave);
void pm__query_hit(const pm__query *q, pm__hit *hit);

/* Where the first hit is, on the shape to rounding, and the unit normal there. */
void pm__query_settle(const pm__query *q, double position[3], double normal[3]);

#endif
