/* FLIP of two pictures, as a display shows them (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild:
 * FLIP, a difference evaluator for alternating images, HPG 2020): what a viewer who flips between them sees.
 *
 *     map = dC ^ (1 - dF)
 *
 * dC, colour: in YCxCz each channel is filtered by what the eye resolves of it (achromatic, red-green, blue-yellow: the
 * transforms of contrast sensitivities that are sums of Gaussians a e^(-b f^2) of f cycles a degree), and colours are
 * cut to what a display has. The HyAB distance in L*a*b* with Hunt's adjustment, to the power 0.7, is spread over 0 to
 * 1: up to 0.4 of the largest (green to blue) onto 0 to 0.95, the rest above.
 * dF, features: of the unfiltered luminance, edges and points are what first and second derivatives of a Gaussian of
 * standard deviation 0.5 w, w = 0.082 degrees, answer; dF is the larger difference of the two answers' lengths, over
 * sqrt(2), to the power 0.5.
 *
 * No unit; 0 (equal) to 1; symmetric. Beyond the border lies the nearest pixel. */
#ifndef PM_METRICS_FLIP_MAP_H
#define PM_METRICS_FLIP_MAP_H

#include "../base/status.h"
#include "filter.h"

enum { PM__CSF_TERMS = 4 };

/* The filters for pixels to the degree. */
typedef struct pm__flip_filters {
    pm__kernel csf[PM__CSF_TERMS];     /* achromatic, red-green, two of blue-yellow; squares: along rows and columns */
    double share[PM__CSF_TERMS];       /* of the channel: a filter's square times it; a channel's weights sum to 1 */
    pm__kernel smooth, edge, point;    /* edge times smooth, point times smooth: positive weights sum to 1 */
} pm__flip_filters;

/* ppd > 0. ENOMEM. *filters: free always. */
pm_status pm__flip_filters_create(double ppd, pm__flip_filters *filters, pm_error *error);
void pm__flip_filters_free(pm__flip_filters *filters);

/* Linear R G B of a display, 0 to 1, of pixel p. */
typedef void pm__picture_of(const void *context, size_t p, double rgb[3]);

/* map[w * h] = FLIP of the two. ENOMEM. */
pm_status pm__flip_map(const pm__plane *plane, pm__picture_of *picture, const void *tested, const void *reference,
                       const pm__flip_filters *filters, double *map, pm_error *error);

#endif
