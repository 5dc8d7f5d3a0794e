/* Densities of maps, at what the camera sees. */
#include "job.h"
#include "points.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* M of D = M / (pi r_M^2), the density of photons ([C02] 3.5.2); pixels of one task; ways through glass that carry less
 * of the light are not looked along. */
enum { NEAREST = 20, BLOCK = 64 };
static const double least_share = 1e-3, pi = 3.14159265358979323846;

/* What the middle of a pixel shows. */
typedef struct sight {
    float position[3], normal[3];
    bool reached;
} sight;

typedef struct drawing {
    const pm__storage_job *job;
    pm__map_kind kind;
    const pm_map *map;
    const pm__spec *policy;  /* that requires */
    sight *sights;           /* [pixel] */
    float *required, *actual, *convergence, *reached; /* [pixel]; the last two are NULL for global maps */
    _Atomic int failure;
} drawing;

typedef struct best_way {
    sight *sight;
    double weight;
} best_way;

/* Of all ways to rough surfaces, that which carries most. */
static void take_way(void *context, const pm__eye *eye, bool reached)
{
    best_way *const best = context;
    const double weight = eye->weight[0] + eye->weight[1] + eye->weight[2];
    if (!reached || !(weight > best->weight))
        return;
    best->weight = weight;
    best->sight->reached = true;
    for (int a = 0; a < 3; a++) {
        best->sight->position[a] = (float)eye->hit.position[a];
        best->sight->normal[a] = (float)eye->facing[a];
    }
}

static void look_out(const drawing *d, size_t pixel)
{
    const pm__storage_job *const job = d->job;
    const size_t width = job->result->width;
    const pm__eye_numbers numbers = pm__eye_numbers_of(job->wish->seed, 0, 0, pixel);
    best_way best = {&d->sights[pixel], 0.0};
    pm__eye eye;
    best.sight->reached = false;
    pm__eye_through(&eye, job->stage.scene, &job->stage.camera, &numbers, (double)(pixel % width) + 0.5,
                    (double)(pixel / width) + 0.5);
    pm__eye_follow_all(&eye, least_share, take_way, &best);
}

/* M / (pi r_M^2); where there are fewer within the radius, of these over the whole of it. */
static pm_status density_at(const drawing *d, const sight *at, float *density)
{
    const pm__looking looking = {NEAREST, d->job->radius};
    pm_query query = pm__points_query(at->position, at->normal, &looking);
    pm_neighbor near[NEAREST];
    size_t count = 0;
    query.sorted = true;
    const pm_status status = pm_map_search(d->map, &query, near, NEAREST, &count);
    const double unit = pm_map_unit(d->map);
    const double square = count == NEAREST ? (double)near[NEAREST - 1].distance2 * unit * unit
                                           : d->job->radius * d->job->radius;
    *density = status == PM_OK && square > 0.0 ? (float)((double)count / (pi * square)) : NAN;
    return status;
}

/* Irradiance from a map, all bands. */
static pm_status light_at(const drawing *d, const pm_map *map, const sight *at, double *light)
{
    pm__point point = {.weight = {1.0F, 1.0F, 1.0F}, .gloss = UINT32_MAX};
    const pm__points_list list = {.items = &point, .count = 1};
    const pm__looking looking = {d->job->wish->k, d->job->radius};
    double sums[3] = {0.0, 0.0, 0.0};
    memcpy(point.position, at->position, sizeof point.position);
    memcpy(point.normal, at->normal, sizeof point.normal);
    const pm_status status = pm__points_look(&list, map, &looking, sums);
    *light = sums[0] + sums[1] + sums[2];
    return status;
}

/* C(x) = D_c / D_r (L_g / L_c)^3 (Suykens and Willems 2000, section 4): above 1 the caustic has converged, be it that
 * other light hides its error. All light comes from the global map. */
static pm_status converge_at(const drawing *d, size_t pixel)
{
    const pm_map *const global = pm__viewing_global(d->job->viewing);
    double caustic = 0.0, all = 0.0;
    const double ratio = (double)d->actual[pixel] / (double)d->required[pixel];
    pm_status status = light_at(d, d->map, &d->sights[pixel], &caustic);
    if (status == PM_OK && global)
        status = light_at(d, global, &d->sights[pixel], &all);
    const double share = fmax(1.0, all / caustic); /* the global light has the caustic's in it: less is noise */
    d->reached[pixel] = (float)ratio;
    d->convergence[pixel] = caustic > 0.0 ? (float)fmin(ratio * share * share * share, 1e30) : NAN;
    return status;
}

static pm_status draw_some(const drawing *d, size_t first, size_t count)
{
    float positions[BLOCK][3], normals[BLOCK][3], importance[BLOCK];
    pm_status status = PM_OK;
    for (size_t i = 0; i < count; i++) {
        memcpy(positions[i], d->sights[first + i].position, sizeof positions[i]);
        memcpy(normals[i], d->sights[first + i].normal, sizeof normals[i]);
    }
    if (d->policy)
        pm__importance_at(d->job->importance, d->kind, (const float(*)[3])positions, (const float(*)[3])normals, count,
                          importance);
    for (size_t i = 0; i < count && status == PM_OK; i++) {
        const size_t p = first + i;
        if (!d->sights[p].reached)
            continue;
        if (d->policy)
            d->required[p] = (float)pm__policy_required(d->policy, d->kind, d->job->importance, (double)importance[i]);
        status = density_at(d, &d->sights[p], &d->actual[p]);
        if (status == PM_OK && d->convergence && d->required[p] > 0.0F)
            status = converge_at(d, p);
    }
    return status;
}

static void draw_block(void *argument, size_t block)
{
    drawing *const d = argument;
    const size_t first = block * BLOCK, pixels = d->job->result->width * d->job->result->height;
    const size_t count = pixels - first < BLOCK ? pixels - first : BLOCK;
    for (size_t i = 0; i < count; i++)
        look_out(d, first + i);
    const pm_status status = draw_some(d, first, count);
    if (status != PM_OK)
        atomic_store(&d->failure, (int)status);
}

/* ---- Images ------------------------------------------------------------------------------------ */

/* The first that requires any density, else `density` as it is by default; NULL: none does. */
static const pm__spec *requiring(pm__storage_job *job, pm__map_kind kind)
{
    const double mean = pm__importance_mean(job->importance, kind);
    for (size_t i = 0; i < job->wish->policy_count; i++)
        if (pm__policy_required(&job->wish->policies[i], kind, job->importance, mean) > 0.0)
            return &job->wish->policies[i];
    const pm__entry *const entry = pm__find(&pm__policies, "density");
    if (!entry)
        return NULL;
    pm__spec_default(entry, &job->density);
    return &job->density;
}

/* A new image, all NAN. */
static pm_status add_image(pm__storage_job *job, pm__density_kind what, pm__map_kind kind, const pm__spec *policy,
                           pm__density_image **made, pm_error *error)
{
    pm__storage_result *const r = job->result;
    pm__density_image *const grown = realloc(r->images, (r->image_count + 1) * sizeof *grown);
    if (!grown)
        return pm__fail(error, PM_ENOMEM, "out of memory for images");
    r->images = grown;
    *made = &grown[r->image_count++];
    **made = (pm__density_image){.kind = what, .map = kind, .policy = policy};
    pm_status status = pm__image_create(r->width, r->height, 1, &(*made)->image, error);
    if (status == PM_OK && what == PM__CONVERGENCE)
        status = pm__image_create(r->width, r->height, 1, &(*made)->reached, error);
    for (size_t i = 0; i < r->width * r->height && status == PM_OK; i++) {
        (*made)->image.values[i] = NAN;
        if ((*made)->reached.values)
            (*made)->reached.values[i] = NAN;
    }
    return status;
}

static bool has_required(const pm__storage_result *r, pm__map_kind kind)
{
    for (size_t i = 0; i < r->image_count; i++)
        if (r->images[i].kind == PM__REQUIRED_DENSITY && r->images[i].map == kind)
            return true;
    return false;
}

static pm_status add_images(pm__storage_job *job, const pm__storage_item *item, bool required, bool convergence,
                            pm_error *error)
{
    const pm__map_kind kind = item->row.map;
    pm__density_image *made;
    pm_status status = PM_OK;
    if (required)
        status = add_image(job, PM__REQUIRED_DENSITY, kind, NULL, &made, error);
    if (status == PM_OK)
        status = add_image(job, PM__ACTUAL_DENSITY, kind, item->row.policy, &made, error);
    if (status == PM_OK && convergence)
        status = add_image(job, PM__CONVERGENCE, kind, item->row.policy, &made, error);
    return status;
}

pm_status pm__storage_draw(pm__storage_job *job, const pm__storage_item *item, const pm_map *map, pm_error *error)
{
    pm__storage_result *const r = job->result;
    const size_t pixels = r->width * r->height, before = r->image_count;
    drawing d = {.job = job, .kind = item->row.map, .map = map, .policy = requiring(job, item->row.map)};
    const bool required = d.policy && !has_required(r, d.kind), convergence = d.policy && d.kind == PM__CAUSTIC_MAP;
    d.sights = pm__alloc(pixels, sizeof *d.sights);
    float *const spare = pm__alloc_zero(pixels, sizeof *spare);
    pm_status status = d.sights && spare ? add_images(job, item, required, convergence, error)
                                         : pm__fail(error, PM_ENOMEM, "out of memory for images");
    if (status == PM_OK) {
        const pm__density_image *const own = &r->images[before + required];
        d.required = required ? r->images[before].image.values : spare;
        d.actual = own->image.values;
        d.convergence = convergence ? own[1].image.values : NULL;
        d.reached = convergence ? own[1].reached.values : NULL;
        pm__for(job->wish->parallel, (pixels + BLOCK - 1) / BLOCK, draw_block, &d);
        status = (pm_status)atomic_load(&d.failure);
    }
    free(d.sights);
    free(spare);
    return status;
}
