/* How much of a lookup's disc is surface. Of a disc of radius R whose middle is q R from a straight edge,
 * (acos q - q sqrt(1 - q^2)) / pi lies beyond it: a circular segment. Of a kernel w(t), t = r / R, the ring at t has
 * acos(q / t) / pi beyond, so the share that is missing is
 *     int_q^1 w(t) t acos(q / t) dt / (pi int_0^1 w(t) t dt),
 * which with w = 1 is the segment's and with w = 1 - t^2 is (acos q - q (5 - 2 q^2) sqrt(1 - q^2) / 3) / pi. An edge
 * through the middle halves any kernel.
 *
 * The 32 points, at (R sqrt((i + 1/2) / 32), 2.39996 i + phase), make a share right to about two of them; counted apart
 * from the code, over 720 phases and every distance of the edge, they are off by 2.64 at worst (at q = 0.38). */
#include "../../cases/scenes/room.h"
#include "../../src/methods/coverage.h"
#include "../lit.h"

enum { PHASES = 200, STEPS = 20000 };

static const double pi = 3.14159265358979323846;
static const double two_points = 2.0 / PM__DISC_POINTS, worst = 2.65 / PM__DISC_POINTS, hair = 1e-6;
static const double up[3] = {0.0, 0.0, 1.0}, below[3] = {0.0, 0.0, -1.0};

/* A scene must have a light: far away. */
static pm__scene *finish(pm__scene *scene)
{
    const pm__light lamp = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0, 0, 100}};
    lit_lamp(scene, &lamp);
    return lit_commit(scene);
}

static void add_rectangle(pm__scene *scene, uint32_t material, double x, double y, double z, const double u[3],
                          const double v[3])
{
    pm_error error;
    const double corner[3] = {x, y, z};
    PM_CHECK_OK(pm__scene_rectangle(scene, material, corner, u, v, &error), error);
}

/* |x|, |y| <= 1/2 at z = 0. */
static pm__scene *square(void)
{
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 0.5, 0.0);
    return scene;
}

static double share_by(const char *estimator, const pm__scene *scene, const double position[3],
                       const double normal[3], double radius, double phase)
{
    pm_error error;
    pm__spec spec;
    pm__coverage coverage;
    PM_CHECK_OK(pm__spec_parse(&pm__estimators, estimator, &spec, &error), error);
    pm__coverage_find(scene, position, normal, radius, phase, &coverage);
    return pm__coverage_share(&coverage, &spec);
}

static void check_share(const pm__scene *scene, double x, double y, double z, const double normal[3], double radius,
                        double want, double tolerance)
{
    const double position[3] = {x, y, z};
    for (int i = 0; i < PHASES; i++) {
        const double got = share_by("disc", scene, position, normal, radius, (double)i / PHASES);
        ck_assert_msg(fabs(got - want) <= tolerance, "(%g, %g, %g), radius %g, phase %d / %d: %g, expected %g", x, y,
                      z, radius, i, PHASES, got, want);
    }
}

static double mean_share(const char *estimator, const pm__scene *scene, double x, double radius)
{
    const double position[3] = {x, 0.0, 0.0};
    double sum = 0.0;
    for (int i = 0; i < PHASES; i++)
        sum += share_by(estimator, scene, position, up, radius, (double)i / PHASES);
    return sum / PHASES;
}

static double segment(double q)
{
    return (acos(q) - q * sqrt(1.0 - q * q)) / pi;
}

START_TEST(middle_edge_and_corner)
{
    pm__scene *const scene = finish(square());
    check_share(scene, 0.0, 0.0, 0.0, up, 0.1, 1.0, 0.0);
    check_share(scene, 0.1, -0.3, 0.0, up, 0.19, 1.0, 0.0);
    check_share(scene, 0.5 - hair, 0.0, 0.0, up, 0.1, 0.5, two_points);
    check_share(scene, 0.0, -0.5 + hair, 0.0, up, 0.2, 0.5, two_points);
    check_share(scene, 0.5 - hair, 0.5 - hair, 0.0, up, 0.1, 0.25, two_points);
    check_share(scene, -0.5 + hair, 0.5 - hair, 0.0, up, 0.3, 0.25, two_points);
    pm__scene_destroy(scene);
}
END_TEST

START_TEST(share_by_distance_from_an_edge)
{
    pm__scene *const scene = finish(square());
    const double radius = 0.2;
    for (int i = 1; i <= 19; i++) {
        const double q = 0.05 * i, x = 0.5 - q * radius;
        check_share(scene, x, 0.0, 0.0, up, radius, 1.0 - segment(q), worst);
        PM_CHECK_NEAR(mean_share("disc", scene, x, radius), 1.0 - segment(q), 0.01);
    }
    pm__scene_destroy(scene);
}
END_TEST

typedef double kernel(double t);

static double even(double t)
{
    (void)t;
    return 1.0;
}

static double of_cone(double t)
{
    return 1.0 - t / 1.5;
}

static double of_epanechnikov(double t)
{
    return 1.0 - t * t;
}

static double missing(kernel *w, double q)
{
    double out = 0.0, all = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double t = (i + 0.5) / STEPS;
        all += w(t) * t;
        out += t > q ? w(t) * t * acos(q / t) / pi : 0.0;
    }
    return out / all;
}

START_TEST(kernels_weigh_the_surface)
{
    static const struct {
        const char *estimator;
        kernel *weight;
    } cases[] = {{"disc", even}, {"cone:k=1.5", of_cone}, {"epanechnikov", of_epanechnikov}};
    pm__scene *const scene = finish(square());
    const double radius = 0.2;
    for (int i = 0; i <= 9; i++) {
        const double q = 0.1 * i, root = sqrt(1.0 - q * q);
        PM_CHECK_NEAR(missing(even, q), segment(q), 1e-4);
        PM_CHECK_NEAR(missing(of_epanechnikov, q), (acos(q) - q * (5.0 - 2.0 * q * q) * root / 3.0) / pi, 1e-4);
        for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
            const double got = mean_share(cases[c].estimator, scene, 0.5 - hair - q * radius, radius);
            const double want = 1.0 - missing(cases[c].weight, q);
            ck_assert_msg(fabs(got - want) <= 0.01, "%s, q = %g: %g, expected %g", cases[c].estimator, q, got, want);
        }
    }
    pm__scene_destroy(scene);
}
END_TEST

/* It fits its own boundary, wherever it is. */
START_TEST(hull_has_all)
{
    pm__scene *const scene = finish(square());
    const double middle[3] = {0.0, 0.0, 0.0}, corner[3] = {0.5 - hair, 0.5 - hair, 0.0};
    ck_assert_double_eq(share_by("hull", scene, middle, up, 0.1, 0.3), 1.0);
    ck_assert_double_eq(share_by("hull", scene, corner, up, 0.1, 0.3), 1.0);
    pm__scene_destroy(scene);
}
END_TEST

/* On the floor's edge x = 1/2. Neither stands in for the other where it ends. */
START_TEST(wall_on_the_edge_changes_nothing)
{
    const double y[3] = {0.0, 1.0, 0.0}, inward[3] = {-1.0, 0.0, 0.0}, radius = 0.2;
    pm__scene *const bare = finish(square()), *const walled = square();
    add_rectangle(walled, lit_wall(walled, 0.5, 0.5, 0.5), 0.5, -0.5, 0.0, up, y);
    finish(walled);
    for (int i = 0; i <= 10; i++) {
        const double position[3] = {0.5 - hair - 0.1 * i * radius, 0.1, 0.0};
        for (int phase = 0; phase < 10; phase++)
            ck_assert_double_eq(share_by("disc", walled, position, up, radius, 0.1 * phase),
                                share_by("disc", bare, position, up, radius, 0.1 * phase));
    }
    check_share(walled, 0.5, 0.0, hair, inward, radius, 0.5, two_points);
    check_share(walled, 0.5, 0.0, 0.5, inward, radius, 1.0, 0.0);
    check_share(walled, 0.5, 0.5 - hair, hair, inward, radius, 0.25, two_points);
    pm__scene_destroy(bare);
    pm__scene_destroy(walled);
}
END_TEST

/* The floor goes on below a block, but no light gets there. */
START_TEST(floor_under_a_block_is_not_there)
{
    pm_error error;
    const double centre[2] = {0.0, 0.0}, outward[3] = {1.0, 0.0, 0.0}, half = 0.2, height = 0.3, radius = 0.1;
    pm__scene *const scene = square();
    PM_CHECK_OK(pm__room_block(scene, lit_wall(scene, 0.5, 0.5, 0.5), centre, half, height, 0.0, &error), error);
    finish(scene);
    check_share(scene, half + hair, 0.0, 0.0, up, radius, 0.5, two_points);
    check_share(scene, half + hair, half + hair, 0.0, up, radius, 0.75, two_points);
    check_share(scene, half + 0.5 * radius, 0.0, 0.0, up, radius, 1.0 - segment(0.5), worst);
    check_share(scene, half + 1.01 * radius, 0.0, 0.0, up, radius, 1.0, 0.0);
    check_share(scene, 0.0, 0.0, height, up, radius, 1.0, 0.0);
    check_share(scene, half - hair, 0.0, height, up, radius, 0.5, two_points);
    check_share(scene, half, 0.0, hair, outward, radius, 0.5, two_points);
    check_share(scene, half, 0.0, height - hair, outward, radius, 0.5, two_points);
    pm__scene_destroy(scene);
}
END_TEST

/* A sphere falls by R^2 / 2a: by 0.15 R at R = 0.3 a, where its normal is 17 degrees off. Another floor that lies 0.2 R
 * lower counts as the same surface, and one 0.3 R lower does not: what may bend away is a quarter of R. */
START_TEST(surfaces_may_bend_away)
{
    const double a = 2.0, radius = 0.1, u[3] = {1.0, 0.0, 0.0}, v[3] = {0.0, 1.0, 0.0};
    for (int inward = 0; inward < 2; inward++) {
        pm__scene *const scene = lit_create();
        lit_sphere(scene, lit_wall(scene, 0.5, 0.5, 0.5), 0.0, 0.0, -a, a, inward);
        finish(scene);
        for (int i = 1; i <= 6; i++)
            check_share(scene, 0.0, 0.0, 0.0, inward ? below : up, 0.05 * i * a, 1.0, 0.0);
        pm__scene_destroy(scene);
    }
    for (int deep = 0; deep < 2; deep++) {
        pm__scene *const scene = square();
        add_rectangle(scene, lit_wall(scene, 0.5, 0.5, 0.5), 0.5, -0.5, deep ? -0.3 * radius : -0.2 * radius, u, v);
        finish(scene);
        check_share(scene, 0.5 - hair, 0.0, 0.0, up, radius, deep ? 0.5 : 1.0, deep ? two_points : 0.0);
        pm__scene_destroy(scene);
    }
}
END_TEST

START_TEST(sheets_have_two_sides)
{
    const pm__material paper = {
        .kind = PM__DIFFUSE, .diffuse = {0.5, 0.5, 0.5}, .two_sided = true, .back = {0.3, 0.3, 0.3}};
    pm__scene *const scene = lit_create();
    lit_floor(scene, lit_material(scene, &paper), 0.5, 0.0);
    finish(scene);
    for (int side = 0; side < 2; side++) {
        const double *const normal = side ? below : up;
        check_share(scene, 0.0, 0.0, 0.0, normal, 0.1, 1.0, 0.0);
        check_share(scene, 0.5 - hair, 0.0, 0.0, normal, 0.1, 0.5, two_points);
        check_share(scene, 0.5 - hair, 0.5 - hair, 0.0, normal, 0.1, 0.25, two_points);
    }
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("coverage", middle_edge_and_corner, share_by_distance_from_an_edge, kernels_weigh_the_surface,
             hull_has_all, wall_on_the_edge_changes_nothing, floor_under_a_block_is_not_there, surfaces_may_bend_away,
             sheets_have_two_sides)
