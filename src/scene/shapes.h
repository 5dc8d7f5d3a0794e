/* Exact shapes: met by rays in double, to rounding. What Embree's float arithmetic is too coarse for.
 *
 * A shape reaches `slack` beyond its rim (some units in the last place of its coordinates), so that shapes that share
 * an edge leave no gap. Lengths in m. All functions are pure. */
#ifndef PM_SCENE_SHAPES_H
#define PM_SCENE_SHAPES_H

#include "../base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* No coordinate is larger: m. Embree drops what comes near the end of the range of float. */
#define PM__LARGEST_LENGTH 1e12

typedef enum pm__shape_kind {
    PM__SHAPE_SPHERE,
    PM__SHAPE_CYLINDER,
    PM__SHAPE_RECTANGLE,
    PM__SHAPE_DISC,
    PM__SHAPE_WAVE
} pm__shape_kind;

typedef struct pm__shape {
    pm__shape_kind kind;
    bool inward;       /* sphere, cylinder: which way the normal points */
    double centre[3];  /* sphere, disc; cylinder: x, y of the axis; rectangle: its corner; wave: z is the height */
    double radius;     /* sphere, cylinder, disc */
    double low, high;  /* cylinder: heights */
    double from;       /* cylinder: there where x - centre[0] >= from * radius */
    double edge[2][3]; /* rectangle */
    double normal[3];  /* disc; rectangle: derived */
    double amplitude;  /* wave, m, of either sign */
    double wavenumber; /* wave, 1/m, >= 0 */
    double extent[2];  /* wave: |x|, |y| at most this */
    /* Derived by pm__shape_prepare: */
    double dual[2][3]; /* rectangle: dual[i] . (p - corner) is the coordinate along edge[i], 0 to 1 */
    double margin[2];  /* rectangle: the slack in these coordinates */
    double slack;
} pm__shape;

/* A straight way that a shape may lie across. */
typedef struct pm__ray {
    double origin[3], direction[3]; /* m; unit */
    double reach;                   /* m; may be infinite unless `arrives` */
    bool leaves;                    /* the origin lies on the shape and is not met */
    bool arrives;                   /* the end, `reach` from the origin, lies on the shape and is not met: all that
                                     * counts is then whether anything is met */
} pm__ray;

/* Checks the shape and fills in what is derived. EINVAL: not finite, out of range, degenerate; the error names shape
 * `number` and the values. */
pm_status pm__shape_prepare(pm__shape *shape, uint32_t number, pm_error *error);

/* The corners of the box about the shape with its slack. */
void pm__shape_bounds(const pm__shape *shape, double low[3], double high[3]);

/* Does the ray meet the shape? *distance: where first, in (0, reach], unless it `arrives`. Cost: 5 to 20 ns; the wave
 * about 100 ns. */
bool pm__shape_meet(const pm__shape *shape, const pm__ray *ray, double *distance);

/* Moves a position that is off the shape by rounding onto it; the unit normal there. */
void pm__shape_settle(const pm__shape *shape, double position[3], double normal[3]);

#endif
