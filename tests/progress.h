/* Progressive runs for tests: configurations from words. */
#ifndef PM_TESTS_PROGRESS_H
#define PM_TESTS_PROGRESS_H

#include "../src/methods/progressive/list.h"
#include "picture.h"

typedef struct progress {
    pm__spec scene, method;
    pm_estimator *kernel;
    pm__progressive_config config;
    pm__progression progression;
} progress;

static inline void progress_free(progress *p)
{
    pm__progression_close(&p->progression);
    pm_estimator_destroy(p->kernel);
    free(p);
}

/* An image of 8 x 6 points, 2000 photons a pass, k = 10, alpha = 2/3, photons of both sides; radius: m, of the first
 * lookup, 0: by k photons. To be opened once what differs has been set. */
static inline progress *progress_create(const char *scene, const char *method, const char *kernel, double radius)
{
    progress *const p = calloc(1, sizeof *p);
    pm_error error = {""};
    ck_assert_ptr_nonnull(p);
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, scene, &p->scene, &error), error);
    PM_CHECK_OK(pm__spec_parse(&pm__progressives, method, &p->method, &error), error);
    PM_CHECK_OK(pm_estimator_create(kernel, &p->kernel, &error), error);
    p->config = (pm__progressive_config){.scene = &p->scene, .width = 8, .height = 6, .method = &p->method,
                                         .estimator = p->kernel, .alpha = 2.0 / 3.0, .radius = radius, .k = 10,
                                         .photons = 2000, .seed = 1};
    return p;
}

static inline progress *progress_open(progress *p)
{
    pm_error error = {""};
    PM_CHECK_OK(pm__progression_open(&p->config, &p->progression, &error), error);
    return p;
}

static inline pm__run progress_begin(const progress *p, uint32_t trial)
{
    pm_error error = {""};
    pm__run run;
    PM_CHECK_OK(pm__run_begin(&p->progression, trial, &run, &error), error);
    return run;
}

static inline void progress_pass(pm__run *run, uint32_t passes)
{
    pm_error error = {""};
    for (uint32_t i = 0; i < passes; i++)
        PM_CHECK_OK(pm__run_pass(run, &error), error);
}

/* The answer at every point; the caller frees it. */
static inline double (*progress_read(pm__run *run))[3]
{
    pm_error error = {""};
    double(*const radiance)[3] = malloc(run->of->points * sizeof *radiance);
    ck_assert_ptr_nonnull(radiance);
    PM_CHECK_OK(pm__run_read(run, radiance, &error), error);
    return radiance;
}

/* Mean over points of the answer. */
static inline double progress_mean(pm__run *run)
{
    double(*const radiance)[3] = progress_read(run);
    double sum = 0.0;
    for (size_t i = 0; i < run->of->points; i++)
        sum += radiance[i][0] / (double)run->of->points;
    free(radiance);
    return sum;
}

/* Squared radius of the next lookup at a point, and its mean over points. */
static inline double progress_radius2_of(const pm__run *run, size_t point)
{
    const double radius = pm__run_view(run, point).radius;
    return radius * radius;
}

static inline double progress_radius2(const pm__run *run)
{
    double sum = 0.0;
    for (size_t i = 0; i < run->of->points; i++)
        sum += progress_radius2_of(run, i) / (double)run->of->points;
    return sum;
}

#endif
