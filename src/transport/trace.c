#include "emission.h"
#include "paths.h"

#include <float.h>

/* A photon on its way. */
typedef struct carrier {
    uint64_t number;
    double position[3], direction[3], power[3];
    uint32_t shape;             /* that it stands on */
    const double *absorption;   /* 1/m by band, of the medium that it was last known to be in; NULL: none yet */
    pm__places places;
} carrier;

/* What is the same for all photons of a call. */
typedef struct job {
    const pm__trace_config *config;
    const pm__emission *emission;
    pm__store store;
    pm__watch watch; /* NULL: nobody does */
    void *context;
} job;

/* false: no light sends any. */
static bool emit(const job *work, uint64_t number, carrier *photon)
{
    pm__departure departure;
    if (!pm__depart(work->emission, number, &departure))
        return false;
    *photon = (carrier){.number = number, .shape = PM__NO_SHAPE, .places = pm__paths_begin()};
    for (int i = 0; i < 3; i++) {
        photon->position[i] = departure.position[i];
        photon->direction[i] = departure.direction[i];
        photon->power[i] = departure.power[i];
    }
    return true;
}

/* The paths' automaton takes a letter. */
static void note(const job *work, carrier *photon, char letter)
{
    if (work->config->paths)
        photon->places = pm__paths_step(work->config->paths, photon->places, letter);
}

static bool is_wanted(const job *work, const carrier *photon)
{
    return !work->config->paths || pm__paths_accept(work->config->paths, photon->places);
}

static bool is_over(const job *work, const carrier *photon)
{
    return work->config->paths && pm__paths_dead(work->config->paths, photon->places);
}

/* Beer's law over the way to the surface. A glass boundary says what lies before it, also to a photon whose light is
 * inside; elsewhere the medium is that beyond the boundary left last. */
static void absorb(carrier *photon, const pm__hit *hit)
{
    if (hit->material->kind == PM__GLASS)
        photon->absorption = pm__medium_before(hit->material, hit->normal, photon->direction);
    if (photon->absorption)
        pm__attenuate(photon->absorption, hit->distance, photon->power);
}

/* false: the receiver wants no more. */
static bool deposit(const job *work, const carrier *photon, const pm__hit *hit)
{
    pm__stored stored;
    const double sign = pm__dot(photon->direction, hit->normal) > 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; i++) {
        stored.position[i] = hit->position[i];
        stored.direction[i] = photon->direction[i];
        stored.normal[i] = sign * hit->normal[i];
        stored.power[i] = photon->power[i];
    }
    return work->store(work->context, photon->number, &stored);
}

/* Off the surface, or false where the photon ends. */
static bool bounce(carrier *photon, const pm__hit *hit, const double u[3])
{
    double outgoing[3];
    if (pm__scatter(hit->material, hit->normal, photon->direction, u, photon->power, outgoing) == PM__ABSORBED)
        return false;
    if (hit->material->kind == PM__GLASS)
        photon->absorption = pm__medium_beyond(hit->material, hit->normal, outgoing);
    for (int i = 0; i < 3; i++) {
        photon->position[i] = hit->position[i];
        photon->direction[i] = outgoing[i];
    }
    photon->shape = hit->shape;
    /* Only the printed glossy formula adds power; what a float cannot hold no map can. */
    return pm__sum(photon->power) < FLT_MAX;
}

/* false: it meets nothing. */
static bool fly(const job *work, const carrier *photon, pm__hit *hit)
{
    if (work->watch)
        work->watch(work->context, photon->position, photon->direction, photon->shape);
    return pm__scene_intersect(work->config->scene, photon->position, photon->direction, INFINITY, photon->shape, hit);
}

static bool trace_photon(const job *work, uint64_t number)
{
    carrier photon;
    if (!emit(work, number, &photon))
        return true;
    note(work, &photon, 'L');
    for (int count = 0; count < PM__LONGEST_PATH && !is_over(work, &photon); count++) {
        double u[3];
        pm__hit hit;
        /* Drawn before it is known whether they serve: the processor does that while it waits for the ray. */
        pm__trace_uniform(work->config->seed, work->config->trial, number, 2 + (uint32_t)count, u);
        if (!fly(work, &photon, &hit) || hit.material->kind == PM__BLACK)
            break;
        absorb(&photon, &hit);
        const bool rough = pm__is_rough(hit.material);
        note(work, &photon, rough ? 'D' : 'S');
        if (rough && is_wanted(work, &photon) && !deposit(work, &photon, &hit))
            return false;
        if (is_over(work, &photon) || !bounce(&photon, &hit, u))
            break;
    }
    return true;
}

uint64_t pm__trace_watched(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store,
                           pm__watch watch, void *context)
{
    pm__emission independent;
    pm__emission_init(config->scene, NULL, PM__ALL_LIGHTS, config->seed, config->trial, &independent);
    const job work = {.config = config,
                      .emission = config->emission ? config->emission : &independent,
                      .store = store,
                      .watch = watch,
                      .context = context};
    for (uint64_t i = 0; i < count; i++)
        if (!trace_photon(&work, first + i))
            return i + 1;
    return count;
}

uint64_t pm__trace(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store, void *context)
{
    return pm__trace_watched(config, first, count, store, NULL, context);
}
