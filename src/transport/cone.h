/* Classes of normals: 3 x 3 on each face of a cube about the origin. */
#ifndef PM_TRANSPORT_CONE_H
#define PM_TRANSPORT_CONE_H

#include <math.h>
#include <stdint.h>

enum { PM__CONE_STEPS = 3, PM__CONES = 6 * PM__CONE_STEPS * PM__CONE_STEPS };

/* The axis along which the normal is longest, and its class there. */
typedef struct pm__cone {
    int axis;      /* 0, 1, 2 */
    uint32_t face; /* 2 axis, and 1 on the negative side */
    uint32_t u, v; /* steps along the next axis and the one after it */
} pm__cone;

static inline uint32_t pm__cone_step(float x)
{
    return (uint32_t)(x >= -1.0f / PM__CONE_STEPS) + (uint32_t)(x > 1.0f / PM__CONE_STEPS);
}

/* normal: not 0, finite. */
static inline pm__cone pm__cone_at(const float normal[3])
{
    pm__cone c;
    c.axis = fabsf(normal[1]) > fabsf(normal[0]) ? 1 : 0;
    c.axis = fabsf(normal[2]) > fabsf(normal[c.axis]) ? 2 : c.axis;
    const float scale = 1.0f / fabsf(normal[c.axis]);
    c.face = (uint32_t)(2 * c.axis + (normal[c.axis] < 0.0f));
    c.u = pm__cone_step(normal[(c.axis + 1) % 3] * scale);
    c.v = pm__cone_step(normal[(c.axis + 2) % 3] * scale);
    return c;
}

/* Below PM__CONES. */
static inline uint32_t pm__cone_number(const pm__cone *c)
{
    return (c->face * PM__CONE_STEPS + c->u) * PM__CONE_STEPS + c->v;
}

#endif
