/* What answers are measured by. */
#include "measure.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../methods/film.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 64 }; /* of one task */

/* Samples of pixels that only the truth has. */
#define TRUTH_SEED 0x7472757468ull

static const pm__progressive *method_of(const pm__progression *p)
{
    return (const pm__progressive *)(const void *)p->config->method->entry;
}

void pm__point_truth(const pm__progression *progression, const pm__hit_point *point, double radiance[3])
{
    double brdf[3], sent[3] = {0.0, 0.0, 0.0};
    if (point->material) {
        const bool even = point->material->kind == PM__DIFFUSE;
        if (even)
            pm__hit_point_brdf(point, point->normal, brdf);
        pm__stage_truth(&progression->stage, point->position, point->normal, point->outgoing, even ? brdf : NULL, sent);
    }
    for (int b = 0; b < 3; b++)
        radiance[b] = point->emitted[b] + (point->material ? point->weight[b] * sent[b] : 0.0);
}

/* ---- Exact ------------------------------------------------------------------------------------- */

typedef struct truths {
    const pm__progression *of;
    double (*values)[3]; /* [points] */
} truths;

/* Ways through glass that carry less are left out of a pixel's truth. */
static const double least = 1e-6;

typedef struct pixel_truth {
    const pm__progression *of;
    double share; /* of one sample */
    double *sum;
} pixel_truth;

static void add_way(void *context, const pm__eye *eye, bool reached)
{
    const pixel_truth *const t = context;
    pm__hit_point point;
    double radiance[3];
    pm__hit_point_of(eye, reached, &point);
    pm__point_truth(t->of, &point, radiance);
    for (int b = 0; b < 3; b++)
        t->sum[b] += t->share * radiance[b];
}

static void find_pixel_truth(const pm__progression *p, size_t i, double radiance[3])
{
    pixel_truth t = {p, 1.0 / PM__PIXEL_SAMPLES, radiance};
    radiance[0] = radiance[1] = radiance[2] = 0.0;
    for (uint32_t s = 0; s < PM__PIXEL_SAMPLES; s++) {
        pm__eye eye;
        pm__run_eye(p, p->config->seed ^ TRUTH_SEED, s, i, false, &eye);
        pm__eye_follow_all(&eye, least, add_way, &t);
    }
}

static void find_truths(void *argument, size_t block)
{
    const truths *const t = argument;
    for (size_t i = block * POINTS; i < (block + 1) * POINTS && i < t->of->points; i++) {
        if (method_of(t->of)->redraws)
            find_pixel_truth(t->of, i, t->values[i]);
        else
            pm__point_truth(t->of, &t->of->fixed[i], t->values[i]);
    }
}

static bool is_known(const double value[3])
{
    return isfinite(value[0]) && isfinite(value[1]) && isfinite(value[2]);
}

static bool is_measured(const pm__progression *p, const bool *lawful, size_t i, const double truth[3])
{
    const bool seen = method_of(p)->redraws || p->fixed[i].material; /* where nothing is, nothing can be wrong */
    return seen && is_known(truth) && (!lawful || lawful[i]);
}

static pm_status take_exact(const pm__progression *p, const bool *lawful, pm__yardstick *y, pm_error *error)
{
    truths t = {.of = p, .values = pm__alloc(p->points, sizeof *t.values)};
    y->name = "exact";
    y->block = 1;
    y->truth = pm__alloc(3 * p->points, sizeof *y->truth);
    y->point = pm__alloc(p->points, sizeof *y->point);
    if (!t.values || !y->truth || !y->point) {
        free(t.values);
        return pm__fail(error, PM_ENOMEM, "out of memory for the truth of %zu points", p->points);
    }
    pm__for(p->config->parallel, (p->points + POINTS - 1) / POINTS, find_truths, &t);
    for (size_t i = 0; i < p->points; i++)
        if (is_measured(p, lawful, i, t.values[i])) {
            memcpy(&y->truth[3 * y->values], t.values[i], sizeof t.values[i]);
            y->point[y->values++] = i;
        }
    free(t.values);
    return y->values ? PM_OK
                     : pm__fail(error, PM_EINVAL, "the truth of %s is known nowhere in its image of %zux%zu points",
                                p->stage.subject->entry.name, p->config->width, p->config->height);
}

/* ---- Reference --------------------------------------------------------------------------------- */

/* Of a scene's defaults. */
static bool has_reference(const pm__spec *scene)
{
    pm__spec plain;
    pm__spec_default(scene->entry, &plain);
    return pm__reference_exists(scene->entry->name + strlen("scene:")) &&
           memcmp(plain.values, scene->values, scene->entry->param_count * sizeof *plain.values) == 0;
}

bool pm__converge_reference_size(const pm__spec *scene, size_t *width, size_t *height)
{
    const pm__case *const subject = (const pm__case *)(const void *)scene->entry;
    pm__reference reference;
    if (subject->truth || !has_reference(scene) ||
        pm__reference_load(scene->entry->name + strlen("scene:"), &reference, NULL) != PM_OK)
        return false;
    *width = reference.radiance.width;
    *height = reference.radiance.height;
    pm__reference_free(&reference);
    return true;
}

static pm_status take_blocks(const pm__progression *p, const pm__image *image, pm__yardstick *y, pm_error *error)
{
    const pm_status status = pm__reference_fits(image, p->config->width, p->config->height, error);
    if (status != PM_OK)
        return status;
    y->name = "reference";
    y->block = p->config->width / image->width;
    y->values = image->width * image->height;
    y->truth = pm__alloc(3 * y->values, sizeof *y->truth);
    y->point = pm__alloc(y->values, sizeof *y->point);
    if (!y->truth || !y->point)
        return pm__fail(error, PM_ENOMEM, "out of memory for the reference");
    for (size_t i = 0; i < y->values; i++)
        y->point[i] = (i / image->width * p->config->width + i % image->width) * y->block;
    for (size_t i = 0; i < 3 * y->values; i++)
        y->truth[i] = (double)image->values[i];
    return PM_OK;
}

static pm_status take_reference(const pm__progression *p, pm__yardstick *y, pm_error *error)
{
    const char *const name = p->stage.subject->entry.name + strlen("scene:");
    char asked[PM__MAX_SPEC];
    pm__reference reference;
    pm__spec_format_short(p->config->scene, asked, sizeof asked);
    if (!pm__reference_exists(name))
        return pm__fail(error, PM_EINVAL, "%.100s has neither an exact answer nor a stored reference", asked);
    if (p->config->view || !has_reference(p->config->scene))
        return pm__fail(error, PM_EINVAL, "%.60s has no exact answer, and the stored reference of scene:%.30s is of "
                                          "its defaults%s alone",
                        asked, name, p->config->view ? " and own view" : "");
    pm_status status = pm__reference_load(name, &reference, error);
    if (status == PM_OK)
        status = take_blocks(p, &reference.radiance, y, error);
    pm__reference_free(&reference);
    return status;
}

/* ---- Both -------------------------------------------------------------------------------------- */

pm_status pm__yardstick_create(const pm__progression *progression, const bool *lawful, pm__yardstick *yardstick,
                               pm_error *error)
{
    *yardstick = (pm__yardstick){.values = 0};
    const pm_status status = progression->stage.subject->truth
                                 ? take_exact(progression, lawful, yardstick, error)
                                 : take_reference(progression, yardstick, error);
    if (status != PM_OK) {
        pm__yardstick_destroy(yardstick);
        return status;
    }
    for (size_t i = 0; i < 3 * yardstick->values; i++)
        yardstick->truth_mean += fabs(yardstick->truth[i]) / (3.0 * (double)yardstick->values);
    if (yardstick->truth_mean > 0.0)
        return PM_OK;
    pm__yardstick_destroy(yardstick);
    return pm__fail(error, PM_EINVAL, "the image of %s is black where its truth is known: there is no relative error",
                    progression->stage.subject->entry.name);
}

void pm__yardstick_destroy(pm__yardstick *yardstick)
{
    free(yardstick->truth);
    free(yardstick->point);
    *yardstick = (pm__yardstick){.values = 0};
}

void pm__yardstick_measure(const pm__yardstick *yardstick, size_t width, const double (*radiance)[3], float *e)
{
    const size_t block = yardstick->block;
    for (size_t i = 0; i < yardstick->values; i++)
        for (int b = 0; b < 3; b++) {
            double sum = 0.0;
            for (size_t y = 0; y < block; y++)
                for (size_t x = 0; x < block; x++)
                    sum += radiance[yardstick->point[i] + y * width + x][b];
            const size_t at = 3 * i + (size_t)b;
            e[at] = (float)(sum / (double)(block * block) - yardstick->truth[at]);
        }
}
