/* Path differentials against paths traced again in long double.
 *
 * A path that the scene has answered is traced anew from a place in the image moved by +-h: the same surfaces, the same
 * choices of reflection and refraction, each hit found by Newton's method from where the first path had it. Central
 * differences with h = 1e-6 pixels are off by h^2 times the third derivative, below 1e-9 of the vectors here, and by
 * 2^-64 / h = 5e-14 of the lengths. What is compared with them is made in double of hits that are known to 1e-15 m over
 * cosines of 0.05 and more: 1e-7 of a vector is far beyond both, and far below what any wrong term would make. */
#include "../../src/base/vec3.h"
#include "../../src/scene/rough.h"
#include "../../src/transport/eye.h"
#include "../../src/transport/footprint.h"
#include "../lit.h"

#include <string.h>

enum { PATHS = 400, MOST = 64 };

typedef long double real;

/* ---- Surfaces in long double ------------------------------------------------------------------- */

typedef enum kind { BALL, TUBE, WAVES, PLANE } kind;

/* About the origin; in the scene p = scale R q + offset. */
typedef struct body {
    kind kind;
    pm__material_kind material;
    real size; /* radius */
    pm__placement place;
} body;

static const double amplitude = 0.1, wavenumber = 3.0, ior = 1.5, room = 10.0;
static const double tilt[3] = {0.6, 0.0, 0.8};

static real dot(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void unit(real v[3])
{
    const real length = sqrtl(dot(v, v));
    for (int i = 0; i < 3; i++)
        v[i] /= length;
}

/* How far off the surface, and the gradient of that. */
static real off(const body *b, const real p[3], real gradient[3])
{
    real q[3], g[3] = {0, 0, 1}, value = 0;
    for (int i = 0; i < 3; i++) {
        q[i] = 0;
        for (int j = 0; j < 3; j++)
            q[i] += (real)b->place.rotation[j][i] * (p[j] - (real)b->place.offset[j]) / (real)b->place.scale;
    }
    switch (b->kind) {
    case BALL:
    case TUBE:
        g[2] = b->kind == BALL ? q[2] : 0;
        g[0] = q[0];
        g[1] = q[1];
        value = (dot(g, g) - b->size * b->size) / 2;
        break;
    case WAVES:
        value = q[2] - (real)amplitude * cosl((real)wavenumber * q[0]);
        g[0] = (real)(amplitude * wavenumber) * sinl((real)wavenumber * q[0]);
        g[1] = 0;
        break;
    case PLANE:
        for (int i = 0; i < 3; i++)
            g[i] = (real)tilt[i];
        value = dot(q, g);
        break;
    }
    for (int i = 0; i < 3; i++)
        gradient[i] = ((real)b->place.rotation[i][0] * g[0] + (real)b->place.rotation[i][1] * g[1] +
                       (real)b->place.rotation[i][2] * g[2]) / (real)b->place.scale;
    return value;
}

/* ---- Paths traced again ------------------------------------------------------------------------ */

typedef struct leg {
    real distance;
    bool outer, through, front; /* on the room's wall; what became of it; met from the normal's side */
} leg;

typedef struct route {
    leg legs[MOST];
    int count;
    /* The first place on the wall, its normal, and the way on from there: legs before `bounce` lead to it. */
    int bounce; /* -1: none */
    real facing[3], out[3], facet[3], in[3];
    bool by_facet;
} route;

static const body wall = {BALL, PM__DIFFUSE, 10.0L, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0, {0, 0, 0}}};

static void advance(const body *b, real distance, real p[3], const real d[3], real normal[3])
{
    real at[3];
    for (int i = 0; i < 3; i++)
        at[i] = p[i] + distance * d[i];
    for (int pass = 0; pass < 30; pass++) {
        const real step = off(b, at, normal) / dot(normal, d);
        for (int i = 0; i < 3; i++)
            at[i] -= step * d[i];
    }
    (void)off(b, at, normal);
    unit(normal);
    memcpy(p, at, sizeof at);
}

static void go_on(const leg *l, const real normal[3], real d[3])
{
    const real sign = l->front ? 1 : -1, eta = l->front ? (real)ior : 1 / (real)ior, c = -sign * dot(normal, d);
    const real f = sqrtl(1 - (1 - c * c) / (eta * eta));
    for (int i = 0; i < 3; i++)
        d[i] = l->through ? d[i] / eta + (c / eta - f) * sign * normal[i] : d[i] + 2 * c * sign * normal[i];
    unit(d);
}

/* The turn that takes `from` to `to` the shortest way, of v (Rodrigues). */
static void turned(const real from[3], const real to[3], const real v[3], real made[3])
{
    const real axis[3] = {from[1] * to[2] - from[2] * to[1], from[2] * to[0] - from[0] * to[2],
                          from[0] * to[1] - from[1] * to[0]};
    const real cosine = dot(from, to), along = dot(axis, v) / (1 + cosine);
    const real across[3] = {axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2],
                            axis[0] * v[1] - axis[1] * v[0]};
    for (int i = 0; i < 3; i++)
        made[i] = cosine * v[i] + across[i] + along * axis[i];
}

static void leave(const route *r, const real normal[3], real d[3])
{
    real side[3], facet[3];
    for (int i = 0; i < 3; i++)
        side[i] = dot(normal, r->facing) > 0 ? normal[i] : -normal[i];
    if (!r->by_facet) {
        turned(r->facing, side, r->out, d);
        return;
    }
    turned(r->facing, side, r->facet, facet);
    const real twice = 2 * dot(facet, d);
    for (int i = 0; i < 3; i++)
        d[i] -= twice * facet[i];
}

static void trace_again(const pm__camera *camera, const body *b, const route *r, real x, real y, real p[3])
{
    real d[3], normal[3];
    for (int i = 0; i < 3; i++) {
        p[i] = (real)camera->eye[i];
        d[i] = (real)camera->corner[i] + x * (real)camera->right[i] + y * (real)camera->down[i];
    }
    unit(d);
    for (int n = 0; n < r->count; n++) {
        advance(r->legs[n].outer ? &wall : b, r->legs[n].distance, p, d, normal);
        if (n == r->bounce)
            leave(r, normal, d);
        else if (n + 1 < r->count)
            go_on(&r->legs[n], normal, d);
    }
}

/* ---- Scenes ------------------------------------------------------------------------------------ */

static void add_body(pm__scene *scene, const body *b, uint32_t material)
{
    static const double middle[3] = {0, 0, 0}, extent[2] = {2.0, 2.0};
    static const double corner[3] = {-1.6, -2.0, 1.2}, u[3] = {3.2, 0.0, -2.4}, v[3] = {0.0, 4.0, 0.0};
    pm_error error;
    switch (b->kind) {
    case BALL:
        PM_CHECK_OK(pm__scene_sphere(scene, material, middle, (double)b->size, false, &error), error);
        break;
    case TUBE:
        PM_CHECK_OK(pm__scene_cylinder(scene, material, middle, (double)b->size, -1.0, 1.0, -1.0, false, &error),
                    error);
        break;
    case WAVES:
        PM_CHECK_OK(pm__scene_wave(scene, material, 0.0, amplitude, wavenumber, extent, &error), error);
        break;
    case PLANE:
        PM_CHECK_OK(pm__scene_rectangle(scene, material, corner, u, v, &error), error);
        break;
    }
}

static bool is_placed(const body *b)
{
    return b->place.scale != 1.0;
}

/* The body is shape 0, the room's wall shape 1: inward, rough, and of `gloss` if that is not 0. */
static pm__scene *make_scene(const body *b, double gloss)
{
    const pm__material smooth = {.kind = b->material, .ior = {ior, ior, ior}, .specular = {1, 1, 1}};
    const pm__material rough = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    const pm__material glossy = {.kind = PM__GLOSSY, .specular = {1, 1, 1}, .roughness = gloss};
    const pm__light lamp = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0, 0, 5}};
    pm_error error;
    pm__scene *const scene = lit_create(), *part = scene;
    if (is_placed(b))
        PM_CHECK_OK(pm__scene_part(scene, &part, &error), error);
    add_body(part, b, lit_material(part, &smooth));
    if (is_placed(b))
        PM_CHECK_OK(pm__scene_place(scene, part, &b->place, &error), error);
    lit_sphere(scene, lit_material(scene, gloss > 0.0 ? &glossy : &rough), 0, 0, 0, room, true);
    lit_lamp(scene, &lamp);
    return lit_commit(scene);
}

static pm__camera make_camera(void)
{
    const pm__view view = {.eye = {0.4, -4.1, 2.2}, .at = {0.1, 0.05, 0.0}, .up = {0, 0, 1}, .angle = 0.5};
    pm__camera camera;
    pm_error error;
    PM_CHECK_OK(pm__camera_init(&view, 40, 40, &camera, &error), error);
    return camera;
}

/* ---- Following --------------------------------------------------------------------------------- */

typedef struct traced {
    const pm__camera *camera;
    const body *body;
    pm__eye eye;
    pm__footprint footprint;
    route route;
    double x, y, steepest; /* the least cosine to a surface */
} traced;

static bool follow(traced *t)
{
    for (;;) {
        const double in[3] = {t->eye.direction[0], t->eye.direction[1], t->eye.direction[2]};
        const pm__eye_met met = pm__eye_step(&t->eye);
        const pm__hit *const hit = &t->eye.hit;
        if (met == PM__EYE_ENDS || t->route.count == MOST)
            return false;
        const double cosine = pm__dot(in, hit->normal), on = pm__dot(t->eye.direction, hit->normal);
        t->route.legs[t->route.count++] =
            (leg){(real)hit->distance, hit->shape == 1, cosine * on > 0.0 && met == PM__EYE_PASSES, cosine < 0.0};
        t->steepest = fmin(t->steepest, fmin(fabs(cosine), fabs(on)));
        pm__footprint_arrive(&t->footprint, in, hit);
        if (met == PM__EYE_STANDS)
            return true;
        pm__footprint_pass(&t->footprint, t->eye.scene, hit, in, t->eye.direction, ior);
    }
}

static bool bounce(traced *t)
{
    const pm__eye before = t->eye;
    if (!pm__eye_bounce(&t->eye))
        return false;
    t->route.bounce = t->route.count - 1;
    for (int i = 0; i < 3; i++) {
        t->route.facing[i] = (real)before.facing[i];
        t->route.out[i] = (real)t->eye.direction[i];
        t->route.in[i] = (real)before.direction[i];
        t->route.facet[i] = t->route.out[i] - t->route.in[i];
    }
    unit(t->route.facet);
    t->route.by_facet = before.hit.material->kind == PM__GLOSSY;
    pm__footprint_bounce(&t->footprint, t->eye.scene, &before.hit, before.direction, t->eye.direction, before.weight);
    return true;
}

static bool begin(traced *t, const pm__scene *scene, const pm__camera *camera, const body *b, uint64_t path)
{
    const pm__eye_numbers numbers = pm__eye_numbers_of(9, 0, 0, path);
    double u[2];
    pm__random_uniform(9, PM__FOR_TESTS, 0, path, u, 2);
    *t = (traced){.camera = camera, .body = b, .x = 40.0 * u[0], .y = 40.0 * u[1], .steepest = 1.0};
    t->route.bounce = -1;
    pm__eye_through(&t->eye, scene, camera, &numbers, t->x, t->y);
    pm__footprint_begin(&t->footprint, camera, t->x, t->y);
    return follow(t);
}

static void compare(const traced *t)
{
    const real h = 1e-6L;
    for (int n = 0; n < 2; n++) {
        real low[3], high[3];
        double worst = 0.0, length = 0.0;
        const real dx = n == 0 ? h : 0, dy = n == 1 ? h : 0;
        trace_again(t->camera, t->body, &t->route, (real)t->x - dx, (real)t->y - dy, low);
        trace_again(t->camera, t->body, &t->route, (real)t->x + dx, (real)t->y + dy, high);
        for (int i = 0; i < 3; i++) {
            const double want = (double)((high[i] - low[i]) / (2 * h));
            worst = fmax(worst, fabs(want - t->footprint.place[n][i]));
            length = fmax(length, fabs(want));
        }
        ck_assert_msg(worst <= 1e-7 * length, "vector %d of %d legs is off by %g of %g", n, t->route.count, worst,
                      length);
    }
}

/* ---- Tests ------------------------------------------------------------------------------------- */

/* Where they stand. */
#define HERE {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0, {0, 0, 0}}
#define TURNED {{{0.6, 0.0, 0.8}, {0.0, 1.0, 0.0}, {-0.8, 0.0, 0.6}}, 1.25, {0.2, -0.1, 0.3}}

static const body bodies[] = {{BALL, PM__GLASS, 1.0L, HERE},   {BALL, PM__MIRROR, 1.0L, HERE},
                              {TUBE, PM__GLASS, 0.8L, HERE},   {TUBE, PM__MIRROR, 0.8L, TURNED},
                              {WAVES, PM__GLASS, 0.0L, HERE},  {WAVES, PM__GLASS, 0.0L, TURNED},
                              {WAVES, PM__MIRROR, 0.0L, HERE}, {BALL, PM__GLASS, 1.0L, TURNED},
                              {PLANE, PM__MIRROR, 0.0L, HERE}, {PLANE, PM__GLASS, 0.0L, HERE}};

START_TEST(mirrors_and_glass_of_every_shape)
{
    const pm__camera camera = make_camera();
    pm__scene *const scene = make_scene(&bodies[_i], 0.0);
    int checked = 0, bent = 0;
    for (uint64_t path = 0; path < PATHS; path++) {
        traced t;
        if (!begin(&t, scene, &camera, &bodies[_i], path) || t.steepest < 0.05)
            continue;
        compare(&t);
        checked++;
        bent += t.route.count > 1;
    }
    ck_assert_msg(bent >= PATHS / 10 && checked > bent / 2, "%d of %d paths compared, %d by way of the body", checked,
                  PATHS, bent);
    pm__scene_destroy(scene);
}
END_TEST

/* Off the wall, whose normal turns as the vertex moves, and on by way of the body or not: of a diffuse wall the way
 * turns with it, of a glossy one the facet does, which mirrors. */
START_TEST(rough_bounces_off_a_curved_wall)
{
    const pm__camera camera = make_camera();
    const body *const b = &bodies[_i / 2];
    pm__scene *const scene = make_scene(b, _i % 2 ? 0.2 : 0.0);
    int checked = 0;
    for (uint64_t path = 0; path < PATHS; path++) {
        traced t;
        if (!begin(&t, scene, &camera, b, path) || !bounce(&t) || !follow(&t) || t.steepest < 0.05)
            continue;
        ck_assert_int_eq(t.footprint.count, 4);
        compare(&t);
        checked++;
    }
    ck_assert_int_gt(checked, PATHS / 4);
    pm__scene_destroy(scene);
}
END_TEST

static void sample(const pm__material *material, const double normal[3], const double in[3], double u0, double u1,
                   double out[3])
{
    double facet[3];
    const double from[3] = {-in[0], -in[1], -in[2]};
    if (material->kind == PM__DIFFUSE) {
        pm__cosine_direction(normal, u0, u1, out);
        return;
    }
    pm__sample_facet(normal, from, pm__alpha(material), u0, u1, facet);
    const double twice = 2.0 * pm__dot(facet, in);
    for (int i = 0; i < 3; i++)
        out[i] = in[i] - twice * facet[i];
}

/* The two new vectors span the solid angle that the sampled direction moves over with its two numbers: by central
 * differences, h = 1e-5, so to about h^2 over the distance from the ends squared, and 2^-52 / h = 2e-11. */
START_TEST(two_numbers_move_a_direction_over_one_over_its_density)
{
    const pm__material materials[] = {{.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}},
                                      {.kind = PM__GLOSSY, .specular = {1, 1, 1}, .roughness = 0.3},
                                      {.kind = PM__GLOSSY, .specular = {1, 1, 1}, .roughness = 0.01}};
    const pm__material *const material = &materials[_i];
    pm__scene *const scene = lit_create();
    const pm__light lamp = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0, 0, 5}};
    lit_floor(scene, lit_material(scene, material), 10.0, 0.0);
    lit_lamp(scene, &lamp);
    lit_commit(scene);
    double in[3] = {0.5, 0.1, -1.0};
    (void)pm__normalize(in);
    const double from[3] = {0, 0, 1}, weight[3] = {1, 1, 1}, h = 1e-5;
    pm__hit hit;
    ck_assert(pm__scene_intersect(scene, from, in, INFINITY, PM__NO_SHAPE, &hit));
    for (uint64_t i = 0; i < 200; i++) {
        double u[2], out[3], d[2][3], across[3], want[3];
        pm__random_uniform(4, PM__FOR_TESTS, 0, i, u, 2);
        for (int n = 0; n < 2; n++)
            u[n] = 0.05 + 0.9 * u[n];
        for (int n = 0; n < 2; n++) {
            double low[3], high[3];
            const double dx = n == 0 ? h : 0.0, dy = n == 1 ? h : 0.0;
            sample(material, hit.normal, in, u[0] - dx, u[1] - dy, low);
            sample(material, hit.normal, in, u[0] + dx, u[1] + dy, high);
            for (int a = 0; a < 3; a++)
                d[n][a] = (high[a] - low[a]) / (2.0 * h);
        }
        sample(material, hit.normal, in, u[0], u[1], out);
        if (!(pm__dot(out, hit.normal) > 0.0))
            continue;
        pm__cross(d[0], d[1], want);
        pm__footprint footprint = {.count = 0};
        pm__footprint_bounce(&footprint, scene, &hit, in, out, weight);
        ck_assert_int_eq(footprint.count, 2);
        pm__cross(footprint.way[0], footprint.way[1], across);
        const double area = sqrt(pm__dot(want, want));
        PM_CHECK_NEAR(sqrt(pm__dot(across, across)), area, 1e-6 * area);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* After more bounces four vectors stand for the eight that there would be: the sum of v v^T stays, and so does the area
 * wherever the path goes next. Here on a sphere's inside, where the old ones turn with the normal by place / R. */
START_TEST(four_vectors_stand_for_more)
{
    pm__scene *const scene = make_scene(&bodies[0], 0.0);
    const double weight[3] = {1, 1, 1}, from[3] = {0, 0, 2.0};
    double in[3] = {0.3, 0.2, 0.9}, out[3] = {-0.7, 0.1, -0.7};
    (void)pm__normalize(in);
    (void)pm__normalize(out);
    pm__hit hit, next;
    ck_assert(pm__scene_intersect(scene, from, in, INFINITY, PM__NO_SHAPE, &hit));
    pm__footprint f = {.count = PM__FOOTPRINT_NUMBERS};
    double places[PM__FOOTPRINT_NUMBERS + 2][3] = {{0.0}};
    double ways[PM__FOOTPRINT_NUMBERS + 2][3] = {{0.0}};
    for (int n = 0; n < f.count; n++) {
        double omega[3], turn[3];
        pm__random_uniform(5, PM__FOR_TESTS, 1, (uint64_t)n, f.place[n], 3);
        pm__random_uniform(5, PM__FOR_TESTS, 2, (uint64_t)n, f.way[n], 3);
        const double along = pm__dot(f.place[n], hit.normal);
        for (int i = 0; i < 3; i++) {
            f.place[n][i] -= along * hit.normal[i];
            places[n][i] = f.place[n][i];
            turn[i] = -places[n][i] / room; /* the normal points inward */
        }
        pm__cross(hit.normal, turn, omega);
        pm__cross(omega, out, ways[n]);
    }
    pm__footprint_bounce(&f, scene, &hit, in, out, weight);
    ck_assert_int_eq(f.count, 6);
    for (int n = 0; n < 2; n++)
        memcpy(ways[PM__FOOTPRINT_NUMBERS + n], f.way[4 + n], sizeof *ways);
    ck_assert(pm__scene_intersect(scene, hit.position, out, INFINITY, hit.shape, &next));
    pm__footprint_arrive(&f, out, &next);
    double sum = 0.0;
    for (int n = 0; n < 8; n++) {
        for (int i = 0; i < 3; i++)
            places[n][i] += next.distance * ways[n][i];
        const double back = pm__dot(places[n], next.normal) / pm__dot(out, next.normal);
        for (int i = 0; i < 3; i++)
            places[n][i] -= back * out[i];
        for (int m = 0; m < n; m++) {
            double across[3];
            pm__cross(places[n], places[m], across);
            sum += pm__dot(across, across);
        }
    }
    PM_CHECK_NEAR(pm__footprint_area(&f), sqrt(sum), 1e-9 * sqrt(sum));
    pm__scene_destroy(scene);
}
END_TEST

int main(void)
{
    enum { BODIES = sizeof bodies / sizeof *bodies };
    Suite *const suite = suite_create("footprint");
    TCase *const tcase = tcase_create("footprint");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, mirrors_and_glass_of_every_shape, 0, BODIES);
    tcase_add_loop_test(tcase, rough_bounces_off_a_curved_wall, 0, 2 * BODIES);
    tcase_add_loop_test(tcase, two_numbers_move_a_direction_over_one_over_its_density, 0, 3);
    tcase_add_test(tcase, four_vectors_stand_for_more);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
