/* Truths of the traced scenes against rays traced here by vectors alone: a deterministic set of emitted rays, each with
 * its power, collected in bins; the mean truth of a bin by midpoints. What is left is the discretisation of both. */
#include "../test.h"

#include "../../cases/scenes/list.h"

static const double pi = 3.14159265358979323846;

static double truth_at(const pm__case *c, const double *values, double x, double y)
{
    const pm__probe probe = {.position = {x, y, 0}, .normal = {0, 0, 1}};
    return c->truth(values, &probe);
}

/* ---- Rays by vectors ---- */

typedef struct ray {
    double o[3], d[3], power;
} ray;

static void advance(ray *r, double distance)
{
    for (int i = 0; i < 3; i++)
        r->o[i] += distance * r->d[i];
}

static void reflect(ray *r, const double normal[3])
{
    const double c = pm__dot(r->d, normal);
    for (int i = 0; i < 3; i++)
        r->d[i] -= 2.0 * c * normal[i];
}

/* Snell's law for the tangential part; Fresnel's by angles: sin and tan of sum and difference. n: far over near. */
static void refract(ray *r, const double normal[3], double n)
{
    const double side = pm__dot(r->d, normal) < 0.0 ? -1.0 : 1.0, c = fabs(pm__dot(r->d, normal));
    double tangent[3], sine2 = 0.0;
    for (int i = 0; i < 3; i++) {
        tangent[i] = (r->d[i] - side * c * normal[i]) / n;
        sine2 += tangent[i] * tangent[i];
    }
    const double in = acos(c), out = asin(sqrt(sine2));
    const double s = in > 1e-6 ? sin(in - out) / sin(in + out) : (n - 1.0) / (n + 1.0);
    const double p = in > 1e-6 ? tan(in - out) / tan(in + out) : s;
    r->power *= 1.0 - 0.5 * (s * s + p * p);
    for (int i = 0; i < 3; i++)
        r->d[i] = tangent[i] + side * sqrt(1.0 - sine2) * normal[i];
}

static void to_level(ray *r, double z)
{
    advance(r, (z - r->o[2]) / r->d[2]);
}

/* Power by equal rings about the axis up to `reach`. */
enum { RINGS = 16 };

static void check_rings(const pm__case *c, const double *values, double from, double to, const double power[RINGS],
                        double tolerance)
{
    const double width = (to - from) / RINGS;
    for (int i = 0; i < RINGS; i++) {
        double mean = 0.0, area = 0.0;
        for (int j = 0; j < 64; j++) {
            const double r = from + width * (i + (j + 0.5) / 64);
            mean += r * truth_at(c, values, r, 0);
            area += r;
        }
        const double got = power[i] / (pi * width * width * ((from / width + i + 1) * (from / width + i + 1) -
                                                             (from / width + i) * (from / width + i)));
        ck_assert_msg(fabs(got / (mean / area) - 1) < tolerance, "%s %g %g ring %d: %.8g, truth %.8g", c->entry.name,
                      values[0], values[1], i, got, mean / area);
    }
}

static void collect(const ray *r, double from, double to, double power[RINGS])
{
    const double at = (hypot(r->o[0], r->o[1]) - from) / (to - from) * RINGS;
    if (at >= 0.0 && at < RINGS)
        power[(int)at] += r->power;
}

/* Far intersection with the unit sphere about the origin. */
static void through_sphere(ray *r)
{
    advance(r, -2.0 * pm__dot(r->o, r->d));
}

START_TEST(test_glass_rays)
{
    static const double setups[][4] = {{1.5, 2, 0, .8}, {1.5, 1.5, .1, .8}, {1.5, 1.2, .08, .4}, {1.5, 1, .02, .18},
                                       {1.33, 2.6, .1, .8}, {1.8, 1.7, 0, .8}};
    enum { RAYS = 2000000 };
    for (size_t k = 0; k < sizeof setups / sizeof *setups; k++) {
        const double *const s = setups[k];
        double power[RINGS] = {0}, landed = 0.0;
        for (int i = 0; i < RAYS; i++) {
            const double b = sqrt((i + 0.5) / RAYS), turn = 2.399963 * i; /* not in one plane, so that vectors matter */
            ray r = {{b * cos(turn), b * sin(turn), sqrt(1.0 - b * b)}, {0, 0, -1}, pi / RAYS};
            refract(&r, r.o, s[0]);
            through_sphere(&r);
            refract(&r, r.o, 1.0 / s[0]);
            if (r.d[2] >= 0.0)
                continue;
            to_level(&r, -s[1]);
            collect(&r, s[2], s[3], power);
            landed += hypot(r.o[0], r.o[1]) < 4.0 ? r.power : 0.0;
        }
        check_rings(&pm__case_scene_glass_sphere, s, s[2], s[3], power, 3e-3);
        PM_CHECK_NEAR(pm__case_scene_glass_sphere.power(s) / landed, 1.0, 1e-5);
    }
}
END_TEST

static void check_layer_rays(const pm__case *c, const double *values, double layer, bool both)
{
    enum { RAYS = 1000000 };
    const double floor_normal[3] = {0, 0, 1}, cone = cos(75.0 * pi / 180.0), total = 2 * pi * (1 - cone);
    double power[RINGS] = {0}, landed = 0.0;
    for (int i = 0; i < RAYS; i++) {
        const double cosine = 1 - (1 - cone) * (i + 0.5) / RAYS, sine = sqrt(1 - cosine * cosine), turn = 2.399963 * i;
        ray r = {{0, 0, layer + 1}, {sine * cos(turn), sine * sin(turn), -cosine}, total / RAYS};
        to_level(&r, both ? layer + 0.4 : layer);
        refract(&r, floor_normal, values[0]);
        to_level(&r, both ? 0.4 : 0);
        if (both)
            refract(&r, floor_normal, 1 / values[0]);
        to_level(&r, 0);
        collect(&r, 0, 2, power);
        landed += r.power;
    }
    check_rings(c, values, 0, 2, power, 1e-3);
    PM_CHECK_NEAR(c->power(values) / landed, 1.0, 1e-6);
}

START_TEST(test_layer_rays)
{
    static const double water[][2] = {{1.33}, {2.2}}, plate[][2] = {{1.5, .2}, {1.9, 1.3}};
    for (int i = 0; i < 2; i++) {
        check_layer_rays(&pm__case_scene_water, water[i], 1.0, false);
        check_layer_rays(&pm__case_scene_plate, plate[i], plate[i][1], true);
    }
}
END_TEST

START_TEST(test_pool_rays)
{
    static const double depths[] = {1, 2.5, 0.4, 3};
    enum { RAYS = 2000000, BINS = 20 };
    for (int k = 0; k < 4; k++) {
        double power[BINS] = {0};
        for (int i = 0; i < RAYS; i++) { /* one period either side, as wide as 1 in y */
            const double x = -1.5 + 3 * (i + 0.5) / RAYS, wave = 2 * pi;
            ray r = {{x, 0, depths[k] + 0.05 * cos(wave * x)}, {0, 0, -1}, 3.0 / RAYS};
            double normal[3] = {0.05 * wave * sin(wave * x), 0, 1};
            pm__normalize(normal);
            refract(&r, normal, 1.33);
            to_level(&r, 0);
            const double at = (r.o[0] + 0.5) * BINS;
            if (at >= 0 && at < BINS)
                power[(int)at] += r.power;
        }
        for (int b = 0; b < BINS; b++) {
            if (depths[k] > 1.5 && (b == BINS / 2 || b == BINS / 2 - 1))
                continue; /* folds: the midpoints would have to be many */
            double mean = 0.0;
            for (int j = 0; j < 64; j++)
                mean += truth_at(&pm__case_scene_pool, &depths[k], -0.5 + (b + (j + 0.5) / 64) / BINS, 0) / 64;
            PM_CHECK_NEAR(power[b] * BINS / mean, 1.0, 1e-3);
        }
    }
}
END_TEST

/* The power that the beam leaves in the pool, over a grid of its disc. */
START_TEST(test_pool_power)
{
    enum { SIDE = 2000 };
    const double values[1] = {1}, up = 2 * pi;
    double sum = 0.0;
    for (int i = 0; i < SIDE; i++) {
        const double x = 1.25 * (2 * (i + 0.5) / SIDE - 1);
        double normal[3] = {0.05 * up * sin(up * x), 0, 1};
        pm__normalize(normal);
        ray r = {{x, 0, 1}, {0, 0, -1}, 2 * sqrt(1.25 * 1.25 - x * x) * 2.5 / SIDE};
        refract(&r, normal, 1.33);
        sum += r.power;
    }
    PM_CHECK_NEAR(pm__case_scene_pool.power(values) / sum, 1.0, 1e-5);
}
END_TEST

/* ---- Mirrors: power in square cells over [-1, 1]^2 ---- */

enum { CELLS = 20, POINTS = 16 };

typedef struct cells {
    double power[CELLS][CELLS], inside, all; /* in cells, in the circle, anywhere */
    double ray;                              /* the power of one */
} cells;

static void collect_cell(const ray *r, cells *to)
{
    const double x = (r->o[0] + 1) * CELLS / 2, y = (r->o[1] + 1) * CELLS / 2;
    to->all += r->power;
    to->ray = r->power;
    to->inside += hypot(r->o[0], r->o[1]) < 1 ? r->power : 0;
    if (x >= 0 && y >= 0 && x < CELLS && y < CELLS)
        to->power[(int)x][(int)y] += r->power;
}

static void nephroid_fold(double t, double at[2])
{
    at[0] = cos(t) * (0.5 + sin(t) * sin(t));
    at[1] = sin(t) * sin(t) * sin(t);
}

static void cardioid_fold(double t, double at[2])
{
    at[0] = (2 * cos(2 * t) - cos(4 * t)) / 3;
    at[1] = (2 * sin(2 * t) - sin(4 * t)) / 3;
}

static double from_fold(void (*fold)(double t, double at[2]), double x, double y)
{
    double nearest = INFINITY;
    for (int i = 0; i <= 400; i++) {
        double at[2];
        fold(pi * (i / 400.0 - 0.5), at);
        nearest = fmin(nearest, hypot(at[0] - x, at[1] - y));
    }
    return nearest;
}

/* Cells wholly in the circle, and not on the fold: their half diagonal is 0.07. The points of a grid that fall into a
 * cell are off by the square root of how many lie by its rim, itself a square root: 3 of those, and 0.4 % for the
 * midpoints by a fold. */
static int check_cells(const pm__case *c, const double *values, void (*fold)(double t, double at[2]), const cells *got)
{
    int checked = 0;
    for (int i = 0; i < CELLS; i++)
        for (int j = 0; j < CELLS; j++) {
            const double cx = -1 + 2 * (i + 0.5) / CELLS, cy = -1 + 2 * (j + 0.5) / CELLS;
            double mean = 0.0;
            if (hypot(cx, cy) > 0.9 || from_fold(fold, cx, cy) < 0.08)
                continue;
            for (int k = 0; k < POINTS * POINTS; k++) {
                const double x = -1 + 2 * (i + (k % POINTS + 0.5) / POINTS) / CELLS;
                const double y = -1 + 2 * (j + (k / POINTS + 0.5) / POINTS) / CELLS;
                mean += truth_at(c, values, x, y) / (POINTS * POINTS);
            }
            const double e = got->power[i][j] * CELLS * CELLS / 4;
            const double tolerance = 0.004 + 3 * pow(got->power[i][j] / got->ray, -0.75);
            ck_assert_msg(fabs(e / mean - 1) < tolerance, "%s cell %d %d: %g, truth %g", c->entry.name, i, j, e, mean);
            checked++;
        }
    return checked;
}

/* Distance to the unit cylinder from inside or on it, beyond rounding; INFINITY if the ray goes straight up or down. */
static double to_cylinder(const ray *r)
{
    const double a = r->d[0] * r->d[0] + r->d[1] * r->d[1], b = r->o[0] * r->d[0] + r->o[1] * r->d[1];
    const double c = r->o[0] * r->o[0] + r->o[1] * r->o[1] - 1, disc = b * b - a * c;
    return disc < 0 ? INFINITY : (-b + sqrt(disc)) / a;
}

/* Where ray i of a grid stands in its row, 0 to 1. Rows are shifted against each other by the golden section, lest the
 * grid beat with the cells. */
static double column(int i, int side)
{
    const double shift = 0.6180339887498949 * (i / side);
    return (i % side + shift - floor(shift)) / side;
}

/* From the wall to the floor, unless the wall is met again; open: only x >= 0 is wall. */
static bool land(ray *r, bool open)
{
    const double again = to_cylinder(r), fall = -r->o[2] / r->d[2];
    const bool stopped = again < fall && (!open || r->o[0] + again * r->d[0] >= 0);
    to_level(r, 0);
    return !stopped;
}

START_TEST(test_nephroid_rays)
{
    static const double setups[][2] = {{45, 2}, {30, 1.5}};
    enum { SIDE = 3000 };
    for (int k = 0; k < 2; k++) {
        const double a = setups[k][0] * pi / 180, high = setups[k][1], width = sin(a) + high * cos(a);
        cells *const got = calloc(1, sizeof *got);
        for (int i = 0; i < SIDE * SIDE; i++) {
            const double y = 2 * column(i, SIDE) - 1, w = width * (i / SIDE + 0.5) / SIDE;
            ray r = {{w * sin(a), y, w * cos(a)}, {cos(a), 0, -sin(a)}, 2 * width / ((double)SIDE * SIDE)};
            advance(&r, to_cylinder(&r));
            if (r.o[2] < 0 || r.o[2] > high)
                continue;
            const double normal[3] = {r.o[0], r.o[1], 0};
            reflect(&r, normal);
            if (land(&r, true))
                collect_cell(&r, got);
        }
        ck_assert_int_gt(check_cells(&pm__case_scene_nephroid, setups[k], nephroid_fold, got), 150);
        PM_CHECK_NEAR(pm__case_scene_nephroid.power(setups[k]) / got->all, 1.0, 1e-3);
        free(got);
    }
}
END_TEST

START_TEST(test_cardioid_rays)
{
    static const double heights[] = {1, 2.5};
    enum { SIDE = 3000 };
    for (int k = 0; k < 2; k++) {
        cells *const got = calloc(1, sizeof *got);
        for (int i = 0; i < SIDE * SIDE; i++) {
            const double sine = (i / SIDE + 0.5) / SIDE, plan = sqrt(1 - sine * sine);
            const double phi = pi * (column(i, SIDE) - 0.5);
            ray r = {{-1, 0, heights[k]}, {plan * cos(phi), plan * sin(phi), -sine}, pi / ((double)SIDE * SIDE)};
            advance(&r, to_cylinder(&r));
            if (r.o[2] < 0 || r.o[0] < -0.999)
                continue;
            const double normal[3] = {r.o[0], r.o[1], 0};
            reflect(&r, normal);
            if (land(&r, false))
                collect_cell(&r, got);
        }
        ck_assert_int_gt(check_cells(&pm__case_scene_cardioid, &heights[k], cardioid_fold, got), 150);
        PM_CHECK_NEAR(pm__case_scene_cardioid.power(&heights[k]) / got->inside, 1.0, 1e-3);
        free(got);
    }
}
END_TEST

/* Light that a point (1, 0, 0) of the sphere sends back in Lambert's way, by a grid of equal parts of its power, lands
 * alike in equal bands about any axis. */
START_TEST(test_integrating_rays)
{
    enum { SIDE = 1000, BANDS = 10 };
    const double tilt[3] = {0.6, 0.48, 0.64};
    double bands[BANDS] = {0};
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double sine = sqrt((i / SIDE + 0.5) / SIDE), turn = 2 * pi * (i % SIDE + 0.5) / SIDE;
        ray r = {{1, 0, 0}, {-sqrt(1 - sine * sine), sine * cos(turn), sine * sin(turn)}, 1.0 / SIDE / SIDE};
        through_sphere(&r);
        bands[(int)fmin(BANDS - 1, BANDS * 0.5 * (1 + pm__dot(r.o, tilt)))] += r.power;
    }
    const double half[1] = {0.5};
    const pm__probe inside = {.position = {1, 0, 0}, .normal = {-1, 0, 0}};
    const double truth = pm__case_scene_integrating_sphere.truth(half, &inside);
    for (int i = 0; i < BANDS; i++) /* at albedo 1/2, the indirect light is as much as the light's own */
        PM_CHECK_NEAR(bands[i] * BANDS / (4 * pi) / truth, 1.0, 2e-3);
    PM_CHECK_NEAR(pm__case_scene_integrating_sphere.power(half), 1.0, 1e-14);
}
END_TEST

PM_TEST_MAIN("scene-rays", test_glass_rays, test_layer_rays, test_pool_rays, test_pool_power, test_nephroid_rays,
             test_cardioid_rays, test_integrating_rays)
