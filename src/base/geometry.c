#include "geometry.h"

#include <math.h>
#include <stdbool.h>

static const double pi = 3.14159265358979323846;

static double clamp(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

/* Area of the unit disc where x <= a, a in [-1, 1]. */
static double half_plane(double a)
{
    return a * sqrt((1.0 - a) * (1.0 + a)) + asin(a) + 0.5 * pi;
}

/* Area of the unit disc where x <= a and y <= b. Where the quadrant's corner lies outside the disc, the lines
 * x = a and y = b do not meet inside it, so the parts that they cut off are apart. */
static double quadrant(double a, double b)
{
    a = clamp(a, -1.0, 1.0);
    b = clamp(b, -1.0, 1.0);
    if (a * a + b * b < 1.0)
        return a * b + 0.5 * (half_plane(a) + half_plane(b)) - 0.25 * pi;
    if (a <= 0.0 && b <= 0.0)
        return 0.0;
    if (a <= 0.0)
        return half_plane(a);
    if (b <= 0.0)
        return half_plane(b);
    return half_plane(a) + half_plane(b) - pi;
}

double pm__disc_rectangle_area(double x, double y, double r, double x0, double x1, double y0, double y1)
{
    if (!(r > 0.0))
        return 0.0;
    const double left = (x0 - x) / r, right = (x1 - x) / r;
    const double below = (y0 - y) / r, above = (y1 - y) / r;
    const double unit =
        quadrant(right, above) - quadrant(left, above) - (quadrant(right, below) - quadrant(left, below));
    return fmax(0.0, unit) * r * r;
}

double pm__ball_ball_volume(double r1, double r2, double d)
{
    if (d >= r1 + r2)
        return 0.0;
    if (d <= fabs(r1 - r2)) {
        const double r = fmin(r1, r2);
        return 4.0 / 3.0 * pi * r * r * r;
    }
    /* Two caps on the common circle. */
    const double depth = r1 + r2 - d, difference = r1 - r2;
    return pi * depth * depth * (d * d + 2.0 * d * (r1 + r2) - 3.0 * difference * difference) / (12.0 * d);
}

double pm__increasing_root(double (*function)(const void *context, double x, double *slope), const void *context,
                           double low, double high, double guess)
{
    const double tolerance = 1e-15 * (high - low);
    bool low_known = false, high_known = false; /* the sign at that end has been seen */
    bool newton = false;                        /* the step before was Newton's */
    double x = clamp(guess, low, high), before = high - low;
    for (int i = 0; i < 200 && high - low > tolerance; i++) {
        double slope;
        const double value = function(context, x, &slope);
        const double step = value / slope;
        if (fabs(step) <= tolerance) /* never true where slope is 0 or NaN comes out */
            return clamp(x - step, low, high);
        low_known = low_known || value < 0.0;
        high_known = high_known || value > 0.0;
        *(value < 0.0 ? &low : &high) = x;
        double next = x - step;
        bool clamped = false;
        /* A root at an end of the range makes Newton fall just outside: that end itself is tried, once. */
        if ((next <= low && !low_known) || (next >= high && !high_known)) {
            next = clamp(next, low, high);
            low_known = low_known || next <= low;
            high_known = high_known || next >= high;
            newton = false;
            clamped = true;
        } else if (!(next > low && next < high && fabs(step) <= 0.5 * before)) {
            /* Newton leaves the bracket, or does not even halve its step (a multiple root). */
            x = low + 0.5 * (high - low);
            before = high - low;
            newton = false;
            continue;
        }
        x = next;
        /* Steps e, C e^2, C^3 e^4: the next one follows from the last two, so it need not be computed. */
        const double ratio = step / before;
        if (newton && fabs(step) * ratio * ratio <= tolerance)
            return x;
        before = fabs(step);
        newton = !clamped;
    }
    return x;
}
