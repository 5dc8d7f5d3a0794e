/* Lookups of the bench: neighbours are found once for the largest k, and every smaller k is a prefix of them. */
#include "bench.h"

/* The case's BRDF as estimators call it. */
static void apply_brdf(void *context, const float incoming[3], const float outgoing[3], float value[3])
{
    const pm__job *const job = context;
    double in[3], out[3], result[3];
    for (int a = 0; a < 3; a++) {
        in[a] = (double)incoming[a];
        out[a] = (double)outgoing[a];
    }
    job->subject->brdf(job->values, in, out, result);
    for (int b = 0; b < 3; b++)
        value[b] = (float)result[b];
}

const pm_source *pm__source_of(const pm__bench_lookup *lookup)
{
    return lookup->source.brdf ? &lookup->source : NULL;
}

static void aim(pm__bench_lookup *lookup, size_t probe)
{
    const pm__job *const job = lookup->job;
    if (!job->subject->brdf)
        return;
    lookup->source.brdf = apply_brdf;
    lookup->source.brdf_context = (void *)(uintptr_t)job; /* only read */
    for (int a = 0; a < 3; a++)
        lookup->source.outgoing[a] = (float)job->probes[probe].outgoing[a];
}

pm_query pm__probe_query(pm__bench_lookup *lookup, size_t probe, size_t k, double radius)
{
    aim(lookup, probe);
    const pm__job *const job = lookup->job;
    const pm__shape *const shape = &job->config->lookup;
    pm_query query;
    pm_query_init(&query);
    for (int a = 0; a < 3; a++) {
        query.position[a] = (float)job->probes[probe].position[a];
        query.normal[a] = (float)job->probes[probe].normal[a];
    }
    query.k = k;
    query.max_radius = (float)radius;
    query.shape = shape->shape;
    query.shape_parameter = (float)shape->parameter;
    query.front_only = shape->front_only;
    query.search = lookup->search;
    return query;
}

/* Looks within the lookup's guess first: the probe before lay nearby, so its radius tells this one's. Fewer than k
 * found there says that the guess was too small, never that the answer is; then all is searched. */
static pm_status gather_within_guess(const pm__bench_lookup *lookup, const pm_map *map, const pm_query *query,
                                     const pm__gathering *gathering, size_t set)
{
    pm_query near = *query;
    near.max_radius = (float)fmin((double)query->max_radius, lookup->guess);
    pm_status status = pm__gather(map, &near, gathering, lookup->workspace, set);
    if (status == PM_OK && near.max_radius < query->max_radius && lookup->workspace->sets[set].cut)
        status = pm__gather(map, query, gathering, lookup->workspace, set);
    return status;
}

pm_status pm__gather_main(const pm__bench_lookup *lookup, const pm_query *query)
{
    const pm_map *const map = lookup->maps->map;
    const pm__gathering gathering = {pm__source_of(lookup), pm_map_unit(map), true, lookup->job->offsets};
    const pm_status status = gather_within_guess(lookup, map, query, &gathering, 0);
    if (status == PM_OK)
        pm__point_sets(lookup->workspace, 1, gathering.offsets);
    return status;
}

pm_status pm__gather_dealt(const pm__bench_lookup *lookup, size_t deal, const pm_query *query)
{
    const size_t maps = lookup->job->deals[deal].maps;
    const pm__gathering gathering = {pm__source_of(lookup), pm_map_unit(lookup->maps->map), true, false};
    for (size_t m = 0; m < maps; m++) {
        pm_query part = *query;
        part.k = pm__share(query->k, maps, m);
        const pm_status status =
            gather_within_guess(lookup, lookup->maps->dealt[deal][m], &part, &gathering, m);
        if (status != PM_OK)
            return status;
    }
    pm__point_sets(lookup->workspace, maps, false);
    return PM_OK;
}

/* The part of a set that a search for k within the radius (map units) would have found. */
static pm__neighbors prefix(const pm__neighbors *set, size_t k, double radius)
{
    pm__neighbors part = *set;
    if (k && part.count > k)
        part.count = k;
    const double radius2 = radius * radius;
    while (part.count && part.distance2[part.count - 1] > (float)radius2)
        part.count--;
    part.cut = !k || (part.count < k && !isinf(radius));
    if (part.cut)
        part.radius2 = radius2;
    else
        part.radius2 = part.count ? (double)part.distance2[part.count - 1] : 0.0;
    return part;
}

pm_status pm__evaluate_variant(const pm__bench_lookup *lookup, const pm__variant *variant, size_t oracle_k,
                               const float normal[3], const pm__neighbors *sets, size_t set_count, double *value)
{
    const double unit = pm_map_unit(lookup->maps->map);
    pm__neighbors parts[PM__MAX_MAPS];
    for (size_t s = 0; s < set_count; s++)
        parts[s] = prefix(&sets[s], variant->k ? pm__share(variant->k, set_count, s) : 0, variant->radius / unit);
    const pm__lookup view = {.sets = parts,
                             .set_count = set_count,
                             .dimensions = lookup->job->subject->dimensions,
                             .normal = {normal[0], normal[1], normal[2]},
                             .unit = unit,
                             .oracle_k = oracle_k};
    double bands[3];
    const pm_status status = pm__evaluate(variant->spec, &view, lookup->workspace, bands);
    *value = bands[0];
    return status;
}
