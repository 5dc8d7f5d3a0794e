/* Methods whose answer is a mean: what their states and lookups have in common. */
#ifndef PM_METHODS_MEANS_H
#define PM_METHODS_MEANS_H

#include "progressive.h"

/* Where points are drawn anew, the state's first numbers: sums over passes of radiance and of what is seen of lights,
 * and photons that count. A method's own follow. */
enum { PM__SUM, PM__SEEN = PM__SUM + 3, PM__FOUND = PM__SEEN + 3, PM__MEAN_FIELDS };
void pm__mean_answer(const pm__run *run, const double *state, double radiance[3]);

/* Where every pass looks for k photons: three sums of its own, then areas and photons. */
enum { PM__NEAREST_SUM, PM__NEAREST_AREA = PM__NEAREST_SUM + 3, PM__NEAREST_COUNT, PM__NEAREST_FIELDS };
void pm__nearest_ask(const pm__run *run, size_t point, const double *state, size_t *k, double *radius);
/* The next radius is not known before its photons: the root of the mean square of those so far. */
pm__point_view pm__nearest_view(const pm__run *run, size_t point, const double *state);

#endif
