/* Estimators as the public interface has them, and one estimate from maps and a query. */
#include "lookup.h"

#include "../base/memory.h"
#include "../base/vec3.h"

#include <stdlib.h>
#include <string.h>

pm_status pm_estimator_create(const char *spec, pm_estimator **estimator, pm_error *error)
{
    if (estimator)
        *estimator = NULL;
    if (!spec || !estimator)
        return pm__fail(error, PM_EINVAL, "an estimator needs a name and somewhere to put it");
    pm_estimator *const created = calloc(1, sizeof *created);
    if (!created)
        return pm__fail(error, PM_ENOMEM, "out of memory for an estimator");
    const pm_status status = pm__spec_parse(&pm__estimators, spec, &created->spec, error);
    if (status != PM_OK) {
        free(created);
        return status;
    }
    pm__spec_format(&created->spec, created->name, sizeof created->name);
    *estimator = created;
    return PM_OK;
}

void pm_estimator_destroy(pm_estimator *estimator)
{
    free(estimator);
}

const char *pm_estimator_name(const pm_estimator *estimator)
{
    return estimator->name;
}

size_t pm_estimator_maps(const pm_estimator *estimator)
{
    return pm__map_count_of(&estimator->spec);
}

size_t pm__map_count_of(const pm__spec *spec)
{
    return (pm__estimator_of(spec)->needs & PM__MAPS) ? (size_t)pm__spec_value(spec, "maps", 1.0) : 1;
}

size_t pm__share(size_t k, size_t maps, size_t m)
{
    return k / maps + (m < k % maps);
}

/* Gives the lookup as much scratch as the estimator wants for so many photons. */
static pm_status provide_scratch(const pm__estimator *estimator, size_t photons, pm_workspace *workspace,
                                 pm__lookup *lookup)
{
    if (!estimator->scratch_per_photon)
        return PM_OK;
    if (photons > SIZE_MAX / estimator->scratch_per_photon ||
        pm__grow(&workspace->scratch, &workspace->scratch_size, photons * estimator->scratch_per_photon, 1))
        return PM_ENOMEM;
    lookup->scratch = workspace->scratch;
    lookup->scratch_size = workspace->scratch_size;
    return PM_OK;
}

pm_status pm__evaluate(const pm__spec *spec, const pm__lookup *lookup, pm_workspace *workspace, double result[3])
{
    const pm__estimator *const estimator = pm__estimator_of(spec);
    size_t found = 0;
    bool blurred = false;
    for (size_t s = 0; s < lookup->set_count; s++) {
        found += lookup->sets[s].count;
        blurred |= lookup->sets[s].blurred;
    }
    result[0] = result[1] = result[2] = 0.0;
    if (!found || blurred)
        return blurred ? PM_EDEGENERATE : PM_OK;
    pm__lookup with_scratch = *lookup;
    pm_status status = provide_scratch(estimator, found, workspace, &with_scratch);
    if (status == PM_OK)
        status = estimator->estimate(spec->values, &with_scratch, result);
    if (status != PM_OK)
        result[0] = result[1] = result[2] = 0.0;
    return status;
}

static pm_status check_request(const pm__spec *spec, const pm_source *source, const pm_query *query)
{
    const pm__estimator *const estimator = pm__estimator_of(spec);
    const size_t maps = pm__map_count_of(spec);
    if (source->dimensions != 2 && source->dimensions != 3)
        return PM_EINVAL;
    if (!(estimator->dimensions & 1U << source->dimensions))
        return PM_EINVAL;
    if (source->map_count != maps || !source->maps)
        return PM_EINVAL;
    for (size_t m = 0; m < maps; m++)
        if (!source->maps[m])
            return PM_EINVAL;
    if (query->k && query->k / maps < estimator->min_k)
        return PM_EINVAL;
    if (estimator->needs & PM__TRUTH)
        return PM_EINVAL;
    return PM_OK;
}

static bool unit_normal(const pm_query *query, float normal[3])
{
    double n[3] = {(double)query->normal[0], (double)query->normal[1], (double)query->normal[2]};
    const double length = pm__normalize(n);
    for (int a = 0; a < 3; a++)
        normal[a] = (float)n[a];
    return length > 0.0 && length < INFINITY;
}

/* r of the region: with several maps the root of the mean square over those that have one, as the pooled estimate has
 * it. */
static double region_radius(const pm__lookup *lookup)
{
    double sum = 0.0, regions = 0.0;
    for (size_t s = 0; s < lookup->set_count; s++) {
        sum += lookup->sets[s].radius2;
        regions += lookup->sets[s].cut || lookup->sets[s].count ? 1.0 : 0.0;
    }
    return regions > 0.0 ? sqrt(sum / regions) * lookup->unit : 0.0;
}

/* The coarsest unit of the maps that hold photons, so that squares in it neither over- nor underflow. */
static double common_unit(const pm_source *source)
{
    double unit = 0.0;
    for (size_t m = 0; m < source->map_count; m++)
        if (source->maps[m]->count)
            unit = fmax(unit, source->maps[m]->unit);
    return unit > 0.0 ? unit : 1.0;
}

/* What the caller's BRDF gave is in the sums: its NaN or infinity is no estimate. */
static pm_status check_finite(double value[3])
{
    if (isfinite(value[0]) && isfinite(value[1]) && isfinite(value[2]))
        return PM_OK;
    memset(value, 0, 3 * sizeof *value);
    return PM_ENONFINITE;
}

pm_status pm_estimate(const pm_estimator *estimator, const pm_source *source, const pm_query *query,
                      pm_workspace *workspace, pm_estimation *estimation)
{
    if (estimation)
        *estimation = (pm_estimation){{0.0, 0.0, 0.0}, 0.0, 0};
    if (!estimator || !source || !query || !workspace || !estimation)
        return PM_EINVAL;
    const unsigned needs = pm__estimator_of(&estimator->spec)->needs;
    if (needs & PM__AT_PHOTON)
        return source->precomputed && !source->brdf
                   ? pm__precomputed_lookup(source->precomputed, query, workspace, estimation)
                   : PM_EINVAL; /* irradiance is what is stored */
    pm_status status = check_request(&estimator->spec, source, query);
    if (status != PM_OK)
        return status;

    const pm__gathering gathering = {source, common_unit(source), query->sorted || (needs & PM__SORTED),
                                     needs & PM__OFFSETS};
    for (size_t m = 0; m < source->map_count && status == PM_OK; m++) {
        pm_query part = *query;
        part.k = pm__share(query->k, source->map_count, m);
        status = pm__gather(source->maps[m], &part, &gathering, workspace, m);
    }
    if (status != PM_OK)
        return status;
    pm__point_sets(workspace, source->map_count, gathering.offsets);
    pm__lookup lookup = {.sets = workspace->sets,
                         .set_count = source->map_count,
                         .dimensions = source->dimensions,
                         .unit = gathering.unit};
    if (!unit_normal(query, lookup.normal) && gathering.offsets)
        return PM_EINVAL; /* no tangent plane */
    status = pm__evaluate(&estimator->spec, &lookup, workspace, estimation->value);
    if (status == PM_OK)
        status = check_finite(estimation->value);
    estimation->radius = region_radius(&lookup);
    for (size_t s = 0; s < lookup.set_count; s++)
        estimation->count += lookup.sets[s].count;
    return status;
}
