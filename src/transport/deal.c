#include "deal.h"

#include "../base/memory.h"
#include "../base/random.h"
#include "../base/status.h"

#include <stdlib.h>

static size_t map_of(const pm__dealing *dealing, size_t i)
{
    if (dealing->round_robin)
        return i % dealing->maps;
    double u;
    pm__random_uniform(dealing->seed, PM__FOR_DEALING, dealing->trial, i, &u, 1);
    return (size_t)(u * (double)dealing->maps);
}

/* Photons by map, each map's in the order in which they came: end[m] says where map m's end. */
static void sort_by_map(const pm__dealing *dealing, const pm_photon *photons, size_t count, size_t *end,
                        uint32_t *to, pm_photon *hand)
{
    for (size_t m = 0; m < dealing->maps; m++)
        end[m] = 0;
    for (size_t i = 0; i < count; i++)
        end[to[i] = (uint32_t)map_of(dealing, i)]++;
    for (size_t m = 0, first = 0; m < dealing->maps; m++) {
        const size_t own = end[m];
        end[m] = first;
        first += own;
    }
    for (size_t i = 0; i < count; i++)
        hand[end[to[i]]++] = photons[i];
}

pm_status pm__deal(const pm__dealing *dealing, const pm_photon *photons, size_t count, const pm_map_options *options,
                   pm_map **made, pm_error *error)
{
    pm_photon *const hand = pm__alloc(count, sizeof *hand);
    uint32_t *const to = pm__alloc(count, sizeof *to);
    size_t *const end = pm__alloc(dealing->maps, sizeof *end);
    pm_status status =
        hand && to && end ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory to deal %zu photons", count);
    if (status == PM_OK)
        sort_by_map(dealing, photons, count, end, to, hand);
    for (size_t m = 0, first = 0; m < dealing->maps && status == PM_OK; first = end[m++])
        status = pm_map_create(hand + first, end[m] - first, options, &made[m], error);
    free(hand);
    free(to);
    free(end);
    return status;
}
