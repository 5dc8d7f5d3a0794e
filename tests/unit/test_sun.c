/* Suns: what leaves the window, what arrives from it and what is seen of it are one light.
 *
 * A sun of half angle a and power Phi, its window of radius R: radiance L = Phi / (pi R^2 pi sin^2 a) along all lines
 * within a of the axis that pass the window. So, n the receiver's unit normal at an angle t from the axis:
 * whole sun seen, t + a <= pi / 2        pi L sin^2 a cos t = Phi cos t / (pi R^2): the integral of the cosine to n
 *                                        over a cone is its projection, pi sin^2 a, foreshortened
 * on the axis, h away, b = atan(R / h)   pi L sin^2 min(a, b), by the same
 * a = pi / 2, parallel, x off the axis   (pi L / 2) (1 - (h^2 + x^2 - R^2) / sqrt((h^2 + x^2 + R^2)^2 - 4 R^2 x^2)),
 *                                        a Lambertian disc (configuration factor of a disc, parallel element)
 * Of the photons those that meet a disc of radius r about the axis, h away, are
 * the disc sees the whole sun            (r / R)^2
 * a = pi / 2                             (X - sqrt(X^2 - 4 (r / R)^2)) / 2, X = 1 + (r^2 + h^2) / R^2 (coaxial discs)
 * Statistical bounds are 6 standard deviations of the true law: a false alarm once in 5e8 comparisons, 5e-8 for the
 * file. */
#include "../../src/base/random.h"
#include "../../src/base/sobol.h"
#include "../../src/transport/eye.h"
#include "../lit.h"

#include <string.h>

enum { SAMPLES = 200000, GRID = 400, DIRECTIONS = 1 << 18 };

static const double pi = 3.14159265358979323846;

static pm__light sun_of(double angle, double radius)
{
    return (pm__light){.kind = PM__SUN, .power = {3, 2, 1}, .position = {0.3, -0.2, 4}, .direction = {0.48, 0.36, -0.8},
                       .radius = radius, .angle = angle};
}

static double radiance_of(const pm__light *sun)
{
    return sun->power[0] / pow(pi * sun->radius * sin(sun->angle), 2);
}

/* `ahead` of the window along the axis, `off` beside it; normal: `tilt` from the way back along the axis. */
static void place(const pm__light *sun, double ahead, double off, double tilt, double point[3], double normal[3])
{
    double s[3], t[3];
    pm__basis(sun->direction, s, t);
    for (int i = 0; i < 3; i++) {
        point[i] = sun->position[i] + ahead * sun->direction[i] + off * s[i];
        normal[i] = -cos(tilt) * sun->direction[i] + sin(tilt) * t[i];
    }
}

/* Irradiance in red by what arrives: the mean over u, by midpoints. */
static double received(const pm__light *sun, const double point[3], const double normal[3])
{
    double sum = 0.0;
    for (int i = 0; i < GRID * GRID; i++) {
        const double u[2] = {(i % GRID + 0.5) / GRID, (i / GRID + 0.5) / GRID};
        pm__light_sample s;
        if (pm__light_reach(sun, point, u, &s))
            sum += s.irradiance[0] * fmax(0.0, pm__dot(s.direction, normal));
    }
    return sum / (GRID * GRID);
}

/* The same by what is seen: pi times its mean over cosine-weighted directions. */
static double seen(const pm__light *sun, const double point[3], const double normal[3])
{
    double s[3], t[3], sum = 0.0;
    pm__basis(normal, s, t);
    for (uint32_t i = 0; i < DIRECTIONS; i++) {
        const double angle = 2.0 * pi * pm__sobol(i, 0) * 0x1p-32, r2 = (pm__sobol(i, 1) + 0.5) * 0x1p-32;
        double direction[3], radiance[3], distance;
        for (int a = 0; a < 3; a++)
            direction[a] = sqrt(r2) * (cos(angle) * s[a] + sin(angle) * t[a]) + sqrt(1.0 - r2) * normal[a];
        (void)pm__light_seen(sun, point, direction, (double)INFINITY, radiance, &distance);
        sum += radiance[0];
    }
    return pi * sum / DIRECTIONS;
}

/* ---- Arriving and seen ------------------------------------------------------------------------- */

START_TEST(the_whole_sun_is_as_parallel_light)
{
    static const double angles[] = {1e-6, 1e-3, 0.0436, 0.3, 0.6}, tilts[] = {0.0, 0.4, 0.9};
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 3; j++) {
            double point[3], normal[3];
            const pm__light sun = sun_of(angles[i], 2.0);
            place(&sun, 1.5, 0.9, tilts[j], point, normal); /* 1.5 tan(0.6) + 0.9 < 2 */
            const double want = 3.0 * cos(tilts[j]) / (pi * 4.0);
            PM_CHECK_NEAR(received(&sun, point, normal), want, 1e-5 * want);
            if (angles[i] > 0.1)
                PM_CHECK_NEAR(seen(&sun, point, normal), want, 5e-3 * want);
        }
}
END_TEST

START_TEST(a_window_hides_the_rest)
{
    static const double aheads[] = {0.5, 2.0, 3.0};
    for (int i = 0; i < 3; i++) {
        double point[3], normal[3];
        const pm__light sun = sun_of(0.5, 0.8);
        place(&sun, aheads[i], 0.0, 0.0, point, normal);
        const double want = pi * radiance_of(&sun) * pow(sin(fmin(0.5, atan(0.8 / aheads[i]))), 2);
        PM_CHECK_NEAR(received(&sun, point, normal), want, 5e-3 * want);
        PM_CHECK_NEAR(seen(&sun, point, normal), want, 5e-3 * want);
    }
}
END_TEST

START_TEST(the_widest_is_a_lambertian_disc)
{
    static const double places[][2] = {{1, 0}, {1, 0.5}, {1, 1.5}, {0.3, 0.6}, {3, 2}};
    for (int i = 0; i < 5; i++) {
        double point[3], normal[3];
        const double h = places[i][0], x = places[i][1], rr = 0.49;
        const pm__light sun = sun_of(0.5 * pi, 0.7);
        place(&sun, h, x, 0.0, point, normal);
        const double square = h * h + x * x, root = sqrt(pow(square + rr, 2) - 4.0 * rr * x * x);
        const double want = 0.5 * pi * radiance_of(&sun) * (1.0 - (square - rr) / root);
        PM_CHECK_NEAR(received(&sun, point, normal), want, 1e-2 * want);
        PM_CHECK_NEAR(seen(&sun, point, normal), want, 1e-2 * want);
    }
}
END_TEST

/* Where a part is seen there is no formula here: what arrives and what is seen must be the same. */
START_TEST(both_agree_in_half_shadow)
{
    for (int i = 0; i < 6; i++) {
        double point[3], normal[3];
        const pm__light sun = sun_of(0.4, 1.0);
        place(&sun, 1.0 + i % 2, 0.6 + 0.2 * i, 0.3, point, normal);
        const double one = received(&sun, point, normal), other = seen(&sun, point, normal);
        ck_assert_double_gt(one, 0.0);
        PM_CHECK_NEAR(one, other, 1e-2 * other + 1e-3);
    }
}
END_TEST

static bool is_seen(const pm__light *sun, const double origin[3], const double direction[3], double reach)
{
    double radiance[3], distance;
    const bool met = pm__light_seen(sun, origin, direction, reach, radiance, &distance);
    for (int b = 0; b < 3; b++)
        PM_CHECK_NEAR(radiance[b], met ? radiance_of(sun) * sun->power[b] / 3.0 : 0.0, 1e-12 * radiance_of(sun));
    return met;
}

/* Just within and just beyond the cone, the window, the reach; nothing behind the window. */
START_TEST(rims_are_where_they_should_be)
{
    static const double in = 1.0 - 1e-6, out = 1.0 + 1e-6;
    for (double angle = 1.0; angle > 1e-9; angle *= 0.1) {
        const pm__light sun = sun_of(angle, 1.0);
        double point[3], up[3], near[3], far[3], s[3], t[3];
        pm__basis(sun.direction, s, t);
        place(&sun, 0.4, 0.1, 0.0, point, up);
        for (int i = 0; i < 3; i++) {
            near[i] = sin(in * angle) * s[i] - cos(in * angle) * sun.direction[i];
            far[i] = sin(out * angle) * s[i] - cos(out * angle) * sun.direction[i];
        }
        ck_assert_msg(is_seen(&sun, point, near, INFINITY), "angle %g: dark inside", angle);
        ck_assert_msg(!is_seen(&sun, point, far, INFINITY), "angle %g: bright outside", angle);
        ck_assert(is_seen(&sun, point, up, 0.4 * out) && !is_seen(&sun, point, up, 0.4 * in));
        place(&sun, 0.4, in, 0.0, point, up);
        ck_assert(is_seen(&sun, point, up, INFINITY));
        place(&sun, 0.4, out, 0.0, point, up);
        ck_assert(!is_seen(&sun, point, up, INFINITY));
        place(&sun, -0.4, 0.1, 0.0, point, up);
        ck_assert(!is_seen(&sun, point, up, INFINITY) && !is_seen(&sun, point, sun.direction, INFINITY));
        pm__light_sample sample;
        ck_assert(!pm__light_reach(&sun, point, (double[]){0.3, 0.7}, &sample));
    }
}
END_TEST

/* A sample's place lies in the window, its direction toward it within the cone. */
START_TEST(samples_are_sound)
{
    for (uint64_t i = 0; i < 20000; i++) {
        double u[4], point[3], normal[3], off[3], radiance[3], distance;
        pm__light_sample s;
        pm__random_uniform(1, PM__FOR_TESTS, 1, i, u, 4);
        const pm__light sun = sun_of(pow(10.0, -8.0 * u[2]), 1.5);
        place(&sun, 3.0 * u[3] + 0.01, 1.0, 0.0, point, normal);
        if (!pm__light_reach(&sun, point, u, &s))
            continue;
        for (int a = 0; a < 3; a++)
            off[a] = s.position[a] - sun.position[a];
        PM_CHECK_NEAR(pm__dot(s.direction, s.direction), 1.0, 1e-13);
        PM_CHECK_NEAR(pm__dot(off, sun.direction), 0.0, 1e-12);
        ck_assert(pm__dot(off, off) <= 2.25 * (1.0 + 1e-12));
        for (int b = 0; b < 3; b++)
            PM_CHECK_NEAR(s.irradiance[b] / s.irradiance[0], sun.power[b] / 3.0, 1e-12);
        if (u[1] < 1.0 - 1e-6)
            ck_assert(pm__light_seen(&sun, point, s.direction, INFINITY, radiance, &distance));
    }
}
END_TEST

/* ---- Photons ----------------------------------------------------------------------------------- */

static void emit(const pm__light *sun, uint64_t number, double position[3], double direction[3])
{
    double u[4];
    pm__random_uniform(2, PM__FOR_TESTS, 0, number, u, 4);
    pm__emit(sun, u, position, direction);
}

/* The share of photons that meet a disc of radius r, `off` beside the axis, h ahead of the window. */
static double share_that_meets(const pm__light *sun, double h, double off, double r)
{
    double point[3], up[3];
    size_t met = 0;
    place(sun, h, off, 0.0, point, up);
    for (uint64_t i = 0; i < SAMPLES; i++) {
        double at[3], way[3], from[3];
        emit(sun, i, at, way);
        PM_CHECK_NEAR(pm__dot(way, way), 1.0, 1e-14);
        for (int a = 0; a < 3; a++)
            from[a] = at[a] - sun->position[a];
        PM_CHECK_NEAR(pm__dot(from, sun->direction), 0.0, 1e-14 * (1.0 + sun->radius));
        const double length = h / pm__dot(way, sun->direction);
        for (int a = 0; a < 3; a++)
            from[a] = at[a] + length * way[a] - point[a];
        met += pm__dot(from, from) <= r * r;
    }
    return (double)met / SAMPLES;
}

static void check_share(const pm__light *sun, double h, double off, double r, double want)
{
    const double error = sqrt(want * (1.0 - want) / SAMPLES), got = share_that_meets(sun, h, off, r);
    ck_assert_msg(fabs(got - want) <= 6.0 * error, "angle %g, h %g, off %g: %g of the photons, expected %g +- %g",
                  sun->angle, h, off, got, want, error);
}

START_TEST(photons_arrive_by_closed_forms)
{
    static const double angles[] = {1e-7, 0.0436, 0.3};
    for (int i = 0; i < 3; i++) {
        const pm__light sun = sun_of(angles[i], 2.0);
        check_share(&sun, 2.0, 0.0, 1.2, 0.36); /* 2 tan(0.3) + 1.2 < 2 */
        check_share(&sun, 2.0, 0.4, 0.8, 0.16);
    }
    static const double discs[][2] = {{1.0, 1.0}, {0.2, 0.5}, {3.0, 2.0}};
    for (int i = 0; i < 3; i++) {
        const double h = discs[i][0], r = discs[i][1], rr = 0.49, x = 1.0 + (r * r + h * h) / rr;
        const pm__light sun = sun_of(0.5 * pi, 0.7);
        check_share(&sun, h, 0.0, r, 0.5 * (x - sqrt(x * x - 4.0 * r * r / rr)));
    }
}
END_TEST

/* In half shadow photons lie as what arrives tells: its integral over a disc, by rings of equal area. */
START_TEST(photons_arrive_as_light_does)
{
    enum { POINTS = 64 };
    const pm__light sun = sun_of(0.5, 1.0);
    const double h = 1.5, off = 0.9, r = 0.3;
    double sum = 0.0, centre[3], up[3], s[3], t[3];
    pm__basis(sun.direction, s, t);
    place(&sun, h, off, 0.0, centre, up);
    for (int i = 0; i < POINTS; i++) {
        const double own = r * sqrt((i + 0.5) / POINTS), way = 2.399963229728653 * i; /* pi (3 - sqrt 5) */
        double point[3];
        for (int a = 0; a < 3; a++)
            point[a] = centre[a] + own * (cos(way) * s[a] + sin(way) * t[a]);
        sum += received(&sun, point, up) / POINTS;
    }
    const double want = pi * r * r * sum / sun.power[0], got = share_that_meets(&sun, h, off, r);
    ck_assert(want < 0.7 * 0.09); /* less than where the whole sun is seen */
    PM_CHECK_NEAR(got, want, 6.0 * sqrt(want * (1.0 - want) / SAMPLES) + 2e-3 * want);
}
END_TEST

/* ---- In a scene -------------------------------------------------------------------------------- */

/* A floor has E = Phi cos / (pi R^2) by photons and by shadow rays; who looks at the sun sees L, unless a wall is in
 * between; and in a mirror. */
START_TEST(it_lights_a_floor_and_is_seen)
{
    enum { SHOT = 40000 };
    const pm__light sun = {.kind = PM__SUN, .power = {3, 2, 1}, .position = {-0.48 * 5, 0.64, 4},
                           .direction = {0.6, 0, -0.8}, .radius = 2.0, .angle = 0.05};
    const double origin[3] = {0.1, 0.2, 2.0}, away[3] = {-0.6, 0, 0.8}, toward[3] = {-0.6, 0, -0.8};
    pm__scene *const scene = lit_create();
    const pm__material shine = {.kind = PM__MIRROR, .specular = {1, 1, 1}};
    pm_error error;
    const double corner[3] = {-2, -0.5, 0}, u[3] = {1.5, 0, 0}, v[3] = {0, 2, 0};
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 8.0, -1e-3);
    PM_CHECK_OK(pm__scene_rectangle(scene, lit_material(scene, &shine), corner, u, v, &error), error);
    lit_lamp(scene, &sun);
    lit_commit(scene);

    const pm__eye_numbers numbers = pm__eye_numbers_of(1, 0, 0, 0);
    pm__eye eye;
    pm__eye_start(&eye, scene, &numbers, origin, away);
    ck_assert(!pm__eye_follow(&eye));
    for (int b = 0; b < 3; b++)
        PM_CHECK_NEAR(eye.emitted[b], radiance_of(&sun) * sun.power[b] / 3.0, 1e-12);
    pm__eye_start(&eye, scene, &numbers, origin, sun.direction); /* down to the floor, the sun behind */
    ck_assert(pm__eye_follow(&eye));
    PM_CHECK_NEAR(eye.emitted[0], 0.0, 0.0);
    pm__eye_start(&eye, scene, &numbers, (double[]){0.2, 0.6, 1.6}, toward); /* the mirror sends it across the sun */
    ck_assert(!pm__eye_follow(&eye));
    PM_CHECK_NEAR(eye.emitted[0], radiance_of(&sun), 1e-12);

    const pm__shoot_config config = {.scene = scene, .seed = 3, .count = SHOT, .emitted = true};
    pm__photon_set set = lit_shoot(&config);
    size_t near = 0;
    for (size_t i = 0; i < set.count; i++) {
        const double x = (double)set.photons[i].position[0] - 0.6, y = (double)set.photons[i].position[1] - 0.64;
        near += x * x + y * y < 0.64;
        PM_CHECK_NEAR((double)set.photons[i].power[0], 3.0 / SHOT, 1e-6 * 3.0 / SHOT);
    }
    const double share = 0.64 * 0.8 / 4.0;
    PM_CHECK_NEAR((double)near / SHOT, share, 6.0 * sqrt(share * (1.0 - share) / SHOT));
    pm__photon_set_free(&set);
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("sun", the_whole_sun_is_as_parallel_light, a_window_hides_the_rest, the_widest_is_a_lambertian_disc,
             both_agree_in_half_shadow, rims_are_where_they_should_be, samples_are_sound,
             photons_arrive_by_closed_forms, photons_arrive_as_light_does, it_lights_a_floor_and_is_seen)
