/* Sine and cosine of a turn. */
#ifndef PM_BASE_TURN_H
#define PM_BASE_TURN_H

#include <stdint.h>

/* Of 2 pi u, u in [0, 1]: within 2^-52. In turns nothing has to be reduced by pi, and polynomials of degree 13 and 14
 * (interpolated at Chebyshev's points of the squared angle) do over an eighth of a turn either way: half the time of
 * libm's, and the same digits on every machine. */
static inline void pm__turn(double u, double *sine, double *cosine)
{
    const int32_t quarter = (int32_t)(4.0 * u + 0.5);
    const double r = 1.57079632679489661923 * (4.0 * u - (double)quarter), y = r * r, z = y * y;
    const double s = (-0.16666666666666664624 + 0.0083333333333309484855 * y) +
                     z * ((-0.00019841269836758574323 + 2.7557316102552440119e-6 * y) +
                          z * (-2.5051131845003624417e-8 + 1.5918129294866608667e-10 * y));
    const double c = (0.041666666666666665389 - 0.0013888888888887397237 * y) +
                     z * ((0.000024801587298765687927 - 2.7557317271729792882e-7 * y) +
                          z * (2.0876146268403197893e-9 - 1.1382632425521718005e-11 * y));
    const double along = 1.0 - (0.5 * y - z * c), across = r + r * y * s;
    const double sign = quarter & 2 ? -1.0 : 1.0;
    *sine = sign * (quarter & 1 ? along : across);
    *cosine = sign * (quarter & 1 ? -across : along);
}

#endif
