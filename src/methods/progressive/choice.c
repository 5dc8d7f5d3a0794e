/* Whether photons find the points of a configuration or points look photons up in a map of them: whichever takes less
 * time, by what a few photons find. Runs that are resumed must choose as they did, so nothing counts here that the
 * configuration does not settle. */
#include "cover.h"

#include <math.h>

/* A pass of its own, not that of the first radii: those have found k of their photons by definition. */
#define PILOT (UINT32_MAX - 1)

enum { PHOTONS = 16384, SAMPLE = 4096 }; /* of the pilot at most, emitted; points that look them up */

/* Points that a photon finds up to which it is faster so. Measured on cornell, plate and furnace with 1024 to 262144
 * points and 20000 to 262144 photons, beside lookups in a grid: at 1 point a photon what comes after tracing takes 0.6
 * to 0.7 of the time, at 2.6 0.6 to 1.1, at 5 1.2 to 1.5, at 8 1.4 to 2.7. Radii shrink, so that later passes find
 * fewer than the first one does. PM__PAIRS has room for somewhat more. */
static const double most_points = 3.0;

static bool may_find(const pm__progression *p)
{
    const pm__progressive_config *const config = p->config;
    const pm__progressive *const method = (const pm__progressive *)(const void *)config->method->entry;
    if (!method->summed || config->search)
        return false;
    const pm__estimator *const kernel = pm__estimator_of(&config->estimator->spec);
    return kernel->weight && !kernel->needs && pm__map_count_of(&config->estimator->spec) == 1;
}

/* Points that a photon of the map lies within the first radius of, on average over photons. */
static double count_found(const pm__progression *p, const pm_map *map, size_t photons)
{
    const size_t sample = p->points < SAMPLE ? p->points : SAMPLE;
    double sum = 0.0;
    for (size_t i = 0; i < sample; i++) {
        /* Of more points some, by steps that keep to no row or column. */
        const size_t at = sample < p->points ? (size_t)(i * 2654435761U % p->points) : i;
        size_t count = 0;
        pm_query query;
        if (!p->fixed[at].material || !(p->radius[at] > 0.0f))
            continue;
        pm__point_query(p, &p->fixed[at], 0, (double)p->radius[at], &query);
        (void)pm_map_search(map, &query, NULL, 0, &count); /* it tells how many there are, if no more */
        sum += (double)count;
    }
    return photons ? sum * ((double)p->points / (double)sample) / (double)photons : 0.0;
}

/* As if a pass had no more photons than these. */
static pm_status pilot(const pm__progression *progression, double *points, pm_error *error)
{
    pm__progressive_config config = *progression->config;
    pm__progression p = *progression;
    pm__run run = {.of = &p, .seed = config.seed};
    pm__photon_set set = {0};
    pm_map *map = NULL;
    config.photons = config.photons < PHOTONS ? config.photons : PHOTONS;
    p.config = &config;
    pm_status status = pm__run_shoot(&run, PILOT, &set, error);
    if (status == PM_OK)
        status = pm__run_pass_map(&run, &set, &map, error);
    if (status == PM_OK)
        *points = count_found(&p, map, set.count);
    pm__photon_set_free(&set);
    pm_map_destroy(map);
    return status;
}

pm_status pm__choose_meeting(pm__progression *progression, pm_error *error)
{
    double points = INFINITY;
    progression->meeting = (pm__meeting){.chunk = PM__CHUNK, .chunks = PM__CHUNKS, .pairs = PM__PAIRS};
    const pm_status status = may_find(progression) ? pilot(progression, &points, error) : PM_OK;
    progression->meeting.by_photons = status == PM_OK && points < most_points;
    return status;
}
