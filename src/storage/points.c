#include "points.h"

#include "../base/memory.h"
#include "../lookup/lookup.h"

#include <stdlib.h>
#include <string.h>

enum { AT_ONCE = 32 }; /* few enough that what is found for them is still near when it is read */

static pm_status add_gloss(pm__points_list *list, const pm__eye *eye, uint32_t *number)
{
    pm__point_gloss *gloss;
    if (pm__grow((void **)&list->gloss, &list->gloss_capacity, list->gloss_count + 1, sizeof *gloss))
        return PM_ENOMEM;
    *number = (uint32_t)list->gloss_count;
    gloss = &list->gloss[list->gloss_count++];
    gloss->material = eye->hit.material;
    memcpy(gloss->normal, eye->hit.normal, sizeof gloss->normal);
    memcpy(gloss->outgoing, eye->outgoing, sizeof gloss->outgoing);
    return PM_OK;
}

pm_status pm__points_add(pm__points_list *list, const pm__eye *eye, uint32_t cell, double share)
{
    double brdf[3] = {1.0, 1.0, 1.0};
    uint32_t gloss = UINT32_MAX;
    if (pm__grow((void **)&list->items, &list->capacity, list->count + 1, sizeof *list->items))
        return PM_ENOMEM;
    if (eye->hit.material->kind == PM__DIFFUSE)
        pm__material_brdf(eye->hit.material, eye->hit.normal, eye->facing, eye->facing, brdf);
    else if (add_gloss(list, eye, &gloss) != PM_OK)
        return PM_ENOMEM;
    pm__point *const point = &list->items[list->count++];
    for (int a = 0; a < 3; a++) {
        point->position[a] = (float)eye->hit.position[a];
        point->normal[a] = (float)eye->facing[a];
        point->weight[a] = (float)(share * eye->weight[a] * brdf[a]);
    }
    point->cell = cell;
    point->gloss = gloss;
    return PM_OK;
}

void pm__points_clear(pm__points_list *list)
{
    list->count = list->gloss_count = 0;
}

void pm__points_free(pm__points_list *list)
{
    free(list->items);
    free(list->gloss);
    *list = (pm__points_list){0};
}

pm_query pm__points_query(const float position[3], const float normal[3], const pm__looking *looking)
{
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, position, sizeof query.position);
    memcpy(query.normal, normal, sizeof query.normal);
    query.k = looking->k;
    query.max_radius = (float)looking->radius;
    query.front_only = true;
    query.sorted = false;
    return query;
}

/* ---- Looking up -------------------------------------------------------------------------------- */

typedef struct desk {
    const pm__points_list *list;
    const pm_map *map;
    const pm__looking *looking;
    pm__spec estimator;
    pm_workspace *workspace;
    pm_neighbor *neighbors;
    size_t stride;
    double *sums;
} desk;

static void brdf_at(void *context, const float incoming[3], const float outgoing[3], float value[3])
{
    const pm__point_gloss *const gloss = context;
    const double in[3] = {-(double)incoming[0], -(double)incoming[1], -(double)incoming[2]};
    double brdf[3];
    (void)outgoing; /* in double, from the point itself */
    pm__material_brdf(gloss->material, gloss->normal, in, gloss->outgoing, brdf);
    for (int b = 0; b < 3; b++)
        value[b] = (float)brdf[b];
}

static pm_status estimate(const desk *d, const pm__point *point, const pm_query *query, pm_neighbor *neighbors,
                          size_t count)
{
    const bool even = point->gloss == UINT32_MAX;
    const pm_source source = {.dimensions = 2,
                              .brdf = even ? NULL : brdf_at,
                              .brdf_context = even ? NULL : &d->list->gloss[point->gloss]};
    const pm__gathering gathering = {&source, pm_map_unit(d->map), false, false};
    double value[3];
    pm_status status = pm__gather_found(d->map, query, neighbors, count, &gathering, d->workspace);
    if (status != PM_OK)
        return status;
    pm__point_sets(d->workspace, 1, false);
    const pm__lookup lookup = {.sets = d->workspace->sets,
                               .set_count = 1,
                               .dimensions = 2,
                               .normal = {query->normal[0], query->normal[1], query->normal[2]},
                               .unit = gathering.unit};
    status = pm__evaluate(&d->estimator, &lookup, d->workspace, value);
    for (int b = 0; b < 3 && status == PM_OK; b++)
        d->sums[3 * (size_t)point->cell + (size_t)b] += (double)point->weight[b] * value[b];
    return status == PM_EDEGENERATE ? PM_OK : status; /* all in one point: it stays black */
}

static pm_status look_some(const desk *d, size_t first, size_t count)
{
    pm_query queries[AT_ONCE] = {{.k = 0}}; /* gcc does not see that all that are looked up are set */
    size_t found[AT_ONCE];
    for (size_t i = 0; i < count; i++)
        queries[i] = pm__points_query(d->list->items[first + i].position, d->list->items[first + i].normal, d->looking);
    pm_status status = pm_map_search_batch(d->map, queries, count, d->neighbors, d->stride, found);
    for (size_t i = 0; i < count && status == PM_OK; i++)
        status = estimate(d, &d->list->items[first + i], &queries[i], d->neighbors + i * d->stride, found[i]);
    return status;
}

pm_status pm__points_look(const pm__points_list *list, const pm_map *map, const pm__looking *looking, double *sums)
{
    const size_t photons = pm_map_count(map), stride = looking->k < photons ? looking->k : photons;
    desk d = {.list = list, .map = map, .looking = looking, .stride = stride, .sums = sums};
    if (!stride || !list->count)
        return PM_OK;
    pm_status status = pm__spec_parse(&pm__estimators, "disc:last=none", &d.estimator, NULL);
    if (status == PM_OK)
        status = pm_workspace_create(stride, &d.workspace);
    d.neighbors = pm__alloc(AT_ONCE * stride, sizeof *d.neighbors);
    if (!d.neighbors)
        status = PM_ENOMEM;
    for (size_t i = 0; i < list->count && status == PM_OK; i += AT_ONCE)
        status = look_some(&d, i, list->count - i < AT_ONCE ? list->count - i : AT_ONCE);
    pm_workspace_destroy(d.workspace);
    free(d.neighbors);
    return status;
}
