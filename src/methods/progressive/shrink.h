/* Statistics that shrink: squared radius, photons and flux of a point ([H09], "Radius reduction", "Flux correction").
 *
 * A lookup of radius R finds M photons beside the N that count so far. Of all N + M the share that is kept is
 * (N + alpha M) / (N + M), and R^2 shrinks by it, so that the density stays what it is. The flux within the smaller
 * disc is (tau + tau_M) times that share (erratum 27: in print tau_M is left out). tau / (pi R^2 passes) is then
 * exactly the mean of the passes' own estimates: radii depend on the past alone, so each of these is unbiased where
 * irradiance is even, and so is the mean. */
#ifndef PM_METHODS_SHRINK_H
#define PM_METHODS_SHRINK_H

#include "progressive.h"

/* A point's state. flux: radiance times area, W/sr; emitted: sum over passes. */
enum { PM__RADIUS2, PM__COUNT, PM__FLUX, PM__EMITTED = PM__FLUX + 3, PM__SHRINK_FIELDS = PM__EMITTED + 3 };

/* Choices of the parameters `flux` and `start`, the first two of a method that shrinks so. */
enum { PM__CORRECTED, PM__PRINTED };
enum { PM__FROM_ZERO, PM__FROM_FIRST };
extern const pm__param pm__shrink_params[2];

void pm__shrink_begin(const pm__run *run, size_t point, double *state);
void pm__shrink_ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius);
void pm__shrink_take(const pm__run *run, const pm__found *found, double *state);
void pm__shrink_answer(const pm__run *run, const double *state, double radiance[3]); /* with the mean emitted */
pm__point_view pm__shrink_view(const pm__run *run, size_t point, const double *state);
bool pm__shrink_averages(const double *values); /* not as printed: first photons weigh more */
double pm__shrink_schedule(const double *values, double alpha, double pass);
/* The product of (i + alpha) / (i + 1) for i from `first` to x - 1, for any real x: Gamma(x + alpha) / Gamma(x + 1)
 * over the same at `first`; 1 below that. */
double pm__shrink_product(double first, double x, double alpha);

#endif
