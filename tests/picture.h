/* Renders for tests: configurations from words, scenes built by hand, threads that are not the program's. */
#ifndef PM_TESTS_PICTURE_H
#define PM_TESTS_PICTURE_H

#include "../cases/scenes/list.h"
#include "../src/lookup/lookup.h"
#include "../src/methods/list.h"
#include "lit.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

/* ---- Threads ----------------------------------------------------------------------------------- */

typedef struct picture_work {
    void (*task)(void *argument, size_t index);
    void *argument;
    size_t count;
    atomic_size_t next;
} picture_work;

static inline void *picture_thread(void *argument)
{
    picture_work *const work = argument;
    for (size_t i = atomic_fetch_add(&work->next, 1); i < work->count; i = atomic_fetch_add(&work->next, 1))
        work->task(work->argument, i);
    return NULL;
}

/* A parallel-for on two threads. */
static inline void picture_run(void *context, size_t count, void (*task)(void *argument, size_t index),
                               void *argument)
{
    (void)context;
    picture_work work = {.task = task, .argument = argument, .count = count};
    pthread_t other;
    ck_assert_int_eq(pthread_create(&other, NULL, picture_thread, &work), 0);
    (void)picture_thread(&work);
    ck_assert_int_eq(pthread_join(other, NULL), 0);
}

static const pm_parallel picture_two_threads = {.run = picture_run};

/* ---- Configurations ---------------------------------------------------------------------------- */

enum { PICTURE_ESTIMATORS = 24 };

typedef struct picture {
    pm__spec scene, method;
    pm_estimator *estimators[PICTURE_ESTIMATORS];
    pm__render_config config;
} picture;

static inline void picture_free(picture *p)
{
    for (size_t i = 0; i < p->config.estimator_count; i++)
        pm_estimator_destroy(p->estimators[i]);
    free(p);
}

/* A small image by those estimators (a comma list). A scene built by hand: NULL, and then scene->entry is set. */
static inline picture *picture_create(const char *scene, const char *method, const char *estimators)
{
    picture *const p = calloc(1, sizeof *p);
    pm__spec *specs = NULL;
    size_t count = 0;
    pm_error error = {""};
    ck_assert_ptr_nonnull(p);
    if (scene)
        PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, scene, &p->scene, &error), error);
    PM_CHECK_OK(pm__spec_parse(&pm__methods, method, &p->method, &error), error);
    PM_CHECK_OK(pm__spec_parse_list(&pm__estimators, estimators, &specs, &count, &error), error);
    ck_assert_uint_le(count, PICTURE_ESTIMATORS);
    for (size_t i = 0; i < count; i++) {
        char name[PM__MAX_SPEC];
        pm__spec_format(&specs[i], name, sizeof name);
        PM_CHECK_OK(pm_estimator_create(name, &p->estimators[i], &error), error);
    }
    free(specs);
    p->config = (pm__render_config){.scene = &p->scene,
                                    .method = &p->method,
                                    .estimators = (const pm_estimator *const *)p->estimators,
                                    .estimator_count = count,
                                    .k = 40,
                                    .radius = (double)INFINITY,
                                    .lookup = {PM_LOOKUP_SPHERE, 0.0, true},
                                    .photons = 5000,
                                    .width = 24,
                                    .height = 20,
                                    .spp = 2,
                                    .trials = 1,
                                    .seed = 1};
    return p;
}

static inline picture *picture_of(const pm__case *scene, const char *method, const char *estimators)
{
    picture *const p = picture_create(NULL, method, estimators);
    pm__spec_default(&scene->entry, &p->scene);
    return p;
}

static inline pm__render_result picture_render(const picture *p)
{
    pm_error error = {""};
    pm__render_result result;
    PM_CHECK_OK(pm__render(&p->config, &result, &error), error);
    return result;
}

static inline pm__plan picture_plan(const picture *p)
{
    pm_error error = {""};
    pm__plan plan;
    PM_CHECK_OK(pm__render_plan(&p->config, &plan, &error), error);
    return plan;
}

/* Plan and render are refused alike, with `part` in what is said. */
static inline void picture_refused(const picture *p, const char *part)
{
    pm_error error = {""};
    pm__plan plan;
    pm__render_result result;
    ck_assert_int_eq(pm__render_plan(&p->config, &plan, &error), PM_EINVAL);
    ck_assert_msg(strstr(error.text, part), "\"%s\" does not say \"%s\"", error.text, part);
    error.text[0] = 0;
    ck_assert_int_eq(pm__render(&p->config, &result, &error), PM_EINVAL);
    ck_assert_msg(strstr(error.text, part), "\"%s\" does not say \"%s\"", error.text, part);
    ck_assert_uint_eq(result.count, 0);
    pm__render_free(&result);
}

static inline bool picture_step(const pm__plan *plan, const char *name)
{
    for (size_t i = 0; i < plan->count; i++)
        if (strcmp(plan->steps[i].name, name) == 0)
            return plan->steps[i].done;
    ck_abort_msg("the plan has no step %s", name);
    return false;
}

/* Mean radiance of an image in a band. */
static inline double picture_mean(const pm__image *image, int band)
{
    double sum = 0.0;
    for (size_t p = 0; p < image->width * image->height; p++)
        sum += (double)image->values[3 * p + (size_t)band];
    return sum / (double)(image->width * image->height);
}

static inline bool picture_same(const pm__image *a, const pm__image *b)
{
    const size_t bytes = a->width * a->height * (size_t)a->channels * sizeof *a->values;
    if (a->width != b->width || a->height != b->height || a->channels != b->channels)
        return false;
    return !bytes || memcmp(a->values, b->values, bytes) == 0;
}

#endif
