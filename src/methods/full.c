/* Jensen's two-pass method ([C02] 2.4): direct light by shadow rays, or by shadow photons where they agree; caustics
 * from a map of their own; light that has met a rough surface before by final gathering over the global map, with
 * irradiance computed beforehand at a share of its photons ([C02] 5.4; Christensen 1999). The global map holds all
 * paths, since it is used a rough bounce away only (errata 45).
 *
 * Where a gathering ray ends nearer than the radius of the estimate there, the estimate would blur what is just around
 * the corner: then that point is gathered for in its turn, by one ray. */
#include "irradiance.h"
#include "plan_steps.h"

#include "../base/clock.h"
#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GATHER, FRACTION, DIRECT, EDGES };
enum { RAYS, PHOTONS };
enum { COVERED, PLAIN };
enum { MOST_SENT = 16 }; /* caustic photons sent to specular surfaces for each that is to be stored: few get on, then */
enum { SHADOW_PHOTONS = 32 }; /* looked at for a light's shadow: the papers do not say how many */

static const pm__param params[] = {
    {"gather", PM__INTEGER, 4, 1, 1024, "", NULL, "rays of final gathering for each sample of a pixel"},
    {"fraction", PM__REAL, 0.25, 1e-6, 1, "", NULL, "of the global photons that carry irradiance"},
    {"direct", PM__CHOICE, RAYS, 0, 0, "", "rays|photons",
     "photons: shadow rays only where lit and shadow photons meet"},
    {"edges", PM__CHOICE, COVERED, 0, 0, "", "covered|plain",
     "of stored irradiance. covered: over the part of a lookup's disc that is surface; plain: over the whole disc, "
     "dark at edges, as the papers have it"}};

/* Photons of one light, lit and in shadow. */
typedef struct shadow_map {
    pm_map *map;
    unsigned char *shadow; /* by photon, in the order in which they were stored */
} shadow_map;

typedef struct full_state {
    pm__maps caustic, global;
    pm__irradiance irradiance;
    shadow_map *shadows; /* [lights]; NULL: shadow rays alone */
    size_t lights;
} full_state;

/* ---- The plan ---------------------------------------------------------------------------------- */

static pm_status check(const pm__render_job *job, pm_error *error)
{
    if (!job->config->k)
        return pm__fail(error, PM_EINVAL, "the method full needs --k: how many photons an estimate has");
    return PM_OK;
}

/* How many lights reach a specular surface; needs: where, and with what share of all power at most. */
static size_t lights_that_reach(const pm__render_job *job, pm__needs *needs)
{
    const size_t count = pm__scene_light_count(job->scene);
    double sum = 0.0, reaching = 0.0;
    size_t found = 0;
    needs->reach = 1.0;
    if (pm__projection_create(job->scene, true, &needs->aim, NULL) != PM_OK)
        return count; /* as if all did: what fails here fails again where it is told */
    for (size_t i = 0; i < count; i++) {
        const double *const power = pm__scene_light_at(job->scene, i)->power, all = power[0] + power[1] + power[2];
        const double part = pm__projection_share(needs->aim, i);
        found += part > 0.0;
        sum += all;
        reaching += part * all;
    }
    needs->reach = found ? reaching / sum : 0.0;
    return found;
}

static bool is_reflecting(const pm__material *material)
{
    double most = 0.0;
    for (int b = 0; b < 3; b++)
        most = fmax(most, fmax(material->diffuse[b], fmax(material->two_sided ? material->back[b] : 0.0,
                                                          material->kind == PM__GLOSSY ? material->specular[b] : 0.0)));
    return pm__is_rough(material) && most > 0.0;
}

static void plan(const pm__render_job *job, pm__plan *plan, pm__needs *needs)
{
    const bool all = job->config->no_skip, photons = job->config->method->values[DIRECT] == PHOTONS;
    const size_t specular = pm__count_objects(job->scene, pm__is_specular);
    const size_t reaching = specular ? lights_that_reach(job, needs) : 0, lights = pm__scene_light_count(job->scene);
    const bool alone = !specular && pm__is_single_floor(job->scene, NULL);
    const bool indirect = pm__count_objects(job->scene, is_reflecting) && !alone;
    needs->caustic = all || reaching;
    needs->projection = reaching && !all;
    needs->global = all || indirect;
    needs->behind = all;
    if (reaching)
        pm__plan_step(plan, true, "caustic pass", "%zu of %zu light%s can reach a specular surface", reaching, lights,
                      lights == 1 ? "" : "s");
    else
        pm__plan_step(plan, all, "caustic pass", "%s%s",
                      specular ? "no light reaches a specular surface" : "no specular surface", pm__plan_anyway(job));
    pm__plan_step(plan, needs->projection, "projection map",
                  !reaching ? "no caustic photons"
                  : all     ? "--no-skip: caustic photons are sent everywhere"
                            : "caustic photons are sent where specular surfaces are");
    pm__plan_step(plan, needs->global, "global map", "%s%s",
                  indirect ? "surfaces light each other"
                  : alone  ? "one flat surface sends no light to itself" : "no rough surface reflects",
                  indirect ? "" : pm__plan_anyway(job));
    if (indirect)
        pm__plan_step(plan, true, "final gathering", "%g rays a sample, irradiance at %g of the photons",
                      job->config->method->values[GATHER], job->config->method->values[FRACTION]);
    else
        pm__plan_step(plan, all, "final gathering", "no indirect light%s", pm__plan_anyway(job));
    pm__plan_step(plan, true, "shadow rays", photons ? "where lit and shadow photons meet"
                                             : all   ? "to every light, also from behind"
                                                     : "to lights in front of the surface that shine that way");
    pm__plan_step(plan, photons, "shadow photons", photons ? "asked for" : "shadow rays do their work");
    pm__plan_maps(job,
                  needs->caustic && needs->global   ? "the global map has all paths, the caustic map fewer"
                  : needs->caustic || needs->global ? "one map does for all light paths"
                                                    : "no map is needed",
                  plan, needs);
    pm__plan_front(job, plan, needs);
    needs->directions = needs->directions || photons;
    pm__plan_volume(job, plan);
}

/* ---- Maps -------------------------------------------------------------------------------------- */

static pm_status make_shadows(pm__render_job *job, uint32_t trial, full_state *state, pm_error *error)
{
    const pm__render_config *const config = job->config;
    state->lights = pm__scene_light_count(job->scene);
    state->shadows = pm__alloc_zero(state->lights, sizeof *state->shadows);
    if (!state->shadows)
        return pm__fail(error, PM_ENOMEM, "out of memory for shadow photons");
    const pm__shoot_config shooting = {.scene = job->scene,
                                       .seed = config->seed,
                                       .trial = trial + ((uint32_t)255 << 24),
                                       .sampler = config->sampler,
                                       .count = config->photons / state->lights + 1,
                                       .emitted = true,
                                       .parallel = config->parallel,
                                       .canceled = config->canceled,
                                       .context = config->context};
    const pm_map_options options = {.parallel = config->parallel};
    pm_status status = PM_OK;
    for (size_t i = 0; i < state->lights && status == PM_OK; i++) {
        pm__photon_set set = {0};
        status = pm__shoot_shadows(&shooting, i, &set, &state->shadows[i].shadow, error);
        if (status == PM_OK)
            status = pm_map_create(set.photons, set.count, &options, &state->shadows[i].map, error);
        job->emitted += set.emitted;
        job->stored += set.count;
        pm__photon_set_free(&set);
    }
    return status;
}

static void release(void *argument)
{
    full_state *const state = argument;
    for (size_t i = 0; state->shadows && i < state->lights; i++) {
        pm_map_destroy(state->shadows[i].map);
        free(state->shadows[i].shadow);
    }
    free(state->shadows);
    pm__irradiance_destroy(&state->irradiance);
    pm__maps_destroy(&state->global);
    pm__maps_destroy(&state->caustic);
    free(state);
}

static pm_status make_global(pm__render_job *job, uint32_t trial, full_state *state, pm_error *error)
{
    const pm__maps_wish wish = {.paths = "L.*D", .photons = job->config->photons, .normals = true, .trial = trial};
    pm_status status = pm__maps_create(job, &wish, &state->global, error);
    const double start = pm__seconds();
    if (status == PM_OK)
        status = pm__irradiance_create(job, &state->global, job->config->method->values[FRACTION],
                                       job->config->method->values[EDGES] == COVERED, &state->irradiance, error);
    job->build_s += pm__seconds() - start;
    return status;
}

static pm_status prepare(pm__render_job *job, uint32_t trial, void **made, pm_error *error)
{
    full_state *const state = pm__alloc_zero(1, sizeof *state);
    if (!state)
        return pm__fail(error, PM_ENOMEM, "out of memory for photon maps");
    /* As many photons, whether they are sent there or everywhere, so that the image is the same. */
    const double reach = job->needs.reach;
    const double most = !(reach > 0.0) || job->needs.projection ? MOST_SENT : MOST_SENT / reach;
    const pm__maps_wish caustic = {.paths = "LS+D", .photons = job->config->photons, .aimed = job->needs.projection,
                                   .emitted = !(reach > 0.0), .most = most, .estimates = true, .trial = trial,
                                   .stream = 1};
    pm_status status = PM_OK;
    if (job->needs.caustic)
        status = pm__maps_create(job, &caustic, &state->caustic, error);
    if (status == PM_OK && job->needs.global)
        status = make_global(job, trial, state, error);
    if (status == PM_OK && job->config->method->values[DIRECT] == PHOTONS)
        status = make_shadows(job, trial, state, error);
    if (status != PM_OK)
        release(state);
    else
        *made = state;
    return status;
}

/* ---- Radiance ---------------------------------------------------------------------------------- */

typedef enum visibility { LIT, SHADOW, UNKNOWN } visibility;

/* What the photons around say of a light (Jensen and Christensen 1995): only where they do not agree must be looked. */
static pm_status ask_photons(const pm__render_job *job, const shadow_map *shadow, const pm__eye *eye,
                             visibility *answer)
{
    pm_neighbor near[SHADOW_PHOTONS];
    size_t found = 0, dark = 0;
    pm_query query = pm__maps_query(job, eye->hit.position, eye->facing);
    query.k = SHADOW_PHOTONS;
    query.front_only = true;
    query.search = NULL;
    const pm_status status = pm_map_search(shadow->map, &query, near, SHADOW_PHOTONS, &found);
    for (size_t i = 0; i < found; i++)
        dark += shadow->shadow[pm_map_source(shadow->map, near[i].number)];
    *answer = found < SHADOW_PHOTONS ? UNKNOWN : dark == found ? SHADOW : dark ? UNKNOWN : LIT;
    return status;
}

/* Photons are asked only where there is something to know: on a surface that faces away from a light none are found,
 * and a search for them goes through them all. */
static pm_status add_light(const pm__render_job *job, const full_state *state, size_t light, pm__eye *eye,
                           double radiance[3])
{
    pm__eye_lit lit;
    visibility seen = UNKNOWN;
    pm_status status = PM_OK;
    const bool shines = pm__eye_sample(eye, pm__scene_light_at(job->scene, light), &lit);
    if (shines && state->shadows)
        status = ask_photons(job, &state->shadows[light], eye, &seen);
    if (shines ? seen == UNKNOWN : lit.arrives && job->needs.behind)
        seen = pm__eye_blocked(eye, &lit) ? SHADOW : LIT;
    for (int b = 0; b < 3 && shines && seen == LIT; b++)
        radiance[b] += lit.radiance[b];
    return status;
}

static pm_status add_direct(const pm__render_job *job, const full_state *state, pm__eye *eye, double radiance[3])
{
    const size_t count = pm__scene_light_count(job->scene);
    pm_status status = PM_OK;
    for (size_t i = 0; i < count && status == PM_OK; i++)
        status = add_light(job, state, i, eye, radiance);
    return status;
}

/* What all that is done for one tile has in common. */
typedef struct gathering {
    const pm__render_job *job;
    const full_state *state;
    pm__maps_scratch *scratch;
    pm__sample *samples; /* of the pixel in hand: [image * stride] */
    size_t stride;
} gathering;

static void add_to_all(const gathering *g, const double radiance[3], double share)
{
    for (size_t i = 0; i < g->job->images; i++)
        for (int b = 0; b < 3; b++)
            g->samples[i * g->stride].radiance[b] += share * radiance[b];
}

static void add_irradiance(const gathering *g, const pm__eye *eye, const double brdf[3], size_t carrier, double share)
{
    const pm__irradiance *const irradiance = &g->state->irradiance;
    for (size_t i = 0; i < g->job->images; i++)
        for (int b = 0; b < 3; b++)
            g->samples[i * g->stride].radiance[b] +=
                share * eye->weight[b] * brdf[b] *
                (double)irradiance->values[i * irradiance->carriers.count + carrier][b];
}

/* A point that no stored irradiance stands for: its direct light and caustics. */
static pm_status add_here(const gathering *g, pm__eye *eye, double share)
{
    double direct[3] = {0.0, 0.0, 0.0};
    pm_status status = add_direct(g->job, g->state, eye, direct);
    add_to_all(g, direct, share);
    if (!g->job->needs.caustic || status != PM_OK)
        return status;
    pm__sample caustic[PM__MOST_IMAGES] = {{{0.0}, 0.0f, 0.0f}};
    const bool reached = true;
    status = pm__maps_estimate(&g->state->caustic, eye, &reached, 1, g->scratch, caustic, 1);
    for (size_t i = 0; i < g->job->images; i++)
        for (int b = 0; b < 3; b++)
            g->samples[i * g->stride].radiance[b] += share * caustic[i].radiance[b];
    return status;
}

/* One ray of final gathering, and those that follow from it. */
static pm_status gather(const gathering *g, pm__eye *eye, double share)
{
    const pm__irradiance *const irradiance = &g->state->irradiance;
    pm_status status = PM_OK;
    while (status == PM_OK && pm__eye_bounce(eye) && pm__eye_follow(eye)) {
        double brdf[3];
        size_t carrier = SIZE_MAX;
        if (pm__is_even(eye, brdf))
            status = pm__irradiance_find(irradiance, eye, g->scratch->workspace, &carrier);
        if (status == PM_OK && carrier != SIZE_MAX && eye->travelled >= (double)irradiance->radius[carrier]) {
            add_irradiance(g, eye, brdf, carrier, share);
            return PM_OK;
        }
        if (status == PM_OK)
            status = add_here(g, eye, share);
    }
    return status;
}

/* Direct and indirect light at a point reached; the eye is copied for each ray, and its numbers go on. */
static pm_status shade(const gathering *g, pm__eye *eye)
{
    double direct[3] = {0.0, 0.0, 0.0};
    const int rays = (int)g->job->config->method->values[GATHER];
    pm_status status = add_direct(g->job, g->state, eye, direct);
    add_to_all(g, direct, 1.0);
    for (int i = 0; i < rays && g->job->needs.global && status == PM_OK; i++) {
        pm__eye ray = *eye;
        ray.sees_caustics = false; /* the caustic map has them */
        status = gather(g, &ray, 1.0 / rays);
        eye->numbers = ray.numbers;
    }
    return status;
}

static pm_status sample_tile(gathering *g, const pm__tile *tile, pm__sample *samples)
{
    const pm__render_job *const job = g->job;
    pm__eye eyes[PM__TILE_PIXELS];
    bool reached[PM__TILE_PIXELS];
    pm_status status = PM_OK;
    for (size_t p = 0; p < g->stride; p++) {
        pm__tile_eye(job, tile, p, tile->trial, &eyes[p]);
        reached[p] = pm__eye_follow(&eyes[p]);
        for (size_t i = 0; i < job->images; i++)
            memcpy(samples[i * g->stride + p].radiance, eyes[p].emitted, sizeof eyes[p].emitted);
    }
    if (job->needs.caustic)
        status = pm__maps_estimate(&g->state->caustic, eyes, reached, g->stride, g->scratch, samples, g->stride);
    for (size_t p = 0; p < g->stride && status == PM_OK; p++)
        if (reached[p]) {
            g->samples = samples + p;
            status = shade(g, &eyes[p]);
        }
    return status;
}

static pm_status sample(const pm__render_job *job, const void *state, const pm__tile *tile, pm__sample *samples,
                        double (*truth)[3])
{
    (void)truth;
    pm__maps_scratch scratch;
    gathering g = {.job = job, .state = state, .scratch = &scratch, .stride = pm__tile_pixels(tile)};
    pm_status status = pm__maps_scratch_create(job, g.state->caustic.map, PM__POINTS_AT_ONCE, &scratch);
    if (status == PM_OK)
        status = sample_tile(&g, tile, samples);
    pm__maps_scratch_destroy(&scratch);
    return status;
}

const pm__method pm__method_full = {
    .entry = {.name = "full",
              .summary = "shadow rays, caustic map, final gathering over the global map",
              .citation = "Jensen 1996; course 43, 2.4 and 5.4",
              .params = params,
              .param_count = 4},
    .estimates = true,
    .check = check,
    .plan = plan,
    .prepare = prepare,
    .sample = sample,
    .release = release,
};
