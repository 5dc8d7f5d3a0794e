/* What a render holds, before it is begun. */
#include "film.h"

#include "../lookup/lookup.h"
#include "../map/structure.h"
#include "../search/search.h"

/* Bytes a photon: as it was traced, a map, and the maps of those that combine several. */
static double bytes_of_maps(const pm__render_config *config)
{
    const pm__structure_id structure = config->search ? config->search->structure : PM__WIDE;
    double bytes = (double)sizeof(pm_photon) + pm__bytes_to_build(structure, false);
    for (size_t i = 0; i < config->estimator_count; i++)
        if (pm__estimator_of(&config->estimators[i]->spec)->needs & PM__MAPS)
            bytes += pm__bytes_when_built(structure, false);
    return bytes;
}

double pm__render_bytes(const pm__render_config *config)
{
    const pm__method *const method = (const pm__method *)(const void *)config->method->entry;
    const double images = method->estimates ? (double)config->estimator_count : 1.0;
    const double pixels = (double)config->width * (double)config->height;
    const double maps = method->estimates ? (double)config->photons * bytes_of_maps(config) : 0.0;
    return pixels * images * pm__film_bytes(config, method->prepare) + maps;
}
