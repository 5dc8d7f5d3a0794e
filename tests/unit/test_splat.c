/* Photons that find fixed points (cover.h) beside points that find photons by a search: the same sums but for the order
 * in which they are added up. */
#include "../progress.h"

#include "../../src/methods/progressive/cover.h"

#include <string.h>

/* ---- Beside a search --------------------------------------------------------------------------- */

typedef struct setting {
    const char *scene, *method, *kernel;
    double radius; /* 0: of 10 photons */
    bool front;
} setting;

static progress *open_setting(const setting *s, const char *search)
{
    progress *const p = progress_create(s->scene, s->method, s->kernel, s->radius);
    p->config.width = p->config.height = 20;
    p->config.photons = 5000;
    p->config.alpha = 0.3; /* radii shrink fast: what is listed is listed anew */
    p->config.front_only = s->front;
    p->config.search = search ? pm_search_find(search) : NULL;
    ck_assert(!search || p->config.search);
    return progress_open(p);
}

/* Relative to the largest: sums of either order differ by rounding, and radii follow. */
static void check_states(const setting *s, const pm__run *a, const pm__run *b)
{
    const size_t count = pm__run_state_count(a->of);
    for (size_t i = 0; i < count; i++)
        ck_assert_msg(fabs(a->state[i] - b->state[i]) <= 1e-9 * fmax(fabs(a->state[i]), fabs(b->state[i])),
                      "%s, %s, %s, radius %g, pass %u: %.17g, expected %.17g", s->scene, s->method, s->kernel,
                      s->radius, a->passes, a->state[i], b->state[i]);
}

static void check_setting(const setting *s)
{
    progress *const splat = open_setting(s, NULL), *const found = open_setting(s, "unbalanced");
    pm__run a = progress_begin(splat, 0), b = progress_begin(found, 0);
    double photons = 0.0;
    ck_assert(pm__run_splats(&a) && !pm__run_splats(&b));
    for (int pass = 0; pass < 12; pass++) {
        progress_pass(&a, 1);
        progress_pass(&b, 1);
        check_states(s, &a, &b);
    }
    for (size_t i = 0; i < splat->progression.points; i++)
        photons += pm__run_view(&a, i).count;
    ck_assert_msg(photons > 100.0, "%s: %g photons", s->scene, photons);
    pm__run_end(&a);
    pm__run_end(&b);
    progress_free(splat);
    progress_free(found);
}

START_TEST(as_by_a_search)
{
    static const setting settings[] = {
        {"scene:cornell", "ppm", "disc", 0.05, true},
        {"scene:cornell", "ppm", "epanechnikov", 0.2, true},
        {"scene:cornell", "ppm", "disc", 0.0, false},
        {"scene:cornell-diffuse", "ppm:start=first", "cone", 0.0, true},
        {"scene:cognac", "ppm", "disc", 0.02, true}, /* a floor that does not scatter evenly */
        {"scene:glossy-plane", "ppm", "gaussian", 0.1, true},
        {"scene:furnace", "ppm:flux=printed", "disc", 0.8, false},
        {"scene:furnace", "ppm", "disc", 3.0, false}, /* all photons at every point */
    };
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++)
        check_setting(&settings[i]);
}
END_TEST

/* ---- Runs -------------------------------------------------------------------------------------- */

/* Back to a state whose radii are larger, and to one whose radii are smaller. */
START_TEST(states_are_taken_up_again)
{
    enum { EARLY = 2, LATE = 9 };
    const setting s = {"scene:cornell", "ppm", "disc", 0.1, true};
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

START_TEST(threads_change_nothing)
{
    const setting s = {"scene:cornell", "ppm", "epanechnikov", 0.07, true};
    progress *const one = open_setting(&s, NULL), *const many = open_setting(&s, NULL);
    pm__run a = progress_begin(one, 0), b = progress_begin(many, 0);
    many->config.parallel = &picture_two_threads;
    one->config.photons = many->config.photons = 60000; /* several tasks' */
    progress_pass(&a, 3);
    progress_pass(&b, 3);
    ck_assert_int_eq(memcmp(a.state, b.state, pm__run_state_count(a.of) * sizeof *a.state), 0);
    pm__run_end(&a);
    pm__run_end(&b);
    progress_free(one);
    progress_free(many);
}
END_TEST

/* ---- The cover --------------------------------------------------------------------------------- */

/* Each point within its radius of a photon is listed in the photon's cell, with a radius that reaches it. */
static void check_listed(const pm__run *run, const pm__cover *cover, const float position[3])
{
    float within[3];
    const size_t cell = pm__cover_cell(cover, position, within);
    for (size_t i = 0; i < run->of->points; i++) {
        const pm__standing *const now = &cover->now[i];
        double d2 = 0.0;
        bool found = false;
        for (int a = 0; a < 3; a++)
            d2 += ((double)position[a] - (double)now->position[a]) * ((double)position[a] - (double)now->position[a]);
        if (!(d2 <= (double)now->radius * (double)now->radius) || !(now->radius > 0.0f))
            continue;
        ck_assert_uint_ne(cell, SIZE_MAX);
        for (size_t e = cover->starts[cell]; e < cover->starts[cell + 1]; e++) {
            const pm__listed *const entry = &cover->listed[e];
            double steps2 = 0.0;
            for (int a = 0; a < 3; a++)
                steps2 += pow((double)within[a] - entry->position[a], 2.0);
            if (entry->point == i && steps2 <= (double)entry->radius * entry->radius) {
                ck_assert_msg(!found, "point %zu is listed twice", i);
                found = true;
            }
        }
        ck_assert_msg(found, "point %zu, %g of %g m off, is not listed", i, sqrt(d2), (double)now->radius);
    }
}

/* Radii from a thousandth of the room to all of it, side by side: photons anywhere, on rims, and beyond the box. */
START_TEST(all_that_may_be_found_is_listed)
{
    const setting s = {"scene:cornell", "ppm", "disc", 0.05, true};
    progress *const p = open_setting(&s, NULL);
    pm__run run = progress_begin(p, 0);
    pm__cover *cover;
    pm_error error;
    for (size_t i = 0; i < p->progression.points; i++) {
        double u[1];
        pm__random_uniform(5, PM__FOR_TESTS, 0, i, u, 1);
        const double radius = i % 97 == 0 ? 2.0 : i % 89 == 0 ? 0.0 : 0.001 * pow(200.0, u[0]);
        run.state[i * pm__progressive_of(&run)->fields] = radius * radius; /* as shrink.h has it */
    }
    PM_CHECK_OK(pm__cover_make(&run, &cover, &error), error);
    for (size_t i = 0; i < 4000; i++) {
        const size_t point = i % p->progression.points;
        double u[3];
        float at[3];
        pm__random_uniform(5, PM__FOR_TESTS, 1, i, u, 3);
        for (int a = 0; a < 3; a++) {
            const float *const centre = cover->now[point].position;
            const float rim = centre[a] + (a == (int)(i % 3) ? cover->now[point].radius : 0.0f);
            at[a] = i % 2 ? rim : (float)(3.0 * u[a] - 1.5);
        }
        check_listed(&run, cover, at);
    }
    check_listed(&run, cover, (float[3]){INFINITY, 0.0f, 0.0f});
    pm__cover_free(cover);
    pm__cover_free(NULL);
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

/* No radius, no surface: nothing is looked up, and passes go on. */
START_TEST(nothing_to_find)
{
    const setting s = {"scene:cornell", "ppm", "disc", 0.05, true};
    progress *const p = open_setting(&s, NULL);
    pm__run run = progress_begin(p, 0);
    const size_t fields = pm__progressive_of(&run)->fields;
    for (size_t i = 0; i < p->progression.points; i++)
        run.state[i * fields] = 0.0;
    progress_pass(&run, 2);
    for (size_t i = 0; i < p->progression.points; i++)
        ck_assert_double_eq(pm__run_view(&run, i).count, 0.0);
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

PM_TEST_MAIN("splat", as_by_a_search, states_are_taken_up_again, threads_change_nothing,
             all_that_may_be_found_is_listed, nothing_to_find)
