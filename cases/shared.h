/* What flat cases share with the scenes in which the same light is traced: parameters, regions, truths and theory, each
 * derived in the case's own file. Values are in the order of the parameters. All functions are as pm__case has them. */
#ifndef PM_CASES_SHARED_H
#define PM_CASES_SHARED_H

#include "planar.h"

/* point_light.c: power, height */
enum { PM__POINT_LIGHT_PARAMS = 2, PM__POINT_LIGHT_REGIONS = 3 };
extern const pm__param pm__point_light_params[PM__POINT_LIGHT_PARAMS];
extern const pm__region pm__point_light_regions[PM__POINT_LIGHT_REGIONS];
double pm__point_light_irradiance(const double *values, double x, double y);
void pm__point_light_probe(const double *values, size_t region, const double *u, pm__probe *point);

/* rect_light.c: radiance, width, depth, height */
enum { PM__RECT_LIGHT_PARAMS = 4, PM__RECT_LIGHT_REGIONS = 3 };
extern const pm__param pm__rect_light_params[PM__RECT_LIGHT_PARAMS];
extern const pm__region pm__rect_light_regions[PM__RECT_LIGHT_REGIONS];
void pm__rect_light_floor(const double *values, double half[2]); /* its half sizes, m, along x and y */
double pm__rect_light_power(const double *values);
void pm__rect_light_probe(const double *values, size_t region, const double *u, pm__probe *point);
double pm__rect_light_truth(const double *values, const pm__probe *point);
double pm__rect_light_mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1);

/* corner.c; its values are not needed for these */
enum { PM__CORNER_REGIONS = 3 };
extern const pm__region pm__corner_regions[PM__CORNER_REGIONS];
void pm__corner_probe(const double *values, size_t region, const double *u, pm__probe *point);
/* Area, m2, of the wall within r of a probe on the floor. */
double pm__corner_wall_area(const pm__probe *point, const pm__shape *shape, double r);

/* wall.c: irradiance, thickness */
enum { PM__WALL_PARAMS = 2, PM__WALL_REGIONS = 3 };
extern const pm__param pm__wall_params[PM__WALL_PARAMS];
extern const pm__region pm__wall_regions[PM__WALL_REGIONS];
double pm__wall_power(const double *values);
void pm__wall_probe(const double *values, size_t region, const double *u, pm__probe *point);
double pm__wall_truth(const double *values, const pm__probe *point);
double pm__wall_mass(const double *values, const pm__probe *point, const pm__shape *shape, double r0, double r1);
double pm__wall_reach(const double *values);

#endif
