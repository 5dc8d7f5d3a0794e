/* Progressive methods against sums written out here, and runs that are taken up again or run on several threads. The
 * furnace's wall is a sphere under even light: the points of a sphere within the chord r are an area of exactly
 * pi r^2, so estimates have no error but noise. It shines 1 W/(m2 sr) and reflects as much (albedo 1/2). */
#include "../progress.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846;
static const double two_thirds = 2.0 / 3.0;

/* ---- The mean of the passes -------------------------------------------------------------------- */

typedef struct counted {
    double count, flux;
} counted;

/* Photons within the radius of a point, one by one. */
static counted count_within(const pm__photon_set *set, const double position[3], double radius2)
{
    counted found = {0.0, 0.0};
    for (size_t i = 0; i < set->count; i++) {
        double d2 = 0.0;
        for (int a = 0; a < 3; a++) {
            const double d = (double)set->photons[i].position[a] - position[a];
            d2 += d * d;
        }
        if (d2 <= radius2) {
            found.count += 1.0;
            found.flux += (double)set->photons[i].power[0];
        }
    }
    return found;
}

static pm__photon_set shoot_pass(const progress *p, const pm__run *run, uint32_t pass)
{
    const pm__shoot_config shooting = {.scene = p->progression.stage.scene, .paths = p->progression.paths,
                                       .seed = run->seed, .trial = pass, .count = p->config.photons, .emitted = true};
    return lit_shoot(&shooting);
}

/* The answer is the mean of the passes' own estimates, and the radius shrinks by the share of photons that is kept.
 * Lookups round their radius to single precision: 1e-6 is ten times that. */
static void check_mean_of_passes(const char *method, bool first)
{
    enum { PASSES = 6, POINT = 21 };
    progress *const p = progress_open(progress_create("scene:furnace", method, "disc", 0.25));
    const pm__hit_point *const point = &p->progression.fixed[POINT];
    pm__run run = progress_begin(p, 0);
    double radius2 = 0.0625, kept = 0.0, sum = 0.0;
    for (uint32_t j = 0; j < PASSES; j++) {
        pm__photon_set set = shoot_pass(p, &run, j);
        const counted found = count_within(&set, point->position, radius2);
        sum += found.flux / (pi * radius2) * 0.5 / pi;
        const double share = j || !first ? (kept + two_thirds * found.count) / (kept + found.count) : 1.0;
        kept = (kept + found.count) * share;
        radius2 *= share;
        progress_pass(&run, 1);
        double(*const radiance)[3] = progress_read(&run);
        const pm__point_view view = pm__run_view(&run, POINT);
        PM_CHECK_NEAR(radiance[POINT][0], 1.0 + sum / (j + 1.0), 1e-6);
        PM_CHECK_NEAR(view.radius * view.radius / radius2, 1.0, 1e-6);
        PM_CHECK_NEAR(view.count / kept, 1.0, 1e-12);
        pm__photon_set_free(&set);
        free(radiance);
    }
    pm__run_end(&run);
    progress_free(p);
}

START_TEST(ppm_is_the_mean_of_its_passes)
{
    check_mean_of_passes("ppm", false);
    check_mean_of_passes("ppm:start=first", true);
}
END_TEST

/* ---- A pass by the public interface ------------------------------------------------------------ */

/* What pm_estimate says, one point at a time, in a map built for another search: to rounding, whether points are looked
 * up together (where they find few photons) or one by one (where these are more than there is room for). */
static void check_estimates(const char *scene, const char *kernel, double radius)
{
    progress *const p = progress_create(scene, "ppm", kernel, radius);
    p->config.width = p->config.height = 24;
    p->config.photons = 20000;
    p->config.front_only = true;
    (void)progress_open(p);
    pm__run run = progress_begin(p, 0);
    pm__photon_set set = shoot_pass(p, &run, 0);
    pm_map *map;
    pm_workspace *workspace;
    pm_error error;
    double seen = 0.0;
    PM_CHECK_OK(pm_map_create(set.photons, set.count, NULL, &map, &error), error);
    ck_assert_int_eq(pm_workspace_create(8, &workspace), PM_OK);
    progress_pass(&run, 1);
    double(*const radiance)[3] = progress_read(&run);
    for (size_t i = 0; i < p->progression.points; i++) {
        const pm__hit_point *const point = &p->progression.fixed[i];
        const pm_source source = {.maps = (const pm_map *const[]){map}, .map_count = 1, .dimensions = 2};
        pm_query query;
        pm_estimation estimation;
        double brdf[3];
        if (!point->material)
            continue;
        pm__point_query(&p->progression, point, 0, radius, &query);
        ck_assert_int_eq(pm_estimate(p->kernel, &source, &query, workspace, &estimation), PM_OK);
        pm__hit_point_brdf(point, point->normal, brdf);
        for (int b = 0; b < 3; b++) {
            const double want = point->emitted[b] + point->weight[b] * brdf[b] * estimation.value[b];
            PM_CHECK_NEAR(radiance[i][b], want, 1e-12 * (1.0 + fabs(want)));
        }
        seen += (double)estimation.count;
    }
    ck_assert_double_gt(seen, 100.0);
    free(radiance);
    pm_workspace_destroy(workspace);
    pm_map_destroy(map);
    pm__photon_set_free(&set);
    pm__run_end(&run);
    progress_free(p);
}

START_TEST(passes_are_estimates)
{
    static const char *const kernels[] = {"disc", "cone", "epanechnikov", "gaussian"};
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++) {
        check_estimates("scene:cornell", kernels[i], 0.02);
        check_estimates("scene:cornell", kernels[i], 0.15);
        check_estimates("scene:furnace", kernels[i], 0.05);
    }
}
END_TEST

/* pppm looks at no photon: the product of (i + alpha) / (i + 1) from i = 1, here by the gamma function. */
START_TEST(pppm_keeps_its_schedule)
{
    enum { PASSES = 9 };
    progress *const p = progress_open(progress_create("scene:furnace", "pppm", "disc", 0.25));
    pm__run run = progress_begin(p, 0);
    for (uint32_t i = 1; i <= PASSES; i++) {
        progress_pass(&run, 1);
        const double share = tgamma(i + 1.0 + two_thirds) / (tgamma(1.0 + two_thirds) * tgamma(i + 2.0));
        PM_CHECK_NEAR(progress_radius2(&run) / 0.0625 / share, 1.0, 1e-12);
    }
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

/* ---- k photons --------------------------------------------------------------------------------- */

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Squared distance of the k-th of all photons of the sets. */
static double kth_distance2(const pm__photon_set *sets, size_t set_count, const double position[3], size_t k)
{
    size_t count = 0, n = 0;
    for (size_t s = 0; s < set_count; s++)
        count += sets[s].count;
    double *const d2 = calloc(count, sizeof *d2);
    ck_assert_ptr_nonnull(d2);
    for (size_t s = 0; s < set_count; s++)
        for (size_t i = 0; i < sets[s].count; i++, n++)
            for (int a = 0; a < 3; a++) {
                const double d = (double)sets[s].photons[i].position[a] - position[a];
                d2[n] += d * d;
            }
    qsort(d2, count, sizeof *d2, by_size);
    const double found = d2[k - 1];
    free(d2);
    return found;
}

enum { MAPS = 4, AT = 13 };

/* What a method says of the point AT after each pass, and the photons. All photons have one power. */
static double run_maps(const char *method, pm__photon_set sets[MAPS], double position[3], double answers[MAPS])
{
    progress *const p = progress_open(progress_create("scene:furnace", method, "disc", 0.0));
    pm__run run = progress_begin(p, 0);
    memcpy(position, p->progression.fixed[AT].position, 3 * sizeof *position);
    for (uint32_t j = 0; j < MAPS; j++) {
        sets[j] = shoot_pass(p, &run, j);
        progress_pass(&run, 1);
        double(*const radiance)[3] = progress_read(&run);
        answers[j] = radiance[AT][0] - 1.0;
        free(radiance);
    }
    pm__run_end(&run);
    progress_free(p);
    return (double)sets[0].photons[0].power[0];
}

static void free_maps(pm__photon_set sets[MAPS])
{
    for (int j = 0; j < MAPS; j++)
        pm__photon_set_free(&sets[j]);
}

/* 10 photons a pass: the mean of 10 / (pi r^2), and 10 M over the sum of pi r^2. */
START_TEST(average_and_combination_of_maps)
{
    pm__photon_set sets[MAPS];
    double position[3], averaged[MAPS], combined[MAPS], sum = 0.0, area = 0.0;
    const double power = run_maps("pm-average", sets, position, averaged);
    free_maps(sets);
    (void)run_maps("pm-combine", sets, position, combined);
    for (int j = 0; j < MAPS; j++) {
        const double r2 = kth_distance2(&sets[j], 1, position, 10);
        sum += 10.0 * power / (pi * r2);
        area += pi * r2;
        PM_CHECK_NEAR(averaged[j], 0.5 / pi * sum / (j + 1.0), 1e-5);
        PM_CHECK_NEAR(combined[j], 0.5 / pi * 10.0 * power * (j + 1.0) / area, 1e-5);
    }
    free_maps(sets);
}
END_TEST

/* All photons so far, k = floor(10 i^beta) of them, each of 1/i of its power. */
static void check_one_map(const char *method, double beta)
{
    pm__photon_set sets[MAPS];
    double position[3], answers[MAPS];
    const double power = run_maps(method, sets, position, answers);
    for (int j = 0; j < MAPS; j++) {
        const size_t k = (size_t)floor(10.0 * pow(j + 1.0, beta));
        const double r2 = kth_distance2(sets, (size_t)j + 1, position, k);
        PM_CHECK_NEAR(answers[j], 0.5 / pi * (double)k * power / (j + 1.0) / (pi * r2), 1e-5);
    }
    free_maps(sets);
}

START_TEST(one_map_of_all_passes)
{
    check_one_map("pm:beta=0", 0.0);
    check_one_map("pm:beta=0.7", 0.7);
}
END_TEST

/* ---- The adaptive radius ------------------------------------------------------------------------ */

enum { SIDE = 121 };

/* Photons on a fine lattice within b of a point, each with the power of its cell under E = 1 + curve (rho / b)^2, so
 * that the Laplacian is 4 curve / b^2: a triweight smooths a quadratic without changing its Laplacian. In a unit of
 * 2 m. */
typedef struct lattice {
    float distance2[SIDE * SIDE], flux[SIDE * SIDE][3];
    size_t count;
    double square, noise; /* sums of squares: of powers of all bands, and of these times the triweight's Laplacian */
} lattice;

static void lattice_fill(lattice *l, double b, double curve)
{
    l->count = 0;
    l->square = l->noise = 0.0;
    for (int x = 0; x < SIDE; x++)
        for (int y = 0; y < SIDE; y++) {
            const double u = 2.0 * x / (SIDE - 1.0) - 1.0, v = 2.0 * y / (SIDE - 1.0) - 1.0, s = u * u + v * v;
            if (s > 1.0)
                continue;
            const double cell = 4.0 / ((SIDE - 1.0) * (SIDE - 1.0)) * b * b, power = cell * (1.0 + curve * s);
            const double lapl = 4.0 / pi * (24.0 * s * (1.0 - s) - 12.0 * (1.0 - s) * (1.0 - s)) / (b * b * b * b);
            l->distance2[l->count] = (float)(s * b * b / 4.0);
            for (int band = 0; band < 3; band++)
                l->flux[l->count][band] = (float)power;
            l->count++;
            l->square += 9.0 * power * power;
            l->noise += 9.0 * power * power * lapl * lapl;
        }
}

/* A pass that finds the lattice within the radius b that it asks for. */
static double take_lattice(pm__run *run, lattice *l, double curve)
{
    const pm__progressive *const method = pm__progressive_of(run);
    size_t k;
    double b;
    method->ask(run, 0, run->state, &k, &b);
    ck_assert_uint_eq(k, 0);
    lattice_fill(l, b, curve);
    const pm__neighbors set = {.count = l->count, .cut = true, .distance2 = l->distance2, .radius2 = b * b / 4.0,
                               .flux = (const float(*)[3])l->flux};
    const pm__found found = {
        .area = pi * b * b, .count = l->count, .neighbors = &set, .unit = 2.0, .share = {1.0, 1.0, 1.0}};
    method->take(run, &found, run->state);
    run->passes++;
    return b;
}

/* The radius must be the one that section 3 of docs/errata.md and the top of appm.c give, with its constants.
 * Within 1 %: a cell is 1/60 of the radius. */
static void check_adaptive_radius(const char *kernel, double infl, double m2)
{
    static lattice l;
    progress *const p = progress_open(progress_create("scene:furnace", "appm", kernel, 0.25));
    pm__run run = progress_begin(p, 0);
    const double b = take_lattice(&run, &l, 0.5);
    PM_CHECK_NEAR(b, 2.5 * 0.25, 1e-12);
    const double lapl = 3.0 * 2.0 / (b * b), density = l.square / (pi * b * b), bias = 0.25 * m2;
    const double h6 = infl * density / pi / (6.0 * bias * bias * (lapl * lapl - l.noise) * 2.0);
    PM_CHECK_NEAR(pm__run_view(&run, 0).radius / pow(h6, 1.0 / 6.0), 1.0, 0.01);
    pm__run_end(&run);
    progress_free(p);
}

START_TEST(appm_takes_the_optimum)
{
    check_adaptive_radius("disc", 1.0, 0.5);
    check_adaptive_radius("cone:k=1", 1.5, 0.3);
    check_adaptive_radius("epanechnikov", 4.0 / 3.0, 1.0 / 3.0);
    check_adaptive_radius("biweight", 1.8, 0.25);
}
END_TEST

/* However curved the light is found to be, or however even, the squared radius of pass i stays between
 * h^2/1024 i^(alpha/2 - 1) and 4 h^2 i^((alpha - 1)/2). */
START_TEST(appm_keeps_its_bounds)
{
    static lattice l;
    progress *const p = progress_open(progress_create("scene:furnace", "appm", "disc", 0.25));
    pm__run curved = progress_begin(p, 0), even = progress_begin(p, 0);
    for (int i = 2; i <= 30; i++) {
        (void)take_lattice(&curved, &l, 1e3);
        (void)take_lattice(&even, &l, 0.0);
        const double low = 0.0625 / 1024.0 * pow(i, two_thirds / 2.0 - 1.0);
        const double high = 4.0 * 0.0625 * pow(i, (two_thirds - 1.0) / 2.0);
        ck_assert_double_ge(progress_radius2_of(&curved, 0), low * (1.0 - 1e-12));
        ck_assert_double_le(progress_radius2_of(&even, 0), high * (1.0 + 1e-12));
        if (i == 30) {
            PM_CHECK_NEAR(progress_radius2_of(&curved, 0) / low, 1.0, 1e-12);
            PM_CHECK_NEAR(progress_radius2_of(&even, 0) / high, 1.0, 1e-12);
        }
    }
    pm__run_end(&curved);
    pm__run_end(&even);
    progress_free(p);
}
END_TEST

/* Where nothing is found the schedule of pppm holds: (i + alpha) / (i + 1). */
START_TEST(appm_without_photons_follows_the_schedule)
{
    progress *const p = progress_open(progress_create("scene:furnace", "appm", "disc", 0.25));
    const pm__progressive *const method = pm__progressive_of(&(pm__run){.of = &p->progression});
    pm__run run = progress_begin(p, 0);
    const pm__found nothing = {.count = 0};
    for (; run.passes < 20; run.passes++) {
        method->take(&run, &nothing, run.state);
        const double i = run.passes + 2.0, radius = method->view(&run, 0, run.state).radius;
        PM_CHECK_NEAR(radius * radius / 0.0625,
                      tgamma(i + two_thirds) / (tgamma(1.0 + two_thirds) * tgamma(i + 1.0)), 1e-12);
    }
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

/* ---- Every method ------------------------------------------------------------------------------- */

static progress *open_any(size_t method, const pm_parallel *parallel)
{
    progress *const p =
        progress_create("scene:glass-sphere:d=2", pm__progressives.entries[method]->name, "disc:last=none", 0.0);
    p->config.width = 24;
    p->config.height = 20; /* more points than one task has */
    p->config.parallel = parallel;
    return progress_open(p);
}

static void check_same(const char *what, pm__run *a, pm__run *b)
{
    double(*const x)[3] = progress_read(a), (*const y)[3] = progress_read(b);
    const size_t fields = pm__progressive_of(a)->fields, points = a->of->points;
    ck_assert_msg(memcmp(x, y, points * sizeof *x) == 0, "%s: answers differ", what);
    ck_assert_msg(memcmp(a->state, b->state, points * fields * sizeof *a->state) == 0, "%s: states differ", what);
    free(x);
    free(y);
}

START_TEST(resumed_runs_go_on_undisturbed)
{
    const char *const name = pm__progressives.entries[_i]->name;
    progress *const p = open_any((size_t)_i, NULL);
    const size_t values = p->progression.points * pm__progressive_of(&(pm__run){.of = &p->progression})->fields;
    double *const saved = calloc(values, sizeof *saved);
    ck_assert_ptr_nonnull(saved);
    pm_error error = {""};
    pm__run whole = progress_begin(p, 2), part = progress_begin(p, 2), rest = progress_begin(p, 2);
    progress_pass(&whole, 5);
    progress_pass(&part, 3);
    memcpy(saved, part.state, values * sizeof *saved);
    rest.emitted = part.emitted;
    rest.stored = part.stored;
    PM_CHECK_OK(pm__run_resume(&rest, saved, 3, &error), error);
    check_same(name, &part, &rest); /* reading in between changes nothing */
    progress_pass(&rest, 2);
    check_same(name, &whole, &rest);
    ck_assert_uint_eq(whole.emitted, rest.emitted);
    ck_assert_uint_eq(whole.stored, rest.stored);
    pm__run_end(&whole);
    pm__run_end(&part);
    pm__run_end(&rest);
    free(saved);
    progress_free(p);
}
END_TEST

START_TEST(threads_change_nothing)
{
    progress *const one = open_any((size_t)_i, NULL), *const two = open_any((size_t)_i, &picture_two_threads);
    pm__run a = progress_begin(one, 1), b = progress_begin(two, 1);
    progress_pass(&a, 4);
    progress_pass(&b, 4);
    check_same(pm__progressives.entries[_i]->name, &a, &b);
    pm__run_end(&a);
    pm__run_end(&b);
    progress_free(one);
    progress_free(two);
}
END_TEST

/* ---- Memory ------------------------------------------------------------------------------------ */

/* kB of the process that are in memory. */
static double resident(void)
{
    FILE *const file = fopen("/proc/self/statm", "r");
    long all = 0, here = 0;
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(fscanf(file, "%ld %ld", &all, &here), 2);
    (void)fclose(file);
    return 4.0 * (double)here;
}

/* A thousand passes hold what a hundred do. Sanitizers keep what is freed: they are not asked. */
START_TEST(memory_does_not_grow_with_passes)
{
#if !defined(__SANITIZE_ADDRESS__)
    static const char *const methods[] = {"ppm", "sppm", "pppm"};
    for (size_t i = 0; i < 3; i++) {
        progress *const p = progress_open(progress_create("scene:plate", methods[i], "disc", 0.0));
        pm__run run = progress_begin(p, 0);
        progress_pass(&run, 100);
        const double before = resident();
        progress_pass(&run, 900);
        const double after = resident();
        ck_assert_msg(after <= 1.02 * before, "%s: %.0f kB after 100 passes, %.0f after 1000", methods[i], before,
                      after);
        pm__run_end(&run);
        progress_free(p);
    }
#else
    (void)resident;
#endif
}
END_TEST

int main(void)
{
    const TTest *const once[] = {ppm_is_the_mean_of_its_passes, pppm_keeps_its_schedule, passes_are_estimates,
                                 average_and_combination_of_maps, one_map_of_all_passes, appm_takes_the_optimum,
                                 appm_keeps_its_bounds, appm_without_photons_follows_the_schedule,
                                 memory_does_not_grow_with_passes};
    Suite *const suite = suite_create("progressive");
    TCase *const tcase = tcase_create("progressive");
    tcase_set_timeout(tcase, 300);
    for (size_t i = 0; i < sizeof once / sizeof *once; i++)
        tcase_add_test(tcase, once[i]);
    tcase_add_loop_test(tcase, resumed_runs_go_on_undisturbed, 0, (int)pm__progressives.count);
    tcase_add_loop_test(tcase, threads_change_nothing, 0, (int)pm__progressives.count);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
