/* How uneven powers are: what makes hot spots. */
#include "job.h"
#include "points.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../stats/stats.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { EVERY = 16, BLOCK = 256 }; /* centres: every so many photons; of one task */

typedef struct spreading {
    const pm__storage_job *job;
    pm__map_kind kind;
    const pm__stored_photons *set;
    const pm_map *map;
    double threshold;
    size_t centres;
    double *largest; /* [block]; NAN: no centre lies in an important place */
    _Atomic int failure;
} spreading;

/* powers: room for k. */
static pm_status spread_at(const spreading *s, const pm_query *query, pm_neighbor *near, double *powers, double *spread)
{
    size_t count = 0;
    const pm_status status = pm_map_search(s->map, query, near, query->k, &count);
    if (status != PM_OK || count < 2)
        return status;
    for (size_t i = 0; i < count; i++) {
        const pm_photon photon = pm_map_photon(s->map, near[i].number);
        powers[i] = (double)photon.power[0] + (double)photon.power[1] + (double)photon.power[2];
    }
    const double median = pm__median(powers, count);
    if (median > 0.0)
        *spread = fmax(*spread, powers[count - 1] / median); /* fmax passes over NAN */
    return PM_OK;
}

static pm_status spread_some(const spreading *s, size_t first, size_t count, double *spread)
{
    float positions[BLOCK][3], normals[BLOCK][3], importance[BLOCK];
    const size_t photons = pm_map_count(s->map), k = s->job->wish->k < photons ? s->job->wish->k : photons;
    const pm__looking looking = {k, s->job->radius};
    for (size_t i = 0; i < count; i++) {
        memcpy(positions[i], s->set->photons[(first + i) * EVERY].position, sizeof positions[i]);
        memcpy(normals[i], s->set->normals[(first + i) * EVERY], sizeof normals[i]);
    }
    pm__importance_at(s->job->importance, s->kind, (const float(*)[3])positions, (const float(*)[3])normals, count,
                      importance);
    pm_neighbor *const near = pm__alloc(k, sizeof *near);
    double *const powers = pm__alloc(k, sizeof *powers);
    pm_status status = near && powers ? PM_OK : PM_ENOMEM;
    for (size_t i = 0; i < count && status == PM_OK; i++)
        if ((double)importance[i] >= s->threshold) {
            const pm_query query = pm__points_query(positions[i], normals[i], &looking);
            status = spread_at(s, &query, near, powers, spread);
        }
    free(near);
    free(powers);
    return status;
}

static void spread_block(void *argument, size_t block)
{
    spreading *const s = argument;
    const size_t first = block * BLOCK, left = s->centres - first;
    s->largest[block] = (double)NAN;
    const pm_status status = spread_some(s, first, left < BLOCK ? left : BLOCK, &s->largest[block]);
    if (status != PM_OK)
        atomic_store(&s->failure, (int)status);
}

pm_status pm__power_spread(const pm__storage_job *job, pm__map_kind kind, const pm__stored_photons *set,
                           const pm_map *map, double *spread)
{
    const size_t centres = (set->count + EVERY - 1) / EVERY, blocks = (centres + BLOCK - 1) / BLOCK;
    spreading s = {.job = job, .kind = kind, .set = set, .map = map, .centres = centres};
    s.threshold = pm__importance_threshold(job->importance, kind);
    s.largest = pm__alloc(blocks, sizeof *s.largest);
    *spread = (double)NAN;
    if (!s.largest)
        return PM_ENOMEM;
    if (s.threshold > 0.0) /* else nothing is important */
        pm__for(job->wish->parallel, blocks, spread_block, &s);
    for (size_t i = 0; i < blocks && s.threshold > 0.0; i++)
        *spread = fmax(*spread, s.largest[i]);
    free(s.largest);
    return (pm_status)atomic_load(&s.failure);
}
