/* Sine and cosine of a turn. */
#ifndef PM_BASE_TURN_H
#define PM_BASE_TURN_H

#include <math.h>
#include <stdint.h>

/* Of an angle r, at most an eighth of a turn either way: within 2^-52. Polynomials of degree 13 and 14 (interpolated at
 * Chebyshev's points of the squared angle) do there: half the time of libm's, and the same digits on every machine. */
static inline void pm__eighth(double r, double *sine, double *cosine)
{
    const double y = r * r, z = y * y;
    const double s = (-0.16666666666666664624 + 0.0083333333333309484855 * y) +
                     z * ((-0.00019841269836758574323 + 2.7557316102552440119e-6 * y) +
                          z * (-2.5051131845003624417e-8 + 1.5918129294866608667e-10 * y));
    const double c = (0.041666666666666665389 - 0.0013888888888887397237 * y) +
                     z * ((0.000024801587298765687927 - 2.7557317271729792882e-7 * y) +
                          z * (2.0876146268403197893e-9 - 1.1382632425521718005e-11 * y));
    *sine = r + r * y * s;
    *cosine = 1.0 - (0.5 * y - z * c);
}

/* Of 2 pi u, u in [0, 1]: within 2^-52. In turns nothing has to be reduced by pi. */
static inline void pm__turn(double u, double *sine, double *cosine)
{
    const int32_t quarter = (int32_t)(4.0 * u + 0.5);
    double along, across;
    pm__eighth(1.57079632679489661923 * (4.0 * u - (double)quarter), &across, &along);
    const double sign = quarter & 2 ? -1.0 : 1.0;
    *sine = sign * (quarter & 1 ? along : across);
    *cosine = sign * (quarter & 1 ? -across : along);
}

/* The nearest whole number, |x| < 2^51: 1.5 * 2^52 leaves no room for digits behind the point. */
static inline double pm__whole(double x)
{
    return (x + 6755399441055744.0) - 6755399441055744.0;
}

/* Of 2 pi u, |u| < 2^48: within 2^-52. Without integers, which not every width of SIMD makes of doubles. */
static inline void pm__turns(double u, double *sine, double *cosine)
{
    const double quarters = pm__whole(4.0 * u), left = quarters - 4.0 * pm__whole(0.25 * quarters); /* -2 to 2 */
    double along, across;
    pm__eighth(1.57079632679489661923 * (4.0 * u - quarters), &across, &along);
    const double s = left * left == 1.0 ? along : across, c = left * left == 1.0 ? across : along;
    *sine = fabs(left - 0.5) > 1.0 ? -s : s;
    *cosine = fabs(left + 0.5) > 1.0 ? -c : c;
}

#endif
