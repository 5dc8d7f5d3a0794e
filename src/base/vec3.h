/* Three-component vectors as arrays, in double. */
#ifndef PM_BASE_VEC3_H
#define PM_BASE_VEC3_H

#include <math.h>

static inline double pm__dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double pm__sum(const double v[3])
{
    return v[0] + v[1] + v[2];
}

/* c must be neither a nor b. */
static inline void pm__cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Returns the length that was; a vector of length 0 stays. Free of overflow: scaled by its largest component. */
static inline double pm__normalize(double v[3])
{
    const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(largest > 0.0))
        return 0.0;
    for (int i = 0; i < 3; i++)
        v[i] /= largest;
    const double length = sqrt(pm__dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return length * largest;
}

/* The same for vectors that are seldom far from unit size: cheaper there. */
static inline double pm__normalize_near(double v[3])
{
    const double square = pm__dot(v, v);
    if (!(square > 1e-200 && square < 1e200))
        return pm__normalize(v);
    const double length = sqrt(square);
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return length;
}

/* The same for vectors that never are: no branch, and one division. */
static inline void pm__normalize_known(double v[3])
{
    const double factor = 1.0 / sqrt(pm__dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] *= factor;
}

/* Two unit vectors that complete the unit vector n to a right-handed orthonormal basis (s, t, n).
 * Duff et al. 2017, "Building an orthonormal basis, revisited". */
static inline void pm__basis(const double n[3], double s[3], double t[3])
{
    const double sign = copysign(1.0, n[2]);
    const double a = -1.0 / (sign + n[2]);
    const double b = n[0] * n[1] * a;
    s[0] = 1.0 + sign * n[0] * n[0] * a;
    s[1] = sign * b;
    s[2] = -sign * n[0];
    t[0] = b;
    t[1] = sign + n[1] * n[1] * a;
    t[2] = -n[1];
}

#endif
