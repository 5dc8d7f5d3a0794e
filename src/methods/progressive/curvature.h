/* How kernels blur, and how light curves under them: what the adaptive radius and the estimate of a run's own error
 * have in common. */
#ifndef PM_METHODS_CURVATURE_H
#define PM_METHODS_CURVATURE_H

#include "../../lookup/lookup.h"

/* Constants of a kernel w over s = (d/r)^2 from 0 to 1, c = integral w ds (docs/errata.md, section 3). An estimate of
 * radius r of an irradiance with the Laplacian L has the bias moment/4 r^2 L and the variance square S / (pi r^2), S
 * the sum of squared powers per area. The kernel must have a weight. Cost: some 32 of it. */
typedef struct pm__blur {
    double square; /* infl = integral w^2 ds / c^2 */
    double moment; /* m2 = integral s w ds / c */
} pm__blur;
pm__blur pm__blur_of(const pm_estimator *estimator);

/* The Laplacian of an irradiance smoothed by the triweight kernel 4/pi (1 - s)^3 / r^2 is the sum over photons of power
 * times this, 1/m4. Its variance is 97.8 S / r^6: 97.8 = (48^2/pi) (2/15), the integral of the square. Smoothing adds
 * 0.05 r^2 times the Laplacian's Laplacian. s in [0, 1], r2: m2. */
static inline double pm__curving(double s, double r2)
{
    return 48.0 / 3.14159265358979323846 * (1.0 - s) * (3.0 * s - 1.0) / (r2 * r2);
}

#endif
