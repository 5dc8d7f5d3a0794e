/* Renders: the same for any threads and beside any other estimator, what is refused, what an interruption leaves. */
#include "../picture.h"

#include "../../src/image/reference.h"

#include <string.h>

#define KINDS "disc,disc:last=none,cone:k=1.1,cone:k=2,gaussian,epanechnikov,biweight,hull,differential," \
    "combined:deal=separate,combined:deal=random,combined:deal=roundrobin,combined:maps=3,rule=mean," \
    "precomputed,precomputed:form=unbiased"

/* ---- A stored reference, in place of the program's --------------------------------------------- */

static pm__image stored; /* width 0: there is none */
const pm__reference_row pm__references[] = {{0}};

bool pm__reference_exists(const char *scene)
{
    return stored.width && strcmp(scene, "cornell") == 0;
}

pm_status pm__reference_load(const char *scene, pm__reference *reference, pm_error *error)
{
    *reference = (pm__reference){0};
    ck_assert(pm__reference_exists(scene));
    const pm_status status = pm__image_create(stored.width, stored.height, 3, &reference->radiance, error);
    memcpy(reference->radiance.values, stored.values, 3 * stored.width * stored.height * sizeof *stored.values);
    return status;
}

pm_status pm__reference_load_from(const pm__reference_row *table, const char *scene, pm__reference *reference,
                                  pm_error *error)
{
    (void)table;
    return pm__reference_load(scene, reference, error);
}

void pm__reference_free(pm__reference *reference)
{
    pm__image_free(&reference->radiance);
    pm__image_free(&reference->error);
}

/* ---- Sameness ---------------------------------------------------------------------------------- */

static void same_images(const pm__render_images *a, const pm__render_images *b, const char *what)
{
    const pm__image *const one[] = {&a->radiance, &a->truth, &a->error, &a->bias, &a->noise, &a->radius, &a->count};
    const pm__image *const other[] = {&b->radiance, &b->truth, &b->error, &b->bias, &b->noise, &b->radius, &b->count};
    for (size_t i = 0; i < sizeof one / sizeof *one; i++)
        ck_assert_msg(picture_same(one[i], other[i]), "%s: image %zu differs", what, i);
}

static const char *const scenes[] = {"scene:water", "scene:glossy-plane", "scene:cornell"};
enum { SCENES = sizeof scenes / sizeof *scenes };

static const char *const methods[] = {"visualize", "visualize:map=caustic", "full:gather=2", "full:direct=photons",
                                      "path"};

START_TEST(any_threads_give_the_same)
{
    for (size_t s = 0; s < SCENES; s++)
        for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
            if (m == 1 && s == 1)
                continue; /* no mirror and no glass */
            picture *const p = picture_create(scenes[s], methods[m], "disc,hull,combined,precomputed");
            p->config.photons = 2000;
            p->config.k = 15;
            p->config.aov = true;
            p->config.trials = 2;
            p->config.spp = 1;
            pm__render_result one = picture_render(p);
            p->config.parallel = &picture_two_threads;
            pm__render_result two = picture_render(p);
            ck_assert_uint_eq(one.count, two.count);
            ck_assert_uint_eq(one.emitted, two.emitted);
            ck_assert_uint_eq(one.stored, two.stored);
            for (size_t i = 0; i < one.count; i++)
                same_images(&one.images[i], &two.images[i], methods[m]);
            pm__render_free(&one);
            pm__render_free(&two);
            picture_free(p);
        }
}
END_TEST

/* All kinds of estimators in one render, and each alone. */
static void check_together(const char *scene, const char *method, size_t k, double radius)
{
    picture *const all = picture_create(scene, method, KINDS);
    all->config.photons = 3000;
    all->config.k = k;
    all->config.radius = radius;
    all->config.aov = true;
    all->config.trials = 2;
    all->config.spp = 1;
    pm__render_result together = picture_render(all);
    ck_assert_uint_eq(together.count, all->config.estimator_count);
    for (size_t i = 0; i < together.count; i++) {
        pm__render_config config = all->config;
        pm_error error = {""};
        pm__render_result alone;
        config.estimators += i;
        config.estimator_count = 1;
        PM_CHECK_OK(pm__render(&config, &alone, &error), error);
        same_images(&together.images[i], &alone.images[0], pm_estimator_name(all->estimators[i]));
        if (strcmp(method, "visualize") == 0)
            ck_assert_double_gt(picture_mean(&alone.images[0].radiance, 1), 0.0);
        pm__render_free(&alone);
    }
    pm__render_free(&together);
    picture_free(all);
}

START_TEST(estimators_do_not_see_each_other)
{
    for (size_t s = 0; s < SCENES; s++)
        check_together(scenes[s], "visualize", 33, INFINITY);
    check_together("scene:glossy-plane", "visualize", 0, 0.1);
    check_together("scene:cornell", "visualize", 40, 0.1);
    check_together("scene:cornell", "full:gather=1", 24, INFINITY);
}
END_TEST

/* Count is k wherever an estimate is made, its radius above 0; elsewhere both are 0. */
START_TEST(radius_and_count)
{
    picture *const p = picture_create("scene:glossy-plane", "visualize", "disc,hull,combined:maps=4,precomputed");
    p->config.aov = true;
    p->config.spp = 1;
    pm__render_result result = picture_render(p);
    for (size_t i = 0; i < result.count; i++) {
        const pm__render_images *const images = &result.images[i];
        size_t made = 0;
        for (size_t at = 0; at < p->config.width * p->config.height; at++) {
            const double count = (double)images->count.values[at], radius = (double)images->radius.values[at];
            const bool seen = images->truth.values[3 * at] > 0.0f;
            made += count > 0.0;
            ck_assert_msg(count == (seen ? (double)p->config.k : 0.0), "count %g", count);
            ck_assert(seen ? radius > 0.0 && radius < 0.5 : radius <= 0.0);
        }
        ck_assert_uint_gt(made, 50);
    }
    pm__render_free(&result);
    picture_free(p);
}
END_TEST

/* ---- Refusals ---------------------------------------------------------------------------------- */

static void refused_by(const char *scene, const char *method, const char *estimators, size_t k, const char *part)
{
    picture *const p = picture_create(scene, method, estimators);
    p->config.k = k;
    picture_refused(p, part);
    picture_free(p);
}

START_TEST(what_is_refused)
{
    refused_by("scene:water", "visualize", "disc", 0, "neither k nor a radius");
    refused_by("scene:water", "full", "disc", 0, "neither k nor a radius");
    refused_by("scene:water", "visualize", "oracle", 40, "oracle knows the truth");
    refused_by("scene:water", "visualize", "disc,combined:maps=8", 23, "--k 23 is too few for combined: at least 24");
    refused_by("scene:water", "full", "combined:maps=8", 23, "--k 23 is too few");
    refused_by("scene:water", "visualize", "disc,hull", 2, "--k 2 is too few for hull");
    refused_by("scene:cornell", "visualize:map=exact", "disc", 40, "has no exact answer");
    picture *const p = picture_create("scene:water", "visualize", "disc");
    const pm_estimator *many[PM__MOST_IMAGES + 1];
    for (size_t i = 0; i <= PM__MOST_IMAGES; i++)
        many[i] = p->estimators[0];
    pm__render_config good = p->config;
    p->config.estimators = many;
    p->config.estimator_count = PM__MOST_IMAGES + 1;
    picture_refused(p, "65 estimators: at most 64");
    p->config = good;
    p->config.spp = 0;
    picture_refused(p, "neither samples nor seconds");
    p->config = good;
    p->config.trials = 0;
    picture_refused(p, "no trials");
    p->config = good;
    p->config.width = 0;
    picture_refused(p, "0 x 20 pixels");
    p->config = good;
    p->config.k = 0;
    p->config.radius = 0.1;
    (void)picture_plan(p);
    p->config = good;
    picture_free(p);
    picture *const full = picture_create("scene:water", "full", "disc");
    full->config.k = 0;
    full->config.radius = 0.1;
    picture_refused(full, "needs --k");
    picture_free(full);
    picture *const path = picture_create("scene:water", "path", "oracle"); /* estimators do not matter to it */
    (void)picture_plan(path);
    picture_free(path);
}
END_TEST

/* ---- References -------------------------------------------------------------------------------- */

static pm__image gray(size_t width, size_t height)
{
    pm_error error;
    pm__image image;
    PM_CHECK_OK(pm__image_create(width, height, 3, &image, &error), error);
    for (size_t i = 0; i < 3 * width * height; i++)
        image.values[i] = 0.25f;
    return image;
}

/* A reference that does not fit is no truth, and the result says so; nor is one of another view. */
START_TEST(references_must_fit)
{
    static const size_t sizes[][2] = {{48, 40}, {24, 10}, {5, 20}, {12, 20}, {7, 5}};
    picture *const p = picture_create("scene:cornell", "path", "disc");
    const pm__view other = {.eye = {0, -1.5, 0.5}, .at = {0, 0, 0.5}, .up = {0, 0, 1}, .angle = 0.7};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        stored = gray(sizes[i][0], sizes[i][1]);
        p->config.aov = true;
        (void)picture_plan(p);
        pm__render_result result;
        pm_error error = {""};
        p->config.spp = 1;
        PM_CHECK_OK(pm__render(&p->config, &result, &error), error);
        ck_assert(result.misfit && !result.truth && !result.images[0].truth.values);
        pm__render_free(&result);
        p->config.view = &other; /* it is not of this view */
        PM_CHECK_OK(pm__render(&p->config, &result, &error), error);
        ck_assert(!result.misfit && !result.truth);
        pm__render_free(&result);
        p->config.view = NULL;
        pm__image_free(&stored);
    }
    p->config.aov = true;
    (void)picture_plan(p);
    picture_free(p);
}
END_TEST

START_TEST(a_reference_of_half_the_size_judges_blocks)
{
    picture *const p = picture_create("scene:cornell", "path", "disc");
    stored = gray(12, 10);
    p->config.aov = true;
    pm__render_result result = picture_render(p);
    ck_assert_str_eq(result.truth, "reference");
    const pm__render_images *const images = &result.images[0];
    ck_assert_uint_eq(images->radiance.width, 24);
    ck_assert_uint_eq(images->error.width, 12);
    ck_assert_uint_eq(images->error.height, 10);
    for (size_t at = 0; at < 120; at++)
        for (size_t b = 0; b < 3; b++) {
            double mean = 0.0;
            for (size_t i = 0; i < 4; i++) {
                const size_t y = at / 12 * 2 + i / 2, x = at % 12 * 2 + i % 2;
                mean += 0.25 * (double)images->radiance.values[3 * (y * 24 + x) + b];
            }
            PM_CHECK_NEAR((double)images->error.values[3 * at + b], (mean - 0.25) / 0.25, 1e-5 * (1.0 + mean));
        }
    pm__render_free(&result);
    picture_free(p);
    /* direct light alone is not what the reference shows */
    picture *const direct = picture_create("scene:cornell", "visualize:map=direct", "disc");
    direct->config.aov = true;
    result = picture_render(direct);
    ck_assert_ptr_null(result.truth);
    pm__render_free(&result);
    picture_free(direct);
    pm__image_free(&stored);
}
END_TEST

/* ---- Interruption and time --------------------------------------------------------------------- */

typedef struct patience {
    atomic_int left; /* questions until it is canceled */
} patience;

static bool out_of_patience(void *context)
{
    return atomic_fetch_sub(&((patience *)context)->left, 1) <= 0;
}

/* However soon it is canceled: finite images, of the tiles that came. */
START_TEST(what_an_interruption_leaves)
{
    bool some = false, begun = false;
    for (int after = 0; after < 60; after += 3) {
        picture *const p = picture_create("scene:cornell", "visualize", "disc,hull");
        patience left;
        atomic_init(&left.left, after);
        p->config.photons = 2000;
        p->config.width = p->config.height = 40;
        p->config.aov = true;
        p->config.trials = 3;
        p->config.canceled = out_of_patience;
        p->config.context = &left;
        pm__render_result result = picture_render(p);
        ck_assert_uint_eq(result.count, 2);
        for (size_t i = 0; i < result.count; i++)
            for (size_t at = 0; at < 3 * 1600; at++)
                ck_assert(isfinite((double)result.images[i].radiance.values[at]));
        ck_assert_uint_ge(result.trials, 1);
        ck_assert_uint_le(result.passes, p->config.spp);
        ck_assert(result.interrupted || result.trials == 3);
        const double mean = picture_mean(&result.images[0].radiance, 0);
        begun = begun || (result.interrupted && mean <= 0.0);
        some = some || (result.interrupted && result.passes == 0 && mean > 0.0);
        pm__render_free(&result);
        picture_free(p);
    }
    ck_assert(begun && some);
}
END_TEST

/* By the clock: at least one pass, more in more time, no more than asked for; a tile that was cut does not darken. */
START_TEST(passes_by_the_clock)
{
    picture *const p = picture_create("scene:rect-light", "path", "disc");
    p->config.width = p->config.height = 16;
    p->config.spp = 0;
    p->config.seconds = 1e-9;
    pm__render_result result = picture_render(p);
    ck_assert_uint_eq(result.passes, 1);
    ck_assert(!result.interrupted);
    pm__render_free(&result);
    p->config.seconds = 0.3;
    result = picture_render(p);
    const size_t passes = result.passes;
    ck_assert_uint_gt(passes, 1);
    pm__render_free(&result);
    p->config.spp = 3;
    p->config.seconds = 1e6;
    result = picture_render(p);
    ck_assert_uint_eq(result.passes, 3);
    pm__render_free(&result);
    picture_free(p);
}
END_TEST

PM_TEST_MAIN("render", any_threads_give_the_same, estimators_do_not_see_each_other, radius_and_count, what_is_refused,
             references_must_fit, a_reference_of_half_the_size_judges_blocks, what_an_interruption_leaves,
             passes_by_the_clock)
