/* Every exact shape, met and left by rays in a scene, against its equation solved in long double. */
#include "../../src/scene/flats.h"
#include "../shapes.h"

enum { RAYS = 40000, WAVE_RAYS = 3000 };

/* ---- The oracle: each shape's equation in long double --------------------------------------------- */

typedef struct answer {
    bool met, unsure;     /* unsure: grazing or at a rim, where rounding may decide */
    long double distance;
    long double condition; /* how far the distance moves when the shape does */
} answer;

/* The shape's equation at a point (0 on it, m about it), and how far within its rim the point is. */
static long double equation(const pm__shape *s, const long double p[3], long double *within)
{
    long double q[3], value = 0.0L;
    for (int a = 0; a < 3; a++)
        q[a] = p[a] - (long double)s->centre[a];
    *within = 1.0L;
    if (s->kind == PM__SHAPE_SPHERE)
        return sqrtl(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) - (long double)s->radius;
    if (s->kind == PM__SHAPE_CYLINDER) {
        *within = fminl(fminl(p[2] - (long double)s->low, (long double)s->high - p[2]),
                        s->from > -1.0 ? q[0] - (long double)(s->from * s->radius) : 1.0L);
        return sqrtl(q[0] * q[0] + q[1] * q[1]) - (long double)s->radius;
    }
    if (s->kind == PM__SHAPE_WAVE) {
        *within = fminl((long double)s->extent[0] - fabsl(p[0]), (long double)s->extent[1] - fabsl(p[1]));
        return q[2] - (long double)s->amplitude * cosl((long double)s->wavenumber * p[0]);
    }
    for (int a = 0; a < 3; a++)
        value += q[a] * (long double)s->normal[a];
    if (s->kind == PM__SHAPE_DISC) {
        *within = (long double)s->radius - sqrtl(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
        return value;
    }
    /* The tests' rectangles have edges at right angles. */
    for (int i = 0; i < 2; i++) {
        long double along = 0.0L, length = 0.0L;
        for (int a = 0; a < 3; a++) {
            along += q[a] * (long double)s->edge[i][a];
            length += (long double)(s->edge[i][a] * s->edge[i][a]);
        }
        *within = fminl(*within, fminl(along / length, 1.0L - along / length));
    }
    return value;
}

static long double at(const pm__shape *s, const double o[3], const double d[3], long double t, long double *within)
{
    long double p[3];
    for (int a = 0; a < 3; a++)
        p[a] = (long double)o[a] + t * (long double)d[a];
    return equation(s, p, within);
}

/* The first change of sign on the ray in small steps, by bisection. Steps in which the value comes so near to 0 that
 * it might touch or cross twice make the answer unsure. `after`: roots up to there are the origin itself. */
static answer brute(const pm__shape *s, const double o[3], const double d[3], long double after, double reach,
                    int steps)
{
    const long double step = (long double)reach / steps;
    long double within, before = at(s, o, d, after, &within);
    for (int i = 0; i < steps; i++) {
        long double low = i ? i * step : after, high = (i + 1) * step;
        if (high <= after)
            continue;
        low = fmaxl(low, after);
        const long double value = at(s, o, d, high, &within);
        if ((before < 0.0L) == (value < 0.0L)) {
            /* The second derivative of each wave is below 10/m, of the round shapes 2/m; an eighth matters. */
            const long double bend = s->kind == PM__SHAPE_WAVE ? 2.0L : 0.5L;
            if (fminl(fabsl(before), fabsl(value)) < bend * step * step && s->kind != PM__SHAPE_RECTANGLE &&
                s->kind != PM__SHAPE_DISC && low > after)
                return (answer){.unsure = true};
            before = value;
            continue;
        }
        for (int k = 0; k < 80; k++) {
            const long double middle = 0.5L * (low + high);
            *((at(s, o, d, middle, &within) < 0.0L) == (before < 0.0L) ? &low : &high) = middle;
        }
        (void)at(s, o, d, low, &within);
        before = value;
        if (fabsl(within) < 1e-9L)
            return (answer){.unsure = true};
        if (within < 0.0L)
            continue;
        long double other;
        const long double slope = (at(s, o, d, low + 1e-6L, &other) - at(s, o, d, low - 1e-6L, &other)) / 2e-6L;
        return (answer){.met = true, .distance = low, .condition = 1.0L / fabsl(slope)};
    }
    return (answer){.met = false};
}

static void check_answer(const char *what, uint64_t i, const answer *want, bool met, const pm__hit *hit)
{
    ck_assert_msg(met == want->met, "%s, ray %llu: met %d, expected %d at %.17Lg", what, (unsigned long long)i, met,
                  want->met, want->distance);
    if (met)
        ck_assert_msg(fabsl((long double)hit->distance - want->distance) <= 2e-14L * (1.0L + want->condition),
                      "%s, ray %llu: %.17g, expected %.17Lg (condition %Lg)", what, (unsigned long long)i,
                      hit->distance, want->distance, want->condition);
}

/* Rays from anywhere, and from where each of them hits, in the mirrored direction and in a random one. */
static void check_shape(const char *what, pm__shape *shape, int rays, int steps)
{
    pm__scene *const scene = scene_of(shape, 1);
    int met_count = 0, unsure = 0, left_count = 0;
    for (int i = 0; i < rays; i++) {
        double o[3], d[3], unused[3], onward[3];
        pm__hit hit, next;
        random_ray(1, (uint64_t)i, 2.0, o, d);
        const answer want = brute(shape, o, d, 0.0L, 6.0, steps);
        if (want.unsure) {
            unsure++;
            continue;
        }
        const bool met = pm__scene_intersect(scene, o, d, 6.0, PM__NO_SHAPE, &hit);
        check_answer(what, (uint64_t)i, &want, met, &hit);
        if (!met)
            continue;
        met_count++;
        long double p[3], within;
        for (int a = 0; a < 3; a++)
            p[a] = (long double)hit.position[a];
        ck_assert(fabsl(equation(shape, p, &within)) < 1e-15L);
        PM_CHECK_NEAR(pm__dot(hit.normal, hit.normal), 1.0, 1e-14);
        random_ray(2, (uint64_t)i, 1.0, unused, onward);
        const answer farther = brute(shape, hit.position, onward, 1e-9L, 6.0, steps);
        const bool left = pm__scene_intersect(scene, hit.position, onward, 6.0, hit.shape, &next);
        if (farther.unsure || (left && next.distance < 1e-6))
            unsure++;
        else
            check_answer(what, (uint64_t)i, &farther, left, &next);
        left_count += left;
    }
    ck_assert_msg(met_count > rays / 50 && unsure < rays / 4, "%s: %d met, %d unsure", what, met_count, unsure);
    ck_assert_msg((left_count > 0) == (shape->kind != PM__SHAPE_RECTANGLE && shape->kind != PM__SHAPE_DISC),
                  "%s: met again %d times", what, left_count);
    pm__scene_destroy(scene);
}

START_TEST(test_round_shapes)
{
    pm__shape shapes[] = {sphere(0.2, -0.1, 0.3, 1.1), cylinder(0.1, 0.2, 0.9, -1.0, 0.8, -1.0),
                          cylinder(0.1, 0.2, 0.9, -1.0, 0.8, 0.0), cylinder(0.1, 0.2, 0.9, -1.0, 0.8, 0.5)};
    check_shape("sphere", &shapes[0], RAYS, 60);
    check_shape("cylinder", &shapes[1], RAYS, 60);
    check_shape("half cylinder", &shapes[2], RAYS, 60);
    check_shape("part of a cylinder", &shapes[3], RAYS, 60);
}
END_TEST

START_TEST(test_flat_shapes)
{
    pm__shape rectangle = {.kind = PM__SHAPE_RECTANGLE,
                           .centre = {-1.0, -0.7, 0.2},
                           .edge = {{1.5, 0.5, 0.3}, {-0.4, 1.2, 0.0}}};
    pm__shape disc = {.kind = PM__SHAPE_DISC, .centre = {0.1, 0.2, -0.3}, .normal = {0.48, 0.6, 0.64}, .radius = 0.9};
    check_shape("rectangle", &rectangle, RAYS, 4);
    check_shape("disc", &disc, RAYS, 4);
}
END_TEST

START_TEST(test_wave)
{
    pm__shape steep = wave(0.12, 8.0), mirrored = wave(-0.3, 3.0), gentle = wave(0.01, 20.0);
    check_shape("steep wave", &steep, WAVE_RAYS, 1500);
    check_shape("wave of negative amplitude", &mirrored, WAVE_RAYS, 1500);
    check_shape("gentle wave", &gentle, WAVE_RAYS, 1500);
}
END_TEST

/* Rays along the wave, the worst for roots: each crosses next to a crest or not at all. */
START_TEST(test_wave_grazing)
{
    pm__shape shape = wave(0.1, 9.0);
    pm__scene *const scene = scene_of(&shape, 1);
    int met_count = 0, compared = 0;
    for (int i = 0; i < WAVE_RAYS; i++) {
        double u[3];
        pm__hit hit;
        pm__random_uniform(7, PM__FOR_TESTS, 3, (uint64_t)i, u, 3);
        const double o[3] = {2.0, 0.0, 0.2 + 0.02 * (u[0] - 0.5)};
        double d[3] = {-1.0, 0.1 * (u[1] - 0.5), 0.02 * (u[2] - 0.5)};
        (void)pm__normalize(d);
        const answer want = brute(&shape, o, d, 0.0L, 4.0, 4000);
        const bool met = pm__scene_intersect(scene, o, d, 4.0, PM__NO_SHAPE, &hit);
        if (!want.unsure)
            check_answer("grazing the wave", (uint64_t)i, &want, met, &hit);
        met_count += met;
        compared += !want.unsure;
    }
    ck_assert_int_gt(met_count, WAVE_RAYS / 5);
    ck_assert_int_gt(compared, WAVE_RAYS / 3);
    pm__scene_destroy(scene);
}
END_TEST

/* A sphere left from its own surface: the chord is -2 d.n r, into it or not at all, also at grazing angles. */
START_TEST(test_sphere_chords)
{
    pm__shape shape = sphere(100.0, -50.0, 30.0, 2.0);
    pm__scene *const scene = scene_of(&shape, 1);
    for (int i = 0; i < RAYS; i++) {
        double unused[3], n[3], d[3], p[3], u[1];
        pm__hit hit;
        random_ray(4, (uint64_t)i, 1.0, unused, n);
        random_ray(5, (uint64_t)i, 1.0, unused, d);
        pm__random_uniform(7, PM__FOR_TESTS, 6, (uint64_t)i, u, 1);
        const double tilt = pm__dot(n, d), wanted = (i % 2 ? 1.0 : -1.0) * pow(10.0, -20.0 * u[0]);
        for (int a = 0; a < 3; a++) {
            p[a] = shape.centre[a] + 2.0 * n[a];
            d[a] += (wanted - tilt) * n[a];
        }
        (void)pm__normalize(d);
        const bool met = pm__scene_intersect(scene, p, d, INFINITY, 0, &hit);
        if (fabs(wanted) > 1e-11) /* else along the surface, to rounding */
            ck_assert_msg(met == (wanted < 0.0), "ray %d at %g to the surface: met %d", i, wanted, met);
        if (met) {
            PM_CHECK_NEAR(hit.distance, -4.0 * pm__dot(n, d), 2e-13);
            ck_assert_double_gt(hit.distance, 1e-13); /* not the origin itself */
        }
    }
    pm__scene_destroy(scene);
}
END_TEST

/* Many flat shapes at once: the digits of each by itself, two and four at a time. */
START_TEST(test_flats)
{
    for (size_t count = 1; count <= PM__MOST_FLATS; count += count < 5 ? 1 : 5) {
        pm__shape shapes[PM__MOST_FLATS];
        pm__flats flats = {.count = 0};
        int met_count = 0, disc_count = 0;
        for (size_t i = 0; i < count; i++) {
            double c[3], n[3], t[3], s[3];
            pm_error error;
            random_ray(50, i, 1.0, c, n);
            pm__basis(n, s, t);
            shapes[i] = (pm__shape){.kind = i % 3 ? PM__SHAPE_RECTANGLE : PM__SHAPE_DISC, .radius = 0.5};
            for (int a = 0; a < 3; a++) {
                shapes[i].centre[a] = c[a];
                shapes[i].normal[a] = i % 3 ? 0.0 : n[a];
                shapes[i].edge[0][a] = s[a];
                shapes[i].edge[1][a] = 0.7 * t[a] + 0.2 * s[a];
            }
            PM_CHECK_OK(pm__shape_prepare(&shapes[i], (uint32_t)i, &error), error);
            pm__flats_add(&flats, &shapes[i], 10 + 2 * (uint32_t)i);
        }
        const bool wide = flats.wide;
        for (int i = 0; i < RAYS; i++) {
            pm__ray ray = {.reach = i % 2 ? (double)INFINITY : 1.0};
            random_ray(51, (uint64_t)i, 2.0, ray.origin, ray.direction);
            if (i % 100 == 0) /* along an axis */
                for (int a = 0; a < 3; a++)
                    ray.direction[a] = a == i / 100 % 3;
            const uint32_t from = 10 + (uint32_t)i % 50, to = 10 + (uint32_t)i % 7;
            double want = INFINITY, got[2] = {0.0, 0.0}, t;
            size_t first = count;
            for (size_t j = 0; j < count; j++)
                if (10 + 2 * j != from && 10 + 2 * j != to && pm__shape_meet(&shapes[j], &ray, &t) && t < want) {
                    want = t;
                    first = j;
                }
            for (int k = 0; k < 2; k++) {
                flats.wide = wide && k;
                ck_assert_uint_eq(pm__flats_meet(&flats, &ray, from, to, &got[k]), first);
            }
            ck_assert_msg(first == count || (got[0] == want && got[1] == want), "ray %d: %.17g %.17g, %.17g alone", i,
                          got[0], got[1], want);
            met_count += first < count;
            disc_count += first < count && first % 3 == 0;
        }
        ck_assert(met_count > RAYS / 200 && disc_count > RAYS / 2000);
    }
}
END_TEST

/* Two in the same place, in different lanes: the lower number. */
START_TEST(test_equal_flats)
{
    const double up[3] = {0.0, 0.0, 1.0};
    for (size_t a = 0; a < 9; a++)
        for (size_t b = a + 1; b < 10; b++) {
            pm__flats flats = {.count = 0};
            for (size_t i = 0; i < 10; i++) {
                pm_error error;
                pm__shape disc = {.kind = PM__SHAPE_DISC, .radius = 1.0, .normal = {0.0, 0.0, 1.0}};
                disc.centre[2] = i == a || i == b ? 1.0 : 2.0 + (double)i;
                PM_CHECK_OK(pm__shape_prepare(&disc, 0, &error), error);
                pm__flats_add(&flats, &disc, (uint32_t)i);
            }
            pm__ray ray = {.reach = 5.0};
            memcpy(ray.direction, up, sizeof up);
            double distance;
            ck_assert_uint_eq(pm__flats_meet(&flats, &ray, PM__NO_SHAPE, PM__NO_SHAPE, &distance), a);
            ck_assert_uint_eq(pm__flats_meet(&flats, &ray, (uint32_t)a, PM__NO_SHAPE, &distance), b);
        }
}
END_TEST

PM_TEST_MAIN("shapes", test_round_shapes, test_flat_shapes, test_wave, test_wave_grazing, test_sphere_chords,
             test_flats, test_equal_flats)
