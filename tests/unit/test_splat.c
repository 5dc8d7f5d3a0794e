/* Photons that find fixed points (cover.h) beside points that find photons by a search: the same photons at the same
 * distances, so that sums differ by the order alone in which they are added up. */
#include "../progress.h"

#include "../../src/methods/progressive/cover.h"

#include <string.h>

enum { SIDE = 20, PASSES = 12 };

typedef struct setting {
    const char *scene, *method, *kernel;
    double radius; /* 0: of 10 photons */
    bool front;
} setting;

static progress *create_setting(const setting *s)
{
    progress *const p = progress_create(s->scene, s->method, s->kernel, s->radius);
    p->config.width = p->config.height = SIDE;
    p->config.photons = 5000;
    p->config.alpha = 0.3; /* radii shrink fast: what is listed is listed anew */
    p->config.front_only = s->front;
    return p;
}

/* search NULL: photons find the points, whatever would be chosen. */
static progress *open_setting(const setting *s, const char *search)
{
    progress *const p = create_setting(s);
    p->config.search = search ? pm_search_find(search) : NULL;
    ck_assert(!search || p->config.search);
    (void)progress_open(p);
    ck_assert(!search || !p->progression.meeting.by_photons);
    p->progression.meeting.by_photons = !search;
    return p;
}

/* ---- Beside a search --------------------------------------------------------------------------- */

/* Sums of terms that are not negative: rounding is relative, and radii follow. */
static void check_states(const char *what, const pm__run *a, const pm__run *b)
{
    const size_t count = pm__run_state_count(a->of);
    for (size_t i = 0; i < count; i++)
        ck_assert_msg(fabs(a->state[i] - b->state[i]) <= 1e-12 * fmax(fabs(a->state[i]), fabs(b->state[i])),
                      "%s, pass %u, state %zu: %.17g, expected %.17g", what, a->passes, i, a->state[i], b->state[i]);
}

static double count_photons(const pm__run *run)
{
    double photons = 0.0;
    for (size_t i = 0; i < run->of->points; i++)
        photons += pm__run_view(run, i).count;
    return photons;
}

/* `change` does the same to what both start from; may be NULL. Photons that count at the end, over all points. */
static double compare(const setting *s, void (*change)(progress *p, pm__run *run))
{
    progress *const splat = open_setting(s, NULL), *const found = open_setting(s, "unbalanced");
    pm__run a = progress_begin(splat, 0), b = progress_begin(found, 0);
    char what[200];
    (void)snprintf(what, sizeof what, "%s, %s, %s, radius %g", s->scene, s->method, s->kernel, s->radius);
    if (change) {
        change(splat, &a);
        change(found, &b);
    }
    for (int pass = 0; pass < PASSES; pass++) {
        progress_pass(&a, 1);
        progress_pass(&b, 1);
        check_states(what, &a, &b);
    }
    ck_assert_ptr_nonnull(a.cover);
    ck_assert_ptr_null(b.cover);
    const double photons = count_photons(&a);
    pm__run_end(&a);
    pm__run_end(&b);
    progress_free(splat);
    progress_free(found);
    return photons;
}

START_TEST(as_by_a_search)
{
    static const setting settings[] = {
        {"scene:cornell", "ppm", "disc", 0.05, true},
        {"scene:cornell", "ppm", "epanechnikov", 0.2, true},
        {"scene:cornell", "ppm", "disc", 0.0, false},
        {"scene:cornell", "ppm:flux=printed,start=first", "biweight", 0.0, true},
        {"scene:cornell-diffuse", "ppm:start=first", "cone", 0.0, true},
        {"scene:cognac", "ppm", "disc", 0.02, true}, /* a floor that does not scatter evenly */
        {"scene:glossy-plane", "ppm", "gaussian", 0.1, true},
        {"scene:plate", "ppm", "disc", 0.05, true},
        {"scene:furnace", "ppm:flux=printed", "disc", 0.8, false},
        {"scene:furnace", "ppm", "epanechnikov", 3.0, false}, /* all photons at every point */
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        const double photons = compare(&settings[i], NULL);
        ck_assert_msg(photons > 100.0, "%s: %g photons", settings[i].scene, photons);
    }
}
END_TEST

/* ---- Points and radii of all kinds ------------------------------------------------------------- */

static double uniform(uint32_t which, size_t i)
{
    double u[1];
    pm__random_uniform(5, PM__FOR_TESTS, which, i, u, 1);
    return u[0];
}

/* Radii from a thousandth of the room to all of it, side by side, and none. */
static double any_radius(size_t i)
{
    return i % 97 == 5 ? 2.0 : i % 89 == 7 ? 0.0 : 0.001 * pow(200.0, uniform(0, i));
}

static void set_radii(progress *p, pm__run *run)
{
    for (size_t i = 0; i < p->progression.points; i++)
        run->state[i * pm__progressive_of(run)->fields] = any_radius(i) * any_radius(i); /* as shrink.h has it */
}

/* As many at each place as `same`, steps apart along a line that no axis has. */
static void line_up(progress *p, size_t same, const double step[3])
{
    pm__hit_point *const fixed = p->progression.fixed;
    for (size_t i = 1; i < p->progression.points; i++) {
        fixed[i] = fixed[0];
        for (int a = 0; a < 3; a++)
            fixed[i].position[a] += (double)(i / same) * step[a];
    }
}

static void put_in_one_place(progress *p, pm__run *run)
{
    (void)run;
    line_up(p, SIZE_MAX, (double[3]){0.0});
}

static void put_in_one_cell(progress *p, pm__run *run)
{
    (void)run;
    line_up(p, 3, (double[3]){1e-6, 2e-6, -1e-6});
}

static void put_on_a_line(progress *p, pm__run *run)
{
    (void)run;
    line_up(p, 1, (double[3]){0.004, 0.0007, 0.0});
}

/* Only one of them is on a surface. */
static void leave_one(progress *p, pm__run *run)
{
    (void)run;
    for (size_t i = 0; i < p->progression.points; i++)
        if (i != 210)
            p->progression.fixed[i].material = NULL;
}

START_TEST(points_and_radii_of_all_kinds)
{
    static const setting s = {"scene:cornell-diffuse", "ppm", "epanechnikov", 0.1, true};
    ck_assert_double_gt(compare(&s, set_radii), 1e4);
    ck_assert_double_gt(compare(&s, put_in_one_place), 100.0);
    ck_assert_double_gt(compare(&s, put_in_one_cell), 100.0);
    ck_assert_double_gt(compare(&s, put_on_a_line), 100.0);
    ck_assert_double_gt(compare(&s, leave_one), 10.0);
}
END_TEST

START_TEST(a_single_point)
{
    static const setting s = {"scene:furnace", "ppm", "disc", 1.0, true};
    progress *const splat = create_setting(&s), *const found = create_setting(&s);
    splat->config.width = splat->config.height = found->config.width = found->config.height = 1;
    found->config.search = pm_search_find("brute");
    pm__run a = progress_begin(progress_open(splat), 0), b = progress_begin(progress_open(found), 0);
    ck_assert(splat->progression.meeting.by_photons);
    progress_pass(&a, 3);
    progress_pass(&b, 3);
    check_states("one point", &a, &b);
    ck_assert_double_gt(count_photons(&a), 100.0);
    pm__run_end(&a);
    pm__run_end(&b);
    progress_free(splat);
    progress_free(found);
}
END_TEST

/* No photon, no radius, no surface: passes go on, and nothing changes. */
START_TEST(nothing_to_find)
{
    static const setting s = {"scene:cornell", "ppm", "disc", 0.05, true};
    progress *const p = open_setting(&s, NULL);
    pm__run run = progress_begin(p, 0);
    const pm__photon_set none = {0};
    const size_t size = pm__run_state_count(&p->progression) * sizeof *run.state;
    double *const before = malloc(size);
    bool done = false;
    pm_error error = {""};
    ck_assert_ptr_nonnull(before);
    memcpy(before, run.state, size);
    PM_CHECK_OK(pm__run_splat(&run, &none, &done, &error), error);
    ck_assert(done && memcmp(run.state, before, size) == 0);
    progress_pass(&run, 1);
    ck_assert(memcmp(run.state, before, size) != 0);
    for (size_t i = 0; i < p->progression.points; i++)
        run.state[i * pm__progressive_of(&run)->fields] = 0.0;
    memcpy(before, run.state, size);
    PM_CHECK_OK(pm__run_resume(&run, before, 1, &error), error);
    progress_pass(&run, 2);
    for (size_t i = 0; i < p->progression.points; i++)
        p->progression.fixed[i].material = NULL;
    progress_pass(&run, 1);
    ck_assert(memcmp(run.state, before, size) == 0);
    pm__run_end(&run);
    progress_free(p);
    free(before);
}
END_TEST

/* ---- However it is cut ------------------------------------------------------------------------- */

typedef struct splitting {
    size_t chunk, chunks, pairs;
} splitting;

/* The states after three passes, to be freed; *lists: chunks that there was room for. */
static double *states(const setting *s, const splitting *cut, const pm_parallel *parallel, size_t *lists)
{
    progress *const p = create_setting(s);
    p->config.parallel = parallel;
    (void)progress_open(p);
    p->progression.meeting.by_photons = true;
    if (cut)
        p->progression.meeting = (pm__meeting){true, cut->chunk, cut->chunks, cut->pairs};
    pm__run run = progress_begin(p, 0);
    progress_pass(&run, 3);
    const size_t size = pm__run_state_count(&p->progression) * sizeof *run.state;
    double *const copy = malloc(size);
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, run.state, size);
    *lists = run.cover->pair_lists;
    pm__run_end(&run);
    progress_free(p);
    return copy;
}

static void check_cuts(const setting *s, const splitting *cuts, size_t count, const pm_parallel *parallel)
{
    size_t lists;
    double *const want = states(s, NULL, NULL, &lists);
    const size_t size = SIDE * SIDE * pm__progressive_ppm.fields * sizeof *want;
    for (size_t i = 0; i < count; i++) {
        double *const got = states(s, &cuts[i], parallel, &lists);
        ck_assert_msg(memcmp(got, want, size) == 0, "chunks of %zu, %zu at once, %zu pairs each", cuts[i].chunk,
                      cuts[i].chunks, cuts[i].pairs);
        ck_assert_uint_le(lists, cuts[i].chunks);
        free(got);
    }
    free(want);
}

/* Tiny chunks; room for next to nothing, so that chunks, and pages of a single photon, end in their midst. */
START_TEST(cuts_change_nothing)
{
    static const splitting cuts[] = {{1, 3, 0}, {1, 1000, 40}, {7, 5, 0}, {100, 1, 0}, {8192, 1, 0},
                                     {8192, 32, 0}, {8192, 3, 400}, {3000, 2, 5000}, {100000, 1, 10000000}};
    static const setting few = {"scene:cornell", "ppm", "epanechnikov", 0.07, true};
    static const setting many = {"scene:furnace", "ppm", "epanechnikov", 1.0, false};
    check_cuts(&few, cuts, sizeof cuts / sizeof *cuts, &picture_two_threads);
    check_cuts(&many, cuts, sizeof cuts / sizeof *cuts, NULL);
}
END_TEST

/* One photon brings more to a run of points than pages hold: 10000 points in one place are 20 runs of up to 512, pages
 * have 170. */
START_TEST(a_photon_may_find_more_than_there_is_room_for)
{
    enum { MANY = 100, CUTS = 2 };
    static const setting s = {"scene:furnace", "ppm", "epanechnikov", 0.7, false};
    static const splitting cuts[CUTS] = {{8192, 32, 10000000}, {8192, 4, 0}};
    progress *p[CUTS];
    pm__run run[CUTS];
    for (size_t i = 0; i < CUTS; i++) {
        p[i] = create_setting(&s);
        p[i]->config.width = p[i]->config.height = MANY;
        p[i]->config.photons = 40;
        (void)progress_open(p[i]);
        put_in_one_place(p[i], NULL);
        p[i]->progression.meeting = (pm__meeting){true, cuts[i].chunk, cuts[i].chunks, cuts[i].pairs};
        run[i] = progress_begin(p[i], 0);
        progress_pass(&run[i], 2);
    }
    ck_assert_double_gt(count_photons(&run[0]), 10000.0);
    ck_assert_int_eq(memcmp(run[0].state, run[1].state, pm__run_state_count(run[0].of) * sizeof *run[0].state), 0);
    for (size_t i = 0; i < CUTS; i++) {
        pm__run_end(&run[i]);
        progress_free(p[i]);
    }
}
END_TEST

/* A parallel-for on three threads. */
static void run_on_three(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    (void)context;
    picture_work work = {.task = task, .argument = argument, .count = count};
    pthread_t others[2];
    for (int i = 0; i < 2; i++)
        ck_assert_int_eq(pthread_create(&others[i], NULL, picture_thread, &work), 0);
    (void)picture_thread(&work);
    for (int i = 0; i < 2; i++)
        ck_assert_int_eq(pthread_join(others[i], NULL), 0);
}

START_TEST(threads_change_nothing)
{
    static const pm_parallel three = {.run = run_on_three};
    static const pm_parallel *const threads[] = {NULL, &picture_two_threads, &three};
    static const setting s = {"scene:cornell", "ppm", "epanechnikov", 0.07, true};
    progress *p[3];
    pm__run run[3];
    for (size_t i = 0; i < 3; i++) {
        p[i] = create_setting(&s);
        p[i]->config.parallel = threads[i];
        p[i]->config.photons = 60000; /* several tasks' */
        run[i] = progress_begin(progress_open(p[i]), 0);
        p[i]->progression.meeting.by_photons = true;
        progress_pass(&run[i], 3);
        ck_assert_int_eq(memcmp(run[i].state, run[0].state, pm__run_state_count(run[0].of) * sizeof(double)), 0);
    }
    for (size_t i = 0; i < 3; i++) {
        pm__run_end(&run[i]);
        progress_free(p[i]);
    }
}
END_TEST

/* ---- Runs -------------------------------------------------------------------------------------- */

/* Back to a state whose radii are larger, and to one whose radii are smaller. */
START_TEST(states_are_taken_up_again)
{
    enum { EARLY = 2, LATE = 9 };
    static const setting s = {"scene:cornell", "ppm", "disc", 0.1, true};
    progress *const p = open_setting(&s, NULL);
    pm_error error = {""};
    pm__run run = progress_begin(p, 0), other = progress_begin(p, 0);
    const size_t size = pm__run_state_count(&p->progression) * sizeof *run.state;
    double *const early = malloc(size), *const late = malloc(size);
    ck_assert(early && late);
    progress_pass(&run, EARLY);
    memcpy(early, run.state, size);
    progress_pass(&run, LATE - EARLY);
    memcpy(late, run.state, size);
    PM_CHECK_OK(pm__run_resume(&run, early, EARLY, &error), error);
    progress_pass(&run, LATE - EARLY);
    ck_assert_int_eq(memcmp(run.state, late, size), 0);
    progress_pass(&other, 1);
    PM_CHECK_OK(pm__run_resume(&other, early, EARLY, &error), error);
    progress_pass(&other, LATE - EARLY);
    ck_assert_int_eq(memcmp(other.state, late, size), 0);
    pm__run_end(&run);
    pm__run_end(&other);
    progress_free(p);
    free(early);
    free(late);
}
END_TEST

PM_TEST_MAIN("splat", as_by_a_search, points_and_radii_of_all_kinds, a_single_point, nothing_to_find,
             cuts_change_nothing, a_photon_may_find_more_than_there_is_room_for, threads_change_nothing,
             states_are_taken_up_again)
