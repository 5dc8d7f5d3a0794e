/* What the flat cases share: their parameter, rectangles, probes, and theory for an irradiance that is a smooth
 * function over a rectangle of the plane z = 0. */
#ifndef PM_CASES_PLANAR_H
#define PM_CASES_PLANAR_H

#include "case.h"

#include "../src/base/geometry.h"

/* Value 0 of most cases. */
#define PM__PARAM_IRRADIANCE                                                                                     \
    {                                                                                                            \
        .name = "irradiance", .type = PM__REAL, .value = 1.0, .min = 1e-6, .max = 1e6, .unit = "W/m2",           \
        .help = "scale of the irradiance"                                                                        \
    }

typedef struct pm__rectangle {
    double x0, x1, y0, y1;
} pm__rectangle;

extern const pm__rectangle pm__unit_square;
extern const pm__rectangle pm__inset_square; /* 0.15 m from every side: domain edges are out of reach */

/* The integral of `irradiance` over the part of the rectangle at distances (r0, r1] from the probe: polar quadrature
 * whose arcs end where the circle leaves the rectangle. Relative error below 1e-7 for irradiance that varies over
 * lengths of (r1-r0)/3 along and r/3 around. An infinite rectangle is allowed. */
double pm__mass_rectangle(double (*irradiance)(const double *values, double x, double y), const double *values,
                          const pm__rectangle *rectangle, const pm__probe *probe, double r0, double r1);

/* The disc of radius r around the probe lies in the rectangle. */
bool pm__holds_disc(const pm__rectangle *rectangle, const pm__probe *probe, double r);

/* Area of the rectangle at distances (r0, r1] from the probe. */
double pm__shell_area(const pm__rectangle *rectangle, const pm__probe *probe, double r0, double r1);

/* A probe on z = 0 with normal +z, uniform in the rectangle. */
void pm__probe_rectangle(const pm__rectangle *rectangle, const double *u, pm__probe *probe);

/* The same, uniform between two radii around (x, y). */
void pm__probe_ring(double x, double y, double r0, double r1, const double *u, pm__probe *probe);

/* A photon that falls straight down on z = 0. */
void pm__photon_down(double x, double y, double position[3], double direction[3], double normal[3]);

/* The lookup accepts photons that travel straight down. */
bool pm__accepts_down(const pm__probe *probe, const pm__shape *shape);

/* The unit square onto the unit disc, area for area and squares to near-squares: Shirley and Chiu 1997. */
void pm__concentric(const double *u, double point[2]);

/* For domains that are square behind u[0] and u[1]. */
void pm__aspect_square(const double *values, double aspect[2]);

#endif
