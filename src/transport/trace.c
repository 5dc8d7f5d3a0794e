#include "../scene/batch.h"
#include "emission.h"
#include "paths.h"

#include <float.h>
#include <string.h>

/* One in so many. */
enum { LEAST_SHARE = 4 };

/* Stored photons that a wave has room for: for those of one photon in any case. A wave of more starts again by halves,
 * and later ones are no larger. */
enum { MOST_RECORDS = PM__LONGEST_PATH };
#define NO_RECORD UINT16_MAX

typedef struct record {
    pm__stored stored;
    uint16_t next; /* of the same photon's */
} record;

/* What is the same for all photons of a call. */
typedef struct job {
    const pm__trace_config *config;
    const pm__emission *emission;
    const pm__batch_kernel *kernel;
    pm__store store;
    pm__watch watch; /* NULL: nobody does; else waves are of one photon */
    void *context;
    bool absorbs; /* some medium */
} job;

/* Photons that take their steps together. None depends on the others; what is stored waits until all have ended, since
 * the receiver is to have it photon by photon. */
typedef struct wave {
    pm__batch rays;                      /* of those that live; number: which photon's */
    const double *absorption[PM__BATCH]; /* 1/m by band, of the medium last known to be in; NULL: none yet */
    pm__places places[PM__BATCH];
    uint32_t coming[PM__BATCH]; /* that have come to a surface, and may go on */
    size_t coming_count, kinds[PM__BLACK + 1]; /* and how many of each kind of material */
    uint64_t first;
    record records[MOST_RECORDS];
    size_t record_count;
    uint16_t head[PM__BATCH], tail[PM__BATCH]; /* the records of photon first + i */
} wave;

static void get(double from[3][PM__BATCH], size_t i, double to[3])
{
    for (int axis = 0; axis < 3; axis++)
        to[axis] = from[axis][i];
}

static void put(const double from[3], double to[3][PM__BATCH], size_t i)
{
    for (int axis = 0; axis < 3; axis++)
        to[axis][i] = from[axis];
}

/* The paths' automaton takes a letter. */
static void note(const job *work, wave *w, size_t i, char letter)
{
    if (work->config->paths)
        w->places[i] = pm__paths_step(work->config->paths, w->places[i], letter);
}

static bool is_wanted(const job *work, const wave *w, size_t i)
{
    return !work->config->paths || pm__paths_accept(work->config->paths, w->places[i]);
}

static bool is_over(const job *work, const wave *w, size_t i)
{
    return work->config->paths && pm__paths_dead(work->config->paths, w->places[i]);
}

/* ---- Steps -------------------------------------------------------------------------------------- */

static void emit(const job *work, uint64_t first, size_t count, wave *w)
{
    pm__batch *const b = &w->rays;
    w->first = first;
    w->record_count = 0;
    b->count = count;
    for (size_t i = 0; i < count; i++) {
        w->head[i] = NO_RECORD;
        b->from[i] = PM__NO_SHAPE;
        b->number[i] = first + i;
        w->absorption[i] = NULL;
        w->places[i] = pm__paths_begin();
        note(work, w, i, 'L');
    }
    if (!pm__depart_all(work->emission, work->kernel, b) || (count > 0 && is_over(work, w, 0)))
        b->count = 0;
}

/* Beer's law over the way to the surface. A glass boundary says what lies before it, also to a photon whose light is
 * inside; elsewhere the medium is that beyond the boundary left last. */
static void absorb(wave *w, size_t i)
{
    pm__batch *const b = &w->rays;
    double normal[3], direction[3], power[3];
    if (b->material[i]->kind == PM__GLASS) {
        get(b->normal, i, normal);
        get(b->direction, i, direction);
        w->absorption[i] = pm__medium_before(b->material[i], normal, direction);
    }
    if (w->absorption[i]) {
        get(b->power, i, power);
        pm__attenuate(w->absorption[i], b->distance[i], power);
        put(power, b->power, i);
    }
}

/* facing: 1 where the photon comes from the side of the normal, else -1. */
static void deposit(wave *w, size_t i, double facing)
{
    const pm__batch *const b = &w->rays;
    const size_t photon = (size_t)(b->number[i] - w->first);
    const uint16_t at = (uint16_t)w->record_count++;
    record *const to = &w->records[at];
    for (int axis = 0; axis < 3; axis++) {
        to->stored.position[axis] = b->position[axis][i];
        to->stored.direction[axis] = b->direction[axis][i];
        to->stored.normal[axis] = facing * b->normal[axis][i];
        to->stored.power[axis] = b->power[axis][i];
    }
    to->next = NO_RECORD;
    *(w->head[photon] == NO_RECORD ? &w->head[photon] : &w->records[w->tail[photon]].next) = at;
    w->tail[photon] = at;
}

/* What scattering needs to know of the surface. toward: what the direction is along the normal. */
static void prepare(pm__batch *b, size_t i, double toward)
{
    const pm__material *const material = b->material[i];
    const double *const albedo = material->two_sided && !(toward < 0.0) ? material->back : material->diffuse;
    const double *const bands = material->kind == PM__GLASS    ? material->ior
                                : material->kind == PM__MIRROR ? material->specular
                                                               : albedo;
    for (int band = 0; band < 3; band++)
        b->bands[band][i] = bands[band];
    b->kind[i] = (int64_t)material->kind;
    if (material->kind != PM__GLOSSY)
        return;
    for (int band = 0; band < 3; band++)
        b->specular[band][i] = material->specular[band];
    b->alpha[i] = pm__alpha(material);
    if (material->printed)
        b->kind[i] = PM__BLACK;
}

/* At a surface. */
static void arrive(const job *work, wave *w, size_t i)
{
    pm__batch *const b = &w->rays;
    const pm__material *const material = b->material[i];
    const bool rough = pm__is_rough(material);
    double normal[3], direction[3];
    if (work->absorbs)
        absorb(w, i);
    note(work, w, i, rough ? 'D' : 'S');
    get(b->normal, i, normal);
    get(b->direction, i, direction);
    const double toward = pm__dot(direction, normal);
    if (rough && is_wanted(work, w, i))
        deposit(w, i, toward > 0.0 ? -1.0 : 1.0);
    if (is_over(work, w, i))
        return;
    prepare(b, i, toward);
    w->kinds[b->kind[i]]++;
    w->coming[w->coming_count++] = (uint32_t)i;
}

static void arrive_all(const job *work, wave *w)
{
    const pm__batch *const b = &w->rays;
    w->coming_count = 0;
    memset(w->kinds, 0, sizeof w->kinds);
    for (size_t i = 0; i < b->count; i++)
        if (b->material[i] && b->material[i]->kind != PM__BLACK)
            arrive(work, w, i);
}

static void scatter_one(pm__batch *b, size_t i)
{
    double normal[3], incoming[3], u[3], power[3], outgoing[3];
    get(b->normal, i, normal);
    get(b->direction, i, incoming);
    get(b->u, i, u);
    get(b->power, i, power);
    b->goes_on[i] = pm__scatter(b->material[i], normal, incoming, u, power, outgoing) != PM__ABSORBED;
    if (!b->goes_on[i])
        return;
    put(power, b->power, i);
    put(outgoing, b->outgoing, i);
    /* Only the printed glossy formula adds power; what a float cannot hold no map can. */
    b->goes_on[i] = pm__sum(power) < FLT_MAX;
}

/* All of a kind together, unless they are so few that most of it would be in vain. */
static void scatter(const job *work, wave *w)
{
    pm__batch *const b = &w->rays;
    for (size_t kind = 0; kind <= PM__BLACK; kind++) {
        if (w->kinds[kind] == 0)
            continue;
        if (work->kernel->scatter[kind] && LEAST_SHARE * w->kinds[kind] >= b->count) {
            work->kernel->scatter[kind](b);
            continue;
        }
        for (size_t j = 0; j < w->coming_count; j++)
            if (b->kind[w->coming[j]] == (int64_t)kind)
                scatter_one(b, w->coming[j]);
    }
}

/* Into what medium? */
static void pass(wave *w, size_t i)
{
    pm__batch *const b = &w->rays;
    double normal[3], outgoing[3];
    if (b->kind[i] != PM__GLASS || !b->goes_on[i])
        return;
    get(b->normal, i, normal);
    get(b->outgoing, i, outgoing);
    w->absorption[i] = pm__medium_beyond(b->material[i], normal, outgoing);
}

/* Off the surfaces; those that go on move up. */
static void leave(const job *work, wave *w)
{
    pm__batch *const b = &w->rays;
    scatter(work, w);
    for (size_t j = 0; j < w->coming_count && work->absorbs && w->kinds[PM__GLASS] > 0; j++)
        pass(w, w->coming[j]);
    size_t count = 0;
    for (size_t j = 0; j < w->coming_count; j++) {
        const uint32_t i = w->coming[j];
        w->coming[count] = i;
        count += b->goes_on[i];
    }
    b->count = count;
    for (size_t j = 0; j < count; j++) {
        const uint32_t i = w->coming[j];
        for (int axis = 0; axis < 3; axis++) {
            b->origin[axis][j] = b->position[axis][i];
            b->direction[axis][j] = b->outgoing[axis][i];
            b->power[axis][j] = b->power[axis][i];
        }
        b->from[j] = b->shape[i];
        b->number[j] = b->number[i];
        w->absorption[j] = w->absorption[i];
        w->places[j] = w->places[i];
    }
}

static void watch(const job *work, wave *w)
{
    double origin[3], direction[3];
    get(w->rays.origin, 0, origin);
    get(w->rays.direction, 0, direction);
    work->watch(work->context, origin, direction, (uint32_t)w->rays.from[0]);
}

/* false: there is not room for what they store. */
static bool run(const job *work, uint64_t first, size_t count, wave *w)
{
    emit(work, first, count, w);
    for (uint32_t step = 0; step < PM__LONGEST_PATH && w->rays.count > 0; step++) {
        if (w->record_count + w->rays.count > MOST_RECORDS)
            return false;
        work->kernel->draw(&w->rays, work->config->seed, work->config->trial, 2 + step, w->rays.u);
        if (work->watch)
            watch(work, w);
        pm__scene_intersect_batch(work->config->scene, work->kernel, &w->rays);
        arrive_all(work, w);
        leave(work, w);
    }
    return true;
}

/* ---- Waves -------------------------------------------------------------------------------------- */

/* How many photons have been handed out; the receiver may want no more. */
static size_t hand_out(const job *work, const wave *w, size_t count, bool *go_on)
{
    *go_on = true;
    for (size_t i = 0; i < count; i++)
        for (uint16_t at = w->head[i]; at != NO_RECORD; at = w->records[at].next)
            if (!work->store(work->context, w->first + i, &w->records[at].stored)) {
                *go_on = false;
                return i + 1;
            }
    return count;
}

uint64_t pm__trace_watched(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store,
                           pm__watch watch_ray, void *context)
{
    pm__emission independent;
    pm__emission_init(config->scene, NULL, PM__ALL_LIGHTS, config->seed, config->trial, &independent);
    const job work = {.config = config,
                      .emission = config->emission ? config->emission : &independent,
                      .kernel = pm__batch_choose(),
                      .store = store,
                      .watch = watch_ray,
                      .context = context,
                      .absorbs = pm__scene_absorbs(config->scene)};
    wave w;
    size_t size = watch_ray ? 1 : PM__BATCH;
    uint64_t done = 0;
    bool go_on = true;
    memset(&w.rays, 0, sizeof w.rays);
    while (go_on && done < count) {
        const size_t now = count - done < size ? (size_t)(count - done) : size;
        if (!run(&work, first + done, now, &w))
            size = now / 2;
        else
            done += hand_out(&work, &w, now, &go_on);
    }
    return done;
}

uint64_t pm__trace(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store, void *context)
{
    return pm__trace_watched(config, first, count, store, NULL, context);
}
