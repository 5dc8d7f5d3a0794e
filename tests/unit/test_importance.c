/* Importance against what can be worked out by hand.
 *
 * A pinhole camera sees a point in pm__camera_project's pixels to the steradian: at the distance d, on a surface tilted
 * by the cosine c, that many times c / d^2 to the square metre, which is one over the footprint of a pixel: exactly so,
 * but for its change across the pixel, which derivatives leave out. Through a plane mirror the same of the camera's
 * mirror image. Importons know it by their path differentials to rounding: positions in float are off by 2^-24 of some
 * metres, and so is the density, to a few times that. */
#include "../importance.h"

enum { PATHS = 20000 };

static double floor_density(void)
{
    const double pixel = 2.0 * above * tan(0.5 * angle) / SIDE;
    return 1.0 / (pixel * pixel);
}

static double seen_density(const pm__camera *camera, const float position[3], const double normal[3])
{
    double at[2], pixels, off[3];
    const double point[3] = {(double)position[0], (double)position[1], (double)position[2]};
    ck_assert(pm__camera_project(camera, point, at, &pixels));
    for (int i = 0; i < 3; i++)
        off[i] = point[i] - camera->eye[i];
    const double d2 = pm__dot(off, off);
    return pixels * fabs(pm__dot(off, normal)) / (d2 * sqrt(d2));
}

/* ---- The footprints of importons --------------------------------------------------------------- */

static void check_seen(const pm__importons *set, const pm__camera *camera, const double normal[3])
{
    for (size_t i = 0; i < set->count; i++) {
        const double want = seen_density(camera, set->importons[i].position, normal);
        PM_CHECK_NEAR((double)set->importons[i].power[PM__IMPORTON_DENSITY], want, 1e-5 * want);
        for (int a = 0; a < 3; a++)
            PM_CHECK_NEAR((double)set->normals[i][a], normal[a], 1e-6);
    }
}

START_TEST(a_tilted_view_of_a_floor)
{
    pm__scene *const scene = make_floor(0.0);
    const double up[3] = {0, 0, 1};
    const pm__camera camera = look(0.3, -2.0, 1.1, 0.1, 1.0, 0.0, 0.5);
    const pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_PIXELS);
    pm__importons sets[PM__MAP_KINDS];
    importons_made(&config, sets);
    ck_assert_uint_eq(sets[PM__CAUSTIC_MAP].count, PATHS);
    ck_assert_uint_eq(sets[PM__GLOBAL_MAP].count, 0);
    check_seen(&sets[PM__CAUSTIC_MAP], &camera, up);
    PM_CHECK_NEAR(flux_of(&sets[PM__CAUSTIC_MAP]), PIXELS, 1e-6 * PIXELS);
    pm__importons_free(sets);
    pm__scene_destroy(scene);
}
END_TEST

START_TEST(through_a_mirror_it_is_unfolded)
{
    pm__scene *const scene = lit_create();
    const pm__material mirror = {.kind = PM__MIRROR, .specular = {1, 1, 1}};
    const double corner[3] = {-5, 3, -5}, u[3] = {10, 0, 0}, v[3] = {0, 0, 10}, up[3] = {0, 0, 1};
    pm_error error;
    PM_CHECK_OK(pm__scene_rectangle(scene, lit_material(scene, &mirror), corner, u, v, &error), error);
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 20.0, 0.0);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0.5, 0.0, 2.0, 0.3, 3.0, 1.0, 0.2), image = look(0.5, 6.0, 2.0, 0.3, 3.0, 1.0, 0.2);
    const pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_PIXELS);
    pm__importons sets[PM__MAP_KINDS];
    importons_made(&config, sets);
    ck_assert_uint_eq(sets[PM__CAUSTIC_MAP].count, PATHS);
    check_seen(&sets[PM__CAUSTIC_MAP], &image, up);
    pm__importons_free(sets);
    pm__scene_destroy(scene);
}
END_TEST

/* A plate of index n and thickness t, in air otherwise, at right angles to the view from the height h: after m
 * reflections back and forth within it, a ray that leaves at the angle q from straight down has come to
 *     rho(q) = (h - t) tan q + (2 m + 1) t tan q',   sin q = n sin q',
 * so of the pixels P(q) / sr there are P sin q dq / (rho drho) to the square metre. The importon's direction tells q,
 * for the ray leaves the plate as it came; P is 1 / (pixel^2 cos^3 q). */
static const double indices[2][3] = {{1.5, 1.5, 1.5}, {1.3, 1.5, 1.8}};

/* false: by another index, or after another number of reflections. */
static bool came_so(const pm_photon *importon, double n, int m, double *density)
{
    const double rho = hypot((double)importon->position[0], (double)importon->position[1]);
    const double s = hypot((double)importon->direction[0], (double)importon->direction[1]), c = sqrt(1.0 - s * s);
    const double s2 = s / n, c2 = sqrt(1.0 - s2 * s2), back = 2.0 * m + 1.0, pixel = 2.0 * tan(0.5 * angle) / SIDE;
    const double far = (above - thick) * s / c + back * thick * s2 / c2;
    const double slope = (above - thick) / (c * c) + back * thick * c / (n * c2 * c2 * c2);
    *density = s / (far * slope) / (pixel * pixel * c * c * c);
    return fabs(rho - far) < 1e-5;
}

START_TEST(through_a_plate_of_glass)
{
    pm__scene *const scene = make_plate(indices[_i]);
    const pm__camera camera = look(0, 0, above, 0, 0, 0, angle);
    const pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_PIXELS);
    pm__importons sets[PM__MAP_KINDS];
    size_t ways[3][4] = {{0}};
    importons_made(&config, sets);
    for (size_t i = 0; i < sets[PM__CAUSTIC_MAP].count; i++) {
        const pm_photon *const importon = &sets[PM__CAUSTIC_MAP].importons[i];
        const double got = (double)importon->power[PM__IMPORTON_DENSITY];
        bool found = hypot((double)importon->direction[0], (double)importon->direction[1]) < 0.02; /* tells nothing */
        for (int b = 0; b < 3 && !found; b++)
            for (int m = 0; m < 4 && !found; m++) {
                double want;
                found = came_so(importon, indices[_i][b], m, &want) && fabs(got - want) <= 3e-5 * want;
                ways[b][m] += found;
            }
        ck_assert_msg(found, "an importon at (%g, %g) with density %g", (double)importon->position[0],
                      (double)importon->position[1], got);
    }
    for (int b = 0; b < (_i ? 3 : 1); b++)
        ck_assert(ways[b][0] > PATHS / 5 && ways[b][1] > 0);
    pm__importons_free(sets);
    pm__scene_destroy(scene);
}
END_TEST

/* Off a diffuse floor to a plate h above it, each seen from the other under the cosine c at the distance d: two unit
 * numbers move the place over pi d^2 / c^2, to which a pixel, small enough, adds nothing. */
START_TEST(off_a_diffuse_floor_to_a_plate)
{
    pm__scene *const scene = lit_create();
    const uint32_t white = lit_wall(scene, 1, 1, 1);
    const double high = 3.0;
    lit_floor(scene, white, 50.0, 0.0);
    lit_floor(scene, white, 50.0, high);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0, 0, above, 0, 0, 0, 1e-4);
    const pm__importance_config config = importance_of(scene, &camera, PATHS / 10, PM__OF_PIXELS);
    pm__importons sets[PM__MAP_KINDS];
    importons_made(&config, sets);
    ck_assert_uint_gt(sets[PM__GLOBAL_MAP].count, PATHS / 4);
    for (size_t i = 0; i < sets[PM__GLOBAL_MAP].count; i++) {
        const pm_photon *const importon = &sets[PM__GLOBAL_MAP].importons[i];
        const double c = (double)importon->direction[2], d = high / c;
        const double want = c * c / (important_pi * d * d);
        PM_CHECK_NEAR((double)sets[PM__GLOBAL_MAP].normals[i][2], -1.0, 1e-6);
        PM_CHECK_NEAR((double)importon->power[PM__IMPORTON_DENSITY], want, 1e-4 * want);
    }
    pm__importons_free(sets);
    pm__scene_destroy(scene);
}
END_TEST

/* ---- Estimates --------------------------------------------------------------------------------- */

/* By pixels the floor from above has one importance everywhere; and beyond the view it falls with the square of the
 * distance, once that is more than the radius of the estimate, r = sqrt(200 / (pi D)) of D importons to the m2, as
 * cells tell it, and ends. Above the view the nearest importon is a known height away. */
START_TEST(a_floor_from_straight_above)
{
    pm__scene *const scene = make_floor(0.5);
    const pm__camera camera = look(0, 0, above, 0, 0, 0, angle);
    pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_PIXELS);
    const double want = floor_density(), r = sqrt(200.0 / (important_pi * want * PATHS / PIXELS));
    for (int quarter = 0; quarter < 2; quarter++) {
        config.share = quarter ? 0.25 : 1.0;
        pm__importance *const importance = importance_made(&config);
        ck_assert_uint_eq(pm__importance_count(importance, PM__CAUSTIC_MAP), PATHS);
        ck_assert_uint_eq(pm__importance_count(importance, PM__GLOBAL_MAP), 0);
        PM_CHECK_NEAR(pm__importance_mean(importance, PM__CAUSTIC_MAP), want, 1e-5 * want);
        PM_CHECK_NEAR(pm__importance_threshold(importance, PM__CAUSTIC_MAP), 0.1 * want, 1e-6 * want);
        for (int i = 0; i < 300; i++) {
            double u[2];
            pm__random_uniform(3, PM__FOR_TESTS, 0, (uint64_t)i, u, 2);
            const double x = 1.4 * (u[0] - 0.5), y = 1.4 * (u[1] - 0.5);
            PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, x, y, 0, 0, 0, 1), want, 1e-5 * want);
            PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, x, y, 0, 0, 0, -1), 0.0, 0.0);
            PM_CHECK_NEAR(importance_at(importance, PM__GLOBAL_MAP, x, y, 0, 0, 0, 1), 0.0, 0.0);
        }
        const double at4 = importance_at(importance, PM__CAUSTIC_MAP, 0, 0, 4.0 * r, 0, 0, 1);
        /* The middle of a cell of up to 1.42 r is up to 1.23 r off, as much again is taken off the distance; r is known
         * by 200 importons, to 5.3 / sqrt(200). */
        ck_assert_msg(at4 > 0.6 * want / (5.23 * 5.23) && at4 < 1.4 * want / (1.54 * 1.54), "%g of %g", at4, want);
        PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, 0, 0, 0.6 * r, 0, 0, 1), want, 1e-5 * want);
        PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, 0, 0, 30.0 * r, 0, 0, 1), 0.0, 0.0);
        pm__importance_destroy(importance);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* Importons do not depend on the measure, so of one seed both = (screen + s pixels) / 2 at every point, s the ratio of
 * their means over importons; and its mean is the screen's. */
START_TEST(half_and_half)
{
    pm__scene *const scene = make_floor(0.5);
    const pm__camera camera = look(0.3, -2.0, 1.1, 0.1, 1.0, 0.0, 0.5);
    pm__importance *by[3];
    for (int measure = 0; measure < 3; measure++) {
        const pm__importance_config config = importance_of(scene, &camera, PATHS / 4, (pm__measure)measure);
        by[measure] = importance_made(&config);
    }
    const double screen = pm__importance_mean(by[PM__OF_SCREEN], PM__CAUSTIC_MAP);
    const double pixels = pm__importance_mean(by[PM__OF_PIXELS], PM__CAUSTIC_MAP);
    PM_CHECK_NEAR(pm__importance_mean(by[PM__OF_BOTH], PM__CAUSTIC_MAP), screen, 1e-9 * screen);
    for (int i = 0; i < 500; i++) {
        double u[2], value[3];
        pm__random_uniform(8, PM__FOR_TESTS, 0, (uint64_t)i, u, 2);
        for (int measure = 0; measure < 3; measure++)
            value[measure] =
                importance_at(by[measure], PM__CAUSTIC_MAP, 3.0 * u[0] - 1.5, 4.0 * u[1] - 1.5, 0, 0, 0, 1);
        const double want = 0.5 * (value[PM__OF_SCREEN] + value[PM__OF_PIXELS] * screen / pixels);
        PM_CHECK_NEAR(value[PM__OF_BOTH], want, 1e-6 * want);
    }
    for (int measure = 0; measure < 3; measure++)
        pm__importance_destroy(by[measure]);
    pm__scene_destroy(scene);
}
END_TEST

/* Half of the view is on a near table, half on a floor so far below that footprints there are 3600 times as large: with
 * importance by pixels of p and p / 3600 their geometric mean is p / 60, so a cut at 6 takes the table to p / 10 and
 * leaves the floor. (The view has no third thing; the table's edge is the view's middle.) */
START_TEST(outliers_are_cut)
{
    pm__scene *const scene = lit_create();
    const double corner[3] = {0, -9, 1}, u[3] = {9, 0, 0}, v[3] = {0, 18, 0};
    pm_error error;
    PM_CHECK_OK(pm__scene_rectangle(scene, lit_wall(scene, 0, 0, 0), corner, u, v, &error), error);
    lit_floor(scene, lit_wall(scene, 0, 0, 0), 100.0, -58.0);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0, 0, above, 0, 0, 0, angle);
    pm__importance_config config = importance_of(scene, &camera, 4096, PM__OF_PIXELS); /* even: half on each */
    const double table = floor_density() * 4.0, ground = table / 3600.0;
    config.nearest = 50;
    for (int cut = 0; cut < 2; cut++) {
        config.outlier = cut ? 6.0 : 100.0;
        pm__importance *const importance = importance_made(&config);
        const double want = cut ? 0.1 * table : table;
        PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, 0.15, 0, 1, 0, 0, 1), want, 1e-3 * want);
        PM_CHECK_NEAR(importance_at(importance, PM__CAUSTIC_MAP, -9.0, 0, -58, 0, 0, 1), ground, 1e-3 * ground);
        pm__importance_destroy(importance);
    }
    pm__scene_destroy(scene);
}
END_TEST

/* A sheet within a ball is lit from both sides: each has its own importance, what came to it to its area. By means over
 * the sheet's middle, to a tenth; of both sides together it would be about twice that. */
START_TEST(sides_are_kept_apart)
{
    pm__scene *const scene = lit_create();
    const uint32_t white = lit_wall(scene, 0.9, 0.9, 0.9);
    lit_sphere(scene, white, 0, 0, 0, 1.0, true);
    lit_floor(scene, white, 0.4, 0.0);
    far_lamp(scene);
    lit_commit(scene);
    const pm__camera camera = look(0.7, 0, 0, 1, 0, 0, 2.0);
    pm__importance_config config = importance_of(scene, &camera, PATHS, PM__OF_SCREEN);
    pm__importons sets[PM__MAP_KINDS];
    config.nearest = 100;
    importons_made(&config, sets);
    pm__importance *const importance = importance_made(&config);
    for (int side = -1; side < 2; side += 2) {
        double flux = 0.0, sum = 0.0;
        for (size_t i = 0; i < sets[PM__GLOBAL_MAP].count; i++) {
            const pm_photon *const importon = &sets[PM__GLOBAL_MAP].importons[i];
            if (fabsf(importon->position[0]) < 0.2f && fabsf(importon->position[1]) < 0.2f &&
                fabsf(importon->position[2]) < 1e-4f && (double)(sets[PM__GLOBAL_MAP].normals[i][2]) * side > 0.5)
                flux += (double)importon->power[PM__IMPORTON_PIXELS];
        }
        for (int x = 0; x < 20; x++)
            for (int y = 0; y < 20; y++)
                sum += importance_at(importance, PM__GLOBAL_MAP, 0.02 * x - 0.19, 0.02 * y - 0.19, 0, 0, 0, side);
        sum /= 400.0;
        PM_CHECK_NEAR(sum, flux / 0.16, 0.1 * sum);
    }
    pm__importance_destroy(importance);
    pm__importons_free(sets);
    pm__scene_destroy(scene);
}
END_TEST

int main(void)
{
    Suite *const suite = suite_create("importance");
    TCase *const tcase = tcase_create("importance");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, a_tilted_view_of_a_floor);
    tcase_add_test(tcase, through_a_mirror_it_is_unfolded);
    tcase_add_loop_test(tcase, through_a_plate_of_glass, 0, 2);
    tcase_add_test(tcase, off_a_diffuse_floor_to_a_plate);
    tcase_add_test(tcase, a_floor_from_straight_above);
    tcase_add_test(tcase, half_and_half);
    tcase_add_test(tcase, outliers_are_cut);
    tcase_add_test(tcase, sides_are_kept_apart);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
