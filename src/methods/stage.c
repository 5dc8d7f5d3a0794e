#include "stage.h"

#include <math.h>
#include <string.h>

/* From a point inside a solid of opaque walls every ray meets the back of one. */
static bool is_in_wall(const pm__scene *scene, const double eye[3])
{
    for (int i = 0; i < 6; i++) {
        double direction[3] = {0.0, 0.0, 0.0};
        pm__hit hit;
        direction[i / 2] = i % 2 ? -1.0 : 1.0;
        if (!pm__scene_intersect(scene, eye, direction, INFINITY, PM__NO_SHAPE, &hit))
            return false;
        const bool opaque = hit.material->kind != PM__GLASS;
        if (!opaque || pm__dot(direction, hit.normal) <= 0.0)
            return false;
    }
    return true;
}

static pm_status make_camera(pm__stage *stage, const pm__view *view, size_t width, size_t height, pm_error *error)
{
    pm__view own;
    if (view)
        own = *view;
    else
        stage->subject->view(stage->values, &own);
    const pm_status status = pm__camera_init(&own, width, height, &stage->camera, error);
    if (status == PM_OK && is_in_wall(stage->scene, own.eye))
        return pm__fail(error, PM_EINVAL, "the camera at (%g, %g, %g) stands inside a wall", own.eye[0], own.eye[1],
                        own.eye[2]);
    return status;
}

pm_status pm__stage_open(const pm__spec *spec, const pm__view *view, size_t width, size_t height, pm__stage *stage,
                         pm_error *error)
{
    *stage = (pm__stage){.subject = (const pm__case *)(const void *)spec->entry, .values = spec->values};
    pm_status status = pm__scene_create(&stage->scene, error);
    if (status == PM_OK)
        status = stage->subject->build(stage->values, stage->scene, error);
    if (status == PM_OK)
        status = pm__scene_commit(stage->scene, error);
    if (status == PM_OK)
        status = make_camera(stage, view, width, height, error);
    if (status != PM_OK)
        pm__stage_close(stage);
    return status;
}

void pm__stage_close(pm__stage *stage)
{
    pm__scene_destroy(stage->scene);
    stage->scene = NULL;
}

void pm__stage_truth(const pm__stage *stage, const double position[3], const double normal[3],
                     const double outgoing[3], const double *brdf, double radiance[3])
{
    const pm__case *const subject = stage->subject;
    pm__probe probe;
    memcpy(probe.position, position, sizeof probe.position);
    memcpy(probe.normal, normal, sizeof probe.normal);
    memcpy(probe.outgoing, outgoing, sizeof probe.outgoing);
    radiance[0] = radiance[1] = radiance[2] = subject->truth(stage->values, &probe);
    if (subject->truth_bands)
        subject->truth_bands(stage->values, &probe, radiance);
    for (int b = 0; b < 3 && !subject->brdf; b++) /* with one the truth is radiance already */
        radiance[b] = brdf ? brdf[b] * radiance[b] : NAN;
}
