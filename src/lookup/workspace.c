/* Buffers of one thread. */
#include "lookup.h"

#include "../base/memory.h"

#include <stdint.h>
#include <stdlib.h>

/* Several arrays that grow together: capacity is only raised once all have grown. */
pm_status pm__workspace_reserve(pm_workspace *workspace, size_t photons, size_t sets)
{
    size_t have[3] = {workspace->capacity, workspace->capacity, workspace->capacity};
    if (pm__grow((void **)&workspace->distance2, &have[0], photons, sizeof *workspace->distance2) ||
        pm__grow((void **)&workspace->flux, &have[1], photons, sizeof *workspace->flux) ||
        pm__grow((void **)&workspace->offset, &have[2], photons, sizeof *workspace->offset))
        return PM_ENOMEM;
    workspace->capacity = have[0];
    size_t have_sets[2] = {workspace->set_capacity, workspace->set_capacity};
    if (pm__grow((void **)&workspace->sets, &have_sets[0], sets, sizeof *workspace->sets) ||
        pm__grow((void **)&workspace->first, &have_sets[1], sets, sizeof *workspace->first))
        return PM_ENOMEM;
    workspace->set_capacity = have_sets[0];
    return PM_OK;
}

pm_status pm__workspace_reserve_neighbors(pm_workspace *workspace, size_t count)
{
    if (pm__grow((void **)&workspace->neighbors, &workspace->neighbor_capacity, count, sizeof *workspace->neighbors))
        return PM_ENOMEM;
    return PM_OK;
}

pm_status pm_workspace_create(size_t max_k, pm_workspace **workspace)
{
    if (!workspace)
        return PM_EINVAL;
    *workspace = NULL;
    pm_workspace *const created = calloc(1, sizeof *created);
    if (!created)
        return PM_ENOMEM;
    pm_status status = pm__workspace_reserve(created, max_k, 1);
    if (status == PM_OK)
        status = pm__workspace_reserve_neighbors(created, max_k);
    if (status != PM_OK) {
        pm_workspace_destroy(created);
        return status;
    }
    *workspace = created;
    return PM_OK;
}

void pm_workspace_destroy(pm_workspace *workspace)
{
    if (!workspace)
        return;
    free(workspace->neighbors);
    free(workspace->distance2);
    free(workspace->flux);
    free(workspace->offset);
    free(workspace->sets);
    free(workspace->first);
    free(workspace->scratch);
    free(workspace);
}
