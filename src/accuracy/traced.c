/* The scenes of traced cases. */
#include "bench.h"

pm_status pm__job_scene(pm__job *job, pm_error *error)
{
    if (!pm__is_traced(job->subject))
        return PM_OK;
    pm_status status = pm__paths_create(job->subject->paths, &job->paths, error);
    if (status == PM_OK)
        status = pm__scene_create(&job->scene, error);
    if (status == PM_OK)
        status = job->subject->build(job->values, job->scene, error);
    return status == PM_OK ? pm__scene_commit(job->scene, error) : status;
}
