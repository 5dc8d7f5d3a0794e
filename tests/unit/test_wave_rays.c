/* Marches along the wave where they are hardest: along the axes, in the surface itself, over thousands of crests, from
 * far off, to and from points on the wave; one by one and in batches.
 *
 * A level ray at height a - delta over the mean along x meets the crest at phase 2 pi n before it, at
 * k x = 2 pi n - acos(1 - delta / a). A ray that sinks by `slope` per m is nearest over a crest at
 * k x = 2 pi n + asin(slope / (a k)), so the first crest where it is below the wave there is the one that it meets. */
#include "../../src/scene/wave.h"
#include "../batches.h"
#include "../shapes.h"

static const long double pi = 3.14159265358979323846L;

/* Steps that the march along the ray takes; it is given up after a million. */
static int steps_of(const pm__shape *shape, const asked *ray, bool *met, double *distance)
{
    enum { MOST = 1000000 };
    pm__above over;
    pm__march m = pm__wave_begin(shape, ray->origin, ray->direction, INFINITY, ray->from == 0, &over);
    int count = 0;
    while (m.goes_on && count < MOST) {
        pm__wave_step(&over, shape->amplitude, &m);
        count++;
    }
    ck_assert_msg(count < MOST, "from (%g, %g, %g) along (%g, %g, %g): no end", ray->origin[0], ray->origin[1],
                  ray->origin[2], ray->direction[0], ray->direction[1], ray->direction[2]);
    *met = m.is_root;
    *distance = m.t;
    return count;
}

/* ---- Along the axes, and in the surface ---------------------------------------------------------- */

static pm__shape prepared(pm__shape shape)
{
    pm_error error;
    PM_CHECK_OK(pm__shape_prepare(&shape, 0, &error), error);
    return shape;
}

/* Every direction of components -1, 0 and 1, and those a hair beside; from above, within, below and on the wave.
 * Marched one by one first, so that what does not end is seen here. */
static size_t rays_along_axes(const pm__shape *shape, asked *rays)
{
    static const double beside[] = {0.0, 1e-320, 1e-200, 1e-12};
    size_t count = 0;
    for (int way = 0; way < 27; way++)
        for (int height = 0; height < 5; height++)
            for (size_t b = 0; b < 4 && way != 13; b++) {
                asked *const r = &rays[count++];
                double up[3];
                bool met;
                double distance;
                *r = (asked){.origin = {b == 1 ? 0.0 : 0.3, 0.2, 0.1}, .from = PM__NO_SHAPE};
                for (int axis = 0, left = way; axis < 3; axis++, left /= 3)
                    r->direction[axis] = left % 3 - 1.0 + beside[b];
                (void)pm__normalize(r->direction);
                if (height == 4) {
                    pm__shape_settle(shape, r->origin, up);
                    r->from = 0;
                } else {
                    const double highest = fabs(shape->amplitude);
                    const double to[] = {-0.99 * highest, 0.0, 0.99 * highest, 2.0 * highest + 1.0};
                    r->origin[2] += to[height];
                }
                ck_assert_int_lt(steps_of(shape, r, &met, &distance), 20000);
                ck_assert(r->from != 0 || !met || distance > shape->slack); /* not the origin itself */
            }
    return count;
}

START_TEST(test_along_axes)
{
    static const double waves[][2] = {{0.12, 8.0}, {-0.3, 3.0}, {0.0, 0.0}, {0.0, 5.0}, {0.2, 0.0}, {1e-9, 1e3}};
    static asked rays[27 * 5 * 4];
    for (size_t w = 0; w < sizeof waves / sizeof *waves; w++) {
        pm__shape shape = prepared(wave(waves[w][0], waves[w][1]));
        const size_t count = rays_along_axes(&shape, rays);
        pm__scene *const scene = scene_of(&shape, 1);
        check_batches(scene, rays, count, "along the axes");
        pm__scene_destroy(scene);
    }
}
END_TEST

/* A wave that is flat, by no amplitude or no wavenumber, against its plane: one way to meet it, and none in it. */
START_TEST(test_flat_waves)
{
    static const double flats[][2] = {{0.0, 0.0}, {0.0, 7.0}, {0.25, 0.0}};
    for (size_t f = 0; f < 3; f++) {
        pm__shape shape = wave(flats[f][0], flats[f][1]);
        const double level = flats[f][1] > 0.0 ? 0.1 : 0.1 + flats[f][0];
        pm__scene *const scene = scene_of(&shape, 1);
        int met_count = 0;
        for (uint64_t i = 0; i < 20000; i++) {
            double o[3], d[3];
            pm__hit hit;
            random_ray(30, i, 2.0, o, d);
            const double t = (level - o[2]) / d[2], x = o[0] + t * d[0], y = o[1] + t * d[1];
            const bool want = t > 0.0 && fabs(x) <= 1.7 && fabs(y) <= 1.3;
            const bool met = pm__scene_intersect(scene, o, d, INFINITY, PM__NO_SHAPE, &hit);
            ck_assert_msg(met == want, "ray %d: met %d", (int)i, met);
            if (!met)
                continue;
            met_count++;
            PM_CHECK_NEAR(hit.distance, t, 1e-14 * (1.0 + t / fabs(d[2])));
            PM_CHECK_NEAR(hit.position[2], level, 0.0);
            PM_CHECK_NEAR(hit.normal[2], 1.0, 0.0);
            ck_assert(!pm__scene_intersect(scene, hit.position, d, INFINITY, hit.shape, &hit));
            d[2] = 0.0;
            (void)pm__normalize(d);
            ck_assert(!pm__scene_intersect(scene, hit.position, d, INFINITY, hit.shape, &hit));
            const double other[3] = {hit.position[1], -0.5 * hit.position[0], level};
            ck_assert(!pm__scene_blocked(scene, hit.position, 0, other, 0));
        }
        ck_assert_int_gt(met_count, 2000);
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Level at a trough, but for a hair upward: over the wave until its flank comes, climb t = 2 a sin^2(k t / 2), at
 * t = 2 climb / (a k^2) (1 + k^2 t^2 / 12 + ...), and along the ray longer by climb^2 / 2: in all by 1.7 t^3. Nearer
 * than the slack there is nothing. */
START_TEST(test_leaving_a_trough)
{
    pm__shape shape = prepared(wave(-0.3, 3.0));
    for (int i = 0; i < 4000; i++) {
        const double climb = pow(10.0, -17.0 + 14.0 * i / 4000.0), want = 2.0 * climb / (0.3 * 3.0 * 3.0);
        asked ray = {.origin = {0.0, 0.2, 0.1 - 0.3}, .direction = {i % 2 ? 1.0 : -1.0, 0.0, climb}};
        bool met;
        double distance;
        (void)pm__normalize(ray.direction);
        ck_assert_int_lt(steps_of(&shape, &ray, &met, &distance), 1000);
        ck_assert_msg(!met || distance > shape.slack, "climb %g: met at %g", climb, distance);
        if (want > 2.0 * shape.slack)
            ck_assert_msg(met && fabs(distance - want) <= 4e-15 + 2.0 * want * want * want,
                          "climb %g: met %d at %g, not %g", climb, met, distance, want);
    }
}
END_TEST

/* What is not finite meets nothing, alone and among others. */
START_TEST(test_not_finite)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    static asked rays[3 * 6 * 2];
    pm__shape shape = wave(0.12, 8.0);
    pm__scene *const scene = scene_of(&shape, 1);
    size_t count = 0;
    for (int i = 0; i < 18; i++) {
        asked r = {.origin = {0.1, 0.2, 1.0}, .direction = {0.0, 0.6, -0.8}, .from = PM__NO_SHAPE};
        pm__hit hit;
        rays[count++] = r;
        (i % 6 < 3 ? r.origin : r.direction)[i % 3] = bad[i / 6];
        rays[count++] = r;
        ck_assert(!pm__scene_intersect(scene, r.origin, r.direction, INFINITY, PM__NO_SHAPE, &hit));
        if (i % 6 < 3) {
            ck_assert(!pm__scene_blocked(scene, r.origin, PM__NO_SHAPE, rays[0].origin, PM__NO_SHAPE));
            ck_assert(!pm__scene_blocked(scene, rays[0].origin, PM__NO_SHAPE, r.origin, PM__NO_SHAPE));
        }
    }
    check_batches(scene, rays, count, "not finite");
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Thousands of crests -------------------------------------------------------------------------- */

enum { CRESTS = 2000 };

/* Amplitude 0.05 m, one crest a metre, from -1000 to 1000 m. */
static pm__shape long_wave(void)
{
    pm__shape shape = wave(0.05, (double)(2.0L * pi));
    shape.extent[0] = 0.5 * CRESTS;
    return prepared(shape);
}

/* Level, above the crests by little: past all of them. Below by little: the next one, at its closed form. */
START_TEST(test_level_over_crests)
{
    pm__shape shape = long_wave();
    const long double k = (long double)shape.wavenumber, a = (long double)shape.amplitude;
    pm__scene *const scene = scene_of(&shape, 1);
    asked rays[2 * PM__BATCH];
    for (int i = 0; i < 2 * PM__BATCH; i++) {
        const int nth = i / 2 * 15 - 990; /* starts over the trough before this crest */
        const double off = pow(10.0, -1.0 - 11.0 * (i / 2) / (double)PM__BATCH) * (i % 2 ? 0.1 : -0.1);
        bool met;
        double distance;
        rays[i] = (asked){.origin = {nth - 0.5, 0.3, shape.centre[2] + (shape.amplitude + off)},
                          .direction = {1.0, 0.0, 0.0},
                          .from = PM__NO_SHAPE};
        const int steps = steps_of(&shape, &rays[i], &met, &distance);
        ck_assert_msg(met == (off < 0.0), "%g m over the crests: met %d", off, met);
        ck_assert_msg(steps < (met ? 200 : 40 * CRESTS), "%g m over the crests: %d steps", off, steps);
        if (!met)
            continue;
        const long double over = (long double)rays[i].origin[2] - (long double)shape.centre[2];
        const long double want = (2.0L * pi * nth - acosl(over / a)) / k - (long double)rays[i].origin[0];
        /* The crest is flat: an error of the height of 1e-17 m moves the place by that over the slope. */
        const double slope = (double)(a * k * sqrtl(1.0L - over / a * (over / a)));
        PM_CHECK_NEAR(distance, (double)want, 1e-15 + 2e-15 * fabs((double)nth) + 1e-16 / slope);
    }
    check_batches(scene, rays, 2 * PM__BATCH, "level over crests");
    pm__scene_destroy(scene);
}
END_TEST

/* Height over the wave of a ray that at x is `over` above the mean and sinks by `slope`, x from crest `n`. */
static long double above(const pm__shape *s, long double over, long double slope, int n, long double x)
{
    return over - slope * (n + x) - (long double)s->amplitude * cosl((long double)s->wavenumber * x);
}

/* The first crest whose nearest point the ray is below; there the root is between the trough before and that point. */
static long double sinking_root(const pm__shape *s, long double over, long double slope, int first)
{
    const long double k = (long double)s->wavenumber, nearest = asinl(slope / ((long double)s->amplitude * k)) / k;
    for (int n = first; n <= CRESTS / 2; n++) {
        long double low = -0.5L, high = nearest;
        if (above(s, over, slope, n, nearest) >= 0.0L)
            continue;
        for (int i = 0; i < 80; i++) {
            const long double middle = 0.5L * (low + high);
            *(above(s, over, slope, n, middle) < 0.0L ? &high : &low) = middle;
        }
        return n + low;
    }
    return INFINITY;
}

/* Sinking slowly over hundreds of crests. The wave of 1 m has k = 2 pi to rounding only: over n crests its crests are
 * off by n 1e-16 m. */
START_TEST(test_sinking_over_crests)
{
    pm__shape shape = long_wave();
    pm__scene *const scene = scene_of(&shape, 1);
    asked rays[PM__BATCH];
    int far = 0;
    for (int i = 0; i < PM__BATCH; i++) {
        double u[3], distance;
        bool met;
        pm__random_uniform(7, PM__FOR_TESTS, 31, (uint64_t)i, u, 3);
        const double slope = pow(10.0, -2.0 - 3.0 * u[0]), over = shape.amplitude * (1.0 + u[1]);
        rays[i] = (asked){.origin = {-990.5, 0.0, shape.centre[2] + over}, .direction = {1.0, 0.0, -slope},
                          .from = PM__NO_SHAPE};
        const double length = pm__normalize(rays[i].direction);
        const double z = rays[i].origin[2] - shape.centre[2];
        const long double root = sinking_root(&shape, (long double)z - 990.5L * (long double)slope, (long double)slope,
                                              -990);
        const int steps = steps_of(&shape, &rays[i], &met, &distance);
        ck_assert_msg(met == (root < INFINITY) && steps < 40 * CRESTS, "ray %d: met %d, %d steps", i, met, steps);
        if (!met)
            continue;
        const double want = (double)((root + 990.5L) * (long double)length);
        const long double x = root - rintl(root);
        const double steep = fabs((double)((long double)(shape.amplitude * shape.wavenumber) *
                                           sinl(2.0L * pi * x)) - slope);
        PM_CHECK_NEAR(distance, want, 1e-13 * (1.0 + want) + 1e-15 * want / steep);
        far += want > 100.0;
    }
    ck_assert_int_gt(far, PM__BATCH / 4);
    check_batches(scene, rays, PM__BATCH, "sinking over crests");
    pm__scene_destroy(scene);
}
END_TEST

/* As many crests as a wave may have, and a ray just over them all. */
START_TEST(test_most_crests)
{
    pm__shape shape = wave(1e-3, 900.0);
    shape.extent[0] = 1e6 / 900.0;
    shape = prepared(shape);
    const asked over = {.origin = {-2e3, 0.1, 0.1 + 1.0001e-3}, .direction = {1.0, 0.0, 0.0}, .from = PM__NO_SHAPE};
    bool met = true;
    pm__above along;
    pm__march m = pm__wave_begin(&shape, over.origin, over.direction, INFINITY, false, &along);
    int steps = 0;
    for (; m.goes_on && steps < 20000000; steps++)
        pm__wave_step(&along, shape.amplitude, &m);
    met = m.is_root;
    ck_assert_msg(!met && !m.goes_on, "%d steps: met %d", steps, met);
}
END_TEST

/* ---- From far off --------------------------------------------------------------------------------- */

/* Down onto the wave from 10^3 to 10^9 m: never through it. The origin's rounding moves the ray by as much. */
START_TEST(test_from_far_off)
{
    static asked rays[PM__BATCH * 8];
    pm__shape shape = prepared(wave(0.12, 8.0));
    pm__scene *const scene = scene_of(&shape, 1);
    for (int power = 3; power <= 9; power++) {
        const double away = pow(10.0, power);
        for (uint64_t i = 0; i < 80000; i++) {
            double at[3], d[3];
            pm__hit hit;
            random_ray(32, i, 1.0, at, d);
            const double side = i % 2 ? 1.0 : -1.0;
            d[2] = -side * (0.6 + 0.4 * fabs(d[2]));
            (void)pm__normalize(d);
            at[2] = 0.0;
            if (i % 4 < 2) /* onto a crest, or a trough from below, where the wave is as high as its box */
                at[0] = (double)(2.0L * pi) / 8.0 * (i % 2 ? 0.0 : 0.5) + 1e-3 * at[0];
            double up[3];
            pm__shape_settle(&shape, at, up);
            for (int axis = 0; axis < 3; axis++)
                at[axis] -= away * d[axis];
            const bool met = pm__scene_intersect(scene, at, d, INFINITY, PM__NO_SHAPE, &hit);
            ck_assert_msg(met && pm__dot(hit.normal, d) * side < 0.0, "ray %d from %g m: met %d, from within at %.17g",
                          (int)i, away, met, met ? hit.distance : 0.0);
            PM_CHECK_NEAR(hit.distance, away, 0.6); /* another crest may come before */
            if (i < sizeof rays / sizeof *rays) {
                memcpy(rays[i].origin, at, sizeof at);
                memcpy(rays[i].direction, d, sizeof d);
                rays[i].from = PM__NO_SHAPE;
            }
        }
        check_batches(scene, rays, sizeof rays / sizeof *rays, "from far off");
    }
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("wave rays", test_along_axes, test_flat_waves, test_leaving_a_trough, test_not_finite,
             test_level_over_crests, test_sinking_over_crests, test_most_crests, test_from_far_off)
