/* Where fixed points lie (cover.h), and when photons shall find them (choice.c). */
#include "../progress.h"

#include "../../src/methods/progressive/cover.h"

/* ---- What is listed ---------------------------------------------------------------------------- */

static double uniform(uint32_t which, size_t i)
{
    double u[1];
    pm__random_uniform(5, PM__FOR_TESTS, which, i, u, 1);
    return u[0];
}

static progress *create_room(void)
{
    progress *const p = progress_create("scene:cornell", "ppm", "disc", 0.05);
    p->config.width = p->config.height = 20;
    return p;
}

static void set_radius(pm__run *run, size_t point, double radius)
{
    run->state[point * pm__progressive_of(run)->fields] = radius * radius; /* as shrink.h has it */
}

static pm__cover *make_cover(const pm__run *run)
{
    pm__cover *cover;
    pm_error error = {""};
    PM_CHECK_OK(pm__cover_make(run, &cover, &error), error);
    return cover;
}

/* Each point within its radius of a photon is listed in the photon's cell, with a radius that reaches it, and points
 * ascend. */
static void check_listed(const pm__run *run, const pm__cover *cover, const float position[3])
{
    float within[3];
    const size_t cell = pm__cover_cell(cover, position, within);
    const size_t from = cell == SIZE_MAX ? 0 : cover->starts[cell], to = cell == SIZE_MAX ? 0 : cover->starts[cell + 1];
    for (size_t i = 0; i < run->of->points; i++) {
        double d2 = 0.0;
        bool found = false, ascend = true;
        for (int a = 0; a < 3; a++) {
            const double d = (double)position[a] - (double)(float)run->of->fixed[i].position[a];
            d2 += d * d;
        }
        if (!(d2 <= (double)cover->built[i] * (double)cover->built[i]) || !(cover->built[i] > 0.0f))
            continue;
        for (size_t e = from; e < to; e++) {
            const pm__listed *const entry = &cover->listed[e];
            double steps2 = 0.0;
            for (int a = 0; a < 3; a++)
                steps2 += pow((double)within[a] - entry->position[a], 2.0);
            ascend = ascend && (e == from || entry[-1].point < entry->point);
            found = found || (entry->point == i && steps2 <= (double)entry->radius * entry->radius);
        }
        if (!found || !ascend) /* Check notes down each assertion, and these are many */
            ck_abort_msg("point %zu, %g of %g m off, is not listed%s", i, sqrt(d2), (double)cover->built[i],
                         ascend ? "" : " in order");
    }
}

/* Photons at rims and anywhere about the middle. */
static void check_places(const pm__run *run, const pm__cover *cover, const double middle[3], double size)
{
    for (size_t i = 0; i < 4000; i++) {
        const pm__hit_point *const point = &run->of->fixed[i % run->of->points];
        const float rim = cover->built[i % run->of->points];
        double u[3];
        float at[3];
        pm__random_uniform(5, PM__FOR_TESTS, 1, i, u, 3);
        for (int a = 0; a < 3; a++)
            at[a] = i % 2 ? (float)point->position[a] + (a == (int)(i % 3) ? rim : 0.0f)
                          : (float)(middle[a] + size * (u[a] - 0.5));
        check_listed(run, cover, at);
    }
    check_listed(run, cover, (float[3]){INFINITY, 0.0f, 0.0f});
    check_listed(run, cover, (float[3]){0.0f, NAN, 0.0f});
}

/* Radii from a thousandth of the room to all of it, side by side; far from the origin too, where positions in single
 * precision are a radius off those in double. */
START_TEST(all_that_may_be_found_is_listed)
{
    static const double far_off[] = {0.0, 3000.0, -3e7};
    for (size_t f = 0; f < 3; f++) {
        progress *const p = progress_open(create_room());
        pm__run run = progress_begin(p, 0);
        for (size_t i = 0; i < p->progression.points; i++) {
            set_radius(&run, i, i % 97 == 0 ? 2.0 : i % 89 == 0 ? 0.0 : 0.0001 * pow(2000.0, uniform(0, i)));
            for (int a = 0; a < 3; a++)
                p->progression.fixed[i].position[a] += far_off[f];
        }
        pm__cover *const cover = make_cover(&run);
        ck_assert_ptr_nonnull(cover);
        check_places(&run, cover, (double[3]){far_off[f], far_off[f], far_off[f]}, 3.0 + 1e-6 * fabs(far_off[f]));
        pm__cover_free(cover);
        pm__run_end(&run);
        progress_free(p);
    }
    pm__cover_free(NULL);
}
END_TEST

/* Rooms of 1e-15 and 1e15 m: cells follow. */
START_TEST(scales_change_nothing)
{
    for (int exponent = -50; exponent <= 50; exponent += 50) {
        progress *const p = progress_open(create_room());
        pm__run run = progress_begin(p, 0);
        for (size_t i = 0; i < p->progression.points; i++) {
            set_radius(&run, i, ldexp(0.05, exponent));
            for (int a = 0; a < 3; a++)
                p->progression.fixed[i].position[a] = ldexp(p->progression.fixed[i].position[a], exponent);
        }
        pm__cover *const cover = make_cover(&run);
        ck_assert_ptr_nonnull(cover);
        check_places(&run, cover, (double[3]){0.0}, ldexp(3.0, exponent));
        for (size_t i = 0; i < p->progression.points; i++) {
            ck_assert_float_le(cover->now[i].radius, 1.0f);
            ck_assert(!p->progression.fixed[i].material || cover->now[i].most2 > 1e-6f);
        }
        pm__cover_free(cover);
        pm__run_end(&run);
        progress_free(p);
    }
}
END_TEST

/* Nobody looks up is one thing, radii beyond all measure another: of these points look up, and say what is wrong. */
START_TEST(no_radius_and_no_cover)
{
    progress *const p = progress_open(create_room());
    pm__run run = progress_begin(p, 0);
    pm_error error = {""};
    for (size_t i = 0; i < p->progression.points; i++)
        set_radius(&run, i, 0.0);
    pm__cover *const empty = make_cover(&run);
    ck_assert(empty && !empty->listed);
    pm__cover_free(empty);
    set_radius(&run, 3, INFINITY);
    ck_assert_ptr_null(make_cover(&run));
    ck_assert(p->progression.meeting.by_photons);
    ck_assert_int_eq((int)pm__run_pass(&run, &error), (int)PM_EINVAL);
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

/* Entries may be as many as 32 bits count; cells are made larger before they are. */
START_TEST(lists_are_bounded)
{
    progress *const p = progress_open(create_room());
    pm__run run = progress_begin(p, 0);
    for (size_t i = 0; i < p->progression.points; i++)
        set_radius(&run, i, i == 77 ? 1e6 : i % 2 ? 1e-6 : 0.3);
    pm__cover *const cover = make_cover(&run);
    ck_assert_ptr_nonnull(cover);
    const size_t cells = cover->cells[0] * cover->cells[1] * cover->cells[2];
    ck_assert_uint_le(cells, 32 * p->progression.points);
    ck_assert_uint_le(cover->starts[cells], 27 * p->progression.points);
    pm__cover_free(cover);
    pm__run_end(&run);
    progress_free(p);
}
END_TEST

/* ---- The choice -------------------------------------------------------------------------------- */

static bool chosen(progress *p)
{
    const bool by_photons = progress_open(p)->progression.meeting.by_photons;
    progress_free(p);
    return by_photons;
}

static progress *create_choice(const char *method, size_t side, size_t k)
{
    progress *const p = progress_create("scene:furnace", method, "disc", 0.0);
    p->config.width = p->config.height = side;
    p->config.k = k;
    return p;
}

/* Points whose first radius is that of their k nearest photons find k of the pass's each: of S photons stored one finds
 * k points / S of them. In the furnace of albedo a photons are stored 1 / (1 - a) times on average; here once for each
 * of at least 2000 emitted, and 4 times at most. */
START_TEST(chosen_by_points_a_photon)
{
    ck_assert(chosen(create_choice("ppm", 8, 10)));    /* 0.3 at most */
    ck_assert(chosen(create_choice("ppm", 20, 14)));   /* 2.8 at most */
    ck_assert(!chosen(create_choice("ppm", 20, 200))); /* 10 at least */
    ck_assert(!chosen(create_choice("ppm", 80, 20)));  /* 16 at least; of these points some are asked */
}
END_TEST

/* Photons lie evenly on the furnace's wall, a sphere of 1 m, of which a ball of radius r about a point of it holds
 * pi r^2: a photon finds points r^2 / 4. */
START_TEST(given_radii_too)
{
    static const double radii[] = {0.05, 0.155, 0.2};
    static const bool wanted[] = {true, true, false}; /* 0.25, 2.4, 4 */
    for (size_t i = 0; i < 3; i++) {
        progress *const p = create_choice("ppm", 20, 10);
        p->config.radius = radii[i];
        ck_assert_int_eq(chosen(p), wanted[i]);
    }
}
END_TEST

/* Only where sums at points that stay are all that is wanted, and nobody has named a search. */
START_TEST(others_look_up)
{
    static const char *const methods[] = {"sppm", "pppm", "appm", "pm", "pm-average", "pm-combine"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
        ck_assert(!chosen(create_choice(methods[i], 8, 10)));
    progress *const named = create_choice("ppm", 8, 10), *const estimated = create_choice("ppm", 8, 10);
    named->config.search = pm_search_find("grid");
    estimated->config.estimates = true;
    ck_assert(!chosen(named));
    ck_assert(chosen(estimated)); /* no bit of an answer depends on that */
}
END_TEST

PM_TEST_MAIN("cover", all_that_may_be_found_is_listed, scales_change_nothing, no_radius_and_no_cover,
             lists_are_bounded, chosen_by_points_a_photon, given_radii_too, others_look_up)
