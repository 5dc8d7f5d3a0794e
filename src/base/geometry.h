/* Exact areas and volumes that truths and predictions need, and a root finder. Pure, in double. */
#ifndef PM_BASE_GEOMETRY_H
#define PM_BASE_GEOMETRY_H

/* Area of the disc of radius r at (x, y) inside the rectangle [x0,x1] x [y0,y1]. r >= 0, any position. */
double pm__disc_rectangle_area(double x, double y, double r, double x0, double x1, double y0, double y1);

/* Volume common to two balls whose centres are d apart. */
double pm__ball_ball_volume(double r1, double r2, double d);

/* The root of an increasing function on [low, high], by Newton steps kept inside a shrinking bracket.
 * `function` returns the value and sets *slope. To about 1e-15 of high - low; the nearer end where there is no
 * change of sign. */
double pm__increasing_root(double (*function)(const void *context, double x, double *slope), const void *context,
                           double low, double high, double guess);

#endif
