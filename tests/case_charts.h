/* The surfaces of the cases as charts over the unit square (volumes: cube), written from the cases' descriptions and
 * not from their code, and what each region's name promises. */
#ifndef PM_TESTS_CASE_CHARTS_H
#define PM_TESTS_CASE_CHARTS_H

#include "test.h"

#include "../cases/case.h"

#include <string.h>

static const double pm__test_pi = 3.14159265358979323846;

static inline const pm__case *pm__test_case(size_t i)
{
    return (const pm__case *)(const void *)pm__cases.entries[i];
}

static inline bool pm__is(const pm__case *c, const char *name)
{
    return strcmp(c->entry.name, name) == 0;
}

/* A parameter by its name. */
static inline double pm__test_value(const pm__case *c, const double *values, const char *name)
{
    for (size_t i = 0; i < c->entry.param_count; i++)
        if (strcmp(c->entry.params[i].name, name) == 0)
            return values[i];
    ck_abort_msg("%s has no parameter %s", c->entry.name, name);
    return 0.0;
}

static inline int pm__chart_count(const pm__case *c)
{
    return pm__is(c, "corner") || pm__is(c, "wall") ? 2 : 1;
}

/* Half sizes of the floor under the rectangular light. */
static inline void pm__test_floor(const pm__case *c, const double *values, double half[2])
{
    const double h = pm__test_value(c, values, "height");
    half[0] = 0.5 * pm__test_value(c, values, "width") + 1.5 * h;
    half[1] = 0.5 * pm__test_value(c, values, "depth") + 1.5 * h;
}

/* The point at st and the area (volume) for each unit of st. */
static inline double pm__chart_point(const pm__case *c, const double *values, int chart, const double st[3],
                                     pm__probe *point)
{
    const double phi = 2.0 * pm__test_pi * st[1];
    *point = (pm__probe){.position = {st[0], st[1], 0.0}, .normal = {0.0, 0.0, 1.0}};
    double *const p = point->position;
    if (pm__is(c, "volume")) { /* radius cubed, cosine, angle */
        const double r = cbrt(st[0]), cosine = 2.0 * st[2] - 1.0, sine = sqrt(fmax(0.0, 1.0 - cosine * cosine));
        p[0] = r * sine * cos(phi);
        p[1] = r * sine * sin(phi);
        p[2] = r * cosine;
        return 4.0 / 3.0 * pm__test_pi;
    }
    if (pm__is(c, "sphere")) { /* height, angle */
        const double a = pm__test_value(c, values, "radius"), z = 2.0 * st[0] - 1.0, r = sqrt(fmax(0.0, 1.0 - z * z));
        const double n[3] = {r * cos(phi), r * sin(phi), z};
        for (int i = 0; i < 3; i++) {
            point->normal[i] = n[i];
            p[i] = a * n[i];
        }
        return 4.0 * pm__test_pi * a * a;
    }
    if (pm__is(c, "point-light")) { /* rho / (rho + h), angle */
        const double h = pm__test_value(c, values, "height"), rho = h * st[0] / (1.0 - st[0]);
        p[0] = rho * cos(phi);
        p[1] = rho * sin(phi);
        return 2.0 * pm__test_pi * rho * (rho + h) * (rho + h) / h;
    }
    if (pm__is(c, "rect-light")) {
        double half[2];
        pm__test_floor(c, values, half);
        for (int i = 0; i < 2; i++)
            p[i] = half[i] * (2.0 * st[i] - 1.0);
        return 4.0 * half[0] * half[1];
    }
    if (chart == 1 && pm__is(c, "wall")) {
        p[2] = -pm__test_value(c, values, "thickness");
        point->normal[2] = -1.0;
    } else if (chart == 1) { /* the corner's wall */
        p[0] = 0.0;
        p[2] = st[0];
        point->normal[0] = 1.0;
        point->normal[2] = 0.0;
    }
    return 1.0;
}

/* The inverse; fails the test for a point that is off the surface. Returns the chart. */
static inline int pm__chart_locate(const pm__case *c, const double *values, const double p[3], const double normal[3],
                                   double st[3])
{
    int chart = 0;
    const double angle = atan2(p[1], p[0]) / (2.0 * pm__test_pi), turn = angle < 0.0 ? angle + 1.0 : angle;
    const double rho = hypot(p[0], p[1]), r = sqrt(pm__dot(p, p));
    st[0] = p[0];
    st[1] = p[1];
    st[2] = 0.0;
    double height = p[2];
    if (pm__is(c, "volume")) {
        st[0] = r * r * r;
        st[1] = turn;
        st[2] = r > 0.0 ? 0.5 * (1.0 + p[2] / r) : 0.5;
        height = 0.0;
    } else if (pm__is(c, "sphere")) {
        const double a = pm__test_value(c, values, "radius");
        st[0] = 0.5 * (1.0 + p[2] / a);
        st[1] = turn;
        height = r / a - 1.0;
        for (int i = 0; i < 3; i++)
            PM_CHECK_NEAR(normal[i], p[i] / a, 1e-12);
    } else if (pm__is(c, "point-light")) {
        st[0] = rho / (rho + pm__test_value(c, values, "height"));
        st[1] = turn;
    } else if (pm__is(c, "rect-light")) {
        double half[2];
        pm__test_floor(c, values, half);
        for (int i = 0; i < 2; i++)
            st[i] = 0.5 * (1.0 + p[i] / half[i]);
    } else if (pm__is(c, "wall") && normal[2] < 0.0) {
        chart = 1;
        height = p[2] + pm__test_value(c, values, "thickness");
    } else if (pm__is(c, "corner") && normal[0] > 0.5) {
        chart = 1;
        st[0] = p[2];
        height = p[0];
    }
    PM_CHECK_NEAR(height, 0.0, 1e-12);
    for (int i = 0; i < c->dimensions; i++)
        ck_assert_msg(st[i] >= -1e-12 && st[i] <= 1.0 + 1e-12, "%s: chart coordinate %d is %g", c->entry.name, i,
                      st[i]);
    return chart;
}

static inline bool pm__between(double x, double low, double high)
{
    return x >= low - 1e-12 && x <= high + 1e-12;
}

/* At least d from every side of the unit square. */
static inline bool pm__test_inset(const double p[3], double d)
{
    return pm__between(p[0], d, 1.0 - d) && pm__between(p[1], d, 1.0 - d);
}

static inline double pm__test_side(double x)
{
    return fmin(x, 1.0 - x);
}

/* What the region's name promises. */
static inline bool pm__in_region(const pm__case *c, const double *values, const char *region, const pm__probe *probe)
{
    const double *const p = probe->position;
    const double rho = hypot(p[0], p[1]), r = sqrt(pm__dot(p, p)), centre = hypot(p[0] - 0.5, p[1] - 0.5);
    const bool all = strcmp(region, "all") == 0;
    const char first = region[0];
    if (pm__is(c, "square")) {
        const double x = pm__test_side(p[0]), y = pm__test_side(p[1]);
        const double near = fmin(x, y), far = fmax(x, y);
        return all ? true
               : first == 'i' ? pm__test_inset(p, 0.15)
               : first == 'e' ? near <= 0.05 && far >= 0.15
                              : far <= 0.05;
    }
    if (pm__is(c, "wall"))
        return pm__test_inset(p, 0.15) && (all || (first == 'l') == (probe->normal[2] > 0.0));
    if (pm__is(c, "corner"))
        return probe->normal[2] > 0.5 && pm__between(p[1], 0.15, 0.85) &&
               (all ? p[0] <= 0.85 : first == 'n' ? p[0] <= 0.05 : pm__between(p[0], 0.15, 0.85));
    if (pm__is(c, "sphere")) {
        const double cosine = p[2] / pm__test_value(c, values, "radius");
        return all || (first == 'l' ? cosine > 0.5 : first == 't' ? fabs(cosine) < 0.1 : cosine < -0.2);
    }
    if (pm__is(c, "volume"))
        return all || (first == 'i' ? r <= 0.7 : r >= 0.9);
    if (pm__is(c, "point-light")) {
        const double t = rho / pm__test_value(c, values, "height");
        return all ? t <= 2.0 : first == 'f' && region[1] == 'o' ? t <= 0.25 : pm__between(t, 1.5, 2.0);
    }
    if (pm__is(c, "rect-light")) {
        const double a = 0.5 * pm__test_value(c, values, "width"), b = 0.5 * pm__test_value(c, values, "depth");
        const double h = pm__test_value(c, values, "height");
        if (all)
            return fabs(p[0]) <= a + 0.9 * h && fabs(p[1]) <= b + 0.9 * h;
        if (strcmp(region, "below") == 0)
            return fabs(p[0]) <= 0.5 * a && fabs(p[1]) <= 0.5 * b;
        return pm__between(p[0], a + 0.4 * h, a + 0.9 * h) && fabs(p[1]) <= b;
    }
    /* What is left has its regions inside the inset square. */
    if (all || pm__is(c, "gradient"))
        return pm__test_inset(p, 0.15);
    if (pm__is(c, "quadratic"))
        return centre <= 0.05;
    if (pm__is(c, "blob")) {
        const double t = centre / pm__test_value(c, values, "sigma");
        return first == 'p' ? t <= 0.5 : pm__between(t, 0.75, 1.25);
    }
    if (pm__is(c, "edge"))
        return pm__test_inset(p, 0.15) && (first == 'l'   ? pm__between(p[0], 0.45, 0.5)
                                           : first == 'd' ? pm__between(p[0], 0.5, 0.55)
                                                          : p[0] <= 0.35);
    /* sinusoid: within 1/20 wave of the crest (trough) next to the middle */
    const double cycles = pm__test_value(c, values, "cycles"), phase = p[0] * cycles;
    const double wave = first == 'c' ? round(0.5 * cycles) : floor(0.5 * cycles) + 0.5;
    return pm__test_inset(p, 0.15) && fabs(phase - wave) <= 0.05 + 1e-9;
}

#endif
